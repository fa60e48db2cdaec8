/* Text on a canvas. */
#ifndef KDR_APPS_KDRAY_OVERLAY_TEXT_H
#define KDR_APPS_KDRAY_OVERLAY_TEXT_H

#include "canvas.h"
#include "overlay_font.h"

/* From one letter to the next, and from one line to the next, in dots. */
#define KDR_TEXT_ADVANCE (KDR_FONT_WIDTH + 1)
#define KDR_TEXT_LINE (KDR_FONT_HEIGHT + 3)

/* Pixels of a dot that suit a picture of that size. */
int kdr_text_dot(int width, int height);

/* Writes a line, its upper left corner at (x, y). Bytes that are no ASCII letters show as one question mark a letter of
 * UTF-8. Returns how many letters were written. */
int kdr_text_draw(kdr_canvas *canvas, int x, int y, int dot, uint32_t colour, const char *text);

/* Letters that kdr_text_draw would write. */
int kdr_text_length(const char *text);

#endif
