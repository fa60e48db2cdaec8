/* Balls as rings of latitude: ring r counts `sectors` x r vertices from the pole down to the equator, so that all
 * triangles are of about one size, and a ball of any whole number of sectors and levels is closed. */
#include "scenes/shape.h"

kdr_ball kdr_ball_fit(size_t triangles) {
    uint32_t level = (uint32_t)sqrt((double)triangles / 8);
    uint32_t low = level > 3 ? level - 2 : 1;
    kdr_ball best = {4, 1};
    size_t best_error = SIZE_MAX;
    for (kdr_ball ball = {.level = low}; ball.level <= level + 1; ball.level++)
        for (ball.sectors = 4; ball.sectors <= 8; ball.sectors++) {
            size_t count = kdr_ball_triangles(ball);
            size_t error = count > triangles ? count - triangles : triangles - count;
            if (error < best_error) {
                best_error = error;
                best = ball;
            }
        }
    return best;
}

/* How many rings away the nearer pole is. */
static uint32_t rings_to_pole(kdr_ball ball, uint32_t row) { return row <= ball.level ? row : 2 * ball.level - row; }

uint32_t kdr_ball_ring_size(kdr_ball ball, uint32_t row) {
    uint32_t rings = rings_to_pole(ball, row);
    return rings ? ball.sectors * rings : 1;
}

kdr_point kdr_ball_point(kdr_ball ball, uint32_t row, uint32_t column) {
    kdr_turn latitude = kdr_turn_of((double)row / (4 * (double)ball.level));
    kdr_turn longitude = kdr_turn_of((double)column / kdr_ball_ring_size(ball, row));
    return (kdr_point){latitude.sine * longitude.sine, latitude.cosine, latitude.sine * longitude.cosine};
}

/* A strip's ring nearer to the pole, counted from that pole. */
static uint32_t strip_rank(kdr_ball ball, uint32_t row) { return row < ball.level ? row : 2 * ball.level - 1 - row; }

uint32_t kdr_ball_strip_size(kdr_ball ball, uint32_t row) { return ball.sectors * (2 * strip_rank(ball, row) + 1); }

void kdr_ball_strip_triangle(kdr_ball ball, uint32_t row, uint32_t i, kdr_ball_corner corners[3]) {
    uint32_t rank = strip_rank(ball, row);
    bool north = row < ball.level;
    uint32_t short_row = north ? row : row + 1, long_row = north ? row + 1 : row;
    uint32_t short_size = kdr_ball_ring_size(ball, short_row), long_size = kdr_ball_ring_size(ball, long_row);

    // Within a sector the corners alternate: two on the long ring and one on the short ring, then the other way round.
    uint32_t sector = i / (2 * rank + 1), step = i % (2 * rank + 1);
    uint32_t on_short = sector * rank + step / 2, on_long = sector * (rank + 1) + (step + 1) / 2;
    kdr_ball_corner first = {short_row, on_short % short_size};
    kdr_ball_corner second = {long_row, on_long % long_size};
    kdr_ball_corner third = {long_row, (on_long + 1) % long_size};
    if (step % 2)
        third = (kdr_ball_corner){short_row, (on_short + 1) % short_size};

    corners[0] = first;
    corners[1] = north ? second : third;
    corners[2] = north ? third : second;
}

/* Vertices of the rings before `row`. */
static uint32_t ring_start(kdr_ball ball, uint32_t row) {
    uint32_t rings = rings_to_pole(ball, row);
    if (row <= ball.level)
        return row ? 1 + ball.sectors * (rings * (rings - 1) / 2) : 0;
    return (uint32_t)kdr_ball_vertices(ball) - 1 - ball.sectors * (rings * (rings + 1) / 2);
}

void kdr_shape_ball(kdr_shape *shape, const kdr_frame *frame, kdr_ball ball, kdr_radius_fn *radius) {
    if (kdr_shape_counts(shape)) {
        kdr_shape_skip(shape, kdr_ball_vertices(ball), kdr_ball_triangles(ball));
        return;
    }
    size_t first_vertex = shape->vertex_count, first_triangle = shape->triangle_count;

    // A stretched ball's normals shrink along an axis as its points stretch.
    kdr_frame across = {frame->origin, kdr_point_scale(frame->x, 1 / kdr_point_dot(frame->x, frame->x)),
                        kdr_point_scale(frame->y, 1 / kdr_point_dot(frame->y, frame->y)),
                        kdr_point_scale(frame->z, 1 / kdr_point_dot(frame->z, frame->z))};
    for (uint32_t row = 0; row <= 2 * ball.level; row++)
        for (uint32_t column = 0; column < kdr_ball_ring_size(ball, row); column++) {
            kdr_point unit = kdr_ball_point(ball, row, column);
            kdr_point normal = {0, 1, 0};
            if (shape->normals)
                normal = kdr_point_unit(kdr_frame_vector(&across, unit.x, unit.y, unit.z));
            if (radius)
                unit = kdr_point_scale(unit, radius(unit));
            kdr_shape_vertex(shape, kdr_frame_point(frame, unit.x, unit.y, unit.z), normal);
        }

    for (uint32_t row = 0; row < 2 * ball.level; row++)
        for (uint32_t i = 0; i < kdr_ball_strip_size(ball, row); i++) {
            kdr_ball_corner corner[3];
            uint32_t vertex[3];
            kdr_ball_strip_triangle(ball, row, i, corner);
            for (int k = 0; k < 3; k++)
                vertex[k] = (uint32_t)first_vertex + ring_start(ball, corner[k].row) + corner[k].column;
            kdr_shape_triangle(shape, vertex[0], vertex[1], vertex[2]);
        }
    if (radius)
        kdr_shape_smooth(shape, first_vertex, first_triangle);
}
