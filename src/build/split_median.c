/* The two medians: the middle of the cell, and the median of the centres of the primitives' boxes.
 *
 * The spatial median halves the cell whatever is in it. The object median halves the primitives: their centres, as
 * integers in the order of floats, are selected digit by digit from the highest on. Each digit is one pass that counts
 * the centres which agree with the digits found so far; the digit in which the median lies follows from the sums.
 * Counters are integers, so the plane is the same for any number of workers. For an even number of primitives the plane
 * lies midway between the two centres in the middle.
 *
 * Where several axes are offered, the plane that costs least by the surface area heuristic among those that separate
 * something is taken.
 *
 * Source: "Parallel KD Tree Acceleration Structures for Ray Tracing on Multi-Core Processor", thesis, 2009, section
 * 3.1: split rules, and rules for the axis.
 * Cost: spatial median O(1), object median O(N) in at most five passes, for each axis. */
#include "build/splitter.h"

#include <string.h>

#define DIGIT_BITS 8

/* A float as an integer of the same order. Zeros are one. */
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

static float between(float a, float b) { return (float)(0.5 * ((double)a + b)); }

/* A selection under way on one axis. */
typedef struct selection {
    const kdr_opening *opening;
    uint32_t axis;
    uint32_t prefix, known; /* digits of the median that were found, and which bits they are */
    uint32_t shift;         /* of the digit that is looked for */
} selection;

static uint32_t centre_key(const selection *s, size_t i) {
    const kdr_references *r = &s->opening->task->references;
    return key_of(0.5f * r->lo[s->axis][i] + 0.5f * r->hi[s->axis][i]);
}

static void tally_range(void *context, size_t begin, size_t end, uint32_t worker) {
    const selection *s = context;
    uint32_t *tallies = s->opening->scratch[worker].rank.tallies;
    for (size_t i = begin; i < end; i++) {
        uint32_t key = centre_key(s, i);
        if ((key & s->known) == s->prefix)
            tallies[key >> s->shift & (KDR_TALLIES - 1)]++;
    }
}

/* The least key above the one that was found. */
static void next_range(void *context, size_t begin, size_t end, uint32_t worker) {
    const selection *s = context;
    uint32_t *next = &s->opening->scratch[worker].rank.next;
    for (size_t i = begin; i < end; i++) {
        uint32_t key = centre_key(s, i);
        if (key > s->prefix && key < *next)
            *next = key;
    }
}

static float middle_of_centres(const kdr_opening *opening, uint32_t axis) {
    uint32_t count = opening->task->references.count, workers = opening->worker_count;
    kdr_split_scratch *scratch = opening->scratch;
    selection s = {.opening = opening, .axis = axis};
    uint32_t rank = (count - 1) / 2, equal = count; /* of the median among the `equal` keys that agree so far */
    for (s.shift = 32; s.shift > 0;) {
        s.shift -= DIGIT_BITS;
        for (uint32_t w = 0; w < workers; w++)
            memset(scratch[w].rank.tallies, 0, sizeof scratch[w].rank.tallies);
        kdr_opening_pass(opening, tally_range, &s);
        uint32_t digit = 0;
        for (;; digit++) {
            equal = 0;
            for (uint32_t w = 0; w < workers; w++)
                equal += scratch[w].rank.tallies[digit];
            if (rank < equal)
                break;
            rank -= equal;
        }
        s.prefix |= digit << s.shift;
        s.known |= (uint32_t)(KDR_TALLIES - 1) << s.shift;
    }

    /* The upper one of the two in the middle is another only if the lower one is the last of its value. */
    float lower = of_key(s.prefix);
    if (count % 2 == 1 || rank + 1 < equal)
        return lower;
    for (uint32_t w = 0; w < workers; w++)
        scratch[w].rank.next = UINT32_MAX;
    kdr_opening_pass(opening, next_range, &s);
    uint32_t next = UINT32_MAX;
    for (uint32_t w = 0; w < workers; w++)
        next = scratch[w].rank.next < next ? scratch[w].rank.next : next;
    return between(lower, of_key(next));
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
    kdr_shares shares = kdr_shares_of(cell);
    return kdr_share(&shares, split->axis, (double)split->plane - cell->lo[split->axis]) * (double)left +
           kdr_share(&shares, split->axis, (double)cell->hi[split->axis] - split->plane) * (double)right;
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
