/* Scenes that make builders run away, by every split with every rule for the axis: needles, hair, grass, copies,
 * overlaps in one plane, a small model in a large place, and triangles without area. What a build does and holds stays
 * bounded, against the plain scene of the same size and the same plan. Work is counted, not timed: references that
 * nodes were opened with. */
#include "kdray/render.h"
#include "scene/scene.h"
#include "support/random.h"
#include "support/soup.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define TRIANGLES 2000
#define WITHOUT_AREA 50000
#define TIMES_PLAIN 10 /* nodes, bytes and work of a hard scene over those of the plain one */
#define REFERENCES 8   /* a triangle, unless the plan says otherwise */

static const char *const hard_scenes[] = {"needles", "hair", "grass", "duplicates", "heap", "stadium"};
enum { HARD_SCENES = sizeof hard_scenes / sizeof hard_scenes[0] };
#define PLAIN_SCENE "sphere"

/* ---- every plan */

/* Word number i of those that a key of a plan takes, as its text lists them: "one|two|three, ...". False past the last.
 */
static bool word_of(const char *key, size_t i, char *word, size_t size) {
    for (size_t k = 0; kdr_build_def_key_name(k); k++) {
        if (strcmp(kdr_build_def_key_name(k), key) != 0)
            continue;
        const char *at = kdr_build_def_key_text(k);
        for (; i > 0; i--) {
            at += strcspn(at, "|,");
            if (*at++ != '|')
                return false;
        }
        snprintf(word, size, "%.*s", (int)strcspn(at, "|,"), at);
        return true;
    }
    fail_msg("no plan has a key %s", key);
    return false;
}

/* The other rows of the builder's tables that make another tree, or make it in another way. */
static const char *const further_plans[] = {
    "split=sweep events=3",
    "split=sweep straddle=clip",
    "split=sweep events=3 straddle=clip retract=yes",
    "split=binned retract=yes",
    "split=binned share=grid/16",
    "split=binned share=cluster/8",
    "split=object share=line/5",
    "quality=best",
};
enum { FURTHER_PLANS = sizeof further_plans / sizeof further_plans[0] };

/* Plan number i: every split with every rule for the axis, and the further ones. False past the last. */
static bool plan_of(size_t i, char *text, size_t size) {
    char split[32], axis[32];
    size_t axes = 0, splits = 0;
    while (word_of("axis", axes, axis, sizeof axis))
        axes++;
    while (word_of("split", splits, split, sizeof split))
        splits++;
    assert_true(axes > 1 && splits > 1);
    if (i >= splits * axes) {
        i -= splits * axes;
        if (i < FURTHER_PLANS)
            snprintf(text, size, "%s", further_plans[i]);
        return i < FURTHER_PLANS;
    }
    word_of("split", i / axes, split, sizeof split);
    word_of("axis", i % axes, axis, sizeof axis);
    snprintf(text, size, "split=%s axis=%s", split, axis);
    return true;
}

/* ---- what a build does and holds */

typedef struct build_account {
    kdr_tree_stats stats;
    size_t peak_bytes;  /* of the whole device, inputs apart */
    uint64_t work;      /* references of all interior nodes together */
    uint64_t pointless; /* interior nodes whose children both hold all of their primitives */
} build_account;

/* Primitives below a node, in order and each once. */
typedef struct primitive_set {
    uint32_t *items;
    size_t count;
} primitive_set;

static int compare_items(const void *a, const void *b) {
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static primitive_set set_of_leaf(const kdr_tree *tree, kdr_node leaf) {
    primitive_set set = {.count = kdr_node_count(leaf)};
    set.items = test_allocate(set.count, sizeof *set.items);
    for (size_t i = 0; i < set.count; i++)
        set.items[i] = kdr_block_primitive(kdr_block_of(tree->blocks, leaf), i);
    qsort(set.items, set.count, sizeof *set.items, compare_items);
    return set;
}

static primitive_set set_of_both(const primitive_set *a, const primitive_set *b) {
    primitive_set both = {.items = test_allocate(a->count + b->count, sizeof *both.items)};
    for (size_t i = 0, j = 0; i < a->count || j < b->count;) {
        bool from_a = j == b->count || (i < a->count && a->items[i] <= b->items[j]);
        uint32_t item = from_a ? a->items[i++] : b->items[j++];
        if (both.count == 0 || both.items[both.count - 1] != item)
            both.items[both.count++] = item;
    }
    return both;
}

/* The set of a node; recursion is as deep as the tree. */
static primitive_set look_below(const kdr_tree *tree, uint32_t index, build_account *account) {
    kdr_node node = tree->nodes[index];
    if (kdr_node_is_leaf(node))
        return set_of_leaf(tree, node);
    primitive_set left = look_below(tree, kdr_node_child(node), account);
    primitive_set right = look_below(tree, kdr_node_child(node) + 1, account);
    primitive_set both = set_of_both(&left, &right);
    account->work += both.count;
    account->pointless += left.count == both.count && right.count == both.count;
    free(left.items);
    free(right.items);
    return both;
}

static build_account account_for(const kdr_triangles_def *triangles, const char *plan) {
    build_account account = {0};
    kdr_build_def def;
    assert_int_equal(kdr_build_def_parse(plan, &def, NULL, 0), KDR_OK);
    kdr_device_def device_def = kdr_default_device_def();
    device_def.worker_count = 1;
    kdr_device *device;
    kdr_scene *scene;
    assert_int_equal(kdr_device_create(&device_def, &device), KDR_OK);
    assert_int_equal(kdr_scene_create(device, &scene), KDR_OK);
    assert_int_equal(kdr_scene_add_triangles(scene, triangles, NULL), KDR_OK);
    assert_int_equal(kdr_scene_commit(scene, &def), KDR_OK);
    assert_int_equal(kdr_scene_verify(scene), KDR_OK);
    assert_int_equal(kdr_scene_stats(scene, &account.stats), KDR_OK);
    account.peak_bytes = kdr_device_peak_bytes(device);
    primitive_set all = look_below(&scene->shown->dynamic_part->tree, 0, &account);
    assert_true(all.count == account.stats.triangle_count);
    free(all.items);
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
    return account;
}

static kdr_mesh *make_mesh(const char *name, kdr_triangles_def *triangles) {
    kdr_mesh *mesh;
    assert_int_equal(kdr_mesh_make(name, TRIANGLES, 0, NULL, &mesh), KDR_OK);
    *triangles = kdr_default_triangles_def();
    triangles->vertices = mesh->positions;
    triangles->vertex_count = mesh->vertex_count;
    triangles->indices = mesh->indices;
    triangles->triangle_count = mesh->triangle_count;
    return mesh;
}

static void hold_below(const char *what, uint64_t value, uint64_t limit, const char *scene, const char *plan) {
    if (value > limit)
        fail_msg("%s by %s: %llu %s, at most %llu", scene, plan, (unsigned long long)value, what,
                 (unsigned long long)limit);
}

static void hold_bounded(const build_account *hard, const build_account *plain, const char *scene, const char *plan) {
    uint64_t triangles = hard->stats.triangle_count;
    hold_below("references", hard->stats.reference_count, REFERENCES * triangles, scene, plan);
    hold_below("interior nodes", hard->stats.interior_count, TIMES_PLAIN * plain->stats.interior_count, scene, plan);
    hold_below("bytes of the tree", hard->stats.node_bytes + hard->stats.leaf_bytes,
               TIMES_PLAIN * (plain->stats.node_bytes + plain->stats.leaf_bytes), scene, plan);
    hold_below("bytes at most", hard->peak_bytes, TIMES_PLAIN * plain->peak_bytes, scene, plan);
    hold_below("references opened", hard->work, TIMES_PLAIN * plain->work, scene, plan);
    hold_below("nodes whose children both hold all of it", hard->pointless, 0, scene, plan);
}

static void work_and_memory_of_hard_scenes_are_within_ten_times_those_of_a_plain_one(void **state) {
    (void)state;
    kdr_triangles_def plain_triangles, hard_triangles;
    kdr_mesh *plain_mesh = make_mesh(PLAIN_SCENE, &plain_triangles);
    char plan[80];
    size_t plans = 0;
    for (; plan_of(plans, plan, sizeof plan); plans++) {
        build_account plain = account_for(&plain_triangles, plan);
        hold_below("nodes whose children both hold all of it", plain.pointless, 0, PLAIN_SCENE, plan);
        for (int i = 0; i < HARD_SCENES; i++) {
            kdr_mesh *mesh = make_mesh(hard_scenes[i], &hard_triangles);
            build_account hard = account_for(&hard_triangles, plan);
            hold_bounded(&hard, &plain, hard_scenes[i], plan);
            kdr_mesh_destroy(mesh);
        }
    }
    assert_true(plans >= 12 + FURTHER_PLANS);
    kdr_mesh_destroy(plain_mesh);
}

static void a_plan_that_asks_for_more_references_gets_no_more_than_it_asks_for(void **state) {
    (void)state;
    char plan[120], with_limit[160];
    for (size_t p = 0; plan_of(p, plan, sizeof plan); p++) {
        for (uint64_t limit = 1; limit <= 8; limit += 7) {
            kdr_triangles_def triangles;
            kdr_mesh *mesh = make_mesh("needles", &triangles);
            snprintf(with_limit, sizeof with_limit, "%s reference-limit=%u", plan, (unsigned)limit);
            build_account account = account_for(&triangles, with_limit);
            hold_below("references", account.stats.reference_count, limit * account.stats.triangle_count, "needles",
                       with_limit);
            hold_below("nodes whose children both hold all of it", account.pointless, 0, "needles", with_limit);
            kdr_mesh_destroy(mesh);
        }
    }
}

/* Copies of a few triangles that lie over one another: no plane parts copies. */
static void copies_end_in_leaves_of_their_number_without_more_nodes(void **state) {
    (void)state;
    enum { KINDS = 8 };
    uint32_t copies = TRIANGLES / KINDS;
    float *vertices = test_allocate(9 * (size_t)KINDS * copies, sizeof *vertices);
    for (uint32_t i = 0; i < KINDS * copies; i++) {
        float step = 2 * (float)(i % KINDS);
        float triangle[9] = {step, 0, 0, step + 1, 0, 1, step, 1, 0};
        memcpy(vertices + 9 * (size_t)i, triangle, sizeof triangle);
    }
    kdr_triangles_def triangles = kdr_default_triangles_def();
    triangles.vertices = vertices;
    triangles.vertex_count = 3 * (size_t)KINDS * copies;
    triangles.triangle_count = (size_t)KINDS * copies;
    char plan[80];
    for (size_t p = 0; plan_of(p, plan, sizeof plan); p++) {
        build_account account = account_for(&triangles, plan);
        hold_below("nodes whose children both hold all of it", account.pointless, 0, "copies", plan);
        hold_below("references", account.stats.reference_count, 2 * triangles.triangle_count, "copies", plan);
        hold_below("leaves", account.stats.leaf_count, 4 * KINDS, "copies", plan);
        assert_true(account.stats.largest_leaf >= copies);
    }
    free(vertices);
}

/* Points, repeated vertices and segments, all over a box, behind a few triangles with area. */
static void triangles_without_area_leave_no_trace_in_the_tree(void **state) {
    (void)state;
    enum { SOUND = 200 };
    size_t count = SOUND + WITHOUT_AREA;
    float *vertices = test_allocate(9 * count, sizeof *vertices);
    test_random random = test_random_start(test_random_seed(), 7);
    for (size_t i = 0; i < count; i++) {
        float *t = vertices + 9 * i, step[3];
        for (int k = 0; k < 3; k++) {
            // Whole numbers, so that a segment has no area at all.
            t[k] = (float)test_random_below(&random, 4096);
            step[k] = (float)(1 + test_random_below(&random, 64));
        }
        for (int k = 0; k < 3; k++) {
            bool sound = i < SOUND;
            t[3 + k] = sound || i % 3 > 0 ? t[k] + step[k] : t[k];
            t[6 + k] = sound ? t[k] + (k == 1 ? 100 : 0) : i % 3 == 2 ? t[k] + 2 * step[k] : t[k];
        }
    }
    kdr_triangles_def all = kdr_default_triangles_def(), sound;
    all.vertices = vertices;
    all.vertex_count = 3 * count;
    all.triangle_count = count;
    sound = all;
    sound.triangle_count = SOUND;
    kdr_triangles_def plain_triangles;
    kdr_mesh *plain_mesh;
    assert_int_equal(kdr_mesh_make(PLAIN_SCENE, WITHOUT_AREA, 0, NULL, &plain_mesh), KDR_OK);
    plain_triangles = all;
    plain_triangles.vertices = plain_mesh->positions;
    plain_triangles.vertex_count = plain_mesh->vertex_count;
    plain_triangles.indices = plain_mesh->indices;
    plain_triangles.triangle_count = plain_mesh->triangle_count;
    build_account plain = account_for(&plain_triangles, "");
    char plan[80];
    for (size_t p = 0; plan_of(p, plan, sizeof plan); p++) {
        build_account with = account_for(&all, plan), without = account_for(&sound, plan);
        assert_true(with.stats.triangle_count == SOUND && with.stats.degenerate_count == WITHOUT_AREA);
        assert_true(with.work == without.work && with.pointless == 0);
        assert_true(with.stats.leaf_count == without.stats.leaf_count);
        assert_true(with.stats.node_bytes + with.stats.leaf_bytes ==
                    without.stats.node_bytes + without.stats.leaf_bytes);
        hold_below("bytes at most", with.peak_bytes, plain.peak_bytes, "triangles without area", plan);
    }
    kdr_mesh_destroy(plain_mesh);
    free(vertices);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(work_and_memory_of_hard_scenes_are_within_ten_times_those_of_a_plain_one),
        cmocka_unit_test(a_plan_that_asks_for_more_references_gets_no_more_than_it_asks_for),
        cmocka_unit_test(copies_end_in_leaves_of_their_number_without_more_nodes),
        cmocka_unit_test(triangles_without_area_leave_no_trace_in_the_tree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
