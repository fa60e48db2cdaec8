/* One renderer for many pictures: each is the one that is made afresh, whatever was made before. */
#include "rendering.h"

#include "support/failing_alloc.h"

static kdr_picture_def view_of(const kdr_mesh *mesh, uint32_t width, uint32_t height) {
    kdr_picture_def def = kdr_default_picture_def();
    float bounds[6];
    kdr_mesh_bounds(mesh, bounds);
    def.camera = kdr_camera_for_bounds(bounds);
    kdr_light_for_bounds(bounds, def.lights[0]);
    def.width = width;
    def.height = height;
    return def;
}

static void hold_picture(kdr_renderer *renderer, kdr_device *device, const kdr_mesh *mesh, const kdr_picture_def *def,
                         kdr_image **image) {
    kdr_picture_stats stats, expected_stats;
    kdr_image *expected;
    const kdr_image *before = *image;
    bool fits = before && before->width == def->width && before->height == def->height;
    assert_int_equal(kdr_picture_render(device, mesh, def, NULL, &hearing, &expected, &expected_stats), KDR_OK);
    assert_int_equal(kdr_renderer_render(renderer, mesh, def, NULL, &hearing, image, &stats), KDR_OK);
    assert_true(!fits || *image == before);
    size_t count = (size_t)def->width * def->height * 3;
    assert_int_equal((*image)->width, def->width);
    assert_memory_equal((*image)->rgb, expected->rgb, count * sizeof(float));
    assert_int_equal(stats.primary_rays, expected_stats.primary_rays);
    assert_int_equal(stats.hits, expected_stats.hits);
    assert_int_equal(stats.shadow_rays, expected_stats.shadow_rays);
    assert_int_equal(stats.tree.triangle_count, 0);

    /* Its bytes are those of the file. */
    char path[] = "/tmp/kdr-renderer-test-XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0 && close(file) == 0);
    assert_int_equal(kdr_image_write_png(*image, path, &hearing), KDR_OK);
    kdr_image *read;
    assert_int_equal(kdr_image_read_png(path, &hearing, &read), KDR_OK);
    uint8_t *bytes = malloc(2 * count);
    assert_non_null(bytes);
    kdr_image_bytes(*image, bytes);
    kdr_image_bytes(read, bytes + count);
    assert_memory_equal(bytes, bytes + count, count);
    free(bytes);
    kdr_image_destroy(read);
    kdr_image_destroy(expected);
    assert_int_equal(unlink(path), 0);
}

static void every_picture_is_the_one_that_is_made_afresh(void **state) {
    (void)state;
    static const struct {
        const char *name;
        size_t triangles;
        double time;
        uint32_t width, height;
        bool box;
    } pictures[] = {
        {"wave", 2000, 0, 40, 30, false},  {"wave", 2000, 0.5, 40, 30, false}, {"explode", 300, 1, 40, 30, true},
        {"explode", 300, 2, 40, 30, true}, {"twist", 5000, 1, 70, 20, false},  {"demo", 1000, 0, 16, 16, true},
        {"wave", 100, 3, 40, 30, false},
    };
    kdr_device_def device_def = kdr_default_device_def();
    device_def.worker_count = 2;
    kdr_device *device;
    assert_int_equal(kdr_device_create(&device_def, &device), KDR_OK);
    kdr_renderer *renderer;
    assert_int_equal(kdr_renderer_create(device, &renderer), KDR_OK);
    kdr_image *image = NULL;
    for (size_t i = 0; i < sizeof pictures / sizeof pictures[0]; i++) {
        kdr_mesh *mesh;
        assert_int_equal(kdr_mesh_make(pictures[i].name, pictures[i].triangles, pictures[i].time, NULL, &mesh), KDR_OK);
        kdr_picture_def def = view_of(mesh, pictures[i].width, pictures[i].height);
        def.box = pictures[i].box;
        hold_picture(renderer, device, mesh, &def, &image);
        kdr_mesh_destroy(mesh);
    }

    /* A mesh of nothing, and after a request that fails. */
    kdr_mesh nothing = mesh_of(NULL, 0, NULL, 0), *mesh;
    kdr_picture_def def = view_of(&nothing, 20, 20);
    def.camera = kdr_default_picture_def().camera;
    memcpy(def.lights, kdr_default_picture_def().lights, sizeof def.lights);
    hold_picture(renderer, device, &nothing, &def, &image);
    told.count = 0;
    def.samples = 0;
    expect_failure(kdr_renderer_render(renderer, &nothing, &def, NULL, &hearing, &image, NULL),
                   KDR_ERROR_INVALID_ARGUMENT, "samples");
    expect_failure(kdr_renderer_render(NULL, &nothing, &def, NULL, &hearing, &image, NULL), KDR_ERROR_INVALID_ARGUMENT,
                   "a renderer");
    assert_int_equal(kdr_mesh_make("wave", 1000, 1, NULL, &mesh), KDR_OK);
    def = view_of(mesh, 30, 30);
    hold_picture(renderer, device, mesh, &def, &image);
    kdr_mesh_destroy(mesh);

    kdr_image_destroy(image);
    kdr_renderer_destroy(renderer);
    kdr_renderer_destroy(NULL);
    assert_int_equal(kdr_renderer_create(NULL, &renderer), KDR_ERROR_INVALID_ARGUMENT);
    assert_null(renderer);
    assert_int_equal(kdr_renderer_create(device, NULL), KDR_ERROR_INVALID_ARGUMENT);
    kdr_device_destroy(device);
    assert_int_equal(kdr_render_bytes(), 0);
}

/* Every request fails in turn, of the room's memory and of the device's; the next picture is right again. */
static void a_picture_without_memory_leaves_a_renderer_that_works(void **state) {
    (void)state;
    failing_alloc failing;
    failing_alloc_init(&failing);
    kdr_allocator functions = failing_alloc_functions(&failing);
    kdr_mesh_memory_replace(&functions);
    kdr_device_def device_def = kdr_default_device_def();
    device_def.worker_count = 1;
    device_def.allocator = functions;
    kdr_device *device;
    assert_int_equal(kdr_device_create(&device_def, &device), KDR_OK);
    kdr_mesh *mesh;
    assert_int_equal(kdr_mesh_make("wave", 400, 1, NULL, &mesh), KDR_OK);
    kdr_picture_def def = view_of(mesh, 16, 16);
    uint64_t n = 0;
    for (bool done = false; !done;) {
        assert_true(++n < 1000);
        kdr_renderer *renderer;
        kdr_image *image = NULL;
        failing_alloc_fail_nth(&failing, n);
        kdr_status status = kdr_renderer_create(device, &renderer);
        if (status == KDR_OK)
            status = kdr_renderer_render(renderer, mesh, &def, NULL, NULL, &image, NULL);
        done = status == KDR_OK;
        assert_true(done || status == KDR_ERROR_OUT_OF_MEMORY);
        assert_true(done == (failing.failures == 0));
        failing_alloc_fail_nth(&failing, 0);
        if (renderer)
            assert_int_equal(kdr_renderer_render(renderer, mesh, &def, NULL, NULL, &image, NULL), KDR_OK);
        kdr_image_destroy(image);
        kdr_renderer_destroy(renderer);
        kdr_device_trim(device);
    }
    assert_true(n > 5);
    kdr_mesh_destroy(mesh);
    kdr_device_destroy(device);
    assert_true(failing_alloc_is_clean(&failing));
    kdr_mesh_memory_replace(NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_picture_is_the_one_that_is_made_afresh),
        cmocka_unit_test(a_picture_without_memory_leaves_a_renderer_that_works),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
