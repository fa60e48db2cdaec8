/* A permuted congruential generator with 64 bits of state and 32 of output, XSH-RR.
 *
 * Source: M. O'Neill, "PCG: A Family of Simple Fast Space-Efficient Statistically Good Algorithms for Random Number
 * Generation", 2014. */
#include "support/random.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#define DEFAULT_SEED 20070917u

uint64_t test_random_seed(void) {
    static atomic_bool said;
    const char *text = getenv("KDR_TEST_SEED");
    uint64_t seed = text && *text ? strtoull(text, NULL, 0) : DEFAULT_SEED;
    if (!atomic_exchange(&said, true)) {
        printf("KDR_TEST_SEED=%llu\n", (unsigned long long)seed);
        fflush(stdout);
    }
    return seed;
}

test_random test_random_start(uint64_t seed, uint64_t sequence) {
    test_random random = {0, sequence * 2 + 1};
    test_random_u32(&random);
    random.state += seed;
    test_random_u32(&random);
    return random;
}

uint32_t test_random_u32(test_random *random) {
    uint64_t state = random->state;
    random->state = state * UINT64_C(6364136223846793005) + random->increment;
    uint32_t mixed = (uint32_t)(((state >> 18) ^ state) >> 27);
    uint32_t turn = (uint32_t)(state >> 59);
    return mixed >> turn | mixed << ((32 - turn) & 31);
}

uint64_t test_random_u64(test_random *random) {
    uint64_t high = test_random_u32(random);
    return high << 32 | test_random_u32(random);
}

uint32_t test_random_below(test_random *random, uint32_t limit) {
    return (uint32_t)((uint64_t)test_random_u32(random) * limit >> 32);
}

float test_random_float(test_random *random) { return (float)(test_random_u32(random) >> 8) * 0x1p-24f; }

float test_random_between(test_random *random, float low, float high) {
    return low + (high - low) * test_random_float(random);
}
