/* Strands: blades of grass, and the hairball, where every box of every hair overlaps many others. */
#include "scenes/parts.h"

#define BLADE_SEGMENTS 3
#define BLADE_TRIANGLES (2 * BLADE_SEGMENTS - 1)

static const kdr_recipe_material grass_materials[] = {
    {"earth", {0.16f, 0.11f, 0.06f}},     {"young blade", {0.35f, 0.55f, 0.10f}}, {"blade", {0.16f, 0.42f, 0.07f}},
    {"old blade", {0.08f, 0.28f, 0.06f}}, {"dry blade", {0.58f, 0.50f, 0.18f}},
};

/* A strip that narrows to a point and leans over more and more. */
static void draw_blade(kdr_shape *shape, kdr_point root, double width, kdr_chance *chance) {
    kdr_turn turn = kdr_turn_of(kdr_chance_unit(chance));
    kdr_point lean = {turn.cosine, 0, turn.sine};
    kdr_turn across_turn = kdr_turn_of(kdr_chance_unit(chance));
    kdr_point across = {across_turn.cosine, 0, across_turn.sine};
    double height = kdr_chance_between(chance, 0.25, 0.6), bend = kdr_chance_between(chance, 0.03, 0.35);

    uint32_t left = 0, right = 0;
    for (int i = 0; i <= BLADE_SEGMENTS; i++) {
        double t = (double)i / BLADE_SEGMENTS;
        kdr_point place = kdr_point_along(root, lean, bend * t * t);
        place.y += height * t * (1 - 0.3 * bend * t);
        kdr_point normal = {0, 1, 0};
        if (shape->normals)
            normal = kdr_point_unit((kdr_point){-lean.x * height, 2 * bend * t + 0.3, -lean.z * height});
        if (i == BLADE_SEGMENTS) {
            uint32_t tip = kdr_shape_vertex(shape, place, normal);
            kdr_shape_triangle(shape, left, right, tip);
            return;
        }
        double half = width * (1 - 0.8 * t * t);
        uint32_t low_left = left, low_right = right;
        left = kdr_shape_vertex(shape, kdr_point_along(place, across, -half), normal);
        right = kdr_shape_vertex(shape, kdr_point_along(place, across, half), normal);
        if (i > 0) {
            kdr_shape_triangle(shape, low_left, low_right, right);
            kdr_shape_triangle(shape, low_left, right, left);
        }
    }
}

static void draw_grass(kdr_shape *shape, size_t triangle_count, double time) {
    (void)time;
    size_t rim = triangle_count < 5000 ? 10 : 60;
    shape->material = 0;
    kdr_frame earth = kdr_frame_at((kdr_point){0, 0, 0}, 1.05);
    kdr_shape_disc(shape, &earth, rim);

    size_t blade_count = (triangle_count - rim) / BLADE_TRIANGLES;
    if (kdr_shape_counts(shape)) {
        kdr_shape_skip(shape, (2 * BLADE_SEGMENTS + 1) * blade_count, BLADE_TRIANGLES * blade_count);
        return;
    }
    double spacing = 1 / sqrt((double)blade_count);
    for (size_t i = 0; i < blade_count; i++) {
        kdr_chance chance = kdr_chance_of(2, i);
        double away = sqrt(((double)i + kdr_chance_unit(&chance)) / (double)blade_count);
        kdr_turn turn = kdr_turn_of((double)i * 0.38196601125 + kdr_chance_unit(&chance) * spacing);
        kdr_point root = {away * turn.cosine, 0, away * turn.sine};
        double dry = kdr_chance_unit(&chance);
        shape->material = dry < 0.06 ? 4 : 1 + kdr_chance_below(&chance, 3);
        draw_blade(shape, root, 0.004 + 0.4 * spacing, &chance);
    }
}

const kdr_recipe kdr_recipe_grass = {
    .name = "grass",
    .text = "a round meadow of bent blades",
    .default_count = 150000,
    .traits = KDR_SCENE_SMOOTH,
    .draw = draw_grass,
    KDR_RECIPE_MATERIALS(grass_materials),
};

#define HAIR_SIDES 3

static const kdr_recipe_material hair_materials[] = {
    {"fair hair", {0.70f, 0.50f, 0.25f}},
    {"red hair", {0.50f, 0.18f, 0.06f}},
    {"brown hair", {0.25f, 0.12f, 0.06f}},
};

typedef struct hair_strand {
    kdr_frame frame; /* y points away from the middle */
    double radius, curl, waves, shift;
    size_t segments;
} hair_strand;

static kdr_point hair_point(const void *context, size_t row, size_t column) {
    const hair_strand *hair = context;
    double t = (double)row / (double)hair->segments;
    kdr_turn wave = kdr_turn_of(hair->waves * t + hair->shift);
    kdr_turn side = kdr_turn_of(-(double)column / HAIR_SIDES);
    double thickness = hair->radius * (1.02 - t);
    return kdr_frame_point(&hair->frame, hair->curl * t * wave.sine + thickness * side.sine,
                           0.04 + 0.96 * t * (1.3 - 0.3 * t), hair->curl * t * wave.cosine + thickness * side.cosine);
}

static void draw_hair(kdr_shape *shape, size_t triangle_count, double time) {
    (void)time;
    size_t segments = triangle_count / 400 < 2 ? 2 : triangle_count / 400 > 24 ? 24 : triangle_count / 400;
    size_t hair_triangles = 2 * HAIR_SIDES * segments;
    size_t hair_count = (triangle_count + hair_triangles / 2) / hair_triangles;
    for (size_t i = 0; i < hair_count; i++) {
        kdr_chance chance = kdr_chance_of(3, i);
        hair_strand hair = {.segments = segments, .radius = 0.002 + 0.2 / sqrt((double)hair_count)};
        hair.frame = kdr_frame_along((kdr_point){0, 0, 0}, kdr_chance_direction(&chance));
        hair.curl = kdr_chance_between(&chance, 0.05, 0.45);
        hair.waves = kdr_chance_between(&chance, -1.5, 1.5);
        hair.shift = kdr_chance_unit(&chance);
        shape->material = kdr_chance_below(&chance, 3);
        kdr_grid grid = {.rows = segments, .columns = HAIR_SIDES, .around = true};
        kdr_shape_grid(shape, grid, hair_point, &hair);
    }
}

const kdr_recipe kdr_recipe_hair = {
    .name = "hair",
    .text = "a hairball: curly tubes out of one middle, all boxes overlapping",
    .default_count = 150000,
    .traits = KDR_SCENE_SMOOTH,
    .draw = draw_hair,
    KDR_RECIPE_MATERIALS(hair_materials),
};
