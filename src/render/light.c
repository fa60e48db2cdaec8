#include "render/light.h"

#include "render/rays.h"

void kdr_lights_make(const kdr_picture_def *def, kdr_light *lights) {
    for (uint32_t i = 0; i < def->light_count; i++) {
        lights[i].position = kdr_vector_of(def->lights[i]);
        lights[i].brightness = 1 / (float)def->light_count;
    }
}

kdr_ray kdr_light_shadow_ray(const kdr_light *light, const kdr_surface *surface, const kdr_room *room) {
    kdr_ray ray = kdr_shadow_ray(surface->position, surface->normal, surface->lift, light->position);
    if (room)
        kdr_room_leave(room, &ray);
    return ray;
}
