/* What the tree of each plan costs by the surface area heuristic, beside that of exact sweeping, on twenty scenes. */
#include "kdray/render.h"
#include "support/everywhere.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

#define TRIANGLES 3000 /* everywhere: costs are the same on every machine */
#define SCENES 20

/* The yardstick: every begin and end of a box is weighed, on every axis, by the heuristic alone. */
#define EXACT "split=sweep empty-bonus=1"

typedef struct bound {
    const char *plan;
    double least, mean, most; /* multiples of the yardstick's cost: the least on any scene, the geometric mean over all
                                 of them, the most on any */
} bound;

/* What was measured, with a margin of some hundredths; a tenth for the most. Cells of coplanar triangles, as in the
 * scene "duplicates", are what bins, three events and medians see worst. */
static const bound bounds[] = {
    {"", 0.97, 1.04, 1.25},
    {"axis=longest", 0.94, 1.09, 2.4},
    {"axis=robin", 1, 1.16, 1.95},
    {"retract=yes", 0.97, 1.04, 1.25},
    {"split=space", 1.25, 1.63, 2.8},
    {"split=space axis=robin", 1.25, 1.8, 3.3},
    {"split=object", 1.3, 1.95, 11.5},
    {"split=object axis=robin", 1.3, 2.2, 11.5},
    {"split=sweep", 0.92, 1.03, 1.15},
    {"split=sweep axis=robin", 0.98, 1.12, 1.3},
    {"split=sweep events=3", 0.92, 1.05, 1.4},
    {"split=sweep straddle=clip", 0.58, 0.98, 1.08},
    {"split=sweep events=3 straddle=clip retract=yes", 0.58, 0.99, 1.2},
    {"quality=best", 0.55, 1.2, 1.8},
    {"share=serial/8", 0.97, 1.1, 2.2},
    {"share=line/8", 1.05, 1.3, 1.65},
    {"share=grid/8", 0.97, 1.1, 1.85},
    {"share=cluster/8", 1.05, 1.3, 1.65},
    {"share=serial/64", 0.98, 1.25, 3.2},
    {"share=line/64", 1.25, 2.3, 5.6},
    {"share=grid/64", 1, 1.25, 1.95},
    {"share=cluster/64", 1.25, 2.3, 5.6},
};
enum { BOUNDS = sizeof bounds / sizeof bounds[0] };

static double cost_of(kdr_device *device, const kdr_triangles_def *triangles, const char *plan) {
    char problem[200];
    kdr_build_def def;
    if (kdr_build_def_parse(plan, &def, problem, sizeof problem) != KDR_OK)
        fail_msg("%s: %s", plan, problem);
    kdr_scene *scene = committed_scene(device, triangles, 1, &def);
    kdr_tree_stats stats;
    assert_int_equal(kdr_scene_stats(scene, &stats), KDR_OK);
    kdr_scene_destroy(scene);
    return stats.cost;
}

static kdr_triangles_def triangles_of(const kdr_mesh *mesh) {
    kdr_triangles_def triangles = kdr_default_triangles_def();
    triangles.vertices = mesh->positions;
    triangles.vertex_count = mesh->vertex_count;
    triangles.indices = mesh->indices;
    triangles.triangle_count = mesh->triangle_count;
    return triangles;
}

/* The built-in scenes, and one that moves again at another time. */
static kdr_mesh *make_scene(size_t i) {
    const char *name = kdr_mesh_builtin_name(i);
    kdr_mesh *mesh;
    assert_int_equal(kdr_mesh_make(name ? name : "explode", TRIANGLES, name ? 0 : 1.5, NULL, &mesh), KDR_OK);
    return mesh;
}

static void every_plan_costs_what_its_bounds_allow_beside_exact_sweeping(void **state) {
    (void)state;
    kdr_device *device;
    assert_int_equal(kdr_device_create(NULL, &device), KDR_OK);
    double logarithms[BOUNDS] = {0}, most[BOUNDS] = {0}, least[BOUNDS];
    for (size_t i = 0; i < SCENES; i++) {
        kdr_mesh *mesh = make_scene(i);
        kdr_triangles_def triangles = triangles_of(mesh);
        double exact = cost_of(device, &triangles, EXACT);
        assert_true(exact > 0);
        for (int b = 0; b < BOUNDS; b++) {
            double ratio = cost_of(device, &triangles, bounds[b].plan) / exact;
            logarithms[b] += log(ratio);
            most[b] = fmax(most[b], ratio);
            least[b] = i == 0 ? ratio : fmin(least[b], ratio);
        }
        kdr_mesh_destroy(mesh);
    }
    for (int b = 0; b < BOUNDS; b++) {
        double mean = exp(logarithms[b] / SCENES);
        if (!(least[b] >= bounds[b].least && mean <= bounds[b].mean && most[b] <= bounds[b].most))
            fail_msg("\"%s\" costs %.3f to %.3f times as much as exact sweeping, in the mean %.3f", bounds[b].plan,
                     least[b], most[b], mean);
    }
    kdr_device_destroy(device);
}

static void there_are_as_many_built_in_scenes_as_the_bounds_were_found_on(void **state) {
    (void)state;
    assert_non_null(kdr_mesh_builtin_name(SCENES - 2));
    assert_null(kdr_mesh_builtin_name(SCENES - 1));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_plan_costs_what_its_bounds_allow_beside_exact_sweeping),
        cmocka_unit_test(there_are_as_many_built_in_scenes_as_the_bounds_were_found_on),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
