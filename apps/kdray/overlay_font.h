/* Letters to draw with: ASCII, all as wide. */
#ifndef KDR_APPS_KDRAY_OVERLAY_FONT_H
#define KDR_APPS_KDRAY_OVERLAY_FONT_H

#include <stdbool.h>

#define KDR_FONT_WIDTH 5
#define KDR_FONT_HEIGHT 8

/* True if a letter has ink at that place; nothing outside, and none in letters that are not there. */
bool kdr_font_has(char letter, int column, int row);

#endif
