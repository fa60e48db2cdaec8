/* What keys do: one table for whoever presses them and for whoever reads of them. */
#ifndef KDR_APPS_KDRAY_VIEW_KEYS_H
#define KDR_APPS_KDRAY_VIEW_KEYS_H

#include <stddef.h>
#include <stdint.h>

typedef enum kdr_view_action {
    KDR_ACTION_NONE,
    KDR_ACTION_QUIT,
    KDR_ACTION_HELP,
    KDR_ACTION_PANEL,
    KDR_ACTION_PLAY,
    KDR_ACTION_FRAME_BACK,
    KDR_ACTION_FRAME_ON,
    KDR_ACTION_SECOND_BACK,
    KDR_ACTION_SECOND_ON,
    KDR_ACTION_BEGIN,
    KDR_ACTION_END,
    KDR_ACTION_RESET,
    KDR_ACTION_SHOW, /* number: a kdr_view_show */
    KDR_ACTION_SHOW_NEXT,
    KDR_ACTION_SHADOWS,
    KDR_ACTION_CELLS,
    KDR_ACTION_CELLS_UP,
    KDR_ACTION_CELLS_DOWN,
    KDR_ACTION_PLAN, /* number: of view_plans.h */
    KDR_ACTION_TRACE_NEXT,
    KDR_ACTION_SHOT,
    KDR_ACTION_SHOT_ALL,
} kdr_view_action;

typedef struct kdr_view_key {
    const char *name; /* as SDL names it */
    kdr_view_action action;
    uint32_t number;
} kdr_view_key;

/* What a key does when it is pressed; action NONE if nothing. */
kdr_view_key kdr_view_key_find(const char *name);

/* Line i of the help: what is pressed, and what it does. NULL past the last one. */
const char *kdr_view_help_keys(size_t i);
const char *kdr_view_help_text(size_t i);

#endif
