/* A square full of people who walk, each on a circle and at a pace of their own, before a town that stands still.
 * Lengths in metres, but for the town, which counts in lots. */
#include "scenes/parts.h"

enum {
    SKIN = KDR_CITY_MATERIAL_COUNT,
    SHIRTS = SKIN + 2,
    SHIRT_COUNT = 5,
    TROUSERS = SHIRTS + SHIRT_COUNT,
    TROUSER_COUNT = 3
};

static const kdr_recipe_material materials[] = {
    KDR_CITY_MATERIALS,
    {"fair skin", {0.75f, 0.48f, 0.36f}},
    {"dark skin", {0.28f, 0.14f, 0.08f}},
    {"red shirt", {0.65f, 0.08f, 0.07f}},
    {"blue shirt", {0.10f, 0.22f, 0.60f}},
    {"green shirt", {0.10f, 0.42f, 0.16f}},
    {"yellow shirt", {0.85f, 0.62f, 0.08f}},
    {"white shirt", {0.80f, 0.80f, 0.78f}},
    {"jeans", {0.07f, 0.10f, 0.24f}},
    {"black trousers", {0.04f, 0.04f, 0.05f}},
    {"khaki trousers", {0.40f, 0.34f, 0.20f}},
};

#define FIGURE_PARTS 10
#define STEP_PERIOD 1.1

typedef struct figure {
    kdr_frame ground; /* where the figure stands: y up, z where it looks */
    kdr_turn swing;   /* of the left leg */
    uint32_t skin, shirt, trousers;
} figure;

static figure walker_at(size_t i, size_t side, double time) {
    kdr_chance chance = kdr_chance_of(12, i);
    double size = (double)side;
    kdr_point middle = {1.3 * ((double)(i % side) + 0.5 - size / 2), 0, 1.3 * ((double)(i / side) + 0.5 - size / 2)};
    double radius = kdr_chance_between(&chance, 0.8, 3), pace = kdr_chance_between(&chance, 0.9, 1.6);
    double start = kdr_chance_unit(&chance), step = kdr_chance_unit(&chance);
    double direction = kdr_chance_unit(&chance) < 0.5 ? -1 : 1;
    double turns = start + direction * kdr_phase(time, 6.283185307179586 * radius / pace);
    kdr_turn turn = kdr_turn_of(turns);

    figure walker;
    walker.ground = kdr_frame_at(kdr_point_add(middle, (kdr_point){radius * turn.sine, 0, radius * turn.cosine}), 1);
    walker.ground = kdr_frame_turn_y(walker.ground, turns + 0.25 * direction);
    walker.swing = kdr_turn_of(kdr_phase(time, STEP_PERIOD * 1.3 / pace) + step);
    walker.skin = SKIN + kdr_chance_below(&chance, 2);
    walker.shirt = SHIRTS + kdr_chance_below(&chance, SHIRT_COUNT);
    walker.trousers = TROUSERS + kdr_chance_below(&chance, TROUSER_COUNT);
    return walker;
}

/* A limb hangs down from its joint; returns the joint at its other end, in the limb's direction. */
static kdr_frame draw_limb(kdr_shape *shape, kdr_frame joint, double length, double radius, kdr_ball ball) {
    kdr_frame middle = joint;
    middle.origin = kdr_point_along(joint.origin, joint.y, -length / 2);
    middle = kdr_frame_stretch(middle, radius, length / 2 + radius * 0.7, radius);
    kdr_shape_ball(shape, &middle, ball, NULL);
    joint.origin = kdr_point_along(joint.origin, joint.y, -length);
    return joint;
}

static kdr_frame joint_at(const figure *walker, double x, double y, double bend) {
    kdr_frame joint = walker->ground;
    joint.origin = kdr_frame_point(&walker->ground, x, y, 0);
    return kdr_frame_turn_x(joint, bend);
}

static void draw_figure(kdr_shape *shape, const figure *walker, kdr_ball ball) {
    if (kdr_shape_counts(shape)) {
        kdr_shape_skip(shape, FIGURE_PARTS * kdr_ball_vertices(ball), FIGURE_PARTS * kdr_ball_triangles(ball));
        return;
    }
    double lift = 0.03 * walker->swing.sine * walker->swing.sine;
    for (int side = -1; side <= 1; side += 2) {
        double swing = side * walker->swing.sine;
        double bend = 0.03 + 0.07 * (1 + side * walker->swing.cosine) / 2;
        shape->material = walker->trousers;
        kdr_frame knee = draw_limb(shape, joint_at(walker, 0.10 * side, 0.94 - lift, -0.075 * swing), 0.45, 0.09, ball);
        draw_limb(shape, kdr_frame_turn_x(knee, bend), 0.46, 0.065, ball);
        shape->material = walker->shirt;
        kdr_frame elbow = draw_limb(shape, joint_at(walker, 0.25 * side, 1.44 - lift, 0.06 * swing), 0.29, 0.06, ball);
        shape->material = walker->skin;
        draw_limb(shape, kdr_frame_turn_x(elbow, -0.05), 0.28, 0.045, ball);
    }

    kdr_frame body = kdr_frame_stretch(joint_at(walker, 0, 1.20 - lift, 0), 0.21, 0.34, 0.14);
    shape->material = walker->shirt;
    kdr_shape_ball(shape, &body, ball, NULL);
    kdr_frame head = kdr_frame_stretch(joint_at(walker, 0, 1.68 - lift, 0), 0.10, 0.14, 0.12);
    shape->material = walker->skin;
    kdr_shape_ball(shape, &head, ball, NULL);
}

/* Draws a city in lots of `size` metres: lots first, then all of it is stretched. */
static void draw_town(kdr_shape *shape, const kdr_city *city, double size, size_t triangles) {
    size_t first = shape->vertex_count;
    kdr_draw_city(shape, city, triangles);
    if (!kdr_shape_counts(shape))
        for (size_t i = 3 * first; i < 3 * shape->vertex_count; i++)
            shape->positions[i] *= (float)size;
}

static void draw(kdr_shape *shape, size_t triangle_count, double time) {
    kdr_ball ball = triangle_count < 2000     ? (kdr_ball){3, 1}
                    : triangle_count < 20000  ? (kdr_ball){4, 1}
                    : triangle_count < 500000 ? (kdr_ball){4, 2}
                                              : (kdr_ball){5, 3};
    size_t figure_triangles = FIGURE_PARTS * kdr_ball_triangles(ball);
    size_t figures = triangle_count * 7 / 10 / figure_triangles;
    size_t side = (size_t)sqrt((double)figures);
    side += side * side < figures;
    for (size_t i = 0; i < figures; i++) {
        figure walker = walker_at(i, side, time);
        draw_figure(shape, &walker, ball);
    }

    // The town stands behind the square and, where there are triangles for it, along its left.
    size_t left = triangle_count - figures * figure_triangles - 2;
    uint32_t lots = left < 300 ? 2 : left < 3000 ? 4 : 6;
    double half = 0.65 * (double)side + 3, lot = 2 * half / lots;
    shape->material = KDR_CITY_PAVEMENT;
    double far = half + 2 * lot;
    kdr_shape_quad(shape, (kdr_point){-far, 0, half}, (kdr_point){far + half, 0, 0}, (kdr_point){0, 0, -far - half});
    double middle = lots / 2.0;
    kdr_city behind = {
        .corner = {-middle, 0, -middle - 1},
        .columns = lots,
        .rows = 1,
        .height = 1.3,
        .centre_z = -middle,
        .reach = 2.0 * lots,
        .seed = 13,
    };
    if (lots == 2) {
        draw_town(shape, &behind, lot, left);
        return;
    }
    behind.corner = (kdr_point){-middle - 2, 0, -middle - 2};
    behind.columns = lots + 2;
    behind.rows = 2;
    kdr_city beside = behind;
    beside.corner = (kdr_point){-middle - 2, 0, -middle};
    beside.columns = 2;
    beside.rows = lots;
    beside.seed = 15;
    draw_town(shape, &behind, lot, left / 2);
    draw_town(shape, &beside, lot, left - left / 2);
}

const kdr_recipe kdr_recipe_crowd = {
    .name = "crowd",
    .text = "moving: people who walk about a square, before a town that stands still",
    .default_count = 150000,
    .traits = KDR_SCENE_SMOOTH | KDR_SCENE_MOVING,
    .draw = draw,
    KDR_RECIPE_MATERIALS(materials),
};
