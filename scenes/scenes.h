/* The table of built-in scenes. Each is a recipe: a function that draws about as many triangles as asked into a shape.
 */
#ifndef KDR_SCENES_SCENES_H
#define KDR_SCENES_SCENES_H

#include "kdray/render.h"
#include "scenes/shape.h"

#define KDR_SCENE_LEAST 100
#define KDR_SCENE_MOST 10000000

enum {
    KDR_SCENE_SMOOTH = 1, /* has normals of its own; shaded flat otherwise */
    KDR_SCENE_CLOSED = 2, /* one surface without border: every edge belongs to exactly two triangles */
    KDR_SCENE_MOVING = 4, /* differs from time to time */
};

typedef struct kdr_recipe_material {
    const char *name;
    float diffuse[3];
} kdr_recipe_material;

/* Draws within 10 % of triangle_count (KDR_SCENE_LEAST to KDR_SCENE_MOST) at any finite time; +y is up.
 * It is called twice with the same arguments (see shape.h) and must do the same both times. */
typedef void kdr_recipe_fn(kdr_shape *shape, size_t triangle_count, double time);

typedef struct kdr_recipe {
    const char *name;
    const char *text; /* one line */
    size_t default_count;
    uint32_t traits;
    kdr_recipe_fn *draw;
    const kdr_recipe_material *materials; /* what shape.material numbers; at least one */
    uint32_t material_count;
} kdr_recipe;

/* Every recipe is a constant kdr_recipe_NAME of its own, in the file of its kind; here is their order. */
#define KDR_RECIPE_LIST(X)                                                                                             \
    X(demo)                                                                                                            \
    X(flake)                                                                                                           \
    X(forest)                                                                                                          \
    X(city)                                                                                                            \
    X(stadium)                                                                                                         \
    X(grass)                                                                                                           \
    X(hair)                                                                                                            \
    X(terrain)                                                                                                         \
    X(sphere)                                                                                                          \
    X(knot)                                                                                                            \
    X(shell)                                                                                                           \
    X(needles)                                                                                                         \
    X(soup)                                                                                                            \
    X(heap)                                                                                                            \
    X(duplicates)                                                                                                      \
    X(explode)                                                                                                         \
    X(twist)                                                                                                           \
    X(wave)                                                                                                            \
    X(crowd)

#define KDR_RECIPE_DECLARE(name) extern const kdr_recipe kdr_recipe_##name;
KDR_RECIPE_LIST(KDR_RECIPE_DECLARE)
#undef KDR_RECIPE_DECLARE

/* Recipe i in that order, or NULL past the last. */
const kdr_recipe *kdr_recipe_at(size_t i);

#define KDR_RECIPE_MATERIALS(list) .materials = (list), .material_count = sizeof(list) / sizeof(list)[0]

#endif
