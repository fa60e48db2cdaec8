/* Queries: what a caller asks, in terms of traversals. Nothing here allocates, locks or fails.
 *
 * The dynamic triangles are asked first. Where a scene has more, static triangles are asked for what is closer, then
 * custom primitives: kdr_part_closer and kdr_customs_closest choose among equal distances. */
#include "geometry/quad.h"
#include "scene/scene.h"

kdr_trace_def kdr_default_trace_def(void) { return (kdr_trace_def){.size = sizeof(kdr_trace_def)}; }

static inline bool has_more(const kdr_committed *seen) { return __builtin_expect(seen->has_more, 0); }

/* Tells the caller of a hit in a part. */
static inline void tell(const kdr_part *part, uint32_t geometry, const kdr_found *found, kdr_ray_hit *ray_hit) {
    ray_hit->ray.tmax = found->t;
    ray_hit->hit = (kdr_hit){.normal_x = found->normal[0],
                             .normal_y = found->normal[1],
                             .normal_z = found->normal[2],
                             .u = found->u,
                             .v = found->v,
                             .primitive = found->primitive - part->first[geometry],
                             .geometry = geometry,
                             .instance = KDR_INVALID_ID};
}

/* Tells the caller what the dynamic triangles' tree said. */
static inline void answer(const kdr_committed *seen, bool hit, const kdr_found *found, kdr_ray_hit *ray_hit) {
    const kdr_part *part = seen->dynamic_part;
    if (hit)
        tell(part, kdr_geometry_of(part->first, part->count, found->primitive), found, ray_hit);
    else
        ray_hit->hit.geometry = KDR_INVALID_ID;
}

/* The same of the static triangles, as far as they come before what the caller was told. */
static inline void answer_static(const kdr_part *part, const kdr_found *found, kdr_ray_hit *ray_hit) {
    uint32_t geometry = kdr_geometry_of(part->first, part->count, found->primitive);
    if (found->t < ray_hit->ray.tmax || geometry < ray_hit->hit.geometry)
        tell(part, geometry, found, ray_hit);
}

static inline void intersect(const kdr_committed *seen, kdr_ray_hit *ray_hit) {
    kdr_found found;
    const kdr_part *part = seen->dynamic_part;
    bool hit = part->lone.closest(&part->tree, &ray_hit->ray, &found);
    answer(seen, hit, &found, ray_hit);
    if (!has_more(seen))
        return;
    part = seen->static_part;
    if (part && part->lone.closest(&part->tree, &ray_hit->ray, &found))
        answer_static(part, &found, ray_hit);
    if (seen->customs)
        kdr_customs_closest(seen->customs, ray_hit);
}

static inline bool occluded(const kdr_committed *seen, const kdr_ray *ray) {
    const kdr_part *part = seen->dynamic_part;
    if (part->lone.any(&part->tree, ray))
        return true;
    part = seen->static_part;
    return has_more(seen) &&
           ((part && part->lone.any(&part->tree, ray)) || (seen->customs && kdr_customs_any(seen->customs, ray)));
}

#define FEWEST_TOGETHER 16 /* fewer rays go one by one */

/* True if the rays, one every `stride` bytes, are to go together: never by a traversal by name, else as the caller
 * says, or if most of eight of them point into one octant. Rays that point everywhere share too few nodes. */
static bool go_together(const kdr_committed *seen, const kdr_trace_def *def, const kdr_ray *rays, size_t stride,
                        size_t count) {
    kdr_coherence coherence = def ? def->coherence : KDR_COHERENCE_UNKNOWN;
    if (count < FEWEST_TOGETHER || !seen->wide || coherence == KDR_COHERENCE_INCOHERENT)
        return false;
    if (coherence == KDR_COHERENCE_COHERENT)
        return true;
    uint32_t alike = 0;
    const kdr_ray *middle = (const kdr_ray *)((const char *)rays + count / 2 * stride);
    for (size_t i = 0; i < 8; i++) {
        const kdr_ray *ray = (const kdr_ray *)((const char *)rays + i * count / 8 * stride);
        alike += (ray->direction_x < 0) == (middle->direction_x < 0) &&
                 (ray->direction_y < 0) == (middle->direction_y < 0) &&
                 (ray->direction_z < 0) == (middle->direction_z < 0);
    }
    return alike >= 6;
}

/* Four rows of four numbers become four columns. */
static inline void turn(const kdr_quad from[4], kdr_quad to[4]) {
    kdr_quad low01 = __builtin_shufflevector(from[0], from[1], 0, 4, 1, 5);
    kdr_quad low23 = __builtin_shufflevector(from[2], from[3], 0, 4, 1, 5);
    kdr_quad high01 = __builtin_shufflevector(from[0], from[1], 2, 6, 3, 7);
    kdr_quad high23 = __builtin_shufflevector(from[2], from[3], 2, 6, 3, 7);
    to[0] = __builtin_shufflevector(low01, low23, 0, 1, 4, 5);
    to[1] = __builtin_shufflevector(low01, low23, 2, 3, 6, 7);
    to[2] = __builtin_shufflevector(high01, high23, 0, 1, 4, 5);
    to[3] = __builtin_shufflevector(high01, high23, 2, 3, 6, 7);
}

/* Up to KDR_PACKET_RAYS rays as a packet, four at a time; those beyond the last repeat it. */
static void gather(kdr_packet_rays *rays, const kdr_ray *from, size_t stride, uint32_t count, bool together) {
    rays->count = count;
    rays->go_together = together;
    rays->valid = UINT64_MAX >> (KDR_PACKET_RAYS - count);
    /* The next rays are on their way while these are traced. */
    for (size_t i = 0; i < KDR_PACKET_RAYS * stride; i += 64)
        __builtin_prefetch((const void *)((uintptr_t)from + count * stride + i), 1);

    for (uint32_t i = 0; i < count || i % 16 != 0; i += 4) {
        kdr_quad at[4], to[4], columns[4];
        for (uint32_t k = 0; k < 4; k++) {
            uint32_t number = i + k < count ? i + k : count - 1;
            const kdr_ray *ray = (const kdr_ray *)((const char *)from + number * stride);
            at[k] = kdr_quad_load(&ray->origin_x);
            to[k] = kdr_quad_load(&ray->direction_x);
            rays->tmax[i + k] = ray->tmax;
        }
        turn(at, columns);
        for (uint32_t k = 0; k < 3; k++)
            kdr_quad_store(&rays->origin[k][i], columns[k]);
        kdr_quad_store(&rays->tmin[i], columns[3]);
        turn(to, columns);
        for (uint32_t k = 0; k < 3; k++)
            kdr_quad_store(&rays->direction[k][i], columns[k]);
    }
}

static inline kdr_found found_by(const kdr_packet_found *found, uint32_t i) {
    return (kdr_found){.t = found->t[i],
                       .u = found->u[i],
                       .v = found->v[i],
                       .normal = {found->normal[0][i], found->normal[1][i], found->normal[2][i]},
                       .primitive = found->primitive[i]};
}

/* Asks a packet, which has been answered by the dynamic triangles, of all else. */
static void intersect_more(const kdr_committed *seen, const kdr_traversals *traversals, kdr_packet_rays *rays,
                           kdr_ray_hit *ray_hits, uint32_t count) {
    kdr_packet_found found;
    const kdr_part *part = seen->static_part;
    if (part) {
        for (uint32_t i = 0; i < count; i++)
            rays->tmax[i] = ray_hits[i].ray.tmax;
        traversals->packet_closest(&part->tree, rays, &found);
        for (uint32_t i = 0; i < count; i++) {
            kdr_found one = found_by(&found, i);
            if (one.primitive != UINT32_MAX)
                answer_static(part, &one, &ray_hits[i]);
        }
    }
    if (seen->customs)
        kdr_customs_closest_n(seen->customs, ray_hits, count);
}

static void intersect_packet(const kdr_committed *seen, const kdr_traversals *traversals, kdr_ray_hit *ray_hits,
                             uint32_t count) {
    kdr_packet_rays rays;
    kdr_packet_found found;
    gather(&rays, &ray_hits->ray, sizeof *ray_hits, count, true);
    traversals->packet_closest(&seen->dynamic_part->tree, &rays, &found);
    for (uint32_t i = 0; i < count; i++) {
        kdr_found one = found_by(&found, i);
        answer(seen, one.primitive != UINT32_MAX, &one, &ray_hits[i]);
    }
    if (has_more(seen))
        intersect_more(seen, traversals, &rays, ray_hits, count);
}

static void occluded_packet(const kdr_committed *seen, const kdr_traversals *traversals, const kdr_ray *from,
                            uint32_t count, bool together, uint8_t *occluded) {
    kdr_packet_rays rays;
    gather(&rays, from, sizeof *from, count, together);
    uint64_t found = traversals->packet_any(&seen->dynamic_part->tree, &rays);
    if (has_more(seen) && seen->static_part) {
        rays.valid &= ~found;
        found |= rays.valid ? traversals->packet_any(&seen->static_part->tree, &rays) : 0;
    }
    for (uint32_t i = 0; i < count; i++)
        occluded[i] = found >> i & 1;
    if (!has_more(seen) || !seen->customs)
        return;
    if (together)
        kdr_customs_any_n(seen->customs, from, occluded, count);
    else
        for (uint32_t i = 0; i < count; i++)
            occluded[i] = occluded[i] || kdr_customs_any(seen->customs, &from[i]);
}

void kdr_intersect1(const kdr_scene *scene, kdr_ray_hit *ray_hit) {
    kdr_visit visit = kdr_scene_enter(scene);
    intersect(visit.seen, ray_hit);
    kdr_scene_leave(visit);
}

bool kdr_occluded1(const kdr_scene *scene, const kdr_ray *ray) {
    kdr_visit visit = kdr_scene_enter(scene);
    bool hit = occluded(visit.seen, ray);
    kdr_scene_leave(visit);
    return hit;
}

/* How many rays are left for one call, at most a packet. */
static uint32_t next_rays(size_t begin, size_t count) {
    return count - begin < KDR_PACKET_RAYS ? (uint32_t)(count - begin) : KDR_PACKET_RAYS;
}

void kdr_intersect_n(const kdr_scene *scene, const kdr_trace_def *def, kdr_ray_hit *ray_hits, size_t count) {
    kdr_visit visit = kdr_scene_enter(scene);
    for (size_t begin = 0; begin < count; begin += KDR_PACKET_RAYS) {
        kdr_ray_hit *part = ray_hits + begin;
        uint32_t rays = next_rays(begin, count);
        if (go_together(visit.seen, def, &part->ray, sizeof *part, rays)) {
            intersect_packet(visit.seen, scene->device->traversals, part, rays);
            continue;
        }
        for (uint32_t i = 0; i < rays; i++)
            intersect(visit.seen, &part[i]);
    }
    kdr_scene_leave(visit);
}

void kdr_occluded_n(const kdr_scene *scene, const kdr_trace_def *def, const kdr_ray *rays, uint8_t *hit, size_t count) {
    kdr_visit visit = kdr_scene_enter(scene);
    const bool go_apart = visit.seen->wide && scene->device->traversals->takes_any_apart;
    for (size_t begin = 0; begin < count; begin += KDR_PACKET_RAYS) {
        const kdr_ray *part = rays + begin;
        uint32_t left = next_rays(begin, count);
        bool together = go_together(visit.seen, def, part, sizeof *part, left);
        if (together || (go_apart && left >= FEWEST_TOGETHER)) {
            occluded_packet(visit.seen, scene->device->traversals, part, left, together, hit + begin);
            continue;
        }
        for (uint32_t i = 0; i < left; i++)
            hit[begin + i] = occluded(visit.seen, &part[i]);
    }
    kdr_scene_leave(visit);
}
