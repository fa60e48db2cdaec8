/* Frames of a view: traced, written over, shown, and kept as files. */
#ifndef KDR_APPS_KDRAY_VIEW_FRAME_H
#define KDR_APPS_KDRAY_VIEW_FRAME_H

#include "viewing.h"

/* Brings the picture to the moment and the plan that are wanted, and shows it, as fine as there is time for; *rests
 * becomes true if there was nothing to do. False after a sentence. */
bool kdr_view_frame_show(kdr_viewing *view, bool *rests);

/* Writes the picture of this moment, as fine as it becomes, to a PNG file; with_text: and what is written over it.
 * False after a sentence to the logger. */
bool kdr_view_frame_write(kdr_viewing *view, const char *path, bool with_text, const kdr_logger *logger);

/* The same under the first name of kdray-0001.png, kdray-0002.png and so on that is free; view->note says which. */
void kdr_view_frame_shoot(kdr_viewing *view, bool with_text);

#endif
