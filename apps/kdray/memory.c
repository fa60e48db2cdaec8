#include "memory.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#define ALIGNMENT ((size_t)64)

void *kdr_memory_get(size_t count, size_t size) {
    size_t bytes;
    void *memory = NULL;
    if (!__builtin_mul_overflow(count, size, &bytes) && bytes <= SIZE_MAX - ALIGNMENT)
        memory = aligned_alloc(ALIGNMENT, (bytes / ALIGNMENT + 1) * ALIGNMENT);
    if (!memory) {
        fprintf(stderr, "kdray: out of memory for %zu times %zu bytes\n", count, size);
        exit(1);
    }
    return memory;
}

void kdr_memory_release(void *memory) { free(memory); }
