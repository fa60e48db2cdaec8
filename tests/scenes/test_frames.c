/* One scene committed again for every frame: each frame is what the same scene built afresh is, it answers as the
 * oracle does, and neither memory nor anything else grows, however many there are. */
#include "kdray/render.h"
#include "support/awkward_rays.h"
#include "support/everywhere.h"
#include "support/failing_alloc.h"
#include "support/test_size.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#define TRIANGLES 1500
#define RAYS TEST_SIZE(200)
#define STILL_FRAMES 8 /* different ones in a long run, shown over and over */
#define LATE_BYTES                                                                                                     \
    ((size_t)4 << 20) /* what a worker takes when it first works: chunks of its arenas and a few blocks */

static kdr_triangles_def def_of(const kdr_mesh *mesh) {
    kdr_triangles_def def = kdr_default_triangles_def();
    def.vertices = mesh->positions;
    def.vertex_count = mesh->vertex_count;
    def.indices = mesh->indices;
    def.triangle_count = mesh->triangle_count;
    return def;
}

static kdr_scene *one_geometry(kdr_device *device, bool double_buffered) {
    kdr_scene_def scene_def = kdr_default_scene_def();
    scene_def.double_buffered = double_buffered;
    kdr_triangles_def def = kdr_default_triangles_def();
    kdr_scene *scene;
    assert_int_equal(kdr_scene_create_with(device, &scene_def, &scene), KDR_OK);
    assert_int_equal(kdr_scene_add_triangles(scene, &def, NULL), KDR_OK);
    return scene;
}

static void show(kdr_scene *scene, const kdr_mesh *mesh, const kdr_build_def *plan) {
    kdr_triangles_def def = def_of(mesh);
    assert_int_equal(kdr_scene_set_triangles(scene, 0, &def), KDR_OK);
    assert_int_equal(kdr_scene_commit(scene, plan), KDR_OK);
}

static void hold_frame(kdr_device *device, const kdr_scene *scene, const kdr_mesh *mesh, const kdr_build_def *plan,
                       uint64_t sequence, const char *label) {
    kdr_triangles_def def = def_of(mesh);
    oracle_scene oracle = oracle_scene_create(&def, 1);
    oracle_tree tree = oracle_tree_create(&oracle);
    test_random random = test_random_start(test_random_seed(), sequence);
    kdr_ray *rays = awkward_rays_create(&random, &tree, RAYS);
    query_sheet sheet = query_sheet_create(&tree, rays, RAYS);
    assert_int_equal(query_sheet_differences(&sheet, scene, label), 0);

    kdr_scene *afresh = committed_scene(device, &def, 1, plan);
    assert_true(kdr_scene_hash(afresh) == kdr_scene_hash(scene));
    for (size_t i = 0; i < RAYS; i++) {
        kdr_ray_hit hits[2] = {{.ray = rays[i]}, {.ray = rays[i]}};
        kdr_intersect1(scene, &hits[0]);
        kdr_intersect1(afresh, &hits[1]);
        assert_memory_equal(&hits[0], &hits[1], sizeof hits[0]);
    }
    kdr_scene_destroy(afresh);
    query_sheet_destroy(&sheet);
    free(rays);
    oracle_tree_destroy(&tree);
    oracle_scene_destroy(&oracle);
}

static void every_frame_is_the_scene_built_afresh_and_answers_as_the_oracle(void **state) {
    (void)state;
    static const char *const plans[] = {"", "quality=fast", "split=sweep", "split=space order=bfs",
                                        "quality=lazy lazy-limit=64"};
    uint64_t sequence = 0;
    for (size_t i = 0; kdr_mesh_builtin_name(i); i++) {
        if (!kdr_mesh_builtin_moves(i))
            continue;
        kdr_device *device;
        assert_int_equal(kdr_device_create(NULL, &device), KDR_OK);
        kdr_scene *scene = one_geometry(device, i % 2);
        for (uint64_t frame = 0; frame < 6; frame++, sequence++) {
            /* Sizes differ too, so that the memory of one frame has to serve another. */
            size_t triangles = TRIANGLES >> (frame * 5 % 3);
            kdr_build_def plan;
            kdr_mesh *mesh;
            assert_int_equal(kdr_build_def_parse(plans[(i + frame / 2) % 5], &plan, NULL, 0), KDR_OK);
            assert_int_equal(kdr_mesh_make(kdr_mesh_builtin_name(i), triangles, 0.17 * (double)frame, NULL, &mesh),
                             KDR_OK);
            show(scene, mesh, &plan);
            hold_frame(device, scene, mesh, &plan, sequence, kdr_mesh_builtin_name(i));
            kdr_mesh_destroy(mesh);
        }
        kdr_scene_destroy(scene);
        kdr_device_destroy(device);
    }
    assert_true(sequence >= 4 * 6);
}

/* Ten thousand in a long run. */
static void memory_and_trees_stay_the_same_over_many_frames(void **state) {
    (void)state;
    const uint64_t frames = test_is_long() ? 10000 : 40 * STILL_FRAMES, settled = frames / 2;
    failing_alloc memory;
    failing_alloc_init(&memory);
    kdr_allocator functions = failing_alloc_functions(&memory);
    kdr_device_def device_def = kdr_default_device_def();
    device_def.allocator = functions;
    device_def.worker_count = 2;
    kdr_device *device;
    assert_int_equal(kdr_device_create(&device_def, &device), KDR_OK);
    kdr_mesh *meshes[STILL_FRAMES];
    uint64_t hashes[STILL_FRAMES] = {0}, late_calls = 0;
    for (int i = 0; i < STILL_FRAMES; i++)
        assert_int_equal(kdr_mesh_make("explode", test_is_long() ? 20000 : TRIANGLES, 0.11 * i, NULL, &meshes[i]),
                         KDR_OK);
    kdr_scene *scene = one_geometry(device, true);
    size_t bytes = 0;
    for (uint64_t frame = 0; frame < frames; frame++) {
        uint64_t calls = memory.calls;
        uint32_t number = frame % STILL_FRAMES;
        show(scene, meshes[number], NULL);
        uint64_t hash = kdr_scene_hash(scene);
        assert_true(frame < STILL_FRAMES || hash == hashes[number]);
        hashes[number] = hash;
        if (frame == settled)
            bytes = kdr_device_bytes(device);
        if (frame > settled)
            late_calls += memory.calls - calls;
    }
    if (test_is_long())
        printf("%llu frames: %zu bytes in the middle, %zu at the end, %llu calls of the allocator between\n",
               (unsigned long long)frames, bytes, kdr_device_bytes(device), (unsigned long long)late_calls);

    /* How many blocks two workers hold at once is a matter of chance, and on a busy machine the second may find its
     * first work late: a few blocks may turn up then, a chunk of an arena among them, but no trickle. */
    assert_true(late_calls <= 8);
    assert_true(kdr_device_bytes(device) <= bytes + (bytes / 4 > LATE_BYTES ? bytes / 4 : LATE_BYTES));
    assert_int_equal(kdr_scene_verify(scene), KDR_OK);
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
    for (int i = 0; i < STILL_FRAMES; i++)
        kdr_mesh_destroy(meshes[i]);
    assert_true(failing_alloc_is_clean(&memory));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_frame_is_the_scene_built_afresh_and_answers_as_the_oracle),
        cmocka_unit_test(memory_and_trees_stay_the_same_over_many_frames),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
