/* A view under way: what is shown, and how. Whoever hears keys and the mouse changes it, whoever draws reads it. */
#ifndef KDR_APPS_KDRAY_VIEWING_H
#define KDR_APPS_KDRAY_VIEWING_H

#include "view_cells.h"
#include "view_clock.h"
#include "view_pace.h"
#include "view_panel.h"
#include "view_picture.h"
#include "view_stage.h"
#include "view_window.h"

#define KDR_VIEW_SAMPLES 8    /* a pixel of a picture that rests */
#define KDR_VIEW_CELL_DEPTH 8 /* of the cells that are shown at first */

typedef enum kdr_view_drag { KDR_DRAG_NONE, KDR_DRAG_ORBIT, KDR_DRAG_PAN, KDR_DRAG_TURN, KDR_DRAG_BAR } kdr_view_drag;

typedef struct kdr_viewing {
    kdr_view_stage stage;
    kdr_view_clock clock;
    kdr_window *window;
    kdr_picture_def look; /* camera, lights, background */
    kdr_camera home;      /* the camera as it was at first */
    kdr_view_show show;
    bool shadows, cells_shown, panel, help;
    uint32_t cell_depth;

    /* What is wanted. */
    bool quit;
    bool moved;  /* the picture is another one */
    bool redraw; /* what is written over it is */
    bool shot, shot_all;
    kdr_view_drag drag;

    /* What is shown. */
    kdr_view_pace pace;
    kdr_view_picture picture;
    kdr_view_cells cells;
    bool cells_taken;
    kdr_canvas canvas;
    size_t canvas_capacity;
    char note[64]; /* empty: nothing has happened lately */

    /* Figures. */
    uint64_t frames, builds, passes;
    double sample_seconds, build_seconds, trace_seconds; /* of all meshes, builds and passes */
    uint64_t rays;
    double frames_a_second; /* lately */
    double busy_seconds;    /* from the frame before to each of the busy ones */
    uint64_t busy;          /* frames that followed another one without rest */
    double last;            /* when the last frame was shown; 0: it rests */
    double counted_since;
    uint32_t counted;
} kdr_viewing;

#endif
