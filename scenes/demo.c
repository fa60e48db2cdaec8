/* The picture that introduces the project: a sphere flake on a pedestal, amid knots on a round chequered floor. */
#include "scenes/parts.h"

enum { TILE_LIGHT, TILE_DARK, PEDESTAL, KNOTS, KNOT_COLOURS = 6, FLAKE = KNOTS + KNOT_COLOURS, FLAKE_COLOURS = 5 };

static const kdr_recipe_material materials[] = {
    {"light tile", {0.62f, 0.60f, 0.55f}}, {"dark tile", {0.13f, 0.14f, 0.17f}}, {"pedestal", {0.42f, 0.38f, 0.34f}},
    {"brass", {0.72f, 0.46f, 0.08f}},      {"jade", {0.06f, 0.42f, 0.22f}},      {"cobalt", {0.05f, 0.14f, 0.56f}},
    {"coral", {0.78f, 0.20f, 0.14f}},      {"pearl", {0.74f, 0.72f, 0.70f}},     {"violet", {0.32f, 0.10f, 0.46f}},
    {"flake 1", {0.66f, 0.06f, 0.03f}},    {"flake 2", {0.80f, 0.24f, 0.04f}},   {"flake 3", {0.88f, 0.48f, 0.08f}},
    {"flake 4", {0.90f, 0.70f, 0.26f}},    {"flake 5", {0.90f, 0.88f, 0.78f}},
};

#define FLOOR_RADIUS 2.35
#define KNOT_DISTANCE 1.95
#define PEDESTAL_HEIGHT 0.5

/* Rings of tiles, light and dark in turn. */
static void draw_floor(kdr_shape *shape, size_t rings, size_t sectors) {
    for (size_t ring = 0; ring < rings; ring++)
        for (size_t i = 0; i < sectors; i++) {
            double low = FLOOR_RADIUS * (0.1 + 0.9 * (double)ring / (double)rings);
            double high = FLOOR_RADIUS * (0.1 + 0.9 * (double)(ring + 1) / (double)rings);
            kdr_turn from = kdr_turn_of((double)i / (double)sectors);
            kdr_turn to = kdr_turn_of((double)(i + 1) / (double)sectors);
            shape->material = (ring + i) % 2 ? TILE_LIGHT : TILE_DARK;
            kdr_shape_quad_corners(shape, (kdr_point){low * from.sine, 0, low * from.cosine},
                                   (kdr_point){high * from.sine, 0, high * from.cosine},
                                   (kdr_point){high * to.sine, 0, high * to.cosine},
                                   (kdr_point){low * to.sine, 0, low * to.cosine});
        }
}

/* Three drums, one upon the other. */
static void draw_pedestal(kdr_shape *shape, uint32_t sides) {
    static const double drums[][3] = {{0.80, 0, 0.10}, {0.50, 0.10, 0.40}, {0.66, 0.40, PEDESTAL_HEIGHT}};
    shape->material = PEDESTAL;
    for (size_t i = 0; i < sizeof drums / sizeof drums[0]; i++) {
        double radius = drums[i][0];
        kdr_frame low = kdr_frame_at((kdr_point){0, drums[i][1], 0}, radius);
        kdr_frame high = kdr_frame_at((kdr_point){0, drums[i][2], 0}, radius);
        kdr_shape_tube(shape, &low, &high, sides);
        if (i != 1)
            kdr_shape_disc(shape, &high, sides);
    }
}

static void draw_knots(kdr_shape *shape, size_t count, size_t triangles) {
    for (size_t i = 0; i < count; i++) {
        double around = ((double)i + 0.3) / (double)count;
        kdr_turn turn = kdr_turn_of(around);
        kdr_frame frame = kdr_frame_at((kdr_point){KNOT_DISTANCE * turn.sine, 0.33, KNOT_DISTANCE * turn.cosine}, 0.33);
        frame = kdr_frame_turn_x(kdr_frame_turn_y(frame, around), 0.23);
        shape->material = KNOTS + (uint32_t)i % KNOT_COLOURS;
        kdr_draw_knot(shape, &frame, triangles / count, 2, 3 + 2 * (int)(i % 2));
    }
}

/* In small sizes the knots are left out, and the floor takes up what the flake leaves over. */
static void draw(kdr_shape *shape, size_t triangle_count, double time) {
    (void)time;
    bool small = triangle_count < 5000;
    size_t rings = small ? 1 : 9, sectors = small ? 4 : 48;
    draw_pedestal(shape, small ? 3 : 64);
    if (!small)
        draw_knots(shape, 12, triangle_count * 3 / 10);
    kdr_frame root = kdr_frame_at((kdr_point){0, 1 + PEDESTAL_HEIGHT, 0}, 1);
    size_t flake = triangle_count - shape->triangle_count - 2 * rings * sectors;
    kdr_draw_flake(shape, &root, flake, FLAKE, FLAKE_COLOURS);

    size_t left = triangle_count > shape->triangle_count ? triangle_count - shape->triangle_count : 0;
    if (small && left / 2 > sectors)
        sectors = left / 2;
    draw_floor(shape, rings, sectors);
}

const kdr_recipe kdr_recipe_demo = {
    .name = "demo",
    .text = "the picture of the README: a sphere flake on a pedestal, amid knots on a chequered floor",
    .default_count = 500000,
    .traits = KDR_SCENE_SMOOTH,
    .draw = draw,
    KDR_RECIPE_MATERIALS(materials),
};
