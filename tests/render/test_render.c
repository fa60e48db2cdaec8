/* Rendering as a job: threads, statistics, progress, cancelling, wrong requests, memory that runs out; the box. */
#include "rendering.h"

#include <stdatomic.h>

#include "support/failing_alloc.h"

static char texture[64];

static int write_texture(void **state) {
    (void)state;
    snprintf(texture, sizeof texture, "/tmp/kdr-texture-test-XXXXXX");
    int file = mkstemp(texture);
    if (file < 0 || close(file) != 0)
        return -1;
    // Red, and green in the lower half.
    kdr_image *image;
    kdr_image_create(4, 8, &image);
    for (int i = 0; i < 32; i++)
        image->rgb[3 * i + (i >= 16)] = 1;
    kdr_status status = kdr_image_write_png(image, texture, NULL);
    kdr_image_destroy(image);
    return status != KDR_OK;
}

static int remove_texture(void **state) {
    (void)state;
    return unlink(texture) != 0 || kdr_render_bytes() != 0;
}

static kdr_mesh *built_in(size_t triangle_count) {
    kdr_mesh *mesh;
    assert_int_equal(kdr_mesh_make(kdr_mesh_builtin_name(0), triangle_count, 0, NULL, &mesh), KDR_OK);
    return mesh;
}

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

static void the_image_is_the_same_to_the_byte_for_any_number_of_threads_and_any_lanes(void **state) {
    (void)state;
    kdr_mesh *mesh = built_in(3000);
    kdr_picture_def def = view_of(mesh, 150, 130);
    def.samples = 3;
    def.box = true;
    kdr_image *first = NULL;
    const struct {
        uint32_t workers;
        kdr_isa isa;
    } devices[] = {
        {1, KDR_ISA_AVX512}, {2, KDR_ISA_AVX512}, {7, KDR_ISA_AVX512}, {2, KDR_ISA_SCALAR}, {2, KDR_ISA_SSE42}};
    for (size_t i = 0; i < sizeof devices / sizeof devices[0]; i++) {
        kdr_device_def device_def = kdr_default_device_def();
        device_def.worker_count = devices[i].workers;
        device_def.isa_limit = devices[i].isa;
        kdr_device *device;
        assert_int_equal(kdr_device_create(&device_def, &device), KDR_OK);
        kdr_image *image = picture_of(device, mesh, &def, NULL);
        if (!first)
            first = image;
        assert_memory_equal(image->rgb, first->rgb, 150 * 130 * 3 * sizeof(float));
        if (image != first)
            kdr_image_destroy(image);
        kdr_device_destroy(device);
    }
    kdr_image_destroy(first);
    kdr_mesh_destroy(mesh);
}

static void statistics_add_up(void **state) {
    (void)state;
    kdr_mesh *mesh = built_in(2000);
    kdr_device *device = device_of(2);
    kdr_picture_def def = view_of(mesh, 100, 70);
    def.samples = 5;
    def.light_count = 3;
    for (int k = 0; k < 3; k++) {
        def.lights[1][k] = def.camera.eye[k];
        def.lights[2][k] = -def.lights[0][k];
    }
    kdr_picture_stats stats;
    kdr_image *image = picture_of(device, mesh, &def, &stats);
    assert_int_equal(stats.primary_rays, 100 * 70 * 5);
    assert_true(stats.hits > 0 && stats.hits <= stats.primary_rays);
    assert_int_equal(stats.shadow_rays, stats.hits * 3);
    assert_true(stats.occluded > 0 && stats.occluded < stats.shadow_rays);
    assert_int_equal(stats.tree.triangle_count, mesh->triangle_count);
    assert_true(stats.build_seconds > 0 && stats.trace_seconds > 0);
    kdr_image_destroy(image);

    def.box = true;
    image = picture_of(device, mesh, &def, &stats);
    assert_int_equal(stats.tree.triangle_count, mesh->triangle_count + 12);
    kdr_image_destroy(image);
    kdr_device_destroy(device);
    kdr_mesh_destroy(mesh);
}

/* What a progress function saw. */
typedef struct progress_log {
    atomic_int inside;
    bool overlapped, disordered;
    uint64_t calls, last, total;
    uint64_t refuse_at; /* calls; 0: never */
} progress_log;

static bool note_progress(uint64_t finished, uint64_t total, void *user) {
    progress_log *log = user;
    if (atomic_fetch_add(&log->inside, 1) != 0)
        log->overlapped = true;
    if (finished <= log->last || finished > total)
        log->disordered = true;
    log->last = finished;
    log->total = total;
    log->calls++;
    atomic_fetch_sub(&log->inside, 1);
    return log->calls != log->refuse_at;
}

static void progress_grows_to_the_total_and_is_told_by_one_thread_at_a_time(void **state) {
    (void)state;
    kdr_mesh *mesh = built_in(1000);
    kdr_device *device = device_of(4);
    kdr_picture_def def = view_of(mesh, 300, 200);
    progress_log log = {0};
    def.progress = note_progress;
    def.progress_user = &log;
    def.samples = 2;
    kdr_image_destroy(picture_of(device, mesh, &def, NULL));
    assert_true(log.calls > 0 && log.last == log.total && log.total > 0);
    assert_false(log.overlapped || log.disordered);
    kdr_device_destroy(device);
    kdr_mesh_destroy(mesh);
}

static void a_refusal_cancels_and_leaves_no_image(void **state) {
    (void)state;
    kdr_mesh *mesh = built_in(1000);
    const uint32_t workers[2] = {1, 3};
    for (int w = 0; w < 2; w++) {
        kdr_device *device = device_of(workers[w]);
        for (uint64_t n = 1; n <= 3; n++) {
            kdr_picture_def def = view_of(mesh, 300, 200);
            progress_log log = {.refuse_at = n};
            def.progress = note_progress;
            def.progress_user = &log;
            def.samples = 100;
            kdr_image *image = (kdr_image *)texture;
            told.count = 0;
            kdr_status status = kdr_picture_render(device, mesh, &def, NULL, &hearing, &image, NULL);
            expect_failure(status, KDR_ERROR_CANCELLED, "cancelled");
            assert_null(image);
            assert_int_equal(log.calls, n);
        }
        kdr_device_destroy(device);
    }
    kdr_mesh_destroy(mesh);
}

static void wrong_requests_are_refused_with_a_sentence(void **state) {
    (void)state;
    kdr_mesh *mesh = built_in(200);
    kdr_device *device = device_of(1);
    const kdr_picture_def good = view_of(mesh, 10, 10);
    kdr_picture_def bad[12];
    const char *part[12] = {"kdr_default_picture_def",
                            "65,536 pixels",
                            "65,536 pixels",
                            "samples",
                            "samples",
                            "16 lights",
                            "16 lights",
                            "light has a coordinate",
                            "background",
                            "the camera has a field of view",
                            "the camera looks along",
                            "the camera looks at the point"};
    for (int i = 0; i < 12; i++)
        bad[i] = good;
    bad[0].size = 0;
    bad[1].width = 0;
    bad[2].height = 65537;
    bad[3].samples = 0;
    bad[4].samples = 65537;
    bad[5].light_count = 0;
    bad[6].light_count = 17;
    bad[7].lights[0][1] = NAN;
    bad[8].background[2] = -1;
    bad[9].camera.fov = 180;
    for (int k = 0; k < 3; k++) {
        bad[10].camera.up[k] = good.camera.eye[k] - good.camera.target[k];
        bad[11].camera.target[k] = good.camera.eye[k];
    }
    told.count = 0;
    for (int i = 0; i < 12; i++) {
        kdr_image *image = (kdr_image *)texture;
        kdr_status status = kdr_picture_render(device, mesh, &bad[i], NULL, &hearing, &image, NULL);
        expect_failure(status, KDR_ERROR_INVALID_ARGUMENT, part[i]);
        assert_null(image);
    }
    kdr_image *image;
    expect_failure(kdr_picture_render(NULL, mesh, &good, NULL, &hearing, &image, NULL), KDR_ERROR_INVALID_ARGUMENT,
                   "needs a device");
    expect_failure(kdr_picture_render(device, NULL, &good, NULL, &hearing, &image, NULL), KDR_ERROR_INVALID_ARGUMENT,
                   "needs a device, a mesh");
    expect_failure(kdr_picture_render(device, mesh, &good, NULL, &hearing, NULL, NULL), KDR_ERROR_INVALID_ARGUMENT,
                   "room for an image");
    kdr_picture_def textured = good;
    textured.box = true;
    textured.texture = "/nowhere/wall.png";
    expect_failure(kdr_picture_render(device, mesh, &textured, NULL, &hearing, &image, NULL), KDR_ERROR_IO, "wall.png");
    kdr_device_destroy(device);
    kdr_mesh_destroy(mesh);
}

static void the_box_fills_the_picture_and_without_it_there_is_background(void **state) {
    (void)state;
    kdr_mesh *mesh = built_in(1000);
    kdr_device *device = device_of(2);
    kdr_picture_def def = view_of(mesh, 100, 100);
    kdr_picture_stats without, with;
    kdr_image_destroy(picture_of(device, mesh, &def, &without));
    def.box = true;
    kdr_image_destroy(picture_of(device, mesh, &def, &with));
    assert_true(without.hits > 500 && without.hits < without.primary_rays);
    assert_int_equal(with.hits, with.primary_rays);

    // Shadows fall on the floor.
    assert_true(with.occluded > without.occluded);
    kdr_device_destroy(device);
    kdr_mesh_destroy(mesh);
}

/* A square in a room, seen from straight ahead, far outside, with the light still farther: the near wall is neither
 * seen nor does it keep the light out. */
static void a_camera_and_a_light_outside_see_and_shine_into_the_box(void **state) {
    (void)state;
    float positions[12];
    uint32_t indices[6];
    put_square(positions, indices, 0, 0, 0, 0, 1);
    kdr_mesh mesh = mesh_of(positions, 4, indices, 2);
    kdr_device *device = device_of(2);
    kdr_picture_def def = front_view(65);
    def.camera.eye[2] = 100;
    def.camera.fov = 3;
    def.lights[0][2] = 200;
    def.box = true;
    kdr_picture_stats stats;
    kdr_image *image = picture_of(device, &mesh, &def, &stats);
    // The square in the middle: ambient, full light and highlight; the lit back wall around it.
    expect_near(pixel_at(image, 32, 32)[0], 0.128 + 0.8 + 0.12, 2e-3);
    assert_true(pixel_at(image, 5, 32)[0] > 0.2f);
    // Who looks past the room, here under its floor, sees the background.
    assert_memory_equal(pixel_at(image, 32, 64), def.background, sizeof def.background);
    assert_true(stats.hits > 2500 && stats.occluded < stats.hits / 2);
    kdr_image_destroy(image);
    kdr_device_destroy(device);
}

/* The texture is upright on the walls, whichever way is up: at the same height all have the same colour. */
static void a_texture_covers_the_walls_upright(void **state) {
    (void)state;
    float positions[12];
    uint32_t indices[6];
    put_square(positions, indices, 0, 0, 0, 0, 0.01f);
    for (int i = 0; i < 4; i++)
        positions[3 * i + 2] = i < 2 ? -0.01f : 0.01f;
    kdr_mesh mesh = mesh_of(positions, 4, indices, 2);
    kdr_device *device = device_of(2);
    const float diagonal = 0.02f * sqrtf(3);
    for (int turn = 0; turn < 12; turn++) {
        int up = turn % 3, ahead = (up + 1 + turn / 6) % 3;
        float sense = turn / 3 % 2 ? -1 : 1;
        kdr_picture_def def = front_view(65);
        def.box = true;
        def.texture = texture;
        memset(&def.camera, 0, sizeof def.camera);
        def.camera.fov = 90;
        // The picture repeats every two diagonals below the ceiling: red for one, then green for one.
        def.camera.eye[up] = def.camera.target[up] = sense * 0.6f * diagonal;
        def.camera.target[ahead] = 1;
        def.camera.up[up] = sense;
        memcpy(def.lights[0], def.camera.eye, sizeof def.camera.eye);
        kdr_image *image = picture_of(device, &mesh, &def, NULL);
        for (uint32_t x = 10; x < 55; x += 7) {
            const float *above = pixel_at(image, x, 24), *below = pixel_at(image, x, 40);
            if (!(above[0] > 0.2f && above[1] < 0.1f && below[1] > 0.2f && below[0] < 0.1f))
                fail_msg("up %g axis %d, ahead %d, column %u: (%g, %g) above (%g, %g)", (double)sense, up, ahead, x,
                         (double)above[0], (double)above[1], (double)below[0], (double)below[1]);
        }
        kdr_image_destroy(image);
    }
    kdr_device_destroy(device);
}

/* One after the other: the room's memory and the device's come from the same failing source. */
static void every_allocation_may_fail_and_nothing_is_left(void **state) {
    (void)state;
    float positions[12];
    uint32_t indices[6];
    put_square(positions, indices, 0, 0, 0, 0, 1);
    kdr_mesh mesh = mesh_of(positions, 4, indices, 2);
    failing_alloc failing;
    failing_alloc_init(&failing);
    kdr_allocator functions = failing_alloc_functions(&failing);
    kdr_mesh_memory_replace(&functions);
    kdr_device_def device_def = kdr_default_device_def();
    device_def.worker_count = 2;
    device_def.allocator = functions;

    kdr_status status = KDR_ERROR_OUT_OF_MEMORY;
    uint64_t n = 0;
    while (status != KDR_OK) {
        kdr_device *device;
        failing_alloc_fail_nth(&failing, 0);
        assert_int_equal(kdr_device_create(&device_def, &device), KDR_OK);
        kdr_picture_def def = front_view(20);
        def.box = true;
        def.texture = texture;
        kdr_image *image;
        told.count = 0;
        failing_alloc_fail_nth(&failing, ++n);
        status = kdr_picture_render(device, &mesh, &def, NULL, &hearing, &image, NULL);
        if (status == KDR_OK)
            status = kdr_image_write_png(image, texture, &hearing);
        else
            assert_null(image);
        assert_true(status == KDR_OK || status == KDR_ERROR_OUT_OF_MEMORY);
        assert_int_equal(told.count, status == KDR_OK ? 0 : 1);
        kdr_image_destroy(image);
        kdr_device_destroy(device);
        assert_true(failing_alloc_is_clean(&failing));
        assert_int_equal(kdr_render_bytes(), 0);
        assert_true(n < 1000);
    }
    assert_true(n > 20);
    kdr_mesh_memory_replace(NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_image_is_the_same_to_the_byte_for_any_number_of_threads_and_any_lanes),
        cmocka_unit_test(statistics_add_up),
        cmocka_unit_test(progress_grows_to_the_total_and_is_told_by_one_thread_at_a_time),
        cmocka_unit_test(a_refusal_cancels_and_leaves_no_image),
        cmocka_unit_test(wrong_requests_are_refused_with_a_sentence),
        cmocka_unit_test(the_box_fills_the_picture_and_without_it_there_is_background),
        cmocka_unit_test(a_camera_and_a_light_outside_see_and_shine_into_the_box),
        cmocka_unit_test(a_texture_covers_the_walls_upright),
        cmocka_unit_test(every_allocation_may_fail_and_nothing_is_left),
    };
    return cmocka_run_group_tests_name("rendering", tests, write_texture, remove_texture);
}
