/* Triangles on both sides of a plane: whether they are cut, and their corners where divisions cut them.
 *
 * A box says little about a long thin triangle that lies across the axes: it meets nearly every cell, and the triangle
 * nearly none of them. So where a plan leaves it open, triangles are cut if their boxes are mostly empty. A sample is
 * asked for the shadows that triangles cast along the axes, against those of their boxes: half of them for a triangle
 * that lies along an axis, or evenly across all three, and next to nothing for a needle. Where boxes are next to empty
 * the tree may also have twice the references, if the plan leaves that open: it takes many to tell needles apart.
 *
 * Cost: some 1024 triangles are looked at; 36 bytes a primitive while the tree grows, if they are cut. */
#include "build/work.h"

#include "base/primitives.h"
#include "build/splitter.h"

#include <math.h>

#define SAMPLE_COUNT 1024
#define CORNERS_GRAIN 16384
#define SPARSE_FILL 0.5 /* below it triangles are cut: scanned models and rooms have 0.65 to 1, forests 0.33 */
#define NEEDLE_FILL 0.1 /* below it boxes say next to nothing: hair has 0.23, grass 0.18, needles 0.005 */

#define REFERENCE_LIMIT 4
#define NEEDLE_REFERENCE_LIMIT 8

/* How much of their boxes a sample of triangles fills: shadows doubled, so at most 1. */
static double fill_of(const kdr_input *input, const kdr_references *r) {
    double shadows = 0, boxes = 0;
    uint32_t step = r->count / SAMPLE_COUNT + 1;
    for (uint32_t i = 0; i < r->count; i += step) {
        float corners[3][3];
        double e[3], f[3], d[3];
        input->corners(input->context, r->primitive[i], corners);
        for (int k = 0; k < 3; k++) {
            e[k] = (double)corners[1][k] - corners[0][k];
            f[k] = (double)corners[2][k] - corners[0][k];
            d[k] = (double)r->hi[k][i] - r->lo[k][i];
        }
        for (int k = 0; k < 3; k++) {
            int l = (k + 1) % 3, m = (k + 2) % 3;
            shadows += fabs(e[l] * f[m] - e[m] * f[l]);
            boxes += d[l] * d[m];
        }
    }
    return boxes > 0 ? shadows / boxes : 1;
}

typedef struct copying {
    const kdr_input *input;
    const kdr_references *root;
    float *to;
} copying;

static void copy_range(void *context, size_t begin, size_t end, uint32_t worker) {
    (void)worker;
    const copying *c = context;
    for (size_t i = begin; i < end; i++) {
        uint32_t primitive = c->root->primitive[i];
        c->input->corners(c->input->context, primitive, (float(*)[3])(c->to + (size_t)9 * primitive));
    }
}

kdr_status kdr_build_settle_straddle(kdr_build_state *state, const kdr_references *root) {
    const kdr_input *input = state->input;
    kdr_straddle_rule *rule = &state->plan.straddle;
    float *limit = &state->plan.reference_limit;
    double fill = input->corners && (*rule == KDR_STRADDLE_AUTO || *limit == 0) ? fill_of(input, root) : 1;
    if (*limit == 0)
        *limit = fill < NEEDLE_FILL ? NEEDLE_REFERENCE_LIMIT : REFERENCE_LIMIT;
    if (*rule == KDR_STRADDLE_AUTO)
        *rule = fill < SPARSE_FILL ? KDR_STRADDLE_CLIP : KDR_STRADDLE_GENERAL;
    if (!input->corners)
        *rule = KDR_STRADDLE_GENERAL;
    if (*rule != KDR_STRADDLE_CLIP || state->splitter->prepare)
        return KDR_OK;
    state->corners_size = (size_t)input->count * 9 * sizeof(float);
    float *to = kdr_bulk_get(state->shop->bulk, &state->corners_size);
    if (!to)
        return KDR_ERROR_OUT_OF_MEMORY;
    copying c = {input, root, to};
    kdr_parallel_for(state->crew, root->count, CORNERS_GRAIN, copy_range, &c);
    state->corners = to;
    return KDR_OK;
}

void kdr_build_release_corners(kdr_build_state *state) {
    kdr_bulk_put(state->shop->bulk, (void *)state->corners, state->corners_size);
    state->corners = NULL;
}
