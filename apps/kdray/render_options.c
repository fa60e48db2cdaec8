#include "render_options.h"

#include "option_numbers.h"

#include <string.h>

#define DEFAULT_THRESHOLD 2.0
#define TIME_LIMIT 1e6 /* seconds */

enum { MOMENT = 0x100, STATS, COMPARE, THRESHOLD };

static const struct argp_option options[] = {
    {NULL, 0, NULL, 0, "Picture:", 1},
    {"output", 'o', "FILE", 0, "Write the picture to this PNG file", 1},
    {"time", MOMENT, "SECONDS", 0, "Show a glTF or GLB file as it is so far into its animation", 1},
    {NULL, 0, NULL, 0, "Comparison:", 3},
    {"compare", COMPARE, "FILE", 0,
     "Print the root mean square difference from this PNG file, 0 to 255; exit with 1 if it is above the threshold. "
     "Its pixels are the default of --resolution",
     3},
    {"threshold", THRESHOLD, "D", 0, "Largest difference that passes (default: 2)", 3},
    {"stats", STATS, NULL, 0, "Print every figure", 10},
    {"quiet", 'q', NULL, 0, "Say nothing but errors and what was asked for", 10},
    {0},
};

static const char description[] = "Render a mesh file to a picture.\v"
                                  "FILE is a mesh file (PLY, OBJ, STL and others, also gzipped) or "
                                  "builtin:NAME[:TRIANGLES[:TIME]], a built-in scene; "
                                  "`kdray info --scenes' lists those.\n\n"
                                  "Exit status: 0 done, 1 failed, 2 wrong usage.";

/* Options that make sense only together. */
static void check_together(const kdr_render_options *render, struct argp_state *state) {
    if (!render->file)
        argp_error(state, "expected a mesh file or builtin:NAME");
    else if (!render->output && !render->compare)
        argp_error(state, "expected -o FILE for the picture, or --compare");
    else if (render->output && strcmp(render->output, "-") == 0)
        argp_error(state, "--output: expected the name of a file, not stdout");
    else if (render->threshold >= 0 && !render->compare)
        argp_error(state, "--threshold: expected --compare as well");
    else if (render->output && render->tree.json && kdr_output_same(render->output, render->tree.json))
        argp_error(state, "--json: expected another file than that of the picture");
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
    kdr_render_options *render = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &render->picture;
        state->child_inputs[1] = &render->tree;
        break;
    case 'o': render->output = text; break;
    case MOMENT:
        render->time = kdr_option_between(state, "--time", text, 0, TIME_LIMIT);
        render->time_given = true;
        break;
    case COMPARE: render->compare = text; break;
    case THRESHOLD: render->threshold = kdr_option_between(state, "--threshold", text, 0, 255); break;
    case STATS: render->stats = true; break;
    case 'q': render->quiet = true; break;
    case ARGP_KEY_ARG:
        if (render->file)
            argp_error(state, "expected one mesh file, found \"%.40s\" as well", text);
        render->file = text;
        break;
    case ARGP_KEY_END: check_together(render, state); break;
    default: return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

void kdr_render_options_parse(int argc, char **argv, kdr_render_options *render) {
    *render = (kdr_render_options){
        .threshold = -1, .picture = kdr_default_picture_options(), .tree = kdr_default_tree_options()};
    const struct argp_child children[] = {{&kdr_picture_argp, 0, NULL, 0}, {&kdr_tree_argp, 0, NULL, 0}, {0}};
    const struct argp parser = {
        .options = options, .parser = parse_option, .args_doc = "FILE", .doc = description, .children = children};
    argp_parse(&parser, argc, argv, 0, NULL, render);
    if (render->threshold < 0)
        render->threshold = DEFAULT_THRESHOLD;
}
