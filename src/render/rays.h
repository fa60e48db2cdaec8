/* The rays of a picture: from the eye through pixels, and from hit points to lights.
 *
 * A view is a camera made ready for one picture size. With x to the right and y down, both in pixels from the top left
 * corner of the picture, the ray through (x, y) is
 *
 *   half_height = tan(fov / 2),  half_width = half_height * width / height          (square pixels)
 *   direction   = unit(forward + (2 x / width - 1) half_width right + (1 - 2 y / height) half_height up)
 *
 * where forward = unit(target - eye), right = unit(forward x up of the camera) and up = right x forward. The centre of
 * pixel (i, j) is (i + 0.5, j + 0.5). Directions are of unit length, so that distances along a ray are true ones. */
#ifndef KDR_RENDER_RAYS_H
#define KDR_RENDER_RAYS_H

#include "kdray/render.h"
#include "render/vector.h"

typedef struct kdr_view {
    kdr_vector eye;
    kdr_vector forward, right, up; /* unit length, perpendicular to one another */
    float half_width, half_height; /* of the picture at distance 1 */
    uint32_t width, height;        /* pixels */
} kdr_view;

/* NULL, or what is wrong with the camera: the end of a sentence that begins with "the camera". */
const char *kdr_view_make(const kdr_camera *camera, uint32_t width, uint32_t height, kdr_view *view);

static inline kdr_ray kdr_view_ray(const kdr_view *view, float x, float y) {
    float across = (2 * x / (float)view->width - 1) * view->half_width;
    float upward = (1 - 2 * y / (float)view->height) * view->half_height;
    kdr_vector d = kdr_vector_add(
        view->forward, kdr_vector_add(kdr_vector_scale(view->right, across), kdr_vector_scale(view->up, upward)));
    float length = sqrtf(kdr_vector_dot(d, d));
    return (kdr_ray){
        .origin_x = view->eye.x,
        .origin_y = view->eye.y,
        .origin_z = view->eye.z,
        .direction_x = d.x / length,
        .direction_y = d.y / length,
        .direction_z = d.z / length,
        .tmax = INFINITY,
    };
}

/* How far from the light a shadow ray ends: before the surface of a lamp that stands there. */
#define KDR_SHADOW_END 0.9999f

/* How far a hit point is lifted off its surface: 1e-4 of the distance it was seen from, or, where the coordinates are
 * so large that this is lost in their rounding, a few units in the last place. */
static inline float kdr_shadow_lift(kdr_vector origin, kdr_vector point, float distance) {
    float rounding = 0x1p-21f * kdr_larger(kdr_vector_extent(origin), kdr_vector_extent(point));
    return kdr_larger(1e-4f * distance, rounding);
}

/* From the point, lifted along its unit normal, to the light; distances are in units of the way to the light. */
static inline kdr_ray kdr_shadow_ray(kdr_vector point, kdr_vector normal, float lift, kdr_vector light) {
    kdr_vector origin = kdr_vector_add(point, kdr_vector_scale(normal, lift));
    kdr_vector direction = kdr_vector_sub(light, origin);
    return (kdr_ray){
        .origin_x = origin.x,
        .origin_y = origin.y,
        .origin_z = origin.z,
        .direction_x = direction.x,
        .direction_y = direction.y,
        .direction_z = direction.z,
        .tmax = KDR_SHADOW_END,
    };
}

#endif
