/* A camera in somebody's hands: it goes around what it looks at, along with it, nearer, or flies. Lengths are in units
 * of the distance from eye to target, so every model feels alike. `up` stays what it is: the horizon never tilts. */
#ifndef KDR_APPS_KDRAY_VIEW_CAMERA_H
#define KDR_APPS_KDRAY_VIEW_CAMERA_H

#include <kdray/render.h>

/* Goes around the target: angles in radians, to the right and upwards. Never over a pole. */
void kdr_camera_orbit(kdr_camera *camera, double right, double up);

/* Turns the head: the target goes around the eye. Never over a pole. */
void kdr_camera_turn(kdr_camera *camera, double right, double up);

/* Shifts eye and target in the plane of the picture; the target goes by so many heights of the picture. */
void kdr_camera_pan(kdr_camera *camera, double right, double up);

/* The distance to the target becomes `factor` times what it was; at least 1e-6 of the largest coordinate. */
void kdr_camera_zoom(kdr_camera *camera, double factor);

/* Flies, target and all. */
void kdr_camera_fly(kdr_camera *camera, double forward, double right, double up);

/* How a camera sees: what is at eye + z (forward + x right + y up) is z away from its plane and, in a picture of
 * height 2 and width 2 * aspect, at (x, y) from the middle, y upwards. */
typedef struct kdr_camera_frame {
    double eye[3], forward[3], right[3], up[3];
} kdr_camera_frame;

/* False if eye and target are one, up points along the view, or a number is not finite. */
bool kdr_camera_frame_make(const kdr_camera *camera, kdr_camera_frame *frame);

/* A point as the camera sees it: {x, y, z} as above; x and y are infinite or NaN where z is 0. */
void kdr_camera_frame_project(const kdr_camera_frame *frame, const double point[3], double seen[3]);

#endif
