/* What a ray finds where it hits: place, normals and the substance of the surface. */
#ifndef KDR_RENDER_MATERIAL_H
#define KDR_RENDER_MATERIAL_H

#include "kdray/render.h"
#include "render/box.h"

/* Everything a ray of the picture can hit. All borrowed. */
typedef struct kdr_stage {
    const kdr_mesh *mesh; /* geometry 0 */
    const kdr_room *room; /* geometry 1; NULL: none */
    kdr_texture texture;  /* of the room */
} kdr_stage;

typedef struct kdr_surface {
    kdr_vector position;
    kdr_vector normal;         /* of the triangle; unit length, on the viewer's side */
    kdr_vector shading_normal; /* the mesh's own where it has normals; unit length, on the same side */
    kdr_vector viewer;         /* unit direction to where the ray came from */
    kdr_vector diffuse;        /* linear RGB */
    float specular;            /* strength of the highlight */
    float shininess;           /* its exponent */
    float lift;                /* see kdr_shadow_lift */
    uint32_t pixel;            /* the caller's */
} kdr_surface;

/* The surface at a hit. The ray's direction is of unit length. pixel is left alone. */
void kdr_surface_at(const kdr_stage *stage, const kdr_ray_hit *ray_hit, kdr_surface *surface);

#endif
