#include "trace_counts.h"

#include "memory.h"

/* A way to ask: a row of a plan's key, and whether rays go together. */
typedef struct trace_way {
    const char *name;
    kdr_trace_rule rule;
    bool together;
} trace_way;

static const trace_way ways[KDR_TRACE_WAYS] = {
    {"packets", KDR_TRACE_AUTO, true},         {"lone rays", KDR_TRACE_AUTO, false},
    {"stack", KDR_TRACE_STACK, false},         {"restart", KDR_TRACE_RESTART, false},
    {"push-down", KDR_TRACE_PUSH_DOWN, false}, {"short-stack", KDR_TRACE_SHORT_STACK, false},
    {"backtrack", KDR_TRACE_BACKTRACK, false},
};

bool kdr_trace_can_count(void) {
    kdr_trace_counts counts;
    return kdr_trace_counts_take(&counts) == KDR_OK;
}

/* Rays that hit; what they cost goes to *counts. */
static uint64_t ask(const kdr_scene *scene, const kdr_bench_rays *rays, bool together, kdr_ray_hit *found,
                    uint8_t *occluded, kdr_trace_counts *counts) {
    kdr_trace_def def = kdr_default_trace_def();
    def.coherence = KDR_COHERENCE_COHERENT;
    for (size_t i = 0; i < rays->count; i++)
        found[i] = (kdr_ray_hit){.ray = rays->rays[i], .hit = {.geometry = KDR_INVALID_ID}};
    kdr_trace_counts_take(counts);
    if (together && rays->any)
        kdr_occluded_n(scene, &def, rays->rays, occluded, rays->count);
    else if (together)
        kdr_intersect_n(scene, &def, found, rays->count);
    for (size_t i = 0; !together && i < rays->count; i++) {
        if (rays->any)
            occluded[i] = kdr_occluded1(scene, &rays->rays[i]);
        else
            kdr_intersect1(scene, &found[i]);
    }
    kdr_trace_counts_take(counts);
    uint64_t hits = 0;
    for (size_t i = 0; i < rays->count; i++)
        hits += rays->any ? occluded[i] : found[i].hit.geometry != KDR_INVALID_ID;
    return hits;
}

static kdr_status commit(const kdr_bench_scene *scene, kdr_build_def def, kdr_trace_rule rule, kdr_scene **out) {
    kdr_triangles_def triangles = kdr_default_triangles_def();
    triangles.vertices = scene->mesh->positions;
    triangles.vertex_count = scene->mesh->vertex_count;
    triangles.indices = scene->mesh->indices;
    triangles.triangle_count = scene->mesh->triangle_count;
    def.trace = rule;
    kdr_status status = kdr_scene_create(scene->device, out);
    if (status == KDR_OK)
        status = kdr_scene_add_triangles(*out, &triangles, NULL);
    return status == KDR_OK ? kdr_scene_commit(*out, &def) : status;
}

bool kdr_trace_sheet_make(const kdr_bench_scene *scene, const kdr_build_def *build, const kdr_logger *logger,
                          kdr_trace_sheet *out) {
    kdr_bench_workload workload = {0};
    kdr_ray_hit *found = NULL;
    uint8_t *occluded = NULL;
    bool done = true;
    out->count = 0;
    for (uint32_t w = 0; done && w < KDR_TRACE_WAYS; w++) {
        if (build->trace != KDR_TRACE_AUTO && ways[w].rule != build->trace)
            continue;
        kdr_scene *committed = NULL;
        done = commit(scene, *build, ways[w].rule, &committed) == KDR_OK;
        if (done && !found) {
            done = kdr_bench_workload_make(scene, committed, logger, &workload);
            size_t most = 0;
            for (int kind = 0; kind < KDR_BENCH_KINDS; kind++)
                most = workload.kinds[kind].count > most ? workload.kinds[kind].count : most;
            found = kdr_memory_get(most, sizeof *found);
            occluded = kdr_memory_get(most, sizeof *occluded);
        }
        for (int kind = 0; done && kind < KDR_BENCH_KINDS; kind++) {
            const kdr_bench_rays *rays = &workload.kinds[kind];
            kdr_trace_row *row = &out->rows[out->count++];
            *row = (kdr_trace_row){ways[w].name, kdr_bench_kind_name((kdr_bench_kind)kind), rays->count, 0, {0}};
            row->hits = ask(committed, rays, ways[w].together, found, occluded, &row->counts);
        }
        kdr_scene_destroy(committed);
    }
    kdr_memory_release(found);
    kdr_memory_release(occluded);
    kdr_bench_workload_release(&workload);
    return done;
}

/* What a figure is for one ray, or for one of something else; nothing of nothing is 0. */
static double each(uint64_t sum, uint64_t count) { return count > 0 ? (double)sum / (double)count : 0; }

void kdr_trace_sheet_print(const kdr_trace_sheet *sheet, FILE *file) {
    fprintf(file, "what a ray costs\n");
    fprintf(file, "  %-12s %-8s %9s %9s %9s %9s %9s %9s %9s %9s\n", "traversal", "rays", "number", "nodes", "together",
            "blocks", "steps", "lanes", "triangles", "exact");
    for (uint32_t i = 0; i < sheet->count; i++) {
        const kdr_trace_row *row = &sheet->rows[i];
        const kdr_trace_counts *c = &row->counts;
        fprintf(file, "  %-12s %-8s %9llu %9.2f %9.2f %9.2f %9.2f %8.0f%% %9.2f %9.3f\n", row->way, row->kind,
                (unsigned long long)row->rays, each(c->nodes, row->rays), each(c->node_rays, c->nodes),
                each(c->blocks, row->rays), each(c->steps, row->rays), 100 * each(c->tests, c->steps * c->width),
                each(c->tests, row->rays), each(c->exact, row->rays));
    }
}

void kdr_trace_sheet_json(const kdr_trace_sheet *sheet, kdr_json *json) {
    kdr_json_array(json, "trace");
    for (uint32_t i = 0; i < sheet->count; i++) {
        const kdr_trace_row *row = &sheet->rows[i];
        const kdr_trace_counts *c = &row->counts;
        kdr_json_object(json, NULL);
        kdr_json_text(json, "traversal", row->way);
        kdr_json_text(json, "rays", row->kind);
        kdr_json_whole(json, "ray_count", row->rays);
        kdr_json_whole(json, "hit_count", row->hits);
        kdr_json_whole(json, "nodes", c->nodes);
        kdr_json_whole(json, "node_rays", c->node_rays);
        kdr_json_whole(json, "blocks", c->blocks);
        kdr_json_whole(json, "steps", c->steps);
        kdr_json_whole(json, "tests", c->tests);
        kdr_json_whole(json, "exact", c->exact);
        kdr_json_whole(json, "width", c->width);
        kdr_json_close(json, '}');
    }
    kdr_json_close(json, ']');
}
