/* White point lights. Together they have one unit of brightness, which does not fall off with distance. */
#ifndef KDR_RENDER_LIGHT_H
#define KDR_RENDER_LIGHT_H

#include "kdray/render.h"
#include "render/material.h"

typedef struct kdr_light {
    kdr_vector position;
    float brightness;
} kdr_light;

/* lights has room for KDR_MAX_LIGHTS. */
void kdr_lights_make(const kdr_picture_def *def, kdr_light *lights);

/* The ray that asks whether a surface sees a light. Walls of the room do not stand in the way. room may be NULL. */
kdr_ray kdr_light_shadow_ray(const kdr_light *light, const kdr_surface *surface, const kdr_room *room);

#endif
