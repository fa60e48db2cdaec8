/* kdr_cost1 counts the cells that a ray passes up to its closest hit, no more and no less, by every builder. */
#include "support/everywhere.h"
#include "support/soup.h"
#include "support/test_size.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* What a walk over all cells makes of one ray: cells that it passes for sure, and those that it may pass. */
typedef struct cell_count {
    kdr_ray ray;
    kdr_ray_cost least, most;
} cell_count;

/* The interval of a ray in a box that is larger by `room` on every side; false if it misses the box. */
static bool passes(const kdr_ray *ray, const float bounds[6], double room) {
    const float origin[3] = {ray->origin_x, ray->origin_y, ray->origin_z};
    const float direction[3] = {ray->direction_x, ray->direction_y, ray->direction_z};
    double enter = ray->tmin, leave = ray->tmax;
    for (int k = 0; k < 3; k++) {
        double below = (double)bounds[k] - room - (double)origin[k];
        double above = (double)bounds[k + 3] + room - (double)origin[k];
        if (direction[k] == 0) {
            if (below > 0 || above < 0)
                return false;
            continue;
        }
        double a = below / (double)direction[k], b = above / (double)direction[k];
        enter = fmax(enter, fmin(a, b));
        leave = fmin(leave, fmax(a, b));
    }
    return enter <= leave;
}

static void add_cell(kdr_ray_cost *cost, const kdr_cell *cell) {
    cost->nodes++;
    cost->leaves += cell->is_leaf;
    cost->primitives += cell->primitive_count;
}

static kdr_cell_step count_cell(const kdr_cell *cell, void *user) {
    cell_count *count = user;
    if (!passes(&count->ray, cell->bounds, 1e-6))
        return KDR_CELL_PAST;
    add_cell(&count->most, cell);
    if (passes(&count->ray, cell->bounds, -1e-6))
        add_cell(&count->least, cell);
    return KDR_CELL_INTO;
}

static kdr_ray any_ray(test_random *random) {
    kdr_ray ray = {.tmax = INFINITY};
    float *origin = &ray.origin_x, *direction = &ray.direction_x;
    for (int k = 0; k < 3; k++) {
        origin[k] = 3 * test_random_float(random) - 1;
        direction[k] = 2 * test_random_float(random) - 1;
    }
    return ray;
}

static void a_ray_costs_the_cells_that_it_passes_up_to_its_hit(void **state) {
    (void)state;
    static const char *const plans[] = {"",
                                        "split=space",
                                        "split=object leaf-limit=1",
                                        "quality=best",
                                        "trace=restart mailbox=8",
                                        "split=sweep events=3"};
    kdr_device *device;
    assert_int_equal(kdr_device_create(NULL, &device), KDR_OK);
    test_random random = test_random_start(test_random_seed(), 3);
    uint64_t hits = 0, exact = 0, asked = 0;
    for (size_t p = 0; p < sizeof plans / sizeof plans[0]; p++) {
        soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), 3000);
        soup.geometries[p % SOUP_GEOMETRIES].is_static = true;
        kdr_build_def def;
        assert_int_equal(kdr_build_def_parse(plans[p], &def, NULL, 0), KDR_OK);
        kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, &def);
        for (int i = 0; i < TEST_SIZE(2000); i++) {
            kdr_ray ray = any_ray(&random);
            kdr_ray_hit hit = {.ray = ray};
            kdr_intersect1(scene, &hit);
            cell_count count = {.ray = hit.ray};
            assert_int_equal(kdr_scene_cells(scene, count_cell, &count), KDR_OK);
            kdr_ray_cost cost;
            kdr_cost1(scene, &ray, &cost);
            assert_in_range(cost.nodes, count.least.nodes, count.most.nodes);
            assert_in_range(cost.leaves, count.least.leaves, count.most.leaves);
            assert_in_range(cost.primitives, count.least.primitives, count.most.primitives);
            hits += hit.hit.geometry != KDR_INVALID_ID;
            exact += count.least.nodes == count.most.nodes;
            asked++;
        }
        kdr_scene_destroy(scene);
        soup_scene_destroy(&soup);
    }
    // The bounds are narrow, and the rays are of both kinds.
    assert_true(exact > asked * 9 / 10);
    assert_true(hits > asked / 100 && hits < asked);
    kdr_device_destroy(device);
}

static void what_passes_every_tree_by_costs_nothing(void **state) {
    (void)state;
    kdr_device *device;
    assert_int_equal(kdr_device_create(NULL, &device), KDR_OK);
    test_random random = test_random_start(test_random_seed(), 4);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), 500);
    kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, NULL), *nothing;
    assert_int_equal(kdr_scene_create(device, &nothing), KDR_OK);
    float bounds[6];
    kdr_scene_bounds(scene, bounds);
    kdr_ray through = {.origin_x = (bounds[0] + bounds[3]) / 2,
                       .origin_y = (bounds[1] + bounds[4]) / 2,
                       .origin_z = bounds[2] - 1,
                       .direction_z = 1,
                       .tmax = INFINITY};
    kdr_ray aside = through, short_of_it = through, invalid = through;
    aside.origin_x = bounds[3] + 1;
    short_of_it.tmax = 0.5f;
    invalid.direction_z = NAN;
    kdr_ray_cost cost;
    kdr_cost1(scene, &through, &cost);
    assert_true(cost.nodes > 0 && cost.leaves > 0);
    const kdr_ray *const free_rays[] = {&aside, &short_of_it, &invalid};
    for (size_t i = 0; i < 3; i++) {
        kdr_cost1(scene, free_rays[i], &cost);
        assert_int_equal(cost.nodes + cost.leaves + cost.primitives, 0);
    }
    kdr_cost1(nothing, &through, &cost);
    assert_int_equal(cost.nodes + cost.leaves + cost.primitives, 0);
    kdr_scene_destroy(nothing);
    kdr_scene_destroy(scene);
    soup_scene_destroy(&soup);
    kdr_device_destroy(device);
}

/* Custom primitives: boxes of a row along x. */
static void row_bounds(uint32_t primitive, float lo[3], float hi[3], void *user) {
    (void)user;
    for (int k = 0; k < 3; k++) {
        lo[k] = k == 0 ? (float)(2 * primitive) : 0;
        hi[k] = lo[k] + 1;
    }
}

static bool miss(const kdr_ray *ray, uint32_t primitive, kdr_custom_hit *hit, void *user) {
    (void)ray;
    (void)primitive;
    (void)hit;
    (void)user;
    return false;
}

static void custom_primitives_count_too(void **state) {
    (void)state;
    kdr_device *device;
    kdr_scene *scene;
    assert_int_equal(kdr_device_create(NULL, &device), KDR_OK);
    assert_int_equal(kdr_scene_create(device, &scene), KDR_OK);
    kdr_custom_def def = kdr_default_custom_def();
    def.primitive_count = 64;
    def.bounds = row_bounds;
    def.intersect = miss;
    assert_int_equal(kdr_scene_add_custom(scene, &def, NULL), KDR_OK);
    assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
    kdr_ray along = {.origin_x = -1, .origin_y = 0.5f, .origin_z = 0.5f, .direction_x = 1, .tmax = INFINITY};
    kdr_ray_cost cost;
    kdr_cost1(scene, &along, &cost);
    assert_true(cost.primitives >= 64 && cost.leaves >= 1 && cost.nodes >= cost.leaves);
    along.tmax = 10;
    kdr_ray_cost part;
    kdr_cost1(scene, &along, &part);
    assert_true(part.primitives >= 5 && part.primitives <= cost.primitives && part.nodes <= cost.nodes);
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ray_costs_the_cells_that_it_passes_up_to_its_hit),
        cmocka_unit_test(what_passes_every_tree_by_costs_nothing),
        cmocka_unit_test(custom_primitives_count_too),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
