/* The teapot in the stadium: two thirds of all triangles within a few hand's breadths on the kick-off spot of a ground
 * that is 200 m long. A tree that cannot adapt spends all its depth on the stands. Lengths in metres. */
#include "scenes/scenes.h"

enum { TURF, STANDS, CHINA };

static const kdr_recipe_material materials[] = {
    {"turf", {0.12f, 0.36f, 0.08f}},
    {"stands", {0.50f, 0.50f, 0.52f}},
    {"china", {0.75f, 0.76f, 0.80f}},
};

#define TURF_RADIUS 52.0
#define STANDS_DEPTH 45.0
#define STANDS_HEIGHT 17.0

/* Treads and risers in turn; the last row is the outer wall, down to the ground. */
static kdr_point stands_point(const void *context, size_t row, size_t column) {
    const kdr_grid *grid = context;
    double steps = (double)((grid->rows - 1) / 2);
    double out = (double)((row + 1) / 2) / steps, up = (double)(row / 2) / steps;
    kdr_turn turn = kdr_turn_of((double)column / (double)grid->columns);
    if (row == grid->rows)
        out = 1.08, up = 0;
    double radius = TURF_RADIUS + STANDS_DEPTH * out;
    return (kdr_point){1.25 * radius * turn.cosine, 0.8 + STANDS_HEIGHT * up * (0.6 + 0.4 * up), radius * turn.sine};
}

/* Turned profile of pot and lid, as radius and height; a smooth curve runs through the points. */
static const double profile[][2] = {
    {0.0010, 0.000}, {0.090, 0.000}, {0.105, 0.008}, {0.135, 0.035},  {0.150, 0.075}, {0.143, 0.115},
    {0.115, 0.150},  {0.088, 0.165}, {0.084, 0.172}, {0.078, 0.176},  {0.045, 0.190}, {0.016, 0.195},
    {0.014, 0.205},  {0.024, 0.215}, {0.020, 0.227}, {0.0005, 0.230},
};
#define PROFILE_POINTS (sizeof profile / sizeof profile[0])

static double profile_at(double t, int axis) {
    size_t i = (size_t)t < PROFILE_POINTS - 2 ? (size_t)t : PROFILE_POINTS - 2;
    double u = t - (double)i;
    double p1 = profile[i][axis], p2 = profile[i + 1][axis];
    double p0 = i ? profile[i - 1][axis] : p1, p3 = i + 2 < PROFILE_POINTS ? profile[i + 2][axis] : p2;
    // Catmull-Rom
    return p1 + 0.5 * u * (p2 - p0 + u * (2 * p0 - 5 * p1 + 4 * p2 - p3 + u * (3 * (p1 - p2) + p3 - p0)));
}

static kdr_point pot_point(const void *context, size_t row, size_t column) {
    const kdr_grid *grid = context;
    double t = (double)row / (double)grid->rows * (PROFILE_POINTS - 1);
    double radius = profile_at(t, 0);
    kdr_turn turn = kdr_turn_of((double)column / (double)grid->columns);
    return (kdr_point){radius * turn.sine, profile_at(t, 1), radius * turn.cosine};
}

/* A tube in the plane z = 0 along a cubic Bezier curve, from one radius to another. */
typedef struct pipe {
    kdr_grid grid;
    double x[4], y[4], first_radius, last_radius;
} pipe;

static kdr_point pipe_point(const void *context, size_t row, size_t column) {
    const pipe *tube = context;
    double t = (double)row / (double)tube->grid.rows, s = 1 - t;
    double weight[4] = {s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t};
    double slope[4] = {-s * s, s * s - 2 * s * t, 2 * s * t - t * t, t * t};
    kdr_point centre = {0, 0, 0}, tangent = {0, 0, 0};
    for (int i = 0; i < 4; i++) {
        kdr_point control = {tube->x[i], tube->y[i], 0};
        centre = kdr_point_along(centre, control, weight[i]);
        tangent = kdr_point_along(tangent, control, slope[i]);
    }
    tangent = kdr_point_unit(tangent);
    kdr_turn side = kdr_turn_of((double)column / (double)tube->grid.columns);
    double radius = tube->first_radius * s + tube->last_radius * t;
    return kdr_point_along(
        (kdr_point){centre.x - tangent.y * radius * side.cosine, centre.y + tangent.x * radius * side.cosine, 0},
        (kdr_point){0, 0, 1}, radius * side.sine);
}

static void draw_pipe(kdr_shape *shape, pipe tube, size_t triangles) {
    tube.grid = kdr_grid_fit(triangles, 1.5, 2, 3);
    tube.grid.around = true;
    kdr_shape_grid(shape, tube.grid, pipe_point, &tube);
}

static void draw(kdr_shape *shape, size_t triangle_count, double time) {
    (void)time;
    shape->material = TURF;
    kdr_frame turf =
        kdr_frame_stretch(kdr_frame_at((kdr_point){0, 0, 0}, TURF_RADIUS + STANDS_DEPTH * 1.15), 1.25, 1, 1);
    kdr_shape_disc(shape, &turf, triangle_count < 5000 ? 6 : 96);

    shape->material = STANDS;
    kdr_grid stands = kdr_grid_fit(triangle_count * 3 / 10, 0.25, 3, 5);
    stands.rows -= stands.rows % 2 == 0;
    stands.around = true;
    kdr_shape_grid(shape, stands, stands_point, &stands);

    shape->material = CHINA;
    draw_pipe(shape, (pipe){{0}, {0.13, 0.20, 0.18, 0.24}, {0.06, 0.06, 0.13, 0.17}, 0.030, 0.013},
              triangle_count / 10);
    draw_pipe(shape, (pipe){{0}, {-0.12, -0.26, -0.24, -0.14}, {0.15, 0.16, 0.04, 0.05}, 0.012, 0.012},
              triangle_count / 10);
    size_t left = triangle_count - shape->triangle_count;
    kdr_grid pot = kdr_grid_fit(left, 0.8, 4, 3);
    pot.around = true;
    kdr_shape_grid(shape, pot, pot_point, &pot);
}

const kdr_recipe kdr_recipe_stadium = {
    .name = "stadium",
    .text = "a finely made teapot on the kick-off spot of an empty stadium",
    .default_count = 100000,
    .traits = 0,
    .draw = draw,
    KDR_RECIPE_MATERIALS(materials),
};
