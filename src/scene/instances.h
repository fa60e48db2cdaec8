/* Instances of a commit: a scene in a scene, with a transform. To the tree each is a custom primitive with a box. */
#ifndef KDR_SCENE_INSTANCES_H
#define KDR_SCENE_INSTANCES_H

#include "scene/device.h"

/* The instances of one geometry, as they were when the commit ran. */
typedef struct kdr_instances {
    kdr_instance_def def;
    kdr_box bounds; /* of the scene that they show */
    struct kdr_instance_place *places;
    uint32_t first; /* number of its first instance among all of the scene */
} kdr_instances;

/* Takes the def as it is now. Transforms are read by kdr_instances_bounds, once each. NULL: no memory. */
kdr_instances *kdr_instances_create(kdr_device *device, const kdr_instance_def *def);
void kdr_instances_destroy(kdr_instances *instances, kdr_device *device);

/* The bounds callback of instances; user: a kdr_instances. A box that is NaN for an instance that is left out, upside
 * down for one whose transform has no inverse. Marks a custom def as one of instances; its user is then a
 * kdr_instance_def until a commit has put a kdr_instances there. */
void kdr_instances_bounds(uint32_t instance, float lo[3], float hi[3], void *user);

/* The closest hit of a ray in an instance, at most at tmax; distances are those of the ray given. Primitive and
 * geometry of *met become those of what was hit, in the scene that holds it. */
bool kdr_instances_closest(const kdr_instances *instances, uint32_t instance, const kdr_ray *ray, kdr_custom_hit *hit,
                           kdr_hit *met);
bool kdr_instances_any(const kdr_instances *instances, uint32_t instance, const kdr_ray *ray);

/* What these two are made of: whether a ray is asked of an instance at all, and where it enters its box; the ray as the
 * scene sees it that is shown; and a hit there, of which hit->t, u, v and the normal are set. */
bool kdr_instances_meet(const kdr_instances *instances, uint32_t instance, const kdr_ray *ray, float *entry);
kdr_ray kdr_instances_take_in(const kdr_instances *instances, uint32_t instance, const kdr_ray *ray);
void kdr_instances_take_out(const kdr_instances *instances, uint32_t instance, const kdr_ray_hit *inside,
                            kdr_custom_hit *hit);

#endif
