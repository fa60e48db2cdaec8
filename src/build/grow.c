/* Nodes and leaf lists while the tree grows: workers take chunks and fill them alone. */
#include "build/work.h"

bool kdr_grow_pair(kdr_build_state *state, kdr_build_worker *worker, uint32_t *pair) {
    if (worker->pair == worker->pair_end) {
        uint32_t chunk;
        if (!kdr_chunks_take(&state->shop->pairs, state->shop->alloc, 1, &chunk)) {
            kdr_build_fail(state, KDR_ERROR_OUT_OF_MEMORY);
            return false;
        }
        worker->pair = chunk * KDR_PAIRS_PER_CHUNK;
        worker->pair_end = worker->pair + KDR_PAIRS_PER_CHUNK;
    }
    *pair = worker->pair++;
    return true;
}

bool kdr_grow_interior(kdr_build_state *state, kdr_build_worker *worker, uint32_t node, uint32_t axis, float plane,
                       uint32_t *pair) {
    if (!kdr_grow_pair(state, worker, pair))
        return false;
    *kdr_growing_node(state->shop, node) = kdr_node_interior(axis, plane, *pair);
    worker->interiors++;
    return true;
}

uint32_t *kdr_grow_leaf(kdr_build_state *state, kdr_build_worker *worker, uint32_t node, uint32_t count) {
    if (worker->id_end - worker->id < count) {
        uint32_t chunk, chunks = (uint32_t)(((uint64_t)count + KDR_IDS_PER_CHUNK - 1) / KDR_IDS_PER_CHUNK);
        if (!kdr_chunks_take(&state->shop->ids, state->shop->alloc, chunks, &chunk)) {
            kdr_build_fail(state, KDR_ERROR_OUT_OF_MEMORY);
            return NULL;
        }
        worker->id = chunk * KDR_IDS_PER_CHUNK;
        worker->id_end = worker->id + chunks * KDR_IDS_PER_CHUNK;
    }
    static uint32_t nothing[1];
    uint32_t first = count > 0 ? worker->id : 0;
    worker->id += count;
    worker->leaf_groups += kdr_block_groups(count);
    worker->leaves++;
    *kdr_growing_node(state->shop, node) = kdr_node_leaf(count, first);
    return count > 0 ? kdr_growing_ids(state->shop, first) : nothing;
}
