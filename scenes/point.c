#include "scenes/point.h"

/* Taylor polynomials, on an eighth of a turn to either side of a quarter turn: the error stays below 1e-15. */
static double sine_near_zero(double radians) {
    double s = radians * radians;
    return radians *
           (1 - s / 6 * (1 - s / 20 * (1 - s / 42 * (1 - s / 72 * (1 - s / 110 * (1 - s / 156 * (1 - s / 210)))))));
}

static double cosine_near_zero(double radians) {
    double s = radians * radians;
    return 1 - s / 2 * (1 - s / 12 * (1 - s / 30 * (1 - s / 56 * (1 - s / 90 * (1 - s / 132 * (1 - s / 182))))));
}

kdr_turn kdr_turn_of(double turns) {
    turns -= floor(turns);
    int quarter = (int)(turns * 4 + 0.5);
    double radians = (turns - quarter * 0.25) * 6.283185307179586477;
    double sine = sine_near_zero(radians), cosine = cosine_near_zero(radians);
    switch (quarter & 3) {
    case 0: return (kdr_turn){sine, cosine};
    case 1: return (kdr_turn){cosine, -sine};
    case 2: return (kdr_turn){-sine, -cosine};
    default: return (kdr_turn){-cosine, sine};
    }
}

/* fmod is exact, so it is as portable as the operators. */
double kdr_phase(double time, double period) {
    double phase = fmod(time, period) / period;
    return phase < 0 ? phase + 1 : phase;
}

kdr_frame kdr_frame_at(kdr_point origin, double size) {
    return (kdr_frame){origin, {size, 0, 0}, {0, size, 0}, {0, 0, size}};
}

kdr_frame kdr_frame_along(kdr_point origin, kdr_point direction) {
    kdr_frame frame = {.origin = origin, .y = kdr_point_unit(direction)};
    kdr_point other = frame.y.x * frame.y.x < 0.5 ? (kdr_point){1, 0, 0} : (kdr_point){0, 0, 1};
    frame.z = kdr_point_unit(kdr_point_cross(other, frame.y));
    frame.x = kdr_point_cross(frame.y, frame.z);
    return frame;
}

kdr_frame kdr_frame_turn_y(kdr_frame frame, double turns) {
    kdr_turn turn = kdr_turn_of(turns);
    kdr_frame turned = frame;
    turned.x = kdr_point_along(kdr_point_scale(frame.x, turn.cosine), frame.z, -turn.sine);
    turned.z = kdr_point_along(kdr_point_scale(frame.z, turn.cosine), frame.x, turn.sine);
    return turned;
}

kdr_frame kdr_frame_turn_x(kdr_frame frame, double turns) {
    kdr_turn turn = kdr_turn_of(turns);
    kdr_frame turned = frame;
    turned.y = kdr_point_along(kdr_point_scale(frame.y, turn.cosine), frame.z, turn.sine);
    turned.z = kdr_point_along(kdr_point_scale(frame.z, turn.cosine), frame.y, -turn.sine);
    return turned;
}

kdr_frame kdr_frame_stretch(kdr_frame frame, double x, double y, double z) {
    frame.x = kdr_point_scale(frame.x, x);
    frame.y = kdr_point_scale(frame.y, y);
    frame.z = kdr_point_scale(frame.z, z);
    return frame;
}
