/* A cursor over text in memory: words, numbers and lines, with the line's number for sentences.
 *
 * Lines end with LF, CR LF or CR. Nothing reads at or past `end`; the text needs no final zero. */
#ifndef KDR_MESH_TEXT_H
#define KDR_MESH_TEXT_H

#include "mesh/number.h"

#include <stddef.h>

typedef struct kdr_text {
    const char *p, *end;
    size_t line;    /* of p; counts from 1 */
    bool continues; /* a backslash at the end of a line joins the next one */
} kdr_text;

typedef struct kdr_word {
    const char *start;
    size_t length;
} kdr_word;

/* What stands at the cursor, for "expected ..., found %s": a word in quotes, or that the line or file ends. */
#define KDR_TEXT_FOUND_BYTES 48
const char *kdr_text_found(const kdr_text *text, char found[KDR_TEXT_FOUND_BYTES]);

bool kdr_word_is(kdr_word word, const char *name);
bool kdr_word_is_any_case(kdr_word word, const char *lower_case_name);

/* Past a backslash at the end of a line; false when none is at p. */
bool kdr_text_join_line(kdr_text *text);

static inline bool kdr_is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
static inline bool kdr_is_line_end(char c) { return c == '\n' || c == '\r'; }

/* Past blanks, not past the end of the line. */
static inline void kdr_text_skip_blanks(kdr_text *text) {
    while (text->p < text->end) {
        if (kdr_is_blank(*text->p))
            text->p++;
        else if (*text->p != '\\' || !text->continues || !kdr_text_join_line(text))
            return;
    }
}

/* Whether only blanks are left of the line; the cursor then stands at its end. */
static inline bool kdr_text_at_line_end(kdr_text *text) {
    kdr_text_skip_blanks(text);
    return text->p == text->end || kdr_is_line_end(*text->p);
}

/* To the end of the line, whatever stands there. */
void kdr_text_skip_rest(kdr_text *text);

/* Past the end of the line at the cursor. False at the end of the text. */
static inline bool kdr_text_next_line(kdr_text *text) {
    if (text->p == text->end)
        return false;
    if (*text->p == '\r' && text->end - text->p > 1 && text->p[1] == '\n')
        text->p++;
    text->p++;
    text->line++;
    return true;
}

/* To the next line that is not blank, the present one included; false when there is none. */
static inline bool kdr_text_skip_blank_lines(kdr_text *text) {
    while (kdr_text_at_line_end(text))
        if (!kdr_text_next_line(text))
            return false;
    return true;
}

/* The next word of the line; length 0 at its end. */
kdr_word kdr_text_take_word(kdr_text *text);

/* All that is left of the line, blanks at both ends put aside. */
kdr_word kdr_text_take_rest(kdr_text *text);

/* The next word as a number; false, cursor at the word, when it is none. */
bool kdr_text_take_double(kdr_text *text, double *out);
bool kdr_text_take_int(kdr_text *text, int64_t *out);

#endif
