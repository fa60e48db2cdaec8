/* Primitives of one's own: spheres by two functions, over a floor of triangles, drawn in letters. */
#include <kdray/kdray.h>
#include <math.h>
#include <stdio.h>

#define WIDTH 64
#define HEIGHT 14

typedef struct sphere {
    float x, y, z, radius;
} sphere;

/* A box that has room for what floats round. */
static void bounds(uint32_t primitive, float lo[3], float hi[3], void *user) {
    const sphere *s = (const sphere *)user + primitive;
    const float centre[3] = {s->x, s->y, s->z};
    for (int k = 0; k < 3; k++) {
        lo[k] = centre[k] - s->radius * 1.001f;
        hi[k] = centre[k] + s->radius * 1.001f;
    }
}

static bool intersect(const kdr_ray *ray, uint32_t primitive, kdr_custom_hit *hit, void *user) {
    const sphere *s = (const sphere *)user + primitive;
    float x = ray->origin_x - s->x, y = ray->origin_y - s->y, z = ray->origin_z - s->z;
    float a =
        ray->direction_x * ray->direction_x + ray->direction_y * ray->direction_y + ray->direction_z * ray->direction_z;
    float b = ray->direction_x * x + ray->direction_y * y + ray->direction_z * z;
    float inside = b * b - a * (x * x + y * y + z * z - s->radius * s->radius);
    if (inside < 0)
        return false;

    /* The front of the sphere, or its back if the ray starts inside. */
    hit->t = (-b - sqrtf(inside)) / a;
    if (hit->t <= ray->tmin)
        hit->t = (-b + sqrtf(inside)) / a;
    hit->normal_x = x + hit->t * ray->direction_x;
    hit->normal_y = y + hit->t * ray->direction_y;
    hit->normal_z = z + hit->t * ray->direction_z;
    return hit->t > ray->tmin && hit->t <= ray->tmax;
}

static void draw(const kdr_scene *scene, uint32_t floor) {
    for (int row = 0; row < HEIGHT; row++) {
        char line[WIDTH + 1] = {0};
        for (int column = 0; column < WIDTH; column++) {
            kdr_ray_hit ray = {.ray = {.origin_y = 2, .origin_z = -6, .direction_z = 1, .tmax = INFINITY}};
            ray.ray.direction_x = ((float)column + 0.5f) * 1.4f / WIDTH - 0.7f;
            ray.ray.direction_y = 0.02f - ((float)row + 0.5f) * 0.04f;
            kdr_intersect1(scene, &ray);
            if (ray.hit.geometry == KDR_INVALID_ID)
                line[column] = ' ';
            else if (ray.hit.geometry == floor)
                line[column] = '.';
            else
                line[column] = (char)('a' + ray.hit.primitive);
        }
        puts(line);
    }
}

int main(void) {
    static sphere spheres[] = {{-2, 1, 0, 1}, {0, 1, 2, 1}, {2, 1, 0, 1}, {0.3f, 0.4f, -1.5f, 0.4f}};
    kdr_custom_def balls = kdr_default_custom_def();
    balls.primitive_count = sizeof spheres / sizeof spheres[0];
    balls.user = spheres;
    balls.bounds = bounds;
    balls.intersect = intersect;

    static const float vertices[] = {-9, 0, -9, 9, 0, -9, 9, 0, 9, -9, 0, -9, 9, 0, 9, -9, 0, 9};
    kdr_triangles_def square = kdr_default_triangles_def();
    square.vertices = vertices;
    square.vertex_count = 6;
    square.triangle_count = 2;

    kdr_device *device = NULL;
    kdr_scene *scene = NULL;
    uint32_t floor = 0;
    kdr_status status = kdr_device_create(NULL, &device);
    if (status == KDR_OK)
        status = kdr_scene_create(device, &scene);
    if (status == KDR_OK)
        status = kdr_scene_add_triangles(scene, &square, &floor);
    if (status == KDR_OK)
        status = kdr_scene_add_custom(scene, &balls, NULL);
    if (status == KDR_OK)
        status = kdr_scene_commit(scene, NULL); /* again when spheres have moved and kdr_scene_touch says so */
    if (status == KDR_OK)
        draw(scene, floor);
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
    return status;
}
