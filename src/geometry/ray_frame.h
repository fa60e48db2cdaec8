/* A ray made ready for a tree: what every step and every triangle test needs of it, computed once.
 *
 * The shear is that of S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", 2013: seen along the ray,
 * with axis z the one on which the direction is longest, a point p becomes (p.x - shear_x p.z, p.y - shear_y p.z), and
 * the ray is the point (0, 0). In floats this is a filter only: `doubt` bounds its error, exact.h decides. */
#ifndef KDR_GEOMETRY_RAY_FRAME_H
#define KDR_GEOMETRY_RAY_FRAME_H

#include "geometry/box.h"
#include "kdray/kdray.h"

typedef struct kdr_ray_frame {
    float origin[3], direction[3];
    int axis_x, axis_y, axis_z;
    float shear_x, shear_y, scale_z; /* scale_z: 1 / direction on axis z */
    float doubt;                     /* at least the error of a sheared coordinate of any point in the scene's box */
} kdr_ray_frame;

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

/* The ray must be valid. */
static inline kdr_ray_frame kdr_ray_frame_of(const kdr_ray *ray, const kdr_box *bounds) {
    kdr_ray_frame f = {.origin = {ray->origin_x, ray->origin_y, ray->origin_z},
                       .direction = {ray->direction_x, ray->direction_y, ray->direction_z}};

    /* Shear along the longest axis. */
    float x = fabsf(f.direction[0]), y = fabsf(f.direction[1]), z = fabsf(f.direction[2]);
    f.axis_z = x > y ? (x > z ? 0 : 2) : (y > z ? 1 : 2);
    f.axis_x = f.axis_z == 2 ? 0 : f.axis_z + 1;
    f.axis_y = f.axis_x == 2 ? 0 : f.axis_x + 1;
    f.shear_x = f.direction[f.axis_x] / f.direction[f.axis_z];
    f.shear_y = f.direction[f.axis_y] / f.direction[f.axis_z];
    f.scale_z = 1 / f.direction[f.axis_z];

    /* With m the largest coordinate of a point seen from the origin, a sheared coordinate is off by at most
     * 2^-24 (2 + 4) m: its two terms carry one and three roundings and it has one of its own. The products of an edge
     * function add less than as much again. 16 leaves a quarter unused. */
    float m = 0;
    for (int k = 0; k < 3; k++) {
        float lo = fabsf(bounds->lo[k] - f.origin[k]), hi = fabsf(bounds->hi[k] - f.origin[k]);
        m = lo > m ? lo : m;
        m = hi > m ? hi : m;
    }
    f.doubt = 16 * 0x1p-24f * m;
    return f;
}

#endif
