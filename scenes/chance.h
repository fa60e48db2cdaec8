/* Randomness that is the same everywhere: a stream of numbers that depends on a seed and an item alone.
 *
 * Ask for one number a statement. The order within an expression, argument list or initializer is the compiler's.
 *
 * The generator is SplitMix64 (Steele, Lea and Flood, "Fast Splittable Pseudorandom Number Generators", 2014): a
 * counter and a mixing function, so that item i of a scene can be made without making the items before it. */
#ifndef KDR_SCENES_CHANCE_H
#define KDR_SCENES_CHANCE_H

#include "scenes/point.h"

#include <stdint.h>

typedef struct kdr_chance {
    uint64_t state;
} kdr_chance;

static inline uint64_t kdr_chance_bits(kdr_chance *chance) {
    uint64_t z = chance->state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* The stream of one item; different seeds or items have unrelated streams. */
static inline kdr_chance kdr_chance_of(uint32_t seed, uint64_t item) {
    kdr_chance chance = {((uint64_t)seed << 40) ^ item};
    chance.state = kdr_chance_bits(&chance);
    return chance;
}

/* Uniform in [0, 1). */
static inline double kdr_chance_unit(kdr_chance *chance) { return (double)(kdr_chance_bits(chance) >> 11) * 0x1p-53; }

/* Uniform in [low, high). */
static inline double kdr_chance_between(kdr_chance *chance, double low, double high) {
    return low + (high - low) * kdr_chance_unit(chance);
}

/* Uniform in [0, count); count must not be 0. */
static inline uint32_t kdr_chance_below(kdr_chance *chance, uint32_t count) {
    return (uint32_t)((kdr_chance_bits(chance) >> 32) * count >> 32);
}

/* Uniform over the unit sphere: height and longitude are independent and uniform. */
static inline kdr_point kdr_chance_direction(kdr_chance *chance) {
    double y = kdr_chance_between(chance, -1, 1);
    kdr_turn turn = kdr_turn_of(kdr_chance_unit(chance));
    double radius = sqrt(1 - y * y);
    return (kdr_point){radius * turn.cosine, y, radius * turn.sine};
}

#endif
