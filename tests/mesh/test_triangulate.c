#include "mesh/triangulate.h"
#include "mesh/reading.h"
#include "support/random.h"
#include "support/test_size.h"

#define MOST 200

/* Twice the signed area in the plane z = 0. */
static double area(const float *p, const uint32_t *corners, size_t count) {
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        const float *a = p + 3 * (size_t)corners[i], *b = p + 3 * (size_t)corners[(i + 1) % count];
        sum += (double)a[0] * (double)b[1] - (double)a[1] * (double)b[0];
    }
    return sum;
}

/* Every triangle turns as the polygon does, and their areas add up to the polygon's: nothing is covered twice. */
static void assert_partition(const float *positions, const uint32_t *corners, size_t count) {
    uint32_t triangles[3 * MOST];
    kdr_triangulate(positions, corners, count, triangles);
    double whole = area(positions, corners, count), sum = 0;
    for (size_t i = 0; i < count - 2; i++) {
        uint32_t triangle[3];
        for (int corner = 0; corner < 3; corner++) {
            assert_true(triangles[3 * i + (size_t)corner] < count);
            triangle[corner] = corners[triangles[3 * i + (size_t)corner]];
        }
        double part = area(positions, triangle, 3);
        assert_true(part * whole >= 0);
        sum += part;
    }
    assert_true(fabs(sum - whole) <= 1e-5 * fabs(whole));
}

static void random_star_shaped_polygons_are_cut_without_overlap(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 2);
    for (int run = 0; run < TEST_SIZE(3000); run++) {
        size_t count = 3 + test_random_below(&random, KDR_EAR_CORNERS - 2);
        float positions[3 * MOST];
        uint32_t corners[MOST];
        bool backwards = test_random_below(&random, 2);
        for (size_t i = 0; i < count; i++) {
            double angle = 6.283185307179586 * (double)i / (double)count;
            double radius = (double)test_random_between(&random, 0.2f, 1.0f);
            positions[3 * i] = (float)(radius * cos(angle)) + 3;
            positions[3 * i + 1] = (float)(radius * sin(angle)) - 5;
            positions[3 * i + 2] = 0;
            corners[i] = (uint32_t)(backwards ? count - 1 - i : i);
        }
        assert_partition(positions, corners, count);
    }
}

static void a_comb_and_a_spiral_are_cut_without_overlap(void **state) {
    (void)state;
    float comb[3 * 62];
    uint32_t corners[62];
    for (uint32_t i = 0; i < 60; i++) {
        comb[3 * i] = (float)i;
        comb[3 * i + 1] = i % 2 ? 10.0f : 1.0f;
    }
    for (uint32_t i = 0; i < 62; i++) {
        comb[3 * i + 2] = 0;
        corners[i] = 61 - i;
    }
    comb[180] = 59, comb[181] = 0, comb[183] = 0, comb[184] = 0;
    assert_partition(comb, corners, 62);

    float spiral[3 * 60];
    uint32_t around[60];
    for (uint32_t i = 0; i < 30; i++) {
        double angle = 0.4 * (double)i, radius = 1 + 0.2 * angle;
        for (uint32_t side = 0; side < 2; side++) {
            uint32_t at = side ? 59 - i : i;
            double r = radius * (side ? 1.02 : 1);
            spiral[3 * at] = (float)(r * cos(angle));
            spiral[3 * at + 1] = (float)(r * sin(angle));
            spiral[3 * at + 2] = 0;
            around[at] = at;
        }
    }
    assert_partition(spiral, around, 60);
}

static void degenerate_polygons_give_triangles_of_their_own_corners(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 3);
    for (int run = 0; run < TEST_SIZE(3000); run++) {
        size_t count = 3 + test_random_below(&random, MOST - 3);
        float positions[3 * 8];
        uint32_t corners[MOST], triangles[3 * MOST];
        static const float values[] = {0, 1, -1, 1e30f, NAN, INFINITY, 1e-40f, 2};
        for (int i = 0; i < 24; i++)
            positions[i] = values[test_random_below(&random, run % 2 ? 3 : 8)];
        for (size_t i = 0; i < count; i++)
            corners[i] = test_random_below(&random, 8);
        kdr_triangulate(positions, corners, count, triangles);
        for (size_t i = 0; i < 3 * (count - 2); i++)
            assert_true(triangles[i] < count);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_star_shaped_polygons_are_cut_without_overlap),
        cmocka_unit_test(a_comb_and_a_spiral_are_cut_without_overlap),
        cmocka_unit_test(degenerate_polygons_give_triangles_of_their_own_corners),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
