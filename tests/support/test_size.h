/* How much a property test does: all of it in a release build, a part where every step costs many times more.
 * With KDR_TEST_LONG=1 in the environment tests that name a long run do that instead. */
#ifndef KDR_TESTS_SUPPORT_TEST_SIZE_H
#define KDR_TESTS_SUPPORT_TEST_SIZE_H

#include <stdbool.h>
#include <stdlib.h>

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define TEST_SLOW 1
#endif
#endif
#if !defined(TEST_SLOW) && (!defined(NDEBUG) || defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__))
#define TEST_SLOW 1
#endif

/* `full` in release builds, a tenth of it otherwise, at least 1. */
#ifdef TEST_SLOW
#define TEST_SIZE(full) ((full) >= 10 ? (full) / 10 : 1)
#else
#define TEST_SIZE(full) (full)
#endif

static inline bool test_is_long(void) {
    const char *text = getenv("KDR_TEST_LONG");
    return text && *text && *text != '0';
}

#endif
