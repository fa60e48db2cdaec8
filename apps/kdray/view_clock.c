#include "view_clock.h"

#include <math.h>

#define SAME 1e-6 /* frames: times that are this near are one */

static bool ends(const kdr_view_clock *clock) { return isfinite(clock->duration); }

static void set(kdr_view_clock *clock, double time) {
    if (clock->duration <= 0)
        return;
    clock->time = fmax(0, ends(clock) ? fmin(time, clock->duration) : time);
}

void kdr_view_clock_advance(kdr_view_clock *clock, double seconds) {
    if (!clock->playing || clock->duration <= 0)
        return;
    clock->time += seconds;
    if (ends(clock) && clock->time >= clock->duration)
        clock->time = fmod(clock->time, clock->duration);
}

void kdr_view_clock_step(kdr_view_clock *clock, int frames) {
    clock->playing = false;
    double at = clock->time * clock->rate;
    // Between two frames the nearer one in that direction is one away.
    double from = frames > 0 ? floor(at + SAME) : ceil(at - SAME);
    set(clock, (from + frames) / clock->rate);
}

void kdr_view_clock_skip(kdr_view_clock *clock, double seconds) { set(clock, clock->time + seconds); }

/* Where the bar begins, and how long it is. */
static double page(const kdr_view_clock *clock, double *length) {
    *length = ends(clock) ? clock->duration : KDR_CLOCK_PAGE;
    return ends(clock) ? 0 : floor(clock->time / KDR_CLOCK_PAGE) * KDR_CLOCK_PAGE;
}

double kdr_view_clock_part(const kdr_view_clock *clock) {
    double length, begin = page(clock, &length);
    return length > 0 ? (clock->time - begin) / length : 0;
}

void kdr_view_clock_seek(kdr_view_clock *clock, double part) {
    double length, begin = page(clock, &length);
    part = fmin(fmax(part, 0), 1);
    // The end of a page is the beginning of the next one.
    if (!ends(clock))
        part = fmin(part, 0.9999);
    set(clock, begin + part * length);
}

double kdr_view_clock_moment(const kdr_view_clock *clock) {
    return clock->by_frames ? floor(clock->time * clock->rate + SAME) / clock->rate : clock->time;
}
