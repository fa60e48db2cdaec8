#include "render/box.h"

#include <float.h>

#define WALL_DISTANCE 1.0 /* from the model's centre, in diagonals */
#define CEILING_DISTANCE 1.6
#define FLOOR_GAP 1e-3 /* a model with a flat bottom does not lie in the floor */

static float component(kdr_vector v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

static void make_walls(kdr_room *room) {
    // Vertex i lies on the high side of axis k if bit k of i is set.
    for (uint32_t i = 0; i < KDR_BOX_VERTICES; i++)
        for (int k = 0; k < 3; k++)
            room->vertices[i][k] = i >> k & 1 ? room->extent.hi[k] : room->extent.lo[k];
    for (uint32_t wall = 0; wall < 6; wall++) {
        uint32_t axis = wall / 2, base = (wall & 1) << axis;
        uint32_t a = 1u << (axis + 1) % 3, b = 1u << (axis + 2) % 3;
        uint32_t quad[2][3] = {{base, base + a, base + a + b}, {base, base + a + b, base + b}};
        for (uint32_t i = 0; i < 2; i++)
            for (uint32_t j = 0; j < 3; j++)
                room->indices[wall * 2 + i][j] = quad[i][j];
    }
}

bool kdr_room_make(const float model_bounds[6], const float up[3], kdr_room *room) {
    double diagonal = 0, magnitude = 0;
    for (int k = 0; k < 3; k++) {
        double extent = (double)model_bounds[k + 3] - model_bounds[k];
        if (!(extent >= 0))
            return false;
        diagonal += extent * extent;
        magnitude = fmax(magnitude, fmax(fabs(model_bounds[k]), fabs(model_bounds[k + 3])));
    }
    // A wall must stand apart from the model in floats.
    diagonal = fmax(sqrt(diagonal), magnitude * 1e-3);
    if (!(diagonal > FLT_MIN))
        diagonal = 1;
    if (magnitude + 2 * diagonal > (double)FLT_MAX / 4)
        return false;

    *room = (kdr_room){.size = (float)(2 * WALL_DISTANCE * diagonal), .margin = (float)(1e-4 * diagonal)};
    for (int k = 1; k < 3; k++)
        if (fabsf(up[k]) > fabsf(up[room->up_axis]))
            room->up_axis = k;
    room->up_is_negative = up[room->up_axis] < 0;
    for (int k = 0; k < 3; k++) {
        double centre = ((double)model_bounds[k] + model_bounds[k + 3]) / 2;
        double lo = centre - WALL_DISTANCE * diagonal, hi = centre + WALL_DISTANCE * diagonal;
        if (k == room->up_axis && !room->up_is_negative) {
            lo = model_bounds[k] - FLOOR_GAP * diagonal;
            hi = centre + CEILING_DISTANCE * diagonal;
        } else if (k == room->up_axis) {
            lo = centre - CEILING_DISTANCE * diagonal;
            hi = model_bounds[k + 3] + FLOOR_GAP * diagonal;
        }
        room->extent.lo[k] = (float)lo;
        room->extent.hi[k] = (float)hi;
    }
    make_walls(room);
    return true;
}

/* The interval of a ray inside the room; empty when it misses. */
static void interval(const kdr_room *room, const kdr_ray *ray, float *enter, float *leave) {
    const float origin[3] = {ray->origin_x, ray->origin_y, ray->origin_z};
    const float direction[3] = {ray->direction_x, ray->direction_y, ray->direction_z};
    *enter = -INFINITY;
    *leave = INFINITY;
    for (int k = 0; k < 3; k++) {
        if (direction[k] == 0)
            continue;
        float a = (room->extent.lo[k] - origin[k]) / direction[k], b = (room->extent.hi[k] - origin[k]) / direction[k];
        *enter = kdr_larger(*enter, kdr_smaller(a, b));
        *leave = kdr_smaller(*leave, kdr_larger(a, b));
    }
}

static float margin(const kdr_room *room, const kdr_ray *ray) {
    kdr_vector d = {ray->direction_x, ray->direction_y, ray->direction_z};
    return room->margin / kdr_vector_extent(d);
}

void kdr_room_enter(const kdr_room *room, kdr_ray *ray) {
    float enter, leave;
    interval(room, ray, &enter, &leave);
    if (enter > 0)
        ray->tmin = enter + margin(room, ray) + 1e-6f * enter;
}

void kdr_room_leave(const kdr_room *room, kdr_ray *ray) {
    float enter, leave;
    interval(room, ray, &enter, &leave);
    float last = leave - margin(room, ray);
    if (last < ray->tmax)
        ray->tmax = kdr_larger(last, 0);
}

kdr_vector kdr_room_colour(const kdr_room *room, const kdr_texture *texture, uint32_t triangle, kdr_vector point) {
    int axis = (int)(triangle / 4);
    // v runs down the walls; on floor and ceiling the picture lies along the two other axes.
    bool upright = axis != room->up_axis;
    int v_axis = upright ? room->up_axis : (axis + 2) % 3;
    int u_axis = 3 - axis - v_axis;
    float u = component(point, u_axis) - room->extent.lo[u_axis];
    float v = component(point, v_axis) - room->extent.lo[v_axis];
    if (upright) {
        // Who looks at the wall from inside has (his way x up) to the right, and u must grow there.
        bool high_side = triangle / 2 & 1, cyclic = (axis + 1) % 3 == v_axis;
        if ((high_side == cyclic) == room->up_is_negative)
            u = -u;
        if (!room->up_is_negative)
            v = room->extent.hi[v_axis] - component(point, v_axis);
    }
    return kdr_texture_at(texture, u / room->size, v / room->size);
}
