/* The textured room around a model, as in the pictures of the 2009 thesis.
 *
 * The model stands on the floor: the wall on the far side of the camera's up direction. The other walls keep a distance
 * of one diagonal of the model from its centre, the ceiling 1.6: room enough for the default camera and its light.
 *
 * Walls are there only for who looks at them from inside. A camera outside looks in through the walls that turn their
 * backs to it, and a light outside shines in through them. Since the room is convex and holds the whole model, this
 * takes no test of walls: the rays are cut to the part that is inside. */
#ifndef KDR_RENDER_BOX_H
#define KDR_RENDER_BOX_H

#include "geometry/box.h"
#include "kdray/render.h"
#include "render/texture.h"

#define KDR_BOX_VERTICES 8
#define KDR_BOX_TRIANGLES 12

typedef struct kdr_room {
    kdr_box extent;
    int up_axis;
    bool up_is_negative;
    float size;   /* length of the texture's repetition: twice the model's diagonal */
    float margin; /* by which a ray's cut goes past a wall */
    float vertices[KDR_BOX_VERTICES][3];
    uint32_t indices[KDR_BOX_TRIANGLES][3]; /* triangles 2k and 2k + 1 are wall k: min x, max x, min y, ... */
} kdr_room;

/* False when there is no model or it is too large for a room of finite size. */
bool kdr_room_make(const float model_bounds[6], const float up[3], kdr_room *room);

/* Moves tmin of a ray that starts outside to just behind the wall it comes in by. */
void kdr_room_enter(const kdr_room *room, kdr_ray *ray);

/* Moves tmax of a ray that starts inside to just before the wall it leaves by. */
void kdr_room_leave(const kdr_room *room, kdr_ray *ray);

/* Colour of the wall that a triangle belongs to, at a point of it. Pictures stand upright on the walls. */
kdr_vector kdr_room_colour(const kdr_room *room, const kdr_texture *texture, uint32_t triangle, kdr_vector point);

#endif
