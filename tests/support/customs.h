/* Custom primitives of several kinds, with their callbacks, and scenes of them and triangles that are asked by brute
 * force: every primitive, the triangles by the oracle. */
#ifndef KDR_TESTS_SUPPORT_CUSTOMS_H
#define KDR_TESTS_SUPPORT_CUSTOMS_H

#include "support/oracle_tree.h"
#include "support/random.h"

#include <stdatomic.h>

typedef enum custom_kind {
    CUSTOM_SPHERE, /* size[0]: radius */
    CUSTOM_BOX,    /* size: half extents */
    CUSTOM_SQUARE, /* flat on one axis, where its size is 0; its box is flat */
    CUSTOM_POINT,  /* hit only by rays that go through it exactly; its box is a point */
} custom_kind;

typedef struct custom_shape {
    custom_kind kind;
    float centre[3], size[3];
} custom_shape;

/* One geometry's primitives: what its callbacks get as their user pointer. */
typedef struct custom_shapes {
    custom_shape *shapes;
    uint32_t count;
    _Atomic uint64_t bounds_calls, intersect_calls, occluded_calls;
    _Atomic uint64_t strays; /* calls for a ray that surely passes the box by */
} custom_shapes;

/* A def of these shapes; occluded is left NULL unless asked for. */
kdr_custom_def custom_shapes_def(custom_shapes *shapes, bool with_occluded);

/* `count` shapes of all kinds but points, strewn over [-1, 1], with some repeated; free shapes->shapes. */
void custom_shapes_strew(test_random *random, custom_shapes *shapes, uint32_t count, float size);

/* The geometries of a scene: those with customs[i].size 0 are of triangles. */
typedef struct custom_scene {
    uint32_t count;
    const kdr_triangles_def *triangles;
    const kdr_custom_def *customs;
    oracle_scene oracle;
    oracle_tree tree; /* of the triangles */
} custom_scene;

void custom_scene_open(custom_scene *scene, const kdr_triangles_def *triangles, const kdr_custom_def *customs,
                       uint32_t count);
void custom_scene_close(custom_scene *scene);

/* Adds all geometries and commits. Fails the running test if anything does. */
kdr_scene *custom_scene_commit(const custom_scene *scene, kdr_device *device, const kdr_build_def *def);

/* By brute force. t, u, v and normal of a triangle are not filled in. */
kdr_ray_hit custom_scene_closest(const custom_scene *scene, const kdr_ray *ray);

/* Asks the committed scene by every query and returns how many answers differ, printing the first few. */
size_t custom_scene_differences(const custom_scene *scene, const kdr_scene *committed, const kdr_ray *rays,
                                const kdr_ray_hit *expected, size_t count, const char *label);

/* A plan with its words. */
typedef struct custom_plan {
    kdr_build_def def;
    char text[96];
} custom_plan;

/* Plans with every word that the library lists: each split by itself, with leaves as small as can be, and with each
 * word of the other keys that goes with it. Returns how many there are. */
#define CUSTOM_PLANS 192
size_t custom_plans(custom_plan plans[CUSTOM_PLANS]);

#endif
