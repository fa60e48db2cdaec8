/* The closest point of a triangle, against exact distances in numbers of 113 bits. */
#include "geometry/triangle_point.h"
#include "support/exact_point.h"
#include "support/soup.h"
#include "support/test_size.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#define POINTS TEST_SIZE(100)

/* On the triangle, beside it, near it, or anywhere. */
static void draw_query(test_random *random, const float (*corner)[3], float query[3]) {
    uint32_t kind = test_random_below(random, 5);
    double u = test_random_float(random), v = kind == 0 ? 0 : test_random_float(random) * (1 - u);
    double size = 0;
    for (int k = 0; k < 3; k++)
        size = fmax(size, fabs((double)corner[1][k] - corner[0][k]));
    for (int k = 0; k < 3; k++) {
        double on = corner[0][k] * (1 - u - v) + corner[1][k] * u + corner[2][k] * v;
        double off = test_random_between(random, -1, 1);
        double at = kind == 2 ? on + off * size : kind == 3 ? on * (1 + off * 1e-6) : on;
        query[k] = kind == 4 || fabs(at) > 3e38 ? soup_any_float(random) : (float)at;
    }
}

/* Infinite if one of the numbers is not finite. */
static double largest_size(const float *numbers, int count) {
    double largest = 0;
    for (int i = 0; i < count; i++)
        largest = isfinite(numbers[i]) ? fmax(largest, fabs((double)numbers[i])) : INFINITY;
    return largest;
}

static void hold(const float query[3], const float (*corner)[3], const char *label) {
    kdr_surface_point p = kdr_triangle_point(query, corner);
    double size = 0, reach = fmax(largest_size(query, 3), largest_size(corner[0], 9));
    for (int k = 0; k < 3; k++) {
        double lo = fmin(corner[0][k], fmin(corner[1][k], corner[2][k]));
        double hi = fmax(corner[0][k], fmax(corner[1][k], corner[2][k]));
        double weighted = (1 - p.u - p.v) * corner[0][k] + p.u * corner[1][k] + p.v * corner[2][k];
        size = fmax(size, hi - lo);
        assert_true(p.at[k] >= lo && p.at[k] <= hi);
        assert_true(fabs(weighted - p.at[k]) <= 0x1p-48 * reach);
    }
    assert_true(p.u >= 0 && p.v >= 0 && p.u + p.v <= 1 + 0x1p-50);
    assert_true(p.square == kdr_point_square(query, p.at));
    double error = exact_point_error(query, corner, p.square);
    if (error < -0x1p-50 * reach || error > 0x1p-50 * reach + 0x1p-20 * size) {
        for (int i = 0; i < 3; i++)
            printf("%a %a %a\n", corner[i][0], corner[i][1], corner[i][2]);
        fail_msg("%s: the distance of %a %a %a is off by %a", label, query[0], query[1], query[2], error);
    }
}

static void a_point_lies_in_its_triangle_and_its_distance_is_within_the_stated_bound(void **state) {
    (void)state;
    for (size_t kind = 0; kind < soup_kind_count; kind++) {
        test_random random = test_random_start(test_random_seed(), kind);
        size_t count = soup_kinds[kind].count;
        float *triangles = test_allocate(9 * count, sizeof(float));
        soup_kinds[kind].fill(&random, triangles, count);
        for (size_t i = 0; i < count; i++) {
            const float(*corner)[3] = (const float(*)[3])(triangles + 9 * i);
            for (int j = 0; j < POINTS && isfinite(largest_size(corner[0], 9)); j++) {
                float query[3];
                draw_query(&random, corner, query);
                hold(query, corner, soup_kinds[kind].name);
            }
        }
        free(triangles);
    }
}

/* Needles of every length and shape, asked about points near their plane, where an error of weights costs most. */
static void thin_triangles_keep_to_the_bound(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 100);
    for (int i = 0; i < 1000 * POINTS; i++) {
        float corner[3][3], query[3];
        double width = ldexp(1, -(int)test_random_below(&random, 60)), place = test_random_float(&random);
        for (int k = 0; k < 3; k++) {
            corner[0][k] = test_random_between(&random, -1, 1) * (float)(i % 2 ? 1 : width);
            corner[1][k] = test_random_between(&random, -1, 1);
            double on = corner[0][k] + place * ((double)corner[1][k] - corner[0][k]);
            corner[2][k] = (float)(on + width * test_random_between(&random, -1, 1));
            query[k] = (float)(on + width * test_random_between(&random, -1, 1));
        }
        hold(query, (const float(*)[3])corner, "needle");
    }
}

static void a_shared_edge_has_one_closest_point(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 101);
    for (int i = 0; i < 100 * POINTS; i++) {
        float p[5][3]; /* two triangles on the edge from 0 to 1, and the query */
        for (int k = 0; k < 15; k++)
            p[k / 3][k % 3] = test_random_between(&random, -1, 1);
        double there[3], back[3], along, rest;
        kdr_edge_point(p[4], p[0], p[1], there, &along);
        kdr_edge_point(p[4], p[1], p[0], back, &rest);
        for (int k = 0; k < 3; k++)
            assert_true(there[k] == back[k]);
        assert_true(fabs(along + rest - 1) < 0x1p-50);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_point_lies_in_its_triangle_and_its_distance_is_within_the_stated_bound),
        cmocka_unit_test(thin_triangles_keep_to_the_bound),
        cmocka_unit_test(a_shared_edge_has_one_closest_point),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
