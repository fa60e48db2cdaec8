#include "render/tile.h"

void kdr_tile_source_init(kdr_tile_source *source, const kdr_picture_def *def) {
    uint32_t columns = (def->width + KDR_BLOCK_SIDE - 1) / KDR_BLOCK_SIDE;
    uint32_t rows = (def->height + KDR_BLOCK_SIDE - 1) / KDR_BLOCK_SIDE;
    *source = (kdr_tile_source){
        .width = def->width,
        .height = def->height,
        .columns = columns,
        .block_count = columns * rows,
        .total = (uint64_t)columns * rows * def->samples,
        .progress = def->progress,
        .progress_user = def->progress_user,
        .reporting = ATOMIC_FLAG_INIT,
    };
}

static uint32_t side(uint32_t begin, uint32_t end) {
    return end - begin < KDR_BLOCK_SIDE ? end - begin : KDR_BLOCK_SIDE;
}

bool kdr_tile_source_next(kdr_tile_source *source, kdr_block *block) {
    if (atomic_load_explicit(&source->cancelled, memory_order_relaxed))
        return false;
    uint32_t number = atomic_fetch_add_explicit(&source->cursor, 1, memory_order_relaxed);
    if (number >= source->block_count)
        return false;
    block->x = number % source->columns * KDR_BLOCK_SIDE;
    block->y = number / source->columns * KDR_BLOCK_SIDE;
    block->width = side(block->x, source->width);
    block->height = side(block->y, source->height);
    return true;
}

/* Tells progress what is finished by now; the caller holds `reporting`. */
static void tell(kdr_tile_source *source) {
    uint64_t finished = atomic_load(&source->finished);
    if (finished == source->reported)
        return;
    source->reported = finished;
    if (!source->progress(finished, source->total, source->progress_user))
        atomic_store(&source->cancelled, true);
}

bool kdr_tile_source_finish(kdr_tile_source *source) {
    atomic_fetch_add(&source->finished, 1);
    bool cancelled = atomic_load(&source->cancelled);
    if (!cancelled && source->progress && !atomic_flag_test_and_set(&source->reporting)) {
        // Another thread may have had a refusal between the look above and the lock.
        if (!atomic_load(&source->cancelled))
            tell(source);
        atomic_flag_clear(&source->reporting);
    }
    return !atomic_load(&source->cancelled);
}

bool kdr_tile_source_close(kdr_tile_source *source) {
    if (source->progress && !atomic_load(&source->cancelled))
        tell(source);
    return !atomic_load(&source->cancelled);
}
