#include "render/material.h"

#include "render/rays.h"

/* What a triangle without a material is made of. */
#define DEFAULT_DIFFUSE 0.8f
#define MODEL_SPECULAR 0.12f
#define MODEL_SHININESS 32.0f

/* Normals whose components leave this range were spoilt by overflow or underflow of the product they come from. */
#define LEAST_NORMAL 1e-30f
#define LARGEST_NORMAL 1e30f

static const float *corner(const kdr_stage *stage, const kdr_hit *hit, int k) {
    if (hit->geometry != 0)
        return stage->room->vertices[stage->room->indices[hit->primitive][k]];
    return stage->mesh->positions + (size_t)stage->mesh->indices[(size_t)hit->primitive * 3 + k] * 3;
}

/* Unit normal of the triangle, from its corners in double. */
static kdr_vector normal_of_corners(const kdr_stage *stage, const kdr_hit *hit) {
    const float *a = corner(stage, hit, 0), *b = corner(stage, hit, 1), *c = corner(stage, hit, 2);
    double e[3], f[3];
    for (int k = 0; k < 3; k++) {
        e[k] = (double)b[k] - a[k];
        f[k] = (double)c[k] - a[k];
    }
    double x = e[1] * f[2] - e[2] * f[1], y = e[2] * f[0] - e[0] * f[2], z = e[0] * f[1] - e[1] * f[0];
    double largest = fmax(fabs(x), fmax(fabs(y), fabs(z)));
    return largest > 0 ? kdr_vector_unit(x / largest, y / largest, z / largest) : (kdr_vector){0, 0, 0};
}

static kdr_vector unit_normal(const kdr_stage *stage, const kdr_hit *hit) {
    kdr_vector n = {hit->normal_x, hit->normal_y, hit->normal_z};
    float extent = kdr_vector_extent(n);
    if (extent > LEAST_NORMAL && extent < LARGEST_NORMAL)
        return kdr_vector_unit(n.x, n.y, n.z);
    return normal_of_corners(stage, hit);
}

static kdr_vector facing(kdr_vector normal, kdr_vector side) {
    return kdr_vector_dot(normal, side) < 0 ? kdr_vector_scale(normal, -1) : normal;
}

/* The mesh's normals, interpolated. Zero where they cancel out. */
static kdr_vector smooth_normal(const kdr_mesh *mesh, const kdr_hit *hit) {
    const uint32_t *index = mesh->indices + (size_t)hit->primitive * 3;
    const float weight[3] = {1 - hit->u - hit->v, hit->u, hit->v};
    kdr_vector sum = {0, 0, 0};
    for (int k = 0; k < 3; k++) {
        kdr_vector n = kdr_vector_of(mesh->normals + (size_t)index[k] * 3);
        sum = kdr_vector_add(sum, kdr_vector_scale(n, weight[k]));
    }
    return kdr_vector_unit(sum.x, sum.y, sum.z);
}

static kdr_vector model_diffuse(const kdr_mesh *mesh, uint32_t triangle) {
    if (mesh->triangle_materials && mesh->triangle_materials[triangle] < mesh->material_count)
        return kdr_vector_of(mesh->materials[mesh->triangle_materials[triangle]].diffuse);
    return (kdr_vector){DEFAULT_DIFFUSE, DEFAULT_DIFFUSE, DEFAULT_DIFFUSE};
}

void kdr_surface_at(const kdr_stage *stage, const kdr_ray_hit *ray_hit, kdr_surface *surface) {
    const kdr_ray *ray = &ray_hit->ray;
    const kdr_hit *hit = &ray_hit->hit;
    kdr_vector origin = {ray->origin_x, ray->origin_y, ray->origin_z};
    kdr_vector direction = {ray->direction_x, ray->direction_y, ray->direction_z};
    surface->viewer = kdr_vector_scale(direction, -1);
    surface->position = kdr_vector_add(origin, kdr_vector_scale(direction, ray->tmax));
    surface->lift = kdr_shadow_lift(origin, surface->position, ray->tmax);
    surface->normal = facing(unit_normal(stage, hit), surface->viewer);
    surface->shading_normal = surface->normal;

    if (hit->geometry != 0) {
        surface->diffuse = kdr_room_colour(stage->room, &stage->texture, hit->primitive, surface->position);
        surface->specular = 0;
        surface->shininess = 1;
        return;
    }
    if (stage->mesh->normals) {
        kdr_vector smooth = smooth_normal(stage->mesh, hit);
        if (kdr_vector_dot(smooth, smooth) > 0)
            surface->shading_normal = facing(smooth, surface->normal);
    }
    surface->diffuse = model_diffuse(stage->mesh, hit->primitive);
    surface->specular = MODEL_SPECULAR;
    surface->shininess = MODEL_SHININESS;
}
