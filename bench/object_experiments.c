/* A tree of trees against one tree: when does it pay to keep the objects of a scene apart?
 *
 * The same triangles are shown as one geometry, or as so many scenes of an object each, which stand as instances in one
 * more scene. Objects lie side by side, or all in one place, turned. Per row the medians over the rounds of a commit of
 * all that changes and of a picture's primary and shadow rays. Rows of instances come twice: every object changes from
 * frame to frame ("objects"), or only places do ("places"). docs/experiments.md has the question and what came out. */
#include "base/cpu.h"
#include "kdray/render.h"

#include <inttypes.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MOST_OBJECTS 64u
#define MOST_ROUNDS 99u
#define BLOCK 4096u

typedef struct request {
    size_t triangles; /* of all objects together */
    uint32_t rounds;
    uint32_t side; /* pixels, a multiple of 64 */
} request;

/* One arrangement, all ways of it at once. */
typedef struct arrangement {
    uint32_t count, side;
    bool apart;
    kdr_device *device;
    kdr_mesh *object;
    float transforms[MOST_OBJECTS][12];
    float *vertices;   /* of all objects, where they stand */
    uint32_t *indices; /* of all objects */
    kdr_scene *one, *parts[MOST_OBJECTS], *whole;
    kdr_ray_hit *primary;
    kdr_ray *shadow;
    uint8_t *occluded;
    float eye[3], light[3];
} arrangement;

static void *get(size_t count, size_t size) {
    void *memory = calloc(count + (count == 0), size);
    if (!memory) {
        fputs("object_experiments: out of memory\n", stderr);
        exit(1);
    }
    return memory;
}

static void must(kdr_status status) {
    if (status == KDR_OK)
        return;
    fprintf(stderr, "object_experiments: %s\n", kdr_status_text(status));
    exit(1);
}

/* ---- scenes */

/* Turned about the vertical, and moved to a place of a square grid if the objects are to lie apart. */
static void place_objects(arrangement *a) {
    float bounds[6], size = 0;
    kdr_mesh_bounds(a->object, bounds);
    for (int k = 0; k < 3; k++)
        size = fmaxf(size, bounds[k + 3] - bounds[k]);
    uint32_t columns = (uint32_t)ceil(sqrt(a->count));
    for (uint32_t i = 0; i < a->count; i++) {
        float angle = 2.4f * (float)i, c = cosf(angle), s = sinf(angle);
        float x = a->apart ? 1.5f * size * (float)(i % columns) : 0,
              z = a->apart ? 1.5f * size * (float)(i / columns) : 0;
        const float m[12] = {c, 0, s, x, 0, 1, 0, 0, -s, 0, c, z};
        memcpy(a->transforms[i], m, sizeof m);
    }
}

static void make_arrays(arrangement *a) {
    size_t vertices = a->object->vertex_count, triangles = a->object->triangle_count;
    a->vertices = get(3 * vertices * a->count, sizeof *a->vertices);
    a->indices = get(3 * triangles * a->count, sizeof *a->indices);
    for (uint32_t i = 0; i < a->count; i++) {
        const float *m = a->transforms[i];
        for (size_t v = 0; v < vertices; v++) {
            const float *p = &a->object->positions[3 * v];
            for (int k = 0; k < 3; k++)
                a->vertices[3 * (i * vertices + v) + (size_t)k] =
                    m[4 * k] * p[0] + m[4 * k + 1] * p[1] + m[4 * k + 2] * p[2] + m[4 * k + 3];
        }
        for (size_t t = 0; t < 3 * triangles; t++)
            a->indices[3 * i * triangles + t] = a->object->indices[t] + (uint32_t)(i * vertices);
    }
}

static kdr_scene *scene_of(kdr_device *device, const float *vertices, size_t vertex_count, const uint32_t *indices,
                           size_t triangle_count) {
    kdr_scene *scene;
    kdr_triangles_def def = kdr_default_triangles_def();
    def.vertices = vertices;
    def.vertex_count = vertex_count;
    def.indices = indices;
    def.triangle_count = triangle_count;
    must(kdr_scene_create(device, &scene));
    must(kdr_scene_add_triangles(scene, &def, NULL));
    must(kdr_scene_commit(scene, NULL));
    return scene;
}

static void make_scenes(arrangement *a) {
    const kdr_mesh *o = a->object;
    a->one = scene_of(a->device, a->vertices, o->vertex_count * a->count, a->indices, o->triangle_count * a->count);
    for (uint32_t i = 0; i < a->count; i++)
        a->parts[i] = scene_of(a->device, o->positions, o->vertex_count, o->indices, o->triangle_count);
    must(kdr_scene_create(a->device, &a->whole));
    for (uint32_t i = 0; i < a->count; i++) {
        kdr_instance_def def = kdr_default_instance_def();
        def.scene = a->parts[i];
        def.transforms = a->transforms[i];
        must(kdr_scene_add_instance(a->whole, &def, NULL));
    }
    must(kdr_scene_commit(a->whole, NULL));
}

/* ---- frames */

static double commit_one(arrangement *a) {
    double begin = kdr_cpu_seconds();
    must(kdr_scene_touch(a->one, 0));
    must(kdr_scene_commit(a->one, NULL));
    return kdr_cpu_seconds() - begin;
}

static double commit_parts(arrangement *a, bool objects) {
    double begin = kdr_cpu_seconds();
    for (uint32_t i = 0; i < a->count; i++) {
        if (objects) {
            must(kdr_scene_touch(a->parts[i], 0));
            must(kdr_scene_commit(a->parts[i], NULL));
        }
        must(kdr_scene_touch(a->whole, i));
    }
    must(kdr_scene_commit(a->whole, NULL));
    return kdr_cpu_seconds() - begin;
}

/* Rays through the pixels, in tiles of 8x8. */
static void aim(arrangement *a) {
    float bounds[6];
    kdr_scene_bounds(a->one, bounds);
    kdr_camera camera = kdr_camera_for_bounds(bounds);
    kdr_light_for_bounds(bounds, a->light);
    memcpy(a->eye, camera.eye, sizeof a->eye);
    float forward[3], right[3], length = 0;
    for (int k = 0; k < 3; k++)
        forward[k] = camera.target[k] - camera.eye[k], length += forward[k] * forward[k];
    length = sqrtf(length);
    for (int k = 0; k < 3; k++)
        forward[k] /= length;
    float across = sqrtf(forward[0] * forward[0] + forward[2] * forward[2]);
    right[0] = -forward[2] / across, right[1] = 0, right[2] = forward[0] / across;
    const float up[3] = {right[1] * forward[2] - right[2] * forward[1], right[2] * forward[0] - right[0] * forward[2],
                         right[0] * forward[1] - right[1] * forward[0]};
    const uint32_t side = a->side;
    const float half = tanf(camera.fov * 3.14159265f / 360);
    for (uint32_t i = 0; i < side * side; i++) {
        uint32_t tile = i / 64, x = tile % (side / 8) * 8 + i % 8, y = tile / (side / 8) * 8 + i / 8 % 8;
        float u = half * (2 * ((float)x + 0.5f) / side - 1), v = half * (1 - 2 * ((float)y + 0.5f) / side);
        kdr_ray_hit *to = &a->primary[i];
        *to = (kdr_ray_hit){.ray = {.origin_x = a->eye[0],
                                    .origin_y = a->eye[1],
                                    .origin_z = a->eye[2],
                                    .direction_x = forward[0] + u * right[0] + v * up[0],
                                    .direction_y = forward[1] + u * right[1] + v * up[1],
                                    .direction_z = forward[2] + u * right[2] + v * up[2],
                                    .tmax = INFINITY}};
    }
}

typedef struct tracing {
    arrangement *a;
    const kdr_scene *scene;
    bool any;
    atomic_uint next;
} tracing;

static void trace_blocks(void *context, uint32_t index) {
    (void)index;
    tracing *t = context;
    for (uint32_t begin; (begin = atomic_fetch_add(&t->next, BLOCK)) < t->a->side * t->a->side;) {
        if (t->any)
            kdr_occluded_n(t->scene, NULL, t->a->shadow + begin, t->a->occluded + begin, BLOCK);
        else
            kdr_intersect_n(t->scene, NULL, t->a->primary + begin, BLOCK);
    }
}

static double trace(arrangement *a, const kdr_scene *scene, bool any) {
    tracing t = {.a = a, .scene = scene, .any = any};
    double begin = kdr_cpu_seconds();
    kdr_device_run(a->device, trace_blocks, &t, kdr_device_worker_count(a->device));
    return kdr_cpu_seconds() - begin;
}

/* A shadow ray from each hit to the light; from a miss one that is not sent. Returns the number of hits. */
static uint32_t turn_to_light(arrangement *a) {
    uint32_t hits = 0;
    for (uint32_t i = 0; i < a->side * a->side; i++) {
        const kdr_ray_hit *from = &a->primary[i];
        const float *origin = &from->ray.origin_x, *direction = &from->ray.direction_x;
        kdr_ray *to = &a->shadow[i];
        *to = (kdr_ray){.tmax = -1};
        if (from->hit.geometry == KDR_INVALID_ID)
            continue;
        hits++;
        to->tmin = 1e-3f;
        to->tmax = 1;
        for (int k = 0; k < 3; k++) {
            (&to->origin_x)[k] = origin[k] + from->ray.tmax * direction[k];
            (&to->direction_x)[k] = a->light[k] - (&to->origin_x)[k];
        }
    }
    return hits;
}

/* ---- rows */

enum way { ONE, OBJECTS, PLACES, WAYS };
static const char *const way_names[] = {"one tree", "instances, objects change", "instances, places change"};

typedef struct figures {
    double commit[MOST_ROUNDS], primary[MOST_ROUNDS], shadow[MOST_ROUNDS];
    uint32_t hits;
} figures;

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, uint32_t count) {
    qsort(values, count, sizeof *values, compare);
    return values[count / 2];
}

static void run_way(arrangement *a, enum way way, uint32_t round, figures *f) {
    const kdr_scene *scene = way == ONE ? a->one : a->whole;
    f->commit[round] = way == ONE ? commit_one(a) : commit_parts(a, way == OBJECTS);
    aim(a);
    f->primary[round] = trace(a, scene, false);
    f->hits = turn_to_light(a);
    f->shadow[round] = trace(a, scene, true);
}

static void measure(const request *r, uint32_t count, bool apart) {
    arrangement *a = get(1, sizeof *a);
    a->count = count;
    a->side = r->side;
    a->apart = apart;
    must(kdr_device_create(NULL, &a->device));
    must(kdr_mesh_make("knot", r->triangles / count, 0, NULL, &a->object));
    a->primary = get((size_t)a->side * a->side, sizeof *a->primary);
    a->shadow = get((size_t)a->side * a->side, sizeof *a->shadow);
    a->occluded = get((size_t)a->side * a->side, 1);
    place_objects(a);
    make_arrays(a);
    make_scenes(a);
    figures *all = get(WAYS, sizeof *all);
    for (uint32_t round = 0; round < r->rounds; round++)
        for (int i = 0; i < WAYS; i++) {
            enum way way = (enum way)(round % 2 ? WAYS - 1 - i : i);
            run_way(a, way, round, &all[way]);
        }
    for (int way = 0; way < WAYS; way++) {
        figures *f = &all[way];
        double commit = 1e3 * median(f->commit, r->rounds), primary = 1e3 * median(f->primary, r->rounds),
               shadow = 1e3 * median(f->shadow, r->rounds);
        printf("%" PRIu32 ",%s,\"%s\",%zu,%" PRIu32 ",%.4g,%.4g,%.4g,%.4g,%" PRIu32 "\n", count,
               apart ? "apart" : "in one place", way_names[way], a->object->triangle_count * count, r->rounds, commit,
               primary, shadow, commit + primary + shadow, f->hits);
    }
    fflush(stdout);

    kdr_scene_destroy(a->whole);
    for (uint32_t i = 0; i < count; i++)
        kdr_scene_destroy(a->parts[i]);
    kdr_scene_destroy(a->one);
    kdr_device_destroy(a->device);
    kdr_mesh_destroy(a->object);
    free(a->vertices);
    free(a->indices);
    free(a->primary);
    free(a->shadow);
    free(a->occluded);
    free(all);
    free(a);
}

/* ---- the program */

static int wrong(const char *argument) {
    fprintf(stderr,
            "object_experiments: %s\nusage: object_experiments [--triangles 10000-10000000] [--rounds 1-%u] [--side "
            "64, 128 ... 4096]\n",
            argument, MOST_ROUNDS);
    return 2;
}

/* A whole number in a range; false for anything else. */
static bool read_number(const char *text, unsigned long least, unsigned long most, unsigned long *out) {
    char *end;
    *out = text ? strtoul(text, &end, 10) : 0;
    return text && *text >= '0' && *text <= '9' && *end == 0 && *out >= least && *out <= most;
}

/* The processor's name as the system gives it. */
static void write_machine(void) {
    char line[256];
    const char *name = NULL;
    FILE *file = fopen("/proc/cpuinfo", "r");
    while (file && !name && fgets(line, sizeof line, file))
        name = strncmp(line, "model name", 10) == 0 ? strchr(line, ':') : NULL;
    if (file)
        fclose(file);
    if (name)
        line[strcspn(line, "\n")] = 0;
    printf("# machine: %s, %ld processors\n", name ? name + 2 : "unknown", sysconf(_SC_NPROCESSORS_ONLN));
}

int main(int argc, char **argv) {
    request r = {.triangles = 200000, .rounds = 9, .side = 512};
    for (int i = 1; i < argc; i += 2) {
        unsigned long value;
        const char *text = i + 1 < argc ? argv[i + 1] : NULL;
        if (strcmp(argv[i], "--triangles") == 0 && read_number(text, 10000, 10000000, &value))
            r.triangles = value;
        else if (strcmp(argv[i], "--rounds") == 0 && read_number(text, 1, MOST_ROUNDS, &value))
            r.rounds = (uint32_t)value;
        else if (strcmp(argv[i], "--side") == 0 && read_number(text, 64, 4096, &value) && value % 64 == 0)
            r.side = (uint32_t)value;
        else
            return wrong(argv[i]);
    }
    printf("# objects: %ux%u pixels, plan: the default\n", r.side, r.side);
    write_machine();
    puts("objects,layout,way,triangles,rounds,commit_ms,primary_ms,shadow_ms,frame_ms,hits");
    for (uint32_t count = 1; count <= MOST_OBJECTS; count *= 2)
        for (int apart = 1; apart >= 0; apart--)
            measure(&r, count, apart);
    return 0;
}
