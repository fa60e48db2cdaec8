#include "support/failing_alloc.h"

#include <stdlib.h>
#include <string.h>

#define FILL_LIMIT ((size_t)1 << 16) /* bytes of a block that get the pattern */
#define FILL_BYTE 0xA5

/* Stands right before the block. */
typedef struct block_header {
    void *start; /* what malloc's family gave */
    size_t size;
} block_header;

static void *failing_allocate(size_t size, size_t alignment, void *user) {
    failing_alloc *failing = user;
    uint64_t number = atomic_fetch_add(&failing->calls, 1) + 1;
    if (failing->first != 0 && number >= failing->first && number <= failing->last) {
        atomic_fetch_add(&failing->failures, 1);
        return NULL;
    }

    // The header takes one alignment unit in front, so that the block itself stays aligned.
    size_t unit = alignment < sizeof(block_header) ? sizeof(block_header) : alignment;
    if (size > SIZE_MAX - 2 * unit)
        return NULL;
    size_t total = (size + unit + unit - 1) / unit * unit;
    char *start = aligned_alloc(unit, total);
    if (!start)
        return NULL;
    char *memory = start + unit;
    memcpy(memory - sizeof(block_header), &(block_header){start, size}, sizeof(block_header));
    memset(memory, FILL_BYTE, size < FILL_LIMIT ? size : FILL_LIMIT);
    atomic_fetch_add(&failing->live_blocks, 1);
    atomic_fetch_add(&failing->live_bytes, size);
    return memory;
}

static void failing_release(void *memory, size_t size, void *user) {
    failing_alloc *failing = user;
    if (!memory)
        return;
    block_header header;
    memcpy(&header, (char *)memory - sizeof(block_header), sizeof(block_header));
    if (header.size != size)
        atomic_fetch_add(&failing->bad_releases, 1);
    atomic_fetch_sub(&failing->live_blocks, 1);
    atomic_fetch_sub(&failing->live_bytes, header.size);
    free(header.start);
}

void failing_alloc_init(failing_alloc *failing) { memset(failing, 0, sizeof(*failing)); }

kdr_allocator failing_alloc_functions(failing_alloc *failing) {
    return (kdr_allocator){failing_allocate, failing_release, failing};
}

static void fail_between(failing_alloc *failing, uint64_t first, uint64_t last) {
    atomic_store(&failing->calls, 0);
    atomic_store(&failing->failures, 0);
    failing->first = first;
    failing->last = last;
}

void failing_alloc_fail_nth(failing_alloc *failing, uint64_t n) { fail_between(failing, n, n); }

void failing_alloc_fail_from(failing_alloc *failing, uint64_t n) { fail_between(failing, n, UINT64_MAX); }

bool failing_alloc_is_clean(const failing_alloc *failing) {
    return atomic_load(&failing->live_blocks) == 0 && atomic_load(&failing->live_bytes) == 0 &&
           atomic_load(&failing->bad_releases) == 0;
}
