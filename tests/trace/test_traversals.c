/* Every traversal by name, with every mailbox and over both layouts of the nodes, on every instruction set, gives the
 * oracle's answers and the scalar stack's bits. */
#include "scene/scene.h"
#include "support/awkward_rays.h"
#include "support/everywhere.h"
#include "support/failing_alloc.h"
#include "support/soup.h"
#include "support/test_size.h"
#include "tree/node_arrays.h"
#include "tree/walk.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define KDR_LANES 1
#include "tree/mailbox_lanes.h"

#define RAYS TEST_SIZE(100)
#define LONG_ROUNDS 20

typedef struct plan_name {
    char text[100];
} plan_name;

/* Plan number i of those whose rules go together, or false past the last one. */
static bool plan_of(size_t i, const char *others, kdr_build_def *def, plan_name *name) {
    static const char *const traces[] = {"stack", "restart", "push-down", "short-stack", "backtrack"};
    static const char *const boxes[] = {"0", "8", "16", "32", "64"};
    size_t layout = i / 25, trace = i / 5 % 5;
    if (layout > 1 || (layout == 1 && trace > 1))
        return false;
    snprintf(name->text, sizeof name->text, "trace=%s nodes=%s mailbox=%s %s", traces[trace],
             layout == 1 ? "arrays" : "structures", boxes[i % 5], others);
    assert_int_equal(kdr_build_def_parse(name->text, def, NULL, 0), KDR_OK);
    return true;
}

/* What a scene says to rays, all of it. */
typedef struct answers {
    kdr_ray_hit *hits;
    uint8_t *occluded;
    size_t count;
} answers;

static answers ask(const kdr_scene *scene, const kdr_ray *rays, size_t count) {
    answers said = {test_allocate(count, sizeof(kdr_ray_hit)), test_allocate(count, 1), count};
    for (size_t i = 0; i < count; i++) {
        said.hits[i].ray = rays[i];
        kdr_intersect1(scene, &said.hits[i]);
        said.occluded[i] = kdr_occluded1(scene, &rays[i]);
    }
    return said;
}

static void forget(answers *said) {
    free(said->hits);
    free(said->occluded);
}

static void assert_same(const answers *a, const answers *b, const kdr_ray *rays, const char *label) {
    for (size_t i = 0; i < a->count; i++) {
        bool same = a->hits[i].hit.geometry == KDR_INVALID_ID
                        ? b->hits[i].hit.geometry == KDR_INVALID_ID
                        : memcmp(&a->hits[i], &b->hits[i], sizeof a->hits[i]) == 0;
        if (same && a->occluded[i] == b->occluded[i])
            continue;
        query_print_ray(&rays[i]);
        fail_msg("%s: another answer than the scalar stack's", label);
    }
}

/* Holds every plan on every instruction set to the oracle, in all queries, and to the bits of the first. */
static void hold_plans(const soup_scene *soup, const kdr_ray *rays, const query_sheet *sheet, const char *others,
                       const char *label) {
    answers expected = {0};
    size_t scenes = 0;
    for (int isa = KDR_ISA_SCALAR; isa <= KDR_ISA_NEON; isa++) {
        kdr_device *device = device_of_isa((kdr_isa)isa, 1, NULL);
        kdr_build_def def;
        plan_name name;
        for (size_t i = 0; device && plan_of(i, others, &def, &name); i++, scenes++) {
            kdr_scene *scene = committed_scene(device, soup->geometries, SOUP_GEOMETRIES, &def);
            assert_null(scene->shown->dynamic_part->tree.wide);
            char text[300];
            snprintf(text, sizeof text, "%s, %s, %s", label, kdr_isa_name((kdr_isa)isa), name.text);
            if (i % 5 == 0 && query_sheet_differences(sheet, scene, text) > 0)
                fail_msg("%s: wrong answers", text);
            answers said = ask(scene, rays, sheet->count);
            if (!expected.hits)
                expected = said;
            assert_same(&expected, &said, rays, text);
            if (said.hits != expected.hits)
                forget(&said);
            kdr_scene_destroy(scene);
        }
        kdr_device_destroy(device);
    }
    forget(&expected);
    assert_true(scenes >= 2 * 35);
}

static void hold_kind(size_t kind, uint64_t round) {
    static const char *const others[] = {"", "traversal-cost=0.01 leaf-limit=1 depth-limit=60",
                                         "split=space leaf-limit=2", "traversal-cost=1"};
    const soup_kind *drawn = &soup_kinds[kind];
    const char *build = others[(kind + round) % 4];
    uint64_t sequence = 300 + round * soup_kind_count + kind;
    test_random random = test_random_start(test_random_seed(), sequence);
    soup_scene soup = soup_scene_create_kind(&random, drawn, drawn->count / (1 + round % 3));
    oracle_scene scene = oracle_scene_create(soup.geometries, SOUP_GEOMETRIES);
    oracle_tree tree = oracle_tree_create(&scene);
    size_t count = drawn->is_exact ? RAYS / 20 + 1 : RAYS;
    kdr_ray *rays = awkward_rays_create(&random, &tree, count);
    query_sheet sheet = query_sheet_create(&tree, rays, count);
    char label[100];
    snprintf(label, sizeof label, "%s, sequence %llu", drawn->name, (unsigned long long)sequence);
    hold_plans(&soup, rays, &sheet, build, label);
    query_sheet_destroy(&sheet);
    free(rays);
    oracle_tree_destroy(&tree);
    oracle_scene_destroy(&scene);
    soup_scene_destroy(&soup);
}

static void every_traversal_gives_the_same_bits_on_every_kind_of_soup(void **state) {
    (void)state;
    uint64_t rounds = test_is_long() ? LONG_ROUNDS : 1;
    for (uint64_t round = 0; round < rounds; round++)
        for (size_t kind = 0; kind < soup_kind_count; kind++)
            hold_kind(kind, round);
}

/* Rays along the planes of a lattice's cells are in cells on both sides all the way, and pass where many meet. */
static void rays_in_split_planes_and_through_their_crossings_lose_nothing(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 301);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("grid"), 300);
    oracle_scene scene = oracle_scene_create(soup.geometries, SOUP_GEOMETRIES);
    oracle_tree tree = oracle_tree_create(&scene);
    size_t count = RAYS;
    kdr_ray *rays = test_allocate(count, sizeof *rays);
    for (size_t i = 0; i < count; i++) {
        const oracle_primitive *from = &scene.primitives[test_random_below(&random, (uint32_t)scene.count)];
        const oracle_primitive *to = &scene.primitives[test_random_below(&random, (uint32_t)scene.count)];
        rays[i] = (kdr_ray){.origin_x = from->a[0],
                            .origin_y = from->b[1],
                            .origin_z = from->c[2],
                            .direction_x = to->a[0] - from->a[0],
                            .direction_y = to->b[1] - from->b[1],
                            .direction_z = to->c[2] - from->c[2],
                            .tmin = -INFINITY,
                            .tmax = INFINITY};
        float *direction = &rays[i].direction_x;
        for (size_t zeros = i % 3; zeros > 0; zeros--)
            direction[test_random_below(&random, 3)] = 0;
    }
    query_sheet sheet = query_sheet_create(&tree, rays, count);
    assert_true(sheet.hit_count > count / 10);
    hold_plans(&soup, rays, &sheet, "traversal-cost=0.01 leaf-limit=1 depth-limit=60", "grid");
    hold_plans(&soup, rays, &sheet, "split=object leaf-limit=1", "grid");
    query_sheet_destroy(&sheet);
    free(rays);
    oracle_tree_destroy(&tree);
    oracle_scene_destroy(&scene);
    soup_scene_destroy(&soup);
}

/* A small scene by a plan. */
typedef struct fixture {
    kdr_device *device;
    soup_scene soup;
    kdr_scene *scene;
} fixture;

static fixture scene_by(const char *plan) {
    kdr_build_def def;
    test_random random = test_random_start(test_random_seed(), 302);
    fixture made = {.soup = soup_scene_create_kind(&random, soup_kind_find("small"), 2000)};
    assert_int_equal(kdr_build_def_parse(plan, &def, NULL, 0), KDR_OK);
    assert_int_equal(kdr_device_create(NULL, &made.device), KDR_OK);
    made.scene = committed_scene(made.device, made.soup.geometries, SOUP_GEOMETRIES, &def);
    return made;
}

static void done_with(fixture *made) {
    kdr_scene_destroy(made->scene);
    kdr_device_destroy(made->device);
    soup_scene_destroy(&made->soup);
}

static void nodes_become_arrays_and_nodes_again_to_the_byte(void **state) {
    (void)state;
    fixture made = scene_by("trace=stack nodes=arrays leaf-limit=4");
    const kdr_tree *tree = &made.scene->shown->dynamic_part->tree;
    assert_true(tree->node_count > 100);
    assert_int_equal(tree->arrays.bytes, 13 * tree->node_count);
    kdr_node *words = test_allocate(tree->node_count, sizeof *words);
    for (uint32_t i = 0; i < tree->node_count; i++)
        words[i] = kdr_node_of_arrays(&tree->arrays, i);
    assert_memory_equal(words, tree->nodes, tree->node_count * sizeof *words);

    // And from these nodes the same arrays.
    kdr_tree again = {.nodes = words, .node_count = tree->node_count};
    assert_true(kdr_tree_add_arrays(&again, &made.device->bulk));
    assert_int_equal(again.arrays.bytes, tree->arrays.bytes);
    assert_memory_equal(again.arrays.plane, tree->arrays.plane, tree->arrays.bytes);
    kdr_bulk_put(&made.device->bulk, again.arrays.plane, again.arrays.bytes);
    free(words);
    done_with(&made);
}

static bool link_is_right(const kdr_tree *tree, const kdr_walk *at, void *context) {
    uint32_t *visited = context;
    kdr_node node = tree->nodes[at->node];
    ++*visited;
    if (memcmp(&tree->links.box[at->node], &at->cell, sizeof at->cell) != 0)
        return false;
    if (kdr_node_is_leaf(node))
        return true;
    uint32_t child = kdr_node_child(node);
    return tree->links.parent[child] == at->node && tree->links.parent[child + 1] == at->node;
}

static void links_name_every_nodes_parent_and_cell(void **state) {
    (void)state;
    fixture made = scene_by("trace=backtrack leaf-limit=4");
    uint32_t visited = 0;
    assert_true(kdr_tree_walk(&made.scene->shown->dynamic_part->tree, link_is_right, &visited));
    assert_int_equal(visited, made.scene->shown->dynamic_part->tree.node_count - 1);
    done_with(&made);
}

static void annexes_are_made_and_counted_only_where_a_plan_asks(void **state) {
    (void)state;
    static const struct {
        const char *plan;
        uint32_t node_bytes;
    } cases[] = {
        {"trace=stack", 8},          {"trace=restart mailbox=64", 8},
        {"trace=short-stack", 8},    {"trace=restart nodes=arrays", 8 + 13},
        {"trace=backtrack", 8 + 28},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        fixture made = scene_by(cases[i].plan);
        kdr_tree_stats stats;
        assert_int_equal(kdr_scene_stats(made.scene, &stats), KDR_OK);
        uint64_t nodes = stats.interior_count + stats.leaf_count + 1; // with the unused one
        assert_int_equal(stats.node_bytes, nodes * cases[i].node_bytes);
        done_with(&made);
    }
}

static void another_traversal_is_in_force_after_a_commit_and_the_tree_is_the_same(void **state) {
    (void)state;
    fixture made = scene_by("trace=backtrack");
    uint64_t hash = kdr_scene_hash(made.scene);
    assert_non_null(made.scene->shown->dynamic_part->tree.links.parent);
    assert_int_equal(kdr_scene_commit(made.scene, NULL), KDR_OK);
    assert_null(made.scene->shown->dynamic_part->tree.links.parent);
    assert_ptr_equal(made.scene->shown->dynamic_part->lone.closest, made.device->traversals->single_closest);
    assert_true(kdr_scene_hash(made.scene) == hash);
    done_with(&made);
}

static void a_commit_without_memory_for_an_annex_keeps_the_old_traversal(void **state) {
    (void)state;
    static const char *const plans[] = {"trace=backtrack", "trace=restart nodes=arrays", "trace=stack test=projection"};
    test_random random = test_random_start(test_random_seed(), 303);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), 400);
    for (size_t i = 0; i < 6; i++) {
        failing_alloc memory;
        failing_alloc_init(&memory);
        kdr_allocator functions = failing_alloc_functions(&memory);
        kdr_build_def from, to;
        assert_int_equal(kdr_build_def_parse(plans[i % 3], &to, NULL, 0), KDR_OK);
        assert_int_equal(kdr_build_def_parse(plans[(i + 1) % 3], &from, NULL, 0), KDR_OK);
        uint64_t failures = 0;
        for (uint64_t n = 1; failures == n - 1; n++) {
            kdr_device *device = device_of_isa(KDR_ISA_SCALAR, 1, &functions);
            kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, i < 3 ? NULL : &from);
            kdr_scene_touch(scene, 0);
            kdr_lone lone = scene->shown->dynamic_part->lone;
            kdr_device_trim(device);
            failing_alloc_fail_nth(&memory, n);
            kdr_status status = kdr_scene_commit(scene, &to);
            failures += memory.failures > 0;
            failing_alloc_fail_nth(&memory, 0);
            if (status != KDR_OK) {
                assert_int_equal(status, KDR_ERROR_OUT_OF_MEMORY);
                assert_true(scene->shown->dynamic_part->lone.closest == lone.closest &&
                            scene->shown->dynamic_part->lone.any == lone.any);
                assert_true((scene->shown->dynamic_part->tree.links.parent != NULL) ==
                            (i >= 3 && from.trace == KDR_TRACE_BACKTRACK));
                assert_true((scene->shown->dynamic_part->tree.arrays.plane != NULL) ==
                            (i >= 3 && from.nodes == KDR_NODES_ARRAYS));
                assert_true((scene->shown->dynamic_part->tree.projections.rows != NULL) ==
                            (i >= 3 && from.test == KDR_TEST_PROJECTION));
                assert_int_equal(kdr_scene_verify(scene), KDR_OK);
            }
            kdr_scene_destroy(scene);
            kdr_device_destroy(device);
            assert_true(failing_alloc_is_clean(&memory));
        }
        assert_true(failures > 3);
    }
    soup_scene_destroy(&soup);
}

/* A block of one triangle with that number. */
static kdr_lane_bits ask_mailbox(kdr_mailbox *mailbox, uint32_t primitive) {
    static float rows[KDR_BLOCK_GROUP * KDR_BLOCK_ROWS];
    const float corners[3][3] = {{0}};
    kdr_node leaf = kdr_node_leaf(1, 0);
    kdr_block_set(rows, leaf, 0, corners, primitive);
    return kdr_mailbox_new(mailbox, kdr_block_of(rows, leaf), 0);
}

static void a_mailbox_knows_a_triangle_until_another_takes_its_place(void **state) {
    (void)state;
    for (uint32_t size = 8; size <= KDR_MAILBOX_LARGEST; size *= 2) {
        kdr_mailbox mailbox;
        kdr_mailbox_begin(&mailbox, size);
        for (uint32_t i = 0; i < size; i++)
            assert_int_equal(ask_mailbox(&mailbox, i), 1);
        for (uint32_t i = 0; i < size; i++)
            assert_int_equal(ask_mailbox(&mailbox, i), 0);
        assert_int_equal(ask_mailbox(&mailbox, size), 1);
        assert_int_equal(ask_mailbox(&mailbox, 1), 0);
        assert_int_equal(ask_mailbox(&mailbox, 0), 1);
        assert_int_equal(ask_mailbox(&mailbox, size), 1);
    }
    assert_int_equal(ask_mailbox(NULL, 5), 1);
    assert_int_equal(ask_mailbox(NULL, 5), 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_traversal_gives_the_same_bits_on_every_kind_of_soup),
        cmocka_unit_test(rays_in_split_planes_and_through_their_crossings_lose_nothing),
        cmocka_unit_test(nodes_become_arrays_and_nodes_again_to_the_byte),
        cmocka_unit_test(links_name_every_nodes_parent_and_cell),
        cmocka_unit_test(annexes_are_made_and_counted_only_where_a_plan_asks),
        cmocka_unit_test(another_traversal_is_in_force_after_a_commit_and_the_tree_is_the_same),
        cmocka_unit_test(a_commit_without_memory_for_an_annex_keeps_the_old_traversal),
        cmocka_unit_test(a_mailbox_knows_a_triangle_until_another_takes_its_place),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
