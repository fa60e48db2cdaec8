#include "view_pace.h"

#include <math.h>

#define FRAME 0.033 /* seconds that a frame in motion may take */
#define LEAST 0.012 /* of them for tracing, whatever came before */
#define SHARE 0.5   /* of what came before, for tracing: a slow build does not make the picture as coarse as can be */
#define RELUCTANCE 0.7 /* of the time that there is: what a finer picture must fit in */

/* The scale that takes at most that time. */
static uint32_t fitting(const kdr_view_pace *pace, double pixels, double time) {
    uint32_t scale = 1;
    while (scale < KDR_PACE_COARSEST && pace->pixel_seconds * pixels / ((double)scale * scale) > time)
        scale++;
    return scale;
}

kdr_view_pass kdr_view_pace_next(kdr_view_pace *pace, bool moved, double pixels, double spent, uint32_t enough) {
    if (moved) {
        double time = fmax(FRAME - spent, fmax(LEAST, SHARE * spent));
        uint32_t scale = fitting(pace, pixels, time);
        // A scale that changes with every frame flickers.
        if (pace->sample == 0 && pace->scale > scale) {
            uint32_t sure = fitting(pace, pixels, RELUCTANCE * time);
            scale = sure < pace->scale ? sure : pace->scale;
        }
        pace->scale = scale;
        pace->sample = 0;
    } else if (pace->scale != 1) {
        pace->scale = pace->scale > 1 ? pace->scale / 2 : 1;
        pace->sample = 0;
    } else {
        pace->sample++;
    }
    if (pace->sample >= enough) {
        pace->sample = enough;
        return (kdr_view_pass){0, 0};
    }
    return (kdr_view_pass){pace->scale, pace->sample};
}

void kdr_view_pace_learn(kdr_view_pace *pace, double pixels, double seconds) {
    double now = seconds / fmax(pixels, 1);
    pace->pixel_seconds = pace->pixel_seconds > 0 ? 0.6 * pace->pixel_seconds + 0.4 * now : now;
}
