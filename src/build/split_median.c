/* The two medians: the middle of the cell, and the median of the centres of the primitives' boxes.
 *
 * The spatial median halves the cell whatever is in it. The object median halves the primitives, by the median of their
 * centres, which is selected without sorting (rank.c). For an even number of primitives the plane lies midway between
 * the two centres in the middle.
 *
 * Where several axes are offered, the plane that costs least by the surface area heuristic among those that separate
 * something is taken.
 *
 * Source: "Parallel KD Tree Acceleration Structures for Ray Tracing on Multi-Core Processor", thesis, 2009, section
 * 3.1: split rules, and rules for the axis.
 * Cost: spatial median O(1), object median O(N) in at most five passes, for each axis. */
#include "build/splitter.h"

static float between(float a, float b) { return (float)(0.5 * ((double)a + b)); }

static float middle_of_centres(const kdr_opening *opening, uint32_t axis) {
    uint32_t count = opening->task->references.count;
    bool even = count % 2 == 0;
    float next, lower = kdr_rank_select(opening, axis, KDR_RANK_CENTRES, (count - 1) / 2, even ? &next : NULL);
    return even ? between(lower, next) : lower;
}

static float middle_of_cell(const kdr_opening *opening, uint32_t axis) {
    return between(opening->task->cell.lo[axis], opening->task->cell.hi[axis]);
}

/* Infinite if the plane separates nothing. */
static double weigh(const kdr_opening *opening, const kdr_split *split) {
    const kdr_box *cell = &opening->task->cell;
    uint64_t left, right, count = opening->task->references.count;
    kdr_opening_count(opening, split, &left, &right);
    if (left == count && right == count)
        return INFINITY;
    kdr_fractions fractions = kdr_fractions_of(cell);
    return kdr_fraction(&fractions, split->axis, (double)split->plane - cell->lo[split->axis]) * (double)left +
           kdr_fraction(&fractions, split->axis, (double)cell->hi[split->axis] - split->plane) * (double)right;
}

static kdr_split choose(const kdr_opening *opening, uint32_t axes, float (*place)(const kdr_opening *, uint32_t)) {
    const kdr_box *cell = &opening->task->cell;
    bool single = (axes & (axes - 1)) == 0;
    kdr_split best = {.cost = INFINITY};
    double least = INFINITY;
    for (uint32_t k = 0; k < 3; k++) {
        if (!(axes >> k & 1))
            continue;
        kdr_split split = {.axis = k, .plane = place(opening, k), .flat_left = true};
        if (!(split.plane > cell->lo[k] && split.plane < cell->hi[k]))
            continue;
        double cost = single ? 0 : weigh(opening, &split);
        if (cost < least) {
            least = cost;
            best = split;
        }
    }
    return best;
}

static kdr_split choose_space(kdr_opening *opening, uint32_t axes) { return choose(opening, axes, middle_of_cell); }

static kdr_split choose_object(kdr_opening *opening, uint32_t axes) { return choose(opening, axes, middle_of_centres); }

const kdr_splitter kdr_split_space = {.choose = choose_space};
const kdr_splitter kdr_split_object = {.choose = choose_object};
