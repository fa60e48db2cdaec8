/* A view that shows a model whole. */
#ifndef KDR_APPS_KDRAY_FIT_VIEW_H
#define KDR_APPS_KDRAY_FIT_VIEW_H

#include <kdray/render.h>

/* Moves the eye straight back from the target until the whole box {min x, y, z, max x, y, z} is in a picture of that
 * size, with a margin; never forward. A box that is empty or not finite leaves the camera alone. */
void kdr_fit_view(kdr_camera *camera, const float bounds[6], uint32_t width, uint32_t height);

#endif
