/* Rays and hits as data: part of kdray/kdray.h, which includes it. */
#ifndef KDR_RAYS_H
#define KDR_RAYS_H

#include <stdint.h>

/* Field order is that of Embree's RTCRay; 16-byte alignment is not required. */
typedef struct kdr_ray {
    float origin_x, origin_y, origin_z;
    float tmin;                                  /* exclusive; in units of the direction's length; may be negative */
    float direction_x, direction_y, direction_z; /* any length but zero */
    float time;                                  /* not read */
    float tmax;                                  /* inclusive; infinity is allowed */
    uint32_t mask;                               /* not read */
    uint32_t id;                                 /* not read; the caller's */
    uint32_t flags;                              /* not read */
} kdr_ray;

/* Field order is that of Embree's RTCHit. Normal, u and v of a custom primitive are what its callback says. */
typedef struct kdr_hit {
    float normal_x, normal_y, normal_z; /* (b - a) x (c - a) of triangle a, b, c: not unit length */
    float u, v;                         /* hit point = (1 - u - v) a + u b + v c */
    uint32_t primitive;                 /* number of the primitive within its geometry */
    uint32_t geometry;                  /* KDR_INVALID_ID: nothing was hit */
    uint32_t instance;                  /* see kdr_scene_add_instance; KDR_INVALID_ID: in none */
} kdr_hit;

typedef struct kdr_ray_hit {
    kdr_ray ray;
    kdr_hit hit;
} kdr_ray_hit;

/* Packets of 4, 8 and 16 rays in structure-of-arrays form: ray i has element i of every array. Fields, their order and
 * what each means are those of kdr_ray and kdr_hit; the layout is that of Embree's RTCRay4 to RTCRayHit16. No alignment
 * beyond that of a float is required. */
#define KDR_PACKET_TYPES(N)                                                                                            \
    typedef struct kdr_ray##N {                                                                                        \
        float origin_x[N], origin_y[N], origin_z[N], tmin[N];                                                          \
        float direction_x[N], direction_y[N], direction_z[N], time[N];                                                 \
        float tmax[N];                                                                                                 \
        uint32_t mask[N], id[N], flags[N];                                                                             \
    } kdr_ray##N;                                                                                                      \
    typedef struct kdr_hit##N {                                                                                        \
        float normal_x[N], normal_y[N], normal_z[N], u[N], v[N];                                                       \
        uint32_t primitive[N], geometry[N], instance[N];                                                               \
    } kdr_hit##N;                                                                                                      \
    typedef struct kdr_ray_hit##N {                                                                                    \
        kdr_ray##N ray;                                                                                                \
        kdr_hit##N hit;                                                                                                \
    } kdr_ray_hit##N

KDR_PACKET_TYPES(4);
KDR_PACKET_TYPES(8);
KDR_PACKET_TYPES(16);
#undef KDR_PACKET_TYPES

#endif
