/* The picture cut into blocks, handed out to whoever asks, and the count of what is done.
 *
 * A block is 64x64 pixels: enough rays for one call of a query, few enough to stay in a core's cache. Its pixels come
 * as 8x8 tiles, rows of tiles from the top, each tile in Morton order, so that any 4, 16 or 64 rays in a row that begin
 * at a multiple of their number look through a square. Blocks at the right and lower border are cut off. */
#ifndef KDR_RENDER_TILE_H
#define KDR_RENDER_TILE_H

#include "kdray/render.h"

#include <stdatomic.h>

#define KDR_BLOCK_SIDE 64u
#define KDR_BLOCK_PIXELS (KDR_BLOCK_SIDE * KDR_BLOCK_SIDE)

typedef struct kdr_block {
    uint32_t x, y;          /* pixel of the upper left corner */
    uint32_t width, height; /* pixels, 1 to KDR_BLOCK_SIDE */
} kdr_block;

/* Column and row, within a block, of the i-th pixel in tile order. */
static inline void kdr_block_pixel(uint32_t i, uint32_t *x, uint32_t *y) {
    uint32_t tile = i / 64;
    *x = tile % 8 * 8 + (i & 1) + (i >> 1 & 2) + (i >> 2 & 4);
    *y = tile / 8 * 8 + (i >> 1 & 1) + (i >> 2 & 2) + (i >> 3 & 4);
}

typedef struct kdr_tile_source {
    uint32_t width, height;
    uint32_t columns, block_count;
    uint64_t total; /* passes over a block: one a block and sample */
    kdr_progress_fn *progress;
    void *progress_user;
    _Atomic uint32_t cursor;
    _Atomic uint64_t finished;
    atomic_bool cancelled;
    atomic_flag reporting; /* held by the thread that calls progress */
    uint64_t reported;     /* under reporting */
} kdr_tile_source;

void kdr_tile_source_init(kdr_tile_source *source, const kdr_picture_def *def);

/* Takes the next block; false when none is left or the picture was cancelled. */
bool kdr_tile_source_next(kdr_tile_source *source, kdr_block *block);

/* Counts one pass over a block as done and tells progress, unless another thread is telling it just now.
 * False when the picture was cancelled. */
bool kdr_tile_source_finish(kdr_tile_source *source);

/* After all workers have returned: makes sure that progress has heard of the last pass. False when cancelled. */
bool kdr_tile_source_close(kdr_tile_source *source);

#endif
