#include "view_panel.h"

#include "overlay_text.h"
#include "view_keys.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define INK 0xf2f2f2
#define DIM 0xa8b4c0
#define ACCENT 0xffb020
#define GROUND 0x0c1016
#define GROUND_COVER 176 /* of 256 */
#define SCALE_STEPS 100

/* A number with commas between thousands. */
static void write_count(char text[32], size_t number) {
    char digits[32];
    int length = snprintf(digits, sizeof digits, "%zu", number), out = 0;
    for (int i = 0; i < length; i++) {
        if (i > 0 && (length - i) % 3 == 0)
            text[out++] = ',';
        text[out++] = digits[i];
    }
    text[out] = 0;
}

int kdr_view_panel_lines(const kdr_view_figures *figures, char lines[KDR_PANEL_LINES][KDR_PANEL_LINE_SIZE]) {
    const kdr_view_figures *f = figures;
    char count[32], grain[32];
    int line = 0;
    write_count(count, f->triangles);
    // The end of a long name says more than its beginning.
    size_t length = strlen(f->file), most = 40;
    snprintf(lines[line++], KDR_PANEL_LINE_SIZE, "%s%s, %s", length > most ? "..." : "",
             f->file + (length > most ? length - most : 0), kdr_view_show_name(f->show));
    snprintf(lines[line++], KDR_PANEL_LINE_SIZE, "mesh  %8.2f ms  %s triangle%s", f->sample_ms, count,
             f->triangles == 1 ? "" : "s");
    snprintf(lines[line++], KDR_PANEL_LINE_SIZE, "build %8.2f ms  plan %s", f->build_ms, f->plan);
    snprintf(lines[line++], KDR_PANEL_LINE_SIZE, "trace %8.2f ms  %.1f Mray/s, %s", f->trace_ms, f->mega_rays,
             f->trace);
    if (f->scale > 1)
        snprintf(grain, sizeof grain, ", coarse 1/%" PRIu32, f->scale);
    else
        snprintf(grain, sizeof grain, ", %" PRIu32 " sample%s", f->samples, f->samples == 1 ? "" : "s");
    if (f->frames_a_second > 0)
        snprintf(lines[line++], KDR_PANEL_LINE_SIZE, "speed %8.1f fps %" PRIu32 "x%" PRIu32 "%s", f->frames_a_second,
                 f->width, f->height, grain);
    else
        snprintf(lines[line++], KDR_PANEL_LINE_SIZE, "speed  at rest    %" PRIu32 "x%" PRIu32 "%s", f->width, f->height,
                 grain);
    if (f->cells)
        snprintf(lines[line++], KDR_PANEL_LINE_SIZE, "cells %8" PRIu32 "%s   to depth %" PRIu32, f->cell_count,
                 f->cells_cut ? "+" : " ", f->cell_depth);
    if (f->note)
        snprintf(lines[line++], KDR_PANEL_LINE_SIZE, "%s", f->note);
    return line;
}

static void draw_ground(kdr_canvas *canvas, int x, int y, int width, int height) {
    kdr_canvas_fill(canvas, x, y, width, height, GROUND, GROUND_COVER);
}

void kdr_view_panel_draw(kdr_canvas *canvas, const kdr_view_figures *figures) {
    char lines[KDR_PANEL_LINES][KDR_PANEL_LINE_SIZE];
    int count = kdr_view_panel_lines(figures, lines), longest = 0, dot = kdr_text_dot(canvas->width, canvas->height);
    for (int i = 0; i < count; i++) {
        int length = kdr_text_length(lines[i]);
        longest = length > longest ? length : longest;
    }
    int margin = 6 * dot;
    draw_ground(canvas, margin, margin, longest * KDR_TEXT_ADVANCE * dot + 2 * margin - dot,
                count * KDR_TEXT_LINE * dot + 2 * margin - 3 * dot);
    for (int i = 0; i < count; i++) {
        bool is_note = i == count - 1 && figures->note;
        kdr_text_draw(canvas, 2 * margin, 2 * margin + i * KDR_TEXT_LINE * dot, dot,
                      i == 0    ? ACCENT
                      : is_note ? DIM
                                : INK,
                      lines[i]);
    }
}

/* A number in few letters. */
static void write_value(char text[32], double value) {
    if (value != 0 && (fabs(value) < 0.01 || fabs(value) >= 1e6))
        snprintf(text, 32, "%.2g", value);
    else
        snprintf(text, 32, "%.*f", fabs(value) >= 100 || value == floor(value) ? 0 : 2, value);
}

void kdr_view_panel_draw_scale(kdr_canvas *canvas, const kdr_view_figures *figures) {
    if (!kdr_view_show_is_value(figures->show))
        return;
    char low[32], high[32];
    const char *name = kdr_view_show_name(figures->show);
    write_value(low, figures->low);
    write_value(high, figures->high);
    int dot = kdr_text_dot(canvas->width, canvas->height), margin = 6 * dot, letter = KDR_TEXT_ADVANCE * dot;
    int letters = kdr_text_length(name);
    letters = kdr_text_length(low) > letters ? kdr_text_length(low) : letters;
    letters = kdr_text_length(high) > letters ? kdr_text_length(high) : letters;
    int line = KDR_TEXT_LINE * dot, bar = SCALE_STEPS * dot;
    int width = letters * letter + 2 * margin, height = bar + 3 * line + 2 * margin;
    int x = canvas->width - width - margin, y = margin;
    draw_ground(canvas, x, y, width, height);
    kdr_text_draw(canvas, x + margin, y + margin, dot, ACCENT, name);
    kdr_text_draw(canvas, x + margin, y + margin + line, dot, INK, high);
    for (int i = 0; i < SCALE_STEPS; i++)
        kdr_canvas_fill(canvas, x + margin, y + margin + 2 * line + i * dot, 4 * letter, dot,
                        kdr_view_show_colour(figures->show, 1 - (i + 0.5) / SCALE_STEPS), 256);
    kdr_text_draw(canvas, x + margin, y + margin + 2 * line + bar + 3 * dot, dot, INK, low);
}

void kdr_view_panel_draw_help(kdr_canvas *canvas) {
    int lines = 0, left = 0, right = 0;
    for (; kdr_view_help_keys((size_t)lines); lines++) {
        int keys = kdr_text_length(kdr_view_help_keys((size_t)lines));
        int text = kdr_text_length(kdr_view_help_text((size_t)lines));
        left = keys > left ? keys : left;
        right = text > right ? text : right;
    }
    // Smaller letters where it would not fit
    int dot = kdr_text_dot(canvas->width, canvas->height), letters = left + 2 + right;
    while (dot > 1 && ((letters * KDR_TEXT_ADVANCE + 24) * dot > canvas->width ||
                       (lines * KDR_TEXT_LINE + 24) * dot > canvas->height))
        dot--;
    int margin = 10 * dot, width = letters * KDR_TEXT_ADVANCE * dot + 2 * margin;
    int height = lines * KDR_TEXT_LINE * dot + 2 * margin;
    int x = (canvas->width - width) / 2, y = (canvas->height - height) / 2;
    kdr_canvas_fill(canvas, x, y, width, height, GROUND, 224);
    for (int i = 0; i < lines; i++) {
        int top = y + margin + i * KDR_TEXT_LINE * dot;
        kdr_text_draw(canvas, x + margin, top, dot, ACCENT, kdr_view_help_keys((size_t)i));
        kdr_text_draw(canvas, x + margin + (left + 2) * KDR_TEXT_ADVANCE * dot, top, dot, INK,
                      kdr_view_help_text((size_t)i));
    }
}

/* ---- the bar */

typedef struct bar_place {
    int x, y, width, height;
} bar_place;

static bar_place bar_of(int width, int height) {
    int dot = kdr_text_dot(width, height), margin = 6 * dot;
    // Room for the time on its right
    int text = 22 * KDR_TEXT_ADVANCE * dot;
    bar_place bar = {2 * margin, height - 3 * margin, width - 5 * margin - text, 6 * dot};
    bar.width = bar.width > 20 ? bar.width : 20;
    return bar;
}

double kdr_view_panel_along_bar(int width, int height, int x) {
    bar_place bar = bar_of(width, height);
    return fmin(fmax((double)(x - bar.x) / (bar.width - 1), 0), 1);
}

double kdr_view_panel_on_bar(int width, int height, int x, int y) {
    bar_place bar = bar_of(width, height);
    // A hand is not as sure as the bar is narrow.
    bool on = x >= bar.x - bar.height && x < bar.x + bar.width + bar.height && y >= bar.y - bar.height &&
              y < bar.y + 2 * bar.height;
    return on ? kdr_view_panel_along_bar(width, height, x) : -1;
}

void kdr_view_panel_draw_bar(kdr_canvas *canvas, const kdr_view_clock *clock) {
    bar_place bar = bar_of(canvas->width, canvas->height);
    int dot = kdr_text_dot(canvas->width, canvas->height), margin = 6 * dot;
    char text[64];
    if (isfinite(clock->duration))
        snprintf(text, sizeof text, "%s %6.2f / %.2f s", clock->playing ? "play " : "pause", clock->time,
                 clock->duration);
    else
        snprintf(text, sizeof text, "%s %6.2f s", clock->playing ? "play " : "pause", clock->time);
    draw_ground(canvas, margin, bar.y - margin, canvas->width - 2 * margin, bar.height + 2 * margin);
    kdr_canvas_fill(canvas, bar.x, bar.y + 2 * dot, bar.width, 2 * dot, DIM, 160);
    int at = (int)(kdr_view_clock_part(clock) * (bar.width - 1));
    kdr_canvas_fill(canvas, bar.x, bar.y + 2 * dot, at, 2 * dot, ACCENT, 256);
    kdr_canvas_fill(canvas, bar.x + at - dot, bar.y, 3 * dot, bar.height, INK, 256);
    kdr_text_draw(canvas, bar.x + bar.width + margin, bar.y - dot, dot, INK, text);
}
