/* Triangles that belong to nothing: long thin ones whose boxes are almost empty, and a soup without any order. */
#include "scenes/chance.h"
#include "scenes/scenes.h"

static const kdr_recipe_material loose_materials[] = {
    {"blue", {0.10f, 0.24f, 0.60f}},
    {"teal", {0.08f, 0.45f, 0.42f}},
    {"orange", {0.80f, 0.38f, 0.06f}},
    {"cream", {0.80f, 0.74f, 0.58f}},
};

static kdr_point in_cube(kdr_chance *chance) {
    double x = kdr_chance_between(chance, -1, 1), y = kdr_chance_between(chance, -1, 1);
    return (kdr_point){x, y, kdr_chance_between(chance, -1, 1)};
}

/* Near one of the four diagonals of the cube, 100 to 400 times as long as wide. */
static void draw_needles(kdr_shape *shape, size_t triangle_count, double time) {
    (void)time;
    if (kdr_shape_counts(shape)) {
        kdr_shape_skip(shape, 3 * triangle_count, triangle_count);
        return;
    }
    for (size_t i = 0; i < triangle_count; i++) {
        kdr_chance chance = kdr_chance_of(5, i);
        uint64_t diagonal = kdr_chance_bits(&chance);
        kdr_point along = {1, diagonal & 1 ? 1 : -1, diagonal & 2 ? 1 : -1};
        along = kdr_point_unit(kdr_point_along(along, kdr_chance_direction(&chance), 0.4));
        kdr_point across = kdr_point_unit(kdr_point_cross(along, kdr_chance_direction(&chance)));
        double length = kdr_chance_between(&chance, 0.4, 1.6);
        kdr_point middle = in_cube(&chance);
        kdr_point foot = kdr_point_along(middle, along, -length / 2);
        shape->material = kdr_chance_below(&chance, 4);
        kdr_shape_facet(shape, foot, kdr_point_along(foot, across, 0.004), kdr_point_along(middle, along, length / 2));
    }
}

const kdr_recipe kdr_recipe_needles = {
    .name = "needles",
    .text = "long thin triangles along the diagonals, in boxes that are almost empty",
    .default_count = 20000,
    .traits = 0,
    .draw = draw_needles,
    KDR_RECIPE_MATERIALS(loose_materials),
};

/* Sides shrink with the fourth root of the count: many triangles stay small without leaving the soup thin. */
static void draw_soup(kdr_shape *shape, size_t triangle_count, double time) {
    (void)time;
    if (kdr_shape_counts(shape)) {
        kdr_shape_skip(shape, 3 * triangle_count, triangle_count);
        return;
    }
    double size = 0.9 / sqrt(sqrt((double)triangle_count));
    for (size_t i = 0; i < triangle_count; i++) {
        kdr_chance chance = kdr_chance_of(6, i);
        kdr_point middle = in_cube(&chance), corner[3];
        for (int k = 0; k < 3; k++)
            corner[k] = kdr_point_along(middle, in_cube(&chance), size);
        shape->material = kdr_chance_below(&chance, 4);
        kdr_shape_facet(shape, corner[0], corner[1], corner[2]);
    }
}

const kdr_recipe kdr_recipe_soup = {
    .name = "soup",
    .text = "random triangles, evenly spread over a cube",
    .default_count = 100000,
    .traits = 0,
    .draw = draw_soup,
    KDR_RECIPE_MATERIALS(loose_materials),
};
