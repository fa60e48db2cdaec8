/* Renders a small built-in scene to the file named. */
#include <kdray/render.h>

#include <stdio.h>

static void print(kdr_log_level level, const char *message, void *user) {
    (void)level;
    (void)user;
    fprintf(stderr, "%s\n", message);
}

int main(int count, char **arguments) {
    const kdr_logger logger = {print, NULL};
    kdr_device *device = NULL;
    kdr_mesh *mesh = NULL;
    kdr_image *image = NULL;
    if (count != 2 || kdr_device_create(NULL, &device) ||
        kdr_mesh_make(kdr_mesh_builtin_name(0), 1000, 0, &logger, &mesh))
        return 1;

    float bounds[6];
    kdr_picture_stats stats;
    kdr_picture_def picture = kdr_default_picture_def();
    picture.width = picture.height = 64;
    kdr_mesh_bounds(mesh, bounds);
    picture.camera = kdr_camera_for_bounds(bounds);
    kdr_light_for_bounds(bounds, picture.lights[0]);
    picture.light_count = 1;
    if (kdr_picture_render(device, mesh, &picture, NULL, &logger, &image, &stats) ||
        kdr_image_write_png(image, arguments[1], &logger))
        return 1;

    printf("%s, %zu triangles: %llu of %llu rays hit\n", mesh->format, mesh->triangle_count,
           (unsigned long long)stats.hits, (unsigned long long)stats.primary_rays);
    kdr_image_destroy(image);
    kdr_mesh_destroy(mesh);
    kdr_device_destroy(device);
    return !(stats.primary_rays == 64 * 64 && stats.hits > 0 && kdr_render_bytes() == 0);
}
