/* Surfaces swept along a curve: the torus knot, closed, and the tower that twists. */
#include "scenes/parts.h"

typedef struct knot_sweep {
    kdr_frame frame;
    kdr_grid grid;
    int around, through;
} knot_sweep;

#define RING_RADIUS 0.62
#define CURVE_RADIUS 0.26
#define TUBE_RADIUS 0.12

/* The curve lies on a torus, whose normal is always at a right angle to it: a frame that comes back to itself, so that
 * the tube closes without a seam. */
static kdr_point knot_point(const void *context, size_t row, size_t column) {
    const knot_sweep *knot = context;
    double t = (double)row / (double)knot->grid.rows;
    kdr_turn a = kdr_turn_of(t * knot->around), b = kdr_turn_of(t * knot->through);
    double reach = RING_RADIUS + CURVE_RADIUS * b.cosine;
    kdr_point centre = {reach * a.cosine, CURVE_RADIUS * b.sine, reach * a.sine};
    kdr_point normal = {b.cosine * a.cosine, b.sine, b.cosine * a.sine};
    double along = reach * knot->around, across = CURVE_RADIUS * knot->through;
    kdr_point tangent = kdr_point_unit((kdr_point){-along * a.sine - across * b.sine * a.cosine, across * b.cosine,
                                                   along * a.cosine - across * b.sine * a.sine});
    kdr_turn side = kdr_turn_of((double)column / (double)knot->grid.columns);
    kdr_point place = kdr_point_along(centre, normal, TUBE_RADIUS * side.cosine);
    place = kdr_point_along(place, kdr_point_cross(tangent, normal), TUBE_RADIUS * side.sine);
    return kdr_frame_point(&knot->frame, place.x, place.y, place.z);
}

void kdr_draw_knot(kdr_shape *shape, const kdr_frame *frame, size_t triangles, int winds_around, int winds_through) {
    kdr_grid grid = kdr_grid_fit(triangles, 8, 12, 3);
    grid.around = grid.closed = true;
    knot_sweep knot = {*frame, grid, winds_around, winds_through};
    kdr_shape_grid(shape, grid, knot_point, &knot);
}

static const kdr_recipe_material knot_materials[] = {{"brass", {0.70f, 0.48f, 0.14f}}};

/* Standing up, so that the camera looks through it. */
static void draw_knot(kdr_shape *shape, size_t triangle_count, double time) {
    (void)time;
    kdr_frame frame = kdr_frame_turn_x(kdr_frame_at((kdr_point){0, 0, 0}, 1), 0.2);
    kdr_draw_knot(shape, &frame, triangle_count, 2, 3);
}

const kdr_recipe kdr_recipe_knot = {
    .name = "knot",
    .text = "a closed tube along a trefoil knot",
    .default_count = 100000,
    .traits = KDR_SCENE_SMOOTH | KDR_SCENE_CLOSED,
    .draw = draw_knot,
    KDR_RECIPE_MATERIALS(knot_materials),
};

#define TOWER_HEIGHT 2.7
#define TWIST_PERIOD 8.0

enum { TWIST_GROUND, TWIST_GLASS, TWIST_SLAB, TWIST_ROOF };

static const kdr_recipe_material twist_materials[] = {
    {"ground", {0.30f, 0.30f, 0.28f}},
    {"glass", {0.10f, 0.28f, 0.38f}},
    {"slab", {0.75f, 0.72f, 0.66f}},
    {"roof", {0.45f, 0.20f, 0.14f}},
};

typedef struct tower_sweep {
    kdr_grid grid;
    double twist; /* turns from foot to top */
} tower_sweep;

/* Every fourth row of cells is a slab that stands out. */
static bool is_slab(size_t row) { return row % 4 == 0; }

/* A square section that narrows upwards, turned in proportion to its height. */
static kdr_point tower_point(const void *context, size_t row, size_t column) {
    const tower_sweep *tower = context;
    double t = (double)row / (double)tower->grid.rows, c = (double)column / (double)tower->grid.columns;
    kdr_turn angle = kdr_turn_of(c);
    double sine = angle.sine < 0 ? -angle.sine : angle.sine, cosine = angle.cosine < 0 ? -angle.cosine : angle.cosine;
    double radius = (0.62 - 0.2 * t) / (sine > cosine ? sine : cosine);
    if (is_slab(row) || (row > 0 && is_slab(row - 1)))
        radius *= 1.07;
    kdr_turn turn = kdr_turn_of(c + tower->twist * t);
    return (kdr_point){radius * turn.sine, TOWER_HEIGHT * t, radius * turn.cosine};
}

static void draw_twist(kdr_shape *shape, size_t triangle_count, double time) {
    // The roof is a fan over the last row: one triangle a column.
    size_t rim = triangle_count < 5000 ? 8 : 64;
    kdr_grid grid = kdr_grid_fit(triangle_count - rim, 1.3, 4, 4);
    grid = kdr_grid_fit(triangle_count - rim - grid.columns, 1.3, 4, 4);
    grid.around = true;
    shape->material = TWIST_GLASS;
    tower_sweep tower = {grid, 0.4 * kdr_turn_of(kdr_phase(time, TWIST_PERIOD) + 0.12).sine};
    size_t first_vertex = shape->vertex_count, first_triangle = shape->triangle_count;
    kdr_shape_grid(shape, grid, tower_point, &tower);

    uint32_t last_row = (uint32_t)(first_vertex + grid.rows * grid.columns);
    shape->material = TWIST_ROOF;
    uint32_t peak = kdr_shape_vertex(shape, (kdr_point){0, TOWER_HEIGHT * 1.06, 0}, (kdr_point){0, 1, 0});
    for (uint32_t c = 0; c < grid.columns; c++)
        kdr_shape_triangle(shape, peak, last_row + c, last_row + (c + 1) % (uint32_t)grid.columns);

    if (!kdr_shape_counts(shape))
        for (size_t i = 0; i < 2 * grid.rows * grid.columns; i++)
            shape->materials[first_triangle + i] = is_slab(i / (2 * grid.columns)) ? TWIST_SLAB : TWIST_GLASS;

    // The ground takes up what the tower leaves over.
    size_t left = triangle_count > shape->triangle_count ? triangle_count - shape->triangle_count : 0;
    shape->material = TWIST_GROUND;
    kdr_frame ground = kdr_frame_at((kdr_point){0, 0, 0}, 1.3);
    kdr_shape_disc(shape, &ground, left < 6 ? 6 : left);
}

const kdr_recipe kdr_recipe_twist = {
    .name = "twist",
    .text = "moving: a tower that twists to and fro every 8 s",
    .default_count = 50000,
    .traits = KDR_SCENE_MOVING,
    .draw = draw_twist,
    KDR_RECIPE_MATERIALS(twist_materials),
};
