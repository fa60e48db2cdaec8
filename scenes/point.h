/* Points, directions and frames in double precision, for making scenes.
 *
 * Only + - * / and sqrt are used, here and in every generator, so that a scene is the same bits on every machine: those
 * five are rounded correctly everywhere, while the functions of libm are not. */
#ifndef KDR_SCENES_POINT_H
#define KDR_SCENES_POINT_H

#include <math.h>

typedef struct kdr_point {
    double x, y, z;
} kdr_point;

static inline kdr_point kdr_point_add(kdr_point a, kdr_point b) { return (kdr_point){a.x + b.x, a.y + b.y, a.z + b.z}; }
static inline kdr_point kdr_point_sub(kdr_point a, kdr_point b) { return (kdr_point){a.x - b.x, a.y - b.y, a.z - b.z}; }
static inline kdr_point kdr_point_scale(kdr_point a, double s) { return (kdr_point){a.x * s, a.y * s, a.z * s}; }
static inline double kdr_point_dot(kdr_point a, kdr_point b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline double kdr_point_length(kdr_point a) { return sqrt(kdr_point_dot(a, a)); }

/* a + s b */
static inline kdr_point kdr_point_along(kdr_point a, kdr_point b, double s) {
    return (kdr_point){a.x + b.x * s, a.y + b.y * s, a.z + b.z * s};
}

static inline kdr_point kdr_point_cross(kdr_point a, kdr_point b) {
    return (kdr_point){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* +y for a vector without length. */
static inline kdr_point kdr_point_unit(kdr_point a) {
    double length = kdr_point_length(a);
    return length > 0 ? kdr_point_scale(a, 1 / length) : (kdr_point){0, 1, 0};
}

/* Sine and cosine of an angle in turns (1 is a full circle), which must be finite. Quarter turns give exact 0 and 1. */
typedef struct kdr_turn {
    double sine, cosine;
} kdr_turn;

kdr_turn kdr_turn_of(double turns);

/* How far a motion that repeats every `period` seconds has come at `time`: in [0, 1]. Any finite time is accepted. */
double kdr_phase(double time, double period);

/* A place and three perpendicular axes, which may carry lengths: what a box, a ball or a limb is drawn in. */
typedef struct kdr_frame {
    kdr_point origin, x, y, z;
} kdr_frame;

static inline kdr_point kdr_frame_vector(const kdr_frame *frame, double x, double y, double z) {
    return kdr_point_along(kdr_point_along(kdr_point_scale(frame->x, x), frame->y, y), frame->z, z);
}

static inline kdr_point kdr_frame_point(const kdr_frame *frame, double x, double y, double z) {
    return kdr_point_add(frame->origin, kdr_frame_vector(frame, x, y, z));
}

/* The world's axes at a place, each `size` long. */
kdr_frame kdr_frame_at(kdr_point origin, double size);

/* Unit axes with y along `direction`; x and z are any that fit. */
kdr_frame kdr_frame_along(kdr_point origin, kdr_point direction);

/* The same frame turned about its own y axis, z towards x. */
kdr_frame kdr_frame_turn_y(kdr_frame frame, double turns);

/* The same frame turned about its own x axis, y towards z. */
kdr_frame kdr_frame_turn_x(kdr_frame frame, double turns);

/* Axes made x, y and z times as long. */
kdr_frame kdr_frame_stretch(kdr_frame frame, double x, double y, double z);

#endif
