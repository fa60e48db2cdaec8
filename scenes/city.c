/* Axis-aligned towers: boxes stacked in setbacks, with windows a hand's breadth before the walls. Nearly every plane of
 * the scene is square to an axis, and most triangles share their plane with hundreds of others. */
#include "scenes/parts.h"

#define MOST_TIERS 3
#define BOX_TRIANGLES 10
#define LOT_LEAST 12
#define PAVEMENT_HEIGHT 0.03

typedef struct city_lot {
    double x, z, half_x, half_z, height;
    uint32_t tiers, walls;
} city_lot;

static city_lot lot_at(const kdr_city *city, uint32_t column, uint32_t row) {
    kdr_chance chance = kdr_chance_of(city->seed, (uint64_t)row << 32 | column);
    city_lot lot = {.x = column + 0.5, .z = row + 0.5};
    lot.half_x = kdr_chance_between(&chance, 0.26, 0.36);
    lot.half_z = kdr_chance_between(&chance, 0.26, 0.36);
    double x = city->corner.x + lot.x - city->centre_x, z = city->corner.z + lot.z - city->centre_z;
    double near = 1 - sqrt(x * x + z * z) / city->reach;
    near = near > 0 ? near * near : 0;
    double storeys = 0.12 * kdr_chance_unit(&chance);
    storeys += near * kdr_chance_between(&chance, 0.25, 0.9);
    lot.height = 0.35 + city->height * storeys;
    lot.tiers = 1 + kdr_chance_below(&chance, MOST_TIERS);
    lot.walls = KDR_CITY_WALLS + kdr_chance_below(&chance, KDR_CITY_WALL_COUNT);
    return lot;
}

/* Windows go with the area of the walls. */
static double lot_weight(const city_lot *lot) { return (lot->half_x + lot->half_z) * lot->height; }

static void draw_block(kdr_shape *shape, kdr_point low, kdr_point high) {
    kdr_frame frame = {
        .origin = kdr_point_scale(kdr_point_add(low, high), 0.5),
        .x = {(high.x - low.x) / 2, 0, 0},
        .y = {0, (high.y - low.y) / 2, 0},
        .z = {0, 0, (high.z - low.z) / 2},
    };
    kdr_shape_box(shape, &frame, false);
}

/* Rows of windows from the ground up, around all four sides; the top row may be incomplete. */
static void draw_windows(kdr_shape *shape, kdr_point low, kdr_point high, size_t count, kdr_chance *chance) {
    if (kdr_shape_counts(shape)) {
        kdr_shape_skip(shape, 4 * count, 2 * count);
        return;
    }
    double size_x = high.x - low.x, size_y = high.y - low.y, size_z = high.z - low.z;
    double floors = sqrt((double)count * size_y / (2.6 * (size_x + size_z)));
    size_t a_side = (size_t)((double)count / (4 * (floors < 1 ? 1 : floors))) + 1;
    size_t floor_count = (count + 4 * a_side - 1) / (4 * a_side);
    double storey = size_y / (double)floor_count, before = 0.03 * storey < 0.004 ? 0.03 * storey : 0.004;

    for (size_t i = 0; i < count; i++) {
        size_t side = i % (4 * a_side) / a_side;
        double from = ((double)(i % a_side) + 0.18) / (double)a_side, width = 0.64 / (double)a_side;
        double foot = low.y + ((double)(i / (4 * a_side)) + 0.25) * storey;
        kdr_point up = {0, 0.55 * storey, 0};
        shape->material = kdr_chance_unit(chance) < 0.12 ? KDR_CITY_LAMP : KDR_CITY_WINDOW;
        if (side == 0)
            kdr_shape_quad(shape, (kdr_point){low.x + from * size_x, foot, high.z + before},
                           (kdr_point){width * size_x, 0, 0}, up);
        else if (side == 1)
            kdr_shape_quad(shape, (kdr_point){high.x + before, foot, high.z - from * size_z},
                           (kdr_point){0, 0, -width * size_z}, up);
        else if (side == 2)
            kdr_shape_quad(shape, (kdr_point){high.x - from * size_x, foot, low.z - before},
                           (kdr_point){-width * size_x, 0, 0}, up);
        else
            kdr_shape_quad(shape, (kdr_point){low.x - before, foot, low.z + from * size_z},
                           (kdr_point){0, 0, width * size_z}, up);
    }
}

static void draw_lot(kdr_shape *shape, const kdr_city *city, const city_lot *lot, size_t triangles,
                     kdr_chance *chance) {
    bool pavement = triangles >= 80;
    uint32_t tiers = triangles < 60 ? 1 : lot->tiers;
    size_t windows = (triangles - BOX_TRIANGLES * (tiers + pavement)) / 2;
    kdr_point middle = kdr_point_add(city->corner, (kdr_point){lot->x, 0, lot->z});
    if (pavement) {
        shape->material = KDR_CITY_PAVEMENT;
        draw_block(shape, kdr_point_add(middle, (kdr_point){-0.42, 0, -0.42}),
                   kdr_point_add(middle, (kdr_point){0.42, PAVEMENT_HEIGHT, 0.42}));
    }

    double foot = pavement ? PAVEMENT_HEIGHT : 0, shrink = 1;
    for (uint32_t tier = 0; tier < tiers; tier++, shrink *= 0.76) {
        double top = lot->height * (tier + 1 == tiers ? 1 : tier ? 0.82 : 0.55);
        kdr_point low = {middle.x - lot->half_x * shrink, middle.y + foot, middle.z - lot->half_z * shrink};
        kdr_point high = {middle.x + lot->half_x * shrink, middle.y + top, middle.z + lot->half_z * shrink};
        shape->material = lot->walls;
        draw_block(shape, low, high);

        size_t part = (size_t)((double)windows * (top - foot) / (lot->height - foot));
        part = tier + 1 == tiers || part > windows ? windows : part;
        draw_windows(shape, low, high, part, chance);
        windows -= part;
        foot = top;
    }
}

void kdr_draw_city(kdr_shape *shape, const kdr_city *city, size_t triangles) {
    double total = 0;
    for (uint32_t row = 0; row < city->rows; row++)
        for (uint32_t column = 0; column < city->columns; column++) {
            city_lot lot = lot_at(city, column, row);
            total += lot_weight(&lot);
        }

    size_t spare = triangles - (size_t)LOT_LEAST * city->rows * city->columns, given = 0;
    double sum = 0;
    for (uint32_t row = 0; row < city->rows; row++)
        for (uint32_t column = 0; column < city->columns; column++) {
            city_lot lot = lot_at(city, column, row);
            sum += lot_weight(&lot);
            size_t until = (size_t)((double)spare * (sum / total) + 0.5);
            kdr_chance chance = kdr_chance_of(city->seed + 1, (uint64_t)row << 32 | column);
            // What a lot leaves over, one triangle at most, the next one gets.
            size_t before = shape->triangle_count, budget = LOT_LEAST + until - given;
            draw_lot(shape, city, &lot, budget, &chance);
            given = until - (budget - (shape->triangle_count - before));
        }
}

static const kdr_recipe_material materials[] = {KDR_CITY_MATERIALS};

static void draw(kdr_shape *shape, size_t triangle_count, double time) {
    (void)time;
    double wanted = sqrt((double)triangle_count / 600);
    uint32_t side = wanted < 2 ? 2 : wanted > 36 ? 36 : (uint32_t)wanted;
    double half = side / 2.0;
    shape->material = KDR_CITY_STREET;
    kdr_shape_quad(shape, (kdr_point){-half, 0, half}, (kdr_point){2 * half, 0, 0}, (kdr_point){0, 0, -2 * half});

    kdr_city city = {
        .corner = {-half, 0, -half},
        .columns = side,
        .rows = side,
        .height = 0.75 * side < 10 ? 0.75 * side : 10,
        .reach = 0.8 * side,
        .seed = 11,
    };
    kdr_draw_city(shape, &city, triangle_count - 2);
}

const kdr_recipe kdr_recipe_city = {
    .name = "city",
    .text = "streets of towers with setbacks and windows, all square to the axes",
    .default_count = 120000,
    .traits = 0,
    .draw = draw,
    KDR_RECIPE_MATERIALS(materials),
};
