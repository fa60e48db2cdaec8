/* What single scenes are for: closed surfaces, motion, copies, planes and triangles without area. */
#include "kdray/render.h"
#include "scenes/scenes.h"
#include "support/test_size.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static kdr_mesh *make(const char *name, size_t triangle_count, double time) {
    kdr_mesh *mesh = NULL;
    assert_int_equal(kdr_mesh_make(name, triangle_count, time, NULL, &mesh), KDR_OK);
    return mesh;
}

static const float *corner_of(const kdr_mesh *mesh, size_t triangle, int corner) {
    return mesh->positions + 3 * (size_t)mesh->indices[3 * triangle + (size_t)corner];
}

static int compare_edges(const void *a, const void *b) {
    uint64_t left = *(const uint64_t *)a, right = *(const uint64_t *)b;
    return left < right ? -1 : left > right;
}

/* An edge is closed when it is there once in each direction. Direction is the lowest bit of the key. */
static void check_closed(const kdr_mesh *mesh, const char *name) {
    size_t count = 3 * mesh->triangle_count;
    uint64_t *edges = malloc(count * sizeof *edges);
    assert_non_null(edges);
    for (size_t i = 0; i < count; i++) {
        uint64_t from = mesh->indices[i], to = mesh->indices[i % 3 == 2 ? i - 2 : i + 1];
        assert_int_not_equal(from, to);
        edges[i] = from < to ? from << 32 | to << 1 : to << 32 | from << 1 | 1;
    }
    qsort(edges, count, sizeof *edges, compare_edges);
    size_t open = count % 2;
    for (size_t i = 0; i + 1 < count; i += 2)
        open += edges[i] + 1 != edges[i + 1] || (i > 0 && edges[i] <= edges[i - 1]);
    free(edges);
    if (open)
        fail_msg("%s: %zu edges are not shared by exactly two triangles in opposite directions", name, open);
}

/* Six times the volume is positive when the surface faces outwards. */
static double volume(const kdr_mesh *mesh) {
    double sum = 0;
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const float *a = corner_of(mesh, i, 0), *b = corner_of(mesh, i, 1), *c = corner_of(mesh, i, 2);
        sum += a[0] * ((double)b[1] * c[2] - (double)b[2] * c[1]) + a[1] * ((double)b[2] * c[0] - (double)b[0] * c[2]) +
               a[2] * ((double)b[0] * c[1] - (double)b[1] * c[0]);
    }
    return sum;
}

static void closed_scenes_are_closed_and_face_outwards(void **state) {
    (void)state;
    static const size_t sizes[] = {100, 137, 1000, 10000, TEST_SIZE(100000)};
    int closed = 0;
    for (size_t i = 0; kdr_recipe_at(i); i++) {
        const kdr_recipe *recipe = kdr_recipe_at(i);
        if (!(recipe->traits & KDR_SCENE_CLOSED))
            continue;
        closed++;
        for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
            kdr_mesh *mesh = make(recipe->name, sizes[k], 0);
            check_closed(mesh, recipe->name);
            assert_true(volume(mesh) > 0);
            kdr_mesh_destroy(mesh);
        }
    }
    assert_true(closed >= 4);
}

static void moving_scenes_move_and_stay_finite_at_any_time(void **state) {
    (void)state;
    static const double times[] = {-1, 0, 0.5, 1, 1e6, -1e6, DBL_MAX};
    int moving = 0;
    for (size_t i = 0; kdr_recipe_at(i); i++) {
        const kdr_recipe *recipe = kdr_recipe_at(i);
        if (!(recipe->traits & KDR_SCENE_MOVING))
            continue;
        moving++;
        kdr_mesh *still = make(recipe->name, 2000, 0.2);
        for (size_t k = 0; k < sizeof times / sizeof times[0]; k++) {
            kdr_mesh *mesh = make(recipe->name, 2000, times[k]);
            assert_int_equal(mesh->triangle_count, still->triangle_count);
            assert_int_equal(mesh->vertex_count, still->vertex_count);
            assert_memory_equal(mesh->indices, still->indices, 3 * sizeof(uint32_t) * mesh->triangle_count);
            assert_memory_not_equal(mesh->positions, still->positions, 3 * sizeof(float) * mesh->vertex_count);
            for (size_t v = 0; v < 3 * mesh->vertex_count; v++)
                assert_true(fabsf(mesh->positions[v]) < 1000);
            kdr_mesh_destroy(mesh);
        }
        kdr_mesh_destroy(still);
    }
    assert_true(moving >= 4);
}

static void still_scenes_are_the_same_at_any_time(void **state) {
    (void)state;
    for (size_t i = 0; kdr_recipe_at(i); i++) {
        const kdr_recipe *recipe = kdr_recipe_at(i);
        if (recipe->traits & KDR_SCENE_MOVING)
            continue;
        kdr_mesh *now = make(recipe->name, 2000, 0), *then = make(recipe->name, 2000, 12.5);
        assert_int_equal(now->vertex_count, then->vertex_count);
        assert_memory_equal(now->positions, then->positions, 3 * sizeof(float) * now->vertex_count);
        kdr_mesh_destroy(now);
        kdr_mesh_destroy(then);
    }
}

static void motion_repeats_without_a_jump(void **state) {
    (void)state;
    kdr_mesh *whole = make("explode", 1000, 0), *again = make("explode", 1000, 6),
             *almost = make("explode", 1000, 5.999);
    assert_memory_equal(whole->positions, again->positions, 3 * sizeof(float) * whole->vertex_count);
    for (size_t v = 0; v < 3 * whole->vertex_count; v++)
        assert_true(fabsf(whole->positions[v] - almost->positions[v]) < 1e-4f);
    kdr_mesh_destroy(whole);
    kdr_mesh_destroy(again);
    kdr_mesh_destroy(almost);
}

static void a_burst_moves_every_triangle_another_way(void **state) {
    (void)state;
    kdr_mesh *whole = make("explode", 1000, 0), *burst = make("explode", 1000, 1.5);
    float last[3] = {0, 0, 0};
    for (size_t i = 0; i < whole->triangle_count; i++) {
        float path[3];
        for (int axis = 0; axis < 3; axis++)
            path[axis] = corner_of(burst, i, 0)[axis] - corner_of(whole, i, 0)[axis];
        assert_memory_not_equal(path, last, sizeof path);
        memcpy(last, path, sizeof path);
    }
    kdr_mesh_destroy(whole);
    kdr_mesh_destroy(burst);
}

/* Exact for coordinates that are whole multiples of 1 / 8192 below 4. */
static bool has_no_area(const kdr_mesh *mesh, size_t triangle) {
    const float *a = corner_of(mesh, triangle, 0), *b = corner_of(mesh, triangle, 1), *c = corner_of(mesh, triangle, 2);
    double u[3], v[3];
    for (int axis = 0; axis < 3; axis++)
        u[axis] = (double)b[axis] - a[axis], v[axis] = (double)c[axis] - a[axis];
    return u[1] * v[2] == u[2] * v[1] && u[2] * v[0] == u[0] * v[2] && u[0] * v[1] == u[1] * v[0];
}

static void a_quarter_of_duplicates_has_no_area_in_four_ways(void **state) {
    (void)state;
    kdr_mesh *mesh = make("duplicates", 10000, 0);
    size_t without_area = 0, ways[4] = {0};
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        if (!has_no_area(mesh, i))
            continue;
        without_area++;
        const uint32_t *index = mesh->indices + 3 * i;
        bool same_vertex = index[0] == index[1] || index[1] == index[2] || index[2] == index[0];
        int same_place = 0;
        for (int k = 0; k < 3; k++)
            same_place += memcmp(corner_of(mesh, i, k), corner_of(mesh, i, (k + 1) % 3), 3 * sizeof(float)) == 0;
        ways[same_vertex ? 0 : same_place == 3 ? 1 : same_place == 1 ? 2 : 3]++;
    }
    assert_int_equal(without_area, 2500);
    for (int way = 0; way < 4; way++)
        assert_int_equal(ways[way], 625);
    kdr_mesh_destroy(mesh);
}

static int compare_triangles(const void *a, const void *b) { return memcmp(a, b, 9 * sizeof(float)); }

static void a_quarter_of_duplicates_is_there_a_thousand_times(void **state) {
    (void)state;
    kdr_mesh *mesh = make("duplicates", 10000, 0);
    float(*triangles)[9] = malloc(mesh->triangle_count * sizeof *triangles);
    assert_non_null(triangles);
    for (size_t i = 0; i < mesh->triangle_count; i++)
        for (int k = 0; k < 3; k++)
            memcpy(triangles[i] + 3 * k, corner_of(mesh, i, k), 3 * sizeof(float));
    qsort(triangles, mesh->triangle_count, sizeof *triangles, compare_triangles);

    size_t copied = 0, run = 1;
    for (size_t i = 1; i <= mesh->triangle_count; i++) {
        if (i < mesh->triangle_count && memcmp(triangles[i], triangles[i - 1], sizeof *triangles) == 0) {
            run++;
            continue;
        }
        copied += run >= 1000 ? run : 0;
        run = 1;
    }
    assert_int_equal(copied, 2500);
    free(triangles);
    kdr_mesh_destroy(mesh);
}

static void a_quarter_of_duplicates_meets_in_one_vertex(void **state) {
    (void)state;
    kdr_mesh *mesh = make("duplicates", 10000, 0);
    uint32_t *uses = calloc(mesh->vertex_count, sizeof *uses);
    assert_non_null(uses);
    uint32_t most = 0;
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
        uint32_t used = ++uses[mesh->indices[i]];
        most = used > most ? used : most;
    }
    assert_int_equal(most, 2500);
    free(uses);
    kdr_mesh_destroy(mesh);
}

/* Every corner of triangle i satisfies the equation of plane i % 6 exactly. */
static void the_heap_lies_in_six_planes_exactly(void **state) {
    (void)state;
    kdr_mesh *mesh = make("heap", 12000, 0);
    size_t in_plane[6] = {0};
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        assert_false(has_no_area(mesh, i));
        bool inside[6] = {true, true, true, true, true, true};
        for (int k = 0; k < 3; k++) {
            const float *p = corner_of(mesh, i, k);
            double x = p[0], y = p[1], z = p[2];
            inside[0] &= y == -1;
            inside[1] &= x == -1;
            inside[2] &= z == -1;
            inside[3] &= y == -0.25;
            inside[4] &= 2 * y + x + z == 0;
            inside[5] &= 8 * x == 2 * z + y;
        }
        for (int plane = 0; plane < 6; plane++)
            in_plane[plane] += inside[plane];
    }
    for (int plane = 0; plane < 6; plane++)
        assert_int_equal(in_plane[plane], 2000);
    kdr_mesh_destroy(mesh);
}

static void city_walls_are_square_to_the_axes(void **state) {
    (void)state;
    kdr_mesh *mesh = make("city", 20000, 0);
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const float *a = corner_of(mesh, i, 0), *b = corner_of(mesh, i, 1), *c = corner_of(mesh, i, 2);
        assert_true((a[0] == b[0] && b[0] == c[0]) || (a[1] == b[1] && b[1] == c[1]) || (a[2] == b[2] && b[2] == c[2]));
    }
    kdr_mesh_destroy(mesh);
}

static void most_of_the_stadium_is_in_a_teapot_of_half_a_metre(void **state) {
    (void)state;
    kdr_mesh *mesh = make("stadium", 20000, 0);
    size_t near = 0;
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const float *p = corner_of(mesh, i, 1);
        near += fabsf(p[0]) < 0.5f && fabsf(p[1]) < 0.5f && fabsf(p[2]) < 0.5f;
    }
    float bounds[6];
    kdr_mesh_bounds(mesh, bounds);
    assert_true(bounds[3] - bounds[0] > 200);
    assert_true(near * 10 > mesh->triangle_count * 6);
    kdr_mesh_destroy(mesh);
}

/* The area of a needle over the area of its box's face is small: that is what makes them hard. */
static void needles_are_long_and_thin(void **state) {
    (void)state;
    kdr_mesh *mesh = make("needles", 2000, 0);
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        double length = 0, base = 0;
        for (int axis = 0; axis < 3; axis++) {
            double along = corner_of(mesh, i, 2)[axis] - corner_of(mesh, i, 0)[axis];
            double across = corner_of(mesh, i, 1)[axis] - corner_of(mesh, i, 0)[axis];
            length += along * along, base += across * across;
        }
        assert_true(length > 90 * 90 * base && base > 0);
    }
    kdr_mesh_destroy(mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closed_scenes_are_closed_and_face_outwards),
        cmocka_unit_test(moving_scenes_move_and_stay_finite_at_any_time),
        cmocka_unit_test(still_scenes_are_the_same_at_any_time),
        cmocka_unit_test(motion_repeats_without_a_jump),
        cmocka_unit_test(a_burst_moves_every_triangle_another_way),
        cmocka_unit_test(a_quarter_of_duplicates_has_no_area_in_four_ways),
        cmocka_unit_test(a_quarter_of_duplicates_is_there_a_thousand_times),
        cmocka_unit_test(a_quarter_of_duplicates_meets_in_one_vertex),
        cmocka_unit_test(the_heap_lies_in_six_planes_exactly),
        cmocka_unit_test(city_walls_are_square_to_the_axes),
        cmocka_unit_test(most_of_the_stadium_is_in_a_teapot_of_half_a_metre),
        cmocka_unit_test(needles_are_long_and_thin),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
