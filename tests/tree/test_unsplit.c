/* What the wide tree shows: every triangle, whole or by all its leaves, the same for every instruction set. */
#include "scene/scene.h"
#include "support/soup.h"
#include "tree/closed.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Of each primitive: leaves of the kd-tree that hold it, leaves of the wide tree that show it, and how many of these
 * show it whole, which is to say that it lies within their box. */
typedef struct showing {
    uint32_t held, shown, whole;
} showing;

static kdr_scene *scene_on(kdr_isa isa, const soup_scene *soup, kdr_device **device) {
    kdr_device_def def = kdr_default_device_def();
    def.isa_limit = isa;
    def.worker_count = 2;
    kdr_scene *scene = NULL;
    assert_int_equal(kdr_device_create(&def, device), KDR_OK);
    assert_int_equal(kdr_scene_create(*device, &scene), KDR_OK);
    for (size_t i = 0; i < SOUP_GEOMETRIES; i++)
        assert_int_equal(kdr_scene_add_triangles(scene, &soup->geometries[i], NULL), KDR_OK);
    assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
    return scene;
}

static bool lies_within(kdr_block block, size_t i, const kdr_wide_node *node, uint32_t place) {
    float t[3][3];
    kdr_block_triangle(block, i, t);
    bool within = true;
    for (int corner = 0; corner < 3; corner++)
        for (int k = 0; k < 3; k++)
            within &= t[corner][k] >= node->face[2 * k][place] && t[corner][k] <= node->face[2 * k + 1][place];
    return within;
}

static void count_shown(const kdr_tree *tree, showing *of) {
    for (size_t n = 0; n < tree->wide_bytes / sizeof *tree->wide; n++) {
        const kdr_wide_node *node = &tree->wide[n];
        for (uint32_t place = 0; place < KDR_WIDE; place++) {
            if (!(node->child[place] & KDR_WIDE_LEAF) || !(node->face[0][place] <= node->face[1][place]))
                continue;
            kdr_block block = kdr_wide_block(tree, node->child[place]);
            for (size_t i = 0; i < block.shown; i++) {
                uint32_t primitive = kdr_block_primitive(block, i);
                if (primitive == UINT32_MAX)
                    continue;
                of[primitive].shown++;
                of[primitive].whole += lies_within(block, i, node, place);
            }
        }
    }
}

static void count_held(const kdr_tree *tree, showing *of) {
    for (uint32_t n = 0; n < tree->node_count; n++) {
        kdr_node node = tree->nodes[n];
        if (n == 1 || !kdr_node_is_leaf(node))
            continue;
        for (uint32_t i = 0; i < kdr_node_count(node); i++)
            of[kdr_block_primitive(kdr_block_of(tree->blocks, node), i)].held++;
    }
}

static void every_triangle_is_shown_whole_by_a_leaf_or_by_all_that_hold_it(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 91);
    uint64_t spared = 0;
    for (size_t kind = 0; kind < soup_kind_count; kind++) {
        size_t count = soup_kinds[kind].count < 3 ? soup_kinds[kind].count : 2000;
        soup_scene soup = soup_scene_create_kind(&random, &soup_kinds[kind], count);
        kdr_device *device = NULL;
        kdr_scene *scene = scene_on(KDR_ISA_NEON, &soup, &device);
        const kdr_tree *tree = &scene->shown->dynamic_part->tree;
        if (tree->wide) {
            showing *of =
                test_allocate(scene->shown->dynamic_part->first[scene->shown->dynamic_part->count], sizeof *of);
            count_held(tree, of);
            count_shown(tree, of);
            for (uint32_t i = 0; i < scene->shown->dynamic_part->first[scene->shown->dynamic_part->count]; i++) {
                assert_true(of[i].whole > 0 || of[i].shown >= of[i].held);
                assert_true(of[i].shown <= of[i].held);
                spared += of[i].held - of[i].shown;
            }
            free(of);
        }
        assert_int_equal(kdr_scene_verify(scene), KDR_OK);
        kdr_scene_destroy(scene);
        kdr_device_destroy(device);
        soup_scene_destroy(&soup);
    }
    assert_true(spared > 100);
}

static void every_instruction_set_shows_the_same(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 92);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), 5000);
    kdr_device *widest_device = NULL, *device = NULL;
    kdr_scene *widest = scene_on(KDR_ISA_NEON, &soup, &widest_device);
    for (int isa = KDR_ISA_SSE42; isa <= KDR_ISA_AVX512; isa++) {
        kdr_scene *scene = scene_on((kdr_isa)isa, &soup, &device);
        assert_int_equal(scene->shown->dynamic_part->tree.wide_bytes, widest->shown->dynamic_part->tree.wide_bytes);
        assert_int_equal(scene->shown->dynamic_part->tree.block_bytes, widest->shown->dynamic_part->tree.block_bytes);
        assert_memory_equal(scene->shown->dynamic_part->tree.blocks, widest->shown->dynamic_part->tree.blocks,
                            scene->shown->dynamic_part->tree.block_bytes);
        for (size_t n = 0;
             n < scene->shown->dynamic_part->tree.wide_bytes / sizeof *scene->shown->dynamic_part->tree.wide; n++)
            assert_memory_equal(scene->shown->dynamic_part->tree.wide[n].child,
                                widest->shown->dynamic_part->tree.wide[n].child,
                                sizeof scene->shown->dynamic_part->tree.wide[n].child);
        kdr_scene_destroy(scene);
        kdr_device_destroy(device);
    }
    kdr_scene_destroy(widest);
    kdr_device_destroy(widest_device);
    soup_scene_destroy(&soup);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_triangle_is_shown_whole_by_a_leaf_or_by_all_that_hold_it),
        cmocka_unit_test(every_instruction_set_shows_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
