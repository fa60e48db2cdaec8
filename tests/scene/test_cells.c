/* kdr_scene_cells shows the committed tree as it is: in order, whole, and no more of it than the visitor asks for. */
#include "support/everywhere.h"
#include "support/soup.h"
#include "support/test_size.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

#define TRIANGLES TEST_SIZE(5000)

static kdr_device *make_device(void) {
    kdr_device *device;
    assert_int_equal(kdr_device_create(NULL, &device), KDR_OK);
    return device;
}

/* What a walk over all cells finds; each cell is held against the one that the plane of its parent makes. */
typedef struct whole_walk {
    kdr_cell expected[KDR_MAX_DEPTH + 2]; /* cells that are still to come, the next one last */
    uint32_t expected_count;
    uint64_t interiors, leaves, empty_leaves, references;
    uint32_t depth, wrong;
} whole_walk;

static kdr_cell_step follow(const kdr_cell *cell, void *user) {
    whole_walk *walk = user;
    if (walk->expected_count == 0) {
        walk->wrong++;
        return KDR_CELL_STOP;
    }
    const kdr_cell *expected = &walk->expected[--walk->expected_count];
    walk->wrong += cell->depth != expected->depth || memcmp(cell->bounds, expected->bounds, sizeof cell->bounds) != 0;
    walk->depth = cell->depth > walk->depth ? cell->depth : walk->depth;
    if (cell->is_leaf) {
        walk->leaves++;
        walk->empty_leaves += cell->primitive_count == 0;
        walk->references += cell->primitive_count;
        walk->wrong += cell->axis != 0 || cell->plane != 0;
        return KDR_CELL_INTO;
    }
    walk->interiors++;
    walk->wrong += cell->primitive_count != 0 || cell->axis > 2;
    walk->wrong += !(cell->plane >= cell->bounds[cell->axis] && cell->plane <= cell->bounds[cell->axis + 3]);
    kdr_cell left = {.depth = cell->depth + 1};
    memcpy(left.bounds, cell->bounds, sizeof left.bounds);
    kdr_cell right = left;
    left.bounds[cell->axis + 3] = right.bounds[cell->axis] = cell->plane;
    walk->expected[walk->expected_count++] = right;
    walk->expected[walk->expected_count++] = left;
    return KDR_CELL_INTO;
}

static void every_cell_is_shown_before_those_inside_it_and_the_lower_side_first(void **state) {
    (void)state;
    kdr_device *device = make_device();
    for (size_t kind = 0; kind < soup_kind_count; kind++) {
        test_random random = test_random_start(test_random_seed(), kind);
        soup_scene soup = soup_scene_create_kind(&random, &soup_kinds[kind], TRIANGLES);
        kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, NULL);
        whole_walk walk = {.expected_count = 1};
        kdr_scene_bounds(scene, walk.expected[0].bounds);
        assert_int_equal(kdr_scene_cells(scene, follow, &walk), KDR_OK);
        assert_int_equal(walk.wrong, 0);
        assert_int_equal(walk.expected_count, 0);

        kdr_tree_stats stats;
        assert_int_equal(kdr_scene_stats(scene, &stats), KDR_OK);
        assert_true(walk.interiors == stats.interior_count && walk.leaves == stats.leaf_count);
        assert_true(walk.empty_leaves == stats.empty_leaf_count && walk.references == stats.reference_count);
        assert_int_equal(walk.depth, stats.depth);
        kdr_scene_destroy(scene);
        soup_scene_destroy(&soup);
    }
    kdr_device_destroy(device);
}

/* Goes past every cell at one depth, and stops after some cells. */
typedef struct part_walk {
    uint32_t past;
    uint64_t stop_after, shown, at_depth;
    uint32_t deepest;
} part_walk;

static kdr_cell_step look(const kdr_cell *cell, void *user) {
    part_walk *walk = user;
    walk->shown++;
    walk->at_depth += cell->depth == walk->past;
    walk->deepest = cell->depth > walk->deepest ? cell->depth : walk->deepest;
    if (walk->shown == walk->stop_after)
        return KDR_CELL_STOP;
    return cell->depth == walk->past ? KDR_CELL_PAST : KDR_CELL_INTO;
}

static void a_visitor_goes_past_cells_and_stops_where_it_likes(void **state) {
    (void)state;
    kdr_device *device = make_device();
    test_random random = test_random_start(test_random_seed(), 1);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), 2000);
    kdr_build_def def = kdr_default_build_def();
    def.split = KDR_SPLIT_OBJECT;
    kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, &def);
    for (uint32_t depth = 0; depth < 4; depth++) {
        // The tree is deeper than that everywhere, so it shows all of its top.
        part_walk walk = {.past = depth};
        assert_int_equal(kdr_scene_cells(scene, look, &walk), KDR_OK);
        assert_int_equal(walk.deepest, depth);
        assert_int_equal(walk.at_depth, 1u << depth);
        assert_int_equal(walk.shown, (2u << depth) - 1);
    }
    for (uint64_t count = 1; count < 20; count++) {
        part_walk walk = {.past = UINT32_MAX, .stop_after = count};
        assert_int_equal(kdr_scene_cells(scene, look, &walk), KDR_OK);
        assert_true(walk.shown == count);
    }
    kdr_scene_destroy(scene);
    soup_scene_destroy(&soup);
    kdr_device_destroy(device);
}

static kdr_cell_step keep_only_cell(const kdr_cell *cell, void *user) {
    kdr_cell *kept = user;
    kept[1] = kept[0];
    kept[0] = *cell;
    return KDR_CELL_INTO;
}

static void a_scene_without_triangles_is_one_empty_leaf(void **state) {
    (void)state;
    kdr_device *device = make_device();
    kdr_scene *scene;
    assert_int_equal(kdr_scene_create(device, &scene), KDR_OK);
    for (int committed = 0; committed <= 1; committed++) {
        kdr_cell cells[2] = {{.depth = 7}, {.depth = 7}};
        assert_int_equal(kdr_scene_cells(scene, keep_only_cell, cells), KDR_OK);
        assert_true(cells[0].is_leaf && cells[0].depth == 0 && cells[0].primitive_count == 0);
        assert_true(cells[0].bounds[0] > cells[0].bounds[3]);
        assert_int_equal(cells[1].depth, 7);
        assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
    }
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
}

static void box_of_ball(uint32_t primitive, float lo[3], float hi[3], void *user) {
    (void)user;
    for (int k = 0; k < 3; k++) {
        lo[k] = k == 0 ? (float)(3 * primitive) : 0;
        hi[k] = lo[k] + 1;
    }
}

static bool hit_nothing(const kdr_ray *ray, uint32_t primitive, kdr_custom_hit *hit, void *user) {
    (void)ray, (void)primitive, (void)hit, (void)user;
    return false;
}

/* What a walk over two trees sees of each. */
typedef struct tree_counts {
    uint64_t leaves[2], roots[2], references[2];
    bool back; /* triangles came after custom primitives */
} tree_counts;

static kdr_cell_step count_trees(const kdr_cell *cell, void *user) {
    tree_counts *counts = user;
    int tree = cell->is_custom;
    counts->back = counts->back || (tree == 0 && counts->roots[1] > 0);
    counts->roots[tree] += cell->depth == 0;
    counts->leaves[tree] += cell->is_leaf;
    counts->references[tree] += cell->primitive_count;
    return KDR_CELL_INTO;
}

static void custom_primitives_have_a_tree_of_their_own_after_the_triangles(void **state) {
    (void)state;
    enum { BALLS = 40 };
    kdr_device *device = make_device();
    test_random random = test_random_start(test_random_seed(), 3);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), 300);
    kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, NULL);
    tree_counts without = {0}, with = {0};
    assert_int_equal(kdr_scene_cells(scene, count_trees, &without), KDR_OK);
    assert_true(without.roots[0] == 1 && without.roots[1] == 0);

    kdr_custom_def balls = kdr_default_custom_def();
    balls.primitive_count = BALLS;
    balls.bounds = box_of_ball;
    balls.intersect = hit_nothing;
    kdr_build_def def = kdr_default_build_def();
    assert_int_equal(kdr_scene_add_custom(scene, &balls, NULL), KDR_OK);
    assert_int_equal(kdr_scene_commit(scene, &def), KDR_OK);
    assert_int_equal(kdr_scene_cells(scene, count_trees, &with), KDR_OK);
    kdr_tree_stats stats;
    assert_int_equal(kdr_scene_stats(scene, &stats), KDR_OK);
    assert_true(with.roots[0] == 1 && with.roots[1] == 1 && !with.back);
    assert_true(with.leaves[0] == without.leaves[0] && with.leaves[0] + with.leaves[1] == stats.leaf_count);
    assert_true(with.references[1] >= BALLS && with.references[0] + with.references[1] == stats.reference_count);

    // A visitor that stops among the triangles sees nothing of the other tree.
    part_walk walk = {.past = UINT32_MAX, .stop_after = 1};
    assert_int_equal(kdr_scene_cells(scene, look, &walk), KDR_OK);
    assert_true(walk.shown == 1);
    kdr_scene_destroy(scene);
    soup_scene_destroy(&soup);
    kdr_device_destroy(device);
}

static void what_is_missing_is_refused(void **state) {
    (void)state;
    kdr_device *device = make_device();
    kdr_scene *scene;
    assert_int_equal(kdr_scene_create(device, &scene), KDR_OK);
    assert_int_equal(kdr_scene_cells(NULL, keep_only_cell, NULL), KDR_ERROR_INVALID_ARGUMENT);
    assert_int_equal(kdr_scene_cells(scene, NULL, NULL), KDR_ERROR_INVALID_ARGUMENT);
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
}

/* Workers that walk and trace one scene at once. */
typedef struct crowd {
    const kdr_scene *scene;
    uint64_t shown[8];
    bool wrong[8];
} crowd;

static void walk_and_trace(void *context, uint32_t index) {
    crowd *all = context;
    part_walk walk = {.past = UINT32_MAX};
    kdr_ray_hit ray = {.ray = {.origin_x = -10, .direction_x = 1, .tmax = INFINITY}};
    all->wrong[index] = kdr_scene_cells(all->scene, look, &walk) != KDR_OK;
    kdr_intersect1(all->scene, &ray);
    all->shown[index] = walk.shown;
}

static void threads_look_at_cells_while_others_trace_and_nothing_is_allocated(void **state) {
    (void)state;
    kdr_device *device = make_device();
    test_random random = test_random_start(test_random_seed(), 2);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), TRIANGLES);
    kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, NULL);
    kdr_device_trim(device);
    size_t bytes = kdr_device_bytes(device), peak = kdr_device_peak_bytes(device);
    crowd all = {.scene = scene};
    kdr_device_run(device, walk_and_trace, &all, 8);
    kdr_tree_stats stats;
    assert_int_equal(kdr_scene_stats(scene, &stats), KDR_OK);
    for (int i = 0; i < 8; i++)
        assert_true(!all.wrong[i] && all.shown[i] == stats.interior_count + stats.leaf_count);
    assert_true(kdr_device_bytes(device) == bytes && kdr_device_peak_bytes(device) == peak);
    kdr_scene_destroy(scene);
    soup_scene_destroy(&soup);
    kdr_device_destroy(device);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_cell_is_shown_before_those_inside_it_and_the_lower_side_first),
        cmocka_unit_test(a_visitor_goes_past_cells_and_stops_where_it_likes),
        cmocka_unit_test(a_scene_without_triangles_is_one_empty_leaf),
        cmocka_unit_test(custom_primitives_have_a_tree_of_their_own_after_the_triangles),
        cmocka_unit_test(what_is_missing_is_refused),
        cmocka_unit_test(threads_look_at_cells_while_others_trace_and_nothing_is_allocated),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
