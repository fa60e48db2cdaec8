/* Blocks of memory that are used again: the references of large nodes, and all that a commit replaces.
 *
 * Sizes are rounded up to a quarter of a power of two, so that what one user gives back fits the next. A block that
 * comes back has its pages already, which is worth more than the build to a scene that moves. Cost: a short lock a
 * block. Thread safe. */
#ifndef KDR_BASE_BULK_H
#define KDR_BASE_BULK_H

#include "base/alloc.h"

#include <pthread.h>

#define KDR_BULK_CLASSES 256

typedef struct kdr_bulk_block kdr_bulk_block;

typedef struct kdr_bulk {
    kdr_alloc *alloc;
    pthread_mutex_t lock;
    kdr_bulk_block *kept[KDR_BULK_CLASSES]; /* by class of size */
} kdr_bulk;

void kdr_bulk_init(kdr_bulk *bulk, kdr_alloc *alloc);
void kdr_bulk_trim(kdr_bulk *bulk); /* gives back what is kept */
void kdr_bulk_destroy(kdr_bulk *bulk);

/* 64-byte aligned; *size becomes what was really taken. NULL when there is no memory. */
void *kdr_bulk_get(kdr_bulk *bulk, size_t *size);

/* Takes back a block; size as asked for or as given. memory NULL is allowed. */
void kdr_bulk_put(kdr_bulk *bulk, void *memory, size_t size);

#endif
