/* Sorted events: where boxes begin, lie in a plane and end, on each axis, kept in order from the root down. See
 * events.c. */
#ifndef KDR_BUILD_EVENTS_H
#define KDR_BUILD_EVENTS_H

#include "build/opening.h"

/* In the order they have at one position. */
typedef enum kdr_event_type { KDR_EVENT_END, KDR_EVENT_LYING, KDR_EVENT_BEGIN } kdr_event_type;

typedef struct kdr_event {
    float position;
    uint32_t what; /* number of the reference in its node, and the type in the lowest two bits */
} kdr_event;

static inline kdr_event kdr_event_of(float position, uint32_t reference, kdr_event_type type) {
    return (kdr_event){position, reference << 2 | (uint32_t)type};
}

static inline kdr_event_type kdr_event_is(kdr_event event) { return (kdr_event_type)(event.what & 3); }

static inline uint32_t kdr_event_reference(kdr_event event) { return event.what >> 2; }

/* The order of events: no two are equal. */
static inline bool kdr_event_before(kdr_event a, kdr_event b) {
    if (a.position != b.position)
        return a.position < b.position;
    if (kdr_event_is(a) != kdr_event_is(b))
        return kdr_event_is(a) < kdr_event_is(b);
    return a.what < b.what;
}

/* Events of a node, behind its references: each list with room for two events a reference. */
typedef struct kdr_events {
    kdr_event *list[3];
    uint32_t count[3];
} kdr_events;

size_t kdr_events_bytes(uint32_t references);

/* Lays the lists into memory of that many bytes; they are empty. */
kdr_events *kdr_events_in(void *memory, uint32_t references);

/* Gives a task that has no events new memory with its references and their sorted events. Where the plan has two
 * events, boxes without extent are widened first. False when there is no memory. */
bool kdr_events_prepare(kdr_build_state *state, kdr_build_worker *worker, bool parallel, kdr_build_task *task);

/* Hands a node's events down to its children, whose references are divided. */
bool kdr_events_divide(kdr_opening *opening, const kdr_split *split, kdr_build_task children[2]);

/* Where the references of a node have gone: the number in each child. Numbers from KDR_EVENT_ANEW up have no events to
 * hand down: the reference is not in that child, or the rest of the number is its place and its events are made anew.
 */
#define KDR_EVENT_ANEW 0x80000000u
#define KDR_EVENT_NOWHERE UINT32_MAX

typedef struct kdr_descent {
    uint32_t *to[2]; /* a reference */
    uint32_t *both;  /* references that were sent to both, ascending */
    uint32_t both_count;
    bool clipped; /* the triangles of those are cut, and their events made anew */
} kdr_descent;

/* clip.c: cuts the triangles on both sides of the plane, leaves them out of a child whose cell they do not meet, and
 * closes the gaps. */
void kdr_descent_clip(const kdr_opening *opening, kdr_descent *descent, kdr_build_task children[2]);

#endif
