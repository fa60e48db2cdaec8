#include "tree/block.h"

void kdr_block_fill(float *blocks, kdr_node leaf, const uint32_t *primitives, kdr_block_vertices_fn *vertices,
                    const void *context) {
    uint32_t count = kdr_node_count(leaf);
    uint32_t length = kdr_block_groups(count) * KDR_BLOCK_GROUP;
    float *block = blocks + (size_t)kdr_node_first(leaf) * (KDR_BLOCK_GROUP_BYTES / sizeof(float));
    for (uint32_t i = 0; i < length; i++) {
        float triangle[3][3] = {{0}};
        uint32_t primitive = UINT32_MAX;
        if (i < count) {
            primitive = primitives[i];
            vertices(context, primitive, triangle);
        }
        for (uint32_t row = 0; row < 9; row++)
            block[(size_t)row * length + i] = triangle[row / 3][row % 3];
        memcpy(&block[(size_t)9 * length + i], &primitive, sizeof primitive);
    }
}
