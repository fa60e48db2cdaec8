/* The custom primitives of a commit: their tree, and whose functions to call. Numbered through all geometries, in
 * order. Queries read nothing else of them. */
#ifndef KDR_SCENE_CUSTOMS_H
#define KDR_SCENE_CUSTOMS_H

#include "scene/device.h"
#include "scene/instances.h"

typedef struct kdr_customs {
    kdr_tree tree;
    kdr_custom_def *defs; /* a geometry, as they were when the commit ran; instances: user is a kdr_instances */
    uint32_t *first;      /* first[g] is the number of geometry g's first primitive; first[count] the total */
    uint32_t count;       /* geometries */
    bool is_taken;        /* instances have been put in the place of their defs */
    bool has_others;      /* there are primitives that are no instances */
} kdr_customs;

/* Builds the tree. defs: `count` of them, or NULL. *out becomes NULL if there is no primitive. Whatever fails, the log
 * is told, and nothing is held. listener may be NULL. Errors: OUT_OF_MEMORY, LIMIT, INVALID_DATA (a box with lo > hi),
 * CANCELLED. */
kdr_status kdr_customs_create(kdr_device *device, const kdr_custom_def *defs, uint32_t count, const kdr_plan *plan,
                              kdr_listener *listener, kdr_customs **out);

/* Custom primitives of all geometries; defs may be NULL. */
uint64_t kdr_customs_total(const kdr_custom_def *defs, uint32_t count);

/* NULL is allowed. */
void kdr_customs_destroy(kdr_customs *customs, kdr_device *device);

/* Makes an answer to a ray that the scene's triangles gave the answer of the whole scene. */
void kdr_customs_closest(const kdr_customs *customs, kdr_ray_hit *ray_hit);

/* True if the ray hits a custom primitive. */
bool kdr_customs_any(const kdr_customs *customs, const kdr_ray *ray);

/* The same for at most KDR_PACKET_RAYS rays that go together: of each instance that some of them meet, these are asked
 * at once. With primitives that are no instances, or instances too many, the rays are asked one by one. occluded[i] not
 * 0: ray i is not asked. (instance_packets.c) */
void kdr_customs_closest_n(const kdr_customs *customs, kdr_ray_hit *ray_hits, uint32_t count);
void kdr_customs_any_n(const kdr_customs *customs, const kdr_ray *rays, uint8_t *occluded, uint32_t count);

#endif
