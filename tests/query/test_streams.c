/* Calls for thousands of rays in any order: each ray gets the bits that a lone ray gets on the plainest instruction
 * set, whatever the caller says of them and wherever a block of them ends.
 *
 * The rays are a few hundred awkward ones and bundles for the very tree (cell_rays.h), repeated and shuffled, with ids
 * of their own: an answer that comes back to the wrong place is another ray's. */
#include "support/awkward_rays.h"
#include "support/cell_rays.h"
#include "support/everywhere.h"
#include "support/soup.h"
#include "support/test_size.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define DISTINCT 256 /* rays, half of them in bundles */
#define BUNDLE 16
#define LONGEST TEST_SIZE(4200)

/* Distinct rays with their answers, and a shuffled stream of them. */
typedef struct stream {
    kdr_ray rays[DISTINCT];
    kdr_ray_hit answers[DISTINCT];
    uint32_t number[LONGEST]; /* of the distinct ray at each place */
    kdr_ray asked[LONGEST];
    kdr_ray_hit given[LONGEST + 1];
    uint8_t occluded[LONGEST + 1];
} stream;

static void make_rays(test_random *random, const kdr_scene *scene, const oracle_tree *tree, stream *s) {
    cell_sample sample = cell_sample_of(scene, random);
    for (size_t i = 0; i < DISTINCT; i++) {
        if (i >= DISTINCT / 2 && i % BUNDLE)
            continue;
        s->rays[i] = test_random_below(random, 2) ? awkward_ray(random, tree) : cell_ray(random, tree, &sample);
        if (i >= DISTINCT / 2)
            cell_ray_bundle(random, tree, &s->rays[i], BUNDLE);
    }
    for (size_t i = 0; i < DISTINCT; i++) {
        oracle_hit exact = oracle_tree_closest(tree, &s->rays[i]);
        s->answers[i] = (kdr_ray_hit){.ray = s->rays[i]};
        kdr_intersect1(scene, &s->answers[i]);
        assert_true(query_answer_is_right(&s->rays[i], &exact, &s->answers[i], "scalar"));
    }
}

/* Stretches of single rays in any order, and of whole bundles, whose rays go together. */
static void shuffle(test_random *random, stream *s) {
    for (uint32_t i = 0; i < LONGEST;) {
        bool bundles = test_random_below(random, 2);
        uint32_t end = i + test_random_below(random, 500) + 1;
        for (; i < end && i < LONGEST; i++) {
            bool again = bundles && i % BUNDLE && s->number[i - 1] % BUNDLE != BUNDLE - 1;
            s->number[i] = again     ? s->number[i - 1] + 1
                           : bundles ? DISTINCT / 2 + test_random_below(random, DISTINCT / 2 / BUNDLE) * BUNDLE
                                     : test_random_below(random, DISTINCT);
            s->asked[i] = s->rays[s->number[i]];
            s->asked[i].id = i;
        }
    }
}

static bool is_right(const stream *s, size_t place, const kdr_ray_hit *given) {
    kdr_ray_hit expected = s->answers[s->number[place]];
    expected.ray.id = (uint32_t)place;
    return memcmp(&given->ray, &expected.ray, sizeof expected.ray) == 0 &&
           given->hit.geometry == expected.hit.geometry &&
           (given->hit.geometry == KDR_INVALID_ID || memcmp(&given->hit, &expected.hit, sizeof expected.hit) == 0);
}

static void hold_call(const kdr_scene *scene, stream *s, size_t first, size_t count, int coherence, const char *label) {
    kdr_trace_def def = kdr_default_trace_def();
    def.coherence = (kdr_coherence)coherence;
    memset(s->given, 0x5a, (count + 1) * sizeof s->given[0]);
    memset(s->occluded, 0x5a, count + 1);
    for (size_t i = 0; i < count; i++)
        s->given[i].ray = s->asked[first + i];
    const kdr_ray_hit behind = s->given[count];
    kdr_intersect_n(scene, &def, s->given, count);
    kdr_occluded_n(scene, &def, s->asked + first, s->occluded, count);
    for (size_t i = 0; i < count; i++) {
        bool hit = s->answers[s->number[first + i]].hit.geometry != KDR_INVALID_ID;
        if (is_right(s, first + i, &s->given[i]) && s->occluded[i] == hit)
            continue;
        query_print_ray(&s->asked[first + i]);
        fail_msg("%s: ray %zu of %zu, coherence %d: wrong", label, i, count, coherence);
    }
    assert_memory_equal(&s->given[count], &behind, sizeof behind);
    assert_int_equal(s->occluded[count], 0x5a);
}

static void hold_scene(const char *kind, size_t triangles, uint64_t sequence, stream *s) {
    static const size_t counts[] = {15, 63, 64, 65, 257, 1025, 4097};
    test_random random = test_random_start(test_random_seed(), sequence);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find(kind), triangles);
    oracle_scene oracle = oracle_scene_create(soup.geometries, SOUP_GEOMETRIES);
    oracle_tree tree = oracle_tree_create(&oracle);
    kdr_device *plain = device_of_isa(KDR_ISA_SCALAR, 1, NULL);
    kdr_scene *reference = committed_scene(plain, soup.geometries, SOUP_GEOMETRIES, NULL);
    make_rays(&random, reference, &tree, s);
    for (int isa = KDR_ISA_SCALAR; isa <= KDR_ISA_NEON; isa++) {
        kdr_device *device = device_of_isa((kdr_isa)isa, 1, NULL);
        if (!device)
            continue;
        kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, NULL);
        char label[100];
        snprintf(label, sizeof label, "%s, %s", kind, kdr_isa_name((kdr_isa)isa));
        shuffle(&random, s);
        for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++)
            if (counts[i] <= LONGEST)
                hold_call(scene, s, test_random_below(&random, (uint32_t)(LONGEST - counts[i]) + 1), counts[i],
                          (int)(i + (size_t)isa) % 3, label);
        for (int coherence = 0; coherence < 3; coherence++)
            hold_call(scene, s, 0, LONGEST, coherence, label);
        kdr_scene_destroy(scene);
        kdr_device_destroy(device);
    }
    kdr_scene_destroy(reference);
    kdr_device_destroy(plain);
    oracle_tree_destroy(&tree);
    oracle_scene_destroy(&oracle);
    soup_scene_destroy(&soup);
}

static void a_ray_of_a_long_stream_gets_its_own_answer(void **state) {
    (void)state;
    stream *s = test_allocate(1, sizeof *s);
    hold_scene("small", 3000, 5000, s);
    hold_scene("large", 200, 5001, s);
    free(s);
}

#define ROW TEST_SIZE(20000) /* of triangles, one behind the other */

/* Each leaf of its own, and every box on the way of a ray that hits nothing but the last: more children wait than
 * rays that take turns have room for. */
static void a_ray_that_meets_thousands_of_boxes_is_answered_among_others(void **state) {
    (void)state;
    float(*corners)[9] = test_allocate(ROW, sizeof *corners);
    for (size_t i = 0; i < ROW; i++) {
        const float x = (float)i, corner[9] = {x, 0, -1, x, 0, 1, x, 2, 0}, wall[9] = {x, -9, -9, x, -9, 9, x, 9, 0};
        memcpy(corners[i], i + 1 < ROW ? corner : wall, sizeof corner);
    }
    kdr_triangles_def triangles = kdr_default_triangles_def();
    triangles.vertices = corners[0];
    triangles.vertex_count = 3 * ROW;
    triangles.triangle_count = ROW;
    kdr_build_def plan;
    assert_int_equal(kdr_build_def_parse("leaf-limit=1 traversal-cost=0.01", &plan, NULL, 0), KDR_OK);
    for (int isa = KDR_ISA_SCALAR; isa <= KDR_ISA_NEON; isa++) {
        kdr_device *device = device_of_isa((kdr_isa)isa, 1, NULL);
        if (!device)
            continue;
        kdr_scene *scene = committed_scene(device, &triangles, 1, &plan);
        kdr_ray rays[100];
        kdr_ray_hit given[100];
        uint8_t occluded[100];
        for (int i = 0; i < 100; i++) {
            rays[i] = (kdr_ray){.origin_x = -1,
                                .origin_y = 1.4f + 0.001f * (float)i,
                                .origin_z = 0.9f,
                                .direction_x = 1,
                                .tmax = i % 3 ? INFINITY : (float)ROW - 0.5f};
            given[i].ray = rays[i];
        }
        kdr_trace_def def = kdr_default_trace_def();
        def.coherence = KDR_COHERENCE_INCOHERENT;
        kdr_occluded_n(scene, &def, rays, occluded, 100);
        kdr_intersect_n(scene, &def, given, 100);
        for (int i = 0; i < 100; i++) {
            assert_int_equal(occluded[i], i % 3 != 0);
            assert_int_equal(given[i].hit.geometry, i % 3 ? 0 : KDR_INVALID_ID);
            assert_true(i % 3 == 0 || (given[i].hit.primitive == ROW - 1 && given[i].ray.tmax == (float)ROW));
        }
        kdr_scene_destroy(scene);
        kdr_device_destroy(device);
    }
    free(corners);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ray_of_a_long_stream_gets_its_own_answer),
        cmocka_unit_test(a_ray_that_meets_thousands_of_boxes_is_answered_among_others),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
