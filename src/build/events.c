/* Events are sorted once, at the root of a subtree, by position, then type, then reference, and never again: a child's
 * events are its parent's, in their order, without those of the references that went the other way.
 *
 * References on both sides of the plane. General rule: on the split axis they get an end at the plane in the left child
 * and a begin at the plane in the right one; both stand in one place of the list, among what else lies in the plane. On
 * the other axes their events are copied. Clip rule: their triangles are cut, and the events of the new boxes, few of
 * them, are sorted and merged in.
 *
 * Sources: I. Wald, V. Havran, "On building fast kd-trees for ray tracing, and on doing that in O(N log N)", 2006;
 * "Parallel KD Tree Acceleration Structures for Ray Tracing on Multi-Core Processor", thesis, 2009,
 * sections 3.1, 4.1, 4.2 (whose printed code muddles the places of straddlers' events). Invariants: each list is in
 * order; a reference has a begin and an end on each axis, or one lying event. Cost: O(N log N) to sort, O(N) a node; 48
 * bytes a reference beside its box. */
#include "build/events.h"

#include "base/primitives.h"

#include <float.h>

#define HEAD_BYTES 64

static size_t list_bytes(uint32_t references) { return ((size_t)references * 2 * sizeof(kdr_event) + 63) / 64 * 64; }

size_t kdr_events_bytes(uint32_t references) { return HEAD_BYTES + 3 * list_bytes(references); }

_Static_assert(sizeof(kdr_events) <= HEAD_BYTES && sizeof(kdr_event) == sizeof(kdr_pair), "sizes");

kdr_events *kdr_events_in(void *memory, uint32_t references) {
    kdr_events *events = memory;
    for (size_t k = 0; k < 3; k++) {
        events->list[k] = (kdr_event *)((char *)memory + HEAD_BYTES + k * list_bytes(references));
        events->count[k] = 0;
    }
    return events;
}

/* ---- making them */

/* A float as an integer of the same order; zeros are one. */
static uint32_t key_of(float x) {
    uint32_t bits;
    x += 0.0f;
    memcpy(&bits, &x, sizeof bits);
    return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

static float of_key(uint32_t key) {
    uint32_t bits = key & 0x80000000u ? key & 0x7fffffffu : ~key;
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Gives boxes without extent the least one. */
static void widen(const kdr_references *r) {
    for (int k = 0; k < 3; k++) {
        for (uint32_t i = 0; i < r->count; i++) {
            if (r->lo[k][i] < r->hi[k][i])
                continue;
            r->lo[k][i] = fmaxf(nextafterf(r->lo[k][i], -INFINITY), -FLT_MAX);
            r->hi[k][i] = fminf(nextafterf(r->hi[k][i], INFINITY), FLT_MAX);
        }
    }
}

/* Writes pairs of the events on an axis so that a stable sort by key alone puts them in order. Returns how many. */
static size_t make_pairs(const kdr_references *r, int axis, kdr_pair *pairs) {
    const float *lo = r->lo[axis], *hi = r->hi[axis];
    size_t count = 0;
    for (uint32_t i = 0; i < r->count; i++)
        if (lo[i] < hi[i])
            pairs[count++] = (kdr_pair){key_of(hi[i]), kdr_event_of(0, i, KDR_EVENT_END).what};
    for (uint32_t i = 0; i < r->count; i++)
        if (!(lo[i] < hi[i]))
            pairs[count++] = (kdr_pair){key_of(lo[i]), kdr_event_of(0, i, KDR_EVENT_LYING).what};
    for (uint32_t i = 0; i < r->count; i++)
        if (lo[i] < hi[i])
            pairs[count++] = (kdr_pair){key_of(lo[i]), kdr_event_of(0, i, KDR_EVENT_BEGIN).what};
    return count;
}

static bool make_events(kdr_build_state *state, bool parallel, const kdr_references *references, kdr_events *events,
                        kdr_buffer *scratch) {
    kdr_crew alone = {.worker_count = 1};
    for (int k = 0; k < 3; k++) {
        kdr_pair *pairs = (kdr_pair *)(void *)events->list[k];
        size_t count = make_pairs(references, k, pairs);
        if (kdr_parallel_sort(parallel ? state->crew : &alone, state->shop->alloc, scratch, pairs, count) != KDR_OK)
            return false;
        for (size_t i = 0; i < count; i++) {
            kdr_pair pair = pairs[i];
            events->list[k][i] = (kdr_event){of_key(pair.key), pair.value};
        }
        events->count[k] = (uint32_t)count;
    }
    return true;
}

bool kdr_events_prepare(kdr_build_state *state, kdr_build_worker *worker, bool parallel, kdr_build_task *task) {
    kdr_bulk *bulk = state->shop->bulk;
    uint32_t count = task->references.count;
    size_t bytes = kdr_references_bytes(count), size = bytes + kdr_events_bytes(count);
    char *memory = kdr_bulk_get(bulk, &size);
    if (!memory)
        return false;
    kdr_references references = kdr_references_in(memory, count);
    for (int k = 0; k < 3; k++) {
        memcpy(references.lo[k], task->references.lo[k], count * sizeof(float));
        memcpy(references.hi[k], task->references.hi[k], count * sizeof(float));
    }
    memcpy(references.primitive, task->references.primitive, count * sizeof(uint32_t));
    if (state->plan.events == KDR_EVENTS_TWO)
        widen(&references);

    kdr_events *events = kdr_events_in(memory + bytes, count);
    if (!make_events(state, parallel, &references, events, &worker->sorting)) {
        kdr_bulk_put(bulk, memory, size);
        return false;
    }
    kdr_bulk_put(bulk, task->memory, task->memory_size);
    task->references = references;
    task->events = events;
    task->memory = memory;
    task->memory_size = size;
    return true;
}

/* ---- handing them down */

/* One division of a node's events. */
typedef struct splicing {
    const kdr_opening *opening;
    const kdr_split *split;
    const kdr_descent *descent;
    kdr_build_task *children;
    kdr_event *made; /* scratch: events made anew, per axis two for each reference in both children */
} splicing;

static void append(kdr_events *to, uint32_t axis, kdr_event event, uint32_t reference) {
    to->list[axis][to->count[axis]++] = (kdr_event){event.position, reference << 2 | (event.what & 3)};
}

/* Appends an event to the list of each child that its reference went to. */
static inline void pass_down(const splicing *s, kdr_events *const to[2], uint32_t axis, kdr_event event) {
    uint32_t from = kdr_event_reference(event);
    for (int side = 0; side < 2; side++) {
        uint32_t number = s->descent->to[side][from];
        if (number < KDR_EVENT_ANEW)
            append(to[side], axis, event, number);
    }
}

/* Events at the plane, all of one type, of references that only touch it, and those of the references in both children,
 * in the order of the references. */
static uint32_t pass_down_at_plane(const splicing *s, kdr_events *to, int side, kdr_event_type type,
                                   const kdr_event *from, uint32_t i, uint32_t count) {
    const kdr_descent *d = s->descent;
    uint32_t axis = s->split->axis, b = 0, both_count = d->clipped ? 0 : d->both_count;
    float plane = s->split->plane;
    for (;;) {
        bool more = i < count && from[i].position == plane && kdr_event_is(from[i]) == type;
        uint32_t reference = more ? kdr_event_reference(from[i]) : UINT32_MAX;
        for (; b < both_count && d->both[b] < reference; b++)
            append(to, axis, kdr_event_of(plane, 0, type), d->to[side][d->both[b]]);
        if (!more)
            return i;
        append(to, axis, from[i], d->to[side][reference]);
        i++;
    }
}

/* On the split axis: what lies before the plane goes left, what lies behind it right. References in both have begun
 * before it and end behind it. */
static void splice_split_axis(const splicing *s, kdr_events *const to[2], const kdr_event *from, uint32_t count) {
    const kdr_descent *d = s->descent;
    uint32_t axis = s->split->axis, i = 0;
    float plane = s->split->plane;
    for (; i < count && from[i].position < plane; i++) {
        uint32_t number = d->to[0][kdr_event_reference(from[i])];
        if (number < KDR_EVENT_ANEW)
            append(to[0], axis, from[i], number);
    }
    i = pass_down_at_plane(s, to[0], 0, KDR_EVENT_END, from, i, count);
    for (; i < count && from[i].position == plane && kdr_event_is(from[i]) == KDR_EVENT_LYING; i++)
        pass_down(s, to, axis, from[i]);
    i = pass_down_at_plane(s, to[1], 1, KDR_EVENT_BEGIN, from, i, count);
    for (; i < count; i++) {
        uint32_t number = d->to[1][kdr_event_reference(from[i])];
        if (number < KDR_EVENT_ANEW)
            append(to[1], axis, from[i], number);
    }
}

static void splice_other_axis(const splicing *s, kdr_events *const to[2], uint32_t axis, const kdr_event *from,
                              uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        pass_down(s, to, axis, from[i]);
}

/* Sorts events by merging runs; scratch has room for as many. */
static void sort_events(kdr_event *events, kdr_event *scratch, size_t count) {
    if (count < 2)
        return;
    size_t half = count / 2, a = 0, b = half;
    sort_events(events, scratch, half);
    sort_events(events + half, scratch, count - half);
    for (size_t i = 0; i < count; i++) {
        bool first = a < half && (b == count || kdr_event_before(events[a], events[b]));
        scratch[i] = first ? events[a++] : events[b++];
    }
    memcpy(events, scratch, count * sizeof *events);
}

/* Merges the events of clipped references into a child's list, from the back. */
static void merge_made(const splicing *s, kdr_events *to, int side, uint32_t axis, kdr_event *made) {
    const kdr_descent *d = s->descent;
    const kdr_references *r = &s->children[side].references;
    size_t count = 0;
    for (uint32_t b = 0; b < d->both_count; b++) {
        uint32_t i = d->to[side][d->both[b]];
        if (i == KDR_EVENT_NOWHERE)
            continue;
        i &= ~KDR_EVENT_ANEW;
        float lo = r->lo[axis][i], hi = r->hi[axis][i];
        if (lo < hi)
            made[count++] = kdr_event_of(hi, i, KDR_EVENT_END);
        made[count++] = kdr_event_of(lo, i, lo < hi ? KDR_EVENT_BEGIN : KDR_EVENT_LYING);
    }
    sort_events(made, made + count, count);
    kdr_event *list = to->list[axis];
    size_t old = to->count[axis], at = old + count;
    to->count[axis] = (uint32_t)at;
    while (count > 0) {
        bool from_list = old > 0 && kdr_event_before(made[count - 1], list[old - 1]);
        list[--at] = from_list ? list[--old] : made[--count];
    }
}

static void splice_axis(void *context, uint32_t axis) {
    const splicing *s = context;
    const kdr_events *events = s->opening->task->events;
    kdr_events *const to[2] = {s->children[0].events, s->children[1].events};
    if (axis == s->split->axis)
        splice_split_axis(s, to, events->list[axis], events->count[axis]);
    else
        splice_other_axis(s, to, axis, events->list[axis], events->count[axis]);
    if (s->descent->clipped)
        for (int side = 0; side < 2; side++)
            merge_made(s, to[side], side, axis, s->made + (size_t)axis * 4 * s->descent->both_count);
}

/* Finds out where every reference went, by the rule that divided them. */
static void find_descent(const kdr_opening *o, const kdr_split *split, kdr_descent *d) {
    const kdr_references *r = &o->task->references;
    const float *lo = r->lo[split->axis], *hi = r->hi[split->axis];
    uint32_t counts[2] = {0, 0};
    d->both_count = 0;
    for (uint32_t i = 0; i < r->count; i++) {
        bool below = lo[i]<split->plane, above = hi[i]> split->plane, flat = !below && !above;
        bool left = below || (flat && split->flat_left), right = above || (flat && !split->flat_left);
        d->to[0][i] = left ? counts[0]++ : KDR_EVENT_NOWHERE;
        d->to[1][i] = right ? counts[1]++ : KDR_EVENT_NOWHERE;
        d->both[d->both_count] = i;
        d->both_count += left && right;
    }
}

bool kdr_events_divide(kdr_opening *o, const kdr_split *split, kdr_build_task children[2]) {
    kdr_arena *arena = &o->worker->arena;
    kdr_arena_mark mark = kdr_arena_save(arena);
    uint32_t count = o->task->references.count;
    kdr_descent d = {0};
    d.to[0] = kdr_arena_get(arena, count * sizeof(uint32_t));
    d.to[1] = kdr_arena_get(arena, count * sizeof(uint32_t));
    d.both = kdr_arena_get(arena, (count + (size_t)1) * sizeof(uint32_t));
    bool memory = d.to[0] && d.to[1] && d.both;
    splicing s = {.opening = o, .split = split, .descent = &d, .children = children};
    if (memory) {
        find_descent(o, split, &d);
        for (int side = 0; side < 2; side++)
            kdr_events_in(children[side].events, children[side].references.count);
        if (o->state->plan.straddle == KDR_STRADDLE_CLIP && o->state->input->corners && d.both_count > 0) {
            kdr_descent_clip(o, &d, children);
            s.made = kdr_arena_get(arena, (size_t)d.both_count * 12 * sizeof *s.made);
            memory = s.made != NULL;
        }
    }
    if (memory && o->parallel)
        kdr_crew_run(o->state->crew, splice_axis, &s, 3);
    else
        for (uint32_t axis = 0; axis < 3 && memory; axis++)
            splice_axis(&s, axis);
    kdr_arena_restore(arena, mark);
    return memory;
}
