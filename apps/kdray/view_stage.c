#include "view_stage.h"

#include "signals.h"
#include "view_plans.h"

#include <math.h>
#include <string.h>

#define VIEW_SAMPLES 9 /* moments that the view is fitted to */

static bool fail(kdr_view_stage *stage, const char *what, kdr_status status) {
    if (!kdr_signals_cancelled())
        kdr_messages_fail_status(stage->messages, what, status);
    return false;
}

/* True if nothing was said of the plan. */
static bool is_default(const kdr_build_def *build) {
    char given[KDR_PLAN_TEXT_SIZE] = "", usual[KDR_PLAN_TEXT_SIZE] = "";
    kdr_build_def def = kdr_default_build_def();
    kdr_build_def_print(build, given, sizeof given);
    kdr_build_def_print(&def, usual, sizeof usual);
    return strcmp(given, usual) == 0;
}

/* A long build ends when somebody wants the program to. */
static bool follow(uint64_t finished, uint64_t total, void *user) {
    (void)finished;
    (void)total;
    (void)user;
    return !kdr_signals_cancelled();
}

bool kdr_view_stage_open(kdr_view_stage *stage, const kdr_view_options *options, kdr_messages *messages) {
    *stage = (kdr_view_stage){.messages = messages, .logger = kdr_messages_logger(messages), .file = options->file};
    stage->moment = NAN;
    stage->given = options->tree.build;
    stage->trace = options->tree.build.trace;
    kdr_status status = kdr_animation_open(options->file, options->rate, &stage->logger, &stage->animation);
    if (status != KDR_OK)
        return fail(stage, options->file, status);
    stage->duration = kdr_animation_duration(stage->animation);
    if (is_default(&stage->given))
        stage->plan = stage->duration > 0 ? KDR_VIEW_PLAN_FAST : KDR_VIEW_PLAN_BALANCED;
    stage->device = kdr_tree_options_device(&options->tree, messages);
    if (!stage->device)
        return false;
    kdr_triangles_def nothing = kdr_default_triangles_def();
    status = kdr_scene_create(stage->device, &stage->scene);
    if (status == KDR_OK)
        status = kdr_scene_add_triangles(stage->scene, &nothing, NULL);
    if (status == KDR_OK)
        status = kdr_scene_set_progress(stage->scene, follow, NULL);
    return status == KDR_OK || fail(stage, "no scene", status);
}

static bool take_sample(kdr_view_stage *stage, double moment) {
    if (stage->mesh && stage->moment == moment)
        return true;
    stage->moment = NAN;
    double begin = kdr_seconds();
    kdr_status status = kdr_animation_sample(stage->animation, moment, &stage->logger, &stage->mesh);
    if (status != KDR_OK)
        return fail(stage, stage->file, status);
    stage->sample_seconds = kdr_seconds() - begin;
    stage->moment = moment;
    stage->is_built = false;
    return true;
}

bool kdr_view_stage_bounds(kdr_view_stage *stage, double seconds, float bounds[6]) {
    int steps = stage->duration > 0 ? VIEW_SAMPLES : 1;
    for (int k = 0; k < 3; k++) {
        bounds[k] = INFINITY;
        bounds[k + 3] = -INFINITY;
    }
    // The first moment last: it is the one that is shown.
    for (int i = steps - 1; i >= 0; i--) {
        float now[6];
        if (!take_sample(stage, steps > 1 ? seconds * i / (steps - 1) : 0))
            return false;
        kdr_mesh_bounds(stage->mesh, now);
        for (int k = 0; k < 3; k++) {
            bounds[k] = fminf(bounds[k], now[k]);
            bounds[k + 3] = fmaxf(bounds[k + 3], now[k + 3]);
        }
    }
    return true;
}

bool kdr_view_stage_update(kdr_view_stage *stage, double moment, bool *changed) {
    *changed = false;
    if (!take_sample(stage, moment))
        return false;
    if (stage->is_built && stage->built_plan == stage->plan && stage->built_trace == stage->trace)
        return true;
    kdr_triangles_def def = kdr_default_triangles_def();
    def.vertices = stage->mesh->positions;
    def.vertex_count = stage->mesh->vertex_count;
    def.indices = stage->mesh->indices;
    def.triangle_count = stage->mesh->triangle_count;
    kdr_build_def build = kdr_view_plan(&stage->given, stage->plan, stage->trace);
    double begin = kdr_seconds();
    kdr_status status = kdr_scene_set_triangles(stage->scene, 0, &def);
    if (status == KDR_OK)
        status = kdr_scene_commit(stage->scene, &build);
    stage->build_seconds = kdr_seconds() - begin;
    if (status != KDR_OK)
        return fail(stage, "the tree was not built", status);
    stage->is_built = *changed = true;
    stage->built_plan = stage->plan;
    stage->built_trace = stage->trace;
    return true;
}

void kdr_view_stage_close(kdr_view_stage *stage) {
    kdr_scene_destroy(stage->scene);
    kdr_mesh_destroy(stage->mesh);
    kdr_animation_destroy(stage->animation);
    kdr_device_destroy(stage->device);
    *stage = (kdr_view_stage){.messages = stage->messages};
}
