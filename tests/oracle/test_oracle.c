/* The oracle held against arithmetic of another kind: integers, worked examples, and its own slow path. */
#include "support/oracle.h"
#include "support/oracle_tree.h"
#include "support/random.h"
#include "support/test_size.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#define INTEGER_CASES TEST_SIZE(200000)

typedef __int128 wide;

static kdr_ray ray_from(float ox, float oy, float oz, float dx, float dy, float dz) {
    return (kdr_ray){.origin_x = ox,
                     .origin_y = oy,
                     .origin_z = oz,
                     .tmin = 0,
                     .direction_x = dx,
                     .direction_y = dy,
                     .direction_z = dz,
                     .tmax = INFINITY};
}

/* ---------------------------------------------------------------------------------------- integer arithmetic */

static int64_t integer_determinant(const int64_t p[3], const int64_t q[3], const int64_t r[3]) {
    return p[0] * (q[1] * r[2] - q[2] * r[1]) + p[1] * (q[2] * r[0] - q[0] * r[2]) + p[2] * (q[0] * r[1] - q[1] * r[0]);
}

/* numerator / denominator rounded to 24 bits, ties to even, by long division; both below 2^62, the quotient normal. */
static float integer_quotient(int64_t numerator, int64_t denominator) {
    if (numerator == 0)
        return 0;
    bool negative = (numerator < 0) != (denominator < 0);
    wide top = numerator < 0 ? -(wide)numerator : numerator;
    wide bottom = denominator < 0 ? -(wide)denominator : denominator;
    int exponent = 0;
    for (; top < bottom << 23; exponent--)
        top <<= 1;
    for (; top >= bottom << 24; exponent++)
        bottom <<= 1;
    wide quotient = top / bottom, twice_rest = 2 * (top % bottom);
    if (twice_rest > bottom || (twice_rest == bottom && (quotient & 1)))
        quotient++;
    float value = ldexpf((float)(int64_t)quotient, exponent);
    return negative ? -value : value;
}

/* numbers: origin, direction, a, b, c */
static bool integer_triangle(const int numbers[5][3], float *t) {
    int64_t p[3][3], direction[3];
    for (int axis = 0; axis < 3; axis++) {
        direction[axis] = numbers[1][axis];
        for (int i = 0; i < 3; i++)
            p[i][axis] = (int64_t)numbers[2 + i][axis] - numbers[0][axis];
    }
    int64_t edges[3];
    int positive = 0, negative = 0;
    for (int i = 0; i < 3; i++) {
        edges[i] = integer_determinant(direction, p[(i + 1) % 3], p[(i + 2) % 3]);
        positive += edges[i] > 0;
        negative += edges[i] < 0;
    }
    if ((positive > 0) == (negative > 0))
        return false;
    *t = integer_quotient(integer_determinant(p[0], p[1], p[2]), edges[0] + edges[1] + edges[2]);
    return true;
}

/* Draws triangles and rays with coordinates in [-limit, limit]; a small limit makes edge, vertex and edge-on hits
 * common. */
static void hold_against_integers(int limit, int exponent, uint64_t sequence) {
    test_random random = test_random_start(test_random_seed(), sequence);
    int hits = 0;
    for (int i = 0; i < INTEGER_CASES; i++) {
        int numbers[5][3];
        float floats[5][3];
        for (int k = 0; k < 15; k++) {
            int value = (int)test_random_below(&random, 2 * (uint32_t)limit + 1) - limit;
            numbers[k / 3][k % 3] = value;
            floats[k / 3][k % 3] = ldexpf((float)value, exponent);
        }
        if (numbers[1][0] == 0 && numbers[1][1] == 0 && numbers[1][2] == 0)
            continue;
        kdr_ray ray = ray_from(floats[0][0], floats[0][1], floats[0][2], floats[1][0], floats[1][1], floats[1][2]);
        float expected = 0, filtered = 0, exact = 0;
        bool meets = integer_triangle(numbers, &expected);
        assert_int_equal(oracle_triangle(&ray, floats[2], floats[3], floats[4], &filtered), meets);
        assert_int_equal(oracle_triangle_exact(&ray, floats[2], floats[3], floats[4], &exact), meets);
        if (meets) {
            assert_true(filtered == expected);
            assert_true(exact == expected);
            hits++;
        }
    }
    assert_true(hits > INTEGER_CASES / 50);
}

static void integers_up_to_1024_give_the_hits_of_integer_arithmetic(void **state) {
    (void)state;
    hold_against_integers(1024, 0, 1);
}

static void tiny_integers_give_the_hits_of_integer_arithmetic(void **state) {
    (void)state;
    hold_against_integers(3, 0, 2);
}

static void denormal_coordinates_give_the_hits_of_the_integers_they_stand_for(void **state) {
    (void)state;
    hold_against_integers(1024, -149, 3);
}

static void huge_coordinates_give_the_hits_of_the_integers_they_stand_for(void **state) {
    (void)state;
    hold_against_integers(1023, 118, 4);
}

/* ------------------------------------------------------------------------------------------- filter and slow path */

/* A float of any bits that is finite. */
static float any_float(test_random *random) {
    for (;;) {
        uint32_t bits = test_random_u32(random);
        float value;
        memcpy(&value, &bits, sizeof(value));
        if (isfinite(value))
            return value;
    }
}

static void hold_against_the_slow_path(bool raw_bits, uint64_t sequence) {
    test_random random = test_random_start(test_random_seed(), sequence);
    int hits = 0;
    for (int i = 0; i < INTEGER_CASES / 4; i++) {
        float v[5][3];
        for (int k = 0; k < 15; k++)
            v[k / 3][k % 3] = raw_bits ? any_float(&random) : test_random_between(&random, -1, 1);
        if (!raw_bits) {
            // Aim at a point that lies on an edge, or on a vertex, but for rounding.
            float s = test_random_below(&random, 4) == 0 ? 0 : test_random_float(&random);
            for (int axis = 0; axis < 3; axis++)
                v[1][axis] = v[2][axis] + s * (v[3][axis] - v[2][axis]) - v[0][axis];
        }
        kdr_ray ray = ray_from(v[0][0], v[0][1], v[0][2], v[1][0], v[1][1], v[1][2]);
        float filtered = 0, exact = 0;
        bool meets = oracle_triangle_exact(&ray, v[2], v[3], v[4], &exact);
        assert_int_equal(oracle_triangle(&ray, v[2], v[3], v[4], &filtered), meets);
        if (meets)
            assert_memory_equal(&filtered, &exact, sizeof(float));
        hits += meets;
    }
    assert_true(hits > INTEGER_CASES / 4 / 50);
}

static void the_filter_agrees_with_the_slow_path_near_edges_and_vertices(void **state) {
    (void)state;
    hold_against_the_slow_path(false, 5);
}

static void the_filter_agrees_with_the_slow_path_on_floats_of_any_bits(void **state) {
    (void)state;
    hold_against_the_slow_path(true, 6);
}

/* --------------------------------------------------------------------------------------------- worked examples */

static const float corner_a[3] = {0, 0, 0}, corner_b[3] = {1, 0, 0}, corner_c[3] = {0, 1, 0};

static void a_ray_through_the_inside_has_the_distance_and_weights_worked_out_by_hand(void **state) {
    (void)state;
    kdr_ray ray = ray_from(0.25f, 0.5f, 3, 0, 0, -2);
    float t;
    double u, v;
    assert_true(oracle_triangle(&ray, corner_a, corner_b, corner_c, &t));
    assert_true(t == 1.5f);
    oracle_barycentric(&ray, corner_a, corner_b, corner_c, &u, &v);
    assert_true(u == 0.25 && v == 0.5);
}

static void edges_and_vertices_are_inside_and_one_step_of_a_float_beyond_is_not(void **state) {
    (void)state;
    float t;
    const float inside[][2] = {{0, 0}, {1, 0}, {0, 1}, {0.5f, 0.5f}, {0.5f, 0}, {0, 0.5f}, {1 - 0x1p-24f, 0x1p-24f}};
    for (size_t i = 0; i < sizeof(inside) / sizeof(inside[0]); i++) {
        kdr_ray ray = ray_from(inside[i][0], inside[i][1], 1, 0, 0, -1);
        assert_true(oracle_triangle(&ray, corner_a, corner_b, corner_c, &t) && t == 1);
        assert_true(oracle_triangle(&ray, corner_c, corner_b, corner_a, &t) && t == 1);
    }
    const float outside[][2] = {
        {-0x1p-149f, 0}, {1, 0x1p-149f}, {0, -0x1p-149f}, {1 + 0x1p-23f, 0}, {0.5f, 0.5f + 0x1p-24f}};
    for (size_t i = 0; i < sizeof(outside) / sizeof(outside[0]); i++) {
        kdr_ray ray = ray_from(outside[i][0], outside[i][1], 1, 0, 0, -1);
        assert_false(oracle_triangle(&ray, corner_a, corner_b, corner_c, &t));
    }
}

static void a_triangle_seen_edge_on_or_without_area_is_not_hit(void **state) {
    (void)state;
    float t;
    kdr_ray within = ray_from(-1, 0.25f, 0, 1, 0, 0), along = ray_from(-1, 0, 0, 1, 0, 0);
    kdr_ray beside = ray_from(-1, 0, 1, 1, 0, 0);
    assert_false(oracle_triangle(&within, corner_a, corner_b, corner_c, &t));
    assert_false(oracle_triangle(&along, corner_a, corner_b, corner_c, &t));
    assert_false(oracle_triangle(&beside, corner_a, corner_b, corner_c, &t));
    const float middle[3] = {0.5f, 0, 0};
    kdr_ray through = ray_from(0.25f, 0, 1, 0, 0, -1);
    assert_false(oracle_triangle(&through, corner_a, corner_b, middle, &t));
    assert_false(oracle_triangle(&through, middle, middle, middle, &t));
}

static void a_distance_half_way_between_floats_goes_to_the_even_one(void **state) {
    (void)state;
    float t;
    // The plane z = 0 seen from z = 2^24 + 1, which is no float: origin 2^24, plane at -1, and so on upwards.
    const float low[3][3] = {{-9, -9, -1}, {9, -9, -1}, {0, 9, -1}};
    kdr_ray ray = ray_from(0, 0, 0x1p24f, 0, 0, -1);
    assert_true(oracle_triangle(&ray, low[0], low[1], low[2], &t) && t == 0x1p24f);
    ray.origin_z = 0x1p24f + 2;
    assert_true(oracle_triangle(&ray, low[0], low[1], low[2], &t) && t == 0x1p24f + 4);
    // Far above the floats and far below them.
    ray = ray_from(0, 0, 0x1p127f, 0, 0, -0x1p-20f);
    assert_true(oracle_triangle(&ray, low[0], low[1], low[2], &t) && isinf(t) && t > 0);
    ray = ray_from(0, 0, -1 + 0x1p-24f, 0, 0, -0x1p127f);
    assert_true(oracle_triangle(&ray, low[0], low[1], low[2], &t) && t == 0);
    // Half of the least denormal is a tie with zero, three quarters of it are not.
    ray = ray_from(0, 0, 0x1p-23f, 0, 0, -0x1p127f);
    const float flat[3][3] = {{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}};
    assert_true(oracle_triangle(&ray, flat[0], flat[1], flat[2], &t) && t == 0);
    ray.origin_z = 0x1.8p-23f;
    assert_true(oracle_triangle(&ray, flat[0], flat[1], flat[2], &t) && t == 0x1p-149f);
}

static void rays_that_the_contract_rules_out_miss(void **state) {
    (void)state;
    const float bad[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 3; i++) {
        kdr_ray ray = ray_from(bad[i], 0, 0, 1, 0, 0);
        assert_false(oracle_ray_is_valid(&ray));
        ray = ray_from(0, 0, 0, 1, bad[i], 0);
        assert_false(oracle_ray_is_valid(&ray));
    }
    kdr_ray ray = ray_from(0, 0, 0, 0, -0.0f, 0);
    assert_false(oracle_ray_is_valid(&ray));
    ray = ray_from(0, 0, 0, 1, 0, 0);
    assert_true(oracle_ray_is_valid(&ray));
    ray.tmin = -INFINITY;
    assert_true(oracle_ray_is_valid(&ray));
    ray.tmin = ray.tmax = 2;
    assert_false(oracle_ray_is_valid(&ray));
    ray.tmax = NAN;
    assert_false(oracle_ray_is_valid(&ray));
}

/* ------------------------------------------------------------------------------------------------------ scenes */

static void of_equal_distances_the_lowest_geometry_then_the_lowest_primitive_wins(void **state) {
    (void)state;
    float vertices[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    uint32_t indices[9] = {0, 1, 2, 2, 1, 0, 0, 1, 2};
    kdr_triangles_def def = {.vertices = vertices,
                             .vertex_stride = 12,
                             .vertex_count = 3,
                             .indices = indices,
                             .index_stride = 12,
                             .triangle_count = 3};
    kdr_triangles_def defs[2] = {def, def};
    oracle_scene scene = oracle_scene_create(defs, 2);
    assert_int_equal(scene.count, 6);
    kdr_ray ray = ray_from(0.25f, 0.25f, 1, 0, 0, -1);
    oracle_hit hit = oracle_closest(&scene, &ray);
    assert_ptr_equal(hit.primitive, &scene.primitives[0]);
    assert_true(hit.t == 1 && oracle_any(&scene, &ray));

    // The interval is open below and closed above.
    ray.tmax = 1;
    assert_non_null(oracle_closest(&scene, &ray).primitive);
    ray.tmax = nextafterf(1, 0);
    assert_null(oracle_closest(&scene, &ray).primitive);
    ray.tmin = 1, ray.tmax = 2;
    assert_null(oracle_closest(&scene, &ray).primitive);
    ray.tmin = nextafterf(1, 0);
    assert_non_null(oracle_closest(&scene, &ray).primitive);
    oracle_scene_destroy(&scene);
}

static void the_oracles_tree_answers_as_its_brute_force(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 7);
    enum { COUNT = 500 };
    static float vertices[COUNT * 9];
    for (int grid = 0; grid < 3; grid++) {
        // Triangles on a coarse grid, on a fine one, and of floats of any bits.
        for (int i = 0; i < COUNT * 9; i++)
            vertices[i] = grid == 2 ? any_float(&random) : (float)test_random_below(&random, grid ? 4096 : 6);
        kdr_triangles_def def = {
            .vertices = vertices, .vertex_stride = 12, .vertex_count = COUNT * 3, .triangle_count = COUNT};
        oracle_scene scene = oracle_scene_create(&def, 1);
        oracle_tree tree = oracle_tree_create(&scene);
        int hits = 0;
        for (int i = 0; i < 400; i++) {
            float v[6];
            for (int k = 0; k < 6; k++)
                v[k] = grid == 2 ? any_float(&random) : (float)test_random_below(&random, grid ? 4096 : 6);
            kdr_ray ray = ray_from(v[0], v[1], v[2], v[3] - v[0], v[4] - v[1], v[5] - v[2]);
            ray.tmin = test_random_below(&random, 2) ? 0 : -INFINITY;
            oracle_hit brute = oracle_closest(&scene, &ray), walked = oracle_tree_closest(&tree, &ray);
            assert_ptr_equal(brute.primitive, walked.primitive);
            assert_true(brute.t == walked.t && brute.u == walked.u && brute.v == walked.v);
            assert_int_equal(oracle_any(&scene, &ray), brute.primitive != NULL);
            assert_int_equal(oracle_tree_any(&tree, &ray), brute.primitive != NULL);
            hits += brute.primitive != NULL;
        }
        assert_true(hits > 100);
        oracle_tree_destroy(&tree);
        oracle_scene_destroy(&scene);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(integers_up_to_1024_give_the_hits_of_integer_arithmetic),
        cmocka_unit_test(tiny_integers_give_the_hits_of_integer_arithmetic),
        cmocka_unit_test(denormal_coordinates_give_the_hits_of_the_integers_they_stand_for),
        cmocka_unit_test(huge_coordinates_give_the_hits_of_the_integers_they_stand_for),
        cmocka_unit_test(the_filter_agrees_with_the_slow_path_near_edges_and_vertices),
        cmocka_unit_test(the_filter_agrees_with_the_slow_path_on_floats_of_any_bits),
        cmocka_unit_test(a_ray_through_the_inside_has_the_distance_and_weights_worked_out_by_hand),
        cmocka_unit_test(edges_and_vertices_are_inside_and_one_step_of_a_float_beyond_is_not),
        cmocka_unit_test(a_triangle_seen_edge_on_or_without_area_is_not_hit),
        cmocka_unit_test(a_distance_half_way_between_floats_goes_to_the_even_one),
        cmocka_unit_test(rays_that_the_contract_rules_out_miss),
        cmocka_unit_test(of_equal_distances_the_lowest_geometry_then_the_lowest_primitive_wins),
        cmocka_unit_test(the_oracles_tree_answers_as_its_brute_force),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
