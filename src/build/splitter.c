/* The table of splitters, and what they share: passes over a node, counts of a plane, rules for the axis. */
#include "build/splitter.h"

#include "base/check.h"

const kdr_splitter *kdr_splitter_for(kdr_split_rule rule) {
    static const kdr_splitter *const rows[] = {
        [KDR_SPLIT_BINNED] = &kdr_split_binned,
        [KDR_SPLIT_SPACE] = &kdr_split_space,
        [KDR_SPLIT_OBJECT] = &kdr_split_object,
    };
    KDR_CHECK((size_t)rule < sizeof rows / sizeof rows[0]);
    return rows[rule];
}

void kdr_opening_pass(const kdr_opening *opening, kdr_range_fn *fn, void *context) {
    uint32_t count = opening->task->references.count;
    if (opening->parallel) {
        kdr_parallel_for(opening->state->crew, count, KDR_PASS_GRAIN, fn, context);
        return;
    }
    for (uint32_t begin = 0; begin < count; begin += KDR_PASS_GRAIN)
        fn(context, begin, count - begin < KDR_PASS_GRAIN ? count : begin + KDR_PASS_GRAIN, 0);
}

typedef struct counting {
    const kdr_opening *opening;
    const kdr_split *split;
} counting;

static void count_range(void *context, size_t begin, size_t end, uint32_t worker) {
    (void)worker;
    const counting *c = context;
    const kdr_opening *o = c->opening;
    size_t range = begin / KDR_PASS_GRAIN;
    o->state->kernels->count(&o->task->references, (uint32_t)begin, (uint32_t)end, c->split, &o->left[range],
                             &o->right[range]);
}

void kdr_opening_count(const kdr_opening *opening, const kdr_split *split, uint64_t *left, uint64_t *right) {
    counting c = {opening, split};
    kdr_opening_pass(opening, count_range, &c);
    *left = *right = 0;
    for (uint32_t i = 0; i < opening->range_count; i++) {
        *left += opening->left[i];
        *right += opening->right[i];
    }
}

/* Axes by falling extent of the cell, equal ones by number. */
static uint32_t by_extent(const kdr_box *cell, uint32_t sets[3]) {
    double extent[3];
    uint32_t left = 7;
    for (int k = 0; k < 3; k++)
        extent[k] = (double)cell->hi[k] - cell->lo[k];
    for (int i = 0; i < 3; i++) {
        int longest = -1;
        for (int k = 0; k < 3; k++)
            if ((left >> k & 1) && (longest < 0 || extent[k] > extent[longest]))
                longest = k;
        sets[i] = 1u << longest;
        left &= ~sets[i];
    }
    return 3;
}

uint32_t kdr_single_axes(kdr_axis_rule rule, const kdr_box *cell, uint32_t depth, uint32_t sets[3]) {
    if (rule == KDR_AXIS_LONGEST)
        return by_extent(cell, sets);
    for (uint32_t i = 0; i < 3; i++)
        sets[i] = 1u << (depth + i) % 3;
    return 3;
}
