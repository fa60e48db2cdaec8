#include "view_options.h"

#include "option_numbers.h"
#include "output.h"

#include <string.h>

#define FRAME_LIMIT 1000000000u
#define RATE_LIMIT 10000.0
#define SIDE_LIMIT 16384u

enum { FRAMES = 0x100, RATE, PAUSED, SHOW, SCREENSHOT };

static const struct argp_option options[] = {
    {NULL, 0, NULL, 0, "Window:", 1},
    {"resolution", 'r', "WxH", 0, "Pixels at first (default: 960x720)", 1},
    {"show", SHOW, "WHAT", 0,
     "picture, normals, depth, nodes or triangles that a pixel's ray passes (default: picture)", 1},
    {"fps", RATE, "RATE", 0, "Frames a second of a sequence and of the arrow keys (default: 25)", 1},
    {"paused", PAUSED, NULL, 0, "Begin with what moves standing still", 1},
    {"frames", FRAMES, "N", 0, "Quit after so many frames were shown", 1},
    {"screenshot", SCREENSHOT, "FILE", 0, "Write the last picture to this PNG file when quitting", 1},
    {"quiet", 'q', NULL, 0, "Say nothing but errors", 10},
    {0},
};

static const char description[] =
    "Look at a mesh, still or moving, in a window.\v"
    "FILE is a mesh file, a glTF or GLB file, a name with # for the number of a sequence of mesh files "
    "(walk_####.ply), "
    "or builtin:NAME[:TRIANGLES[:TIME]], a built-in scene; `kdray info --scenes' lists those. The tree is built anew "
    "for every frame that moves. Drag to go around, H lists the keys, Esc quits.\n\n"
    "Exit status: 0 done, 1 failed, 2 wrong usage.";

static kdr_view_show read_show(struct argp_state *state, const char *text) {
    for (int i = 0; i < KDR_SHOW_COUNT; i++)
        if (strcmp(kdr_view_show_name((kdr_view_show)i), text) == 0)
            return (kdr_view_show)i;
    argp_error(state, "--show: expected picture, normals, depth, nodes or triangles, found \"%.40s\"", text);
    return KDR_SHOW_SHADED;
}

/* Options that make sense only together. */
static void check_together(const kdr_view_options *view, struct argp_state *state) {
    if (!view->file)
        argp_error(state, "expected a mesh file or builtin:NAME");
    else if (view->screenshot && strcmp(view->screenshot, "-") == 0)
        argp_error(state, "--screenshot: expected the name of a file, not stdout");
    else if (view->screenshot && view->tree.json && kdr_output_same(view->screenshot, view->tree.json))
        argp_error(state, "--json: expected another file than that of --screenshot");
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
    kdr_view_options *view = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &view->picture;
        state->child_inputs[1] = &view->tree;
        break;
    case 'r':
        kdr_option_size(state, "--resolution", text, SIDE_LIMIT, &view->picture.width, &view->picture.height);
        view->picture.size_given = true;
        break;
    case SHOW: view->show = read_show(state, text); break;
    case RATE: view->rate = kdr_option_inside(state, "--fps", text, 0, RATE_LIMIT); break;
    case PAUSED: view->paused = true; break;
    case FRAMES: view->frames = kdr_option_whole(state, "--frames", text, 1, FRAME_LIMIT); break;
    case SCREENSHOT: view->screenshot = text; break;
    case 'q': view->quiet = true; break;
    case ARGP_KEY_ARG:
        if (view->file)
            argp_error(state, "expected one mesh file, found \"%.40s\" as well", text);
        view->file = text;
        break;
    case ARGP_KEY_END: check_together(view, state); break;
    default: return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

void kdr_view_options_parse(int argc, char **argv, kdr_view_options *view) {
    *view =
        (kdr_view_options){.rate = 25, .picture = kdr_default_picture_options(), .tree = kdr_default_tree_options()};
    view->picture.width = 960;
    view->picture.height = 720;
    const struct argp_child children[] = {{&kdr_camera_argp, 0, NULL, 0}, {&kdr_tree_argp, 0, NULL, 0}, {0}};
    const struct argp parser = {
        .options = options, .parser = parse_option, .args_doc = "FILE", .doc = description, .children = children};
    argp_parse(&parser, argc, argv, 0, NULL, view);
}
