/* Random numbers for property tests: small, fast, the same on every machine for the same seed. */
#ifndef KDR_TESTS_SUPPORT_RANDOM_H
#define KDR_TESTS_SUPPORT_RANDOM_H

#include <stdint.h>

/* One generator belongs to one thread at a time. */
typedef struct test_random {
    uint64_t state;
    uint64_t increment; /* odd; names the sequence */
} test_random;

/* The seed of this run: the environment variable KDR_TEST_SEED, or a fixed default. Prints it on the first call. */
uint64_t test_random_seed(void);

/* Generators with different sequence numbers are independent, also for the same seed. */
test_random test_random_start(uint64_t seed, uint64_t sequence);

uint32_t test_random_u32(test_random *random);
uint64_t test_random_u64(test_random *random);
uint32_t test_random_below(test_random *random, uint32_t limit);       /* [0, limit), limit > 0 */
float test_random_float(test_random *random);                          /* [0, 1), a multiple of 2^-24 */
float test_random_between(test_random *random, float low, float high); /* low + (high - low) * [0, 1) */

#endif
