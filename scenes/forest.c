/* Trees of branches and leaves, each grown anew: no two are alike and none is an instance of another. */
#include "scenes/parts.h"

#define MOST_GENERATIONS 6
#define CHILDREN 3

enum { GROUND, BARK, LEAVES, LEAF_COLOURS = 4 };

static const kdr_recipe_material materials[] = {
    {"ground", {0.20f, 0.17f, 0.09f}},      {"bark", {0.24f, 0.14f, 0.07f}},
    {"spring leaf", {0.26f, 0.46f, 0.07f}}, {"summer leaf", {0.10f, 0.34f, 0.07f}},
    {"dark leaf", {0.06f, 0.24f, 0.09f}},   {"autumn leaf", {0.62f, 0.28f, 0.05f}},
};

typedef struct tree_plan {
    kdr_chance chance;
    uint32_t generations;
    uint32_t sides[MOST_GENERATIONS];
    size_t leaf_count;
    size_t tip_count;
    size_t tips_drawn;
    double leaf_size;
    uint32_t leaf_material;
} tree_plan;

/* About a third of the triangles become wood, the rest leaves of two triangles each. */
static tree_plan plan_tree(size_t triangles, kdr_chance chance) {
    tree_plan plan = {.chance = chance, .tip_count = 1};
    size_t wood = 0, branches = 1;
    for (uint32_t i = 0; i < MOST_GENERATIONS; i++, branches *= CHILDREN) {
        uint32_t sides = triangles < 400 ? 3 : i == 0 ? 8 : i == 1 ? 5 : 3;
        size_t more = 2 * sides * branches;
        if (i > 0 && (wood + more) * 3 > triangles)
            break;
        plan.sides[i] = sides;
        plan.tip_count = branches;
        plan.generations = i + 1;
        wood += more;
    }
    plan.leaf_count = triangles > wood ? (triangles - wood) / 2 : 0;
    plan.leaf_size = 2.3 / sqrt((double)plan.leaf_count + 20);
    plan.leaf_material = LEAVES + kdr_chance_below(&plan.chance, LEAF_COLOURS);
    return plan;
}

/* A pointed leaf that hangs anywhere around the outer half of a branch. */
static void draw_leaf(kdr_shape *shape, tree_plan *tree, const kdr_frame *branch, double length, double spread) {
    kdr_chance *chance = &tree->chance;
    kdr_point place = kdr_point_along(branch->origin, branch->y, length * kdr_chance_between(chance, 0.3, 1.1));
    double distance = spread * kdr_chance_unit(chance);
    place = kdr_point_along(place, kdr_chance_direction(chance), distance);
    kdr_frame frame = kdr_frame_along(place, kdr_chance_direction(chance));
    double size = tree->leaf_size * kdr_chance_between(chance, 0.6, 1);
    kdr_shape_quad_corners(shape, place, kdr_frame_point(&frame, size * 0.35, size * 0.5, 0),
                           kdr_frame_point(&frame, 0, size, 0), kdr_frame_point(&frame, size * -0.35, size * 0.5, 0));
}

static void draw_branch(kdr_shape *shape, tree_plan *tree, kdr_frame branch, double length, double radius,
                        uint32_t generation) {
    kdr_chance *chance = &tree->chance;
    kdr_frame low = kdr_frame_stretch(branch, radius, 1, radius);
    kdr_frame high = kdr_frame_stretch(branch, radius * 0.65, 1, radius * 0.65);
    high.origin = kdr_point_along(branch.origin, branch.y, length);
    shape->material = BARK;
    kdr_shape_tube(shape, &low, &high, tree->sides[generation]);

    if (generation + 1 == tree->generations) {
        size_t leaves = kdr_share(tree->leaf_count, tree->tip_count, tree->tips_drawn++);
        shape->material = tree->leaf_material;
        if (kdr_shape_counts(shape)) {
            kdr_shape_skip(shape, 4 * leaves, 2 * leaves);
            return;
        }
        double spread = 0.5 / sqrt((double)tree->tip_count) + 0.08;
        for (size_t i = 0; i < leaves; i++)
            draw_leaf(shape, tree, &branch, length, spread);
        return;
    }

    double start = kdr_chance_unit(chance);
    for (int i = 0; i < CHILDREN; i++) {
        kdr_frame child = kdr_frame_turn_y(branch, start + i / (double)CHILDREN);
        child = kdr_frame_turn_x(child, kdr_chance_between(chance, 0.06, 0.13));
        child.origin = kdr_point_along(branch.origin, branch.y, length * kdr_chance_between(chance, 0.6, 0.98));
        double shrink = kdr_chance_between(chance, 0.65, 0.85);
        draw_branch(shape, tree, child, length * shrink, radius * 0.62, generation + 1);
    }
}

/* Trees stand on a sunflower's spiral, which leaves no rows and no gaps. */
static void draw(kdr_shape *shape, size_t triangle_count, double time) {
    (void)time;
    size_t rim = triangle_count < 5000 ? 8 : 64;
    size_t tree_count = triangle_count / 2500 < 3 ? 3 : triangle_count / 2500;
    double radius = 0.42 * sqrt((double)tree_count) + 0.2;
    kdr_frame ground = kdr_frame_at((kdr_point){0, 0, 0}, radius + 0.3);
    shape->material = GROUND;
    kdr_shape_disc(shape, &ground, rim);

    for (size_t i = 0; i < tree_count; i++) {
        tree_plan tree = plan_tree(kdr_share(triangle_count - rim, tree_count, i), kdr_chance_of(1, i));
        double away = radius * sqrt(((double)i + 0.5) / (double)tree_count);
        kdr_turn turn = kdr_turn_of((double)i * 0.38196601125);
        kdr_frame root = kdr_frame_at((kdr_point){away * turn.cosine, 0, away * turn.sine}, 1);
        root = kdr_frame_turn_y(root, kdr_chance_unit(&tree.chance));
        root = kdr_frame_turn_x(root, kdr_chance_between(&tree.chance, 0, 0.015));
        double height = kdr_chance_between(&tree.chance, 0.4, 0.65);
        draw_branch(shape, &tree, root, height, height * 0.075, 0);
    }
}

const kdr_recipe kdr_recipe_forest = {
    .name = "forest",
    .text = "trees of branches and leaves, every one grown anew",
    .default_count = 150000,
    .traits = KDR_SCENE_SMOOTH,
    .draw = draw,
    KDR_RECIPE_MATERIALS(materials),
};
