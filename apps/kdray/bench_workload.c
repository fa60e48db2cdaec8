/* The rays of the benchmark, the same floats for every tracer.
 *
 * Primary rays look through the pixels' centres of a pinhole camera, block by block of 64x64 pixels, each block as
 * tiles of 8x8. Every primary hit sends a shadow ray to the point light and four rays that are distributed by the
 * cosine to the normal. These begin above the surface, by 1e-4 of the distance from the eye along the normal on the
 * eye's side: whether they meet anything is then a question about the scene, not about rounding at their start. Chance
 * depends on the pixel alone, so that a run can be repeated. */
#include "bench.h"
#include "memory.h"

#include <math.h>
#include <stdatomic.h>

#define BLOCK_SIDE 64u
#define TILE_SIDE 8u
#define HEMISPHERE_RAYS 4u
#define LIFT 1e-4           /* of the distance from the eye */
#define LIGHT_REACH 0.9999f /* of the distance to the light */
#define TURN 6.283185307179586

const char *kdr_bench_kind_name(kdr_bench_kind kind) {
    static const char *const names[KDR_BENCH_KINDS] = {"primary", "shadow", "ao", "diffuse"};
    return names[kind];
}

/* ---- blocks over workers */

typedef struct block_run {
    kdr_bench_block_fn *fn;
    void *context;
    size_t count;
    atomic_size_t cursor;
} block_run;

static void run_blocks(void *context, uint32_t index) {
    (void)index;
    block_run *run = context;
    for (;;) {
        size_t begin = atomic_fetch_add_explicit(&run->cursor, KDR_BENCH_BLOCK, memory_order_relaxed);
        if (begin >= run->count)
            return;
        size_t left = run->count - begin;
        run->fn(run->context, begin, begin + (left < KDR_BENCH_BLOCK ? left : KDR_BENCH_BLOCK));
    }
}

void kdr_bench_run(const kdr_bench_scene *scene, size_t count, kdr_bench_block_fn *fn, void *context) {
    block_run run = {.fn = fn, .context = context, .count = count};
    kdr_device_run(scene->device, run_blocks, &run, kdr_device_worker_count(scene->device));
}

/* ---- vectors in double precision: rays are made once, and rounded once */

typedef struct vector {
    double x, y, z;
} vector;

static vector vector_of(const float v[3]) { return (vector){v[0], v[1], v[2]}; }
static vector add(vector a, vector b) { return (vector){a.x + b.x, a.y + b.y, a.z + b.z}; }
static vector scale(vector a, double s) { return (vector){a.x * s, a.y * s, a.z * s}; }
static vector sub(vector a, vector b) { return add(a, scale(b, -1)); }
static double dot(vector a, vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static vector cross(vector a, vector b) {
    return (vector){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* False for a vector without a direction. */
static bool make_unit(vector *v) {
    double length = sqrt(dot(*v, *v));
    *v = scale(*v, 1 / length);
    return length > 0 && isfinite(length);
}

static kdr_ray ray_from(vector origin, vector direction, float tmax) {
    return (kdr_ray){.origin_x = (float)origin.x,
                     .origin_y = (float)origin.y,
                     .origin_z = (float)origin.z,
                     .direction_x = (float)direction.x,
                     .direction_y = (float)direction.y,
                     .direction_z = (float)direction.z,
                     .tmax = tmax,
                     .mask = UINT32_MAX};
}

/* ---- primary rays */

static bool make_primary(const kdr_bench_scene *scene, kdr_ray *rays) {
    vector eye = vector_of(scene->camera.eye);
    vector forward = sub(vector_of(scene->camera.target), eye);
    if (!make_unit(&forward))
        return false;
    vector right = cross(forward, vector_of(scene->camera.up));
    if (!make_unit(&right))
        return false;
    vector up = cross(right, forward);
    double half_height = tan(scene->camera.fov * (TURN / 720));
    double half_width = half_height * scene->width / scene->height;

    /* Blocks, tiles and pixels in rows from the top; what lies outside the picture is left out. */
    size_t count = 0;
    uint32_t columns = (scene->width + BLOCK_SIDE - 1) / BLOCK_SIDE;
    uint32_t lines = (scene->height + BLOCK_SIDE - 1) / BLOCK_SIDE;
    for (uint32_t block = 0; block < columns * lines; block++) {
        for (uint32_t i = 0; i < BLOCK_SIDE * BLOCK_SIDE; i++) {
            uint32_t tile = i / (TILE_SIDE * TILE_SIDE), tiles = BLOCK_SIDE / TILE_SIDE;
            uint32_t x = block % columns * BLOCK_SIDE + tile % tiles * TILE_SIDE + i % TILE_SIDE;
            uint32_t y = block / columns * BLOCK_SIDE + tile / tiles * TILE_SIDE + i / TILE_SIDE % TILE_SIDE;
            if (x >= scene->width || y >= scene->height)
                continue;
            vector across = scale(right, half_width * (2 * (x + 0.5) / scene->width - 1));
            vector upward = scale(up, half_height * (1 - 2 * (y + 0.5) / scene->height));
            vector direction = add(forward, add(across, upward));
            make_unit(&direction);
            rays[count++] = ray_from(eye, direction, INFINITY);
        }
    }
    return true;
}

/* ---- rays from hits */

/* Numbers in [0, 1): the mixing steps of splitmix64 over a counter that starts from the pixel. */
static double chance(uint64_t *state) {
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

/* A direction within the hemisphere around a unit normal, its density the cosine to the normal over pi. */
static vector cosine_direction(vector normal, uint64_t *state) {
    vector side = fabs(normal.x) < 0.5 ? (vector){1, 0, 0} : (vector){0, 1, 0};
    vector tangent = cross(normal, side);
    make_unit(&tangent);
    vector bitangent = cross(normal, tangent);
    double square = chance(state), turn = TURN * chance(state);
    vector flat = add(scale(tangent, cos(turn)), scale(bitangent, sin(turn)));
    vector direction = add(scale(flat, sqrt(square)), scale(normal, sqrt(1 - square)));
    make_unit(&direction);
    return direction;
}

static kdr_ray shadow_ray(vector origin, vector light) {
    vector direction = sub(light, origin);
    float distance = (float)sqrt(dot(direction, direction));
    if (!make_unit(&direction)) /* the light lies in the surface: a ray of no length */
        return ray_from(origin, (vector){0, 1, 0}, 0);
    return ray_from(origin, direction, distance * LIGHT_REACH);
}

/* The rays from one primary hit; `pixel` seeds chance. */
static void make_secondary(const kdr_ray_hit *found, vector light, size_t pixel, kdr_ray *shadow,
                           kdr_ray hemisphere[HEMISPHERE_RAYS]) {
    vector eye = {found->ray.origin_x, found->ray.origin_y, found->ray.origin_z};
    vector direction = {found->ray.direction_x, found->ray.direction_y, found->ray.direction_z};
    vector normal = {found->hit.normal_x, found->hit.normal_y, found->hit.normal_z};
    if (!make_unit(&normal)) /* too small for a float */
        normal = scale(direction, -1);
    if (dot(normal, direction) > 0)
        normal = scale(normal, -1);

    double t = found->ray.tmax;
    vector origin = add(add(eye, scale(direction, t)), scale(normal, LIFT * t));
    *shadow = shadow_ray(origin, light);
    uint64_t state = (uint64_t)pixel << 8;
    for (uint32_t i = 0; i < HEMISPHERE_RAYS; i++)
        hemisphere[i] = ray_from(origin, cosine_direction(normal, &state), INFINITY);
}

typedef struct reference_trace {
    const kdr_scene *scene;
    kdr_ray_hit *found;
} reference_trace;

static void trace_reference(void *context, size_t begin, size_t end) {
    const reference_trace *trace = context;
    kdr_intersect_n(trace->scene, NULL, trace->found + begin, end - begin);
}

bool kdr_bench_workload_make(const kdr_bench_scene *scene, const kdr_scene *reference, const kdr_logger *logger,
                             kdr_bench_workload *out) {
    *out = (kdr_bench_workload){0};
    size_t pixels = (size_t)scene->width * scene->height;
    kdr_ray *primary = kdr_memory_get(pixels, sizeof *primary);
    if (!make_primary(scene, primary)) {
        kdr_memory_release(primary);
        logger->log(KDR_LOG_ERROR, "the camera has no view: it looks at its own place, or along its up direction",
                    logger->user);
        return false;
    }

    /* Ask the reference where the primary rays end */
    kdr_ray_hit *found = kdr_memory_get(pixels, sizeof *found);
    for (size_t i = 0; i < pixels; i++)
        found[i] = (kdr_ray_hit){.ray = primary[i], .hit = {.geometry = KDR_INVALID_ID}};
    kdr_bench_run(scene, pixels, trace_reference, &(reference_trace){reference, found});
    size_t hits = 0;
    for (size_t i = 0; i < pixels; i++)
        hits += found[i].hit.geometry != KDR_INVALID_ID;

    /* Go on from there */
    kdr_ray *shadow = kdr_memory_get(hits, sizeof *shadow);
    kdr_ray *hemisphere = kdr_memory_get(hits, HEMISPHERE_RAYS * sizeof *hemisphere);
    vector light = vector_of(scene->light);
    size_t made = 0;
    for (size_t i = 0; i < pixels; i++) {
        if (found[i].hit.geometry == KDR_INVALID_ID)
            continue;
        make_secondary(&found[i], light, i, &shadow[made], &hemisphere[HEMISPHERE_RAYS * made]);
        made++;
    }
    kdr_memory_release(found);
    out->kinds[KDR_BENCH_PRIMARY] = (kdr_bench_rays){primary, pixels, .any = false, .coherent = true};
    out->kinds[KDR_BENCH_SHADOW] = (kdr_bench_rays){shadow, hits, .any = true, .coherent = true};
    out->kinds[KDR_BENCH_AO] = (kdr_bench_rays){hemisphere, HEMISPHERE_RAYS * hits, .any = true, .coherent = false};
    out->kinds[KDR_BENCH_DIFFUSE] = out->kinds[KDR_BENCH_AO];
    out->kinds[KDR_BENCH_DIFFUSE].any = false;
    return true;
}

void kdr_bench_workload_release(kdr_bench_workload *workload) {
    for (int kind = 0; kind < KDR_BENCH_DIFFUSE; kind++) /* diffuse rays are those of ambient occlusion */
        kdr_memory_release((void *)workload->kinds[kind].rays);
    *workload = (kdr_bench_workload){0};
}
