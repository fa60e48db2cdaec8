/* A ray made ready for a tree: what every step and every triangle test needs of it, computed once.
 *
 * The shear is that of S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", 2013: seen along the ray,
 * with axis z the one on which the direction is longest, a point p becomes (p.x - shear_x p.z, p.y - shear_y p.z), and
 * the ray is the point (0, 0). In floats this is a filter only: `doubt` bounds its error, exact.h decides. */
#ifndef KDR_GEOMETRY_RAY_FRAME_H
#define KDR_GEOMETRY_RAY_FRAME_H

#include "geometry/box.h"
#include "geometry/quad.h"
#include "kdray/kdray.h"

#include <stddef.h>

typedef struct kdr_ray_frame {
    float origin[4], direction[4]; /* the fourth of each has no meaning */
    uint32_t axis_x, axis_y, axis_z;
    float origin_along[3];           /* the origin on axes x, y, z */
    float shear_x, shear_y, scale_z; /* scale_z: 1 / direction on axis z */
    /* Times the largest coordinate of a sheared triangle, plus `doubt_least`: at least the error of its edge functions.
     * Infinite: nothing is known in floats. */
    float doubt, doubt_least;
} kdr_ray_frame;

/* Faces of a box in a register; the fourth number has no meaning. */
KDR_QUAD_INLINE kdr_quad kdr_quad_lo(const kdr_box *box) { return kdr_quad_load(box); }

KDR_QUAD_INLINE kdr_quad kdr_quad_hi(const kdr_box *box) {
    kdr_quad q = kdr_quad_load((const char *)box + offsetof(kdr_box, hi) - sizeof(float));
    return __builtin_shufflevector(q, q, 1, 2, 3, 3);
}

/* A ray's origin and direction in registers; the fourth number has no meaning. */
KDR_QUAD_INLINE kdr_quad kdr_quad_origin(const kdr_ray *ray) { return kdr_quad_load(ray); }

KDR_QUAD_INLINE kdr_quad kdr_quad_direction(const kdr_ray *ray) {
    return kdr_quad_load((const char *)ray + offsetof(kdr_ray, direction_x));
}

/* False if the ray can hit nothing: a component is NaN or an infinite origin or direction, the direction is zero,
 * or tmin >= tmax. */
static inline bool kdr_ray_is_valid(const kdr_ray *ray) {
    /* x - x is 0 for finite x and NaN otherwise. */
    float origin = (ray->origin_x - ray->origin_x) + (ray->origin_y - ray->origin_y) + (ray->origin_z - ray->origin_z);
    float direction = (ray->direction_x - ray->direction_x) + (ray->direction_y - ray->direction_y) +
                      (ray->direction_z - ray->direction_z);
    bool zero = ray->direction_x == 0 && ray->direction_y == 0 && ray->direction_z == 0;
    return origin + direction == 0 && !zero && ray->tmin < ray->tmax;
}

/* Up to this, in space and along the ray, no product of an edge function and a distance overflows. Beyond it nothing is
 * sure in floats. */
#define KDR_RAY_FRAME_LARGEST 0x1p40f

/* The ray must be valid. reciprocal: 1 / direction, right on the longest axis at least. */
static inline __attribute__((always_inline)) void kdr_ray_frame_set(kdr_ray_frame *f, const kdr_ray *ray,
                                                                    const float reciprocal[3], const kdr_box *bounds) {
    kdr_quad origin = kdr_quad_origin(ray), direction = kdr_quad_direction(ray);
    kdr_quad_store(f->origin, origin);
    kdr_quad_store(f->direction, direction);

    /* Shear along the longest axis. */
    float x = fabsf(ray->direction_x), y = fabsf(ray->direction_y), z = fabsf(ray->direction_z);
    f->axis_z = x > y ? (x > z ? 0 : 2) : (y > z ? 1 : 2);
    f->axis_x = f->axis_z == 2 ? 0 : f->axis_z + 1;
    f->axis_y = f->axis_x == 2 ? 0 : f->axis_x + 1;
    f->scale_z = reciprocal[f->axis_z];
    f->shear_x = f->direction[f->axis_x] * f->scale_z;
    f->shear_y = f->direction[f->axis_y] * f->scale_z;

    f->origin_along[0] = f->origin[f->axis_x];
    f->origin_along[1] = f->origin[f->axis_y];
    f->origin_along[2] = f->origin[f->axis_z];

    /* With m the largest coordinate of a point seen from the origin, a sheared coordinate is off by at most
     * e = 2^-24 (2 + 5) m: its two terms carry one and four roundings and it has one of its own. An edge function of
     * coordinates up to s is off by at most 4 e s + 2 e^2, and its products add less than as much again: 64 2^-24 m s
     * leaves an eighth unused. */
    kdr_quad lo = kdr_quad_lo(bounds), hi = kdr_quad_hi(bounds);
    float largest = kdr_quad_most(kdr_quad_max(kdr_quad_abs(lo - origin), kdr_quad_abs(hi - origin)));
    bool in_range = largest <= KDR_RAY_FRAME_LARGEST && largest * fabsf(f->scale_z) <= KDR_RAY_FRAME_LARGEST;
    f->doubt = in_range ? 64 * 0x1p-24f * largest : INFINITY;
    f->doubt_least = 0x1p-4f * f->doubt * f->doubt + 0x1p-126f;
}

#endif
