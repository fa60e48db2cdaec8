/* Up to 64 rays that go together, in structure-of-arrays form, and what they found. */
#ifndef KDR_TRACE_PACKET_H
#define KDR_TRACE_PACKET_H

#include "kdray/kdray.h"

#define KDR_PACKET_RAYS 64

typedef struct kdr_packet_rays {
    _Alignas(64) float origin[3][KDR_PACKET_RAYS];
    float direction[3][KDR_PACKET_RAYS];
    float tmin[KDR_PACKET_RAYS], tmax[KDR_PACKET_RAYS];
    uint64_t valid;   /* bit i: ray i is to be answered; the numbers of others have no meaning */
    bool go_together; /* rays may share a walk: they start and point alike, or it is worth trying */
    uint32_t count;   /* rays beyond it are not valid, and their numbers need be set up to a multiple of 16 only */
} kdr_packet_rays;

/* One of them as a ray. */
static inline kdr_ray kdr_packet_ray(const kdr_packet_rays *rays, uint32_t i) {
    return (kdr_ray){.origin_x = rays->origin[0][i],
                     .origin_y = rays->origin[1][i],
                     .origin_z = rays->origin[2][i],
                     .tmin = rays->tmin[i],
                     .direction_x = rays->direction[0][i],
                     .direction_y = rays->direction[1][i],
                     .direction_z = rays->direction[2][i],
                     .tmax = rays->tmax[i]};
}

/* Of rays that hit nothing only `primitive` is set, to UINT32_MAX; of rays that are not valid, nothing. */
typedef struct kdr_packet_found {
    _Alignas(64) float t[KDR_PACKET_RAYS];
    float u[KDR_PACKET_RAYS], v[KDR_PACKET_RAYS], normal[3][KDR_PACKET_RAYS];
    uint32_t primitive[KDR_PACKET_RAYS];
} kdr_packet_found;

#endif
