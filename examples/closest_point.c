#include <kdray/kdray.h>
#include <math.h>
#include <stdio.h>

static bool print_one(const kdr_point_hit *hit, void *user) {
    (void)user;
    printf("triangle %u is within 1 of the point\n", hit->primitive);
    return true;
}

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
        status = kdr_scene_commit(scene, NULL);
    if (status == KDR_OK) {
        kdr_point_query query = {.x = 1.5f, .y = -1, .z = 0, .radius = INFINITY};
        kdr_point_hit hit;
        if (kdr_closest_point(scene, &query, &hit))
            printf("closest point %g %g %g at distance %g\n", hit.x, hit.y, hit.z, hit.distance);
        query.radius = 1;
        kdr_primitives_within(scene, &query, print_one, NULL);
    }
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
    return status;
}
