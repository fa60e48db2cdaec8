/* Queries about a point. As with rays, nothing here allocates, locks or fails. */
#include "scene/scene.h"
#include "trace/points.h"

/* False if nothing can be found: a number that is NaN, a point that is not finite, a radius below 0. */
static bool read_query(const kdr_point_query *query, float at[3], double *square) {
    at[0] = query->x;
    at[1] = query->y;
    at[2] = query->z;
    *square = (double)query->radius * query->radius;
    return isfinite(query->x) && isfinite(query->y) && isfinite(query->z) && query->radius >= 0;
}

static kdr_point_hit hit_of(const kdr_part *part, const kdr_nearest *nearest) {
    const kdr_surface_point *point = &nearest->point;
    uint32_t geometry = kdr_geometry_of(part->first, part->count, nearest->primitive);
    return (kdr_point_hit){.x = (float)point->at[0],
                           .y = (float)point->at[1],
                           .z = (float)point->at[2],
                           .distance = (float)sqrt(point->square),
                           .u = (float)point->u,
                           .v = (float)point->v,
                           .primitive = nearest->primitive - part->first[geometry],
                           .geometry = geometry,
                           .instance = KDR_INVALID_ID};
}

bool kdr_closest_point(const kdr_scene *scene, const kdr_point_query *query, kdr_point_hit *hit) {
    float at[3];
    double square;
    bool found = false;
    if (!read_query(query, at, &square))
        return false;
    kdr_visit visit = kdr_scene_enter(scene);
    const kdr_part *parts[2] = {visit.seen->dynamic_part, visit.seen->static_part};
    for (int p = 0; p < 2 && parts[p]; p++) {
        kdr_nearest nearest = {.point.square = square, .primitive = UINT32_MAX};
        kdr_point_searches_for(scene->device->isa)->closest(&parts[p]->tree, at, &nearest);
        if (nearest.primitive == UINT32_MAX)
            continue;
        kdr_point_hit one = hit_of(parts[p], &nearest);
        if (found && nearest.point.square == square && one.geometry > hit->geometry)
            continue;
        *hit = one;
        square = nearest.point.square;
        found = true;
    }
    kdr_scene_leave(visit);
    return found;
}

/* A caller's function and what is told to it. */
typedef struct listener {
    const kdr_part *part;
    kdr_point_fn *visit;
    void *user;
    size_t count;
} listener;

static bool tell(const kdr_nearest *nearest, void *context) {
    listener *l = context;
    kdr_point_hit hit = hit_of(l->part, nearest);
    l->count++;
    return l->visit(&hit, l->user);
}

size_t kdr_primitives_within(const kdr_scene *scene, const kdr_point_query *query, kdr_point_fn *fn, void *user) {
    float at[3];
    double square;
    if (!read_query(query, at, &square))
        return 0;
    kdr_visit visit = kdr_scene_enter(scene);
    const kdr_part *parts[2] = {visit.seen->dynamic_part, visit.seen->static_part};
    listener l = {.visit = fn, .user = user};
    bool goes_on = true;
    for (int p = 0; p < 2 && parts[p] && goes_on; p++) {
        l.part = parts[p];
        goes_on = kdr_point_searches_for(scene->device->isa)->within(&parts[p]->tree, at, square, tell, &l);
    }
    kdr_scene_leave(visit);
    return l.count;
}
