/* The moment that is shown: it plays, stands, goes by frames, or goes where a bar is dragged. Seconds throughout. */
#ifndef KDR_APPS_KDRAY_VIEW_CLOCK_H
#define KDR_APPS_KDRAY_VIEW_CLOCK_H

#include <stdbool.h>

#define KDR_CLOCK_PAGE 10.0 /* of what never ends, the bar shows so many seconds at a time */

typedef struct kdr_view_clock {
    double duration; /* 0: it stands still; infinity: it never ends */
    double rate;     /* frames a second */
    bool by_frames;  /* nothing changes between two frames */
    bool playing;
    double time;
} kdr_view_clock;

/* Goes on by that time if it plays. Behind the end it begins anew. */
void kdr_view_clock_advance(kdr_view_clock *clock, double seconds);

/* Stops, and goes to a frame: the next one that is so many away. It stays within what there is. */
void kdr_view_clock_step(kdr_view_clock *clock, int frames);

/* Goes on by a time, back if it is below 0, within what there is. */
void kdr_view_clock_skip(kdr_view_clock *clock, double seconds);

/* Where the time is on the bar, 0 to 1, and back. */
double kdr_view_clock_part(const kdr_view_clock *clock);
void kdr_view_clock_seek(kdr_view_clock *clock, double part);

/* What is to be shown: the time, or that of its frame. */
double kdr_view_clock_moment(const kdr_view_clock *clock);

#endif
