/* The benchmark's rays are those that its description says, and the same however they are made. */
#include "apps/kdray/bench.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define WIDTH 136 /* two blocks and a bit, a tile beyond */
#define HEIGHT 70

static kdr_mesh *mesh;

static void print_sentence(kdr_log_level level, const char *message, void *user) {
    (void)level;
    (void)user;
    print_message("%s\n", message);
}

static const kdr_logger logger = {print_sentence, NULL};

/* A scene, its device and its rays. */
typedef struct made {
    kdr_bench_scene scene;
    kdr_scene *reference;
    kdr_bench_workload workload;
} made;

static kdr_bench_scene scene_with(uint32_t workers) {
    kdr_bench_scene scene = {.mesh = mesh, .width = WIDTH, .height = HEIGHT};
    float bounds[6];
    kdr_mesh_bounds(mesh, bounds);
    scene.camera = kdr_camera_for_bounds(bounds);
    kdr_light_for_bounds(bounds, scene.light);
    kdr_device_def def = kdr_default_device_def();
    def.worker_count = workers;
    assert_int_equal(kdr_device_create(&def, &scene.device), KDR_OK);
    return scene;
}

static made make(uint32_t workers) {
    made m = {.scene = scene_with(workers)};
    kdr_triangles_def triangles = kdr_default_triangles_def();
    triangles.vertices = mesh->positions;
    triangles.vertex_count = mesh->vertex_count;
    triangles.indices = mesh->indices;
    triangles.triangle_count = mesh->triangle_count;
    assert_int_equal(kdr_scene_create(m.scene.device, &m.reference), KDR_OK);
    assert_int_equal(kdr_scene_add_triangles(m.reference, &triangles, NULL), KDR_OK);
    assert_int_equal(kdr_scene_commit(m.reference, NULL), KDR_OK);
    assert_true(kdr_bench_workload_make(&m.scene, m.reference, &logger, &m.workload));
    return m;
}

static void release(made *m) {
    kdr_bench_workload_release(&m->workload);
    kdr_scene_destroy(m->reference);
    kdr_device_destroy(m->scene.device);
}

typedef struct vector {
    double x, y, z;
} vector;

static vector vector_of(const float v[3]) { return (vector){v[0], v[1], v[2]}; }
static vector origin_of(const kdr_ray *ray) { return (vector){ray->origin_x, ray->origin_y, ray->origin_z}; }
static vector direction_of(const kdr_ray *ray) {
    return (vector){ray->direction_x, ray->direction_y, ray->direction_z};
}
static double dot(vector a, vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static double length(vector a) { return sqrt(dot(a, a)); }
static vector add(vector a, double s, vector b) { return (vector){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z}; }
static double distance(vector a, vector b) { return length(add(a, -1, b)); }

static vector cross_unit(vector a, vector b) {
    vector c = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    double s = 1 / length(c);
    return (vector){s * c.x, s * c.y, s * c.z};
}

/* Column and row, in pixels, of the point that a primary ray looks through. */
static void pixel_of(const kdr_bench_scene *scene, const kdr_ray *ray, double *x, double *y) {
    vector forward = add(vector_of(scene->camera.target), -1, vector_of(scene->camera.eye));
    vector right = cross_unit(forward, vector_of(scene->camera.up)), up = cross_unit(right, forward);
    vector direction = direction_of(ray);
    double along = dot(direction, forward) / length(forward), half = tan(scene->camera.fov * acos(-1) / 360);
    *x = (1 + dot(direction, right) / along / (half * WIDTH / HEIGHT)) / 2 * WIDTH;
    *y = (1 - dot(direction, up) / along / half) / 2 * HEIGHT;
}

static void primary_rays_look_through_every_pixel_once_block_by_block_and_tile_by_tile(void **state) {
    (void)state;
    made m = make(1);
    const kdr_bench_rays *rays = &m.workload.kinds[KDR_BENCH_PRIMARY];
    assert_int_equal(rays->count, WIDTH * HEIGHT);
    assert_false(rays->any);
    static uint8_t seen[HEIGHT][WIDTH];
    memset(seen, 0, sizeof seen);
    long last_block = -1, last_tile = -1;
    for (size_t i = 0; i < rays->count; i++) {
        double x, y;
        pixel_of(&m.scene, &rays->rays[i], &x, &y);
        assert_true(fabs(x - floor(x) - 0.5) < 0.01 && fabs(y - floor(y) - 0.5) < 0.01); /* through the centre */
        int column = (int)x, row = (int)y;
        assert_in_range(column, 0, WIDTH - 1);
        assert_in_range(row, 0, HEIGHT - 1);
        assert_int_equal(seen[row][column]++, 0);
        long block = row / 64 * 3 + column / 64, tile = row % 64 / 8 * 8 + column % 64 / 8;
        assert_true(block > last_block || (block == last_block && tile >= last_tile));
        last_block = block;
        last_tile = tile;
        assert_true(fabs(length(direction_of(&rays->rays[i])) - 1) < 1e-6);
        assert_true(rays->rays[i].tmin == 0 && isinf(rays->rays[i].tmax));
    }
    release(&m);
}

/* Where a primary ray ended. */
typedef struct primary_hit {
    double t;
    vector point, normal; /* unit length, towards the eye */
    vector lifted;        /* by 1e-4 t along the normal: where secondary rays begin */
} primary_hit;

/* Calls check for every primary hit; returns their number. */
static size_t for_each_hit(const made *m, void (*check)(const made *m, const primary_hit *hit, size_t number)) {
    const kdr_bench_rays *rays = &m->workload.kinds[KDR_BENCH_PRIMARY];
    size_t hits = 0;
    for (size_t i = 0; i < rays->count; i++) {
        kdr_ray_hit found = {.ray = rays->rays[i]};
        kdr_intersect1(m->reference, &found);
        if (found.hit.geometry == KDR_INVALID_ID)
            continue;
        primary_hit hit = {.t = found.ray.tmax};
        hit.point = add(origin_of(&found.ray), hit.t, direction_of(&found.ray));
        vector normal = {found.hit.normal_x, found.hit.normal_y, found.hit.normal_z};
        double side = dot(normal, direction_of(&found.ray)) > 0 ? -1 : 1;
        hit.normal = add((vector){0, 0, 0}, side / length(normal), normal);
        hit.lifted = add(hit.point, 1e-4 * hit.t, hit.normal);
        check(m, &hit, hits++);
    }
    return hits;
}

static void check_shadow(const made *m, const primary_hit *hit, size_t number) {
    const kdr_ray *ray = &m->workload.kinds[KDR_BENCH_SHADOW].rays[number];
    vector origin = origin_of(ray), light = vector_of(m->scene.light);
    double reach = distance(origin, light);
    assert_true(distance(origin, hit->lifted) < 1e-5 * hit->t);
    assert_true(fabs(ray->tmax / reach - 0.9999) < 1e-6);
    assert_true(distance(add(origin, reach, direction_of(ray)), light) < 1e-5 * reach);
}

static void shadow_rays_go_from_each_hit_to_just_before_the_light(void **state) {
    (void)state;
    made m = make(1);
    size_t hits = for_each_hit(&m, check_shadow);
    assert_true(hits > 1000);
    assert_int_equal(m.workload.kinds[KDR_BENCH_SHADOW].count, hits);
    assert_true(m.workload.kinds[KDR_BENCH_SHADOW].any);
    release(&m);
}

static double cosine_sum, square_sum;

static void check_hemisphere(const made *m, const primary_hit *hit, size_t number) {
    for (size_t i = 4 * number; i < 4 * number + 4; i++) {
        const kdr_ray *ray = &m->workload.kinds[KDR_BENCH_AO].rays[i];
        double cosine = dot(direction_of(ray), hit->normal);
        assert_true(cosine > -1e-5);
        assert_true(fabs(length(direction_of(ray)) - 1) < 1e-6);
        assert_true(distance(origin_of(ray), hit->lifted) < 1e-5 * hit->t);
        assert_true(isinf(ray->tmax));
        cosine_sum += cosine;
        square_sum += cosine * cosine;
    }
}

static void four_rays_leave_each_hit_distributed_by_the_cosine(void **state) {
    (void)state;
    made m = make(1);
    cosine_sum = square_sum = 0;
    size_t count = 4 * for_each_hit(&m, check_hemisphere);
    assert_int_equal(m.workload.kinds[KDR_BENCH_AO].count, count);
    assert_true(fabs(cosine_sum / (double)count - 2.0 / 3) < 0.02); /* of a density of cos / pi */
    assert_true(fabs(square_sum / (double)count - 1.0 / 2) < 0.02);

    const kdr_bench_rays *ao = &m.workload.kinds[KDR_BENCH_AO], *diffuse = &m.workload.kinds[KDR_BENCH_DIFFUSE];
    assert_true(ao->any && !diffuse->any);
    assert_ptr_equal(ao->rays, diffuse->rays);
    assert_int_equal(ao->count, diffuse->count);
    release(&m);
}

static void rays_are_the_same_every_time_and_for_any_number_of_workers(void **state) {
    (void)state;
    made one = make(1), three = make(3);
    for (int kind = 0; kind < KDR_BENCH_KINDS; kind++) {
        const kdr_bench_rays *a = &one.workload.kinds[kind], *b = &three.workload.kinds[kind];
        assert_int_equal(a->count, b->count);
        assert_memory_equal(a->rays, b->rays, a->count * sizeof *a->rays);
    }
    release(&one);
    release(&three);
}

static void a_camera_without_a_view_is_refused(void **state) {
    (void)state;
    kdr_bench_scene scene = scene_with(1);
    kdr_scene *empty;
    kdr_bench_workload workload;
    assert_int_equal(kdr_scene_create(scene.device, &empty), KDR_OK);
    memcpy(scene.camera.target, scene.camera.eye, sizeof scene.camera.target);
    assert_false(kdr_bench_workload_make(&scene, empty, &logger, &workload));
    scene.camera.target[1] += 1; /* straight up */
    assert_false(kdr_bench_workload_make(&scene, empty, &logger, &workload));
    kdr_scene_destroy(empty);
    kdr_device_destroy(scene.device);
}

static void a_view_past_everything_leaves_no_secondary_rays(void **state) {
    (void)state;
    kdr_bench_scene scene = scene_with(2);
    kdr_scene *empty;
    kdr_bench_workload workload;
    assert_int_equal(kdr_scene_create(scene.device, &empty), KDR_OK);
    assert_true(kdr_bench_workload_make(&scene, empty, &logger, &workload));
    assert_int_equal(workload.kinds[KDR_BENCH_PRIMARY].count, WIDTH * HEIGHT);
    assert_int_equal(workload.kinds[KDR_BENCH_SHADOW].count, 0);
    assert_int_equal(workload.kinds[KDR_BENCH_DIFFUSE].count, 0);
    kdr_bench_workload_release(&workload);
    kdr_scene_destroy(empty);
    kdr_device_destroy(scene.device);
}

static void take_block(void *context, size_t begin, size_t end) {
    uint8_t *seen = context;
    for (size_t i = begin; i < end; i++)
        seen[i]++;
}

static void every_ray_belongs_to_one_block_whatever_their_number(void **state) {
    (void)state;
    static const size_t counts[] = {
        0, 1, KDR_BENCH_BLOCK - 1, KDR_BENCH_BLOCK, KDR_BENCH_BLOCK + 1, 5 * KDR_BENCH_BLOCK + 7};
    static uint8_t seen[6 * KDR_BENCH_BLOCK];
    kdr_bench_scene scene = scene_with(3);
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        memset(seen, 0, sizeof seen);
        kdr_bench_run(&scene, counts[i], take_block, seen);
        for (size_t k = 0; k < sizeof seen; k++)
            assert_int_equal(seen[k], k < counts[i]);
    }
    kdr_device_destroy(scene.device);
}

static int make_mesh(void **state) {
    (void)state;
    return kdr_mesh_make("flake", 2000, 0, &logger, &mesh) != KDR_OK;
}

static int destroy_mesh(void **state) {
    (void)state;
    kdr_mesh_destroy(mesh);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(primary_rays_look_through_every_pixel_once_block_by_block_and_tile_by_tile),
        cmocka_unit_test(shadow_rays_go_from_each_hit_to_just_before_the_light),
        cmocka_unit_test(four_rays_leave_each_hit_distributed_by_the_cosine),
        cmocka_unit_test(rays_are_the_same_every_time_and_for_any_number_of_workers),
        cmocka_unit_test(a_camera_without_a_view_is_refused),
        cmocka_unit_test(a_view_past_everything_leaves_no_secondary_rays),
        cmocka_unit_test(every_ray_belongs_to_one_block_whatever_their_number),
    };
    return cmocka_run_group_tests(tests, make_mesh, destroy_mesh);
}
