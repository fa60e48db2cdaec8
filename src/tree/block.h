/* What a leaf holds: one block of triangles in structure-of-arrays form, as long as the leaf, rounded up to groups
 * of 4.
 *
 *   row         0    1    2    3    4    5    6    7    8    9
 *   each p long a.x  a.y  a.z  b.x  b.y  b.z  c.x  c.y  c.z  primitive        p = 4 x groups
 *
 * One layout serves every width of lanes: a leaf of n triangles is met in ceil(n / lanes) steps, the last one under a
 * mask, and wastes at most three lanes of memory (40 bytes each). These repeat the leaf's last triangle, so that they
 * are missed where it is, and their primitive is UINT32_MAX. A leaf's first item is the number of its first group.
 * Reads of a full vector may run past the last block: 60 bytes behind it are readable.
 *
 * Only this header and block_lanes.h know this. Builders say which primitives a leaf has; traversals ask
 * kdr_block_closest and kdr_block_any. */
#ifndef KDR_TREE_BLOCK_H
#define KDR_TREE_BLOCK_H

#include "geometry/box.h"
#include "tree/node.h"

#include <stddef.h>

#define KDR_BLOCK_GROUP 4
#define KDR_BLOCK_ROWS 10
#define KDR_BLOCK_GROUP_BYTES (KDR_BLOCK_GROUP * KDR_BLOCK_ROWS * sizeof(float))
#define KDR_BLOCK_TAIL_BYTES 64

/* Groups that a leaf of `count` triangles takes. */
static inline uint32_t kdr_block_groups(uint32_t count) {
    return (uint32_t)(((uint64_t)count + KDR_BLOCK_GROUP - 1) / KDR_BLOCK_GROUP);
}

/* Where a block lies. */
typedef struct kdr_block {
    const float *rows;
    size_t length; /* of a row: a multiple of 4 */
    size_t shown;  /* triangles to ask, the first ones: a multiple of 4 */
} kdr_block;

/* shown: groups to ask of the block's. */
static inline kdr_block kdr_block_at(const float *blocks, uint32_t first, uint32_t groups, uint32_t shown) {
    return (kdr_block){blocks + (size_t)first * (KDR_BLOCK_GROUP_BYTES / sizeof(float)),
                       (size_t)groups * KDR_BLOCK_GROUP, (size_t)shown * KDR_BLOCK_GROUP};
}

static inline kdr_block kdr_block_of(const float *blocks, kdr_node leaf) {
    uint32_t groups = kdr_block_groups(kdr_node_count(leaf));
    return kdr_block_at(blocks, kdr_node_first(leaf), groups, groups);
}

static inline float *kdr_block_start(float *blocks, kdr_node leaf) {
    return blocks + (size_t)kdr_node_first(leaf) * (KDR_BLOCK_GROUP_BYTES / sizeof(float));
}

/* Primitives are stored with this bit turned, which as floats makes them numbers of common size or NaN: a vector that
 * reaches past row 8 reads them, and arithmetic with the smallest floats costs a hundred cycles on many machines. */
#define KDR_BLOCK_PRIMITIVE_BIT 0x40000000u

static inline uint32_t kdr_block_primitive(kdr_block block, size_t i) {
    uint32_t stored;
    memcpy(&stored, block.rows + 9 * block.length + i, sizeof stored);
    return stored ^ KDR_BLOCK_PRIMITIVE_BIT;
}

/* Vertices of triangle i of a block. */
static inline void kdr_block_triangle(kdr_block block, size_t i, float vertices[3][3]) {
    for (uint32_t row = 0; row < 9; row++)
        vertices[row / 3][row % 3] = block.rows[row * block.length + i];
}

static inline void kdr_block_set_primitive(float *blocks, kdr_node leaf, uint32_t i, uint32_t primitive) {
    size_t length = (size_t)kdr_block_groups(kdr_node_count(leaf)) * KDR_BLOCK_GROUP;
    primitive ^= KDR_BLOCK_PRIMITIVE_BIT;
    memcpy(kdr_block_start(blocks, leaf) + 9 * length + i, &primitive, sizeof primitive);
}

/* Sets triangle i of a leaf's block. */
static inline void kdr_block_set(float *blocks, kdr_node leaf, uint32_t i, const float vertices[3][3],
                                 uint32_t primitive) {
    size_t length = (size_t)kdr_block_groups(kdr_node_count(leaf)) * KDR_BLOCK_GROUP;
    float *at = kdr_block_start(blocks, leaf) + i;
    for (uint32_t row = 0; row < 9; row++)
        at[row * length] = vertices[row / 3][row % 3];
    kdr_block_set_primitive(blocks, leaf, i, primitive);
}

/* Fills what is left of a leaf's last group. The leaf holds a triangle. */
static inline void kdr_block_pad(float *blocks, kdr_node leaf) {
    uint32_t count = kdr_node_count(leaf), length = kdr_block_groups(count) * KDR_BLOCK_GROUP;
    float last[3][3];
    kdr_block_triangle(kdr_block_of(blocks, leaf), count - 1, last);
    for (uint32_t i = count; i < length; i++)
        kdr_block_set(blocks, leaf, i, (const float(*)[3])last, UINT32_MAX);
}

#endif
