/* What the tree of each plan costs by the surface area heuristic, beside that of exact sweeping, on twenty scenes. */
#include "kdray/render.h"
#include "support/everywhere.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

#define TRIANGLES 3000 /* everywhere: costs are the same on every machine */
#define SCENES 20

/* The yardstick: every begin and end of a box is weighed, on every axis, by the heuristic alone. The default cuts
 * triangles whose boxes are mostly empty, and may be far below. */
#define EXACT "split=sweep empty-bonus=1 straddle=general reference-limit=4"

typedef struct bound {
    const char *plan;
    double least, mean, most; /* multiples of the yardstick's cost: the least on any scene, the geometric mean over all
                                 of them, the most on any */
} bound;

/* What was measured, with a margin of some hundredths; a tenth for the most. Cells of coplanar triangles, as in the
 * scene "duplicates", are what bins, three events and medians see worst. */
static const bound bounds[] = {
    {"", 0.45, 1.00, 1.19},
    {"axis=longest", 0.46, 1.05, 2.27},
    {"axis=robin", 0.47, 1.11, 1.82},
    {"retract=yes", 0.45, 1.00, 1.19},
    {"split=space", 0.56, 1.54, 2.59},
    {"split=space axis=robin", 0.57, 1.69, 3.16},
    {"split=object", 0.59, 1.84, 11.66},
    {"split=object axis=robin", 0.64, 2.10, 10.80},
    {"split=sweep", 0.51, 1.00, 1.17},
    {"split=sweep axis=robin", 0.52, 1.07, 1.34},
    {"split=sweep events=3", 0.51, 1.01, 1.24},
    {"split=sweep straddle=clip", 0.51, 0.98, 1.13},
    {"split=sweep events=3 straddle=clip retract=yes", 0.50, 0.99, 1.24},
    {"quality=best", 0.48, 1.16, 1.84},
    {"share=serial/8", 0.46, 1.04, 2.05},
    {"share=line/8", 1.07, 1.27, 1.49},
    {"share=grid/8", 0.72, 1.07, 1.83},
    {"share=cluster/8", 1.07, 1.27, 1.49},
    {"share=serial/64", 0.49, 1.18, 3.39},
    {"share=line/64", 1.26, 2.22, 5.54},
    {"share=grid/64", 0.84, 1.20, 1.95},
    {"share=cluster/64", 1.26, 2.20, 5.54},
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
