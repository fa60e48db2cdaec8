#include "view_input.h"

#include "view_camera.h"
#include "view_keys.h"
#include "view_plans.h"

#include <math.h>
#include <string.h>

#define HALF_TURN 3.14159265358979323846
#define ZOOM_STEP 0.88 /* of the distance, for a step of the wheel */
#define FLY_SPEED 0.7  /* distances to the target in a second */
#define FLY_FASTER 4.0
#define TAP (1.0 / 60) /* seconds that a key counts for when it goes down */
#define CELL_DEEPEST 60u

static void set_show(kdr_viewing *view, kdr_view_show show) {
    view->show = show;
    view->moved = true;
}

static void next_trace(kdr_viewing *view, bool back) {
    uint32_t count = 0, now = view->stage.trace;
    while (kdr_view_trace_name(count))
        count++;
    view->stage.trace = (kdr_trace_rule)((now + (back ? count - 1 : 1)) % count);
}

static void set_cells(kdr_viewing *view, int deeper) {
    if (deeper == 0)
        view->cells_shown = !view->cells_shown;
    else if (deeper < 0 ? view->cell_depth > 0 : view->cell_depth < CELL_DEEPEST)
        view->cell_depth += (uint32_t)deeper;
    view->cells_taken = false;
    view->redraw = true;
}

static void reset_camera(kdr_viewing *view) {
    view->look.camera = view->home;
    view->moved = true;
}

/* The beginning of what moves; of what does not, the camera's. */
static void go_home(kdr_viewing *view) {
    if (view->clock.duration > 0)
        kdr_view_clock_skip(&view->clock, -view->clock.time);
    else
        reset_camera(view);
}

static void act(kdr_viewing *view, kdr_view_key key, bool shift) {
    kdr_view_clock *clock = &view->clock;
    switch (key.action) {
    case KDR_ACTION_QUIT: view->quit = true; break;
    case KDR_ACTION_HELP: view->help = !view->help; break;
    case KDR_ACTION_PANEL: view->panel = !view->panel; break;
    case KDR_ACTION_PLAY: clock->playing = !clock->playing && clock->duration > 0; break;
    case KDR_ACTION_FRAME_BACK: kdr_view_clock_step(clock, -1); break;
    case KDR_ACTION_FRAME_ON: kdr_view_clock_step(clock, 1); break;
    case KDR_ACTION_SECOND_BACK: kdr_view_clock_skip(clock, -1); break;
    case KDR_ACTION_SECOND_ON: kdr_view_clock_skip(clock, 1); break;
    case KDR_ACTION_BEGIN: go_home(view); break;
    case KDR_ACTION_END: kdr_view_clock_seek(clock, 1); break;
    case KDR_ACTION_RESET: reset_camera(view); break;
    case KDR_ACTION_SHOW: set_show(view, (kdr_view_show)key.number); break;
    case KDR_ACTION_SHOW_NEXT:
        set_show(view, (kdr_view_show)((view->show + (shift ? KDR_SHOW_COUNT - 1 : 1)) % KDR_SHOW_COUNT));
        break;
    case KDR_ACTION_SHADOWS:
        view->shadows = !view->shadows;
        view->moved = true;
        break;
    case KDR_ACTION_CELLS: set_cells(view, 0); break;
    case KDR_ACTION_CELLS_UP: set_cells(view, -1); break;
    case KDR_ACTION_CELLS_DOWN: set_cells(view, 1); break;
    case KDR_ACTION_PLAN: view->stage.plan = key.number; break;
    case KDR_ACTION_TRACE_NEXT: next_trace(view, shift); break;
    case KDR_ACTION_SHOT: view->shot = true; break;
    case KDR_ACTION_SHOT_ALL: view->shot_all = true; break;
    case KDR_ACTION_NONE: return;
    }
    view->note[0] = 0;
    view->redraw = true;
}

/* There and back on each axis: forward, right, up. */
static const char *const fly_keys[] = {"W", "S", "D", "A", "E", "Q"};

#define FLY_KEYS 6

/* A key that is down for less than a frame moves the camera too. */
static void tap(kdr_viewing *view, const char *key) {
    for (int i = 0; i < FLY_KEYS; i++)
        if (strcmp(key, fly_keys[i]) == 0) {
            double ways[3] = {0, 0, 0};
            ways[i / 2] = (i % 2 ? -1 : 1) * FLY_SPEED * TAP;
            kdr_camera_fly(&view->look.camera, ways[0], ways[1], ways[2]);
            view->moved = true;
        }
}

/* What a key that is held does again and again, and what only once. */
static bool goes_on(kdr_view_action action) {
    return (action >= KDR_ACTION_FRAME_BACK && action <= KDR_ACTION_SECOND_ON) || action == KDR_ACTION_CELLS_UP ||
           action == KDR_ACTION_CELLS_DOWN;
}

static void press(kdr_viewing *view, const kdr_window_event *event) {
    double part = -1;
    if (view->clock.duration > 0 && view->panel)
        part = kdr_view_panel_on_bar(view->canvas.width, view->canvas.height, event->x, event->y);
    if (event->button == KDR_BUTTON_LEFT && part >= 0) {
        view->drag = KDR_DRAG_BAR;
        view->clock.playing = false;
        kdr_view_clock_seek(&view->clock, part);
        view->redraw = true;
    } else if (event->button == KDR_BUTTON_MIDDLE || (event->button == KDR_BUTTON_LEFT && event->shift)) {
        view->drag = KDR_DRAG_PAN;
    } else if (event->button == KDR_BUTTON_LEFT) {
        view->drag = KDR_DRAG_ORBIT;
    } else if (event->button == KDR_BUTTON_RIGHT) {
        view->drag = KDR_DRAG_TURN;
    }
}

static void drag(kdr_viewing *view, const kdr_window_event *event) {
    kdr_camera *camera = &view->look.camera;
    int width = view->canvas.width, height = view->canvas.height;
    double right = (double)event->by_x / height, up = -(double)event->by_y / height;
    double seen = (double)camera->fov / 180 * HALF_TURN; // from the lower edge to the upper one
    switch (view->drag) {
    case KDR_DRAG_NONE: return;
    case KDR_DRAG_ORBIT: kdr_camera_orbit(camera, -HALF_TURN * right, -HALF_TURN * up); break;
    case KDR_DRAG_PAN: kdr_camera_pan(camera, right, up); break;
    case KDR_DRAG_TURN: kdr_camera_turn(camera, seen * right, seen * up); break;
    case KDR_DRAG_BAR:
        kdr_view_clock_seek(&view->clock, kdr_view_panel_along_bar(width, height, event->x));
        view->redraw = true;
        return;
    }
    view->moved = true;
}

void kdr_view_input_take(kdr_viewing *view, const kdr_window_event *event) {
    kdr_view_key key;
    switch (event->news) {
    case KDR_NEWS_NONE: break;
    case KDR_NEWS_CLOSED: view->quit = true; break;
    case KDR_NEWS_CHANGED: view->redraw = true; break;
    case KDR_NEWS_KEY:
        key = kdr_view_key_find(event->key);
        if (!event->repeated || goes_on(key.action))
            act(view, key, event->shift);
        if (!event->repeated)
            tap(view, event->key);
        break;
    case KDR_NEWS_PRESS: press(view, event); break;
    case KDR_NEWS_RELEASE: view->drag = KDR_DRAG_NONE; break;
    case KDR_NEWS_MOVE: drag(view, event); break;
    case KDR_NEWS_WHEEL:
        kdr_camera_zoom(&view->look.camera, pow(ZOOM_STEP, event->wheel));
        view->moved = true;
        break;
    }
}

void kdr_view_input_fly(kdr_viewing *view, double seconds) {
    const kdr_window *window = view->window;
    double by = seconds * FLY_SPEED, ways[3] = {0, 0, 0};
    if (kdr_window_holds(window, "Left Shift") || kdr_window_holds(window, "Right Shift"))
        by *= FLY_FASTER;
    for (int i = 0; i < FLY_KEYS; i++)
        if (kdr_window_holds(window, fly_keys[i]))
            ways[i / 2] += i % 2 ? -by : by;
    if (ways[0] == 0 && ways[1] == 0 && ways[2] == 0)
        return;
    kdr_camera_fly(&view->look.camera, ways[0], ways[1], ways[2]);
    view->moved = true;
}
