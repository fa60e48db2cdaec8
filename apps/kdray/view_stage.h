/* What is on view: an animation, the scene that is committed again for every moment, and the plan of its tree. */
#ifndef KDR_APPS_KDRAY_VIEW_STAGE_H
#define KDR_APPS_KDRAY_VIEW_STAGE_H

#include "view_options.h"

typedef struct kdr_view_stage {
    kdr_messages *messages;
    kdr_logger logger;
    const char *file;
    kdr_animation *animation;
    kdr_device *device;
    kdr_scene *scene;
    kdr_mesh *mesh;
    double duration;     /* of the animation */
    double moment;       /* that the mesh shows; NaN: there is none yet */
    kdr_build_def given; /* the plan of the command line */
    uint32_t plan;       /* of view_plans.h */
    kdr_trace_rule trace;
    uint32_t built_plan; /* those of the tree */
    kdr_trace_rule built_trace;
    bool is_built;
    double sample_seconds, build_seconds; /* the last mesh, and the last commit */
} kdr_view_stage;

/* Opens what is named, and makes a device and a scene. False after a sentence; what was made is there to be closed. */
bool kdr_view_stage_open(kdr_view_stage *stage, const kdr_view_options *options, kdr_messages *messages);

/* The box of what is seen in the next `seconds`, as far as some moments tell. False after a sentence. */
bool kdr_view_stage_bounds(kdr_view_stage *stage, double seconds, float bounds[6]);

/* Shows a moment by the plan that is set. *changed: something had to be built. False after a sentence. */
bool kdr_view_stage_update(kdr_view_stage *stage, double moment, bool *changed);

void kdr_view_stage_close(kdr_view_stage *stage);

#endif
