#include "view_camera.h"

#include <math.h>

#define POLE 0.02 /* radians: nearest to a pole */

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static double length(const double v[3]) { return sqrt(dot(v, v)); }

/* False for a vector without a direction. */
static bool normalize(double v[3]) {
    double size = length(v);
    for (int k = 0; k < 3; k++)
        v[k] /= size;
    return size > 0 && isfinite(size);
}

/* Unit vectors, and the distance from eye to target. False: there are none. */
static bool axes_of(const kdr_camera *camera, double forward[3], double right[3], double up[3], double *distance) {
    for (int k = 0; k < 3; k++) {
        forward[k] = (double)camera->target[k] - (double)camera->eye[k];
        up[k] = (double)camera->up[k];
    }
    *distance = length(forward);
    if (!normalize(forward) || !normalize(up))
        return false;
    cross(forward, up, right);
    if (!normalize(right))
        return false;
    cross(right, forward, up);
    return true;
}

/* A way of that length, turned by angles: around the camera's up, then towards it or away from it. */
static void turn(const kdr_camera *camera, double way[3], double right, double up) {
    double axis[3] = {(double)camera->up[0], (double)camera->up[1], (double)camera->up[2]}, side[3], level[3];
    double size = length(way);
    if (!normalize(axis) || !normalize(way))
        return;
    cross(way, axis, side);
    if (!normalize(side))
        return;
    cross(axis, side, level); // the way without its height
    double height = asin(fmin(fmax(dot(way, axis), -1), 1)) + up;
    double most = 1.57079632679489661923 - POLE;
    height = fmin(fmax(height, -most), most);
    for (int k = 0; k < 3; k++) {
        double flat = cos(right) * level[k] + sin(right) * side[k];
        way[k] = size * (cos(height) * flat + sin(height) * axis[k]);
    }
}

void kdr_camera_orbit(kdr_camera *camera, double right, double up) {
    double way[3];
    for (int k = 0; k < 3; k++)
        way[k] = (double)camera->eye[k] - (double)camera->target[k];
    turn(camera, way, -right, up);
    for (int k = 0; k < 3; k++)
        camera->eye[k] = (float)((double)camera->target[k] + way[k]);
}

void kdr_camera_turn(kdr_camera *camera, double right, double up) {
    double way[3];
    for (int k = 0; k < 3; k++)
        way[k] = (double)camera->target[k] - (double)camera->eye[k];
    turn(camera, way, right, up);
    for (int k = 0; k < 3; k++)
        camera->target[k] = (float)((double)camera->eye[k] + way[k]);
}

/* Shifts eye and target by amounts along the camera's axes. */
static void shift(kdr_camera *camera, double along, double right, double up) {
    double forward[3], sideways[3], upwards[3], distance;
    if (!axes_of(camera, forward, sideways, upwards, &distance))
        return;
    for (int k = 0; k < 3; k++) {
        double by = distance * (along * forward[k] + right * sideways[k] + up * upwards[k]);
        camera->eye[k] = (float)((double)camera->eye[k] + by);
        camera->target[k] = (float)((double)camera->target[k] + by);
    }
}

/* Half the height of what is seen, a unit away. */
static double half_height(const kdr_camera *camera) {
    return tan((double)camera->fov * (3.14159265358979323846 / 360));
}

void kdr_camera_pan(kdr_camera *camera, double right, double up) {
    double height = 2 * half_height(camera);
    shift(camera, 0, -right * height, -up * height);
}

void kdr_camera_zoom(kdr_camera *camera, double factor) {
    double way[3], size = 0;
    for (int k = 0; k < 3; k++) {
        way[k] = (double)camera->eye[k] - (double)camera->target[k];
        size = fmax(size, fmax(fabs((double)camera->eye[k]), fabs((double)camera->target[k])));
    }
    if (factor < 1 && length(way) * factor < 1e-6 * size)
        return;
    for (int k = 0; k < 3; k++)
        camera->eye[k] = (float)((double)camera->target[k] + factor * way[k]);
}

void kdr_camera_fly(kdr_camera *camera, double forward, double right, double up) { shift(camera, forward, right, up); }

bool kdr_camera_frame_make(const kdr_camera *camera, kdr_camera_frame *frame) {
    double distance, half = half_height(camera);
    if (!axes_of(camera, frame->forward, frame->right, frame->up, &distance) || !isfinite(distance))
        return false;
    for (int k = 0; k < 3; k++) {
        frame->eye[k] = (double)camera->eye[k];
        frame->right[k] *= half;
        frame->up[k] *= half;
    }
    return true;
}

void kdr_camera_frame_project(const kdr_camera_frame *frame, const double point[3], double seen[3]) {
    double way[3] = {point[0] - frame->eye[0], point[1] - frame->eye[1], point[2] - frame->eye[2]};
    seen[2] = dot(way, frame->forward);
    seen[0] = dot(way, frame->right) / dot(frame->right, frame->right) / seen[2];
    seen[1] = dot(way, frame->up) / dot(frame->up, frame->up) / seen[2];
}
