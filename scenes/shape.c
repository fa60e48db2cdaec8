#include "scenes/shape.h"

void kdr_shape_facet(kdr_shape *shape, kdr_point a, kdr_point b, kdr_point c) {
    kdr_point normal = {0, 1, 0};
    if (shape->normals)
        normal = kdr_point_unit(kdr_point_cross(kdr_point_sub(b, a), kdr_point_sub(c, a)));
    uint32_t first = kdr_shape_vertex(shape, a, normal);
    kdr_shape_vertex(shape, b, normal);
    kdr_shape_vertex(shape, c, normal);
    kdr_shape_triangle(shape, first, first + 1, first + 2);
}

void kdr_shape_quad_corners(kdr_shape *shape, kdr_point a, kdr_point b, kdr_point c, kdr_point d) {
    kdr_point normal = {0, 1, 0};
    if (shape->normals)
        normal = kdr_point_unit(kdr_point_cross(kdr_point_sub(c, a), kdr_point_sub(d, b)));
    uint32_t first = kdr_shape_vertex(shape, a, normal);
    kdr_shape_vertex(shape, b, normal);
    kdr_shape_vertex(shape, c, normal);
    kdr_shape_vertex(shape, d, normal);
    kdr_shape_triangle(shape, first, first + 1, first + 2);
    kdr_shape_triangle(shape, first, first + 2, first + 3);
}

void kdr_shape_quad(kdr_shape *shape, kdr_point corner, kdr_point edge_a, kdr_point edge_b) {
    kdr_point a = kdr_point_add(corner, edge_a);
    kdr_shape_quad_corners(shape, corner, a, kdr_point_add(a, edge_b), kdr_point_add(corner, edge_b));
}

void kdr_shape_box(kdr_shape *shape, const kdr_frame *frame, bool bottom) {
    if (kdr_shape_counts(shape)) {
        kdr_shape_skip(shape, bottom ? 24 : 20, bottom ? 12 : 10);
        return;
    }
    kdr_point low = kdr_frame_point(frame, -1, -1, -1);
    kdr_point x = kdr_point_scale(frame->x, 2), y = kdr_point_scale(frame->y, 2), z = kdr_point_scale(frame->z, 2);
    kdr_shape_quad(shape, kdr_point_add(low, x), y, z);
    kdr_shape_quad(shape, low, z, y);
    kdr_shape_quad(shape, kdr_point_add(low, y), z, x);
    kdr_shape_quad(shape, kdr_point_add(low, z), x, y);
    kdr_shape_quad(shape, low, y, x);
    if (bottom)
        kdr_shape_quad(shape, low, x, z);
}

void kdr_shape_disc(kdr_shape *shape, const kdr_frame *frame, size_t segments) {
    if (kdr_shape_counts(shape)) {
        kdr_shape_skip(shape, segments + 1, segments);
        return;
    }
    kdr_point normal = kdr_point_unit(frame->y);
    uint32_t middle = kdr_shape_vertex(shape, frame->origin, normal);
    for (size_t i = 0; i < segments; i++) {
        kdr_turn turn = kdr_turn_of((double)i / (double)segments);
        uint32_t vertex = kdr_shape_vertex(shape, kdr_frame_point(frame, turn.sine, 0, turn.cosine), normal);
        kdr_shape_triangle(shape, middle, vertex, i + 1 < segments ? vertex + 1 : middle + 1);
    }
}

void kdr_shape_tube(kdr_shape *shape, const kdr_frame *low, const kdr_frame *high, uint32_t sides) {
    if (kdr_shape_counts(shape)) {
        kdr_shape_skip(shape, (size_t)2 * sides, (size_t)2 * sides);
        return;
    }
    uint32_t first = (uint32_t)shape->vertex_count;
    for (uint32_t i = 0; i < sides; i++) {
        kdr_turn turn = kdr_turn_of((double)i / sides);
        kdr_point normal = kdr_point_unit(kdr_frame_vector(low, turn.sine, 0, turn.cosine));
        kdr_shape_vertex(shape, kdr_frame_point(low, turn.sine, 0, turn.cosine), normal);
        kdr_shape_vertex(shape, kdr_frame_point(high, turn.sine, 0, turn.cosine), normal);
    }
    for (uint32_t i = 0; i < sides; i++) {
        uint32_t a = first + 2 * i, b = first + 2 * ((i + 1) % sides);
        kdr_shape_triangle(shape, a, b, b + 1);
        kdr_shape_triangle(shape, a, b + 1, a + 1);
    }
}

void kdr_shape_grid(kdr_shape *shape, kdr_grid grid, kdr_grid_fn *place, const void *context) {
    size_t rows = grid.rows + !grid.closed, columns = grid.columns + !grid.around;
    if (kdr_shape_counts(shape)) {
        kdr_shape_skip(shape, rows * columns, 2 * grid.rows * grid.columns);
        return;
    }
    size_t first_vertex = shape->vertex_count, first_triangle = shape->triangle_count;
    for (size_t r = 0; r < rows; r++)
        for (size_t c = 0; c < columns; c++)
            kdr_shape_vertex(shape, place(context, r, c), (kdr_point){0, 1, 0});
    for (size_t r = 0; r < grid.rows; r++) {
        uint32_t this_row = (uint32_t)(first_vertex + r * columns);
        uint32_t next_row = (uint32_t)(first_vertex + (r + 1) % rows * columns);
        for (size_t c = 0; c < grid.columns; c++) {
            uint32_t here = (uint32_t)c, next = (uint32_t)(c + 1 == columns ? 0 : c + 1);
            kdr_shape_triangle(shape, this_row + here, this_row + next, next_row + next);
            kdr_shape_triangle(shape, this_row + here, next_row + next, next_row + here);
        }
    }
    kdr_shape_smooth(shape, first_vertex, first_triangle);
}

kdr_grid kdr_grid_fit(size_t triangles, double aspect, size_t least_rows, size_t least_columns) {
    double ideal = sqrt((double)triangles / 2 * aspect);
    size_t low = (size_t)(ideal * 0.8), high = (size_t)(ideal * 1.25) + 1;
    low = low < least_rows ? least_rows : low;
    high = high < low ? low : high;
    high = high > low + 64 ? low + 64 : high;

    kdr_grid best = {.rows = least_rows, .columns = least_columns};
    size_t best_error = SIZE_MAX;
    for (size_t rows = low; rows <= high; rows++) {
        size_t columns = (triangles + rows) / (2 * rows);
        columns = columns < least_columns ? least_columns : columns;
        size_t count = 2 * rows * columns;
        size_t error = count > triangles ? count - triangles : triangles - count;
        if (error < best_error) {
            best_error = error;
            best.rows = rows;
            best.columns = columns;
        }
    }
    return best;
}

void kdr_shape_smooth(kdr_shape *shape, size_t first_vertex, size_t first_triangle) {
    if (!shape->normals)
        return;
    for (size_t i = 3 * first_vertex; i < 3 * shape->vertex_count; i++)
        shape->normals[i] = 0;
    for (size_t i = first_triangle; i < shape->triangle_count; i++) {
        const uint32_t *index = shape->indices + 3 * i;
        kdr_point corner[3];
        for (int k = 0; k < 3; k++) {
            const float *p = shape->positions + 3 * (size_t)index[k];
            corner[k] = (kdr_point){p[0], p[1], p[2]};
        }
        kdr_point area = kdr_point_cross(kdr_point_sub(corner[1], corner[0]), kdr_point_sub(corner[2], corner[0]));
        for (int k = 0; k < 3; k++) {
            float *n = shape->normals + 3 * (size_t)index[k];
            n[0] += (float)area.x, n[1] += (float)area.y, n[2] += (float)area.z;
        }
    }
    for (size_t i = first_vertex; i < shape->vertex_count; i++) {
        float *n = shape->normals + 3 * i;
        kdr_point unit = kdr_point_unit((kdr_point){n[0], n[1], n[2]});
        n[0] = (float)unit.x, n[1] = (float)unit.y, n[2] = (float)unit.z;
    }
}
