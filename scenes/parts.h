/* Parts that more than one scene is composed of. All are drawn twice, as shape.h says. */
#ifndef KDR_SCENES_PARTS_H
#define KDR_SCENES_PARTS_H

#include "scenes/chance.h"
#include "scenes/scenes.h"

/* A sphere flake of about `triangles` around the unit ball of `frame` (equal axes), generation by generation in
 * material_count materials from first_material on. */
void kdr_draw_flake(kdr_shape *shape, const kdr_frame *frame, size_t triangles, uint32_t first_material,
                    uint32_t material_count);

/* A closed tube along the (winds_around, winds_through) torus knot, about 1 across in the frame, in about `triangles`.
 */
void kdr_draw_knot(kdr_shape *shape, const kdr_frame *frame, size_t triangles, int winds_around, int winds_through);

/* Materials that kdr_draw_city uses: they stand first in the list of every scene with a city. */
enum {
    KDR_CITY_STREET,
    KDR_CITY_PAVEMENT,
    KDR_CITY_WINDOW,
    KDR_CITY_LAMP,
    KDR_CITY_WALLS,
    KDR_CITY_WALL_COUNT = 5,
    KDR_CITY_MATERIAL_COUNT = KDR_CITY_WALLS + KDR_CITY_WALL_COUNT,
};

#define KDR_CITY_MATERIALS                                                                                             \
    {"street", {0.07f, 0.07f, 0.08f}}, {"pavement", {0.34f, 0.33f, 0.31f}}, {"window", {0.04f, 0.09f, 0.16f}},         \
        {"lit window", {0.95f, 0.75f, 0.30f}}, {"sandstone", {0.58f, 0.47f, 0.32f}}, {"brick", {0.48f, 0.17f, 0.10f}}, \
        {"plaster", {0.74f, 0.72f, 0.67f}}, {"slate", {0.26f, 0.30f, 0.35f}}, {                                        \
        "copper", { 0.22f, 0.45f, 0.38f }                                                                              \
    }

/* Buildings on columns x rows lots one unit wide, lot (0, 0) at `corner`, in exactly `triangles` or one less; at least
 * 12 a lot. Towers grow up to `height` towards (centre_x, centre_z). No ground. */
typedef struct kdr_city {
    kdr_point corner;
    uint32_t columns, rows;
    double height, centre_x, centre_z, reach;
    uint32_t seed;
} kdr_city;

void kdr_draw_city(kdr_shape *shape, const kdr_city *city, size_t triangles);

#endif
