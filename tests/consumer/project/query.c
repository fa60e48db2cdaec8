/* One triangle, one ray that meets it and one that does not: the distances must be exact. */
#include <kdray/kdray.h>

#include <math.h>
#include <stdio.h>

int main(void) {
    static const float vertices[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    kdr_device *device = NULL;
    kdr_scene *scene = NULL;
    kdr_triangles_def triangles = kdr_default_triangles_def();
    triangles.vertices = vertices;
    triangles.vertex_count = 3;
    triangles.triangle_count = 1;
    if (kdr_device_create(NULL, &device) || kdr_scene_create(device, &scene) ||
        kdr_scene_add_triangles(scene, &triangles, NULL) || kdr_scene_commit(scene, NULL)) {
        fprintf(stderr, "the scene could not be made\n");
        return 1;
    }

    kdr_ray_hit hit = {
        .ray = {.origin_x = 0.25f, .origin_y = 0.25f, .origin_z = -2, .direction_z = 1, .tmax = INFINITY}};
    kdr_intersect1(scene, &hit);
    kdr_ray aside = {.origin_x = 2, .origin_z = -2, .direction_z = 1, .tmax = INFINITY};
    bool occluded = kdr_occluded1(scene, &aside);
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);

    printf("kdray %s: distance %g, u %g, v %g\n", kdr_version(), hit.ray.tmax, hit.hit.u, hit.hit.v);
    return !(hit.hit.geometry == 0 && hit.hit.primitive == 0 && hit.ray.tmax == 2 && hit.hit.u == 0.25f &&
             hit.hit.v == 0.25f && !occluded);
}
