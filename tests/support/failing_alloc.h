/* A host's memory that fails on demand: tests make every allocation fail in turn and look for what was left behind.
 *
 * Blocks carry their size, so that a release with another size is counted, and start filled with a pattern, so that
 * nobody leans on zeros. Only the first pages of a large block are filled: upper bounds stay cheap. Thread safe. */
#ifndef KDR_TESTS_SUPPORT_FAILING_ALLOC_H
#define KDR_TESTS_SUPPORT_FAILING_ALLOC_H

#include "kdray/kdray.h"

#include <stdatomic.h>

typedef struct failing_alloc {
    _Atomic uint64_t calls;        /* allocations asked for since init or the last fail_*, failed ones too */
    _Atomic uint64_t failures;     /* of these, made to fail */
    _Atomic uint64_t live_blocks;  /* not yet released: 0 at the end, or there is a leak */
    _Atomic size_t live_bytes;     /* their sizes as requested */
    _Atomic uint64_t bad_releases; /* with another size than that of the request */
    uint64_t first;                /* number of the first allocation to fail, from 1; 0: none */
    uint64_t last;                 /* number of the last one */
} failing_alloc;

void failing_alloc_init(failing_alloc *failing);

/* The callbacks; failing must outlive every block. */
kdr_allocator failing_alloc_functions(failing_alloc *failing);

/* Counts from 0 again, and fails the n-th allocation from now (1: the next one) and no other. 0: none fails.
 * Not while another thread allocates. */
void failing_alloc_fail_nth(failing_alloc *failing, uint64_t n);

/* The same, with every allocation after the n-th failing too. */
void failing_alloc_fail_from(failing_alloc *failing, uint64_t n);

/* True when every block was given back with the size it was asked for. */
bool failing_alloc_is_clean(const failing_alloc *failing);

#endif
