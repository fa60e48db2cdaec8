/* Queries: what a caller asks, in terms of traversals. Nothing here allocates, locks or fails.
 *
 * The triangles are asked first. Where a scene has custom primitives, `answer` and `any` then ask these too: no other
 * place knows of both trees. */
#include "scene/scene.h"

kdr_trace_def kdr_default_trace_def(void) { return (kdr_trace_def){.size = sizeof(kdr_trace_def)}; }

static inline bool has_customs(const kdr_scene *scene) { return __builtin_expect(scene->customs != NULL, 0); }

static inline void answer_triangles(const kdr_scene *scene, bool hit, const kdr_found *found, kdr_ray_hit *ray_hit) {
    if (!hit) {
        ray_hit->hit.geometry = KDR_INVALID_ID;
        return;
    }
    uint32_t geometry = kdr_geometry_of(scene->first, scene->committed_count, found->primitive);
    ray_hit->ray.tmax = found->t;
    ray_hit->hit = (kdr_hit){.normal_x = found->normal[0],
                             .normal_y = found->normal[1],
                             .normal_z = found->normal[2],
                             .u = found->u,
                             .v = found->v,
                             .primitive = found->primitive - scene->first[geometry],
                             .geometry = geometry,
                             .instance = KDR_INVALID_ID};
}

/* Tells the caller what the triangles' tree said, or the custom primitives' if they are closer. */
static inline void answer(const kdr_scene *scene, bool hit, const kdr_found *found, kdr_ray_hit *ray_hit) {
    answer_triangles(scene, hit, found, ray_hit);
    if (has_customs(scene))
        kdr_customs_closest(scene->customs, ray_hit);
}

/* The same for any hit. */
static inline bool any(const kdr_scene *scene, bool hit, const kdr_ray *ray) {
    return hit || (has_customs(scene) && kdr_customs_any(scene->customs, ray));
}

static inline void intersect(const kdr_scene *scene, kdr_ray_hit *ray_hit) {
    kdr_found found;
    bool hit = scene->lone.closest(&scene->tree, &ray_hit->ray, &found);
    answer(scene, hit, &found, ray_hit);
}

/* True if the rays, one every `stride` bytes, are to go together: never by a traversal by name, else as the caller
 * says, or if most of eight of them point into one octant. Rays that point everywhere share too few nodes to pay for
 * their lists. */
static bool go_together(const kdr_scene *scene, const kdr_trace_def *def, const kdr_ray *rays, size_t stride,
                        size_t count) {
    kdr_coherence coherence = def ? def->coherence : KDR_COHERENCE_UNKNOWN;
    if (count < 16 || !scene->tree.wide || coherence == KDR_COHERENCE_INCOHERENT)
        return false;
    uint32_t alike = 0;
    const kdr_ray *middle = (const kdr_ray *)((const char *)rays + count / 2 * stride);
    for (size_t i = 0; i < 8; i++) {
        const kdr_ray *ray = (const kdr_ray *)((const char *)rays + i * count / 8 * stride);
        alike += (ray->direction_x < 0) == (middle->direction_x < 0) &&
                 (ray->direction_y < 0) == (middle->direction_y < 0) &&
                 (ray->direction_z < 0) == (middle->direction_z < 0);
    }
    return coherence == KDR_COHERENCE_COHERENT || alike >= 6;
}

void kdr_intersect1(const kdr_scene *scene, kdr_ray_hit *ray_hit) { intersect(scene, ray_hit); }

bool kdr_occluded1(const kdr_scene *scene, const kdr_ray *ray) {
    return any(scene, scene->lone.any(&scene->tree, ray), ray);
}

void kdr_intersect_n(const kdr_scene *scene, const kdr_trace_def *def, kdr_ray_hit *ray_hits, size_t count) {
    const kdr_traversals *traversals = scene->device->traversals;
    for (size_t begin = 0; begin < count; begin += KDR_STREAM_RAYS) {
        kdr_ray_hit *part = ray_hits + begin;
        uint32_t rays = count - begin < KDR_STREAM_RAYS ? (uint32_t)(count - begin) : KDR_STREAM_RAYS;
        if (!go_together(scene, def, &part->ray, sizeof *part, rays)) {
            for (uint32_t i = 0; i < rays; i++)
                intersect(scene, &part[i]);
            continue;
        }
        kdr_found found[KDR_STREAM_RAYS];
        traversals->stream_closest(&scene->tree, &part->ray, sizeof *part, rays, found);
        for (uint32_t i = 0; i < rays; i++)
            answer(scene, found[i].primitive != UINT32_MAX, &found[i], &part[i]);
    }
}

void kdr_occluded_n(const kdr_scene *scene, const kdr_trace_def *def, const kdr_ray *rays, uint8_t *occluded,
                    size_t count) {
    const kdr_traversals *traversals = scene->device->traversals;
    for (size_t begin = 0; begin < count; begin += KDR_STREAM_RAYS) {
        const kdr_ray *part = rays + begin;
        uint32_t together = count - begin < KDR_STREAM_RAYS ? (uint32_t)(count - begin) : KDR_STREAM_RAYS;
        if (go_together(scene, def, part, sizeof *part, together)) {
            traversals->stream_any(&scene->tree, part, sizeof *part, together, occluded + begin);
            for (uint32_t i = 0; has_customs(scene) && i < together; i++)
                occluded[begin + i] = any(scene, occluded[begin + i], &part[i]);
            continue;
        }
        for (uint32_t i = 0; i < together; i++)
            occluded[begin + i] = any(scene, scene->lone.any(&scene->tree, &part[i]), &part[i]);
    }
}
