#include "support/everywhere.h"

#include "support/awkward_rays.h"
#include "support/failing_alloc.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

static build_case make_case(const char *name, float traversal, float intersection, uint32_t leaf_limit,
                            uint32_t depth_limit, float reference_limit) {
    build_case built = {name, kdr_default_build_def()};
    if (traversal > 0)
        built.def.cost_traversal = traversal;
    if (intersection > 0)
        built.def.cost_intersection = intersection;
    if (leaf_limit > 0)
        built.def.leaf_limit = leaf_limit;
    if (depth_limit > 0)
        built.def.depth_limit = depth_limit;
    if (reference_limit > 0)
        built.def.reference_limit = reference_limit;
    return built;
}

const build_case *build_cases(void) {
    static build_case cases[BUILD_CASE_COUNT];
    cases[0] = make_case("default", 0, 0, 0, 0, 0);
    cases[1] = make_case("leaf limit 1", 0, 0, 1, 0, 0);
    cases[2] = make_case("costs 1:1", 1, 1, 0, 0, 0);
    cases[3] = make_case("costs 16:1", 16, 1, 0, 0, 0);
    cases[4] = make_case("costs 1:100", 1, 100, 0, 0, 0);
    cases[5] = make_case("depth limit 1", 0, 0, 0, 1, 0);
    cases[6] = make_case("depth limit 60", 0, 0, 1, KDR_MAX_DEPTH, 0);
    cases[7] = make_case("reference limit 1", 0, 0, 0, 0, 1);
    cases[8] = make_case("all at once", 1, 1000, 1, KDR_MAX_DEPTH, 100);
    return cases;
}

kdr_device *device_of_isa(kdr_isa isa, uint32_t worker_count, const kdr_allocator *functions) {
    kdr_device_def def = kdr_default_device_def();
    def.isa_limit = isa;
    def.worker_count = worker_count;
    if (functions)
        def.allocator = *functions;
    kdr_device *device;
    assert_int_equal(kdr_device_create(&def, &device), KDR_OK);
    if (kdr_device_isa(device) == isa)
        return device;
    kdr_device_destroy(device);
    return NULL;
}

kdr_scene *committed_scene(kdr_device *device, const kdr_triangles_def *geometries, uint32_t geometry_count,
                           const kdr_build_def *def) {
    kdr_scene *scene;
    assert_int_equal(kdr_scene_create(device, &scene), KDR_OK);
    for (uint32_t i = 0; i < geometry_count; i++) {
        uint32_t geometry;
        assert_int_equal(kdr_scene_add_triangles(scene, &geometries[i], &geometry), KDR_OK);
        assert_int_equal(geometry, i);
    }
    assert_int_equal(kdr_scene_commit(scene, def), KDR_OK);
    return scene;
}

/* Returns the hash of the tree. sheet NULL: asks nothing. */
static uint64_t hold_one(kdr_device *device, const kdr_triangles_def *geometries, uint32_t geometry_count,
                         const query_sheet *sheet, const build_case *built, const char *label) {
    char name[200];
    snprintf(name, sizeof(name), "%s, %s, %s, %u workers", label, built->name, kdr_isa_name(kdr_device_isa(device)),
             kdr_device_worker_count(device));
    kdr_scene *scene = committed_scene(device, geometries, geometry_count, &built->def);
    if (kdr_scene_verify(scene) != KDR_OK)
        fail_msg("%s: the tree is not sound", name);
    if (sheet && query_sheet_differences(sheet, scene, name) > 0)
        fail_msg("%s: wrong answers", name);
    uint64_t hash = kdr_scene_hash(scene);
    kdr_scene_destroy(scene);
    return hash;
}

void hold_everywhere(const kdr_triangles_def *geometries, uint32_t geometry_count, const query_sheet *sheet,
                     size_t case_count, const char *label) {
    failing_alloc memory;
    failing_alloc_init(&memory);
    kdr_allocator functions = failing_alloc_functions(&memory);
    uint64_t hashes[BUILD_CASE_COUNT] = {0};
    int device_count = 0;
    for (int isa = KDR_ISA_SCALAR; isa <= KDR_ISA_NEON; isa++) {
        for (uint32_t workers = 1; workers <= 2; workers++) {
            kdr_device *device = device_of_isa((kdr_isa)isa, workers, &functions);
            if (!device)
                continue;
            for (size_t i = 0; i < case_count; i++) {
                // An equal tree need not be asked again.
                const query_sheet *asked = workers == 1 ? sheet : NULL;
                uint64_t hash = hold_one(device, geometries, geometry_count, asked, &build_cases()[i], label);
                if (device_count > 0 && hash != hashes[i])
                    fail_msg("%s: %s with %u workers builds another tree", label, kdr_isa_name((kdr_isa)isa), workers);
                hashes[i] = hash;
            }
            kdr_device_destroy(device);
            device_count++;
        }
    }
    assert_true(device_count > 0);
    assert_true(failing_alloc_is_clean(&memory));
}

void hold_awkward_rays_everywhere(const kdr_triangles_def *geometries, uint32_t geometry_count, uint64_t sequence,
                                  size_t ray_count, size_t case_count, const char *label) {
    test_random random = test_random_start(test_random_seed(), sequence);
    oracle_scene scene = oracle_scene_create(geometries, geometry_count);
    oracle_tree tree = oracle_tree_create(&scene);
    kdr_ray *rays = awkward_rays_create(&random, &tree, ray_count);
    query_sheet sheet = query_sheet_create(&tree, rays, ray_count);
    hold_everywhere(geometries, geometry_count, &sheet, case_count, label);
    query_sheet_destroy(&sheet);
    free(rays);
    oracle_tree_destroy(&tree);
    oracle_scene_destroy(&scene);
}
