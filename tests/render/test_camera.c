/* Cameras and the rays they send out: the written formula, camera files, cameras that cannot be. */
#include "render/rays.h"
#include "render/sample.h"
#include "render/tile.h"
#include "rendering.h"

#include <float.h>

#include "support/random.h"

static char path[64];

static void write_text(const char *text) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fputs(text, file);
    assert_int_equal(fclose(file), 0);
}

static int make_file(void **state) {
    (void)state;
    told.count = 0;
    snprintf(path, sizeof path, "/tmp/kdr-camera-test-XXXXXX");
    int file = mkstemp(path);
    return file < 0 ? -1 : close(file);
}

static int remove_file(void **state) {
    (void)state;
    return unlink(path) != 0 || kdr_render_bytes() != 0;
}

static void rays_through_pixel_centres_follow_the_written_formula(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 1);
    for (int round = 0; round < 200; round++) {
        kdr_camera camera = {.fov = test_random_between(&random, 5, 150)};
        for (int k = 0; k < 3; k++) {
            camera.eye[k] = test_random_between(&random, -5, 5);
            camera.target[k] = test_random_between(&random, -5, 5);
            camera.up[k] = test_random_between(&random, -1, 1);
        }
        uint32_t width = 1 + test_random_below(&random, 2000), height = 1 + test_random_below(&random, 2000);
        kdr_view view;
        assert_null(kdr_view_make(&camera, width, height, &view));

        double f[3], r[3], u[3], length = 0;
        for (int k = 0; k < 3; k++)
            length += pow(f[k] = (double)camera.target[k] - camera.eye[k], 2);
        for (int k = 0; k < 3; k++)
            f[k] /= sqrt(length);
        for (int k = 0; k < 3; k++)
            r[k] = f[(k + 1) % 3] * camera.up[(k + 2) % 3] - f[(k + 2) % 3] * camera.up[(k + 1) % 3];
        length = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
        for (int k = 0; k < 3; k++)
            r[k] /= length;
        for (int k = 0; k < 3; k++)
            u[k] = r[(k + 1) % 3] * f[(k + 2) % 3] - r[(k + 2) % 3] * f[(k + 1) % 3];

        uint32_t i = test_random_below(&random, width), j = test_random_below(&random, height);
        double half = tan(camera.fov * acos(-1) / 360), d[3];
        double across = (2 * (i + 0.5) / width - 1) * half * width / height;
        double upward = (1 - 2 * (j + 0.5) / height) * half;
        for (int k = 0; k < 3; k++)
            d[k] = f[k] + across * r[k] + upward * u[k];
        length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);

        kdr_ray ray = kdr_view_ray(&view, (float)i + 0.5f, (float)j + 0.5f);
        assert_true(ray.origin_x == camera.eye[0] && ray.origin_y == camera.eye[1] && ray.origin_z == camera.eye[2]);
        assert_true(ray.tmin == 0 && ray.tmax == INFINITY);
        expect_near(ray.direction_x, d[0] / length, 2e-6);
        expect_near(ray.direction_y, d[1] / length, 2e-6);
        expect_near(ray.direction_z, d[2] / length, 2e-6);
    }
}

static void rows_run_down_and_columns_to_the_right(void **state) {
    (void)state;
    kdr_camera camera = {.eye = {0, 0, 4}, .up = {0, 1, 0}, .fov = 90};
    kdr_view view;
    assert_null(kdr_view_make(&camera, 4, 2, &view));
    kdr_ray corner = kdr_view_ray(&view, 0, 0), middle = kdr_view_ray(&view, 2, 1);
    expect_near(corner.direction_x / corner.direction_z, 2, 1e-6); // twice as wide as high, to the left
    expect_near(corner.direction_y / corner.direction_z, -1, 1e-6);
    assert_true(corner.direction_x < 0 && corner.direction_y > 0 && corner.direction_z < 0);
    expect_near(middle.direction_z, -1, 0);
}

static void a_shadow_ray_starts_above_the_surface_and_ends_before_the_light(void **state) {
    (void)state;
    kdr_vector eye = {0, 0, 10}, point = {1, 2, 0}, light = {1, 2, 5};
    float lift = kdr_shadow_lift(eye, point, 10);
    expect_near(lift, 1e-3, 1e-9);
    kdr_ray ray = kdr_shadow_ray(point, (kdr_vector){0, 0, 1}, lift, light);
    expect_near(ray.origin_z, 1e-3, 1e-9);
    expect_near(ray.origin_x, 1, 0);
    expect_near(ray.origin_z + ray.tmax * ray.direction_z, 1e-3 + 0.9999 * (5 - 1e-3), 1e-6);
    // Far from the origin of coordinates the lift is more than their rounding.
    assert_true(1e6f + kdr_shadow_lift((kdr_vector){1e6f, 0, 1}, (kdr_vector){1e6f, 0, 0}, 1) > 1e6f);
}

static const char *fault_of(kdr_camera camera) {
    kdr_view view;
    const char *fault = kdr_view_make(&camera, 10, 10, &view);
    return fault ? fault : "";
}

static void a_camera_that_cannot_be_is_refused_with_the_reason(void **state) {
    (void)state;
    const kdr_camera good = {.eye = {1, 2, 3}, .up = {0, 1, 0}, .fov = 45};
    assert_string_equal(fault_of(good), "");
    const float angles[5] = {0, 180, -10, NAN, INFINITY};
    for (int i = 0; i < 5; i++) {
        kdr_camera camera = good;
        camera.fov = angles[i];
        assert_non_null(strstr(fault_of(camera), "field of view"));
    }
    kdr_camera camera = good;
    memcpy(camera.target, camera.eye, sizeof camera.eye);
    assert_non_null(strstr(fault_of(camera), "eye and target are the same"));
    camera = good;
    camera.up[1] = 0;
    assert_non_null(strstr(fault_of(camera), "zero"));
    for (int k = 0; k < 3; k++)
        camera.up[k] = -7 * camera.eye[k];
    assert_non_null(strstr(fault_of(camera), "along its up direction"));
    camera = good;
    camera.target[2] = NAN;
    assert_non_null(strstr(fault_of(camera), "not finite"));
}

/* Everything relative to the size of the coordinates. */
static void cameras_work_at_huge_and_tiny_scales(void **state) {
    (void)state;
    const float scales[4] = {1e-36f, 1e-20f, 1e20f, 1e37f};
    for (int i = 0; i < 4; i++) {
        float s = scales[i], bounds[6] = {-s, -s, -s, s, s, s}, light[3];
        kdr_camera camera = kdr_camera_for_bounds(bounds);
        kdr_light_for_bounds(bounds, light);
        kdr_view view;
        assert_null(kdr_view_make(&camera, 8, 8, &view));
        expect_near(view.forward.z, -0.9 / sqrt(0.35 * 0.35 + 0.25 * 0.25 + 0.9 * 0.9), 1e-6);
        expect_near(light[1] / s, 1.5 * sqrt(12), 1e-5);
    }
}

static void the_default_camera_and_light_stand_where_the_header_says(void **state) {
    (void)state;
    const float bounds[6] = {1, 2, 3, 4, 6, 15};
    const double centre[3] = {2.5, 4, 9}, diagonal = 13, way[3] = {0.35, 0.25, 0.9}, beside[3] = {0.8, 1.5, 0.8};
    double length = sqrt(0.35 * 0.35 + 0.25 * 0.25 + 0.9 * 0.9);
    kdr_camera camera = kdr_camera_for_bounds(bounds);
    float light[3];
    kdr_light_for_bounds(bounds, light);
    for (int k = 0; k < 3; k++) {
        expect_near(camera.eye[k], centre[k] + 0.95 * diagonal * way[k] / length, 2e-6);
        expect_near(camera.target[k], centre[k], 0);
        expect_near(light[k], centre[k] + diagonal * beside[k], 2e-6);
    }
    assert_true(camera.fov == 45 && camera.up[1] == 1);
}

static void bounds_without_size_or_without_a_model_still_give_a_camera(void **state) {
    (void)state;
    const float empty[6] = {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY};
    const float point[6] = {1e7f, 0, 5, 1e7f, 0, 5};
    const float largest[6] = {-FLT_MAX, -FLT_MAX, -FLT_MAX, FLT_MAX, FLT_MAX, FLT_MAX};
    const float *all[3] = {empty, point, largest};
    for (int i = 0; i < 3; i++) {
        kdr_camera camera = kdr_camera_for_bounds(all[i]);
        assert_string_equal(fault_of(camera), "");
        float light[3];
        kdr_light_for_bounds(all[i], light);
        assert_true(isfinite(light[0]) && isfinite(light[1]) && isfinite(light[2]));
    }
}

static void a_camera_file_gives_its_13_numbers(void **state) {
    (void)state;
    write_text("1 2.5 -3e1 4 5 6 0 1 0 45 7 8 9\n");
    kdr_camera camera;
    float light[3];
    assert_int_equal(kdr_camera_read(path, &hearing, &camera, light), KDR_OK);
    assert_true(camera.eye[0] == 1 && camera.eye[1] == 2.5f && camera.eye[2] == -30);
    assert_true(camera.target[0] == 4 && camera.target[2] == 6 && camera.up[1] == 1 && camera.fov == 45);
    assert_true(light[0] == 7 && light[1] == 8 && light[2] == 9);
}

static void a_wrong_camera_file_names_the_number_and_what_was_found(void **state) {
    (void)state;
    const struct {
        const char *text, *part;
    } files[] = {
        {"", "eye x (number 1 of 13), found the end"},
        {"1 2 3 4 five 6 0 1 0 45 7 8 9", "target y (number 5 of 13), found 'five'"},
        {"1 2 3 4 5 6 0 1 0 45 7 8", "light z (number 13 of 13), found the end"},
        {"1 2 3 4 5 6 0 1 0 45 7 8 9 10", "the end after 13 numbers, found '10'"},
        {"1 2 nan 4 5 6 0 1 0 45 7 8 9", "eye z (number 3 of 13), found 'nan'"},
        {"1 2 3 4 5 1e99 0 1 0 45 7 8 9", "target z (number 6 of 13), found '1e99'"},
        {"1,2,3,4,5,6,0,1,0,45,7,8,9", "number 1 of 13"},
        {"1 2 3 4 5 6 0 1 0 180 7 8 9", "between 0 and 180 degrees (number 10 of 13), found 180"},
    };
    kdr_camera camera = {.fov = 77};
    float light[3] = {1, 2, 3};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        write_text(files[i].text);
        expect_failure(kdr_camera_read(path, &hearing, &camera, light), KDR_ERROR_INVALID_DATA, files[i].part);
    }
    assert_true(camera.fov == 77 && light[2] == 3);
    expect_failure(kdr_camera_read("/nowhere/at.cam", &hearing, &camera, light), KDR_ERROR_IO,
                   "No such file or directory");
    expect_failure(kdr_camera_read(path, &hearing, NULL, light), KDR_ERROR_INVALID_ARGUMENT, "needs a file name");
}

static void every_pixel_of_a_block_comes_once_and_16_in_a_row_are_a_square(void **state) {
    (void)state;
    static uint8_t seen[KDR_BLOCK_SIDE][KDR_BLOCK_SIDE];
    uint32_t first_x = 0, first_y = 0;
    for (uint32_t i = 0; i < KDR_BLOCK_PIXELS; i++) {
        uint32_t x, y;
        kdr_block_pixel(i, &x, &y);
        assert_true(x < KDR_BLOCK_SIDE && y < KDR_BLOCK_SIDE);
        assert_int_equal(seen[y][x]++, 0);
        if (i % 16 == 0) {
            first_x = x;
            first_y = y;
        }
        assert_true(x - first_x < 4 && y - first_y < 4);
        assert_int_equal(x / 8 + y / 8 * 8, i / 64);
    }
}

/* Cells of equal area: in each row of cells, the samples' columns are all different. */
static void samples_fill_the_cells_of_their_pixel_one_by_one(void **state) {
    (void)state;
    const uint32_t counts[8] = {2, 3, 4, 7, 16, 30, 64, 1000};
    for (int n = 0; n < 8; n++) {
        kdr_strata strata = kdr_strata_make(counts[n]);
        double sum_x = 0, sum_y = 0;
        for (uint32_t s = 0; s < counts[n]; s++) {
            float x, y, again_x, again_y;
            kdr_strata_place(&strata, 5, 3, 4, s, &x, &y);
            kdr_strata_place(&strata, 5, 3, 4, s, &again_x, &again_y);
            assert_true(x >= 0 && x < 1 && y >= 0 && y < 1 && x == again_x && y == again_y);
            sum_x += x;
            sum_y += y;
        }
        expect_near(sum_x / counts[n], 0.5, 0.5 / sqrt(counts[n]));
        expect_near(sum_y / counts[n], 0.5, 0.5 / sqrt(counts[n]));
    }
    // 16 samples: 4 x 4 cells, each with one.
    kdr_strata strata = kdr_strata_make(16);
    uint32_t cells = 0;
    for (uint32_t s = 0; s < 16; s++) {
        float x, y;
        kdr_strata_place(&strata, 9, 1, 2, s, &x, &y);
        cells |= 1u << ((uint32_t)(y * 4) * 4 + (uint32_t)(x * 4));
    }
    assert_int_equal(cells, 0xffff);
}

int main(void) {
#define WITH_FILE(test) cmocka_unit_test_setup_teardown(test, make_file, remove_file)
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_through_pixel_centres_follow_the_written_formula),
        cmocka_unit_test(rows_run_down_and_columns_to_the_right),
        cmocka_unit_test(a_shadow_ray_starts_above_the_surface_and_ends_before_the_light),
        cmocka_unit_test(a_camera_that_cannot_be_is_refused_with_the_reason),
        cmocka_unit_test(cameras_work_at_huge_and_tiny_scales),
        cmocka_unit_test(the_default_camera_and_light_stand_where_the_header_says),
        cmocka_unit_test(bounds_without_size_or_without_a_model_still_give_a_camera),
        WITH_FILE(a_camera_file_gives_its_13_numbers),
        WITH_FILE(a_wrong_camera_file_names_the_number_and_what_was_found),
        cmocka_unit_test(every_pixel_of_a_block_comes_once_and_16_in_a_row_are_a_square),
        cmocka_unit_test(samples_fill_the_cells_of_their_pixel_one_by_one),
    };
    return cmocka_run_group_tests_name("cameras and rays", tests, NULL, NULL);
}
