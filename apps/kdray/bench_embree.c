/* Embree as an engine: packets as wide as the machine takes ("packet"), or ray after ray ("single").
 *
 * The library is looked for when the program runs, so that kdray neither links nor needs it; its types come from its
 * header, where the compiler found one. It gets what serves it best: triangles at the quality asked for, in scene and
 * geometry alike, the fast triangle test, the coherent flag for coherent rays, and denormals flushed to zero while it
 * runs. */
#include "bench.h"
#include "bench_packets.h"
#include "memory.h"

#if __has_include(<embree3/rtcore.h>)

#include <dlfcn.h>
#include <embree3/rtcore.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

/* ---- the library */

#define FUNCTIONS(X)                                                                                                   \
    X(rtcNewDevice)                                                                                                    \
    X(rtcReleaseDevice)                                                                                                \
    X(rtcGetDeviceProperty)                                                                                            \
    X(rtcGetDeviceError)                                                                                               \
    X(rtcSetDeviceMemoryMonitorFunction)                                                                               \
    X(rtcNewScene)                                                                                                     \
    X(rtcReleaseScene)                                                                                                 \
    X(rtcSetSceneBuildQuality)                                                                                         \
    X(rtcAttachGeometry)                                                                                               \
    X(rtcCommitScene)                                                                                                  \
    X(rtcNewGeometry)                                                                                                  \
    X(rtcReleaseGeometry)                                                                                              \
    X(rtcSetGeometryBuildQuality)                                                                                      \
    X(rtcSetSharedGeometryBuffer)                                                                                      \
    X(rtcUpdateGeometryBuffer)                                                                                         \
    X(rtcCommitGeometry)                                                                                               \
    X(rtcIntersect1)                                                                                                   \
    X(rtcIntersect4)                                                                                                   \
    X(rtcIntersect8)                                                                                                   \
    X(rtcIntersect16)                                                                                                  \
    X(rtcOccluded1)                                                                                                    \
    X(rtcOccluded4)                                                                                                    \
    X(rtcOccluded8)                                                                                                    \
    X(rtcOccluded16)

static struct {
#define FUNCTION_POINTER(name) __typeof__(&name) name;
    FUNCTIONS(FUNCTION_POINTER)
#undef FUNCTION_POINTER
} embree;

static bool load(const char **why) {
    const char *name = getenv("KDRAY_EMBREE");
    void *library = dlopen(name ? name : "libembree3.so.3", RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        *why = "Embree is not there: libembree3.so.3, or the library that KDRAY_EMBREE names, does not load";
        return false;
    }
    bool whole = true;
    void *symbol;
#define FUNCTION_LOOK_UP(name)                                                                                         \
    symbol = dlsym(library, #name);                                                                                    \
    whole = whole && symbol;                                                                                           \
    memcpy(&embree.name, &symbol, sizeof symbol);
    FUNCTIONS(FUNCTION_LOOK_UP)
#undef FUNCTION_LOOK_UP
    if (!whole)
        *why = "the library that KDRAY_EMBREE names is no Embree 3";
    return whole;
}

const char *kdr_bench_embree_version(const char **why) {
    static char version[KDR_BENCH_NAME_SIZE];
    if (version[0])
        return version;
    if (!load(why))
        return NULL;
    RTCDevice device = embree.rtcNewDevice("set_affinity=0");
    if (!device) {
        *why = "Embree is there, but makes no device on this machine";
        return NULL;
    }
    long major = (long)embree.rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION_MAJOR);
    long minor = (long)embree.rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION_MINOR);
    long patch = (long)embree.rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION_PATCH);
    embree.rtcReleaseDevice(device);
    snprintf(version, sizeof version, "%ld.%ld.%ld", major, minor, patch);
    return version;
}

/* ---- state */

typedef struct embree_state {
    RTCDevice device;
    RTCScene scene;
    RTCGeometry geometry;
    float *vertices; /* the mesh's, with room behind the last for loads of 16 bytes */
    size_t vertex_count;
    int64_t bytes;  /* taken by all builds less what they gave back */
    uint32_t width; /* rays in a packet: 4, 8 or 16 */
} embree_state;

static embree_state *state_of(const kdr_bench_engine *engine) { return engine->state; }

/* What all devices hold together. One engine builds at a time, so its share is a difference. */
static _Atomic int64_t held_bytes;

static bool count_bytes(void *user, ssize_t bytes, bool post) {
    (void)user;
    (void)post;
    atomic_fetch_add_explicit(&held_bytes, bytes, memory_order_relaxed);
    return true;
}

/* False, and a sentence, after an error. */
static bool succeeded(const kdr_bench_engine *engine) {
    RTCDevice device = state_of(engine)->device;
    enum RTCError error = device ? embree.rtcGetDeviceError(device) : RTC_ERROR_UNKNOWN;
    if (error == RTC_ERROR_NONE)
        return true;
    engine->logger->log(KDR_LOG_ERROR,
                        error == RTC_ERROR_OUT_OF_MEMORY ? "Embree: out of memory" : "Embree: a call failed",
                        engine->logger->user);
    return false;
}

/* ---- denormals are zero while Embree runs on this thread, and only then: kdray keeps them */

static uint32_t flush_denormals(void) {
#if defined(__x86_64__)
    uint32_t before = _mm_getcsr();
    _mm_setcsr(before | _MM_FLUSH_ZERO_ON | 0x0040 /* denormals are zero */);
    return before;
#else
    return 0;
#endif
}

static void restore_denormals(uint32_t before) {
#if defined(__x86_64__)
    _mm_setcsr(before);
#else
    (void)before;
#endif
}

/* ---- rays */

_Static_assert(sizeof(struct RTCRay) == sizeof(kdr_ray) && sizeof(struct RTCRayHit) == sizeof(kdr_ray_hit),
               "rays and hits are alike");
_Static_assert(sizeof(struct RTCRayHit16) == sizeof(kdr_ray_hit16), "and so are packets of them");

static struct RTCIntersectContext context_for(const kdr_bench_rays *rays) {
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = rays->coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    return context;
}

/* ---- lone rays */

static void fill_single(const kdr_bench_engine *engine, const kdr_bench_rays *rays, size_t begin, size_t end,
                        kdr_bench_sheet *sheet) {
    (void)engine;
    kdr_bench_packets_fill(rays, 1, begin, end, sheet);
}

static uint64_t count_single(const kdr_bench_engine *engine, const kdr_bench_rays *rays, size_t begin, size_t end,
                             const kdr_bench_sheet *sheet) {
    (void)engine;
    return kdr_bench_packets_count(rays, 1, begin, end, sheet);
}

static void trace_single(const kdr_bench_engine *engine, const kdr_bench_rays *rays, size_t begin, size_t end,
                         kdr_bench_sheet *sheet) {
    RTCScene scene = state_of(engine)->scene;
    struct RTCIntersectContext context = context_for(rays);
    uint32_t before = flush_denormals();
    if (rays->any) {
        struct RTCRay *lone = sheet->rays;
        for (size_t i = begin; i < end; i++)
            embree.rtcOccluded1(scene, &context, &lone[i]);
    } else {
        struct RTCRayHit *lone = sheet->rays;
        for (size_t i = begin; i < end; i++)
            embree.rtcIntersect1(scene, &context, &lone[i]);
    }
    restore_denormals(before);
}

/* ---- packets */

static void fill_packet(const kdr_bench_engine *engine, const kdr_bench_rays *rays, size_t begin, size_t end,
                        kdr_bench_sheet *sheet) {
    kdr_bench_packets_fill(rays, state_of(engine)->width, begin, end, sheet);
}

static uint64_t count_packet(const kdr_bench_engine *engine, const kdr_bench_rays *rays, size_t begin, size_t end,
                             const kdr_bench_sheet *sheet) {
    return kdr_bench_packets_count(rays, state_of(engine)->width, begin, end, sheet);
}

static void ask_packet(uint32_t width, bool any, const int *valid, RTCScene scene, struct RTCIntersectContext *context,
                       void *packet) {
    if (width == 16 && any)
        embree.rtcOccluded16(valid, scene, context, packet);
    else if (width == 16)
        embree.rtcIntersect16(valid, scene, context, packet);
    else if (width == 8 && any)
        embree.rtcOccluded8(valid, scene, context, packet);
    else if (width == 8)
        embree.rtcIntersect8(valid, scene, context, packet);
    else if (any)
        embree.rtcOccluded4(valid, scene, context, packet);
    else
        embree.rtcIntersect4(valid, scene, context, packet);
}

static void trace_packet(const kdr_bench_engine *engine, const kdr_bench_rays *rays, size_t begin, size_t end,
                         kdr_bench_sheet *sheet) {
    const embree_state *state = state_of(engine);
    uint32_t width = state->width;
    _Alignas(64) int valid[16];
    memset(valid, -1, sizeof valid);
    struct RTCIntersectContext context = context_for(rays);
    uint32_t before = flush_denormals();
    for (size_t first = begin; first < end; first += width) {
        for (size_t lane = end - first; lane < width; lane++) /* the last packet is cut off */
            valid[lane] = 0;
        ask_packet(width, rays->any, valid, state->scene, &context, kdr_bench_packet_at(rays, width, sheet, first));
    }
    restore_denormals(before);
}

/* ---- building */

/* Embree reads vertices by 16 bytes, so it gets a copy with room behind the last. */
static bool show(kdr_bench_engine *engine, const kdr_mesh *mesh) {
    embree_state *state = state_of(engine);
    size_t count = 3 * mesh->vertex_count;
    if (!state->vertices || mesh->vertex_count != state->vertex_count) {
        kdr_memory_release(state->vertices);
        state->vertices = kdr_memory_get(count + 4, sizeof *state->vertices);
        state->vertex_count = mesh->vertex_count;
    }
    if (count)
        memcpy(state->vertices, mesh->positions, count * sizeof *state->vertices);
    memset(state->vertices + count, 0, 4 * sizeof *state->vertices);
    embree.rtcSetSharedGeometryBuffer(state->geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, state->vertices, 0,
                                      3 * sizeof(float), mesh->vertex_count);
    embree.rtcSetSharedGeometryBuffer(state->geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh->indices, 0,
                                      3 * sizeof(uint32_t), mesh->triangle_count);
    return succeeded(engine);
}

static bool build(kdr_bench_engine *engine) {
    embree_state *state = state_of(engine);
    int64_t held = atomic_load(&held_bytes);
    uint32_t before = flush_denormals();
    embree.rtcUpdateGeometryBuffer(state->geometry, RTC_BUFFER_TYPE_VERTEX, 0);
    embree.rtcCommitGeometry(state->geometry);
    embree.rtcCommitScene(state->scene);
    restore_denormals(before);
    state->bytes += atomic_load(&held_bytes) - held;
    return succeeded(engine);
}

static double bytes(const kdr_bench_engine *engine) { return (double)state_of(engine)->bytes; }

static void close_engine(kdr_bench_engine *engine) {
    embree_state *state = state_of(engine);
    if (state->geometry)
        embree.rtcReleaseGeometry(state->geometry);
    if (state->scene)
        embree.rtcReleaseScene(state->scene);
    if (state->device)
        embree.rtcReleaseDevice(state->device);
    kdr_memory_release(state->vertices);
    kdr_memory_release(state);
    engine->state = NULL;
}

static RTCDevice new_device(const kdr_bench_scene *scene) {
    static const char *const limits[] = {[KDR_ISA_SCALAR] = ",isa=sse2",
                                         [KDR_ISA_SSE42] = ",isa=sse4.2",
                                         [KDR_ISA_AVX2] = ",isa=avx2",
                                         [KDR_ISA_AVX512] = "",
                                         [KDR_ISA_NEON] = ""};
    uint32_t threads = kdr_device_worker_count(scene->device);
    char config[64];
    snprintf(config, sizeof config, "threads=%u,set_affinity=0%s", threads, limits[kdr_device_isa(scene->device)]);
    return embree.rtcNewDevice(config);
}

bool kdr_bench_embree_open(const kdr_bench_scene *scene, const char *name, const kdr_logger *logger,
                           kdr_bench_engine *out) {
    embree_state *state = kdr_memory_get(1, sizeof *state);
    *state = (embree_state){.width = 4};
    *out = (kdr_bench_engine){.name = name,
                              .tracers = {{"packet", fill_packet, trace_packet, count_packet},
                                          {"single", fill_single, trace_single, count_single}},
                              .show = show,
                              .build = build,
                              .bytes = bytes,
                              .close = close_engine,
                              .state = state,
                              .logger = logger};
    enum RTCBuildQuality level = RTC_BUILD_QUALITY_MEDIUM;
    if (strcmp(name, "embree/low") == 0)
        level = RTC_BUILD_QUALITY_LOW;
    else if (strcmp(name, "embree/high") == 0)
        level = RTC_BUILD_QUALITY_HIGH;

    state->device = new_device(scene);
    if (!succeeded(out)) {
        close_engine(out);
        return false;
    }
    embree.rtcSetDeviceMemoryMonitorFunction(state->device, count_bytes, NULL);
    if (embree.rtcGetDeviceProperty(state->device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED))
        state->width = 16;
    else if (embree.rtcGetDeviceProperty(state->device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED))
        state->width = 8;

    /* Both the scene and the geometry have a quality: one alone would leave a low build at medium. */
    state->scene = embree.rtcNewScene(state->device);
    state->geometry = embree.rtcNewGeometry(state->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    embree.rtcSetSceneBuildQuality(state->scene, level);
    embree.rtcSetGeometryBuildQuality(state->geometry, level);
    embree.rtcAttachGeometry(state->scene, state->geometry);
    if (show(out, scene->mesh))
        return true;
    close_engine(out);
    return false;
}

#else

const char *kdr_bench_embree_version(const char **why) {
    *why = "this kdray was compiled without Embree's header";
    return NULL;
}

bool kdr_bench_embree_open(const kdr_bench_scene *scene, const char *name, const kdr_logger *logger,
                           kdr_bench_engine *out) {
    (void)scene;
    (void)name;
    (void)out;
    logger->log(KDR_LOG_ERROR, "this kdray was compiled without Embree's header", logger->user);
    return false;
}

#endif
