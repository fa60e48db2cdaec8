/* Commit: new trees are made beside the old ones and take their places only when they are whole. */
#include "base/cpu.h"
#include "build/plan.h"
#include "scene/scene.h"

static bool same_build(const kdr_plan *a, const kdr_plan *b) {
    return a->split == b->split && a->axis == b->axis && a->order == b->order && a->share == b->share &&
           a->share_count == b->share_count && a->events == b->events && a->straddle == b->straddle &&
           a->retract == b->retract && a->empty_bonus == b->empty_bonus && a->box_weight == b->box_weight &&
           a->cost_traversal == b->cost_traversal && a->cost_intersection == b->cost_intersection &&
           a->leaf_limit == b->leaf_limit && a->depth_limit == b->depth_limit &&
           a->reference_limit == b->reference_limit && a->trace == b->trace && a->nodes == b->nodes &&
           a->mailbox == b->mailbox && a->test == b->test;
}

/* How many scenes lie below one another in it, counted through instances. */
static uint32_t nesting_of(const kdr_scene *scene) {
    uint32_t deepest = 0;
    for (uint32_t g = 0; scene->custom_defs && g < scene->geometry_count; g++) {
        if (!kdr_scene_is_instance(scene, g))
            continue;
        const kdr_instance_def *def = scene->custom_defs[g].user;
        uint32_t below = atomic_load(&def->scene->shown)->nesting + 1;
        deepest = below > deepest ? below : deepest;
    }
    return deepest;
}

/* A part as it was, if nothing of it changed. */
static kdr_part *keep(kdr_part *part) {
    part->users++;
    return part;
}

/* The plan's tree is the wide one where there are lanes and nothing else is asked for. */
static void settle(const kdr_device *device, kdr_plan *plan) {
    plan->wide = device->traversals->wants_wide && plan->trace == KDR_TRACE_AUTO;
}

/* The next so many of `left` primitives are those of the build that follows. */
static kdr_listener *next_build(kdr_listener *listener, uint64_t count, uint64_t *left) {
    if (!listener)
        return NULL;
    listener->begin += listener->share;
    listener->share = *left > 0 ? (1 - listener->begin) * (double)count / (double)*left : 0;
    *left -= count;
    return listener;
}

/* An empty tree has no wide nodes, and needs none. */
static bool may_go_together(const kdr_part *part) {
    return part->tree.wide || (part->plan.wide && part->tree.primitive_count == 0);
}

/* Fills a place with what is to be shown. What was made when something fails is left there. */
static kdr_status fill(kdr_scene *scene, const kdr_plan *plan, bool keep_dynamic, bool keep_static,
                       kdr_listener *listener, kdr_committed *to) {
    kdr_device *device = scene->device;
    const kdr_committed *old = atomic_load(&scene->shown);
    const kdr_triangles_def *defs = scene->geometries;
    const uint32_t count = scene->geometry_count;
    uint64_t statics = kdr_part_triangles(defs, count, true), dynamics = kdr_part_triangles(defs, count, false);
    uint64_t customs = kdr_customs_total(scene->custom_defs, count);
    uint64_t left = (keep_static ? 0 : statics) + (keep_dynamic ? 0 : dynamics) + customs;
    kdr_status status = KDR_OK;

    if (statics > 0 && keep_static)
        to->static_part = keep(old->static_part);
    else if (statics > 0)
        status = kdr_part_create(device, defs, count, true, &scene->static_plan, next_build(listener, statics, &left),
                                 &to->static_part);
    if (status == KDR_OK && keep_dynamic)
        to->dynamic_part = keep(old->dynamic_part);
    else if (status == KDR_OK)
        status =
            kdr_part_create(device, defs, count, false, plan, next_build(listener, dynamics, &left), &to->dynamic_part);
    if (status == KDR_OK)
        status = kdr_customs_create(device, scene->custom_defs, count, plan, next_build(listener, customs, &left),
                                    &to->customs);
    if (status != KDR_OK)
        return status;
    to->is_commit = true;
    to->has_more = to->static_part || to->customs;
    to->is_named = plan->trace != KDR_TRACE_AUTO || (to->static_part && scene->static_plan.trace != KDR_TRACE_AUTO);
    to->wide = may_go_together(to->dynamic_part) && (!to->static_part || may_go_together(to->static_part));
    return KDR_OK;
}

kdr_status kdr_scene_commit(kdr_scene *scene, const kdr_build_def *given) {
    if (!scene)
        return KDR_ERROR_INVALID_ARGUMENT;
    kdr_device *device = scene->device;
    kdr_build_def def = given ? *given : kdr_default_build_def();
    const char *problem = kdr_build_def_problem(&def);
    if (problem)
        return kdr_device_fail(device, KDR_ERROR_INVALID_ARGUMENT, "%s", problem);
    kdr_plan plan = kdr_plan_of(&def);
    settle(device, &plan);
    settle(device, &scene->static_plan);
    kdr_committed *old = atomic_load(&scene->shown);
    bool as_before = scene->committed && same_build(&plan, &old->dynamic_part->plan);
    bool keep_dynamic = as_before && !scene->dynamic_changed, keep_static = scene->committed && !scene->static_changed;
    if (keep_dynamic && keep_static)
        return KDR_OK;

    double start = kdr_cpu_seconds();
    uint32_t nesting = nesting_of(scene);
    if (nesting > KDR_MAX_INSTANCE_DEPTH)
        return kdr_device_fail(device, KDR_ERROR_LIMIT, "instances lie at most %d deep in one another",
                               KDR_MAX_INSTANCE_DEPTH);
    kdr_listener listener = {.tell = scene->tell, .user = scene->tell_user, .busy = ATOMIC_FLAG_INIT};
    kdr_listener *told = scene->tell ? &listener : NULL;
    kdr_committed *next = kdr_scene_other_place(scene);
    kdr_status status = fill(scene, &plan, keep_dynamic, keep_static, told, next);
    if (status == KDR_OK && !kdr_listener_end(told))
        status = KDR_ERROR_CANCELLED;
    if (status != KDR_OK) {
        kdr_scene_empty_place(scene, next);
        return status;
    }
    next->nesting = nesting;
    next->build_seconds = kdr_cpu_seconds() - start;

    /* Show it. */
    atomic_store(&scene->shown, next);
    scene->committed = true;
    scene->dynamic_changed = scene->static_changed = false;
    if (!scene->readers)
        kdr_scene_empty_place(scene, old);
    return KDR_OK;
}
