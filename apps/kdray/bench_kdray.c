/* kdray as an engine: whole calls of 4096 rays ("stream"), packets of 16 ("packet"), or ray after ray ("single"). */
#include "bench.h"
#include "bench_packets.h"
#include "memory.h"

#include <string.h>

typedef struct kdray_state {
    kdr_scene *scene;
    kdr_build_def build;
} kdray_state;

static const kdray_state *state_of(const kdr_bench_engine *engine) { return engine->state; }

/* kdray takes rays as they are. They are copied all the same: a closest hit changes its ray, and all tracers shall find
 * their rays in the caches alike. */
static void fill(const kdr_bench_engine *engine, const kdr_bench_rays *rays, size_t begin, size_t end,
                 kdr_bench_sheet *sheet) {
    (void)engine;
    if (rays->any) {
        memcpy((kdr_ray *)sheet->rays + begin, rays->rays + begin, (end - begin) * sizeof(kdr_ray));
        memset(sheet->occluded + begin, 0, end - begin);
        return;
    }
    kdr_ray_hit *ray_hits = sheet->rays;
    for (size_t i = begin; i < end; i++)
        ray_hits[i] = (kdr_ray_hit){.ray = rays->rays[i], .hit = {.geometry = KDR_INVALID_ID}};
}

static void trace_stream(const kdr_bench_engine *engine, const kdr_bench_rays *rays, size_t begin, size_t end,
                         kdr_bench_sheet *sheet) {
    const kdr_scene *scene = state_of(engine)->scene;
    kdr_trace_def def = kdr_default_trace_def();
    def.coherence = rays->coherent ? KDR_COHERENCE_COHERENT : KDR_COHERENCE_INCOHERENT;
    if (rays->any)
        kdr_occluded_n(scene, &def, (const kdr_ray *)sheet->rays + begin, sheet->occluded + begin, end - begin);
    else
        kdr_intersect_n(scene, &def, (kdr_ray_hit *)sheet->rays + begin, end - begin);
}

static void trace_single(const kdr_bench_engine *engine, const kdr_bench_rays *rays, size_t begin, size_t end,
                         kdr_bench_sheet *sheet) {
    const kdr_scene *scene = state_of(engine)->scene;
    if (rays->any) {
        const kdr_ray *lone = sheet->rays;
        for (size_t i = begin; i < end; i++)
            sheet->occluded[i] = kdr_occluded1(scene, &lone[i]);
    } else {
        kdr_ray_hit *lone = sheet->rays;
        for (size_t i = begin; i < end; i++)
            kdr_intersect1(scene, &lone[i]);
    }
}

/* ---- packets of 16 */

static void fill_packet(const kdr_bench_engine *engine, const kdr_bench_rays *rays, size_t begin, size_t end,
                        kdr_bench_sheet *sheet) {
    (void)engine;
    kdr_bench_packets_fill(rays, 16, begin, end, sheet);
}

static uint64_t count_packet(const kdr_bench_engine *engine, const kdr_bench_rays *rays, size_t begin, size_t end,
                             const kdr_bench_sheet *sheet) {
    (void)engine;
    return kdr_bench_packets_count(rays, 16, begin, end, sheet);
}

static void trace_packet(const kdr_bench_engine *engine, const kdr_bench_rays *rays, size_t begin, size_t end,
                         kdr_bench_sheet *sheet) {
    const kdr_scene *scene = state_of(engine)->scene;
    int32_t valid[16];
    memset(valid, -1, sizeof valid);
    for (size_t first = begin; first < end; first += 16) {
        for (size_t lane = end - first; lane < 16; lane++) /* the last packet is cut off */
            valid[lane] = 0;
        if (rays->any)
            kdr_occluded16(scene, valid, kdr_bench_packet_at(rays, 16, sheet, first));
        else
            kdr_intersect16(scene, valid, kdr_bench_packet_at(rays, 16, sheet, first));
    }
}

/* ---- the engine */

static uint64_t count_hits(const kdr_bench_engine *engine, const kdr_bench_rays *rays, size_t begin, size_t end,
                           const kdr_bench_sheet *sheet) {
    (void)engine;
    const kdr_ray_hit *ray_hits = sheet->rays;
    uint64_t hits = 0;
    for (size_t i = begin; i < end; i++)
        hits += rays->any ? sheet->occluded[i] : ray_hits[i].hit.geometry != KDR_INVALID_ID;
    return hits;
}

static kdr_triangles_def triangles_of(const kdr_mesh *mesh) {
    kdr_triangles_def triangles = kdr_default_triangles_def();
    triangles.vertices = mesh->positions;
    triangles.vertex_count = mesh->vertex_count;
    triangles.indices = mesh->indices;
    triangles.triangle_count = mesh->triangle_count;
    return triangles;
}

static bool show(kdr_bench_engine *engine, const kdr_mesh *mesh) {
    kdr_triangles_def triangles = triangles_of(mesh);
    return kdr_scene_set_triangles(state_of(engine)->scene, 0, &triangles) == KDR_OK;
}

static bool build(kdr_bench_engine *engine) {
    const kdray_state *state = state_of(engine);
    return kdr_scene_touch(state->scene, 0) == KDR_OK && kdr_scene_commit(state->scene, &state->build) == KDR_OK;
}

static double bytes(const kdr_bench_engine *engine) {
    kdr_tree_stats stats;
    if (kdr_scene_stats(state_of(engine)->scene, &stats) != KDR_OK)
        return 0;
    return (double)stats.node_bytes + (double)stats.leaf_bytes;
}

static void close_engine(kdr_bench_engine *engine) {
    kdr_scene_destroy(state_of(engine)->scene);
    kdr_memory_release(engine->state);
    engine->state = NULL;
}

const kdr_scene *kdr_bench_kdray_scene(const kdr_bench_engine *engine) { return state_of(engine)->scene; }

bool kdr_bench_kdray_open(const kdr_bench_scene *scene, const kdr_build_def *def, const kdr_logger *logger,
                          kdr_bench_engine *out) {
    kdray_state *state = kdr_memory_get(1, sizeof *state);
    *state = (kdray_state){.build = *def};
    *out = (kdr_bench_engine){.name = "kdray",
                              .tracers = {{"stream", fill, trace_stream, count_hits},
                                          {"packet", fill_packet, trace_packet, count_packet},
                                          {"single", fill, trace_single, count_hits}},
                              .show = show,
                              .build = build,
                              .bytes = bytes,
                              .close = close_engine,
                              .state = state,
                              .logger = logger};

    kdr_triangles_def triangles = triangles_of(scene->mesh);
    if (kdr_scene_create(scene->device, &state->scene) == KDR_OK &&
        kdr_scene_add_triangles(state->scene, &triangles, NULL) == KDR_OK)
        return true;
    close_engine(out);
    return false;
}
