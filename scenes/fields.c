/* Height fields: a block of land with mountains, closed all around, and a sheet of water in motion. */
#include "scenes/chance.h"
#include "scenes/scenes.h"

/* Value noise: random heights at whole coordinates, blended smoothly in between. In [0, 1). */
static double lattice(int64_t x, int64_t z) {
    kdr_chance chance = {(uint64_t)x * 0x9e3779b97f4a7c15u ^ (uint64_t)z * 0xd1b54a32d192ed03u};
    return kdr_chance_unit(&chance);
}

static double noise(double x, double z) {
    double floor_x = floor(x), floor_z = floor(z);
    int64_t i = (int64_t)floor_x, k = (int64_t)floor_z;
    double u = x - floor_x, v = z - floor_z;
    u = u * u * (3 - 2 * u), v = v * v * (3 - 2 * v);
    double low = lattice(i, k) * (1 - u) + lattice(i + 1, k) * u;
    double high = lattice(i, k + 1) * (1 - u) + lattice(i + 1, k + 1) * u;
    return low * (1 - v) + high * v;
}

typedef struct height_field {
    size_t rows, columns;
    double time;
} height_field;

/* Ridges come from folding the noise: |2 n - 1| is sharp where n passes through one half. */
static double terrain_height(double x, double z) {
    double height = 0, size = 0.5, frequency = 2.2;
    for (int octave = 0; octave < 6; octave++) {
        double n = 2 * noise(x * frequency + 7.3 * octave + 3.1, z * frequency + 3.7 * octave + 1.9) - 1;
        height += size * (1 - (n < 0 ? -n : n));
        size *= 0.48;
        frequency *= 2.07;
    }
    double edge = (1 - x * x) * (1 - z * z);
    return (height - 0.35) * (0.25 + 0.75 * edge);
}

static kdr_point field_place(const height_field *field, size_t row, size_t column, double *x, double *z) {
    *x = 2 * (double)row / (double)field->rows - 1;
    *z = 2 * (double)column / (double)field->columns - 1;
    return (kdr_point){*x, 0, *z};
}

static kdr_point terrain_point(const void *context, size_t row, size_t column) {
    double x, z;
    kdr_point place = field_place(context, row, column, &x, &z);
    place.y = terrain_height(x, z);
    return place;
}

enum { EARTH, MEADOW, ROCK, SNOW };

static const kdr_recipe_material terrain_materials[] = {
    {"earth", {0.30f, 0.20f, 0.12f}},
    {"meadow", {0.20f, 0.36f, 0.10f}},
    {"rock", {0.38f, 0.34f, 0.30f}},
    {"snow", {0.90f, 0.92f, 0.95f}},
};

/* Steep is rock, high is snow. */
static void colour_terrain(kdr_shape *shape) {
    if (kdr_shape_counts(shape))
        return;
    for (size_t i = 0; i < shape->triangle_count; i++) {
        size_t vertex = shape->indices[3 * i];
        float height = shape->positions[3 * vertex + 1], upright = shape->normals[3 * vertex + 1];
        shape->materials[i] = height > 0.42f && upright > 0.45f   ? SNOW
                              : upright > 0.72f && height < 0.36f ? MEADOW
                                                                  : ROCK;
    }
}

/* Vertex k of the border, in the direction in which the land's own triangles pass it. */
static uint32_t border_vertex(const height_field *field, size_t k) {
    size_t rows = field->rows, columns = field->columns, row, column;
    k %= 2 * (rows + columns);
    if (k < columns)
        row = 0, column = k;
    else if (k < columns + rows)
        row = k - columns, column = columns;
    else if (k < 2 * columns + rows)
        row = rows, column = 2 * columns + rows - k;
    else
        row = 2 * (rows + columns) - k, column = 0;
    return (uint32_t)(row * (columns + 1) + column);
}

/* Side walls down to a floor, and the floor. */
static void close_terrain(kdr_shape *shape, const height_field *field) {
    size_t border = 2 * (field->rows + field->columns);
    if (kdr_shape_counts(shape)) {
        kdr_shape_skip(shape, border + 1, 3 * border);
        return;
    }
    shape->material = EARTH;
    uint32_t first = (uint32_t)shape->vertex_count;
    uint32_t middle = first + (uint32_t)border;
    for (size_t k = 0; k < border; k++) {
        const float *above = shape->positions + 3 * (size_t)border_vertex(field, k);
        kdr_point outwards = {above[0] < 0 ? -1 : 1, 0, 0};
        if (above[2] * above[2] > above[0] * above[0])
            outwards = (kdr_point){0, 0, above[2] < 0 ? -1 : 1};
        kdr_shape_vertex(shape, (kdr_point){above[0], -0.25, above[2]}, outwards);
    }
    kdr_shape_vertex(shape, (kdr_point){0, -0.25, 0}, (kdr_point){0, -1, 0});
    for (size_t k = 0; k < border; k++) {
        uint32_t a = border_vertex(field, k), b = border_vertex(field, k + 1);
        uint32_t below_a = first + (uint32_t)k, below_b = first + (uint32_t)((k + 1) % border);
        kdr_shape_triangle(shape, b, a, below_a);
        kdr_shape_triangle(shape, b, below_a, below_b);
        kdr_shape_triangle(shape, below_b, below_a, middle);
    }
}

/* The border costs three triangles for each of its edges: 2 rows columns + 6 (rows + columns) in all. */
static height_field fit_terrain(size_t triangles) {
    size_t ideal = (size_t)sqrt((double)triangles / 2);
    height_field best = {0};
    size_t best_error = SIZE_MAX;
    for (size_t rows = ideal > 6 ? ideal - 6 : 2; rows <= ideal; rows++) {
        size_t columns = (triangles - 6 * rows + rows + 3) / (2 * rows + 6);
        size_t count = 2 * rows * columns + 6 * (rows + columns);
        size_t error = count > triangles ? count - triangles : triangles - count;
        if (error < best_error) {
            best_error = error;
            best = (height_field){rows, columns, 0};
        }
    }
    return best;
}

static void draw_terrain(kdr_shape *shape, size_t triangle_count, double time) {
    (void)time;
    height_field field = fit_terrain(triangle_count);
    kdr_shape_grid(shape, (kdr_grid){.rows = field.rows, .columns = field.columns}, terrain_point, &field);
    colour_terrain(shape);
    close_terrain(shape, &field);
}

const kdr_recipe kdr_recipe_terrain = {
    .name = "terrain",
    .text = "a block of land with mountains, closed at the sides and below",
    .default_count = 150000,
    .traits = KDR_SCENE_SMOOTH | KDR_SCENE_CLOSED,
    .draw = draw_terrain,
    KDR_RECIPE_MATERIALS(terrain_materials),
};

/* Four trains of waves, each with its own direction, length, height and period in seconds. */
static const struct wave_train {
    double x, z, height, period;
} trains[] = {{1.1, 0.3, 0.06, 4}, {-0.4, 1.7, 0.035, 3}, {2.6, 2.1, 0.018, 2.2}, {-4.1, 3.3, 0.01, 1.5}};

static kdr_point wave_point(const void *context, size_t row, size_t column) {
    const height_field *field = context;
    double x, z;
    kdr_point place = field_place(field, row, column, &x, &z);
    for (size_t i = 0; i < sizeof trains / sizeof trains[0]; i++) {
        double phase = kdr_phase(field->time, trains[i].period);
        place.y += trains[i].height * kdr_turn_of(x * trains[i].x + z * trains[i].z - phase).sine;
    }
    // A ring that spreads from the middle and fades.
    double away = sqrt(x * x + z * z);
    place.y += 0.13 / (1 + 6 * away) * kdr_turn_of(3 * away - kdr_phase(field->time, 1.8)).cosine;
    return place;
}

static const kdr_recipe_material wave_materials[] = {{"water", {0.06f, 0.26f, 0.38f}}};

static void draw_wave(kdr_shape *shape, size_t triangle_count, double time) {
    kdr_grid grid = kdr_grid_fit(triangle_count, 1, 3, 3);
    height_field field = {grid.rows, grid.columns, time};
    kdr_shape_grid(shape, grid, wave_point, &field);
}

const kdr_recipe kdr_recipe_wave = {
    .name = "wave",
    .text = "moving: a sheet of water with waves of several lengths",
    .default_count = 100000,
    .traits = KDR_SCENE_SMOOTH | KDR_SCENE_MOVING,
    .draw = draw_wave,
    KDR_RECIPE_MATERIALS(wave_materials),
};
