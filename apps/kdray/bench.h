/* kdray bench: the same rays through several tracers in one run.
 *
 *   scene    a mesh, a view of it and the workers that trace for everyone
 *   rays     one kind of rays, made once and given to all tracers (bench_workload.c)
 *   engine   what builds: kdray, or Embree at one quality (bench_kdray.c, bench_embree.c)
 *   tracer   one way to ask an engine: what a row of the results is named by, "embree/low/packet"
 *   row      the medians of a tracer on a scene (bench_measure.c), shown by bench_report.c
 */
#ifndef KDR_APPS_KDRAY_BENCH_H
#define KDR_APPS_KDRAY_BENCH_H

#include "progress.h"

#include <kdray/render.h>
#include <stdio.h>

/* Rays in one call of a tracer: a block of 64x64 pixels. */
#define KDR_BENCH_BLOCK 4096u

/* ---- rays */

typedef enum kdr_bench_kind {
    KDR_BENCH_PRIMARY, /* closest hit, through the pixels' centres */
    KDR_BENCH_SHADOW,  /* any hit, from each primary hit to the light */
    KDR_BENCH_AO,      /* any hit, four from each primary hit, distributed by the cosine to the normal */
    KDR_BENCH_DIFFUSE, /* closest hit, the same four */
    KDR_BENCH_KINDS,
} kdr_bench_kind;

/* "primary", "shadow", "ao", "diffuse". */
const char *kdr_bench_kind_name(kdr_bench_kind kind);

typedef struct kdr_bench_rays {
    const kdr_ray *rays; /* in the order of the pixels' blocks of 64x64 and tiles of 8x8 */
    size_t count;
    bool any;      /* asks for any hit, not the closest */
    bool coherent; /* neighbours go the same way */
} kdr_bench_rays;

#define KDR_BENCH_SCENE_SIZE 64u
#define KDR_BENCH_NAME_SIZE 32u

typedef struct kdr_bench_scene {
    char name[KDR_BENCH_SCENE_SIZE];
    kdr_mesh *mesh;           /* what is shown now */
    kdr_animation *animation; /* where the mesh of another frame comes from; NULL: it stands still */
    double frame_seconds;     /* from one frame to the next */
    float bounds[6];          /* of all that is shown: {min x, y, z, max x, y, z} */
    kdr_camera camera;
    float light[3];
    uint32_t width, height;
    kdr_device *device; /* kdray's; its workers trace for every tracer */
} kdr_bench_scene;

typedef struct kdr_bench_workload {
    kdr_bench_rays kinds[KDR_BENCH_KINDS];
} kdr_bench_workload;

/* Makes the rays of all kinds from the closest hits of `reference`, a committed scene of the same mesh. False, with a
 * sentence to the logger, for a camera without a view. Release: kdr_bench_workload_release. */
bool kdr_bench_workload_make(const kdr_bench_scene *scene, const kdr_scene *reference, const kdr_logger *logger,
                             kdr_bench_workload *out);
void kdr_bench_workload_release(kdr_bench_workload *workload);

/* Calls fn(context, begin, end) for every block of [0, count) on the scene's workers, handed out by one cursor. */
typedef void kdr_bench_block_fn(void *context, size_t begin, size_t end);
void kdr_bench_run(const kdr_bench_scene *scene, size_t count, kdr_bench_block_fn *fn, void *context);

/* ---- engines and tracers */

/* Room for the rays of one kind in a tracer's own layout. */
typedef struct kdr_bench_sheet {
    void *rays;        /* KDR_BENCH_SHEET_BYTES a ray, for a count rounded up to KDR_BENCH_BLOCK */
    uint8_t *occluded; /* one a ray */
} kdr_bench_sheet;

#define KDR_BENCH_SHEET_BYTES sizeof(kdr_ray_hit)

typedef struct kdr_bench_engine kdr_bench_engine;

/* Functions get a range of rays that begins at a multiple of KDR_BENCH_BLOCK and is no longer. */
typedef struct kdr_bench_tracer {
    const char *name; /* after the engine's: "stream", "single", "packet" */
    /* Lays the rays out anew. Not timed. */
    void (*fill)(const kdr_bench_engine *engine, const kdr_bench_rays *rays, size_t begin, size_t end,
                 kdr_bench_sheet *sheet);
    /* Nothing but the calls that trace. */
    void (*trace)(const kdr_bench_engine *engine, const kdr_bench_rays *rays, size_t begin, size_t end,
                  kdr_bench_sheet *sheet);
    /* Rays that hit something. Not timed. */
    uint64_t (*count)(const kdr_bench_engine *engine, const kdr_bench_rays *rays, size_t begin, size_t end,
                      const kdr_bench_sheet *sheet);
} kdr_bench_tracer;

#define KDR_BENCH_ENGINE_TRACERS 3u

struct kdr_bench_engine {
    const char *name;                                   /* "kdray", "embree/low" */
    kdr_bench_tracer tracers[KDR_BENCH_ENGINE_TRACERS]; /* those behind the last have no name */
    /* Takes over the arrays of the scene's mesh, which may be others than before. Not timed. False after a sentence to
     * the logger. */
    bool (*show)(kdr_bench_engine *engine, const kdr_mesh *mesh);
    /* Builds from scratch, as for a frame in which everything moved. False after a sentence to the logger. */
    bool (*build)(kdr_bench_engine *engine);
    /* Bytes of what the last build made. */
    double (*bytes)(const kdr_bench_engine *engine);
    void (*close)(kdr_bench_engine *engine);
    void *state; /* the engine's own */
    const kdr_logger *logger;
};

/* kdray on the scene's own device. False after a sentence to the logger. */
bool kdr_bench_kdray_open(const kdr_bench_scene *scene, const kdr_build_def *build, const kdr_logger *logger,
                          kdr_bench_engine *out);

/* The scene that a kdray engine commits: the reference for the secondary rays. */
const kdr_scene *kdr_bench_kdray_scene(const kdr_bench_engine *engine);

/* Embree is looked for when the program runs: the library that the environment variable KDRAY_EMBREE names, or
 * libembree3.so.3. Its version, such as "3.13.5"; NULL, and a sentence in *why, without it. */
const char *kdr_bench_embree_version(const char **why);

/* Embree with the quality that ends the name ("embree/low", "embree/medium", "embree/high"), as many threads as the
 * scene's device has workers, and no wider instructions than the device uses. False after a sentence to the logger.
 * Only after kdr_bench_embree_version has found it. */
bool kdr_bench_embree_open(const kdr_bench_scene *scene, const char *name, const kdr_logger *logger,
                           kdr_bench_engine *out);

/* ---- measuring */

#define KDR_BENCH_ONLY_LIMIT 16u

typedef struct kdr_bench_options {
    uint32_t rounds;
    uint32_t frames; /* of what moves, each built and traced anew; 0: the mesh as it is, and all kinds of rays */
    const char *only[KDR_BENCH_ONLY_LIMIT]; /* beginnings of tracers' names */
    uint32_t only_count;                    /* 0: every tracer */
    kdr_build_def build;
} kdr_bench_options;

/* True if the name of some tracer begins so. */
bool kdr_bench_known(const char *beginning);

/* True if some tracer is asked for whose name begins so. */
bool kdr_bench_wanted(const kdr_bench_options *options, const char *beginning);

typedef struct kdr_bench_row {
    char scene[KDR_BENCH_SCENE_SIZE];
    char tracer[KDR_BENCH_NAME_SIZE];
    uint32_t threads;
    uint64_t triangles;
    double build_ms;               /* again, in memory that is warm */
    double build_cold_ms;          /* the first */
    double speed[KDR_BENCH_KINDS]; /* million rays a second; 0: there were no rays of this kind */
    double image_ms;               /* build, primary and shadow rays; of a frame in the mean */
    double bytes_per_triangle;     /* 0: there are no triangles */
    uint64_t hits[KDR_BENCH_KINDS];
} kdr_bench_row;

/* The tracers that there are, and more: three engines of Embree, and kdray. */
#define KDR_BENCH_ROW_LIMIT (4 * KDR_BENCH_ENGINE_TRACERS)

/* Measures every tracer that is asked for and there; *row_count gets the number of rows. False after a sentence to the
 * logger. with_embree false: leaves Embree alone. */
bool kdr_bench_measure(kdr_bench_scene *scene, const kdr_bench_options *options, bool with_embree,
                       const kdr_logger *logger, kdr_progress *progress, kdr_bench_row rows[KDR_BENCH_ROW_LIMIT],
                       uint32_t *row_count);

/* ---- reports */

/* Median of values, which are put in order; of an even number the mean of the middle two. count at least 1. */
double kdr_bench_median(double *values, uint32_t count);

/* What a report says of the run as a whole. */
typedef struct kdr_bench_run_info {
    uint32_t width, height, rounds, threads;
    uint32_t frames; /* 0: meshes stood still */
    kdr_isa isa;
    kdr_build_def build;
    const char *embree; /* its version; NULL: none */
} kdr_bench_run_info;

/* Two tables for people: the figures of one scene's rows, and how many times as fast they are as embree/medium/packet,
 * or as the first row where that is missing. Then the counts of hits in which tracers differ from the first row. */
void kdr_bench_print(FILE *out, const kdr_bench_row *rows, uint32_t row_count);

/* Comment lines that say what was run and on what, a line of names, a line a row. */
void kdr_bench_write_csv(FILE *out, const kdr_bench_run_info *info, const kdr_bench_row *rows, size_t row_count);

/* A list of objects, one a row, each with the plan by which its tree was built; null for Embree's. */
void kdr_bench_write_json(FILE *out, const kdr_bench_run_info *info, const kdr_bench_row *rows, size_t row_count);

#endif
