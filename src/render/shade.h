/* Phong's reflection model: how much light a surface sends to the viewer.
 *
 *   ambient      diffuse (0.06 + 0.10 max(0, n.v))
 *   each light   brightness (diffuse (n.l) + specular max(0, r.v)^shininess) softened,  where n.l > 0 and it is visible
 *
 * n is the shading normal, v the direction to the viewer, l to the light, r = 2 (n.l) n - l. The ambient part is
 * brighter where a surface faces the viewer, so that shadows keep their form, and nothing is black that is not so by
 * itself. Both sides of a triangle shine alike: n lies on the viewer's side.
 *
 * Source: B. T. Phong, "Illumination for Computer Generated Pictures", 1975.
 * Softening: where smooth normals stand on flat triangles, light comes to a triangle at an angle at which the triangle
 * itself is turned away, and the edge between light and shadow shows the facets. The factor of M. Chiang, Y. Li and
 * B. Burley, "Taming the Shadow Terminator", 2019, fades the light out before: with G = (g.l) / ((n.l) (g.n)), at most
 * 1, and g the triangle's normal, it is -G^3 + G^2 + G. It is 1 on flat triangles. */
#ifndef KDR_RENDER_SHADE_H
#define KDR_RENDER_SHADE_H

#include "render/light.h"
#include "render/material.h"

/* Linear RGB without any light. */
kdr_vector kdr_shade_ambient(const kdr_surface *surface);

/* What a light that the surface sees adds. */
kdr_vector kdr_shade_light(const kdr_surface *surface, const kdr_light *light);

#endif
