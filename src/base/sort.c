/* Stable radix sort, least significant digit first, eight bits a pass.
 *
 * Every part counts its digits; an exclusive sum over the counts, digit by digit and within a digit part by part, gives
 * every part its places; then every part moves its pairs there in order. The order among equal digits is therefore that
 * of the input, whoever did the work. Digits in which all keys agree are skipped.
 * Cost: at most four passes, each reading twice and writing once; scratch of one copy and 2 KB a part (of 128 KB). */
#include "base/primitives.h"

#include "base/check.h"

#include <string.h>

#define GRAIN 16384
#define DIGIT_BITS 8
#define DIGITS (1u << DIGIT_BITS)

typedef struct sort {
    kdr_pair *from;
    kdr_pair *to;
    size_t (*places)[DIGITS]; /* by part */
    uint32_t shift;
} sort;

static uint32_t digit_of(const sort *s, uint32_t key) { return key >> s->shift & (DIGITS - 1); }

static void count_digits(void *context, size_t begin, size_t end, uint32_t worker) {
    const sort *s = context;
    (void)worker;
    uint32_t counts[DIGITS] = {0};
    for (size_t i = begin; i < end; i++)
        counts[digit_of(s, s->from[i].key)]++;
    size_t *places = s->places[begin / GRAIN];
    for (uint32_t digit = 0; digit < DIGITS; digit++)
        places[digit] = counts[digit];
}

static void sum_places(size_t (*places)[DIGITS], size_t parts) {
    size_t total = 0;
    for (uint32_t digit = 0; digit < DIGITS; digit++) {
        for (size_t part = 0; part < parts; part++) {
            size_t count = places[part][digit];
            places[part][digit] = total;
            total += count;
        }
    }
}

static void move_pairs(void *context, size_t begin, size_t end, uint32_t worker) {
    const sort *s = context;
    (void)worker;
    size_t *places = s->places[begin / GRAIN];
    for (size_t i = begin; i < end; i++) {
        kdr_pair pair = s->from[i];
        s->to[places[digit_of(s, pair.key)]++] = pair;
    }
}

/* Bits in which keys of a range differ from the first key. */
typedef struct key_bits {
    const kdr_pair *pairs;
    _Atomic uint32_t differing;
} key_bits;

static void find_differing(void *context, size_t begin, size_t end, uint32_t worker) {
    key_bits *bits = context;
    (void)worker;
    uint32_t first = bits->pairs[0].key, differing = 0;
    for (size_t i = begin; i < end; i++)
        differing |= bits->pairs[i].key ^ first;
    atomic_fetch_or_explicit(&bits->differing, differing, memory_order_relaxed);
}

static void copy_pairs(void *context, size_t begin, size_t end, uint32_t worker) {
    const sort *s = context;
    (void)worker;
    memcpy(s->to + begin, s->from + begin, (end - begin) * sizeof(kdr_pair));
}

kdr_status kdr_parallel_sort(const kdr_crew *crew, kdr_alloc *alloc, kdr_buffer *scratch, kdr_pair *pairs,
                             size_t count) {
    if (count < 2)
        return KDR_OK;

    // One copy of the pairs, and the places behind it.
    size_t parts = (count - 1) / GRAIN + 1;
    size_t copy_bytes, place_bytes, bytes;
    if (!kdr_size_mul(count, sizeof(kdr_pair), &copy_bytes) ||
        !kdr_size_mul(parts, sizeof(size_t[DIGITS]), &place_bytes) || !kdr_size_add(copy_bytes, place_bytes, &bytes) ||
        !kdr_buffer_reserve(alloc, scratch, bytes))
        return KDR_ERROR_OUT_OF_MEMORY;
    kdr_pair *copy = scratch->memory;

    key_bits bits = {.pairs = pairs};
    kdr_parallel_for(crew, count, GRAIN, find_differing, &bits);
    uint32_t differing = atomic_load_explicit(&bits.differing, memory_order_relaxed);

    sort s = {.from = pairs, .to = copy, .places = (void *)((char *)scratch->memory + copy_bytes)};
    for (s.shift = 0; s.shift < 32; s.shift += DIGIT_BITS) {
        if (digit_of(&s, differing) == 0)
            continue;
        kdr_parallel_for(crew, count, GRAIN, count_digits, &s);
        sum_places(s.places, parts);
        kdr_parallel_for(crew, count, GRAIN, move_pairs, &s);
        s.to = s.from;
        s.from = s.from == pairs ? copy : pairs;
    }
    if (s.from == copy) {
        s.to = pairs;
        kdr_parallel_for(crew, count, GRAIN, copy_pairs, &s);
    }
    return KDR_OK;
}
