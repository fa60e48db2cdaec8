/* How coarse the next picture is, so that what moves keeps moving, and how it becomes finer where nothing does. */
#ifndef KDR_APPS_KDRAY_VIEW_PACE_H
#define KDR_APPS_KDRAY_VIEW_PACE_H

#include <stdbool.h>
#include <stdint.h>

#define KDR_PACE_COARSEST 8

typedef struct kdr_view_pace {
    double pixel_seconds; /* what a pixel took lately; 0: not known */
    uint32_t scale;       /* pixels of the window for one of the picture, in a row; 0: nothing was shown */
    uint32_t sample;      /* of the last pass */
} kdr_view_pace;

typedef struct kdr_view_pass {
    uint32_t scale;  /* 0: there is nothing to do */
    uint32_t sample; /* number of the sample, from 0; above 0 it is added to those before */
} kdr_view_pass;

/* The next pass over a picture of a window with so many pixels. moved: it differs from the one before. spent: seconds
 * that the frame took before tracing. enough: samples a pixel of a picture that rests. */
kdr_view_pass kdr_view_pace_next(kdr_view_pace *pace, bool moved, double pixels, double spent, uint32_t enough);

/* Tells how long a pass took, and how many pixels were traced. */
void kdr_view_pace_learn(kdr_view_pace *pace, double pixels, double seconds);

#endif
