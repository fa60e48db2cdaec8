/* One ball in three states: smooth, swollen into bumps, and bursting. */
#include "scenes/chance.h"
#include "scenes/scenes.h"

static const kdr_recipe_material ball_materials[] = {{"enamel", {0.65f, 0.16f, 0.10f}}};

static void draw_sphere(kdr_shape *shape, size_t triangle_count, double time) {
    (void)time;
    kdr_frame frame = kdr_frame_at((kdr_point){0, 0, 0}, 1);
    kdr_shape_ball(shape, &frame, kdr_ball_fit(triangle_count), NULL);
}

const kdr_recipe kdr_recipe_sphere = {
    .name = "sphere",
    .text = "a closed sphere of triangles of about one size",
    .default_count = 100000,
    .traits = KDR_SCENE_SMOOTH | KDR_SCENE_CLOSED,
    .draw = draw_sphere,
    KDR_RECIPE_MATERIALS(ball_materials),
};

static double bumpy_radius(kdr_point unit) {
    double large = kdr_turn_of(0.7 * unit.x + 0.1).sine * kdr_turn_of(0.6 * unit.y + 0.3).sine +
                   kdr_turn_of(0.8 * unit.z + 0.6).sine * kdr_turn_of(0.5 * unit.x - 0.2).cosine;
    double small = kdr_turn_of(2.1 * unit.x).sine * kdr_turn_of(2.3 * unit.y).sine * kdr_turn_of(1.9 * unit.z).sine;
    return 1 + 0.22 * large + 0.12 * small;
}

static const kdr_recipe_material shell_materials[] = {{"jade", {0.16f, 0.48f, 0.30f}}};

static void draw_shell(kdr_shape *shape, size_t triangle_count, double time) {
    (void)time;
    kdr_frame frame = kdr_frame_at((kdr_point){0, 0, 0}, 1);
    kdr_shape_ball(shape, &frame, kdr_ball_fit(triangle_count), bumpy_radius);
}

const kdr_recipe kdr_recipe_shell = {
    .name = "shell",
    .text = "a closed blob with bumps",
    .default_count = 100000,
    .traits = KDR_SCENE_SMOOTH | KDR_SCENE_CLOSED,
    .draw = draw_shell,
    KDR_RECIPE_MATERIALS(shell_materials),
};

#define BURST_PERIOD 6.0

static const kdr_recipe_material explode_materials[] = {
    {"ember", {0.80f, 0.20f, 0.04f}},
    {"flame", {0.90f, 0.52f, 0.08f}},
    {"ash", {0.30f, 0.28f, 0.27f}},
    {"crust", {0.18f, 0.10f, 0.07f}},
};

/* One splinter: flies out on its own path, tumbling about its own middle, falls a little and comes home. */
static void draw_splinter(kdr_shape *shape, const kdr_point corners[3], kdr_chance *chance, double burst) {
    kdr_point middle = kdr_point_scale(kdr_point_add(kdr_point_add(corners[0], corners[1]), corners[2]), 1 / 3.0);
    kdr_point path = kdr_point_along(middle, kdr_chance_direction(chance), 0.6);
    double speed = kdr_chance_between(chance, 0.2, 1.6);
    kdr_frame tumble = kdr_frame_along((kdr_point){0, 0, 0}, kdr_chance_direction(chance));
    kdr_frame turned = kdr_frame_turn_y(tumble, burst * kdr_chance_between(chance, -3, 3));
    turned.origin = kdr_point_along(middle, path, speed * burst);
    turned.origin.y -= 0.5 * burst * burst;

    kdr_point moved[3];
    for (int k = 0; k < 3; k++) {
        kdr_point arm = kdr_point_sub(corners[k], middle);
        moved[k] = kdr_frame_point(&turned, kdr_point_dot(arm, tumble.x), kdr_point_dot(arm, tumble.y),
                                   kdr_point_dot(arm, tumble.z));
    }
    kdr_shape_facet(shape, moved[0], moved[1], moved[2]);
}

static void draw_explode(kdr_shape *shape, size_t triangle_count, double time) {
    kdr_ball ball = kdr_ball_fit(triangle_count);
    if (kdr_shape_counts(shape)) {
        kdr_shape_skip(shape, 3 * kdr_ball_triangles(ball), kdr_ball_triangles(ball));
        return;
    }
    double burst = (1 - kdr_turn_of(kdr_phase(time, BURST_PERIOD)).cosine) / 2;
    for (uint32_t row = 0; row < 2 * ball.level; row++)
        for (uint32_t i = 0; i < kdr_ball_strip_size(ball, row); i++) {
            kdr_ball_corner corners[3];
            kdr_point places[3];
            kdr_ball_strip_triangle(ball, row, i, corners);
            for (int k = 0; k < 3; k++)
                places[k] = kdr_ball_point(ball, corners[k].row, corners[k].column);
            kdr_chance chance = kdr_chance_of(4, shape->triangle_count);
            shape->material = kdr_chance_below(&chance, 4);
            draw_splinter(shape, places, &chance, burst);
        }
}

const kdr_recipe kdr_recipe_explode = {
    .name = "explode",
    .text = "moving: a sphere bursts, every triangle on a path of its own, and is whole again every 6 s",
    .default_count = 50000,
    .traits = KDR_SCENE_MOVING,
    .draw = draw_explode,
    KDR_RECIPE_MATERIALS(explode_materials),
};
