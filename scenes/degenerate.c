/* What a builder must survive: triangles by the thousand in one plane, exact copies, triangles without area, and a fan
 * whose triangles all meet in one vertex.
 *
 * Coordinates are whole multiples of 1 / 8192 below 4, exact as floats, and so are all areas: coplanar means exactly
 * coplanar, and no area means exactly none. */
#include "scenes/chance.h"
#include "scenes/scenes.h"

#define GRAIN (1.0 / 1024)

static const kdr_recipe_material degenerate_materials[] = {
    {"red", {0.60f, 0.10f, 0.08f}},    {"green", {0.16f, 0.42f, 0.14f}}, {"blue", {0.10f, 0.20f, 0.52f}},
    {"yellow", {0.80f, 0.62f, 0.10f}}, {"white", {0.80f, 0.80f, 0.78f}}, {"violet", {0.34f, 0.12f, 0.42f}},
};

static double grains(kdr_chance *chance, int low, int high) {
    return (low + (int)kdr_chance_below(chance, (uint32_t)(high - low + 1))) * GRAIN;
}

typedef struct flat_triangle {
    double u[3], v[3];
} flat_triangle;

/* A triangle of a plane's coordinates u, v in [-1, 1], with an area: corners go round its middle in thirds. */
static flat_triangle flat(kdr_chance *chance) {
    flat_triangle flat;
    double u = grains(chance, -700, 700), v = grains(chance, -700, 700);
    int size = 16 + (int)kdr_chance_below(chance, 300);
    flat.u[0] = u + grains(chance, size / 2, size), flat.v[0] = v + grains(chance, -size / 4, size / 4);
    flat.u[1] = u - grains(chance, size / 4, size), flat.v[1] = v + grains(chance, size / 2, size);
    flat.u[2] = u - grains(chance, size / 4, size), flat.v[2] = v - grains(chance, size / 2, size);
    return flat;
}

#define PLANE_COUNT 6

/* Three planes square to the axes, a second floor, and two slanted ones. */
static kdr_point plane_point(uint32_t plane, double u, double v) {
    switch (plane) {
    case 0: return (kdr_point){v, -1, u};
    case 1: return (kdr_point){-1, u, v};
    case 2: return (kdr_point){u, v, -1};
    case 3: return (kdr_point){v, -0.25, u};
    case 4: return (kdr_point){v, -u / 2 - v / 2, u};
    default: return (kdr_point){u / 4 + v / 8, v, u};
    }
}

static void draw_heap(kdr_shape *shape, size_t triangle_count, double time) {
    (void)time;
    if (kdr_shape_counts(shape)) {
        kdr_shape_skip(shape, 3 * triangle_count, triangle_count);
        return;
    }
    for (size_t i = 0; i < triangle_count; i++) {
        kdr_chance chance = kdr_chance_of(7, i);
        flat_triangle t = flat(&chance);
        uint32_t plane = (uint32_t)(i % PLANE_COUNT);
        shape->material = plane;
        kdr_shape_facet(shape, plane_point(plane, t.u[0], t.v[0]), plane_point(plane, t.u[1], t.v[1]),
                        plane_point(plane, t.u[2], t.v[2]));
    }
}

const kdr_recipe kdr_recipe_heap = {
    .name = "heap",
    .text = "thousands of overlapping triangles in six planes, four of them square to the axes",
    .default_count = 20000,
    .traits = 0,
    .draw = draw_heap,
    KDR_RECIPE_MATERIALS(degenerate_materials),
};

#define COPIES 1000

/* Standing triangles, each there at least a thousand times where the size allows it. */
static void draw_copies(kdr_shape *shape, size_t count) {
    size_t kinds = count / COPIES ? count / COPIES : 1;
    for (size_t i = 0; i < count; i++) {
        kdr_chance chance = kdr_chance_of(8, i % kinds);
        flat_triangle t = flat(&chance);
        double depth = grains(&chance, -256, 256);
        shape->material = kdr_chance_below(&chance, 2);
        kdr_shape_facet(shape, (kdr_point){t.u[0], t.v[0] + 1.5, t.u[0] / 2 + depth},
                        (kdr_point){t.u[1], t.v[1] + 1.5, t.u[1] / 2 + depth},
                        (kdr_point){t.u[2], t.v[2] + 1.5, t.u[2] / 2 + depth});
    }
}

static void draw_overlaps(kdr_shape *shape, size_t count) {
    for (size_t i = 0; i < count; i++) {
        kdr_chance chance = kdr_chance_of(9, i);
        flat_triangle t = flat(&chance);
        shape->material = 2 + kdr_chance_below(&chance, 2);
        kdr_shape_facet(shape, (kdr_point){t.v[0], 0, t.u[0]}, (kdr_point){t.v[1], 0, t.u[1]},
                        (kdr_point){t.v[2], 0, t.u[2]});
    }
}

/* In turn: one point three times, one vertex twice, two vertices in one place, three vertices in a line. */
static void draw_areas_of_zero(kdr_shape *shape, size_t count) {
    shape->material = 4;
    kdr_point up = {0, 1, 0};
    for (size_t i = 0; i < count; i++) {
        kdr_chance chance = kdr_chance_of(10, i);
        double x = grains(&chance, -1024, 1024), y = grains(&chance, 0, 2048), z = grains(&chance, -1024, 1024);
        double right = grains(&chance, 1, 64), up_by = grains(&chance, 1, 64), near = grains(&chance, 1, 64);
        kdr_point a = {x, y, z}, step = {right, up_by, near};
        uint32_t first = kdr_shape_vertex(shape, a, up);
        uint32_t second = kdr_shape_vertex(shape, i % 4 == 0 ? a : kdr_point_add(a, step), up);
        uint32_t third = kdr_shape_vertex(shape, i % 4 == 3 ? kdr_point_along(a, step, 2) : a, up);
        kdr_shape_triangle(shape, first, second, i % 4 == 1 ? second : third);
    }
}

static void draw_duplicates(kdr_shape *shape, size_t triangle_count, double time) {
    (void)time;
    size_t quarter = triangle_count / 4, rest = triangle_count - 3 * quarter;
    if (kdr_shape_counts(shape)) {
        kdr_shape_skip(shape, 9 * quarter + rest + 1, triangle_count);
        return;
    }
    draw_copies(shape, quarter);
    draw_overlaps(shape, quarter);
    draw_areas_of_zero(shape, quarter);
    shape->material = 5;
    kdr_frame fan = kdr_frame_at((kdr_point){0, -0.25, 0}, 1.5);
    kdr_shape_disc(shape, &fan, rest);
}

const kdr_recipe kdr_recipe_duplicates = {
    .name = "duplicates",
    .text = "a quarter each: exact copies, coplanar overlaps, triangles without area, and one fan",
    .default_count = 10000,
    .traits = 0,
    .draw = draw_duplicates,
    KDR_RECIPE_MATERIALS(degenerate_materials),
};
