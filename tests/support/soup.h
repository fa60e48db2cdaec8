/* Triangle soups of many kinds, and scenes made of them: what the library's queries are held against the oracle on. */
#ifndef KDR_TESTS_SUPPORT_SOUP_H
#define KDR_TESTS_SUPPORT_SOUP_H

#include "kdray/kdray.h"
#include "support/random.h"

/* Fills 9 floats for each of `count` triangles. */
typedef void soup_fill_fn(test_random *random, float *triangles, size_t count);

typedef struct soup_kind {
    const char *name;
    soup_fill_fn *fill;
    size_t count;  /* of triangles that a scene of this kind should have */
    bool is_exact; /* most rays need exact arithmetic: fewer of them are asked */
} soup_kind;

extern const soup_kind soup_kinds[];
extern const size_t soup_kind_count;

/* The kind of that name; aborts if there is none. */
const soup_kind *soup_kind_find(const char *name);

#define SOUP_GEOMETRIES 4

/* The triangles dealt out to geometries of different layouts: tight without indices, an empty one, a stride of 16 with
 * NaN between the vertices, a stride of 32 with shuffled vertices and a wide index stride. */
typedef struct soup_scene {
    kdr_triangles_def geometries[SOUP_GEOMETRIES];
    void *arrays[2 * SOUP_GEOMETRIES]; /* owned */
} soup_scene;

/* Aborts without memory. */
soup_scene soup_scene_create(test_random *random, const float *triangles, size_t count);
soup_scene soup_scene_create_kind(test_random *random, const soup_kind *kind, size_t count);
void soup_scene_destroy(soup_scene *scene);

/* A finite float of any bits. */
float soup_any_float(test_random *random);

/* calloc that aborts without memory; a count of 0 gives a block too. */
void *test_allocate(size_t count, size_t size);

#endif
