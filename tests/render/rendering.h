/* Small meshes, pictures of them, and the sentences that were told. */
#ifndef KDR_TESTS_RENDER_RENDERING_H
#define KDR_TESTS_RENDER_RENDERING_H

#include "kdray/render.h"
#include "mesh/mesh_memory.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static struct {
    int count;
    char last[1200];
} told;

static inline void hear(kdr_log_level level, const char *message, void *user) {
    (void)level;
    (void)user;
    told.count++;
    snprintf(told.last, sizeof told.last, "%s", message);
    assert_null(strchr(message, '\n'));
}

static const kdr_logger hearing = {hear, NULL};

/* The last call failed with this status and told exactly one sentence that holds `part`. */
static inline void expect_failure(kdr_status status, kdr_status wanted, const char *part) {
    if (status != wanted || told.count != 1 || !strstr(told.last, part))
        fail_msg("expected %s and one sentence with '%s', got %s and %d, the last '%s'", kdr_status_text(wanted), part,
                 kdr_status_text(status), told.count, told.last);
    told.count = 0;
}

/* A mesh over arrays of the test's own; not for kdr_mesh_destroy. */
static inline kdr_mesh mesh_of(float *positions, size_t vertex_count, uint32_t *indices, size_t triangle_count) {
    return (kdr_mesh){.positions = positions,
                      .vertex_count = vertex_count,
                      .indices = indices,
                      .triangle_count = triangle_count,
                      .format = "a test's own"};
}

/* Two triangles a square: half_side around (x, y), in the plane z, which faces +z. */
static inline void put_square(float *positions, uint32_t *indices, uint32_t first, float x, float y, float z,
                              float half_side) {
    const float corner[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    const uint32_t order[6] = {0, 1, 2, 0, 2, 3};
    for (int i = 0; i < 4; i++) {
        positions[3 * i] = x + half_side * corner[i][0];
        positions[3 * i + 1] = y + half_side * corner[i][1];
        positions[3 * i + 2] = z;
    }
    for (int i = 0; i < 6; i++)
        indices[i] = first + order[i];
}

/* From (0, 0, 4) to the origin, light beside the eye, on a small square picture. */
static inline kdr_picture_def front_view(uint32_t side) {
    kdr_picture_def def = kdr_default_picture_def();
    def.width = def.height = side;
    def.camera = (kdr_camera){.eye = {0, 0, 4}, .target = {0, 0, 0}, .up = {0, 1, 0}, .fov = 45};
    def.lights[0][0] = def.lights[0][1] = 0;
    def.lights[0][2] = 4;
    return def;
}

static inline kdr_device *device_of(uint32_t workers) {
    kdr_device_def def = kdr_default_device_def();
    def.worker_count = workers;
    kdr_device *device;
    assert_int_equal(kdr_device_create(&def, &device), KDR_OK);
    return device;
}

static inline kdr_image *picture_of(kdr_device *device, const kdr_mesh *mesh, const kdr_picture_def *def,
                                    kdr_picture_stats *stats) {
    kdr_image *image;
    kdr_status status = kdr_picture_render(device, mesh, def, NULL, &hearing, &image, stats);
    if (status != KDR_OK)
        fail_msg("%s: %s", kdr_status_text(status), told.last);
    return image;
}

static inline const float *pixel_at(const kdr_image *image, uint32_t x, uint32_t y) {
    return image->rgb + 3 * ((size_t)y * image->width + x);
}

static inline void expect_near(double value, double wanted, double tolerance) {
    if (!(fabs(value - wanted) <= tolerance))
        fail_msg("expected %.9g within %g, got %.9g", wanted, tolerance, value);
}

#endif
