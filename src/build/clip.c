/* Perfect splits: a triangle on both sides of a plane is cut, so that each child sees the bounds of the part that lies
 * in its cell, and a child whose cell it does not meet does not see it at all. See geometry/clip.h for the margin.
 *
 * Source: V. Havran, "Heuristic Ray Shooting Algorithms", 2000: split clipping. Cost: two polygons a straddler, and one
 * pass over the children's references. */
#include "build/events.h"

#include "geometry/clip.h"

static kdr_box box_of(const kdr_references *r, uint32_t i) {
    return (kdr_box){{r->lo[0][i], r->lo[1][i], r->lo[2][i]}, {r->hi[0][i], r->hi[1][i], r->hi[2][i]}};
}

static void set_box(const kdr_references *r, uint32_t i, const kdr_box *box) {
    for (int k = 0; k < 3; k++) {
        r->lo[k][i] = box->lo[k];
        r->hi[k][i] = box->hi[k];
    }
}

/* A part without extent has no begin before its end: where there are two events it keeps what it had. */
static void keep_extent(const kdr_box *before, kdr_box *part) {
    for (int k = 0; k < 3; k++) {
        if (part->lo[k] < part->hi[k])
            continue;
        part->lo[k] = before->lo[k];
        part->hi[k] = before->hi[k];
    }
}

/* Cuts one triangle and says where it goes. */
static void clip_reference(const kdr_opening *o, kdr_descent *d, uint32_t reference, kdr_build_task children[2]) {
    const kdr_input *input = o->state->input;
    float corners[3][3];
    kdr_box part[2];
    bool meets[2];
    input->corners(input->context, o->task->references.primitive[reference], corners);
    for (int side = 0; side < 2; side++) {
        kdr_box box = box_of(&children[side].references, d->to[side][reference]);
        meets[side] = kdr_triangle_clip((const float(*)[3])corners, &box, &part[side]);
        if (meets[side] && o->state->plan.events == KDR_EVENTS_TWO)
            keep_extent(&box, &part[side]);
    }
    for (int side = 0; side < 2; side++) {
        if (meets[side])
            set_box(&children[side].references, d->to[side][reference], &part[side]);
        if (meets[side] || !meets[1 - side])
            d->to[side][reference] |= KDR_EVENT_ANEW;
        else
            d->to[side][reference] = KDR_EVENT_NOWHERE;
    }
}

/* Moves what is left of a child's references together, and finds their bounds. */
static void close_gaps(const kdr_opening *o, const kdr_descent *d, int side, kdr_build_task *child) {
    const kdr_references *r = &child->references;
    uint32_t *to = d->to[side], left = 0, b = 0, from = 0;
    child->box = kdr_box_empty();
    for (uint32_t i = 0; i < o->task->references.count; i++) {
        bool is_both = b < d->both_count && d->both[b] == i;
        b += is_both;
        if (to[i] == KDR_EVENT_NOWHERE) {
            from += is_both; /* it was counted when the references were divided */
            continue;
        }
        kdr_box box = box_of(r, from);
        if (left != from) {
            set_box(r, left, &box);
            r->primitive[left] = r->primitive[from];
        }
        to[i] = left++ | (to[i] & KDR_EVENT_ANEW);
        from++;
        kdr_box_add(&child->box, &box);
    }
    child->references.count = left;
}

void kdr_descent_clip(const kdr_opening *opening, kdr_descent *descent, kdr_build_task children[2]) {
    for (uint32_t b = 0; b < descent->both_count; b++)
        clip_reference(opening, descent, descent->both[b], children);
    for (int side = 0; side < 2; side++)
        close_gaps(opening, descent, side, &children[side]);
    descent->clipped = true;
}
