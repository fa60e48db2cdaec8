/* Pictures through lazy trees: the same ones as through whole trees, a hundred times over, while threads race to open
 * what their pixels need. */
#include "rendering.h"

#include "support/test_size.h"

#define TRIANGLES TEST_SIZE(4000)
#define RUNS TEST_SIZE(100)

static void a_hundred_runs_on_every_scene_give_the_picture_of_the_whole_tree(void **state) {
    (void)state;
    kdr_device_def device_def = kdr_default_device_def();
    device_def.worker_count = 4;
    kdr_device *device;
    kdr_renderer *renderer;
    assert_int_equal(kdr_device_create(&device_def, &device), KDR_OK);
    assert_int_equal(kdr_renderer_create(device, &renderer), KDR_OK);
    kdr_build_def whole = kdr_quality_build_def(KDR_QUALITY_FAST), lazy = kdr_quality_build_def(KDR_QUALITY_LAZY);
    kdr_image *image = NULL;

    for (size_t scene = 0; kdr_mesh_builtin_name(scene); scene++) {
        const char *name = kdr_mesh_builtin_name(scene);
        kdr_mesh *mesh;
        assert_int_equal(kdr_mesh_make(name, TRIANGLES, 0.5, &hearing, &mesh), KDR_OK);
        kdr_picture_def def = kdr_default_picture_def();
        float bounds[6];
        kdr_mesh_bounds(mesh, bounds);
        def.camera = kdr_camera_for_bounds(bounds);
        kdr_light_for_bounds(bounds, def.lights[0]);
        def.width = 100;
        def.height = 70;
        kdr_image *expected;
        kdr_picture_stats of_whole;
        assert_int_equal(kdr_picture_render(device, mesh, &def, &whole, &hearing, &expected, &of_whole), KDR_OK);
        for (int run = 0; run < RUNS; run++) {
            lazy.lazy_limit = KDR_MIN_LAZY_LIMIT << run % 5;
            kdr_picture_stats stats;
            assert_int_equal(kdr_renderer_render(renderer, mesh, &def, &lazy, &hearing, &image, &stats), KDR_OK);
            if (memcmp(image->rgb, expected->rgb, 3 * sizeof(float) * def.width * def.height) != 0)
                fail_msg("%s: run %d has another picture", name, run);
            assert_true(stats.hits == of_whole.hits && stats.occluded == of_whole.occluded);
        }
        kdr_image_destroy(expected);
        kdr_mesh_destroy(mesh);
    }
    kdr_image_destroy(image);
    kdr_renderer_destroy(renderer);
    kdr_device_destroy(device);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_hundred_runs_on_every_scene_give_the_picture_of_the_whole_tree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
