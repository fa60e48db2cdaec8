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

static kdr_point_hit hit_of(const kdr_scene *scene, const kdr_nearest *nearest) {
    const kdr_surface_point *point = &nearest->point;
    uint32_t geometry = kdr_geometry_of(scene->first, scene->committed_count, nearest->primitive);
    return (kdr_point_hit){.x = (float)point->at[0],
                           .y = (float)point->at[1],
                           .z = (float)point->at[2],
                           .distance = (float)sqrt(point->square),
                           .u = (float)point->u,
                           .v = (float)point->v,
                           .primitive = nearest->primitive - scene->first[geometry],
                           .geometry = geometry,
                           .instance = KDR_INVALID_ID};
}

bool kdr_closest_point(const kdr_scene *scene, const kdr_point_query *query, kdr_point_hit *hit) {
    float at[3];
    kdr_nearest nearest = {.primitive = UINT32_MAX};
    if (!read_query(query, at, &nearest.point.square))
        return false;
    kdr_point_searches_for(scene->device->isa)->closest(&scene->tree, at, &nearest);
    if (nearest.primitive == UINT32_MAX)
        return false;
    *hit = hit_of(scene, &nearest);
    return true;
}

/* A caller's function and what is told to it. */
typedef struct listener {
    const kdr_scene *scene;
    kdr_point_fn *visit;
    void *user;
    size_t count;
} listener;

static bool tell(const kdr_nearest *nearest, void *context) {
    listener *l = context;
    kdr_point_hit hit = hit_of(l->scene, nearest);
    l->count++;
    return l->visit(&hit, l->user);
}

size_t kdr_primitives_within(const kdr_scene *scene, const kdr_point_query *query, kdr_point_fn *visit, void *user) {
    float at[3];
    double square;
    listener l = {scene, visit, user, 0};
    if (read_query(query, at, &square))
        kdr_point_searches_for(scene->device->isa)->within(&scene->tree, at, square, tell, &l);
    return l.count;
}
