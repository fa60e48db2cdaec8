#include "view_plans.h"

/* Beside the plan that was given; words as kdr_build_def_parse reads them. */
static const struct {
    const char *name, *words;
} plans[] = {
    {"fast", "quality=fast"},        {"balanced", "quality=balanced"}, {"best", "quality=best"},
    {"sweep", "split=sweep"},        {"space median", "split=space"},  {"object median", "split=object"},
    {"grid of 16", "share=grid/16"}, {"breadth first", "order=bfs"},   {"lazy", "quality=lazy"},
};

#define PLAN_COUNT (sizeof plans / sizeof plans[0])

static const char *const traces[] = {"auto", "stack", "restart", "push-down", "short-stack", "backtrack"};

const char *kdr_view_plan_name(uint32_t number) {
    return number == 0 ? "as given" : number <= PLAN_COUNT ? plans[number - 1].name : NULL;
}

const char *kdr_view_trace_name(uint32_t trace) {
    return trace < sizeof traces / sizeof traces[0] ? traces[trace] : NULL;
}

kdr_build_def kdr_view_plan(const kdr_build_def *given, uint32_t number, kdr_trace_rule trace) {
    kdr_build_def def = *given;
    if (number > 0 && number <= PLAN_COUNT)
        kdr_build_def_parse(plans[number - 1].words, &def, NULL, 0);
    if (def.trace != trace) {
        def.trace = trace;
        def.nodes = KDR_NODES_STRUCTURES;
        def.mailbox = KDR_MAILBOX_NONE;
        def.test = KDR_TEST_WATERTIGHT;
    }
    if (trace == KDR_TRACE_BACKTRACK) // it needs the links of the whole tree
        def.lazy_limit = 0;
    return def;
}
