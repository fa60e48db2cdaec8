/* Queries: what a caller asks, in terms of traversals. Nothing here allocates, locks or fails. */
#include "scene/scene.h"

kdr_trace_def kdr_default_trace_def(void) { return (kdr_trace_def){.size = sizeof(kdr_trace_def)}; }

static inline void answer(const kdr_scene *scene, bool hit, const kdr_found *found, kdr_ray_hit *ray_hit) {
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

static inline void intersect(const kdr_scene *scene, const kdr_traversals *traversals, kdr_ray_hit *ray_hit) {
    kdr_found found;
    bool hit = traversals->single_closest(&scene->tree, &ray_hit->ray, &found);
    answer(scene, hit, &found, ray_hit);
}

/* True if the rays, one every `stride` bytes, are to go together: as the caller says, or if most of eight of them point
 * into one octant. Rays that point everywhere share too few nodes to pay for their lists. */
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

/* Up to KDR_PACKET_RAYS rays as a packet. */
static void gather(kdr_packet_rays *rays, const kdr_ray *from, size_t stride, uint32_t count) {
    rays->count = count;
    rays->valid = UINT64_MAX >> (KDR_PACKET_RAYS - count);
    for (uint32_t i = 0; i < count || i % 16 != 0; i++) {
        const kdr_ray *ray = (const kdr_ray *)((const char *)from + (i < count ? i : 0) * stride);
        rays->origin[0][i] = ray->origin_x;
        rays->origin[1][i] = ray->origin_y;
        rays->origin[2][i] = ray->origin_z;
        rays->direction[0][i] = ray->direction_x;
        rays->direction[1][i] = ray->direction_y;
        rays->direction[2][i] = ray->direction_z;
        rays->tmin[i] = ray->tmin;
        rays->tmax[i] = ray->tmax;
    }
}

static void intersect_packet(const kdr_scene *scene, kdr_ray_hit *ray_hits, uint32_t count) {
    kdr_packet_rays rays;
    kdr_packet_found found;
    gather(&rays, &ray_hits->ray, sizeof *ray_hits, count);
    scene->device->traversals->packet_closest(&scene->tree, &rays, &found);
    for (uint32_t i = 0; i < count; i++) {
        kdr_found one = {.t = found.t[i],
                         .u = found.u[i],
                         .v = found.v[i],
                         .normal = {found.normal[0][i], found.normal[1][i], found.normal[2][i]},
                         .primitive = found.primitive[i]};
        answer(scene, one.primitive != UINT32_MAX, &one, &ray_hits[i]);
    }
}

static void occluded_packet(const kdr_scene *scene, const kdr_ray *from, uint32_t count, uint8_t *occluded) {
    kdr_packet_rays rays;
    gather(&rays, from, sizeof *from, count);
    uint64_t found = scene->device->traversals->packet_any(&scene->tree, &rays);
    for (uint32_t i = 0; i < count; i++)
        occluded[i] = found >> i & 1;
}

void kdr_intersect1(const kdr_scene *scene, kdr_ray_hit *ray_hit) {
    intersect(scene, scene->device->traversals, ray_hit);
}

bool kdr_occluded1(const kdr_scene *scene, const kdr_ray *ray) {
    return scene->device->traversals->single_any(&scene->tree, ray);
}

void kdr_intersect_n(const kdr_scene *scene, const kdr_trace_def *def, kdr_ray_hit *ray_hits, size_t count) {
    const kdr_traversals *traversals = scene->device->traversals;
    for (size_t begin = 0; begin < count; begin += KDR_STREAM_RAYS) {
        kdr_ray_hit *part = ray_hits + begin;
        uint32_t rays = count - begin < KDR_STREAM_RAYS ? (uint32_t)(count - begin) : KDR_STREAM_RAYS;
        if (!go_together(scene, def, &part->ray, sizeof *part, rays)) {
            for (uint32_t i = 0; i < rays; i++)
                intersect(scene, traversals, &part[i]);
            continue;
        }
        for (uint32_t i = 0; i < rays; i += KDR_PACKET_RAYS)
            intersect_packet(scene, part + i, rays - i < KDR_PACKET_RAYS ? rays - i : KDR_PACKET_RAYS);
    }
}

void kdr_occluded_n(const kdr_scene *scene, const kdr_trace_def *def, const kdr_ray *rays, uint8_t *occluded,
                    size_t count) {
    const kdr_traversals *traversals = scene->device->traversals;
    for (size_t begin = 0; begin < count; begin += KDR_STREAM_RAYS) {
        const kdr_ray *part = rays + begin;
        uint32_t together = count - begin < KDR_STREAM_RAYS ? (uint32_t)(count - begin) : KDR_STREAM_RAYS;
        if (go_together(scene, def, part, sizeof *part, together)) {
            for (uint32_t i = 0; i < together; i += KDR_PACKET_RAYS)
                occluded_packet(scene, part + i, together - i < KDR_PACKET_RAYS ? together - i : KDR_PACKET_RAYS,
                                occluded + begin + i);
            continue;
        }
        for (uint32_t i = 0; i < together; i++)
            occluded[begin + i] = traversals->single_any(&scene->tree, &part[i]);
    }
}
