#include "animate_options.h"

#include "frame_names.h"
#include "option_numbers.h"
#include "output.h"

#include <stdlib.h>
#include <string.h>

#define FRAME_LIMIT 1000000000u
#define RATE_LIMIT 10000.0

enum { FRAMES = 0x100, RATE, CSV, RESUME, VIDEO };

static const struct argp_option options[] = {
    {NULL, 0, NULL, 0, "Frames:", 1},
    {"output", 'o', "NAME", 0, "Write each frame to a PNG file: #### in the name becomes its number", 1},
    {"frames", FRAMES, "A..B", 0,
     "First and last frame; frame i is what is seen after i / RATE seconds (default: all there is, or 100 of what "
     "never "
     "ends)",
     1},
    {"fps", RATE, "RATE", 0, "Frames a second (default: 25)", 1},
    {"resume", RESUME, NULL, 0, "Leave out frames whose file is there already, whole and of this size", 1},
    {"video", VIDEO, "FILE", 0, "Write a video as well, or instead; takes the program ffmpeg", 1},
    {"csv", CSV, "FILE", 0, "Write a line of figures for each frame that was rendered", 10},
    {"quiet", 'q', NULL, 0, "Say nothing but errors", 10},
    {0},
};

static const char description[] =
    "Render what moves to numbered pictures, the tree built anew for each.\v"
    "FILE is a glTF, GLB or MD2 file, a name with # for the number of a sequence of mesh files (walk_####.ply), a mesh "
    "file "
    "that stands still, or builtin:NAME[:TRIANGLES[:TIME]], a built-in scene; `kdray info --scenes' lists those.\n\n"
    "Exit status: 0 done, 1 failed, 2 wrong usage.";

/* A..B, or one number. */
static void read_frames(kdr_animate_options *animate, char *text, struct argp_state *state) {
    char *dots = strstr(text, "..");
    if (dots)
        *dots = 0;
    animate->first = kdr_option_whole(state, "--frames", text, 0, FRAME_LIMIT);
    animate->last = dots ? kdr_option_whole(state, "--frames", dots + 2, 0, FRAME_LIMIT) : animate->first;
    if (dots)
        *dots = '.';
    animate->frames_given = true;
    if (animate->first > animate->last)
        argp_error(state, "--frames: expected A..B with A not above B, found \"%.40s\"", text);
}

/* Options that make sense only together. */
static void check_together(const kdr_animate_options *animate, struct argp_state *state) {
    const char *fault = NULL;
    bool several = !animate->frames_given || animate->first < animate->last;
    if (animate->output)
        fault = kdr_frame_pattern_fault(animate->output, several);
    if (!animate->file)
        argp_error(state, "expected a mesh file or builtin:NAME");
    else if (!animate->output && !animate->video)
        argp_error(state, "expected -o NAME for the pictures, or --video");
    else if (fault)
        argp_error(state, "--output: expected %s, found \"%.60s\"", fault, animate->output);
    else if (animate->resume && !animate->output)
        argp_error(state, "--resume: expected -o as well");
    else if (animate->csv && animate->tree.json && kdr_output_same(animate->csv, animate->tree.json))
        argp_error(state, "--json: expected another file than that of --csv");
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
    kdr_animate_options *animate = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &animate->picture;
        state->child_inputs[1] = &animate->tree;
        break;
    case 'o': animate->output = text; break;
    case FRAMES: read_frames(animate, text, state); break;
    case RATE: animate->rate = kdr_option_inside(state, "--fps", text, 0, RATE_LIMIT); break;
    case CSV: animate->csv = text; break;
    case RESUME: animate->resume = true; break;
    case VIDEO: animate->video = text; break;
    case 'q': animate->quiet = true; break;
    case ARGP_KEY_ARG:
        if (animate->file)
            argp_error(state, "expected one mesh file, found \"%.40s\" as well", text);
        animate->file = text;
        break;
    case ARGP_KEY_END: check_together(animate, state); break;
    default: return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

void kdr_animate_options_parse(int argc, char **argv, kdr_animate_options *animate) {
    *animate =
        (kdr_animate_options){.rate = 25, .picture = kdr_default_picture_options(), .tree = kdr_default_tree_options()};
    const struct argp_child children[] = {{&kdr_picture_argp, 0, NULL, 0}, {&kdr_tree_argp, 0, NULL, 0}, {0}};
    const struct argp parser = {
        .options = options, .parser = parse_option, .args_doc = "FILE", .doc = description, .children = children};
    argp_parse(&parser, argc, argv, 0, NULL, animate);
}
