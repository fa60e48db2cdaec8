/* Blocks of memory for the references of large nodes, handed between workers and kept from build to build.
 *
 * Sizes are rounded up to a quarter of a power of two, so that what one node gives back fits the next.
 * Cost: a short lock a block; only nodes too large for a worker's arena come here. */
#ifndef KDR_BUILD_BULK_H
#define KDR_BUILD_BULK_H

#include "base/alloc.h"

#include <pthread.h>

#define KDR_BULK_CLASSES 256

typedef struct kdr_bulk_block kdr_bulk_block;

typedef struct kdr_bulk {
    pthread_mutex_t lock;
    kdr_bulk_block *kept[KDR_BULK_CLASSES]; /* by class of size */
} kdr_bulk;

void kdr_bulk_init(kdr_bulk *bulk);
void kdr_bulk_trim(kdr_bulk *bulk, kdr_alloc *alloc); /* gives back what is kept */
void kdr_bulk_destroy(kdr_bulk *bulk, kdr_alloc *alloc);

/* 64-byte aligned; *size becomes what was really taken. NULL when there is no memory. */
void *kdr_bulk_get(kdr_bulk *bulk, kdr_alloc *alloc, size_t *size);
void kdr_bulk_put(kdr_bulk *bulk, void *memory, size_t size);

#endif
