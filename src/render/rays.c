#include "render/rays.h"

/* Sine of the least angle between the view and the up direction: below it, rounding would decide which way is up. */
#define LEAST_ANGLE_SINE 1e-6

static bool all_finite(const float v[3]) { return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]); }

static kdr_vector cross_unit(kdr_vector a, kdr_vector b, double *length) {
    double x = (double)a.y * b.z - (double)a.z * b.y;
    double y = (double)a.z * b.x - (double)a.x * b.z;
    double z = (double)a.x * b.y - (double)a.y * b.x;
    *length = sqrt(x * x + y * y + z * z);
    return kdr_vector_unit(x, y, z);
}

const char *kdr_view_make(const kdr_camera *camera, uint32_t width, uint32_t height, kdr_view *view) {
    if (!all_finite(camera->eye) || !all_finite(camera->target) || !all_finite(camera->up))
        return "has a coordinate that is not finite";
    if (!(camera->fov > 0 && camera->fov < 180))
        return "has a field of view that is not between 0 and 180 degrees";

    kdr_vector eye = kdr_vector_of(camera->eye);
    kdr_vector forward = kdr_vector_towards(eye, kdr_vector_of(camera->target));
    if (kdr_vector_dot(forward, forward) == 0)
        return "looks at the point where it stands: eye and target are the same";
    kdr_vector upward = kdr_vector_unit(camera->up[0], camera->up[1], camera->up[2]);
    if (kdr_vector_dot(upward, upward) == 0)
        return "has no up direction: the vector is zero";

    double sine, one;
    kdr_vector right = cross_unit(forward, upward, &sine);
    if (sine < LEAST_ANGLE_SINE)
        return "looks along its up direction";
    *view = (kdr_view){.eye = eye, .forward = forward, .right = right, .up = cross_unit(right, forward, &one)};

    double half_height = tan(camera->fov * (3.14159265358979323846 / 360));
    view->half_height = (float)half_height;
    view->half_width = (float)(half_height * width / height);
    view->width = width;
    view->height = height;
    return NULL;
}
