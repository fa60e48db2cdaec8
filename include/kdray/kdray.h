/* kdray: ray queries against triangles and custom primitives, through a kd-tree that is built again whenever they move.
 *
 * One C header to include, no dependency but libc, libm and threads.
 *
 *   device   workers, memory and log; everything else is made from one
 *   scene    triangles and custom primitives, and the tree that a commit makes of them
 *   query    rays asked of a committed scene
 *
 * Ownership. A handle has one owner, who destroys it. A scene must be destroyed before its device. Arrays given in
 * def structs are borrowed: the caller keeps them alive and unchanged while a commit runs. Queries read copies only.
 *
 * Errors. Everything that can fail returns a kdr_status and, on failure, tells the device's log a sentence. Nothing
 * is half done: a call that fails leaves the scene as it was.
 *
 * Threads. Queries may run on any number of threads at once, on the same scene. A call that changes an object
 * (add, touch, commit, destroy) needs that object for itself alone; a commit needs its device for itself as well. Only
 * a scene that is doubly buffered may be asked while it is changed and committed.
 *
 * Floating point. Coordinates and distances are binary32. Hit decisions are those of exact arithmetic on the given
 * numbers (see kdr_intersect1). The default floating-point environment is assumed: round to nearest, no flush to zero.
 */
#ifndef KDRAY_KDRAY_H
#define KDRAY_KDRAY_H

#include "kdray/cost.h"
#include "kdray/counts.h"
#include "kdray/plan.h"
#include "kdray/rays.h"
#include "kdray/tree.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define KDR_API __attribute__((visibility("default")))
#else
#define KDR_API
#endif

#define KDR_VERSION_MAJOR 0
#define KDR_VERSION_MINOR 1
#define KDR_VERSION_PATCH 0

/* ---------------------------------------------------------------------------------------------------- status */

/* Every status, with the sentence that kdr_status_text gives for it. */
#define KDR_STATUS_LIST(X)                                                                                             \
    X(KDR_OK, "no error")                                                                                              \
    X(KDR_ERROR_OUT_OF_MEMORY, "out of memory")                                                                        \
    X(KDR_ERROR_INVALID_ARGUMENT, "invalid argument")                                                                  \
    X(KDR_ERROR_INVALID_DATA, "invalid data")                                                                          \
    X(KDR_ERROR_IO, "input or output failed")                                                                          \
    X(KDR_ERROR_UNSUPPORTED, "not supported")                                                                          \
    X(KDR_ERROR_LIMIT, "a limit of the library was exceeded")                                                          \
    X(KDR_ERROR_CANCELLED, "cancelled")

typedef enum kdr_status {
#define KDR_STATUS_NAME(name, text) name,
    KDR_STATUS_LIST(KDR_STATUS_NAME)
#undef KDR_STATUS_NAME
} kdr_status;

/* A short lower-case phrase for a status; never NULL; static storage. Any value is accepted. Thread safe. */
KDR_API const char *kdr_status_text(kdr_status status);

/* "major.minor.patch" of the library that is linked; static storage. Thread safe. */
KDR_API const char *kdr_version(void);

/* ---------------------------------------------------------------------------------------------------- device */

typedef struct kdr_device kdr_device;
typedef struct kdr_scene kdr_scene;

/* Instruction sets, narrowest first. A device uses the widest one that machine, KDR_ISA and isa_limit all allow. */
typedef enum kdr_isa {
    KDR_ISA_SCALAR, /* plain C, one lane: the reference */
    KDR_ISA_SSE42,  /* 4 lanes */
    KDR_ISA_AVX2,   /* 8 lanes, with FMA present but never used to contract */
    KDR_ISA_AVX512, /* 16 lanes: F, DQ, VL */
    KDR_ISA_NEON,   /* 4 lanes, aarch64 */
} kdr_isa;

/* Lower-case name ("scalar", "sse42", "avx2", "avx512", "neon"); "unknown" for other values. Thread safe. */
KDR_API const char *kdr_isa_name(kdr_isa isa);

/* One unit of concurrent work; index is in [0, count) of the start that it belongs to. */
typedef void kdr_task_fn(void *context, uint32_t index);

/* How a host lends its threads. Two functions and a pointer.
 *
 *   start  begins `count` calls task(context, 0) ... task(context, count - 1), in any order, at best all at once.
 *          Returns a handle for wait, or NULL when the calls have already been made.
 *   wait   returns when all calls of that handle have returned. The waiting thread may make calls itself.
 *
 * Calls never wait for one another, so a host that runs them one after the other is correct, only slow.
 * Both are called on the thread that called kdray, and never from inside a task. */
typedef struct kdr_task_backend {
    void *(*start)(kdr_task_fn *task, void *context, uint32_t count, void *user);
    void (*wait)(void *handle, void *user);
    void *user; /* passed through; owned by the host */
} kdr_task_backend;

/* A host's memory. Both NULL: kdray's own (mmap for large sizes, aligned_alloc otherwise).
 *
 *   allocate  `size` bytes (never 0) aligned to `alignment` (a power of two, at most 4096); NULL when there is none
 *   release   gives back what allocate returned, with the same size
 *
 * Called from any worker, several at once. Large requests are upper bounds: pages that stay untouched should cost
 * nothing, as with malloc on Linux. */
typedef struct kdr_allocator {
    void *(*allocate)(size_t size, size_t alignment, void *user);
    void (*release)(void *memory, size_t size, void *user);
    void *user;
} kdr_allocator;

typedef enum kdr_log_level { KDR_LOG_ERROR, KDR_LOG_WARNING, KDR_LOG_INFO } kdr_log_level;

/* One sentence, no newline, valid during the call only. Called on the thread that called kdray. */
typedef void kdr_log_fn(kdr_log_level level, const char *message, void *user);

typedef struct kdr_device_def {
    size_t size;             /* set by kdr_default_device_def; proves initialisation and version */
    uint32_t worker_count;   /* threads that build; 0: as many as this thread may run on; at most 256 */
    kdr_isa isa_limit;       /* use nothing wider; default: no limit beyond the KDR_ISA environment variable */
    kdr_task_backend tasks;  /* default (start NULL): a pool of kdray's own threads */
    kdr_allocator allocator; /* default (allocate NULL): kdray's own */
    kdr_log_fn *log;         /* NULL: silence */
    void *log_user;          /* passed to log */
} kdr_device_def;

KDR_API kdr_device_def kdr_default_device_def(void);

/* Makes a device. def NULL means the defaults. *out is NULL on failure.
 * Errors: INVALID_ARGUMENT (def not initialised, one callback of a pair missing, out NULL), OUT_OF_MEMORY,
 * UNSUPPORTED (KDR_ISA names a set that this machine lacks). Thread safe. */
KDR_API kdr_status kdr_device_create(const kdr_device_def *def, kdr_device **out);

/* Destroys a device whose scenes are all destroyed. NULL is allowed. */
KDR_API void kdr_device_destroy(kdr_device *device);

KDR_API kdr_isa kdr_device_isa(const kdr_device *device);
KDR_API uint32_t kdr_device_worker_count(const kdr_device *device);

/* Bytes that the device and its scenes hold now, and the most they ever held. Thread safe. */
KDR_API size_t kdr_device_bytes(const kdr_device *device);
KDR_API size_t kdr_device_peak_bytes(const kdr_device *device);

/* Gives back the working memory that is kept from one commit to the next. */
KDR_API void kdr_device_trim(kdr_device *device);

/* Runs task(context, i) for i in [0, count) on the device's workers and returns when all are done: the device's
 * threads lent back to the caller, for tracing or shading. count may exceed the worker count. Never call it from
 * inside a task. */
KDR_API void kdr_device_run(kdr_device *device, kdr_task_fn *task, void *context, uint32_t count);

/* ----------------------------------------------------------------------------------------------------- scene */

#define KDR_INVALID_ID UINT32_MAX

/* Indexed triangles. Arrays are borrowed until the scene is destroyed, and read only while a commit runs. */
typedef struct kdr_triangles_def {
    size_t size;             /* set by kdr_default_triangles_def */
    const float *vertices;   /* x, y, z of vertex i at (const char *)vertices + i * vertex_stride; NULL only if none */
    size_t vertex_stride;    /* bytes, a multiple of 4, at least 12; default 12 */
    size_t vertex_count;     /* at most 2^32 - 1 */
    const uint32_t *indices; /* three vertex numbers a triangle; NULL: triangle i has vertices 3i, 3i + 1, 3i + 2 */
    size_t index_stride;     /* bytes from one triangle to the next, a multiple of 4, at least 12; default 12 */
    size_t triangle_count;   /* may be 0 */
    bool is_static;          /* in a tree of its own with all others that are; default false: see kdr_scene_commit */
} kdr_triangles_def;

KDR_API kdr_triangles_def kdr_default_triangles_def(void);

/* Makes an empty scene. It answers "miss" until its first commit. Errors: INVALID_ARGUMENT, OUT_OF_MEMORY. */
KDR_API kdr_status kdr_scene_create(kdr_device *device, kdr_scene **out);

typedef struct kdr_scene_def {
    size_t size;                /* set by kdr_default_scene_def */
    bool double_buffered;       /* may be asked while it is committed: see kdr_scene_commit; default false */
    kdr_build_def static_build; /* plan of the tree of static triangles; default KDR_QUALITY_BEST */
} kdr_scene_def;

KDR_API kdr_scene_def kdr_default_scene_def(void);

/* The same with more to choose. def NULL means the defaults. Errors: also INVALID_ARGUMENT (def, its static_build). */
KDR_API kdr_status kdr_scene_create_with(kdr_device *device, const kdr_scene_def *def, kdr_scene **out);

/* Destroys a scene. NULL is allowed. No query may be running. */
KDR_API void kdr_scene_destroy(kdr_scene *scene);

/* Adds triangles; they take part from the next commit on. *geometry (may be NULL) gets 0, 1, 2 ... in order.
 * Errors: INVALID_ARGUMENT (def, strides, missing arrays), LIMIT (2^32 - 1 geometries), OUT_OF_MEMORY.
 * Vertex numbers are checked by the commit, not here. */
KDR_API kdr_status kdr_scene_add_triangles(kdr_scene *scene, const kdr_triangles_def *def, uint32_t *geometry);

/* Gives a geometry of triangles new arrays or counts, in force from the next commit on.
 * Errors: INVALID_ARGUMENT (also: another kind of geometry). */
KDR_API kdr_status kdr_scene_set_triangles(kdr_scene *scene, uint32_t geometry, const kdr_triangles_def *def);

/* The hit of a ray and a custom primitive, as its callback says. All fields are 0 before the call. */
typedef struct kdr_custom_hit {
    float t;                            /* distance, in units of the direction's length */
    float normal_x, normal_y, normal_z; /* these and u, v go into kdr_hit as they are */
    float u, v;
} kdr_custom_hit;

/* Primitives of the caller's own: a box each, and functions that say where a ray hits them.
 *
 *   bounds     fills in the box of a primitive: lo <= hi on every axis, all finite; it may be flat or a point. A box
 *              with a number that is NaN or infinite leaves its primitive out. Called once a primitive and commit, by
 *              several workers at once.
 *   intersect  says whether the ray hits the primitive, and where: the hit counts if ray->tmin < hit->t <= ray->tmax.
 *              ray->tmax is the distance of the closest hit so far, so the callback reports its closest hit within
 *              that interval, or false.
 *   occluded   says whether the primitive has any hit in that interval; NULL: intersect is asked.
 *
 * A hit must lie in the box: origin + t direction, with t off by no more than half a float step. A callback that rounds
 * gives boxes that are larger by as much. Then answers do not depend on how the tree was built.
 * intersect and occluded are called by queries, on the threads that ask, several at once, and more than once a ray and
 * primitive if the primitive reaches over planes of the tree. They may query other scenes; they must change nothing of
 * kdray's. */
typedef struct kdr_custom_def {
    size_t size;              /* set by kdr_default_custom_def */
    uint32_t primitive_count; /* may be 0 */
    void *user;               /* passed through; must be valid while the scene is committed or queried */
    void (*bounds)(uint32_t primitive, float lo[3], float hi[3], void *user);
    bool (*intersect)(const kdr_ray *ray, uint32_t primitive, kdr_custom_hit *hit, void *user);
    bool (*occluded)(const kdr_ray *ray, uint32_t primitive, void *user);
} kdr_custom_def;

KDR_API kdr_custom_def kdr_default_custom_def(void);

/* Adds custom primitives; they take part from the next commit on. Geometries of both kinds share one numbering: see
 * kdr_scene_add_triangles. The def is copied; a hit carries the number of the geometry and of the primitive in it.
 * Errors: INVALID_ARGUMENT (def, bounds or intersect NULL), LIMIT (2^32 - 1 geometries), OUT_OF_MEMORY. */
KDR_API kdr_status kdr_scene_add_custom(kdr_scene *scene, const kdr_custom_def *def, uint32_t *geometry);

/* Gives a geometry of custom primitives another def, in force from the next commit on; until then queries call the old
 * functions with the old user pointer. Errors: INVALID_ARGUMENT (also: another kind of geometry). */
KDR_API kdr_status kdr_scene_set_custom(kdr_scene *scene, uint32_t geometry, const kdr_custom_def *def);

#define KDR_MAX_INSTANCE_DEPTH 8

/* Instances: a committed scene that stands in another one, as often as there are transforms. */
typedef struct kdr_instance_def {
    size_t size;            /* set by kdr_default_instance_def */
    const kdr_scene *scene; /* what they show: of the same device, created before the scene they are added to */
    const float
        *transforms; /* 12 numbers each, rows of 4: (x, y, z) goes to m[0] x + m[1] y + m[2] z + m[3] and so on */
    size_t transform_stride; /* bytes from one to the next, a multiple of 4, at least 48; default 48 */
    uint32_t count;          /* transforms; default 1, may be 0 */
} kdr_instance_def;

KDR_API kdr_instance_def kdr_default_instance_def(void);

/* Adds instances; they take part from the next commit on, as they are then. Geometries of all kinds share one
 * numbering: see kdr_scene_add_triangles. Transforms are borrowed as arrays of triangles are. The scene that is shown
 * must outlive this one's last commit and queries; when it is committed again, touch this geometry and commit this
 * scene before asking it. Instances may show scenes that have instances, KDR_MAX_INSTANCE_DEPTH deep at most.
 *
 * An instance answers a ray as kdr_intersect1 does in the scene that is shown, for the ray through the inverse of the
 * transform, which is worked out in doubles and rounded to floats; the distance is then that of the ray itself, and of
 * equal ones the lowest geometry of this scene wins, then the lowest instance. hit.geometry and hit.primitive are
 * numbers in the scene that holds the triangle, hit.instance that of the instance in this scene, counted from 0 through
 * all its instances in the order of geometries; the normal is that of the triangle as it stands in this scene. A ray
 * that starts some hundred times farther away than the instance is from the origin may pass its border by.
 * A transform with a number that is not finite, or of a scene without primitives, leaves its instance out; one that
 * cannot be undone is an error of the commit: INVALID_DATA. Points and radii are searched for among triangles alone.
 *
 * Errors: INVALID_ARGUMENT (def, scene, transforms missing, stride), LIMIT (2^32 - 1 geometries), OUT_OF_MEMORY. */
KDR_API kdr_status kdr_scene_add_instance(kdr_scene *scene, const kdr_instance_def *def, uint32_t *geometry);

/* Gives a geometry of instances another def, in force from the next commit on. Errors: INVALID_ARGUMENT (also: another
 * kind of geometry). */
KDR_API kdr_status kdr_scene_set_instance(kdr_scene *scene, uint32_t geometry, const kdr_instance_def *def);

/* Says that the arrays of a geometry have new contents, or the boxes of its custom primitives, or what instances show.
 * A commit of a scene in which nothing was added, set or touched, with the same build def, does nothing. Errors:
 * INVALID_ARGUMENT (no such geometry). */
KDR_API kdr_status kdr_scene_touch(kdr_scene *scene, uint32_t geometry);

#define KDR_MAX_DEPTH 60

KDR_API kdr_build_def kdr_default_build_def(void);

/* Plans made up for a purpose. */
typedef enum kdr_quality {
    KDR_QUALITY_FAST,     /* for a tree that one picture's rays go through: larger leaves, built sooner */
    KDR_QUALITY_BALANCED, /* the default: for a tree that several pictures' rays go through */
    KDR_QUALITY_BEST, /* for a tree that is built once: the sweep with triangles cut at planes, and splits taken back */
    KDR_QUALITY_LAZY, /* for few rays of a large scene: as FAST, but rays build what they reach, see lazy_limit */
} kdr_quality;

/* The plan for a purpose, to be changed as needed. A value that is no kdr_quality means the default. */
KDR_API kdr_build_def kdr_quality_build_def(kdr_quality quality);

/* A plan as text: words KEY=VALUE with spaces between them, such as "split=object leaf-limit=4". Reads it into *out; a
 * key that is left out has its default. On failure *out is left alone and `problem`, unless its size is 0, gets one
 * sentence, cut to that size, that names the word and what is allowed.
 * Errors: INVALID_ARGUMENT (unknown key, value that is not allowed, key given twice, values that do not go together,
 * text or out NULL). Thread safe. */
KDR_API kdr_status kdr_build_def_parse(const char *text, kdr_build_def *out, char *problem, size_t problem_size);

#define KDR_PLAN_TEXT_SIZE 512 /* bytes that hold every plan as text, with its end */

/* Writes a plan as text, every key with its value, defaults resolved; kdr_build_def_parse reads it back to a def that
 * builds the same tree. text: `size` bytes, the caller's; left alone on failure.
 * Errors: INVALID_ARGUMENT (def not initialised or out of range, text NULL), LIMIT (size too small). Thread safe. */
KDR_API kdr_status kdr_build_def_print(const kdr_build_def *def, char *text, size_t size);

/* Key number i of a plan as text, counted from 0, and its values, defaults and meaning in one line; static storage.
 * NULL past the last one. Thread safe. */
KDR_API const char *kdr_build_def_key_name(size_t i);
KDR_API const char *kdr_build_def_key_text(size_t i);

/* Told how far a long call is: `finished` of `total`, in units of its own, never less than before, and all at its end.
 * False cancels the call. Called on the thread that made the call, or on a worker, never on two at once. It must not
 * change anything of kdray's. */
typedef bool kdr_progress_fn(uint64_t finished, uint64_t total, void *user);

/* Whom commits of the scene tell; fn NULL: nobody, which is the default. A commit that is cancelled ends as soon as the
 * nodes have been divided that workers are at. Errors: INVALID_ARGUMENT (scene NULL). */
KDR_API kdr_status kdr_scene_set_progress(kdr_scene *scene, kdr_progress_fn *fn, void *user);

/* Builds the tree over all geometries; def NULL means the defaults. Blocks until done; the device's workers help.
 * Custom primitives have a tree of their own, built by the same def; rays are asked of both.
 * So have static triangles, built by the scene's static_build. A commit leaves that tree as it is, and does not read
 * its arrays, unless static triangles were added, set or touched; the tree of the others likewise.
 *
 * A scene that is doubly buffered may be asked by other threads throughout: a query sees the trees of the last commit
 * that was done when the query began, all of them, to its end. A commit waits for queries that began before the last
 * one ended, so a query's callback must not wait for a commit. The trees of the last two commits are held. Other scenes
 * that show its instances must not be asked meanwhile.
 * Triangles with a vertex that is not finite and triangles of exactly zero area, which no ray can hit, are left out and
 * counted in the statistics, and so are custom primitives whose box is not finite.
 * On failure the old tree stays in force. The tree depends on the primitives and the def alone, never on the number of
 * workers or the instruction set. Errors: INVALID_ARGUMENT (def), INVALID_DATA (a vertex number out of range, a finite
 * box with lo > hi), LIMIT (2^30 triangles of a tree, or custom primitives), OUT_OF_MEMORY, CANCELLED. */
KDR_API kdr_status kdr_scene_commit(kdr_scene *scene, const kdr_build_def *def);

/* Smallest box around the committed triangles and boxes of custom primitives, {min x, y, z, max x, y, z}; min > max on
 * every axis if there is none. */
KDR_API void kdr_scene_bounds(const kdr_scene *scene, float bounds[6]);

/* Walks the committed trees and counts. Errors: INVALID_ARGUMENT. Thread safe with queries. */
KDR_API kdr_status kdr_scene_stats(const kdr_scene *scene, kdr_tree_stats *out);

/* Shows the cells of the committed tree to a visitor, on the calling thread: every cell before those inside it, what
 * lies below a plane before what lies above it; then those of the custom primitives' tree, if there are any. A tree
 * without triangles is one empty leaf with min > max. The visitor may ask queries, but not change the scene. Never
 * allocates. Errors: INVALID_ARGUMENT (scene or visit NULL); that the visitor stops is none. Thread safe with queries.
 */
KDR_API kdr_status kdr_scene_cells(const kdr_scene *scene, kdr_cell_fn *visit, void *user);

/* A number that is equal for equal trees (nodes, split planes and the primitives of each leaf), however they lie in
 * memory and whoever built them. 0 before the first commit. */
KDR_API uint64_t kdr_scene_hash(const kdr_scene *scene);

/* Walks the committed tree and checks every invariant: planes inside their cells, every primitive in every leaf whose
 * cell its box meets, depth and counts within limits. INVALID_DATA with a log message when one is broken. */
KDR_API kdr_status kdr_scene_verify(const kdr_scene *scene);

/* What the queries of the calling thread cost since it asked last, in a library that was built to count (see
 * docs/trace.md); custom primitives, points and radii apart. UNSUPPORTED, and *out is all zero, in any other;
 * INVALID_ARGUMENT if out is NULL. */
KDR_API kdr_status kdr_trace_counts_take(kdr_trace_counts *out);

/* --------------------------------------------------------------------------------------------------- queries */

/* Finds the closest hit. If there is one, ray.tmax becomes its distance and hit is filled in; if not, ray is left
 * alone and hit.geometry becomes KDR_INVALID_ID.
 *
 * What counts as a hit, in exact arithmetic on the floats given:
 *   a ray meets a triangle if the three edge functions of the triangle's projection along the ray have no two
 *   opposite signs (a zero is inside) and are not all zero (a triangle seen edge-on, or without area, is never hit);
 *   its distance is the exact one, rounded to the nearest float; it must be greater than tmin and at most tmax;
 *   of hits at equal (rounded) distance, the lowest geometry wins, then the lowest primitive.
 * A custom primitive is hit where its callback says, under the same conditions on the distance and with the same
 * choice among equal ones.
 * Both sides of a triangle are hit. A closed mesh has no cracks. A ray with a component that is NaN or an infinite
 * origin or direction, with zero direction, or with tmin >= tmax, misses.
 *
 * scene must not be NULL. Never allocates, locks or fails. Thread safe. */
KDR_API void kdr_intersect1(const kdr_scene *scene, kdr_ray_hit *ray_hit);

/* True if there is any hit as defined above. */
KDR_API bool kdr_occluded1(const kdr_scene *scene, const kdr_ray *ray);

/* Counts what lies on a ray's way through the committed kd-trees, up to its closest hit: what a traversal front to back
 * visits (see docs/trace.md), whatever the plan names. A ray that is not valid or passes every tree by costs nothing;
 * an instance is one primitive. Takes about twice as long as kdr_intersect1. Nothing may be NULL. Never allocates,
 * locks or fails. Thread safe. */
KDR_API void kdr_cost1(const kdr_scene *scene, const kdr_ray *ray, kdr_ray_cost *cost);

/* The same for packets: each active ray is answered as by kdr_intersect1, to the bit, and what belongs to the others is
 * not changed, whatever it is. valid: one number a ray, 0 where it is not active, any other (Embree has -1) where it
 * is; NULL: all are active. Fastest for rays that start and point alike, right for any. Every width works on every
 * machine, with up to 64 KiB of the calling thread's stack. scene and ray_hits must not be NULL. Never allocates, locks
 * or fails. Thread safe. */
KDR_API void kdr_intersect4(const kdr_scene *scene, const int32_t *valid, kdr_ray_hit4 *ray_hits);
KDR_API void kdr_intersect8(const kdr_scene *scene, const int32_t *valid, kdr_ray_hit8 *ray_hits);
KDR_API void kdr_intersect16(const kdr_scene *scene, const int32_t *valid, kdr_ray_hit16 *ray_hits);

/* tmax of active rays that hit anything becomes -infinity, as with Embree; nothing else is changed. */
KDR_API void kdr_occluded4(const kdr_scene *scene, const int32_t *valid, kdr_ray4 *rays);
KDR_API void kdr_occluded8(const kdr_scene *scene, const int32_t *valid, kdr_ray8 *rays);
KDR_API void kdr_occluded16(const kdr_scene *scene, const int32_t *valid, kdr_ray16 *rays);

typedef enum kdr_coherence { KDR_COHERENCE_UNKNOWN, KDR_COHERENCE_COHERENT, KDR_COHERENCE_INCOHERENT } kdr_coherence;

/* What the caller knows about the rays of one call. It changes speed only, never an answer. */
typedef struct kdr_trace_def {
    size_t size;             /* set by kdr_default_trace_def */
    kdr_coherence coherence; /* default: unknown */
} kdr_trace_def;

KDR_API kdr_trace_def kdr_default_trace_def(void);

/* The same for `count` rays, each answered as by kdr_intersect1 or kdr_occluded1. def NULL means the defaults.
 * occluded[i] becomes 1 or 0. Runs on the calling thread, with up to 64 KiB of its stack, and 16 KiB more for each
 * level of instances: split the rays over threads with kdr_device_run. */
KDR_API void kdr_intersect_n(const kdr_scene *scene, const kdr_trace_def *def, kdr_ray_hit *ray_hits, size_t count);
KDR_API void kdr_occluded_n(const kdr_scene *scene, const kdr_trace_def *def, const kdr_ray *rays, uint8_t *occluded,
                            size_t count);

/* A point to search about. Field order is that of Embree's RTCPointQuery. */
typedef struct kdr_point_query {
    float x, y, z; /* finite, else nothing is found */
    float time;    /* not read */
    float radius;  /* largest distance, inclusive; infinity is allowed; below 0 or NaN nothing is found */
} kdr_point_query;

/* The closest point of a primitive. */
typedef struct kdr_point_hit {
    float x, y, z;
    float distance;     /* from the query's point */
    float u, v;         /* the point = (1 - u - v) a + u b + v c of triangle a, b, c */
    uint32_t primitive; /* number of the triangle within its geometry */
    uint32_t geometry;
    uint32_t instance; /* KDR_INVALID_ID */
} kdr_point_hit;

/* Finds the point of the committed triangles that is closest to the query's, no farther than its radius. False, and
 * *hit left alone, if there is none.
 *
 * Distances are compared in double, each from the query's point to the closest point of a triangle as it is computed
 * there: see docs/geometry.md for how close that is. Of equal distances the lowest geometry wins, then the lowest
 * primitive. So the answer is that of asking all triangles, whatever the tree and the instruction set. Triangles that
 * the commit leaves out, those without area among them, are not found.
 *
 * scene, query and hit must not be NULL. Never allocates, locks or fails. Thread safe. */
KDR_API bool kdr_closest_point(const kdr_scene *scene, const kdr_point_query *query, kdr_point_hit *hit);

/* Told of one primitive. False ends the search. It may ask the scene itself. */
typedef bool kdr_point_fn(const kdr_point_hit *hit, void *user);

/* Calls visit(hit, user) exactly once for every triangle whose closest point, by the same distances, is no farther than
 * the query's radius; in no particular order, on the calling thread. Returns the number of calls made. None may be NULL
 * but user. Never allocates, locks or fails. Thread safe. */
KDR_API size_t kdr_primitives_within(const kdr_scene *scene, const kdr_point_query *query, kdr_point_fn *visit,
                                     void *user);

#ifdef __cplusplus
}
#endif

#endif
