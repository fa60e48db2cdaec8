#include "hit_tracers.h"

#include "support/soup.h"

#include <embree3/rtcore.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#define WIDTH 16     /* rays in a packet */
#define RAY_WORDS 12 /* 32-bit fields of a ray, in the order of kdr_ray */
#define WORDS 20     /* with those of its hit */
#define FAR 8        /* tmax; minus infinity where a ray was found occluded */
#define PRIMITIVE 17
#define GEOMETRY 18
#define INSTANCE 19

_Static_assert(sizeof(kdr_ray_hit16) == WORDS * WIDTH * 4 && sizeof(struct RTCRayHit16) == sizeof(kdr_ray_hit16),
               "packets of both libraries are alike");

struct hit_tracers {
    kdr_scene *scene;
    RTCDevice device;
    RTCScene robust, fast;
    float *vertices; /* the mesh's, with room behind the last for loads of 16 bytes */
};

const char *hit_tracer_name(int tracer) {
    static const char *const names[HIT_TRACERS] = {"kdray/single",         "kdray/packet",         "kdray/stream",
                                                   "embree/robust/single", "embree/robust/packet", "embree/fast/single",
                                                   "embree/fast/packet"};
    return names[tracer];
}

/* ---- making */

static RTCScene embree_scene(const hit_tracers *tracers, const kdr_mesh *mesh, enum RTCSceneFlags flags) {
    RTCScene scene = rtcNewScene(tracers->device);
    RTCGeometry geometry = rtcNewGeometry(tracers->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSceneFlags(scene, flags);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, tracers->vertices, 0, 12,
                               mesh->vertex_count);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh->indices, 0, 12,
                               mesh->triangle_count);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    return scene;
}

static bool open_embree(hit_tracers *tracers, kdr_device *device, const kdr_mesh *mesh) {
    char config[64];
    snprintf(config, sizeof config, "threads=%u,set_affinity=0", kdr_device_worker_count(device));
    tracers->device = rtcNewDevice(config);
    if (!tracers->device)
        return false;
    tracers->vertices = test_allocate(3 * mesh->vertex_count + 4, sizeof(float));
    memcpy(tracers->vertices, mesh->positions, 12 * mesh->vertex_count);
    tracers->robust = embree_scene(tracers, mesh, RTC_SCENE_FLAG_ROBUST);
    tracers->fast = embree_scene(tracers, mesh, RTC_SCENE_FLAG_NONE);
    return rtcGetDeviceError(tracers->device) == RTC_ERROR_NONE;
}

static bool open_kdray(hit_tracers *tracers, kdr_device *device, const kdr_mesh *mesh) {
    kdr_triangles_def def = kdr_default_triangles_def();
    def.vertices = mesh->positions;
    def.vertex_count = mesh->vertex_count;
    def.indices = mesh->indices;
    def.triangle_count = mesh->triangle_count;
    return kdr_scene_create(device, &tracers->scene) == KDR_OK &&
           kdr_scene_add_triangles(tracers->scene, &def, NULL) == KDR_OK &&
           kdr_scene_commit(tracers->scene, NULL) == KDR_OK;
}

hit_tracers *hit_tracers_open(kdr_device *device, const kdr_mesh *mesh) {
    hit_tracers *tracers = test_allocate(1, sizeof *tracers);
    if (open_kdray(tracers, device, mesh) && open_embree(tracers, device, mesh))
        return tracers;
    fprintf(stderr, "%s does not build the scene\n", tracers->device ? "Embree" : "kdray");
    hit_tracers_close(tracers);
    return NULL;
}

void hit_tracers_close(hit_tracers *tracers) {
    if (tracers->robust)
        rtcReleaseScene(tracers->robust);
    if (tracers->fast)
        rtcReleaseScene(tracers->fast);
    if (tracers->device)
        rtcReleaseDevice(tracers->device);
    kdr_scene_destroy(tracers->scene);
    free(tracers->vertices);
    free(tracers);
}

const kdr_scene *hit_tracers_scene(const hit_tracers *tracers) { return tracers->scene; }

/* ---- asking, in pieces of up to 16 rays in the layout that both libraries share */

typedef struct piece {
    _Alignas(64) uint32_t packet[WORDS * WIDTH];
    kdr_ray_hit rays[WIDTH];
    _Alignas(64) int32_t valid[WIDTH];
    uint32_t count;
} piece;

static void load(piece *p, const kdr_ray *rays, uint32_t count) {
    *p = (piece){.count = count};
    for (uint32_t i = 0; i < count; i++) {
        uint32_t words[RAY_WORDS];
        memcpy(words, &rays[i], sizeof words);
        for (uint32_t k = 0; k < RAY_WORDS; k++)
            p->packet[k * WIDTH + i] = words[k];
        p->packet[GEOMETRY * WIDTH + i] = p->packet[INSTANCE * WIDTH + i] = UINT32_MAX;
        p->rays[i] = (kdr_ray_hit){.ray = rays[i], .hit = {.geometry = UINT32_MAX, .instance = UINT32_MAX}};
        p->valid[i] = -1;
    }
}

static hit_answer answer_of(const kdr_ray_hit *from, bool any) {
    return (hit_answer){any ? from->ray.tmax < 0 : from->hit.geometry != UINT32_MAX, from->ray.tmax,
                        from->hit.primitive};
}

static hit_answer answer_in_packet(const piece *p, uint32_t i, bool any) {
    float t;
    memcpy(&t, &p->packet[FAR * WIDTH + i], sizeof t);
    return (hit_answer){any ? t < 0 : p->packet[GEOMETRY * WIDTH + i] != UINT32_MAX, t,
                        p->packet[PRIMITIVE * WIDTH + i]};
}

static void ask_kdray(const kdr_scene *scene, bool together, bool any, piece *p) {
    if (together && any) {
        kdr_occluded16(scene, p->valid, (kdr_ray16 *)(void *)p->packet);
    } else if (together) {
        kdr_intersect16(scene, p->valid, (kdr_ray_hit16 *)(void *)p->packet);
    } else {
        for (uint32_t i = 0; i < p->count; i++) {
            if (!any)
                kdr_intersect1(scene, &p->rays[i]);
            else if (kdr_occluded1(scene, &p->rays[i].ray))
                p->rays[i].ray.tmax = -INFINITY;
        }
    }
}

/* With denormals flushed to zero, as Embree recommends, and only meanwhile: kdray keeps them. */
static void ask_embree(RTCScene scene, bool together, const kdr_bench_rays *rays, piece *p) {
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = rays->coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
#if defined(__x86_64__)
    uint32_t before = _mm_getcsr();
    _mm_setcsr(before | _MM_FLUSH_ZERO_ON | 0x0040 /* denormals are zero */);
#endif
    if (together && rays->any) {
        rtcOccluded16(p->valid, scene, &context, (struct RTCRay16 *)(void *)p->packet);
    } else if (together) {
        rtcIntersect16(p->valid, scene, &context, (struct RTCRayHit16 *)(void *)p->packet);
    } else {
        for (uint32_t i = 0; i < p->count; i++) {
            _Alignas(64) struct RTCRayHit lone;
            memcpy(&lone, &p->rays[i], sizeof lone);
            if (rays->any)
                rtcOccluded1(scene, &context, &lone.ray);
            else
                rtcIntersect1(scene, &context, &lone);
            memcpy(&p->rays[i], &lone, sizeof lone);
        }
    }
#if defined(__x86_64__)
    _mm_setcsr(before);
#endif
}

static void ask_stream(const kdr_scene *scene, const kdr_bench_rays *rays, size_t begin, size_t count,
                       hit_answer *answers) {
    kdr_trace_def def = kdr_default_trace_def();
    def.coherence = rays->coherent ? KDR_COHERENCE_COHERENT : KDR_COHERENCE_INCOHERENT;
    if (rays->any) {
        uint8_t *occluded = test_allocate(count, 1);
        kdr_occluded_n(scene, &def, rays->rays + begin, occluded, count);
        for (size_t i = 0; i < count; i++)
            answers[i] = (hit_answer){.hit = occluded[i] != 0};
        free(occluded);
        return;
    }
    kdr_ray_hit *hits = test_allocate(count, sizeof *hits);
    for (size_t i = 0; i < count; i++)
        hits[i].ray = rays->rays[begin + i];
    kdr_intersect_n(scene, &def, hits, count);
    for (size_t i = 0; i < count; i++)
        answers[i] = answer_of(&hits[i], false);
    free(hits);
}

void hit_tracers_ask(const hit_tracers *tracers, int tracer, const kdr_bench_rays *rays, size_t begin, size_t end,
                     hit_answer *answers) {
    if (tracer == 2) {
        ask_stream(tracers->scene, rays, begin, end - begin, answers);
        return;
    }
    bool together = tracer < 2 ? tracer == 1 : tracer % 2 == 0;
    for (size_t first = begin; first < end; first += WIDTH) {
        piece p;
        load(&p, rays->rays + first, end - first < WIDTH ? (uint32_t)(end - first) : WIDTH);
        if (tracer < 2)
            ask_kdray(tracers->scene, together, rays->any, &p);
        else
            ask_embree(tracer < 5 ? tracers->robust : tracers->fast, together, rays, &p);
        for (uint32_t i = 0; i < p.count; i++)
            answers[first - begin + i] =
                together ? answer_in_packet(&p, i, rays->any) : answer_of(&p.rays[i], rays->any);
    }
}
