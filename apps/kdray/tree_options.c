#include "tree_options.h"

#include "option_numbers.h"

#include <string.h>

#define THREAD_LIMIT 256u
#define FACTOR_LIMIT 1e6f

enum { TRAVERSAL_COST = 0x200, INTERSECTION_COST, LEAF_LIMIT, DEPTH_LIMIT, REFERENCE_LIMIT, ISA, JSON, PLAN };

static const struct argp_option options[] = {
    {NULL, 0, NULL, 0, "Work and results:", 10},
    {"threads", 't', "N", 0, "Threads that build and trace, 1 to 256 (default: all of the machine)", 10},
    {"isa", ISA, "NAME", 0, "Instruction set: scalar, sse42, avx2, avx512 or neon (default: the widest there is)", 10},
    {"json", JSON, "FILE", 0, "Write every figure as JSON; - is stdout", 10},
    {NULL, 0, NULL, 0, "How the tree is built:", 20},
    {"plan", PLAN, "PLAN", 0,
     "Words KEY=VALUE that say everything at once; it replaces what came before it, options after it change it "
     "(`kdray info --plans' lists the keys)",
     20},
    {"traversal-cost", TRAVERSAL_COST, "COST", 0, "Cost of a step through an interior node", 20},
    {"intersection-cost", INTERSECTION_COST, "COST", 0, "Cost of a triangle test", 20},
    {"leaf-limit", LEAF_LIMIT, "N", 0, "Split every leaf of more triangles", 20},
    {"depth-limit", DEPTH_LIMIT, "N", 0, "Deepest leaf, up to 60; 0: as deep as the number of triangles asks for", 20},
    {"reference-limit", REFERENCE_LIMIT, "FACTOR", 0, "Most references a triangle, at least 1", 20},
    {0},
};

static bool find_isa(const char *name, kdr_isa *isa) {
    for (int i = KDR_ISA_SCALAR; i <= KDR_ISA_NEON; i++)
        if (strcmp(kdr_isa_name((kdr_isa)i), name) == 0) {
            *isa = (kdr_isa)i;
            return true;
        }
    return false;
}

static void read_plan(struct argp_state *state, const char *text, kdr_build_def *def) {
    char problem[400];
    if (kdr_build_def_parse(text, def, problem, sizeof problem) != KDR_OK)
        argp_error(state, "--plan: %s", problem);
}

static error_t parse(int key, char *text, struct argp_state *state) {
    kdr_tree_options *tree = state->input;
    switch (key) {
    case 't': tree->threads = (uint32_t)kdr_option_whole(state, "--threads", text, 1, THREAD_LIMIT); break;
    case ISA:
        if (!find_isa(text, &tree->isa))
            argp_error(state, "--isa: expected scalar, sse42, avx2, avx512 or neon, found \"%.40s\"", text);
        tree->isa_given = true;
        break;
    case JSON: tree->json = text; break;
    case PLAN: read_plan(state, text, &tree->build); break;
    case TRAVERSAL_COST:
        tree->build.cost_traversal = kdr_option_positive(state, "--traversal-cost", text, FACTOR_LIMIT);
        break;
    case INTERSECTION_COST:
        tree->build.cost_intersection = kdr_option_positive(state, "--intersection-cost", text, FACTOR_LIMIT);
        break;
    case LEAF_LIMIT:
        tree->build.leaf_limit = (uint32_t)kdr_option_whole(state, "--leaf-limit", text, 1, UINT32_MAX);
        break;
    case DEPTH_LIMIT:
        tree->build.depth_limit = (uint32_t)kdr_option_whole(state, "--depth-limit", text, 0, KDR_MAX_DEPTH);
        break;
    case REFERENCE_LIMIT:
        tree->build.reference_limit =
            (float)kdr_option_between(state, "--reference-limit", text, 1, (double)FACTOR_LIMIT);
        break;
    default: return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

const struct argp kdr_tree_argp = {.options = options, .parser = parse};

kdr_tree_options kdr_default_tree_options(void) { return (kdr_tree_options){.build = kdr_default_build_def()}; }

kdr_device *kdr_tree_options_device(const kdr_tree_options *tree, kdr_messages *messages) {
    kdr_logger logger = kdr_messages_logger(messages);
    kdr_device_def def = kdr_default_device_def();
    def.worker_count = tree->threads;
    def.log = logger.log;
    def.log_user = logger.user;
    if (tree->isa_given)
        def.isa_limit = tree->isa;

    kdr_device *device;
    kdr_status status = kdr_device_create(&def, &device);
    if (status != KDR_OK) {
        kdr_messages_fail_status(messages, "no device", status);
        return NULL;
    }
    // A limit alone would quietly fall back to what there is.
    kdr_isa isa = kdr_device_isa(device);
    if (tree->isa_given && isa != tree->isa) {
        kdr_messages_fail(messages, "--isa: %s is not there to use, %s is", kdr_isa_name(tree->isa), kdr_isa_name(isa));
        kdr_device_destroy(device);
        return NULL;
    }
    return device;
}
