#include "fit_view.h"

#include <math.h>

#define MARGIN 0.96 /* of the way from the picture's middle to its edge */

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* False for a vector without a direction. */
static bool normalize(double v[3]) {
    double length = sqrt(dot(v, v));
    for (int k = 0; k < 3; k++)
        v[k] /= length;
    return length > 0 && isfinite(length);
}

void kdr_fit_view(kdr_camera *camera, const float bounds[6], uint32_t width, uint32_t height) {
    double forward[3], right[3], up[3], distance = 0;
    for (int k = 0; k < 3; k++) {
        forward[k] = (double)camera->target[k] - camera->eye[k];
        up[k] = camera->up[k];
        distance += forward[k] * forward[k];
    }
    distance = sqrt(distance);
    if (!normalize(forward))
        return;
    cross(forward, up, right);
    if (!normalize(right))
        return;
    cross(right, forward, up);

    // A corner at (x, y, z) from the target is in view from distance d if |y| is at most (d + z) times this.
    double high = MARGIN * tan(camera->fov * (3.14159265358979323846 / 360)), wide = high * width / height;
    double least = distance;
    for (int corner = 0; corner < 8; corner++) {
        double at[3];
        for (int k = 0; k < 3; k++)
            at[k] = (double)bounds[k + (corner >> k & 1) * 3] - camera->target[k];
        double z = dot(at, forward);
        least = fmax(least, fmax(fabs(dot(at, right)) / wide, fabs(dot(at, up)) / high) - z);
    }
    if (!isfinite(least))
        return;
    for (int k = 0; k < 3; k++)
        camera->eye[k] = (float)(camera->target[k] - least * forward[k]);
}
