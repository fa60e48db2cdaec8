/* Packets of 4, 8 and 16 rays in the caller's layout: copied into the form that traversals take, and answers back.
 *
 * The three widths differ only in how far a field's numbers lie apart, so one inlined body serves them. */
#include "scene/scene.h"

/* Rows of a packet of `width` rays, in the order of the fields. */
enum ray_row { ORIGIN, TMIN = 3, DIRECTION, TMAX = 8, RAY_ROWS = 12 };
enum hit_row { NORMAL, WEIGHTS = 3, PRIMITIVE = 5, GEOMETRY, INSTANCE, HIT_ROWS };

_Static_assert(sizeof(kdr_ray16) == RAY_ROWS * 16 * sizeof(float), "rows of a packet follow one another");
_Static_assert(sizeof(kdr_ray_hit16) == (RAY_ROWS + HIT_ROWS) * 16 * sizeof(float), "and so do those of its hits");
_Static_assert(offsetof(kdr_ray4, direction_x) == DIRECTION * 4 * sizeof(float), "direction");
_Static_assert(offsetof(kdr_ray4, tmax) == TMAX * 4 * sizeof(float), "tmax");
_Static_assert(offsetof(kdr_hit4, geometry) == GEOMETRY * 4 * sizeof(float), "geometry");

#define INLINE static inline __attribute__((always_inline))

/* False if no ray is active. */
INLINE bool take_rays(kdr_packet_rays *rays, const int32_t *valid, const void *from, uint32_t width) {
    const size_t row = width * sizeof(float);
    const char *at = from;
    uint64_t bits = 0;
    for (uint32_t i = 0; i < width; i++)
        bits |= (uint64_t)(!valid || valid[i] != 0) << i;
    rays->valid = bits;
    rays->count = width;
    rays->go_together = true;
    if (bits == 0)
        return false;
    for (uint32_t i = 0; i < 16; i += width) { /* lanes beyond the packet repeat it */
        for (uint32_t k = 0; k < 3; k++) {
            memcpy(&rays->origin[k][i], at + (ORIGIN + k) * row, row);
            memcpy(&rays->direction[k][i], at + (DIRECTION + k) * row, row);
        }
        memcpy(&rays->tmin[i], at + TMIN * row, row);
        memcpy(&rays->tmax[i], at + TMAX * row, row);
    }
    return true;
}

INLINE void put(void *base, uint32_t row, uint32_t width, uint32_t i, const void *number) {
    memcpy((char *)base + (row * width + i) * sizeof(float), number, sizeof(float));
}

/* Rays go one by one where custom primitives are asked too, and by a traversal by name. */
static bool go_alone(const kdr_committed *seen) { return seen->customs || seen->is_named; }

INLINE void tell_one(void *ray_hits, uint32_t width, uint32_t i, const kdr_ray_hit *one) {
    char *hits = (char *)ray_hits + RAY_ROWS * width * sizeof(float);
    if (one->hit.geometry != KDR_INVALID_ID) {
        const float *normal = &one->hit.normal_x;
        for (uint32_t k = 0; k < 3; k++)
            put(hits, NORMAL + k, width, i, &normal[k]);
        put(hits, WEIGHTS, width, i, &one->hit.u);
        put(hits, WEIGHTS + 1, width, i, &one->hit.v);
        put(hits, PRIMITIVE, width, i, &one->hit.primitive);
        put(hits, INSTANCE, width, i, &one->hit.instance);
        put(ray_hits, TMAX, width, i, &one->ray.tmax);
    }
    put(hits, GEOMETRY, width, i, &one->hit.geometry);
}

INLINE void intersect_alone(const kdr_scene *scene, const kdr_packet_rays *rays, void *ray_hits, uint32_t width) {
    for (uint64_t left = rays->valid; left; left &= left - 1) {
        uint32_t i = (uint32_t)__builtin_ctzll(left);
        kdr_ray_hit one = {.ray = kdr_packet_ray(rays, i)};
        kdr_intersect1(scene, &one);
        tell_one(ray_hits, width, i, &one);
    }
}

/* Tells of the hits that a part found, as far as they come before what the caller was told: geometries and tmax are
 * those of the closest hits so far. */
INLINE void tell(const kdr_part *part, const kdr_packet_found *found, kdr_packet_rays *rays, uint32_t *geometries,
                 void *ray_hits, uint32_t width) {
    for (uint64_t left = rays->valid; left; left &= left - 1) {
        uint32_t i = (uint32_t)__builtin_ctzll(left);
        if (found->primitive[i] == UINT32_MAX)
            continue;
        uint32_t geometry = kdr_geometry_of(part->first, part->count, found->primitive[i]);
        if (found->t[i] == rays->tmax[i] && geometry > geometries[i])
            continue;
        geometries[i] = geometry;
        rays->tmax[i] = found->t[i];
        kdr_ray_hit one = {.ray.tmax = found->t[i],
                           .hit = {.normal_x = found->normal[0][i],
                                   .normal_y = found->normal[1][i],
                                   .normal_z = found->normal[2][i],
                                   .u = found->u[i],
                                   .v = found->v[i],
                                   .primitive = found->primitive[i] - part->first[geometry],
                                   .geometry = geometry,
                                   .instance = KDR_INVALID_ID}};
        tell_one(ray_hits, width, i, &one);
    }
}

INLINE void intersect(const kdr_scene *scene, const int32_t *valid, void *ray_hits, uint32_t width) {
    kdr_packet_rays rays;
    kdr_packet_found found;
    uint32_t geometries[16];
    if (!take_rays(&rays, valid, ray_hits, width))
        return;
    kdr_visit visit = kdr_scene_enter(scene);
    const kdr_committed *seen = visit.seen;
    if (go_alone(seen)) {
        kdr_scene_leave(visit);
        intersect_alone(scene, &rays, ray_hits, width);
        return;
    }
    char *hits = (char *)ray_hits + RAY_ROWS * width * sizeof(float);
    for (uint32_t i = 0; i < width; i++) {
        geometries[i] = KDR_INVALID_ID;
        if (rays.valid >> i & 1)
            put(hits, GEOMETRY, width, i, &geometries[i]);
    }
    const kdr_part *parts[2] = {seen->dynamic_part, seen->static_part};
    for (int p = 0; p < 2 && parts[p]; p++) {
        scene->device->traversals->packet_closest(&parts[p]->tree, &rays, &found);
        tell(parts[p], &found, &rays, geometries, ray_hits, width);
    }
    kdr_scene_leave(visit);
}

INLINE uint64_t occluded_alone(const kdr_scene *scene, const kdr_packet_rays *rays) {
    uint64_t found = 0;
    for (uint64_t left = rays->valid; left; left &= left - 1) {
        uint32_t i = (uint32_t)__builtin_ctzll(left);
        kdr_ray ray = kdr_packet_ray(rays, i);
        found |= (uint64_t)kdr_occluded1(scene, &ray) << i;
    }
    return found;
}

INLINE void occluded(const kdr_scene *scene, const int32_t *valid, void *from, uint32_t width) {
    const float none = -INFINITY;
    kdr_packet_rays rays;
    if (!take_rays(&rays, valid, from, width))
        return;
    kdr_visit visit = kdr_scene_enter(scene);
    const kdr_committed *seen = visit.seen;
    uint64_t found = 0;
    if (go_alone(seen)) {
        found = occluded_alone(scene, &rays);
    } else {
        const uint64_t all = rays.valid;
        found = scene->device->traversals->packet_any(&seen->dynamic_part->tree, &rays);
        rays.valid = all & ~found;
        if (seen->static_part && rays.valid)
            found |= scene->device->traversals->packet_any(&seen->static_part->tree, &rays);
    }
    kdr_scene_leave(visit);
    for (; found; found &= found - 1)
        put(from, TMAX, width, (uint32_t)__builtin_ctzll(found), &none);
}

void kdr_intersect4(const kdr_scene *scene, const int32_t *valid, kdr_ray_hit4 *ray_hits) {
    intersect(scene, valid, ray_hits, 4);
}

void kdr_intersect8(const kdr_scene *scene, const int32_t *valid, kdr_ray_hit8 *ray_hits) {
    intersect(scene, valid, ray_hits, 8);
}

void kdr_intersect16(const kdr_scene *scene, const int32_t *valid, kdr_ray_hit16 *ray_hits) {
    intersect(scene, valid, ray_hits, 16);
}

void kdr_occluded4(const kdr_scene *scene, const int32_t *valid, kdr_ray4 *rays) { occluded(scene, valid, rays, 4); }

void kdr_occluded8(const kdr_scene *scene, const int32_t *valid, kdr_ray8 *rays) { occluded(scene, valid, rays, 8); }

void kdr_occluded16(const kdr_scene *scene, const int32_t *valid, kdr_ray16 *rays) { occluded(scene, valid, rays, 16); }
