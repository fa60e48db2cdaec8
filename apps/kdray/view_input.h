/* Hands on a view: keys and the mouse. */
#ifndef KDR_APPS_KDRAY_VIEW_INPUT_H
#define KDR_APPS_KDRAY_VIEW_INPUT_H

#include "viewing.h"

/* Does what an event asks for. */
void kdr_view_input_take(kdr_viewing *view, const kdr_window_event *event);

/* Flies by the keys that have been held for some seconds. */
void kdr_view_input_fly(kdr_viewing *view, double seconds);

#endif
