/* What scenes are put together from: triangles, boxes, balls, tubes and grids, appended to arrays of exact size.
 *
 * A scene is drawn twice by the same code. The first time the arrays are NULL and appending only counts; the second
 * time the arrays have just that size. So a count can never disagree with what is written, and no formula says it
 * twice.
 *
 * Winding is counter-clockwise seen from outside: normals point out. */
#ifndef KDR_SCENES_SHAPE_H
#define KDR_SCENES_SHAPE_H

#include "base/check.h"
#include "scenes/point.h"

typedef struct kdr_shape {
    float *positions;    /* 3 a vertex; NULL while counting, as are the others */
    float *normals;      /* 3 a vertex; NULL also when the scene is shaded flat */
    uint32_t *indices;   /* 3 a triangle */
    uint32_t *materials; /* 1 a triangle */
    size_t vertex_count; /* appended up to here */
    size_t triangle_count;
    uint32_t material; /* of the triangles that follow */
} kdr_shape;

static inline bool kdr_shape_counts(const kdr_shape *shape) { return shape->positions == NULL; }

/* Appends a vertex and returns its number. */
static inline uint32_t kdr_shape_vertex(kdr_shape *shape, kdr_point place, kdr_point normal) {
    size_t vertex = shape->vertex_count++;
    if (shape->positions) {
        float *p = shape->positions + 3 * vertex;
        p[0] = (float)place.x, p[1] = (float)place.y, p[2] = (float)place.z;
    }
    if (shape->normals) {
        float *n = shape->normals + 3 * vertex;
        n[0] = (float)normal.x, n[1] = (float)normal.y, n[2] = (float)normal.z;
    }
    return (uint32_t)vertex;
}

static inline void kdr_shape_triangle(kdr_shape *shape, uint32_t a, uint32_t b, uint32_t c) {
    size_t triangle = shape->triangle_count++;
    if (shape->indices) {
        uint32_t *index = shape->indices + 3 * triangle;
        index[0] = a, index[1] = b, index[2] = c;
        shape->materials[triangle] = shape->material;
    }
}

/* Counts that many without drawing: what a scene with equal parts does while counting. */
static inline void kdr_shape_skip(kdr_shape *shape, size_t vertices, size_t triangles) {
    shape->vertex_count += vertices;
    shape->triangle_count += triangles;
}

/* A triangle with three vertices of its own: 1 triangle. */
void kdr_shape_facet(kdr_shape *shape, kdr_point a, kdr_point b, kdr_point c);

/* A parallelogram, seen from the side of edge_a x edge_b: 2 triangles. */
void kdr_shape_quad(kdr_shape *shape, kdr_point corner, kdr_point edge_a, kdr_point edge_b);

/* Any four corners in one plane, counter-clockwise: 2 triangles. */
void kdr_shape_quad_corners(kdr_shape *shape, kdr_point a, kdr_point b, kdr_point c, kdr_point d);

/* A box from -1 to 1 along the frame's axes: 12 triangles, 10 without the face at y = -1. */
void kdr_shape_box(kdr_shape *shape, const kdr_frame *frame, bool bottom);

/* A fan around the frame's origin, in its x and z axes, facing its y axis: `segments` (at least 3) triangles. */
void kdr_shape_disc(kdr_shape *shape, const kdr_frame *frame, size_t segments);

/* A unit ball in the frame: a cap of `sectors` (at least 3) triangles at either pole, each refined `level` (at least 1)
 * times a side: 2 sectors level^2 triangles, sectors level^2 + 2 vertices, closed. */
typedef struct kdr_ball {
    uint32_t sectors, level;
} kdr_ball;

static inline size_t kdr_ball_triangles(kdr_ball ball) { return (size_t)2 * ball.sectors * ball.level * ball.level; }
static inline size_t kdr_ball_vertices(kdr_ball ball) { return kdr_ball_triangles(ball) / 2 + 2; }

/* The ball of 4 to 8 sectors whose triangle count is nearest to the one asked for: within 10 % from 100 on. */
kdr_ball kdr_ball_fit(size_t triangles);

/* Vertex `column` of ring `row`: 0 is the pole at y = 1, 2 level the one at y = -1. On the unit sphere. */
kdr_point kdr_ball_point(kdr_ball ball, uint32_t row, uint32_t column);

/* Triangles between ring `row` and the next one, by number, each as row and column of its corners. */
typedef struct kdr_ball_corner {
    uint32_t row, column;
} kdr_ball_corner;

uint32_t kdr_ball_ring_size(kdr_ball ball, uint32_t row);
uint32_t kdr_ball_strip_size(kdr_ball ball, uint32_t row);
void kdr_ball_strip_triangle(kdr_ball ball, uint32_t row, uint32_t i, kdr_ball_corner corners[3]);

/* Radius of the surface over a point of the unit sphere; NULL where a ball is meant. */
typedef double kdr_radius_fn(kdr_point unit);
void kdr_shape_ball(kdr_shape *shape, const kdr_frame *frame, kdr_ball ball, kdr_radius_fn *radius);

/* A surface over rows x columns cells, 2 triangles each, facing (direction of columns) x (direction of rows).
 * place gives vertex (row, column); around: the last column is joined to the first; closed: the last row to the first.
 * Normals are smoothed over the cells. */
typedef kdr_point kdr_grid_fn(const void *context, size_t row, size_t column);

typedef struct kdr_grid {
    size_t rows, columns;
    bool around, closed;
} kdr_grid;

void kdr_shape_grid(kdr_shape *shape, kdr_grid grid, kdr_grid_fn *place, const void *context);

/* The grid with 2 rows columns nearest to `triangles` among those with rows near aspect x columns, at least the minima.
 */
kdr_grid kdr_grid_fit(size_t triangles, double aspect, size_t least_rows, size_t least_columns);

/* A cone or cylinder without caps from frame `low` to frame `high` (their x and z axes are the radii):
 * 2 sides (at least 3) triangles. */
void kdr_shape_tube(kdr_shape *shape, const kdr_frame *low, const kdr_frame *high, uint32_t sides);

/* Sets the normals of all vertices from first_vertex on from the triangles from first_triangle on, weighted by area. */
void kdr_shape_smooth(kdr_shape *shape, size_t first_vertex, size_t first_triangle);

/* Part i of `total` dealt out to `count` receivers as evenly as whole numbers allow. */
static inline size_t kdr_share(size_t total, size_t count, size_t i) {
    return total / count + ((i + 1) * (total % count) / count - i * (total % count) / count);
}

#endif
