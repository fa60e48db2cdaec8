#include "view_tile.h"

#include <math.h>
#include <string.h>

/* Light that comes from nowhere, from where the camera is, and from the lights. */
#define AMBIENT 0.08f
#define HEADLIGHT 0.22f
#define LIGHTS 0.80f

/* Of the largest coordinate: how far a shadow ray begins above its surface. */
#define LIFT 0x1p-17f

static float dot(const float a[3], const float b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* By the largest number first, so that no square leaves the range of floats. */
static void normalize(float v[3]) {
    float largest = fmaxf(fabsf(v[0]), fmaxf(fabsf(v[1]), fabsf(v[2])));
    for (int k = 0; k < 3; k++)
        v[k] = largest > 0 ? v[k] / largest : 0;
    float size = sqrtf(dot(v, v));
    for (int k = 0; k < 3; k++)
        v[k] = size > 0 ? v[k] / size : 0;
}

/* Where in a pixel its samples are: the middle, then the R2 sequence. Source: M. Roberts, "The Unreasonable
 * Effectiveness of Quasirandom Sequences", 2018. */
static void place_of(uint32_t sample, double place[2]) {
    place[0] = 0.5 + 0.7548776662466927 * sample;
    place[1] = 0.5 + 0.5698402909980532 * sample;
    place[0] -= floor(place[0]);
    place[1] -= floor(place[1]);
}

/* Column and row, within a tile, of its i-th ray: squares of 8 times 8, each in Morton order, so that rays that follow
 * one another look through a square. */
static void pixel_of(uint32_t i, uint32_t *x, uint32_t *y) {
    uint32_t square = i / 64, side = KDR_TILE_SIDE / 8;
    *x = square % side * 8 + (i & 1) + (i >> 1 & 2) + (i >> 2 & 4);
    *y = square / side * 8 + (i >> 1 & 1) + (i >> 2 & 2) + (i >> 3 & 4);
}

/* Rays of the tile; their numbers in the picture go to the rays' ids. Returns how many. */
static uint32_t make_rays(kdr_view_painter *painter, const kdr_camera_frame *frame, const kdr_view_raster *raster,
                          uint32_t left, uint32_t top) {
    double place[2], high = raster->window_height, wide = raster->window_width;
    place_of(raster->sample, place);
    uint32_t count = 0;
    for (uint32_t i = 0; i < KDR_TILE_PIXELS; i++) {
        uint32_t x, y;
        pixel_of(i, &x, &y);
        x += left;
        y += top;
        if (x >= raster->width || y >= raster->height)
            continue;
        double right = (2 * (x + place[0]) * raster->scale - wide) / high;
        double up = 1 - 2 * (y + place[1]) * raster->scale / high;
        float direction[3];
        for (int k = 0; k < 3; k++)
            direction[k] = (float)(frame->forward[k] + right * frame->right[k] + up * frame->up[k]);
        painter->hits[count++].ray = (kdr_ray){.origin_x = (float)frame->eye[0],
                                               .origin_y = (float)frame->eye[1],
                                               .origin_z = (float)frame->eye[2],
                                               .direction_x = direction[0],
                                               .direction_y = direction[1],
                                               .direction_z = direction[2],
                                               .tmax = INFINITY,
                                               .id = y * raster->width + x};
    }
    return count;
}

/* Where the edges' product leaves the range of floats: the same of the edges' directions. */
static void normal_of_triangle(const kdr_mesh *mesh, uint32_t triangle, float normal[3]) {
    const uint32_t *corners = &mesh->indices[3 * (size_t)triangle];
    float edges[2][3];
    for (int e = 0; e < 2; e++) {
        for (int k = 0; k < 3; k++)
            edges[e][k] = mesh->positions[3 * (size_t)corners[e + 1] + (size_t)k] -
                          mesh->positions[3 * (size_t)corners[0] + (size_t)k];
        normalize(edges[e]);
    }
    for (int k = 0; k < 3; k++)
        normal[k] = edges[0][(k + 1) % 3] * edges[1][(k + 2) % 3] - edges[0][(k + 2) % 3] * edges[1][(k + 1) % 3];
    normalize(normal);
}

/* The normal at a hit, of the vertices where they have some, unit length; and the triangle's own, both towards the
 * camera. */
static void find_normals(const kdr_mesh *mesh, const kdr_ray_hit *found, float flat[3], float smooth[3]) {
    const kdr_hit *hit = &found->hit;
    const kdr_ray *ray = &found->ray;
    const float way[3] = {ray->direction_x, ray->direction_y, ray->direction_z};
    flat[0] = hit->normal_x, flat[1] = hit->normal_y, flat[2] = hit->normal_z;
    normalize(flat);
    if (!(dot(flat, flat) > 0.5f))
        normal_of_triangle(mesh, hit->primitive, flat);
    if (dot(flat, way) > 0)
        for (int k = 0; k < 3; k++)
            flat[k] = -flat[k];
    memcpy(smooth, flat, 3 * sizeof(float));
    if (!mesh->normals)
        return;
    const uint32_t *corners = &mesh->indices[3 * (size_t)hit->primitive];
    const float weights[3] = {1 - hit->u - hit->v, hit->u, hit->v};
    float sum[3] = {0, 0, 0};
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            sum[k] += weights[c] * mesh->normals[3 * (size_t)corners[c] + (size_t)k];
    normalize(sum);
    float side = dot(sum, flat);
    for (int k = 0; k < 3 && side != 0; k++)
        smooth[k] = side < 0 ? -sum[k] : sum[k];
}

static void add(const kdr_view_raster *raster, float sum[3], const float colour[3]) {
    for (int k = 0; k < 3; k++)
        sum[k] = raster->sample == 0 ? colour[k] : sum[k] + colour[k];
}

static void add_normal(const kdr_view_look *look, const kdr_view_raster *raster, const kdr_ray_hit *found,
                       float sum[3]) {
    float flat[3], smooth[3], colour[3];
    find_normals(look->mesh, found, flat, smooth);
    for (int k = 0; k < 3; k++) {
        // Halves as a screen shows them, since normals are read as numbers
        float code = 0.5f + 0.5f * smooth[k];
        colour[k] = code * code * (0.305306f * code + 0.682171f) + 0.012523f * code;
    }
    add(raster, sum, colour);
}

/* What needs no light's ray: sets point, normal and colour of a hit and adds what shines on it from all around. */
static void add_surface(kdr_view_painter *painter, const kdr_view_look *look, const kdr_view_raster *raster, uint32_t i,
                        float sum[3]) {
    const kdr_mesh *mesh = look->mesh;
    const kdr_ray_hit *found = &painter->hits[i];
    const kdr_ray *ray = &found->ray;
    const float origin[3] = {ray->origin_x, ray->origin_y, ray->origin_z};
    const float direction[3] = {ray->direction_x, ray->direction_y, ray->direction_z};
    static const float plain[3] = {0.8f, 0.8f, 0.8f};
    const float *diffuse = plain;
    if (mesh->triangle_materials)
        diffuse = mesh->materials[mesh->triangle_materials[found->hit.primitive]].diffuse;

    float flat[3], *normal = painter->normals[i], *point = painter->points[i];
    find_normals(mesh, found, flat, normal);
    float largest = 0, towards[3];
    for (int k = 0; k < 3; k++) {
        point[k] = origin[k] + ray->tmax * direction[k];
        largest = fmaxf(largest, fmaxf(fabsf(point[k]), fabsf(origin[k])));
        towards[k] = -direction[k];
    }
    normalize(towards);
    float shine = AMBIENT + HEADLIGHT * fmaxf(0, dot(normal, towards)), colour[3];
    for (int k = 0; k < 3; k++) {
        point[k] += LIFT * largest * flat[k];
        painter->colours[i][k] = diffuse[k];
        colour[k] = shine * diffuse[k];
    }
    add(raster, sum, colour);
}

/* Adds a light to the surfaces of the tile that face it and see it. */
static void add_light(kdr_view_painter *painter, const kdr_view_look *look, uint32_t count, const float light[3],
                      float (*sums)[3]) {
    kdr_trace_def def = kdr_default_trace_def();
    def.coherence = KDR_COHERENCE_COHERENT;
    uint32_t facing = 0;
    for (uint32_t i = 0; i < count; i++) {
        const float *point = painter->points[i];
        if (painter->hits[i].hit.geometry == KDR_INVALID_ID)
            continue;
        const float way[3] = {light[0] - point[0], light[1] - point[1], light[2] - point[2]};
        if (!(dot(way, painter->normals[i]) > 0))
            continue;
        painter->lit[facing] = (uint16_t)i;
        painter->shadows[facing++] = (kdr_ray){.origin_x = point[0],
                                               .origin_y = point[1],
                                               .origin_z = point[2],
                                               .direction_x = way[0],
                                               .direction_y = way[1],
                                               .direction_z = way[2],
                                               .tmax = 1};
    }
    memset(painter->hidden, 0, sizeof painter->hidden);
    if (look->shadows) {
        kdr_occluded_n(look->scene, &def, painter->shadows, painter->hidden, facing);
        painter->rays += facing;
    }
    for (uint32_t j = 0; j < facing; j++) {
        if (painter->hidden[j])
            continue;
        uint32_t i = painter->lit[j];
        const kdr_ray *shadow = &painter->shadows[j];
        float way[3] = {shadow->direction_x, shadow->direction_y, shadow->direction_z};
        normalize(way);
        float shine = LIGHTS / (float)look->picture->light_count * dot(way, painter->normals[i]);
        for (int k = 0; k < 3; k++)
            sums[painter->hits[i].ray.id][k] += shine * painter->colours[i][k];
    }
}

/* What the ray of a pixel costs. Where it hits nothing that is something too. */
static float cost_of(const kdr_view_look *look, const kdr_ray *ray) {
    kdr_ray_cost cost;
    kdr_cost1(look->scene, ray, &cost);
    return (float)(look->show == KDR_SHOW_NODES ? cost.nodes : cost.primitives);
}

void kdr_view_tile_trace(kdr_view_painter *painter, const kdr_view_look *look, const kdr_camera_frame *frame,
                         const kdr_view_raster *raster, uint32_t x, uint32_t y, float (*sums)[3], float *depth) {
    kdr_trace_def def = kdr_default_trace_def();
    def.coherence = KDR_COHERENCE_COHERENT;
    uint32_t count = make_rays(painter, frame, raster, x, y);
    kdr_intersect_n(look->scene, &def, painter->hits, count);
    painter->rays += count;

    for (uint32_t i = 0; i < count; i++) {
        kdr_ray_hit *found = &painter->hits[i];
        float *sum = sums[found->ray.id];
        bool hit = found->hit.geometry != KDR_INVALID_ID;
        if (raster->sample == 0)
            depth[found->ray.id] = hit ? found->ray.tmax : INFINITY;
        if (look->show == KDR_SHOW_DEPTH)
            sum[0] = hit ? found->ray.tmax : -1;
        else if (kdr_view_show_is_value(look->show))
            sum[0] = cost_of(look, &found->ray);
        else if (!hit)
            add(raster, sum, look->picture->background);
        else if (look->show == KDR_SHOW_NORMALS)
            add_normal(look, raster, found, sum);
        else
            add_surface(painter, look, raster, i, sum);
    }
    for (uint32_t l = 0; look->show == KDR_SHOW_SHADED && l < look->picture->light_count; l++)
        add_light(painter, look, count, look->picture->lights[l], sums);
}
