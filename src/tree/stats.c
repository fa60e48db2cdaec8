/* What a tree is made of, and what it costs.
 *
 * Source of the cost: J. D. MacDonald, K. S. Booth, "Heuristics for ray tracing using space subdivision", 1990: a ray
 * that meets the root's box meets a cell inside with probability area(cell) / area(root). */
#include "tree/closed.h"
#include "tree/walk.h"

typedef struct counting {
    kdr_tree_stats *stats;
    double cost, depth_sum;
} counting;

static bool count_node(const kdr_tree *tree, const kdr_walk *at, void *context) {
    counting *c = context;
    kdr_tree_stats *s = c->stats;
    kdr_node node = tree->nodes[at->node];
    double area = kdr_box_area(&at->cell);
    if (!kdr_node_is_leaf(node)) {
        s->interior_count++;
        c->cost += area * tree->cost_traversal;
        return true;
    }

    uint32_t count = kdr_node_count(node);
    c->cost += area * tree->cost_intersection * count;
    c->depth_sum += at->depth;
    s->leaf_count++;
    s->empty_leaf_count += count == 0;
    s->reference_count += count;
    s->depth = at->depth > s->depth ? at->depth : s->depth;
    s->largest_leaf = count > s->largest_leaf ? count : s->largest_leaf;
    s->depth_histogram[at->depth < KDR_HISTOGRAM_SIZE ? at->depth : KDR_HISTOGRAM_SIZE - 1]++;
    s->leaf_histogram[count < KDR_HISTOGRAM_SIZE ? count : KDR_HISTOGRAM_SIZE - 1]++;
    return true;
}

void kdr_tree_count(const kdr_tree *tree, kdr_tree_stats *out) {
    *out = (kdr_tree_stats){.triangle_count = tree->primitive_count,
                            .dropped_count = tree->dropped_count,
                            .degenerate_count = tree->degenerate_count,
                            .node_bytes = kdr_tree_node_bytes(tree) + tree->arrays.bytes + tree->links.bytes,
                            .leaf_bytes = kdr_tree_block_bytes(tree) + tree->projections.bytes};
    if (tree->closed) {
        out->closed_count = tree->closed->count;
        out->opened_count = __atomic_load_n(&tree->closed->opened_count, __ATOMIC_RELAXED);
    }
    counting c = {.stats = out};
    kdr_tree_walk(tree, count_node, &c);
    double root = kdr_box_area(&tree->bounds);
    out->cost = root > 0 ? c.cost / root : 0;
    out->mean_leaf_depth = out->leaf_count > 0 ? c.depth_sum / (double)out->leaf_count : 0;
}
