#include "render/shade.h"

#define AMBIENT 0.06f
#define AMBIENT_FACING 0.10f

kdr_vector kdr_shade_ambient(const kdr_surface *surface) {
    float towards_viewer = kdr_larger(0, kdr_vector_dot(surface->shading_normal, surface->viewer));
    return kdr_vector_scale(surface->diffuse, AMBIENT + AMBIENT_FACING * towards_viewer);
}

/* cosine_* are those of the light's direction with the triangle's and the shading normal, both positive. */
static float softening(const kdr_surface *surface, float cosine_flat, float cosine_smooth) {
    float between = kdr_vector_dot(surface->normal, surface->shading_normal);
    float g = cosine_flat / (cosine_smooth * between);
    // Also where the normals are at right angles and the quotient is infinite.
    if (!(g < 1))
        return 1;
    return g * (1 + g * (1 - g));
}

kdr_vector kdr_shade_light(const kdr_surface *surface, const kdr_light *light) {
    kdr_vector n = surface->shading_normal;
    kdr_vector l = kdr_vector_towards(surface->position, light->position);
    float cosine_flat = kdr_vector_dot(surface->normal, l), cosine_smooth = kdr_vector_dot(n, l);
    if (!(cosine_flat > 0) || !(cosine_smooth > 0))
        return (kdr_vector){0, 0, 0};

    kdr_vector mirrored = kdr_vector_sub(kdr_vector_scale(n, 2 * cosine_smooth), l);
    float towards_viewer = kdr_vector_dot(mirrored, surface->viewer);
    float highlight = 0;
    if (surface->specular > 0 && towards_viewer > 0)
        highlight = surface->specular * powf(towards_viewer, surface->shininess);
    kdr_vector sum = kdr_vector_add(kdr_vector_scale(surface->diffuse, cosine_smooth),
                                    (kdr_vector){highlight, highlight, highlight});
    return kdr_vector_scale(sum, light->brightness * softening(surface, cosine_flat, cosine_smooth));
}
