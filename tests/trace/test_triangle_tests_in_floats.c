/* The triangle tests in floats on soups and rays of every kind: what they tell lies within float roundings, what they
 * must find they find, and one tree has the same bits on every instruction set, with every traversal, layout and
 * mailbox. */
#include "scene/scene.h"
#include "support/awkward_rays.h"
#include "support/everywhere.h"
#include "support/float_doubt.h"
#include "support/soup.h"
#include "support/test_size.h"
#include "tree/node_arrays.h"
#include "tree/node_links.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define RAYS TEST_SIZE(300)

static const char *const test_words[] = {"test=watertight", "test=moller-trumbore", "test=projection"};

/* A soup, its oracle and rays: of two, one is awkward and one from a random point to another. */
typedef struct fixture {
    soup_scene soup;
    oracle_scene scene;
    oracle_tree tree;
    kdr_ray *rays;
    size_t count;
    kdr_device *device;
} fixture;

static fixture fixture_create(const char *name, uint64_t sequence, size_t ray_count) {
    test_random random = test_random_start(test_random_seed(), sequence);
    const soup_kind *kind = soup_kind_find(name);
    fixture f = {.soup = soup_scene_create_kind(&random, kind, kind->count), .count = ray_count};
    f.scene = oracle_scene_create(f.soup.geometries, SOUP_GEOMETRIES);
    f.tree = oracle_tree_create(&f.scene);
    f.rays = awkward_rays_create(&random, &f.tree, ray_count);
    for (size_t i = 0; i < ray_count; i += 2) {
        float at[6];
        for (int k = 0; k < 6; k++)
            at[k] = test_random_between(&random, -1.5f, 1.5f);
        f.rays[i] = (kdr_ray){.origin_x = at[0],
                              .origin_y = at[1],
                              .origin_z = at[2],
                              .direction_x = at[3] - at[0],
                              .direction_y = at[4] - at[1],
                              .direction_z = at[5] - at[2],
                              .tmax = INFINITY};
    }
    assert_int_equal(kdr_device_create(NULL, &f.device), KDR_OK);
    return f;
}

static void fixture_destroy(fixture *f) {
    kdr_device_destroy(f->device);
    free(f->rays);
    oracle_tree_destroy(&f->tree);
    oracle_scene_destroy(&f->scene);
    soup_scene_destroy(&f->soup);
}

static kdr_scene *scene_of(const fixture *f, const char *test, const char *others) {
    char text[200];
    kdr_build_def def;
    snprintf(text, sizeof text, "%s %s", test, others);
    assert_int_equal(kdr_build_def_parse(text, &def, NULL, 0), KDR_OK);
    return committed_scene(f->device, f->soup.geometries, SOUP_GEOMETRIES, &def);
}

static const oracle_primitive *primitive_of(const oracle_scene *scene, const kdr_hit *hit) {
    for (size_t i = 0; i < scene->count; i++)
        if (scene->primitives[i].geometry == hit->geometry && scene->primitives[i].primitive == hit->primitive)
            return &scene->primitives[i];
    return NULL;
}

typedef struct tally {
    size_t hits, known, clear;
} tally;

/* NULL if an answer to a ray is one that the test may give: what it tells within doubts, and nothing that it must find
 * left out or passed over. Else what is wrong. */
static const char *wrong_with(kdr_triangle_test test, const oracle_scene *scene, const kdr_ray *ray,
                              const kdr_ray_hit *told, tally *count) {
    bool hit = told->hit.geometry != KDR_INVALID_ID;
    count->hits += hit;
    if (!oracle_ray_is_valid(ray))
        return hit ? "no ray hits something" : NULL;
    if (hit) {
        const oracle_primitive *primitive = primitive_of(scene, &told->hit);
        if (!primitive || !(told->ray.tmax > ray->tmin && told->ray.tmax <= ray->tmax))
            return "the hit is not in the interval";
        float_doubt doubt = float_doubt_of(test, ray, primitive);
        count->known += doubt.known;
        if (!float_doubt_allows(&doubt, told))
            return "the hit is not where doubles have it";
    }
    double nearest = INFINITY;
    for (size_t i = 0; i < scene->count; i++) {
        float_doubt doubt = float_doubt_of(test, ray, &scene->primitives[i]);
        if (float_doubt_is_clear(&doubt, ray))
            nearest = fmin(nearest, doubt.t + doubt.doubt_t);
    }
    count->clear += nearest < INFINITY;
    return nearest == INFINITY || (hit && (double)told->ray.tmax <= nearest) ? NULL : "a clear hit is passed over";
}

static tally hold_answers(const fixture *f, kdr_triangle_test test, const char *others, const char *label) {
    tally count = {0};
    kdr_scene *scene = scene_of(f, test_words[test], others);
    for (size_t i = 0; i < f->count; i++) {
        kdr_ray_hit told = {.ray = f->rays[i]};
        kdr_intersect1(scene, &told);
        const char *wrong = wrong_with(test, &f->scene, &f->rays[i], &told, &count);
        if (!wrong && kdr_occluded1(scene, &f->rays[i]) != (told.hit.geometry != KDR_INVALID_ID))
            wrong = "any hit and closest hit differ";
        if (wrong) {
            query_print_ray(&f->rays[i]);
            fail_msg("%s, %s: %s: %u at %a (%a, %a)", label, test_words[test], wrong, told.hit.primitive,
                     (double)told.ray.tmax, (double)told.hit.u, (double)told.hit.v);
        }
    }
    kdr_scene_destroy(scene);
    return count;
}

static void hold_every_kind(kdr_triangle_test test) {
    static const char *const others[] = {"trace=stack", "trace=stack traversal-cost=60 leaf-limit=200",
                                         "trace=stack split=space leaf-limit=2", "trace=stack traversal-cost=1"};
    for (size_t kind = 0; kind < soup_kind_count; kind++) {
        const char *name = soup_kinds[kind].name;
        fixture f = fixture_create(name, 500 + kind, RAYS);
        tally count = hold_answers(&f, test, others[kind % 4], name);
        if (strcmp(name, "large") == 0) {
            assert_true(count.hits > f.count / 4);
            assert_true(count.known > count.hits / 2);
            assert_true(count.clear > count.hits / 2);
        }
        fixture_destroy(&f);
    }
}

static void moller_trumbore_lies_within_float_roundings_and_finds_what_is_clear(void **state) {
    (void)state;
    hold_every_kind(KDR_TEST_MOLLER_TRUMBORE);
}

static void projection_lies_within_float_roundings_and_finds_what_is_clear(void **state) {
    (void)state;
    hold_every_kind(KDR_TEST_PROJECTION);
}

static void the_bounds_tell_a_wrong_answer(void **state) {
    (void)state;
    fixture f = fixture_create("large", 530, RAYS);
    for (int rule = KDR_TEST_MOLLER_TRUMBORE; rule <= KDR_TEST_PROJECTION; rule++) {
        kdr_triangle_test test = (kdr_triangle_test)rule;
        kdr_scene *scene = scene_of(&f, test_words[test], "trace=stack");
        size_t told_wrong[5] = {0}, asked = 0;
        tally count = {0};
        for (size_t i = 0; i < f.count; i += 2) {
            kdr_ray_hit right = {.ray = f.rays[i]};
            kdr_intersect1(scene, &right);
            if (right.hit.geometry == KDR_INVALID_ID)
                continue;
            kdr_ray_hit wrong[5] = {right, right, right, right, right};
            wrong[0].ray.tmax = -right.ray.tmax;
            wrong[1].ray.tmax *= 1.01f;
            wrong[2].hit.u = right.hit.v;
            wrong[2].hit.v = right.hit.u;
            wrong[3].hit.u = -right.hit.u;
            wrong[4].hit.geometry = KDR_INVALID_ID;
            for (int k = 0; k < 5; k++)
                told_wrong[k] += wrong_with(test, &f.scene, &f.rays[i], &wrong[k], &count) != NULL;
            asked++;
        }
        assert_true(asked > f.count / 8);
        for (int k = 0; k < 5; k++)
            assert_true(told_wrong[k] > asked * 3 / 4);
        kdr_scene_destroy(scene);
    }
    fixture_destroy(&f);
}

/* Answers of one function of a table, for comparing. */
typedef struct answer {
    bool closest, any;
    kdr_found found;
} answer;

static answer ask(const kdr_lone *lone, const kdr_tree *tree, const kdr_ray *ray) {
    answer said;
    memset(&said, 0, sizeof said);
    said.closest = lone->closest(tree, ray, &said.found);
    if (!said.closest)
        memset(&said.found, 0, sizeof said.found);
    said.any = lone->any(tree, ray);
    return said;
}

/* All that one tree can be asked by, against the scalar stack without a mailbox. */
static void hold_bits(const fixture *f, kdr_tree *tree, kdr_triangle_test test, const char *label) {
    tree->test = test;
    tree->mailbox_size = 0;
    answer *expected = test_allocate(f->count, sizeof *expected);
    const kdr_lone *first = &kdr_named_traversals_for(KDR_ISA_SCALAR)->of[KDR_TRACE_STACK][0][0];
    for (size_t i = 0; i < f->count; i++)
        expected[i] = ask(first, tree, &f->rays[i]);
    size_t asked = 0, devices = 0;
    for (int isa = KDR_ISA_SCALAR; isa <= KDR_ISA_NEON; isa++) {
        kdr_device *device = device_of_isa((kdr_isa)isa, 1, NULL);
        devices += device != NULL;
        for (int trace = KDR_TRACE_STACK; device && trace <= KDR_TRACE_BACKTRACK; trace++) {
            for (int way = 0; way < 4; way++) {
                const kdr_lone *lone = &kdr_named_traversals_for((kdr_isa)isa)->of[trace][way % 2][way / 2];
                tree->mailbox_size = way < 2 ? 0 : 8u << (trace + isa) % 4;
                for (size_t i = 0; lone->closest && i < f->count; i++) {
                    answer said = ask(lone, tree, &f->rays[i]);
                    if (memcmp(&said, &expected[i], sizeof said) == 0)
                        continue;
                    query_print_ray(&f->rays[i]);
                    fail_msg("%s, %s, %s, trace %d, nodes %d, mailbox of %u: other bits", label, test_words[test],
                             kdr_isa_name((kdr_isa)isa), trace, way % 2, tree->mailbox_size);
                }
                asked += lone->closest != NULL;
            }
        }
        kdr_device_destroy(device);
    }
    assert_true(devices > 0 && asked == 14 * devices);
    free(expected);
}

static void one_tree_has_the_same_bits_however_it_is_asked(void **state) {
    (void)state;
    static const char *const others[] = {"trace=backtrack", "trace=backtrack traversal-cost=0.01 leaf-limit=1",
                                         "trace=backtrack traversal-cost=60 leaf-limit=200",
                                         "trace=backtrack split=sweep straddle=clip leaf-limit=4"};
    for (size_t kind = 0; kind < soup_kind_count; kind++) {
        fixture f = fixture_create(soup_kinds[kind].name, 560 + kind, RAYS / 3 + 1);
        kdr_scene *scene = scene_of(&f, "test=projection", others[kind % 4]);
        assert_true(kdr_tree_add_arrays(&scene->shown->dynamic_part->tree, &f.device->bulk));
        hold_bits(&f, &scene->shown->dynamic_part->tree, KDR_TEST_MOLLER_TRUMBORE, soup_kinds[kind].name);
        hold_bits(&f, &scene->shown->dynamic_part->tree, KDR_TEST_PROJECTION, soup_kinds[kind].name);
        kdr_scene_destroy(scene);
        fixture_destroy(&f);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(moller_trumbore_lies_within_float_roundings_and_finds_what_is_clear),
        cmocka_unit_test(projection_lies_within_float_roundings_and_finds_what_is_clear),
        cmocka_unit_test(the_bounds_tell_a_wrong_answer),
        cmocka_unit_test(one_tree_has_the_same_bits_however_it_is_asked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
