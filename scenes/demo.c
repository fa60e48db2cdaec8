/* The picture that introduces the project: a sphere flake on a round chequered floor, knots around it and an old town
 * of towers behind. */
#include "scenes/parts.h"

enum { TILE_LIGHT = KDR_CITY_MATERIAL_COUNT, TILE_DARK, RIM, KNOTS, KNOT_COUNT = 5, FLAKE = KNOTS + KNOT_COUNT, FLAKE_COUNT = 5 };

static const kdr_recipe_material materials[] = {
    KDR_CITY_MATERIALS,
    {"light tile", {0.62f, 0.60f, 0.55f}}, {"dark tile", {0.16f, 0.17f, 0.20f}}, {"rim", {0.30f, 0.24f, 0.18f}},
    {"brass", {0.70f, 0.46f, 0.10f}}, {"jade", {0.10f, 0.45f, 0.26f}}, {"cobalt", {0.08f, 0.18f, 0.58f}},
    {"coral", {0.78f, 0.24f, 0.16f}}, {"pearl", {0.74f, 0.72f, 0.70f}},
    {"flake 1", {0.74f, 0.14f, 0.05f}}, {"flake 2", {0.84f, 0.34f, 0.06f}}, {"flake 3", {0.90f, 0.56f, 0.12f}},
    {"flake 4", {0.90f, 0.74f, 0.34f}}, {"flake 5", {0.88f, 0.86f, 0.78f}},
};

#define FLOOR_RADIUS 3.4

/* Rings of tiles, light and dark in turn, about as deep as wide. */
static void draw_floor(kdr_shape *shape, size_t rings, size_t sectors) {
    for (size_t ring = 0; ring < rings; ring++)
        for (size_t i = 0; i < sectors; i++) {
            double low = FLOOR_RADIUS * (0.06 + 0.94 * (double)ring / (double)rings);
            double high = FLOOR_RADIUS * (0.06 + 0.94 * (double)(ring + 1) / (double)rings);
            kdr_turn from = kdr_turn_of((double)i / (double)sectors), to = kdr_turn_of((double)(i + 1) / (double)sectors);
            shape->material = (ring + i) % 2 ? TILE_LIGHT : TILE_DARK;
            kdr_shape_quad_corners(shape, (kdr_point){low * from.sine, 0, low * from.cosine},
                                   (kdr_point){high * from.sine, 0, high * from.cosine},
                                   (kdr_point){high * to.sine, 0, high * to.cosine},
                                   (kdr_point){low * to.sine, 0, low * to.cosine});
        }
}

static void draw(kdr_shape *shape, size_t triangle_count, double time) {
    (void)time;
    bool small = triangle_count < 5000;
    draw_floor(shape, small ? 2 : 12, small ? 3 : 48);

    size_t knots = small ? 1 : KNOT_COUNT;
    for (size_t i = 0; i < knots; i++) {
        kdr_turn turn = kdr_turn_of((double)i / 10.0 - 0.12);
        kdr_frame frame = kdr_frame_at((kdr_point){2.55 * turn.sine, 0.42, 2.55 * turn.cosine}, 0.42);
        frame = kdr_frame_turn_x(kdr_frame_turn_y(frame, (double)i / 10.0), 0.22);
        shape->material = KNOTS + (uint32_t)i;
        kdr_draw_knot(shape, &frame, triangle_count / (small ? 8 : 25), 2, 3 + 2 * (int)(i % 2));
    }

    kdr_frame root = kdr_frame_at((kdr_point){0, 1, 0}, 1);
    kdr_draw_flake(shape, &root, triangle_count - shape->triangle_count, FLAKE, FLAKE_COUNT);
}

const kdr_recipe kdr_recipe_demo = {
    .name = "demo",
    .text = "the picture of the README: a sphere flake, knots and towers on a chequered floor",
    .default_count = 500000,
    .traits = KDR_SCENE_SMOOTH,
    .draw = draw,
    KDR_RECIPE_MATERIALS(materials),
};
