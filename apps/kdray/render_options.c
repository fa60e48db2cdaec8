#include "render_options.h"

#include "option_numbers.h"

#include <string.h>

#define SIDE_LIMIT 65536u
#define SAMPLE_LIMIT 65536u
#define DEFAULT_THRESHOLD 2.0
#define TIME_LIMIT 1e6 /* seconds */

enum { CAMERA = 0x100, TARGET, UP, FOV, VIEW, LIGHT, BOX, TEXTURE, SPP, SEED, MOMENT, STATS, COMPARE, THRESHOLD };

static const struct argp_option options[] = {
    {NULL, 0, NULL, 0, "Picture:", 1},
    {"output", 'o', "FILE", 0, "Write the picture to this PNG file", 1},
    {"resolution", 'r', "WxH", 0, "Pixels (default: 1024x1024, or those of the picture to compare with)", 1},
    {"spp", SPP, "N", 0, "Samples a pixel, 1 to 65536 (default: 1)", 1},
    {"seed", SEED, "N", 0, "Seed of the samples' positions (default: 0)", 1},
    {"time", MOMENT, "SECONDS", 0, "Show a glTF or GLB file as it is so far into its animation", 1},
    {NULL, 0, NULL, 0, "View (default: the model from three quarters above):", 2},
    {"view", VIEW, "FILE", 0, "Read one line of 13 numbers: eye, target, up, field of view, light", 2},
    {"camera", CAMERA, "X,Y,Z", 0, "Where the eye is", 2},
    {"target", TARGET, "X,Y,Z", 0, "What it looks at", 2},
    {"up", UP, "X,Y,Z", 0, "Which way is up (default: 0,1,0)", 2},
    {"fov", FOV, "DEGREES", 0, "Vertical field of view, above 0 and below 180 (default: 45)", 2},
    {"light", LIGHT, "X,Y,Z", 0, "A point light; up to 16 of them", 2},
    {"box", BOX, NULL, 0, "Put the model in a textured box", 2},
    {"texture", TEXTURE, "FILE", 0, "PNG file on the box (default: a checkerboard)", 2},
    {NULL, 0, NULL, 0, "Comparison:", 3},
    {"compare", COMPARE, "FILE", 0,
     "Print the root mean square difference from this PNG file, 0 to 255; exit with 1 if it is above the threshold", 3},
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

static void add_light(kdr_render_options *render, const char *text, struct argp_state *state) {
    if (render->light_count == KDR_MAX_LIGHTS) {
        argp_error(state, "--light: expected at most %d lights", KDR_MAX_LIGHTS);
        return;
    }
    kdr_option_triple(state, "--light", text, render->lights[render->light_count]);
    render->light_count++;
}

/* Options that make sense only together. */
static void check_together(const kdr_render_options *render, struct argp_state *state) {
    if (!render->file)
        argp_error(state, "expected a mesh file or builtin:NAME");
    else if (!render->output && !render->compare)
        argp_error(state, "expected -o FILE for the picture, or --compare");
    else if (render->output && strcmp(render->output, "-") == 0)
        argp_error(state, "--output: expected the name of a file, not stdout");
    else if (render->texture && !render->box)
        argp_error(state, "--texture: expected --box as well, since the texture is the box's");
    else if (render->threshold >= 0 && !render->compare)
        argp_error(state, "--threshold: expected --compare as well");
    else if (render->output && render->tree.json && kdr_output_same(render->output, render->tree.json))
        argp_error(state, "--json: expected another file than that of the picture");
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
    kdr_render_options *render = state->input;
    switch (key) {
    case ARGP_KEY_INIT: state->child_inputs[0] = &render->tree; break;
    case 'o': render->output = text; break;
    case 'r':
        kdr_option_size(state, "--resolution", text, SIDE_LIMIT, &render->width, &render->height);
        render->size_given = true;
        break;
    case SPP: render->samples = (uint32_t)kdr_option_whole(state, "--spp", text, 1, SAMPLE_LIMIT); break;
    case MOMENT:
        render->time = kdr_option_between(state, "--time", text, 0, TIME_LIMIT);
        render->time_given = true;
        break;
    case SEED: render->seed = kdr_option_whole(state, "--seed", text, 0, UINT64_MAX); break;
    case VIEW: render->view = text; break;
    case CAMERA:
        kdr_option_triple(state, "--camera", text, render->camera.eye);
        render->eye_given = true;
        break;
    case TARGET:
        kdr_option_triple(state, "--target", text, render->camera.target);
        render->target_given = true;
        break;
    case UP:
        kdr_option_triple(state, "--up", text, render->camera.up);
        render->up_given = true;
        break;
    case FOV:
        render->camera.fov = (float)kdr_option_inside(state, "--fov", text, 0, 180);
        render->fov_given = true;
        break;
    case LIGHT: add_light(render, text, state); break;
    case BOX: render->box = true; break;
    case TEXTURE: render->texture = text; break;
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
        .width = 1024, .height = 1024, .samples = 1, .threshold = -1, .tree = kdr_default_tree_options()};
    const struct argp_child children[] = {{&kdr_tree_argp, 0, NULL, 0}, {0}};
    const struct argp parser = {
        .options = options, .parser = parse_option, .args_doc = "FILE", .doc = description, .children = children};
    argp_parse(&parser, argc, argv, 0, NULL, render);
    if (render->threshold < 0)
        render->threshold = DEFAULT_THRESHOLD;
}
