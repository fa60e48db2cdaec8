#include <kdray/kdray.h>
#include <math.h>
#include <stdio.h>

int main(void) {
    static const float vertices[] = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
    static const uint32_t indices[] = {0, 1, 2, 0, 2, 3};
    kdr_triangles_def square = kdr_default_triangles_def();
    square.vertices = vertices;
    square.vertex_count = 4;
    square.indices = indices;
    square.triangle_count = 2;

    kdr_device *device = NULL;
    kdr_scene *scene = NULL;
    kdr_status status = kdr_device_create(NULL, &device);
    if (status == KDR_OK)
        status = kdr_scene_create(device, &scene);
    if (status == KDR_OK)
        status = kdr_scene_add_triangles(scene, &square, NULL);
    if (status == KDR_OK)
        status = kdr_scene_commit(scene, NULL); /* again when the arrays have changed */
    if (status == KDR_OK) {
        kdr_ray_hit ray = {.ray = {.origin_x = 0.5f, .origin_z = -2, .direction_z = 1, .tmax = INFINITY}};
        kdr_intersect1(scene, &ray);
        printf("triangle %u at distance %g\n", ray.hit.primitive, ray.ray.tmax);
    }
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
    return status;
}
