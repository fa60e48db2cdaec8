#include "overlay_text.h"

/* Of a letter of UTF-8 only the first byte counts. */
static bool follows(char byte) { return ((unsigned char)byte & 0xc0) == 0x80; }

int kdr_text_dot(int width, int height) {
    int side = width * 3 < height * 4 ? width * 3 / 4 : height;
    return side >= 1200 ? 3 : side >= 560 ? 2 : 1;
}

static void draw_letter(kdr_canvas *canvas, int x, int y, int dot, uint32_t colour, char letter) {
    for (int row = 0; row < KDR_FONT_HEIGHT; row++)
        for (int column = 0; column < KDR_FONT_WIDTH; column++)
            if (kdr_font_has(letter, column, row))
                kdr_canvas_fill(canvas, x + column * dot, y + row * dot, dot, dot, colour, 256);
}

int kdr_text_draw(kdr_canvas *canvas, int x, int y, int dot, uint32_t colour, const char *text) {
    int count = 0;
    for (; *text; text++) {
        if (follows(*text))
            continue;
        char letter = *text >= ' ' && *text <= '~' ? *text : '?';
        draw_letter(canvas, x + count * KDR_TEXT_ADVANCE * dot, y, dot, colour, letter);
        count++;
    }
    return count;
}

int kdr_text_length(const char *text) {
    int count = 0;
    for (; *text; text++)
        count += !follows(*text);
    return count;
}
