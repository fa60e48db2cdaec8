#include "tree/projections.h"

#include "tree/walk.h"

#include <math.h>

static void project(const float corner[3][3], float *to, size_t length) {
    double e[3], f[3], n[3];
    for (int k = 0; k < 3; k++) {
        e[k] = (double)corner[1][k] - corner[0][k];
        f[k] = (double)corner[2][k] - corner[0][k];
    }
    for (int k = 0; k < 3; k++)
        n[k] = e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3];
    int k = fabs(n[0]) > fabs(n[1]) ? (fabs(n[0]) > fabs(n[2]) ? 0 : 2) : (fabs(n[1]) > fabs(n[2]) ? 1 : 2);
    int u = (k + 1) % 3, v = (k + 2) % 3;
    const float *a = corner[0];
    double values[10] = {n[u] / n[k],
                         n[v] / n[k],
                         a[k] + n[u] / n[k] * a[u] + n[v] / n[k] * a[v],
                         f[v] / n[k],
                         -f[u] / n[k],
                         (f[u] * a[v] - f[v] * a[u]) / n[k],
                         -e[v] / n[k],
                         e[u] / n[k],
                         (e[v] * a[u] - e[u] * a[v]) / n[k],
                         k};
    for (uint32_t row = 0; row < 10; row++)
        to[row * length] = (float)values[row];
}

static bool project_leaf(const kdr_tree *tree, const kdr_walk *at, void *context) {
    kdr_node node = tree->nodes[at->node];
    if (!kdr_node_is_leaf(node) || kdr_node_count(node) == 0)
        return true;
    kdr_block block = kdr_block_of(tree->blocks, node);
    float *to = (float *)context + (block.rows - tree->blocks);
    for (size_t i = 0; i < block.length; i++) {
        float corner[3][3];
        kdr_block_triangle(block, i, corner);
        project((const float(*)[3])corner, to + i, block.length);
    }
    return true;
}

bool kdr_tree_add_projections(kdr_tree *tree, kdr_bulk *bulk) {
    size_t bytes = (size_t)tree->group_count * KDR_BLOCK_GROUP_BYTES + KDR_BLOCK_TAIL_BYTES, size = bytes;
    float *rows = kdr_bulk_get(bulk, &size);
    if (!rows)
        return false;
    kdr_tree_walk(tree, project_leaf, rows);
    tree->projections = (kdr_projections){rows, bytes};
    return true;
}
