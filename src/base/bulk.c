#include "base/bulk.h"

struct kdr_bulk_block {
    kdr_bulk_block *next;
    size_t size;
};

/* Rounds up to 4, 5, 6 or 7 times a power of two; the class counts such sizes. */
static uint32_t size_class(size_t *size) {
    size_t at_least = *size < 1024 ? 1024 : *size;
    uint32_t shift = 61 - (uint32_t)__builtin_clzll(at_least);
    size_t quarters = (at_least >> shift) + ((at_least & (((size_t)1 << shift) - 1)) != 0);
    *size = quarters << shift;
    return shift * 4 + (uint32_t)(quarters - 4);
}

void kdr_bulk_init(kdr_bulk *bulk, kdr_alloc *alloc) {
    *bulk = (kdr_bulk){.alloc = alloc};
    pthread_mutex_init(&bulk->lock, NULL);
}

void kdr_bulk_trim(kdr_bulk *bulk) {
    for (uint32_t i = 0; i < KDR_BULK_CLASSES; i++) {
        while (bulk->kept[i]) {
            kdr_bulk_block *block = bulk->kept[i];
            bulk->kept[i] = block->next;
            kdr_alloc_release(bulk->alloc, block, block->size);
        }
    }
}

void kdr_bulk_destroy(kdr_bulk *bulk) {
    kdr_bulk_trim(bulk);
    pthread_mutex_destroy(&bulk->lock);
}

void *kdr_bulk_get(kdr_bulk *bulk, size_t *size) {
    uint32_t class = size_class(size);
    pthread_mutex_lock(&bulk->lock);
    kdr_bulk_block *block = bulk->kept[class];
    if (block)
        bulk->kept[class] = block->next;
    pthread_mutex_unlock(&bulk->lock);
    return block ? (void *)block : kdr_alloc_get(bulk->alloc, *size, 64);
}

void kdr_bulk_put(kdr_bulk *bulk, void *memory, size_t size) {
    if (!memory)
        return;
    uint32_t class = size_class(&size);
    kdr_bulk_block *block = memory;
    block->size = size;
    pthread_mutex_lock(&bulk->lock);
    block->next = bulk->kept[class];
    bulk->kept[class] = block;
    pthread_mutex_unlock(&bulk->lock);
}
