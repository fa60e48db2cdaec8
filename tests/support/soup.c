#include "support/soup.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void *test_allocate(size_t count, size_t size) {
    void *memory = calloc(count ? count : 1, size);
    if (!memory) {
        fprintf(stderr, "test support: out of memory\n");
        abort();
    }
    return memory;
}

float soup_any_float(test_random *random) {
    for (;;) {
        uint32_t bits = test_random_u32(random);
        float value;
        memcpy(&value, &bits, sizeof(value));
        if (isfinite(value))
            return value;
    }
}

/* ------------------------------------------------------------------------------------------------------- kinds */

/* Triangles of about `size` in the cube [-1, 1]. */
static void fill_cube(test_random *random, float *triangles, size_t count, float size) {
    for (size_t i = 0; i < count; i++) {
        float centre[3];
        for (int axis = 0; axis < 3; axis++)
            centre[axis] = test_random_between(random, -1, 1);
        for (int k = 0; k < 9; k++)
            triangles[9 * i + k] = centre[k % 3] + test_random_between(random, -size, size);
    }
}

static void scale(float *triangles, size_t count, float factor) {
    for (size_t i = 0; i < 9 * count; i++)
        triangles[i] *= factor;
}

static void fill_small(test_random *random, float *triangles, size_t count) {
    fill_cube(random, triangles, count, 0.05f);
}

static void fill_large(test_random *random, float *triangles, size_t count) { fill_cube(random, triangles, count, 1); }

/* Corners on a coarse grid: shared vertices and edges, coplanar and zero-area triangles, duplicates. */
static void fill_grid(test_random *random, float *triangles, size_t count) {
    for (size_t i = 0; i < 9 * count; i++)
        triangles[i] = (float)test_random_below(random, 5) - 2;
}

/* Right triangles in axis-aligned planes at the borders of 32 bins. */
static void fill_slabs(test_random *random, float *triangles, size_t count) {
    for (size_t i = 0; i < count; i++) {
        float *t = triangles + 9 * i;
        int axis = (int)test_random_below(random, 3);
        float low[3];
        for (int k = 0; k < 3; k++)
            low[k] = (float)test_random_below(random, 32);
        for (int k = 0; k < 9; k++)
            t[k] = low[k % 3];
        t[3 + (axis + 1) % 3] += 1 + (float)test_random_below(random, 8);
        t[6 + (axis + 2) % 3] += 1 + (float)test_random_below(random, 8);
    }
}

/* The twelve triangles of flat and cubic boxes with integer corners. */
static void fill_boxes(test_random *random, float *triangles, size_t count) {
    static const uint8_t corners[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                           {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    float low[3] = {0}, size[3] = {0};
    for (size_t i = 0; i < count; i++) {
        for (int axis = 0; axis < 3 && i % 12 == 0; axis++) {
            low[axis] = (float)test_random_below(random, 16);
            size[axis] = (float)test_random_below(random, 4);
        }
        for (int k = 0; k < 9; k++)
            triangles[9 * i + k] = low[k % 3] + (corners[i % 12][k / 3] >> k % 3 & 1 ? size[k % 3] : 0);
    }
}

/* All in the plane z = 1/4. */
static void fill_plane(test_random *random, float *triangles, size_t count) {
    fill_cube(random, triangles, count, 0.2f);
    for (size_t i = 0; i < 3 * count; i++)
        triangles[3 * i + 2] = 0.25f;
}

/* All in a plane that lies along no axis: on a grid, so that they lie in it exactly. */
static void fill_slanted_plane(test_random *random, float *triangles, size_t count) {
    for (size_t i = 0; i < 3 * count; i++) {
        float x = (float)test_random_below(random, 17) - 8, y = (float)test_random_below(random, 17) - 8;
        triangles[3 * i] = x;
        triangles[3 * i + 1] = y;
        triangles[3 * i + 2] = 2 * x - 3 * y + 1;
    }
}

/* Copies of three triangles. */
static void fill_duplicates(test_random *random, float *triangles, size_t count) {
    fill_cube(random, triangles, count < 3 ? count : 3, 1);
    for (size_t i = 3; i < count; i++)
        memcpy(triangles + 9 * i, triangles + 9 * (i % 3), 9 * sizeof(float));
}

/* Segments and points. */
static void fill_zero_area(test_random *random, float *triangles, size_t count) {
    fill_cube(random, triangles, count, 0.5f);
    for (size_t i = 0; i < count; i++) {
        float *t = triangles + 9 * i;
        memcpy(t + 6, t + (test_random_below(random, 2) ? 3 : 0), 3 * sizeof(float));
        if (i % 3 == 0)
            memcpy(t + 3, t, 3 * sizeof(float));
    }
}

/* Long and thin, in all directions. */
static void fill_needles(test_random *random, float *triangles, size_t count) {
    fill_cube(random, triangles, count, 1);
    for (size_t i = 0; i < count; i++)
        for (int axis = 0; axis < 3; axis++)
            triangles[9 * i + 6 + axis] = triangles[9 * i + axis] + test_random_between(random, -1e-5f, 1e-5f);
}

/* A fan around one vertex, and its edges shared. */
static void fill_fan(test_random *random, float *triangles, size_t count) {
    (void)random;
    for (size_t i = 0; i < count; i++) {
        for (int k = 0; k < 9; k++)
            triangles[9 * i + k] = 0.1f;
        for (int side = 0; side < 2; side++) {
            double angle = 6.283185307179586 * (double)((i + side) % count) / (double)count;
            triangles[9 * i + 3 + 3 * side] = (float)cos(angle);
            triangles[9 * i + 4 + 3 * side] = (float)sin(angle);
        }
    }
}

static void fill_huge(test_random *random, float *triangles, size_t count) {
    fill_cube(random, triangles, count, 0.5f);
    scale(triangles, count, 1e30f);
}

static void fill_largest(test_random *random, float *triangles, size_t count) {
    fill_cube(random, triangles, count, 0.1f);
    scale(triangles, count, 3e38f);
    for (size_t i = 0; i < 9 * count; i++)
        triangles[i] = fmaxf(fminf(triangles[i], 3.4e38f), -3.4e38f);
}

static void fill_tiny(test_random *random, float *triangles, size_t count) {
    fill_cube(random, triangles, count, 0.5f);
    scale(triangles, count, 1e-30f);
}

static void fill_denormal(test_random *random, float *triangles, size_t count) {
    for (size_t i = 0; i < 9 * count; i++)
        triangles[i] = (float)((int)test_random_below(random, 257) - 128) * 0x1p-149f;
}

/* Each triangle at a scale of its own. */
static void fill_mixed_scales(test_random *random, float *triangles, size_t count) {
    fill_cube(random, triangles, count, 0.5f);
    for (size_t i = 0; i < count; i++) {
        int exponent = (int)test_random_below(random, 200) - 100;
        for (int k = 0; k < 9; k++)
            triangles[9 * i + k] = ldexpf(triangles[9 * i + k], exponent);
    }
}

static void fill_any_bits(test_random *random, float *triangles, size_t count) {
    for (size_t i = 0; i < 9 * count; i++)
        triangles[i] = soup_any_float(random);
}

/* Every third triangle has a vertex that is NaN or infinite. */
static void fill_not_finite(test_random *random, float *triangles, size_t count) {
    static const float bad[] = {NAN, INFINITY, -INFINITY};
    fill_cube(random, triangles, count, 0.3f);
    for (size_t i = 0; i < count; i += 3)
        triangles[9 * i + test_random_below(random, 9)] = bad[i / 3 % 3];
}

/* Copies of one triangle: no plane separates anything. */
static void fill_identical(test_random *random, float *triangles, size_t count) {
    fill_cube(random, triangles, count < 1 ? count : 1, 1);
    for (size_t i = 1; i < count; i++)
        memcpy(triangles + 9 * i, triangles, 9 * sizeof(float));
}

/* A small model in a large stadium: all but a few lie in one of any bins over the scene. */
static void fill_stadium(test_random *random, float *triangles, size_t count) {
    fill_cube(random, triangles, count, 0.1f);
    scale(triangles, count, 0x1p-20f);
    for (size_t i = 0; i < 3 && i < count; i++)
        for (int k = 0; k < 9; k++)
            triangles[9 * i + k] = test_random_between(random, -1, 1) * 100;
}

const soup_kind soup_kinds[] = {
    {"none", fill_small, 0, false},
    {"one", fill_large, 1, false},
    {"two", fill_large, 2, false},
    {"small", fill_small, 1500, false},
    {"large", fill_large, 200, false},
    {"grid", fill_grid, 150, false},
    {"slabs", fill_slabs, 400, false},
    {"boxes", fill_boxes, 480, false},
    {"plane", fill_plane, 250, true},
    {"slanted plane", fill_slanted_plane, 100, false},
    {"duplicates", fill_duplicates, 300, true},
    {"zero area", fill_zero_area, 200, false},
    {"needles", fill_needles, 300, true},
    {"fan", fill_fan, 150, true},
    {"huge", fill_huge, 200, false},
    {"largest", fill_largest, 200, false},
    {"tiny", fill_tiny, 200, false},
    {"denormal", fill_denormal, 150, false},
    {"mixed scales", fill_mixed_scales, 300, true},
    {"any bits", fill_any_bits, 200, true},
    {"not finite", fill_not_finite, 300, false},
    {"identical", fill_identical, 200, true},
    {"stadium", fill_stadium, 300, false},
};
const size_t soup_kind_count = sizeof(soup_kinds) / sizeof(soup_kinds[0]);

const soup_kind *soup_kind_find(const char *name) {
    for (size_t i = 0; i < soup_kind_count; i++)
        if (strcmp(soup_kinds[i].name, name) == 0)
            return &soup_kinds[i];
    fprintf(stderr, "soup: no kind is named %s\n", name);
    abort();
}

/* ------------------------------------------------------------------------------------------------------ scenes */

static kdr_triangles_def tight(soup_scene *scene, const float *triangles, size_t count) {
    float *vertices = test_allocate(9 * count, sizeof(float));
    if (count > 0)
        memcpy(vertices, triangles, 9 * count * sizeof(float));
    scene->arrays[0] = vertices;
    kdr_triangles_def def = kdr_default_triangles_def();
    def.vertices = vertices;
    def.vertex_count = 3 * count;
    def.triangle_count = count;
    return def;
}

/* Vertices in shuffled order at a stride of `words` floats, NaN in the gaps; indices at a stride of index_words. */
static kdr_triangles_def indexed(soup_scene *scene, int slot, test_random *random, const float *triangles, size_t count,
                                 size_t words, size_t index_words) {
    size_t vertex_count = 3 * count;
    float *vertices = test_allocate(words * vertex_count, sizeof(float));
    uint32_t *indices = test_allocate(index_words * count, sizeof(uint32_t));
    uint32_t *places = test_allocate(vertex_count, sizeof(uint32_t));
    for (size_t i = 0; i < vertex_count; i++) {
        size_t k = test_random_below(random, (uint32_t)i + 1);
        places[i] = places[k];
        places[k] = (uint32_t)i;
    }
    for (size_t i = 0; i < words * vertex_count; i++)
        vertices[i] = NAN;
    for (size_t i = 0; i < index_words * count; i++)
        indices[i] = UINT32_MAX;
    for (size_t i = 0; i < vertex_count; i++) {
        memcpy(vertices + words * places[i], triangles + 3 * i, 3 * sizeof(float));
        indices[i / 3 * index_words + i % 3] = places[i];
    }
    free(places);
    scene->arrays[2 * slot] = vertices;
    scene->arrays[2 * slot + 1] = indices;
    kdr_triangles_def def = kdr_default_triangles_def();
    def.vertices = vertices;
    def.vertex_stride = words * sizeof(float);
    def.vertex_count = vertex_count;
    def.indices = indices;
    def.index_stride = index_words * sizeof(uint32_t);
    def.triangle_count = count;
    return def;
}

soup_scene soup_scene_create(test_random *random, const float *triangles, size_t count) {
    soup_scene scene = {0};
    size_t first = count / 3, second = 2 * (count / 3);
    scene.geometries[0] = tight(&scene, triangles, first);
    scene.geometries[1] = kdr_default_triangles_def();
    scene.geometries[2] = indexed(&scene, 2, random, triangles + 9 * first, second - first, 4, 3);
    scene.geometries[3] = indexed(&scene, 3, random, triangles + 9 * second, count - second, 8, 5);
    return scene;
}

soup_scene soup_scene_create_kind(test_random *random, const soup_kind *kind, size_t count) {
    float *triangles = test_allocate(9 * count, sizeof(float));
    kind->fill(random, triangles, count);
    soup_scene scene = soup_scene_create(random, triangles, count);
    free(triangles);
    return scene;
}

void soup_scene_destroy(soup_scene *scene) {
    for (int i = 0; i < 2 * SOUP_GEOMETRIES; i++)
        free(scene->arrays[i]);
    *scene = (soup_scene){0};
}
