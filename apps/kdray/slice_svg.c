/* A sheet as SVG: one path for the leaves of each depth, so that a rectangle takes some 30 bytes. */
#include "depth_scale.h"
#include "report.h"
#include "slice.h"
#include "utf8.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#define MARGIN 16
#define LINE 18           /* pixels from one line of text to the next */
#define LETTER 7.3        /* width of a letter, at most */
#define LEAST_WIDTH 560.0 /* of the legend */
#define SWATCH 12

/* ---- text */

/* A letter of any text as XML: what cannot be told becomes U+FFFD. Returns its bytes. */
static int put_letter(FILE *file, const unsigned char *text) {
    int length = kdr_utf8_length(text);
    bool none = length == 3 && text[0] == 0xef && text[1] == 0xbf && text[2] >= 0xbe; /* no XML has these two */
    if (length == 0 || none || *text < 0x20 || *text == 0x7f)
        fputs("&#xFFFD;", file);
    else if (*text == '<' || *text == '>' || *text == '&')
        fprintf(file, "&#%d;", *text);
    else
        fwrite(text, 1, (size_t)length, file);
    return length > 0 ? length : 1;
}

static void put_text(FILE *file, const char *text) {
    for (const unsigned char *at = (const unsigned char *)text; *at;)
        at += put_letter(file, at);
}

/* Text in lines, broken at spaces, or where a word alone is too long; returns where the next line goes. file NULL: no
 * more than that. */
static double put_lines(FILE *file, double y, size_t columns, const char *text) {
    const unsigned char *at = (const unsigned char *)text;
    while (*at) {
        /* Find the end of the line. */
        const unsigned char *end = at, *space = NULL;
        size_t letters = 0;
        for (; *end && letters < columns; letters++) {
            int length = kdr_utf8_length(end);
            end += length > 0 ? length : 1;
            if (*end == ' ' || *end == 0)
                space = end;
        }
        end = space ? space : end;
        if (file) {
            fprintf(file, "<text x=\"%d\" y=\"%.0f\">", MARGIN, y);
            while (at < end)
                at += put_letter(file, at);
            fputs("</text>\n", file);
        }
        at = end;
        while (*at == ' ')
            at++;
        y += LINE;
    }
    return y;
}

/* ---- the cut */

static double part_of(const kdr_slice_sheet *sheet, uint32_t depth) {
    uint32_t range = sheet->largest_depth - sheet->least_depth;
    return range > 0 ? (double)(depth - sheet->least_depth) / range : 0;
}

/* A number of tenths, as short as it can be. */
static void put_tenths(FILE *file, const char *before, long tenths) {
    if (tenths % 10)
        fprintf(file, "%s%.1f", before, (double)tenths / 10);
    else
        fprintf(file, "%s%ld", before, tenths / 10);
}

static long tenths_of(float pixels) { return lround(10 * (double)pixels); }

/* The rectangles of one depth. Corners, not sides, are rounded, so neighbours touch; what has no width then is not
 * drawn. */
static void put_rectangles(FILE *file, const kdr_slice_sheet *sheet, uint32_t depth, bool empty) {
    bool open = false;
    uint32_t colour = kdr_depth_colour(part_of(sheet, depth));
    for (size_t i = 0; i < sheet->rectangle_count; i++) {
        const kdr_slice_rectangle *r = &sheet->rectangles[i];
        if (r->depth != depth || r->empty != empty)
            continue;
        long left = tenths_of(r->left), top = tenths_of(r->top), right = tenths_of(r->right);
        long bottom = tenths_of(r->bottom);
        if (left == right || top == bottom)
            continue;
        if (!open)
            fprintf(file,
                    empty ? "<path fill=\"none\" stroke=\"#%06" PRIx32 "\" d=\"" : "<path fill=\"#%06" PRIx32 "\" d=\"",
                    colour);
        open = true;
        put_tenths(file, "M", left);
        put_tenths(file, " ", top);
        put_tenths(file, "H", right);
        put_tenths(file, "V", bottom);
        put_tenths(file, "H", left);
        fputs("z", file);
    }
    if (open)
        fputs("\"/>\n", file);
}

static void put_segments(FILE *file, const kdr_slice_sheet *sheet) {
    if (sheet->segment_count == 0)
        return;
    fputs("<path fill=\"none\" stroke=\"#e03c1c\" stroke-width=\"1\" stroke-linecap=\"round\" d=\"", file);
    for (size_t i = 0; i < sheet->segment_count; i++) {
        const kdr_slice_segment *s = &sheet->segments[i];
        put_tenths(file, "M", tenths_of(s->from[0]));
        put_tenths(file, " ", tenths_of(s->from[1]));
        put_tenths(file, "L", tenths_of(s->to[0]));
        put_tenths(file, " ", tenths_of(s->to[1]));
    }
    fputs("\"/>\n", file);
}

static void put_cut(FILE *file, const kdr_slice_sheet *sheet) {
    fprintf(file, "<g transform=\"translate(%d %d)\" stroke-width=\"0.6\">\n<g stroke=\"#fff\">\n", MARGIN, MARGIN);
    for (uint32_t depth = sheet->least_depth; depth <= sheet->largest_depth; depth++)
        put_rectangles(file, sheet, depth, false);
    fputs("</g>\n", file);
    for (uint32_t depth = sheet->least_depth; depth <= sheet->largest_depth; depth++)
        put_rectangles(file, sheet, depth, true);
    put_segments(file, sheet);
    fputs("</g>\n", file);
}

/* ---- the legend */

/* A square a depth with its number under it, and one for an empty leaf. Returns where the next line goes. */
static double put_scale(FILE *file, const kdr_slice_sheet *sheet, double y, double width) {
    uint32_t count = sheet->largest_depth - sheet->least_depth + 1;
    double step = fmin((width - 220) / count, 28);
    uint32_t every = (uint32_t)ceil(20 / step);
    fprintf(file, "<text x=\"%d\" y=\"%.0f\">depth</text>\n", MARGIN, y);
    double x = MARGIN + 50;
    for (uint32_t i = 0; i < count; i++, x += step) {
        fprintf(file, "<rect x=\"%.1f\" y=\"%.0f\" width=\"%.1f\" height=\"%d\" fill=\"#%06" PRIx32 "\"/>\n", x,
                y - SWATCH + 2, step, SWATCH, kdr_depth_colour(part_of(sheet, sheet->least_depth + i)));
        if (i % every == 0)
            fprintf(file, "<text x=\"%.1f\" y=\"%.0f\" text-anchor=\"middle\" font-size=\"10\">%" PRIu32 "</text>\n",
                    x + step / 2, y + SWATCH, sheet->least_depth + i);
    }
    fprintf(file,
            "<rect x=\"%.1f\" y=\"%.0f\" width=\"%d\" height=\"%d\" fill=\"none\" stroke=\"#666\"/>\n"
            "<text x=\"%.1f\" y=\"%.0f\">empty leaf</text>\n",
            x + 16, y - SWATCH + 2, SWATCH, SWATCH, x + 34, y);
    return y + LINE + SWATCH;
}

#define LINES 5
#define LINE_SIZE 256

/* The lines of the legend but for the scale. */
static void write_lines(const kdr_slice_sheet *sheet, const kdr_slice_legend *legend, char lines[LINES][LINE_SIZE]) {
    const kdr_tree_stats *tree = legend->tree;
    snprintf(lines[0], LINE_SIZE, "%.220s, %" PRIu64 " triangles", legend->name, tree->triangle_count);
    snprintf(lines[1], LINE_SIZE, "%s", legend->plan);
    snprintf(lines[2], LINE_SIZE, "tree: cost %.1f, %.2f references a triangle, %" PRIu64 " leaves, depth %" PRIu32,
             tree->cost, kdr_tree_duplication(tree), tree->leaf_count, tree->depth);
    snprintf(lines[3], LINE_SIZE, "cut at %c = %.6g (%.4g %% of the box), %c to the right, %c up", "xyz"[sheet->axis],
             sheet -> position, 100 * sheet -> part, "xyz"[sheet->across], "xyz"[sheet->up]);
    int length =
        snprintf(lines[4], LINE_SIZE, "%zu leaves cut, %zu of them empty", sheet->leaf_count, sheet->empty_count);
    if (sheet->together_count > 0)
        snprintf(lines[4] + length, LINE_SIZE - (size_t)length, "; the smallest are drawn together, in %zu rectangles",
                 sheet->together_count);
}

void kdr_slice_draw(FILE *file, const kdr_slice_sheet *sheet, const kdr_slice_legend *legend) {
    char lines[LINES][LINE_SIZE];
    write_lines(sheet, legend, lines);

    /* Lines tell how tall it becomes. */
    double width = fmax(sheet->width, LEAST_WIDTH), first = MARGIN + sheet->height + 2 * LINE, end = first;
    size_t columns = (size_t)(width / LETTER);
    for (int i = 0; i < LINES; i++)
        end = put_lines(NULL, end, columns, lines[i]);
    end += LINE + SWATCH;

    fprintf(file,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" viewBox=\"0 0 %.0f %.0f\" "
            "font-family=\"monospace\" font-size=\"12\">\n<title>Cells of ",
            width + 2 * MARGIN, end, width + 2 * MARGIN, end);
    put_text(file, lines[0]);
    fputs(", ", file);
    put_text(file, lines[1]);
    fputs("</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n", file);
    put_cut(file, sheet);
    double y = first;
    for (int i = 0; i < LINES; i++)
        y = put_lines(file, y, columns, lines[i]);
    put_scale(file, sheet, y, width);
    fputs("</svg>\n", file);
}
