#include "canvas.h"

void kdr_canvas_blend(kdr_canvas *canvas, int x, int y, uint32_t colour, uint32_t cover) {
    if (x < 0 || y < 0 || x >= canvas->width || y >= canvas->height)
        return;
    uint32_t *pixel = &canvas->pixels[(uint64_t)y * (uint64_t)canvas->width + (uint64_t)x], below = *pixel;
    // Red and blue together: there is room between them.
    uint32_t red_blue = ((below & 0xff00ff) * (256 - cover) + (colour & 0xff00ff) * cover) >> 8 & 0xff00ff;
    uint32_t green = ((below & 0x00ff00) * (256 - cover) + (colour & 0x00ff00) * cover) >> 8 & 0x00ff00;
    *pixel = red_blue | green;
}

void kdr_canvas_fill(kdr_canvas *canvas, int x, int y, int width, int height, uint32_t colour, uint32_t cover) {
    int right = x + width < canvas->width ? x + width : canvas->width;
    int bottom = y + height < canvas->height ? y + height : canvas->height;
    for (int row = y > 0 ? y : 0; row < bottom; row++)
        for (int column = x > 0 ? x : 0; column < right; column++)
            kdr_canvas_blend(canvas, column, row, colour, cover);
}
