#include "support/oracle_tree.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define LEAF_LIMIT 4
#define STACK_SIZE 64      /* halving 2^32 primitives goes 32 deep */
#define MARGIN 0x1p-20     /* relative, of distances: floats round by 2^-24, doubles by 2^-53 */
#define LEAST_MARGIN 1e-40 /* absolute, for distances that are denormal floats */

static void *allocate(size_t count, size_t size) {
    void *memory = calloc(count ? count : 1, size);
    if (!memory) {
        fprintf(stderr, "oracle_tree: out of memory\n");
        abort();
    }
    return memory;
}

static double centre(const oracle_primitive *primitive, int axis) {
    double a = primitive->a[axis], b = primitive->b[axis], c = primitive->c[axis];
    return fmin(fmin(a, b), c) + fmax(fmax(a, b), c);
}

/* Puts the k-th smallest centre at its place, smaller ones before it, larger ones after it (Hoare's selection). */
static void select_median(const oracle_primitive *primitives, uint32_t *order, ptrdiff_t count, ptrdiff_t k, int axis) {
    ptrdiff_t low = 0, high = count - 1;
    while (low < high) {
        double pivot = centre(&primitives[order[k]], axis);
        ptrdiff_t i = low, j = high;
        while (i <= j) {
            while (centre(&primitives[order[i]], axis) < pivot)
                i++;
            while (centre(&primitives[order[j]], axis) > pivot)
                j--;
            if (i <= j) {
                uint32_t swap = order[i];
                order[i++] = order[j];
                order[j--] = swap;
            }
        }
        if (j < k)
            low = i;
        if (k < i)
            high = j;
    }
}

static void find_box(const oracle_primitive *primitives, const uint32_t *order, uint32_t count, oracle_node *node) {
    for (int axis = 0; axis < 3; axis++) {
        node->low[axis] = INFINITY;
        node->high[axis] = -INFINITY;
        for (uint32_t i = 0; i < count; i++) {
            const oracle_primitive *primitive = &primitives[order[i]];
            float a = primitive->a[axis], b = primitive->b[axis], c = primitive->c[axis];
            node->low[axis] = fminf(node->low[axis], fminf(fminf(a, b), c));
            node->high[axis] = fmaxf(node->high[axis], fmaxf(fmaxf(a, b), c));
        }
    }
}

static int longest_axis(const oracle_node *node) {
    int longest = 0;
    for (int axis = 1; axis < 3; axis++) {
        if ((double)node->high[axis] - node->low[axis] > (double)node->high[longest] - node->low[longest])
            longest = axis;
    }
    return longest;
}

static void divide(oracle_tree *tree, uint32_t first, uint32_t count) {
    oracle_node *node = &tree->nodes[tree->node_count++];
    find_box(tree->scene->primitives, tree->order + first, count, node);
    if (count <= LEAF_LIMIT) {
        node->first = first;
        node->count = count;
        return;
    }
    uint32_t half = count / 2;
    select_median(tree->scene->primitives, tree->order + first, count, half, longest_axis(node));
    divide(tree, first, half);
    node->first = tree->node_count;
    node->count = 0;
    divide(tree, first + half, count - half);
}

oracle_tree oracle_tree_create(const oracle_scene *scene) {
    oracle_tree tree = {scene, allocate(scene->count, sizeof(uint32_t)), NULL, 0};
    tree.nodes = allocate(scene->count, sizeof(oracle_node)); // leaves hold two primitives or more, unless all is one
    for (size_t i = 0; i < scene->count; i++)
        tree.order[i] = (uint32_t)i;
    if (scene->count > 0)
        divide(&tree, 0, (uint32_t)scene->count);
    return tree;
}

void oracle_tree_destroy(oracle_tree *tree) {
    free(tree->order);
    free(tree->nodes);
    *tree = (oracle_tree){0};
}

/* Whether the line may meet the box at a distance in [near, far]. A point of the box is at the ray's exact distance, so
 * its sides' distances, widened by the margin, enclose it. */
static bool meets_box(const oracle_node *node, const double o[3], const double d[3], double near, double far) {
    for (int axis = 0; axis < 3; axis++) {
        if (d[axis] == 0) {
            if (o[axis] < node->low[axis] || o[axis] > node->high[axis])
                return false;
            continue;
        }
        double t0 = (node->low[axis] - o[axis]) / d[axis];
        double t1 = (node->high[axis] - o[axis]) / d[axis];
        double enter = t0 < t1 ? t0 : t1, leave = t0 < t1 ? t1 : t0;
        enter -= fabs(enter) * MARGIN + LEAST_MARGIN;
        leave += fabs(leave) * MARGIN + LEAST_MARGIN;
        near = enter > near ? enter : near;
        far = leave < far ? leave : far;
    }
    return near <= far;
}

/* With any set, stops at the first hit. */
static oracle_hit walk(const oracle_tree *tree, const kdr_ray *ray, bool any) {
    oracle_hit best = {0};
    if (tree->node_count == 0 || !oracle_ray_is_valid(ray))
        return best;
    const double o[3] = {ray->origin_x, ray->origin_y, ray->origin_z};
    const double d[3] = {ray->direction_x, ray->direction_y, ray->direction_z};
    uint32_t stack[STACK_SIZE];
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        uint32_t number = stack[--depth];
        const oracle_node *node = &tree->nodes[number];
        if (!meets_box(node, o, d, ray->tmin, best.primitive ? best.t : ray->tmax))
            continue;
        if (node->count == 0) {
            stack[depth++] = node->first;
            stack[depth++] = number + 1;
            continue;
        }
        for (uint32_t i = 0; i < node->count; i++)
            oracle_improve(ray, &tree->scene->primitives[tree->order[node->first + i]], &best);
        if (any && best.primitive)
            return best;
    }
    return best;
}

oracle_hit oracle_tree_closest(const oracle_tree *tree, const kdr_ray *ray) {
    oracle_hit best = walk(tree, ray, false);
    if (best.primitive)
        best.weight_doubt =
            oracle_barycentric(ray, best.primitive->a, best.primitive->b, best.primitive->c, &best.u, &best.v);
    return best;
}

bool oracle_tree_any(const oracle_tree *tree, const kdr_ray *ray) { return walk(tree, ray, true).primitive != NULL; }
