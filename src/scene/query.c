/* Queries: what a caller asks, in terms of traversals. Nothing here allocates, locks or fails. */
#include "scene/scene.h"

kdr_trace_def kdr_default_trace_def(void) { return (kdr_trace_def){.size = sizeof(kdr_trace_def)}; }

static inline void intersect(const kdr_scene *scene, const kdr_traversals *traversals, kdr_ray_hit *ray_hit) {
    kdr_found found;
    if (!traversals->single_closest(&scene->tree, &ray_hit->ray, &found)) {
        ray_hit->hit.geometry = KDR_INVALID_ID;
        return;
    }
    uint32_t geometry = kdr_geometry_of(scene->first, scene->committed_count, found.primitive);
    ray_hit->ray.tmax = found.t;
    ray_hit->hit = (kdr_hit){.normal_x = found.normal[0],
                             .normal_y = found.normal[1],
                             .normal_z = found.normal[2],
                             .u = found.u,
                             .v = found.v,
                             .primitive = found.primitive - scene->first[geometry],
                             .geometry = geometry,
                             .instance = KDR_INVALID_ID};
}

void kdr_intersect1(const kdr_scene *scene, kdr_ray_hit *ray_hit) {
    intersect(scene, scene->device->traversals, ray_hit);
}

bool kdr_occluded1(const kdr_scene *scene, const kdr_ray *ray) {
    return scene->device->traversals->single_any(&scene->tree, ray);
}

void kdr_intersect_n(const kdr_scene *scene, const kdr_trace_def *def, kdr_ray_hit *ray_hits, size_t count) {
    (void)def; /* lone rays answer any coherence alike */
    for (size_t i = 0; i < count; i++)
        intersect(scene, scene->device->traversals, &ray_hits[i]);
}

void kdr_occluded_n(const kdr_scene *scene, const kdr_trace_def *def, const kdr_ray *rays, uint8_t *occluded,
                    size_t count) {
    (void)def;
    for (size_t i = 0; i < count; i++)
        occluded[i] = scene->device->traversals->single_any(&scene->tree, &rays[i]);
}
