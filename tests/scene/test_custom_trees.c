/* The trees of custom primitives: they ask whoever may be hit, are sound for boxes of any shape, are counted with those
 * of triangles, may be made of scenes, and stay where memory runs out. */
#include "support/customs.h"
#include "support/everywhere.h"
#include "support/failing_alloc.h"
#include "support/soup.h"
#include "support/test_size.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static kdr_device *device_of(uint32_t workers, const kdr_allocator *memory) {
    kdr_device_def def = kdr_default_device_def();
    def.worker_count = workers;
    if (memory)
        def.allocator = *memory;
    kdr_device *device;
    assert_int_equal(kdr_device_create(&def, &device), KDR_OK);
    return device;
}

static kdr_scene *scene_of(kdr_device *device) {
    kdr_scene *scene;
    assert_int_equal(kdr_scene_create(device, &scene), KDR_OK);
    return scene;
}

/* ---- who is asked, on boxes and rays of small whole numbers, where it can be said exactly who must be */

#define WHOLE_BOXES 250
#define WHOLE_RAYS TEST_SIZE(300)

typedef struct whole_boxes {
    int lo[WHOLE_BOXES][3], hi[WHOLE_BOXES][3];
    bool asked[WHOLE_BOXES];
} whole_boxes;

static void whole_bounds(uint32_t primitive, float lo[3], float hi[3], void *user) {
    const whole_boxes *boxes = user;
    for (int k = 0; k < 3; k++) {
        lo[k] = (float)boxes->lo[primitive][k];
        hi[k] = (float)boxes->hi[primitive][k];
    }
}

static bool whole_intersect(const kdr_ray *ray, uint32_t primitive, kdr_custom_hit *hit, void *user) {
    whole_boxes *boxes = user;
    (void)ray;
    (void)hit;
    boxes->asked[primitive] = true;
    return false;
}

/* True if some point of the closed box lies on the ray beyond its origin and no farther than tmax: near and far ends of
 * the three intervals are fractions with positive denominators, compared by cross multiplication. */
static bool whole_meet(const whole_boxes *boxes, int i, const int o[3], const int d[3], int tmax) {
    int near[4] = {0, 0, 0, 0}, far[4] = {0, 0, 0, tmax}, below[4] = {0, 0, 0, 1}; // the fourth: the ray's own
    for (int k = 0; k < 3; k++) {
        below[k] = abs(d[k]);
        near[k] = d[k] < 0 ? o[k] - boxes->hi[i][k] : boxes->lo[i][k] - o[k];
        far[k] = d[k] < 0 ? o[k] - boxes->lo[i][k] : boxes->hi[i][k] - o[k];
        if (d[k] == 0 && (near[k] > 0 || far[k] < 0))
            return false;
    }
    for (int a = 0; a < 4; a++) {
        if (below[a] > 0 && far[a] <= 0)
            return false;
        for (int b = 0; b < 4; b++)
            if (below[a] > 0 && below[b] > 0 && near[a] * below[b] > far[b] * below[a])
                return false;
    }
    return true;
}

static void every_primitive_is_asked_whose_closed_box_the_ray_meets(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 3);
    whole_boxes *boxes = test_allocate(1, sizeof *boxes);
    kdr_custom_def def = kdr_default_custom_def();
    def.primitive_count = WHOLE_BOXES;
    def.user = boxes;
    def.bounds = whole_bounds;
    def.intersect = whole_intersect;
    kdr_device *device = device_of(1, NULL);
    custom_plan plans[CUSTOM_PLANS];
    size_t met = 0, asked = 0, plan_count = custom_plans(plans);
    for (size_t plan = 0; plan < plan_count; plan++) {
        for (int i = 0; i < WHOLE_BOXES; i++) {
            for (int k = 0; k < 3; k++) { // a third is flat on each axis
                boxes->lo[i][k] = (int)test_random_below(&random, 13) - 6;
                boxes->hi[i][k] = boxes->lo[i][k] + (int)test_random_below(&random, 3);
            }
        }
        kdr_scene *scene = scene_of(device);
        assert_int_equal(kdr_scene_add_custom(scene, &def, NULL), KDR_OK);
        assert_int_equal(kdr_scene_commit(scene, &plans[plan].def), KDR_OK);
        for (int r = 0; r < WHOLE_RAYS; r++) {
            // Most go through a corner of a box, at the distance 1.
            int o[3], d[3], aim = (int)test_random_below(&random, WHOLE_BOXES), tmax = 1 + r % 3;
            for (int k = 0; k < 3; k++) {
                o[k] = (int)test_random_below(&random, 25) - 12;
                d[k] = (test_random_below(&random, 2) ? boxes->lo : boxes->hi)[aim][k] - o[k];
                if (r % 5 == 0)
                    d[k] = (int)test_random_below(&random, 3) - 1;
            }
            kdr_ray_hit ray = {.ray = {(float)o[0], (float)o[1], (float)o[2], 0, (float)d[0], (float)d[1], (float)d[2],
                                       0, (float)tmax, 0, 0, 0}};
            if (d[0] == 0 && d[1] == 0 && d[2] == 0)
                continue;
            for (int query = 0; query < 2; query++) {
                memset(boxes->asked, 0, sizeof boxes->asked);
                if (query == 0)
                    kdr_intersect1(scene, &ray);
                else
                    assert_false(kdr_occluded1(scene, &ray.ray));
                for (int i = 0; i < WHOLE_BOXES; i++) {
                    bool must = whole_meet(boxes, i, o, d, tmax);
                    if (must && !boxes->asked[i])
                        fail_msg("%s: box %d is not asked by the ray {%d, %d, %d} {%d, %d, %d} tmax %d",
                                 plans[plan].text, i, o[0], o[1], o[2], d[0], d[1], d[2], tmax);
                    met += must;
                    asked += boxes->asked[i];
                }
            }
        }
        kdr_scene_destroy(scene);
    }
    // Nobody is asked without need, but for those that are met at the origin alone.
    assert_true(met > (size_t)40 * WHOLE_RAYS && asked < met + met / 8);
    kdr_device_destroy(device);
    free(boxes);
}

static void boxes_without_volume_make_a_sound_tree_wherever_they_lie(void **state) {
    (void)state;
    enum { COUNT = 2000 };
    custom_shapes shapes = {.shapes = test_allocate(COUNT, sizeof(custom_shape)), .count = COUNT};
    kdr_device *device = device_of(1, NULL);
    custom_plan plans[CUSTOM_PLANS];
    size_t plan_count = custom_plans(plans);
    // Points in one place, on a line, in a plane, in space.
    for (uint32_t extents = 0; extents < 4; extents++) {
        for (uint32_t i = 0; i < COUNT; i++) {
            shapes.shapes[i] = (custom_shape){.kind = CUSTOM_POINT};
            for (uint32_t k = 0; k < extents; k++)
                shapes.shapes[i].centre[k] = (float)(i * (2 * k + 7) % 1009 % (k + 13));
        }
        for (size_t plan = 0; plan < plan_count; plan++) {
            kdr_scene *scene = scene_of(device);
            kdr_custom_def def = custom_shapes_def(&shapes, true);
            assert_int_equal(kdr_scene_add_custom(scene, &def, NULL), KDR_OK);
            assert_int_equal(kdr_scene_commit(scene, &plans[plan].def), KDR_OK);
            if (kdr_scene_verify(scene) != KDR_OK)
                fail_msg("%s: the tree is not sound", plans[plan].text);
            for (uint32_t i = 0; i < 13; i++) {
                // From a power of two away, so that the point is met exactly.
                const float *at = shapes.shapes[i].centre;
                kdr_ray ray = {at[0] - 4, at[1] - 8, at[2] + 4, 0, 1, 2, -1, 0, 4, 0, 0, 0};
                assert_true(kdr_occluded1(scene, &ray));
                ray.tmax = 3.99f;
                ray.origin_x += 0.001f;
                assert_false(kdr_occluded1(scene, &ray));
            }
            kdr_scene_destroy(scene);
        }
    }
    kdr_device_destroy(device);
    free(shapes.shapes);
}

static void statistics_and_bounds_are_of_both_trees(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 1);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), 700);
    custom_shapes shapes;
    custom_shapes_strew(&random, &shapes, 500, 0.1f);
    kdr_custom_def def = custom_shapes_def(&shapes, false);
    kdr_device *device = device_of(1, NULL);
    kdr_tree_stats stats[3];
    uint64_t hashes[3];
    float bounds[3][6];
    for (int i = 0; i < 3; i++) { // triangles, custom primitives, both
        kdr_scene *scene = scene_of(device);
        for (int g = 0; i != 1 && g < SOUP_GEOMETRIES; g++)
            assert_int_equal(kdr_scene_add_triangles(scene, &soup.geometries[g], NULL), KDR_OK);
        if (i != 0)
            assert_int_equal(kdr_scene_add_custom(scene, &def, NULL), KDR_OK);
        assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
        assert_int_equal(kdr_scene_stats(scene, &stats[i]), KDR_OK);
        kdr_scene_bounds(scene, bounds[i]);
        hashes[i] = kdr_scene_hash(scene);
        kdr_scene_destroy(scene);
    }
    const kdr_tree_stats *a = &stats[0], *b = &stats[1], *sum = &stats[2];
    assert_true(a->custom_count == 0 && a->triangle_count > 600 && b->custom_count == 500 && b->triangle_count == 0);
    assert_true(sum->custom_count == 500 && sum->triangle_count == a->triangle_count);
    // The scene without triangles has a tree of them: one empty leaf.
    assert_int_equal(sum->leaf_count, a->leaf_count + b->leaf_count - 1);
    assert_int_equal(sum->empty_leaf_count, a->empty_leaf_count + b->empty_leaf_count - 1);
    assert_int_equal(sum->interior_count, a->interior_count + b->interior_count);
    assert_int_equal(sum->interior_count + 2, sum->leaf_count);
    assert_int_equal(sum->reference_count, a->reference_count + b->reference_count);
    assert_true(sum->reference_count >= sum->triangle_count + sum->custom_count);
    assert_int_equal(sum->depth, a->depth > b->depth ? a->depth : b->depth);
    assert_int_equal(sum->largest_leaf, a->largest_leaf > b->largest_leaf ? a->largest_leaf : b->largest_leaf);
    assert_true(fabs(sum->cost - a->cost - b->cost) <= 1e-9 * sum->cost);
    uint64_t leaves = 0, depths = 0;
    for (uint64_t i = 0; i < KDR_HISTOGRAM_SIZE; i++) {
        leaves += sum->leaf_histogram[i];
        depths += i * sum->depth_histogram[i];
    }
    assert_int_equal(leaves, sum->leaf_count);
    assert_true(fabs(sum->mean_leaf_depth * (double)leaves - (double)depths) < 1e-6 * (double)depths);
    assert_true(sum->node_bytes > a->node_bytes && sum->leaf_bytes >= a->leaf_bytes + 500 * 28);
    for (int k = 0; k < 3; k++) {
        assert_true(bounds[2][k] == fminf(bounds[0][k], bounds[1][k]));
        assert_true(bounds[2][k + 3] == fmaxf(bounds[0][k + 3], bounds[1][k + 3]));
    }
    assert_true(hashes[0] != hashes[1] && hashes[1] != hashes[2] && hashes[0] != hashes[2]);
    kdr_device_destroy(device);
    free(shapes.shapes);
    soup_scene_destroy(&soup);
}

/* ---- a scene as a primitive of another */

typedef struct placed_scene {
    const kdr_scene *scene;
    float place[3];
} placed_scene;

static void placed_bounds(uint32_t primitive, float lo[3], float hi[3], void *user) {
    const placed_scene *placed = &((const placed_scene *)user)[primitive];
    float bounds[6];
    kdr_scene_bounds(placed->scene, bounds);
    for (int k = 0; k < 3; k++) {
        lo[k] = bounds[k] + placed->place[k];
        hi[k] = bounds[k + 3] + placed->place[k];
    }
}

static bool placed_intersect(const kdr_ray *ray, uint32_t primitive, kdr_custom_hit *hit, void *user) {
    const placed_scene *placed = &((const placed_scene *)user)[primitive];
    kdr_ray_hit inner = {.ray = *ray};
    inner.ray.origin_x -= placed->place[0];
    inner.ray.origin_y -= placed->place[1];
    inner.ray.origin_z -= placed->place[2];
    kdr_intersect1(placed->scene, &inner);
    *hit = (kdr_custom_hit){.t = inner.ray.tmax, .u = inner.hit.u, .v = inner.hit.v};
    return inner.hit.geometry != KDR_INVALID_ID;
}

static void a_primitive_may_be_a_scene_of_its_own(void **state) {
    (void)state;
    enum { COPIES = 27 };
    static const float square[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0};
    kdr_triangles_def triangles = kdr_default_triangles_def();
    triangles.vertices = square;
    triangles.vertex_count = 6;
    triangles.triangle_count = 2;
    kdr_device *device = device_of(1, NULL);
    kdr_scene *inner = committed_scene(device, &triangles, 1, NULL), *outer = scene_of(device);
    placed_scene placed[COPIES];
    for (int i = 0; i < COPIES; i++)
        placed[i] = (placed_scene){inner, {(float)(i % 3 * 2), (float)(i / 3 % 3 * 2), (float)(i / 9 * 2)}};
    kdr_custom_def def = kdr_default_custom_def();
    def.primitive_count = COPIES;
    def.user = placed;
    def.bounds = placed_bounds;
    def.intersect = placed_intersect;
    assert_int_equal(kdr_scene_add_custom(outer, &def, NULL), KDR_OK);
    assert_int_equal(kdr_scene_commit(outer, NULL), KDR_OK);
    for (int i = 0; i < COPIES; i++) {
        const float *at = placed[i].place;
        kdr_ray_hit ray = {.ray = {at[0] + 0.75f, at[1] + 0.25f, at[2] - 1, 0, 0, 0, 1, 0, INFINITY, 0, 0, 0}};
        kdr_intersect1(outer, &ray);
        assert_true(ray.hit.primitive == (uint32_t)i && ray.ray.tmax == 1);
        assert_true(ray.hit.u == 0.5f && ray.hit.v == 0.25f);
        ray.ray.origin_x += 1;
        assert_false(kdr_occluded1(outer, &ray.ray));
    }
    kdr_scene_destroy(outer);
    kdr_scene_destroy(inner);
    kdr_device_destroy(device);
}

/* ---- memory */

static void every_allocation_of_a_commit_may_fail_and_the_old_trees_stay(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 2);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), 3000);
    custom_shapes old, new;
    custom_shapes_strew(&random, &old, 300, 0.1f);
    custom_shapes_strew(&random, &new, 20000, 0.03f);
    kdr_custom_def old_def = custom_shapes_def(&old, false), new_def = custom_shapes_def(&new, true);
    for (uint64_t n = 0, new_hash = 0;; n++) {
        failing_alloc memory;
        failing_alloc_init(&memory);
        kdr_allocator functions = failing_alloc_functions(&memory);
        kdr_device *device = device_of(1 + (uint32_t)(n % 2), &functions);
        kdr_scene *scene = scene_of(device);
        for (int g = 0; g < SOUP_GEOMETRIES; g++)
            assert_int_equal(kdr_scene_add_triangles(scene, &soup.geometries[g], NULL), KDR_OK);
        assert_int_equal(kdr_scene_add_custom(scene, &old_def, NULL), KDR_OK);
        assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
        kdr_device_trim(device);
        uint64_t old_hash = kdr_scene_hash(scene);
        assert_int_equal(kdr_scene_set_custom(scene, SOUP_GEOMETRIES, &new_def), KDR_OK);
        failing_alloc_fail_nth(&memory, n);
        kdr_status status = kdr_scene_commit(scene, NULL);
        bool failed = memory.failures > 0;
        assert_int_equal(status, failed ? KDR_ERROR_OUT_OF_MEMORY : KDR_OK);
        failing_alloc_fail_nth(&memory, 0);
        if (failed) {
            assert_true(kdr_scene_hash(scene) == old_hash);
            assert_int_equal(kdr_scene_verify(scene), KDR_OK);
            kdr_ray ray = {.direction_z = 1, .origin_z = -9, .tmax = 99};
            uint64_t calls = new.intersect_calls + new.occluded_calls;
            kdr_occluded1(scene, &ray);
            assert_true(new.intersect_calls + new.occluded_calls == calls);
            assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
        }
        assert_true(n == 0 || kdr_scene_hash(scene) == new_hash);
        new_hash = kdr_scene_hash(scene);
        assert_true(new_hash != old_hash);
        kdr_scene_destroy(scene);
        kdr_device_destroy(device);
        assert_true(failing_alloc_is_clean(&memory));
        if (n > 0 && !failed) {
            assert_true(n > 10);
            break;
        }
    }
    free(old.shapes);
    free(new.shapes);
    soup_scene_destroy(&soup);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_primitive_is_asked_whose_closed_box_the_ray_meets),
        cmocka_unit_test(boxes_without_volume_make_a_sound_tree_wherever_they_lie),
        cmocka_unit_test(statistics_and_bounds_are_of_both_trees),
        cmocka_unit_test(a_primitive_may_be_a_scene_of_its_own),
        cmocka_unit_test(every_allocation_of_a_commit_may_fail_and_the_old_trees_stay),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
