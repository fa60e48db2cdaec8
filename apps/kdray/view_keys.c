#include "view_keys.h"

#include "view_show.h"

#include <string.h>

static const kdr_view_key keys[] = {
    {"Escape", KDR_ACTION_QUIT, 0},
    {"H", KDR_ACTION_HELP, 0},
    {"F1", KDR_ACTION_HELP, 0},
    {"I", KDR_ACTION_PANEL, 0},
    {"Space", KDR_ACTION_PLAY, 0},
    {"Left", KDR_ACTION_FRAME_BACK, 0},
    {"Right", KDR_ACTION_FRAME_ON, 0},
    {"[", KDR_ACTION_SECOND_BACK, 0},
    {"]", KDR_ACTION_SECOND_ON, 0},
    {"PageUp", KDR_ACTION_SECOND_BACK, 0},
    {"PageDown", KDR_ACTION_SECOND_ON, 0},
    {"Home", KDR_ACTION_BEGIN, 0},
    {"End", KDR_ACTION_END, 0},
    {"R", KDR_ACTION_RESET, 0},
    {"Z", KDR_ACTION_SHOW, KDR_SHOW_SHADED},
    {"X", KDR_ACTION_SHOW, KDR_SHOW_NORMALS},
    {"C", KDR_ACTION_SHOW, KDR_SHOW_DEPTH},
    {"V", KDR_ACTION_SHOW, KDR_SHOW_NODES},
    {"B", KDR_ACTION_SHOW, KDR_SHOW_TRIANGLES},
    {"Tab", KDR_ACTION_SHOW_NEXT, 0},
    {"O", KDR_ACTION_SHADOWS, 0},
    {"L", KDR_ACTION_CELLS, 0},
    {",", KDR_ACTION_CELLS_UP, 0},
    {".", KDR_ACTION_CELLS_DOWN, 0},
    {"0", KDR_ACTION_PLAN, 0},
    {"1", KDR_ACTION_PLAN, 1},
    {"2", KDR_ACTION_PLAN, 2},
    {"3", KDR_ACTION_PLAN, 3},
    {"4", KDR_ACTION_PLAN, 4},
    {"5", KDR_ACTION_PLAN, 5},
    {"6", KDR_ACTION_PLAN, 6},
    {"7", KDR_ACTION_PLAN, 7},
    {"8", KDR_ACTION_PLAN, 8},
    {"T", KDR_ACTION_TRACE_NEXT, 0},
    {"P", KDR_ACTION_SHOT, 0},
    {"F12", KDR_ACTION_SHOT, 0},
    {"F11", KDR_ACTION_SHOT_ALL, 0},
};

static const struct {
    const char *keys, *text;
} help[] = {
    {"left drag", "go around the target"},
    {"middle drag, Shift+left", "shift the picture"},
    {"right drag", "turn the head"},
    {"wheel", "nearer, farther"},
    {"W A S D Q E", "fly; Shift: faster"},
    {"R", "the camera as it was; still scenes: Home"},
    {"Space", "play, pause"},
    {"Left, Right", "one frame"},
    {"[ ] or Page, Home, End", "a second; the ends"},
    {"drag the bar", "go to a moment"},
    {"Z X C V B, Tab", "picture, normals, depth, nodes, triangles"},
    {"O", "shadows"},
    {"L , .", "cells of the tree; fewer, more"},
    {"1 2 3", "plan: fast, balanced, best"},
    {"4 5 6", "sweep, space median, object median"},
    {"7 8 9 0", "grid of 16, breadth first, lazy, as given"},
    {"T, Shift+T", "next traversal, the one before"},
    {"P, F12", "screenshot; F11: with all text"},
    {"I", "figures on or off"},
    {"H, F1", "this list"},
    {"Esc", "quit"},
};

kdr_view_key kdr_view_key_find(const char *name) {
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++)
        if (strcmp(keys[i].name, name) == 0)
            return keys[i];
    return (kdr_view_key){name, KDR_ACTION_NONE, 0};
}

const char *kdr_view_help_keys(size_t i) { return i < sizeof help / sizeof help[0] ? help[i].keys : NULL; }

const char *kdr_view_help_text(size_t i) { return i < sizeof help / sizeof help[0] ? help[i].text : NULL; }
