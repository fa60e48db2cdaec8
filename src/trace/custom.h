/* Rays asked of a tree whose leaves hold boxes: whether a primitive is hit, a function says. */
#ifndef KDR_TRACE_CUSTOM_H
#define KDR_TRACE_CUSTOM_H

#include "tree/boxed.h"

/* Who answers for the primitives. The ray's tmax is the distance of the closest hit so far. */
typedef struct kdr_custom_answers {
    void *context;
    bool (*intersect)(void *context, const kdr_ray *ray, uint32_t primitive, kdr_custom_hit *hit);
    void (*take)(void *context); /* what intersect said last is the closest hit so far */
    bool (*occluded)(void *context, const kdr_ray *ray, uint32_t primitive);
} kdr_custom_answers;

/* True, and *hit and *primitive set, if the ray hits something. Of hits at tmax itself only those of primitives below
 * `limit` count, so that a search can go on where another one ended. */
bool kdr_custom_closest(const kdr_tree *tree, const kdr_custom_answers *answers, const kdr_ray *ray, uint32_t limit,
                        kdr_custom_hit *hit, uint32_t *primitive);
bool kdr_custom_any(const kdr_tree *tree, const kdr_custom_answers *answers, const kdr_ray *ray);

#endif
