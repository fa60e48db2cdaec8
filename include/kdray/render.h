/* kdray-render: mesh files to pictures, on top of kdray's ray queries.
 *
 *   mesh     arrays read from a file or made by a built-in scene
 *   picture  camera, lights and sampling: what to render
 *   image    linear RGB pixels, read from and written to PNG
 *
 * Errors are returned as kdr_status; the sentence for the user goes to the log given. Objects made here are released by
 * the function named beside them; NULL may be released. Unless said otherwise a function may be called from any thread,
 * on objects that no other thread is changing.
 */
#ifndef KDRAY_RENDER_H
#define KDRAY_RENDER_H

#include <kdray/kdray.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A function and its pointer for sentences to the user; log NULL: silence. */
typedef struct kdr_logger {
    kdr_log_fn *log;
    void *user;
} kdr_logger;

/* ------------------------------------------------------------------------------------------------------ mesh */

typedef struct kdr_mesh_material {
    char *name;       /* UTF-8 as found in the file; never NULL */
    float diffuse[3]; /* linear RGB in 0..1; 0.8 where the file says nothing */
} kdr_mesh_material;

/* Triangles as arrays, nothing more. Every index is below its count; every position and normal is finite. */
typedef struct kdr_mesh {
    float *positions; /* 3 floats a vertex */
    float *normals;   /* 3 floats a vertex, unit length; NULL: shade by the triangles' own normals */
    size_t vertex_count;
    uint32_t *indices;            /* 3 a triangle */
    uint32_t *triangle_materials; /* one a triangle; NULL: no materials */
    size_t triangle_count;
    kdr_mesh_material *materials;
    size_t material_count;
    size_t dropped_count;        /* triangles left out: a vertex was NaN or infinite */
    size_t dropped_vertex_count; /* such vertices */
    char format[32];             /* "PLY binary little endian", "OBJ", "built-in city", ... */
} kdr_mesh;

/* Reads a mesh file; the format is found by content first, then by name. PLY, OBJ, STL (each also gzipped) are read by
 * kdray itself, glTF/GLB and all others by assimp where the library was built with it.
 * A name "builtin:NAME[:TRIANGLES[:TIME]]" makes a built-in scene instead (see kdr_mesh_make).
 * On failure *out is NULL and the log gets one sentence: file, line or byte offset, and what was expected.
 * Triangles with a vertex that is not finite are dropped and counted, with a warning.
 * Errors: IO, INVALID_DATA, UNSUPPORTED, OUT_OF_MEMORY, LIMIT, INVALID_ARGUMENT. Release: kdr_mesh_destroy. */
KDR_API kdr_status kdr_mesh_read(const char *path, const kdr_logger *logger, kdr_mesh **out);

/* Reads a glTF or GLB file as it is `seconds` into its first animation: nodes, skins and morph targets in their pose. A
 * time outside of the animation is its nearest end; a file without one always shows the same. Errors as kdr_mesh_read;
 * UNSUPPORTED also for a file of another kind, INVALID_ARGUMENT also for a time that is not finite. */
KDR_API kdr_status kdr_mesh_read_at(const char *path, double seconds, const kdr_logger *logger, kdr_mesh **out);

/* Something that moves: a mesh for every moment. */
typedef struct kdr_animation kdr_animation;

/* Opens what `path` names:
 *   a glTF or GLB file: its first animation, as kdr_mesh_read_at shows it;
 *   an MD2 file, where the library was built with assimp: its keyframes, ten a second, and straight lines between them;
 *   a name with # in its last part, "walk_####.ply": the files that have a number there, of at least as many digits,
 *     with zeros before it if need be, each shown for 1 / rate seconds, the first from time 0 on;
 *   "builtin:NAME[:TRIANGLES[:TIME]]": a built-in scene, which moves on from TIME for ever, or stands still;
 *   any other mesh file: the same at all times.
 * rate: files a second, above 0; only a sequence reads it. path is copied; files are read again by later samples.
 * On failure *out is NULL and the log gets one sentence.
 * Errors: as kdr_mesh_read; IO also for a sequence without files, INVALID_DATA for one with a number left out,
 * INVALID_ARGUMENT (NULL, rate). Release: kdr_animation_destroy. */
KDR_API kdr_status kdr_animation_open(const char *path, double rate, const kdr_logger *logger, kdr_animation **out);

/* Seconds until it ends: 0 if it stands still, infinity if it goes on for ever. */
KDR_API double kdr_animation_duration(const kdr_animation *animation);

/* Makes *mesh what it is at `seconds`; a time before the beginning or behind the end is that end. *mesh is NULL, or the
 * last sample of this animation, whose arrays are used again or replaced: pointers into them are then invalid. On
 * failure it is still there, its contents those of before or, where a file was found broken on the way, undefined.
 * Errors: as kdr_mesh_read; INVALID_ARGUMENT (NULL, a time that is not finite). One thread at a time.
 * Release of the mesh: kdr_mesh_destroy, at any time. */
KDR_API kdr_status kdr_animation_sample(kdr_animation *animation, double seconds, const kdr_logger *logger,
                                        kdr_mesh **mesh);

/* NULL is allowed. */
KDR_API void kdr_animation_destroy(kdr_animation *animation);

/* Makes the built-in scene `name` with about `triangle_count` triangles (0: its default size; 100 to 10 million) at
 * `time` in seconds (still scenes ignore it). The same arguments make the same mesh everywhere.
 * Errors: INVALID_ARGUMENT (no such scene, size), OUT_OF_MEMORY. Release: kdr_mesh_destroy. */
KDR_API kdr_status kdr_mesh_make(const char *name, size_t triangle_count, double time, const kdr_logger *logger,
                                 kdr_mesh **out);

/* Name and one-line description of built-in scene i, or NULL past the last; static storage. */
KDR_API const char *kdr_mesh_builtin_name(size_t i);
KDR_API const char *kdr_mesh_builtin_text(size_t i);

/* True if built-in scene i differs from time to time; false past the last. */
KDR_API bool kdr_mesh_builtin_moves(size_t i);

KDR_API void kdr_mesh_destroy(kdr_mesh *mesh);

/* {min x, y, z, max x, y, z} of the vertices that triangles use; min > max if there are none. */
KDR_API void kdr_mesh_bounds(const kdr_mesh *mesh, float bounds[6]);

/* Bytes that all meshes, images and the rest of kdray-render hold now. */
KDR_API size_t kdr_render_bytes(void);

/* ----------------------------------------------------------------------------------------------------- image */

/* Linear RGB, 3 floats a pixel, rows from the top, no padding. */
typedef struct kdr_image {
    uint32_t width, height;
    float *rgb;
} kdr_image;

/* Black. Errors: INVALID_ARGUMENT (0 or over 65,536 a side), OUT_OF_MEMORY. Release: kdr_image_destroy. */
KDR_API kdr_status kdr_image_create(uint32_t width, uint32_t height, kdr_image **out);
KDR_API void kdr_image_destroy(kdr_image *image);

/* 8-bit sRGB PNG. The file appears whole under its name or not at all. Errors: IO, OUT_OF_MEMORY. */
KDR_API kdr_status kdr_image_write_png(const kdr_image *image, const char *path, const kdr_logger *logger);

/* The 8-bit sRGB values that a PNG file of it has: 3 bytes a pixel, rows from the top, 3 * width * height in all.
 * Nothing may be NULL. */
KDR_API void kdr_image_bytes(const kdr_image *image, uint8_t *bytes);

/* Any PNG, converted to linear RGB; alpha is dropped. Errors: IO, INVALID_DATA, OUT_OF_MEMORY, LIMIT. */
KDR_API kdr_status kdr_image_read_png(const char *path, const kdr_logger *logger, kdr_image **out);

/* Root mean square difference of the 8-bit sRGB values, 0 to 255. Errors: INVALID_ARGUMENT (sizes differ). */
KDR_API kdr_status kdr_image_compare(const kdr_image *a, const kdr_image *b, double *difference);

/* --------------------------------------------------------------------------------------------------- picture */

#define KDR_MAX_LIGHTS 16

typedef struct kdr_camera {
    float eye[3], target[3], up[3];
    float fov; /* vertical, degrees, in (0, 180) */
} kdr_camera;

/* Three quarters from above: eye = centre + 0.95 diagonal x normalize(0.35, 0.25, 0.9), up +y, 45 degrees. */
KDR_API kdr_camera kdr_camera_for_bounds(const float bounds[6]);

/* The light that goes with it: centre + diagonal x (0.8, 1.5, 0.8). */
KDR_API void kdr_light_for_bounds(const float bounds[6], float light[3]);

/* One line of 13 numbers: eye, target, up, fov, light. Errors: IO, INVALID_DATA. */
KDR_API kdr_status kdr_camera_read(const char *path, const kdr_logger *logger, kdr_camera *camera, float light[3]);

typedef struct kdr_picture_def {
    size_t size;            /* set by kdr_default_picture_def */
    uint32_t width, height; /* default 1024 x 1024 */
    kdr_camera camera;
    float lights[KDR_MAX_LIGHTS][3]; /* white point lights that share one unit of brightness; no falloff */
    uint32_t light_count;            /* 1 to 16 */
    uint32_t samples;                /* a pixel, 1 to 65,536; 1: through the pixel's centre, more: stratified */
    uint64_t seed;                   /* of the samples' positions */
    bool box;                        /* the thesis's textured box around the model */
    const char *texture;             /* PNG on the box; NULL: a checkerboard */
    float background[3];             /* linear RGB */
    kdr_progress_fn *progress;       /* tiles; NULL: none */
    void *progress_user;
} kdr_picture_def;

KDR_API kdr_picture_def kdr_default_picture_def(void);

typedef struct kdr_picture_stats {
    double build_seconds; /* commit of the scene */
    double trace_seconds; /* rays and shading, all tiles */
    uint64_t primary_rays, hits, shadow_rays, occluded;
    kdr_tree_stats tree;
} kdr_picture_stats;

/* Builds the scene of `mesh` (and box) on `device` and renders it: one primary ray a sample and one shadow ray a light
 * for each hit, Phong shading. stats may be NULL. build NULL means the defaults.
 * The image depends on mesh and def alone, not on the number of threads.
 * Errors: INVALID_ARGUMENT, OUT_OF_MEMORY, CANCELLED, and those of reading the texture. Release: kdr_image_destroy. */
KDR_API kdr_status kdr_picture_render(kdr_device *device, const kdr_mesh *mesh, const kdr_picture_def *def,
                                      const kdr_build_def *build, const kdr_logger *logger, kdr_image **image,
                                      kdr_picture_stats *stats);

/* A scene and room for pixels that are kept from picture to picture, for what moves: each picture builds the tree anew,
 * in the memory of the last one. */
typedef struct kdr_renderer kdr_renderer;

/* device must outlive it. *out is NULL on failure. Errors: INVALID_ARGUMENT (NULL), OUT_OF_MEMORY. Release:
 * kdr_renderer_destroy. */
KDR_API kdr_status kdr_renderer_create(kdr_device *device, kdr_renderer **out);

/* As kdr_picture_render, to the bit, for one mesh after the other, alike or not. *image is NULL or an image of before,
 * which is written over if it has the size and replaced if not; on failure it is left to the caller, contents
 * undefined. mesh must not change while this runs; it is not needed afterwards. The tree is not counted: stats->tree
 * becomes all zero. Errors as kdr_picture_render. One thread at a time. */
KDR_API kdr_status kdr_renderer_render(kdr_renderer *renderer, const kdr_mesh *mesh, const kdr_picture_def *def,
                                       const kdr_build_def *build, const kdr_logger *logger, kdr_image **image,
                                       kdr_picture_stats *stats);

/* NULL is allowed. */
KDR_API void kdr_renderer_destroy(kdr_renderer *renderer);

#ifdef __cplusplus
}
#endif

#endif
