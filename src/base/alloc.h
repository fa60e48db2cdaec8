/* Counted memory: every byte that the library holds comes through one of these, so that a leak is a number.
 *
 * Sizes from KDR_ALLOC_LARGE up are mapped straight from the system: fresh zero pages that cost nothing until they are
 * touched, with huge pages asked for. Callers may therefore ask for upper bounds. */
#ifndef KDR_BASE_ALLOC_H
#define KDR_BASE_ALLOC_H

#include "kdray/kdray.h"

#include <stdatomic.h>

#define KDR_ALLOC_LARGE ((size_t)1 << 20)

typedef struct kdr_alloc {
    kdr_allocator functions;   /* allocate never NULL after kdr_alloc_init */
    _Atomic size_t bytes;      /* held now */
    _Atomic size_t peak_bytes; /* the most ever held */
} kdr_alloc;

/* functions NULL, or with allocate NULL: kdray's own. */
void kdr_alloc_init(kdr_alloc *alloc, const kdr_allocator *functions);

/* NULL when there is no memory; a size of 0 gives NULL too. Thread safe. */
void *kdr_alloc_get(kdr_alloc *alloc, size_t size, size_t alignment);

/* count * size with overflow checked. */
void *kdr_alloc_array(kdr_alloc *alloc, size_t count, size_t size, size_t alignment);

/* memory NULL is allowed; size is that of the request. Thread safe. */
void kdr_alloc_release(kdr_alloc *alloc, void *memory, size_t size);

/* A block that is kept and grows: the buffer of something that is made again and again. */
typedef struct kdr_buffer {
    void *memory;
    size_t capacity; /* bytes */
} kdr_buffer;

/* Makes room for `size` bytes; contents are lost when it grows. False, and an unchanged buffer, when there is none. */
bool kdr_buffer_reserve(kdr_alloc *alloc, kdr_buffer *buffer, size_t size);
void kdr_buffer_release(kdr_alloc *alloc, kdr_buffer *buffer);

#endif
