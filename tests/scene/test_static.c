/* Static triangles: a tree of their own that a commit leaves alone, and answers as if there were one tree. */
#include "scene/scene.h"
#include "support/awkward_rays.h"
#include "support/everywhere.h"
#include "support/failing_alloc.h"
#include "support/soup.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { RAYS = 300, POINTS = 30, CASES = 15 };

/* The geometries of a soup, those whose bit is set static. */
static kdr_scene *mixed_scene(kdr_device *device, const soup_scene *soup, uint32_t statics, const kdr_build_def *plan,
                              const kdr_scene_def *def) {
    kdr_scene *scene;
    assert_int_equal(kdr_scene_create_with(device, def, &scene), KDR_OK);
    for (uint32_t g = 0; g < SOUP_GEOMETRIES; g++) {
        kdr_triangles_def triangles = soup->geometries[g];
        triangles.is_static = statics >> g & 1;
        assert_int_equal(kdr_scene_add_triangles(scene, &triangles, NULL), KDR_OK);
    }
    assert_int_equal(kdr_scene_commit(scene, plan), KDR_OK);
    assert_int_equal(kdr_scene_verify(scene), KDR_OK);
    return scene;
}

/* Numbers of what was found, by the order of visits of a tree that may be another one. */
typedef struct visited {
    uint64_t sum, count;
} visited;

static bool add_visit(const kdr_point_hit *hit, void *user) {
    visited *v = user;
    v->sum += (hit->geometry + 1) * 1000003ull + hit->primitive * 7919ull;
    v->count++;
    return true;
}

static bool stop_at_once(const kdr_point_hit *hit, void *user) {
    (void)hit;
    ++*(uint32_t *)user;
    return false;
}

static void hold_points_alike(const kdr_scene *a, const kdr_scene *b, test_random *random) {
    float bounds[6];
    kdr_scene_bounds(a, bounds);
    for (int i = 0; i < POINTS; i++) {
        float size = bounds[3] - bounds[0];
        kdr_point_query query = {test_random_between(random, bounds[0], bounds[3]),
                                 test_random_between(random, bounds[1], bounds[4]),
                                 test_random_between(random, bounds[2], bounds[5]), 0,
                                 i % 3 == 0 ? INFINITY : test_random_between(random, 0, 0.1f * size)};
        kdr_point_hit hits[2];
        memset(hits, 0, sizeof hits);
        assert_int_equal(kdr_closest_point(a, &query, &hits[0]), kdr_closest_point(b, &query, &hits[1]));
        assert_memory_equal(&hits[0], &hits[1], sizeof hits[0]);
        visited all[2] = {{0, 0}, {0, 0}};
        assert_int_equal(kdr_primitives_within(a, &query, add_visit, &all[0]),
                         kdr_primitives_within(b, &query, add_visit, &all[1]));
        assert_memory_equal(&all[0], &all[1], sizeof all[0]);
        uint32_t calls = 0;
        size_t told = kdr_primitives_within(b, &query, stop_at_once, &calls);
        assert_int_equal(told, calls);
        assert_int_equal(calls, all[1].count > 0);
    }
}

static void static_and_dynamic_triangles_answer_as_one_tree(void **state) {
    (void)state;
    static const char *const kinds[] = {"small", "boxes", "plane", "mixed scales", "any bits"};
    static const char *const plans[] = {"", "split=space trace=stack", "split=object trace=restart"};
    for (size_t kind = 0; kind < sizeof kinds / sizeof *kinds; kind++) {
        test_random random = test_random_start(test_random_seed(), 7000 + kind);
        const soup_kind *of = soup_kind_find(kinds[kind]);
        const size_t count = of->is_exact ? RAYS / 10 : RAYS;
        soup_scene soup = soup_scene_create_kind(&random, of, 300);
        oracle_scene oracle = oracle_scene_create(soup.geometries, SOUP_GEOMETRIES);
        oracle_tree tree = oracle_tree_create(&oracle);
        kdr_ray *rays = awkward_rays_create(&random, &tree, count);
        query_sheet sheet = query_sheet_create(&tree, rays, count);
        for (uint32_t i = 0; i < CASES; i++) {
            kdr_isa isa = (kdr_isa)(i % (KDR_ISA_NEON + 1));
            kdr_device *device = device_of_isa(isa, 1, NULL);
            if (!device)
                continue;
            kdr_build_def plan;
            kdr_scene_def def = kdr_default_scene_def();
            assert_int_equal(kdr_build_def_parse(plans[i % 3], &plan, NULL, 0), KDR_OK);
            assert_int_equal(kdr_build_def_parse(plans[(i + i / 4) % 3], &def.static_build, NULL, 0), KDR_OK);
            def.double_buffered = i & 1;
            uint32_t statics = test_random_below(&random, 16);
            char label[100];
            snprintf(label, sizeof label, "%s, %s, static geometries 0x%x", kinds[kind], kdr_isa_name(isa), statics);
            kdr_scene *one = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, NULL);
            kdr_scene *scene = mixed_scene(device, &soup, statics, &plan, &def);
            assert_int_equal(query_sheet_differences(&sheet, scene, label), 0);
            hold_points_alike(one, scene, &random);
            kdr_scene_destroy(scene);
            kdr_scene_destroy(one);
            kdr_device_destroy(device);
        }
        query_sheet_destroy(&sheet);
        free(rays);
        oracle_tree_destroy(&tree);
        oracle_scene_destroy(&oracle);
        soup_scene_destroy(&soup);
    }
}

/* A soup of which geometry 0 is static, its arrays in memory that a test may spoil. */
typedef struct standing {
    kdr_device *device;
    kdr_scene *scene;
    float vertices[2][9];
} standing;

static const float wall[9] = {-1, -1, 1, 1, -1, 1, 0, 1, 1}, leaf[9] = {-1, -1, 0, 1, -1, 0, 0, 1, 0};

static kdr_triangles_def one_triangle(const float *vertices, bool is_static) {
    kdr_triangles_def def = kdr_default_triangles_def();
    def.vertices = vertices;
    def.vertex_count = 3;
    def.triangle_count = 1;
    def.is_static = is_static;
    return def;
}

static void open_standing(standing *s) {
    memcpy(s->vertices[0], wall, sizeof wall);
    memcpy(s->vertices[1], leaf, sizeof leaf);
    assert_int_equal(kdr_device_create(NULL, &s->device), KDR_OK);
    assert_int_equal(kdr_scene_create(s->device, &s->scene), KDR_OK);
    for (uint32_t g = 0; g < 2; g++) {
        kdr_triangles_def def = one_triangle(s->vertices[g], g == 0);
        assert_int_equal(kdr_scene_add_triangles(s->scene, &def, NULL), KDR_OK);
    }
    assert_int_equal(kdr_scene_commit(s->scene, NULL), KDR_OK);
}

static void close_standing(standing *s) {
    kdr_scene_destroy(s->scene);
    kdr_device_destroy(s->device);
}

/* What a ray from -z meets, and where. */
static uint32_t ask(const kdr_scene *scene, float *t) {
    kdr_ray_hit hit = {.ray = {.origin_z = -4, .direction_z = 1, .tmax = INFINITY}};
    kdr_intersect1(scene, &hit);
    *t = hit.ray.tmax;
    return hit.hit.geometry;
}

static void hold_hit(const kdr_scene *scene, uint32_t geometry, float t) {
    float given;
    assert_int_equal(ask(scene, &given), geometry);
    assert_true(given == t);
}

static void move_to(float *vertices, float z) { vertices[2] = vertices[5] = vertices[8] = z; }

static void a_commit_does_not_look_at_static_triangles_that_nobody_touched(void **state) {
    (void)state;
    standing s;
    open_standing(&s);
    hold_hit(s.scene, 1, 4);
    const kdr_part *part = s.scene->shown->static_part;
    memset(s.vertices[0], 0xff, sizeof s.vertices[0]); /* all NaN */
    for (int i = 0; i < 20; i++) {
        float z = i % 2 == 0 ? 2 : -1;
        move_to(s.vertices[1], z);
        assert_int_equal(kdr_scene_touch(s.scene, 1), KDR_OK);
        assert_int_equal(kdr_scene_commit(s.scene, NULL), KDR_OK);
        assert_ptr_equal(s.scene->shown->static_part, part);
        hold_hit(s.scene, z > 1 ? 0 : 1, z > 1 ? 5 : z + 4);
    }
    kdr_tree_stats stats;
    assert_int_equal(kdr_scene_stats(s.scene, &stats), KDR_OK);
    assert_int_equal(stats.static_count, 1);
    assert_int_equal(stats.triangle_count, 2);
    assert_int_equal(stats.dropped_count, 0);

    /* Touched, it is read again. */
    assert_int_equal(kdr_scene_touch(s.scene, 0), KDR_OK);
    assert_int_equal(kdr_scene_commit(s.scene, NULL), KDR_OK);
    assert_int_equal(kdr_scene_stats(s.scene, &stats), KDR_OK);
    assert_int_equal(stats.triangle_count, 1);
    assert_int_equal(stats.dropped_count, 1);
    close_standing(&s);
}

static void a_commit_does_not_look_at_dynamic_triangles_when_only_static_ones_changed(void **state) {
    (void)state;
    standing s;
    open_standing(&s);
    const kdr_part *part = s.scene->shown->dynamic_part;
    memset(s.vertices[1], 0xff, sizeof s.vertices[1]);
    move_to(s.vertices[0], -2);
    assert_int_equal(kdr_scene_touch(s.scene, 0), KDR_OK);
    assert_int_equal(kdr_scene_commit(s.scene, NULL), KDR_OK);
    assert_ptr_equal(s.scene->shown->dynamic_part, part);
    hold_hit(s.scene, 0, 2);
    close_standing(&s);
}

static void a_geometry_may_become_static_and_dynamic_again(void **state) {
    (void)state;
    standing s;
    open_standing(&s);
    for (uint32_t i = 0; i < 8; i++) {
        kdr_tree_stats stats;
        for (uint32_t g = 0; g < 2; g++) {
            kdr_triangles_def def = one_triangle(s.vertices[g], (i >> g & 1) != 0);
            assert_int_equal(kdr_scene_set_triangles(s.scene, g, &def), KDR_OK);
        }
        move_to(s.vertices[i & 1], (float)i - 3);
        assert_int_equal(kdr_scene_commit(s.scene, NULL), KDR_OK);
        assert_int_equal(kdr_scene_stats(s.scene, &stats), KDR_OK);
        assert_int_equal(stats.static_count, (i & 1) + (i >> 1 & 1));
        uint32_t first = s.vertices[0][2] <= s.vertices[1][2] ? 0 : 1;
        hold_hit(s.scene, first, s.vertices[first][2] + 4);
    }
    close_standing(&s);
}

static void of_hits_at_one_distance_the_lowest_geometry_wins_in_whichever_tree(void **state) {
    (void)state;
    for (uint32_t statics = 0; statics < 16; statics++) {
        kdr_device *device;
        kdr_scene *scene;
        assert_int_equal(kdr_device_create(NULL, &device), KDR_OK);
        assert_int_equal(kdr_scene_create(device, &scene), KDR_OK);
        for (uint32_t g = 0; g < 4; g++) {
            kdr_triangles_def def = one_triangle(wall, statics >> g & 1);
            assert_int_equal(kdr_scene_add_triangles(scene, &def, NULL), KDR_OK);
        }
        assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
        hold_hit(scene, 0, 5);
        kdr_point_query query = {.z = -4, .radius = INFINITY};
        kdr_point_hit point;
        assert_true(kdr_closest_point(scene, &query, &point));
        assert_int_equal(point.geometry, 0);
        kdr_scene_destroy(scene);
        kdr_device_destroy(device);
    }
}

typedef struct cells {
    uint32_t statics, customs, others;
} cells;

static kdr_cell_step count_cell(const kdr_cell *cell, void *user) {
    cells *c = user;
    *(cell->is_static ? &c->statics : cell->is_custom ? &c->customs : &c->others) += cell->depth == 0;
    return KDR_CELL_INTO;
}

static void cells_bounds_and_hash_are_of_both_trees(void **state) {
    (void)state;
    standing s;
    open_standing(&s);
    cells count = {0};
    assert_int_equal(kdr_scene_cells(s.scene, count_cell, &count), KDR_OK);
    assert_int_equal(count.statics, 1);
    assert_int_equal(count.others, 1);
    assert_int_equal(count.customs, 0);
    float bounds[6];
    kdr_scene_bounds(s.scene, bounds);
    assert_true(bounds[2] == 0 && bounds[5] == 1);
    uint64_t hash = kdr_scene_hash(s.scene);
    move_to(s.vertices[0], 3);
    kdr_scene_touch(s.scene, 0);
    assert_int_equal(kdr_scene_commit(s.scene, NULL), KDR_OK);
    assert_true(kdr_scene_hash(s.scene) != hash);
    close_standing(&s);
}

static void a_failed_commit_keeps_both_old_trees_and_the_next_one_works(void **state) {
    (void)state;
    failing_alloc memory;
    failing_alloc_init(&memory);
    kdr_allocator functions = failing_alloc_functions(&memory);
    uint64_t failures = 0;
    for (uint64_t n = 1; failures == n - 1; n++) {
        kdr_device *device = device_of_isa(KDR_ISA_SCALAR, 1, &functions);
        float vertices[2][9];
        memcpy(vertices[0], wall, sizeof wall);
        memcpy(vertices[1], leaf, sizeof leaf);
        kdr_triangles_def defs[2] = {one_triangle(vertices[0], true), one_triangle(vertices[1], false)};
        kdr_scene *scene = committed_scene(device, defs, 2, NULL);
        uint64_t hash = kdr_scene_hash(scene);
        for (uint32_t g = 0; g < 2; g++) {
            move_to(vertices[g], 7 + (float)g);
            kdr_scene_touch(scene, g);
        }
        kdr_device_trim(device);
        failing_alloc_fail_nth(&memory, n);
        kdr_status status = kdr_scene_commit(scene, NULL);
        failures += memory.failures > 0;
        failing_alloc_fail_nth(&memory, 0);
        if (status != KDR_OK) {
            assert_int_equal(status, KDR_ERROR_OUT_OF_MEMORY);
            assert_true(kdr_scene_hash(scene) == hash);
            hold_hit(scene, 1, 4);
            assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
        }
        hold_hit(scene, 0, 11);
        kdr_scene_destroy(scene);
        kdr_device_destroy(device);
    }
    assert_true(failures > 5);
    assert_true(failing_alloc_is_clean(&memory));
}

static void a_scene_def_that_is_not_sound_is_an_error(void **state) {
    (void)state;
    kdr_device *device;
    kdr_scene *scene;
    assert_int_equal(kdr_device_create(NULL, &device), KDR_OK);
    kdr_scene_def def = {0};
    assert_int_equal(kdr_scene_create_with(device, &def, &scene), KDR_ERROR_INVALID_ARGUMENT);
    assert_null(scene);
    def = kdr_default_scene_def();
    def.static_build.cost_traversal = -1;
    assert_int_equal(kdr_scene_create_with(device, &def, &scene), KDR_ERROR_INVALID_ARGUMENT);
    assert_int_equal(kdr_scene_create_with(device, NULL, NULL), KDR_ERROR_INVALID_ARGUMENT);
    assert_int_equal(kdr_scene_create_with(NULL, NULL, &scene), KDR_ERROR_INVALID_ARGUMENT);
    kdr_device_destroy(device);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(static_and_dynamic_triangles_answer_as_one_tree),
        cmocka_unit_test(a_commit_does_not_look_at_static_triangles_that_nobody_touched),
        cmocka_unit_test(a_commit_does_not_look_at_dynamic_triangles_when_only_static_ones_changed),
        cmocka_unit_test(a_geometry_may_become_static_and_dynamic_again),
        cmocka_unit_test(of_hits_at_one_distance_the_lowest_geometry_wins_in_whichever_tree),
        cmocka_unit_test(cells_bounds_and_hash_are_of_both_trees),
        cmocka_unit_test(a_failed_commit_keeps_both_old_trees_and_the_next_one_works),
        cmocka_unit_test(a_scene_def_that_is_not_sound_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
