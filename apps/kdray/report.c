#include "report.h"

#include <inttypes.h>

double kdr_tree_duplication(const kdr_tree_stats *tree) {
    return tree->triangle_count ? (double)tree->reference_count / (double)tree->triangle_count : 0;
}

double kdr_tree_bytes_per_triangle(const kdr_tree_stats *tree) {
    double bytes = (double)tree->node_bytes + (double)tree->leaf_bytes;
    return tree->triangle_count ? bytes / (double)tree->triangle_count : 0;
}

void kdr_report_tree(FILE *file, const kdr_tree_stats *tree) {
    fprintf(file, "tree\n");
    fprintf(file, "  triangles     %" PRIu64 "\n", tree->triangle_count);
    fprintf(file, "  dropped       %" PRIu64 "\n", tree->dropped_count);
    fprintf(file, "  degenerate    %" PRIu64 "\n", tree->degenerate_count);
    if (tree->closed_count > 0)
        fprintf(file, "  closed        %" PRIu64 " nodes were left to the rays, which opened %" PRIu64 "\n",
                tree->closed_count, tree->opened_count);
    fprintf(file, "  nodes         %" PRIu64 " (%" PRIu64 " interior, %" PRIu64 " leaves)\n",
            tree->interior_count + tree->leaf_count, tree->interior_count, tree->leaf_count);
    fprintf(file, "  leaves        %" PRIu64 " (%" PRIu64 " empty, the largest with %" PRIu32 " triangles)\n",
            tree->leaf_count, tree->empty_leaf_count, tree->largest_leaf);
    fprintf(file, "  depth         %" PRIu32 " (%.1f for the mean leaf)\n", tree->depth, tree->mean_leaf_depth);
    fprintf(file, "  cost          %.2f by the surface area heuristic\n", tree->cost);
    fprintf(file, "  duplication   %.3f references a triangle (%" PRIu64 " in all)\n", kdr_tree_duplication(tree),
            tree->reference_count);
    fprintf(file, "  bytes         %.1f a triangle (nodes %zu, leaves %zu)\n", kdr_tree_bytes_per_triangle(tree),
            tree->node_bytes, tree->leaf_bytes);
    fprintf(file, "  build         %.1f ms\n", 1e3 * tree->build_seconds);
}

/* ---- histograms */

#define LABEL_COLUMNS 21 /* what stands before a bar: two spaces, number, two spaces, count, two spaces */
#define BAR_LIMIT 60

/* Entries up to the last that is not 0. */
static size_t used_entries(const uint64_t counts[KDR_HISTOGRAM_SIZE]) {
    size_t used = KDR_HISTOGRAM_SIZE;
    while (used > 0 && counts[used - 1] == 0)
        used--;
    return used;
}

static void print_histogram(FILE *file, const char *title, const uint64_t counts[KDR_HISTOGRAM_SIZE], bool last_is_more,
                            int columns) {
    size_t used = used_entries(counts), first = 0;
    while (first < used && counts[first] == 0)
        first++;
    uint64_t most = 0;
    for (size_t i = 0; i < used; i++)
        most = counts[i] > most ? counts[i] : most;
    int room = columns - LABEL_COLUMNS;
    room = room < BAR_LIMIT ? room : BAR_LIMIT;

    fprintf(file, "%s\n", title);
    for (size_t i = first; i < used; i++) {
        // Whatever is there is seen: no count above 0 is without a bar.
        double part = (double)counts[i] / (double)most;
        int bar = room > 0 ? (int)(part * room + 0.5) : 0;
        bar = counts[i] > 0 && bar == 0 && room > 0 ? 1 : bar;
        fprintf(file, "  %2zu%c  %12" PRIu64, i, last_is_more && i == KDR_HISTOGRAM_SIZE - 1 ? '+' : ' ', counts[i]);
        if (bar > 0)
            fputs("  ", file);
        for (int k = 0; k < bar; k++)
            fputc('#', file);
        fputc('\n', file);
    }
}

void kdr_report_histograms(FILE *file, const kdr_tree_stats *tree, int columns) {
    print_histogram(file, "leaves by depth", tree->depth_histogram, false, columns);
    print_histogram(file, "leaves by number of triangles", tree->leaf_histogram, true, columns);
}

void kdr_report_plan_json(kdr_json *json, const kdr_build_def *def) {
    char plan[KDR_PLAN_TEXT_SIZE] = "";
    kdr_build_def_print(def, plan, sizeof plan);
    kdr_json_text(json, "plan", plan);
}

void kdr_report_tree_json(kdr_json *json, const kdr_tree_stats *tree) {
    kdr_json_object(json, "tree");
    kdr_json_whole(json, "triangles", tree->triangle_count);
    kdr_json_whole(json, "dropped", tree->dropped_count);
    kdr_json_whole(json, "degenerate", tree->degenerate_count);
    kdr_json_whole(json, "closed", tree->closed_count);
    kdr_json_whole(json, "opened", tree->opened_count);
    kdr_json_whole(json, "nodes", tree->interior_count + tree->leaf_count);
    kdr_json_whole(json, "interior", tree->interior_count);
    kdr_json_whole(json, "leaves", tree->leaf_count);
    kdr_json_whole(json, "empty_leaves", tree->empty_leaf_count);
    kdr_json_whole(json, "references", tree->reference_count);
    kdr_json_whole(json, "depth", tree->depth);
    kdr_json_whole(json, "largest_leaf", tree->largest_leaf);
    kdr_json_real(json, "mean_leaf_depth", tree->mean_leaf_depth);
    kdr_json_real(json, "cost", tree->cost);
    kdr_json_real(json, "duplication", kdr_tree_duplication(tree));
    kdr_json_whole(json, "node_bytes", tree->node_bytes);
    kdr_json_whole(json, "leaf_bytes", tree->leaf_bytes);
    kdr_json_real(json, "bytes_per_triangle", kdr_tree_bytes_per_triangle(tree));
    kdr_json_real(json, "build_ms", 1e3 * tree->build_seconds);
    kdr_json_wholes(json, "depth_histogram", tree->depth_histogram, used_entries(tree->depth_histogram));
    kdr_json_wholes(json, "leaf_histogram", tree->leaf_histogram, used_entries(tree->leaf_histogram));
    kdr_json_close(json, '}');
}
