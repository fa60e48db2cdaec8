/* Selection by digits: numbers as integers in the order of floats are selected digit by digit from the highest on. Each
 * digit is one pass that counts the numbers which agree with the digits found so far; the digit in which the rank lies
 * follows from the sums. Counters are integers, so the outcome is the same for any number of workers. */
#include "build/rank.h"

#include "build/opening.h"

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

/* A selection under way on one axis. */
typedef struct selection {
    const kdr_opening *opening;
    const float *lo, *hi;
    kdr_rank_of of;
    uint32_t prefix, known; /* digits that were found, and which bits they are */
    uint32_t shift;         /* of the digit that is looked for */
} selection;

/* The numbers of reference i; returns how many. */
static inline uint32_t keys_of(const selection *s, size_t i, uint32_t keys[2]) {
    if (s->of == KDR_RANK_CENTRES) {
        keys[0] = key_of(0.5f * s->lo[i] + 0.5f * s->hi[i]);
        return 1;
    }
    keys[0] = key_of(s->lo[i]);
    keys[1] = key_of(s->hi[i]);
    return 2;
}

static void tally_range(void *context, size_t begin, size_t end, uint32_t worker) {
    const selection *s = context;
    uint32_t *tallies = s->opening->scratch[worker].tallies.tallies;
    for (size_t i = begin; i < end; i++) {
        uint32_t keys[2], count = keys_of(s, i, keys);
        for (uint32_t j = 0; j < count; j++)
            if ((keys[j] & s->known) == s->prefix)
                tallies[keys[j] >> s->shift & (KDR_RANK_TALLIES - 1)]++;
    }
}

/* The least key above the one that was found. */
static void next_range(void *context, size_t begin, size_t end, uint32_t worker) {
    const selection *s = context;
    uint32_t *next = &s->opening->scratch[worker].tallies.next;
    for (size_t i = begin; i < end; i++) {
        uint32_t keys[2], count = keys_of(s, i, keys);
        for (uint32_t j = 0; j < count; j++)
            if (keys[j] > s->prefix && keys[j] < *next)
                *next = keys[j];
    }
}

static float find_next(const selection *s) {
    const kdr_opening *opening = s->opening;
    for (uint32_t w = 0; w < opening->worker_count; w++)
        opening->scratch[w].tallies.next = UINT32_MAX;
    kdr_opening_pass(opening, next_range, (void *)s);
    uint32_t next = UINT32_MAX;
    for (uint32_t w = 0; w < opening->worker_count; w++)
        next = opening->scratch[w].tallies.next < next ? opening->scratch[w].tallies.next : next;
    return of_key(next < UINT32_MAX ? next : s->prefix);
}

float kdr_rank_select(const kdr_opening *opening, uint32_t axis, kdr_rank_of of, uint64_t rank, float *next) {
    const kdr_references *r = &opening->task->references;
    kdr_split_scratch *scratch = opening->scratch;
    selection s = {.opening = opening, .lo = r->lo[axis], .hi = r->hi[axis], .of = of};
    uint64_t equal = 0; /* keys that agree so far; rank counts among them */
    for (s.shift = 32; s.shift > 0;) {
        s.shift -= DIGIT_BITS;
        for (uint32_t w = 0; w < opening->worker_count; w++)
            memset(scratch[w].tallies.tallies, 0, sizeof scratch[w].tallies.tallies);
        kdr_opening_pass(opening, tally_range, &s);
        uint32_t digit = 0;
        for (;; digit++) {
            equal = 0;
            for (uint32_t w = 0; w < opening->worker_count; w++)
                equal += scratch[w].tallies.tallies[digit];
            if (rank < equal)
                break;
            rank -= equal;
        }
        s.prefix |= digit << s.shift;
        s.known |= (uint32_t)(KDR_RANK_TALLIES - 1) << s.shift;
    }

    /* The next one is another number only if this is the last of its value. */
    if (next)
        *next = rank + 1 < equal ? of_key(s.prefix) : find_next(&s);
    return of_key(s.prefix);
}
