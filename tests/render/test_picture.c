/* Pictures: values computed by hand, shadows, lights, samples, materials, odd scenes. */
#include "rendering.h"

static kdr_device *device;

static int open_device(void **state) {
    (void)state;
    device = device_of(2);
    return 0;
}

static int close_device(void **state) {
    (void)state;
    kdr_device_destroy(device);
    return kdr_render_bytes() != 0;
}

static double code_of(double linear) {
    double value = fmin(fmax(linear, 0), 1);
    return 255 * (value <= 0.0031308 ? 12.92 * value : 1.055 * pow(value, 1 / 2.4) - 0.055);
}

static void expect_code(const float *rgb, double wanted) {
    for (int k = 0; k < 3; k++)
        expect_near(code_of(rgb[k]), code_of(wanted), 1);
}

/* Phong's value at (x, y, 0) of a grey plane that faces +z, eye at (0, 0, 4). */
static double phong_at(double x, double y, const float light[3]) {
    double v[3] = {-x, -y, 4}, l[3] = {light[0] - x, light[1] - y, light[2]};
    double v_length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    double l_length = sqrt(l[0] * l[0] + l[1] * l[1] + l[2] * l[2]);
    double n_dot_l = l[2] / l_length, n_dot_v = v[2] / v_length;
    double r[3] = {-l[0] / l_length, -l[1] / l_length, l[2] / l_length};
    double r_dot_v = (r[0] * v[0] + r[1] * v[1] + r[2] * v[2]) / v_length;
    return 0.8 * (0.06 + 0.10 * n_dot_v) + 0.8 * n_dot_l + 0.12 * pow(fmax(0, r_dot_v), 32);
}

static void a_lit_square_that_faces_the_camera_has_the_values_of_the_formula(void **state) {
    (void)state;
    float positions[12];
    uint32_t indices[6];
    put_square(positions, indices, 0, 0, 0, 0, 1);
    kdr_mesh mesh = mesh_of(positions, 4, indices, 2);
    kdr_picture_def def = front_view(65);
    def.lights[0][1] = 4 * sqrtf(3); // 60 degrees off the normal in the middle
    kdr_image *image = picture_of(device, &mesh, &def, NULL);

    // In the middle: 0.8 (0.06 + 0.10) + 0.8 cos 60 degrees, and no highlight.
    expect_code(pixel_at(image, 32, 32), 0.528);
    double half = 4 * tan(acos(-1) / 8);
    int lit = 0;
    for (uint32_t j = 0; j < 65; j++) {
        for (uint32_t i = 0; i < 65; i++) {
            double x = (2 * (i + 0.5) / 65 - 1) * half, y = (1 - 2 * (j + 0.5) / 65) * half;
            bool inside = fabs(x) < 1 && fabs(y) < 1;
            lit += inside;
            if (inside)
                expect_code(pixel_at(image, i, j), phong_at(x, y, def.lights[0]));
            else
                assert_memory_equal(pixel_at(image, i, j), def.background, sizeof def.background);
        }
    }
    assert_true(lit > 1000);
    kdr_image_destroy(image);
}

static void a_highlight_stands_where_the_light_is_mirrored(void **state) {
    (void)state;
    float positions[12];
    uint32_t indices[6];
    put_square(positions, indices, 0, 0, 0, 0, 1);
    kdr_mesh mesh = mesh_of(positions, 4, indices, 2);
    kdr_mesh_material black = {.name = (char[]){"black"}};
    uint32_t materials[2] = {0, 0};
    mesh.materials = &black;
    mesh.material_count = 1;
    mesh.triangle_materials = materials;
    kdr_picture_def def = front_view(65);
    kdr_image *image = picture_of(device, &mesh, &def, NULL);
    expect_near(pixel_at(image, 32, 32)[0], 0.12, 1e-5);
    assert_true(pixel_at(image, 20, 32)[0] < 0.1f);
    kdr_image_destroy(image);
}

/* A wide wall, a small square before its middle, the light beside the eye: the shadow is as much to the left as the
 * light is to the right. */
static void a_shadow_lies_where_the_way_to_the_light_is_blocked(void **state) {
    (void)state;
    float positions[24];
    uint32_t indices[12];
    put_square(positions, indices, 0, 0, 0, 0, 3);
    put_square(positions + 12, indices + 6, 4, 0, 0, 2, 0.1f);
    kdr_mesh mesh = mesh_of(positions, 8, indices, 4);
    kdr_picture_def def = front_view(129);
    def.lights[0][0] = 1;
    kdr_picture_stats stats;
    kdr_image *image = picture_of(device, &mesh, &def, &stats);
    // The shadow is centred at x = -1 on the wall, half as wide again as the square: from -1.2 to -0.8.
    double half = 4 * tan(acos(-1) / 8);
    for (uint32_t i = 0; i < 129; i++) {
        double x = (2 * (i + 0.5) / 129 - 1) * half;
        double dark = 0.8 * (0.06 + 0.10 * 4 / sqrt(16 + x * x));
        if (fabs(x + 1) < 0.19)
            expect_code(pixel_at(image, i, 64), dark);
        else if (fabs(x + 1) > 0.21 && fabs(x) > 0.25 && fabs(x) < 1.6)
            expect_code(pixel_at(image, i, 64), phong_at(x, 0, def.lights[0]));
    }
    assert_true(stats.occluded > 100 && stats.occluded < 400);
    kdr_image_destroy(image);
}

static void lights_share_one_unit_of_brightness(void **state) {
    (void)state;
    float positions[12];
    uint32_t indices[6];
    put_square(positions, indices, 0, 0, 0, 0, 1);
    kdr_mesh mesh = mesh_of(positions, 4, indices, 2);
    kdr_picture_def def = front_view(33);
    def.lights[0][0] = 3;
    kdr_image *one = picture_of(device, &mesh, &def, NULL);
    for (uint32_t i = 1; i < KDR_MAX_LIGHTS; i++)
        memcpy(def.lights[i], def.lights[0], sizeof def.lights[0]);
    def.light_count = KDR_MAX_LIGHTS;
    kdr_image *all = picture_of(device, &mesh, &def, NULL);
    for (int i = 0; i < 33 * 33 * 3; i++)
        expect_near(all->rgb[i], one->rgb[i], 1e-5);

    // The second of two stands behind the square: half of the light remains.
    def.light_count = 2;
    def.lights[1][2] = -4;
    kdr_image *half = picture_of(device, &mesh, &def, NULL);
    double ambient = 0.8 * 0.16, full = pixel_at(one, 16, 16)[0];
    assert_true(full > ambient + 0.3);
    expect_near(pixel_at(half, 16, 16)[0], ambient + (full - ambient) / 2, 1e-5);
    kdr_image_destroy(half);
    kdr_image_destroy(all);
    kdr_image_destroy(one);
}

static void both_sides_of_a_triangle_shine_alike(void **state) {
    (void)state;
    float positions[12];
    uint32_t indices[6];
    put_square(positions, indices, 0, 0, 0, 0, 1);
    kdr_mesh mesh = mesh_of(positions, 4, indices, 2);
    kdr_picture_def def = front_view(33);
    kdr_image *front = picture_of(device, &mesh, &def, NULL);
    for (int i = 0; i < 6; i += 3) {
        uint32_t kept = indices[i];
        indices[i] = indices[i + 1];
        indices[i + 1] = kept;
    }
    kdr_image *back = picture_of(device, &mesh, &def, NULL);
    assert_memory_equal(front->rgb, back->rgb, 33 * 33 * 3 * sizeof(float));
    kdr_image_destroy(back);
    kdr_image_destroy(front);
}

static void normals_of_the_mesh_bend_the_light_and_straight_ones_change_nothing(void **state) {
    (void)state;
    float positions[12], normals[12];
    uint32_t indices[6];
    put_square(positions, indices, 0, 0, 0, 0, 1);
    kdr_mesh mesh = mesh_of(positions, 4, indices, 2);
    kdr_picture_def def = front_view(33);
    def.lights[0][0] = 2;
    kdr_image *flat = picture_of(device, &mesh, &def, NULL);
    for (int i = 0; i < 12; i++)
        normals[i] = i % 3 == 2;
    mesh.normals = normals;
    kdr_image *straight = picture_of(device, &mesh, &def, NULL);
    for (int i = 0; i < 33 * 33 * 3; i++)
        expect_near(straight->rgb[i], flat->rgb[i], 1e-6);
    for (int i = 0; i < 12; i += 3) {
        normals[i] = -0.6f;
        normals[i + 2] = 0.8f;
    }
    kdr_image *bent = picture_of(device, &mesh, &def, NULL);
    assert_true(pixel_at(bent, 16, 16)[0] < pixel_at(flat, 16, 16)[0] - 0.1f);
    kdr_image_destroy(bent);
    kdr_image_destroy(straight);
    kdr_image_destroy(flat);
}

static void triangles_have_the_colour_of_their_material(void **state) {
    (void)state;
    float positions[12];
    uint32_t indices[6], materials[2] = {1, 0};
    put_square(positions, indices, 0, 0, 0, 0, 3);
    kdr_mesh mesh = mesh_of(positions, 4, indices, 2);
    kdr_mesh_material pair[2] = {{.name = (char[]){"red"}, .diffuse = {0.5f, 0, 0}},
                                 {.name = (char[]){"green"}, .diffuse = {0, 0.5f, 0}}};
    mesh.materials = pair;
    mesh.material_count = 2;
    mesh.triangle_materials = materials;
    kdr_picture_def def = front_view(33);
    def.lights[0][0] = 40; // no highlight
    kdr_image *image = picture_of(device, &mesh, &def, NULL);
    assert_true(pixel_at(image, 30, 30)[1] > 0.05f && pixel_at(image, 30, 30)[0] < 1e-6f); // below the diagonal
    assert_true(pixel_at(image, 2, 2)[0] > 0.05f && pixel_at(image, 2, 2)[1] < 1e-6f);
    kdr_image_destroy(image);
}

/* The square's left edge cuts a column of pixels: the more samples, the nearer their mean to the covered part. */
static void samples_converge_to_the_covered_part_of_a_pixel(void **state) {
    (void)state;
    double half = 4 * tan(acos(-1) / 8), edge = (2 * 10.3 / 32 - 1) * half; // 0.7 of column 10 is covered
    float positions[12];
    uint32_t indices[6];
    put_square(positions, indices, 0, (float)(edge + 3), 0, 0, 3);
    kdr_mesh mesh = mesh_of(positions, 4, indices, 2);
    kdr_mesh_material black = {.name = (char[]){"black"}};
    uint32_t materials[2] = {0, 0};
    mesh.materials = &black;
    mesh.material_count = 1;
    mesh.triangle_materials = materials;
    kdr_picture_def def = front_view(32);
    def.lights[0][2] = -4; // black on white
    def.background[0] = def.background[1] = def.background[2] = 1;
    double before = 1;
    const uint32_t samples[3] = {1, 16, 256};
    for (int n = 0; n < 3; n++) {
        double error = 0;
        def.samples = samples[n];
        kdr_image *image = picture_of(device, &mesh, &def, NULL);
        for (uint32_t y = 0; y < 32; y++)
            error += fabs(pixel_at(image, 10, y)[0] - 0.3) / 32;
        assert_true(error < before / 3);
        before = error;
        kdr_image_destroy(image);
    }
    // Other seeds give other samples, the same seed the same.
    def.samples = 16;
    kdr_image *a = picture_of(device, &mesh, &def, NULL), *b = picture_of(device, &mesh, &def, NULL);
    def.seed = 1;
    kdr_image *c = picture_of(device, &mesh, &def, NULL);
    assert_memory_equal(a->rgb, b->rgb, 32 * 32 * 3 * sizeof(float));
    assert_memory_not_equal(a->rgb, c->rgb, 32 * 32 * 3 * sizeof(float));
    kdr_image_destroy(a);
    kdr_image_destroy(b);
    kdr_image_destroy(c);
}

static void a_mesh_without_triangles_is_all_background(void **state) {
    (void)state;
    kdr_mesh mesh = mesh_of(NULL, 0, NULL, 0);
    for (int box = 0; box < 2; box++) {
        kdr_picture_def def = front_view(70);
        def.box = box;
        kdr_picture_stats stats;
        kdr_image *image = picture_of(device, &mesh, &def, &stats);
        for (uint32_t i = 0; i < 70 * 70; i++)
            assert_memory_equal(image->rgb + 3 * i, def.background, sizeof def.background);
        assert_int_equal(stats.primary_rays, 4900);
        assert_int_equal(stats.hits + stats.shadow_rays + stats.occluded, 0);
        kdr_image_destroy(image);
    }
}

/* Two squares, one above the other, at the scale s. */
static kdr_image *picture_at_scale(float s, bool box) {
    float positions[24];
    uint32_t indices[12];
    put_square(positions, indices, 0, 0, 0, 0, 1);
    put_square(positions + 12, indices + 6, 4, 0.2f, 0.2f, 0.4f, 0.5f);
    for (int i = 0; i < 24; i++)
        positions[i] *= s;
    kdr_mesh mesh = mesh_of(positions, 8, indices, 4);
    kdr_picture_def def = front_view(64);
    def.box = box;
    float bounds[6];
    kdr_mesh_bounds(&mesh, bounds);
    def.camera = kdr_camera_for_bounds(bounds);
    kdr_light_for_bounds(bounds, def.lights[0]);
    return picture_of(device, &mesh, &def, NULL);
}

/* Powers of two: the same numbers but for their exponents. */
static void huge_and_tiny_scenes_look_like_others(void **state) {
    (void)state;
    const float scales[4] = {0x1p-110f, 0x1p-60f, 0x1p60f, 0x1p110f};
    for (int box = 0; box < 2; box++) {
        kdr_image *wanted = picture_at_scale(1, box);
        for (int i = 0; i < 4; i++) {
            kdr_image *image = picture_at_scale(scales[i], box);
            double difference;
            assert_int_equal(kdr_image_compare(image, wanted, &difference), KDR_OK);
            if (!(difference < 0.1))
                fail_msg("scale %g, box %d: differs by %g", (double)scales[i], box, difference);
            kdr_image_destroy(image);
        }
        kdr_image_destroy(wanted);
    }
}

/* A cube around the light: everything outside is in its shadow. */
static void nothing_is_black_when_the_light_is_shut_in(void **state) {
    (void)state;
    float positions[24];
    uint32_t indices[36] = {0, 1, 2, 1, 3, 2, 4, 6, 5, 5, 6, 7, 0, 4, 1, 1, 4, 5,
                            2, 3, 6, 3, 7, 6, 0, 2, 4, 2, 6, 4, 1, 5, 3, 3, 5, 7};
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 3; k++)
            positions[3 * i + k] = i >> k & 1 ? 1 : -1;
    kdr_mesh mesh = mesh_of(positions, 8, indices, 12);
    kdr_picture_def def = front_view(65);
    def.camera.eye[0] = 3;
    def.camera.eye[1] = 2;
    memset(def.lights[0], 0, sizeof def.lights[0]);
    kdr_picture_stats stats;
    kdr_image *image = picture_of(device, &mesh, &def, &stats);
    assert_true(stats.hits > 500);
    assert_int_equal(stats.occluded, stats.hits);
    for (int i = 0; i < 65 * 65 * 3; i++)
        assert_true(image->rgb[i] > 0.04f);
    kdr_image_destroy(image);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_lit_square_that_faces_the_camera_has_the_values_of_the_formula),
        cmocka_unit_test(a_highlight_stands_where_the_light_is_mirrored),
        cmocka_unit_test(a_shadow_lies_where_the_way_to_the_light_is_blocked),
        cmocka_unit_test(lights_share_one_unit_of_brightness),
        cmocka_unit_test(both_sides_of_a_triangle_shine_alike),
        cmocka_unit_test(normals_of_the_mesh_bend_the_light_and_straight_ones_change_nothing),
        cmocka_unit_test(triangles_have_the_colour_of_their_material),
        cmocka_unit_test(samples_converge_to_the_covered_part_of_a_pixel),
        cmocka_unit_test(a_mesh_without_triangles_is_all_background),
        cmocka_unit_test(huge_and_tiny_scenes_look_like_others),
        cmocka_unit_test(nothing_is_black_when_the_light_is_shut_in),
    };
    return cmocka_run_group_tests_name("pictures", tests, open_device, close_device);
}
