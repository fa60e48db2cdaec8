// The same from C++: the header compiles, and its names are C's.
#include <kdray/kdray.h>

#include <cstdio>
#include <limits>
#include <vector>

int main() {
    const std::vector<float> vertices = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const std::vector<uint32_t> indices = {0, 1, 2};
    kdr_device *device = nullptr;
    kdr_scene *scene = nullptr;
    kdr_triangles_def triangles = kdr_default_triangles_def();
    triangles.vertices = vertices.data();
    triangles.vertex_count = 3;
    triangles.indices = indices.data();
    triangles.triangle_count = 1;
    if (kdr_device_create(nullptr, &device) != KDR_OK || kdr_scene_create(device, &scene) != KDR_OK ||
        kdr_scene_add_triangles(scene, &triangles, nullptr) != KDR_OK || kdr_scene_commit(scene, nullptr) != KDR_OK) {
        std::fprintf(stderr, "the scene could not be made\n");
        return 1;
    }

    kdr_ray_hit hit{};
    hit.ray.origin_x = hit.ray.origin_y = 0.25f;
    hit.ray.origin_z = 3;
    hit.ray.direction_z = -2;
    hit.ray.tmax = std::numeric_limits<float>::infinity();
    kdr_intersect1(scene, &hit);
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);

    std::printf("kdray %s: distance %g\n", kdr_version(), hit.ray.tmax);
    return !(hit.hit.geometry == 0 && hit.ray.tmax == 1.5f);
}
