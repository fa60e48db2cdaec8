/* What a ray costs in all trees of a commit. */
#include "trace/cost.h"

#include "scene/scene.h"

void kdr_cost1(const kdr_scene *scene, const kdr_ray *ray, kdr_ray_cost *cost) {
    /* The hit must be one in what is seen here. A place where somebody is counted in is not filled again, so if it is
     * still shown behind the question, it was shown all the time. */
    kdr_visit visit = kdr_scene_enter(scene);
    kdr_ray_hit up_to = {.ray = *ray};
    kdr_intersect1(scene, &up_to);
    while (atomic_load(&scene->shown) != visit.seen) {
        kdr_scene_leave(visit);
        visit = kdr_scene_enter(scene);
        up_to.ray = *ray;
        kdr_intersect1(scene, &up_to);
    }

    const kdr_committed *seen = visit.seen;
    *cost = (kdr_ray_cost){0};
    kdr_cost_add(&seen->dynamic_part->tree, &up_to.ray, cost);
    if (seen->static_part)
        kdr_cost_add(&seen->static_part->tree, &up_to.ray, cost);
    if (seen->customs)
        kdr_cost_add(&seen->customs->tree, &up_to.ray, cost);
    kdr_scene_leave(visit);
}
