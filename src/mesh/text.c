#include "mesh/text.h"

#include <stdio.h>
#include <string.h>

static bool is_word_end(const kdr_text *text, const char *p) {
    return p == text->end || kdr_is_blank(*p) || kdr_is_line_end(*p);
}

const char *kdr_text_found(const kdr_text *text, char found[KDR_TEXT_FOUND_BYTES]) {
    const char *p = text->p;
    while (!is_word_end(text, p))
        p++;
    size_t length = (size_t)(p - text->p), most = KDR_TEXT_FOUND_BYTES - 8;
    if (length)
        snprintf(found, KDR_TEXT_FOUND_BYTES, "'%.*s%s'", (int)(length < most ? length : most), text->p,
                 length > most ? "..." : "");
    else
        snprintf(found, KDR_TEXT_FOUND_BYTES, text->p == text->end ? "the end of the file" : "the end of the line");
    return found;
}

bool kdr_word_is(kdr_word word, const char *name) {
    return word.length == strlen(name) && memcmp(word.start, name, word.length) == 0;
}

bool kdr_word_is_any_case(kdr_word word, const char *name) {
    if (word.length != strlen(name))
        return false;
    for (size_t i = 0; i < word.length; i++) {
        char c = word.start[i];
        if (c >= 'A' && c <= 'Z')
            c = (char)(c | 32);
        if (c != name[i])
            return false;
    }
    return true;
}

bool kdr_text_join_line(kdr_text *text) {
    const char *p = text->p;
    if (text->end - p < 2 || *p != '\\' || !kdr_is_line_end(p[1]))
        return false;
    text->p++;
    kdr_text_next_line(text);
    return true;
}

void kdr_text_skip_rest(kdr_text *text) {
    for (;;) {
        while (text->p < text->end && !kdr_is_line_end(*text->p) && *text->p != '\\')
            text->p++;
        if (text->p == text->end || *text->p != '\\')
            return;
        if (!text->continues || !kdr_text_join_line(text))
            text->p++;
    }
}

kdr_word kdr_text_take_word(kdr_text *text) {
    kdr_text_skip_blanks(text);
    const char *start = text->p;
    while (!is_word_end(text, text->p) &&
           !(text->continues && *text->p == '\\' && text->end - text->p > 1 && kdr_is_line_end(text->p[1])))
        text->p++;
    return (kdr_word){start, (size_t)(text->p - start)};
}

kdr_word kdr_text_take_rest(kdr_text *text) {
    kdr_text_skip_blanks(text);
    const char *start = text->p;
    while (text->p < text->end && !kdr_is_line_end(*text->p))
        text->p++;
    const char *last = text->p;
    while (last > start && kdr_is_blank(last[-1]))
        last--;
    return (kdr_word){start, (size_t)(last - start)};
}

/* A number must fill its word. */
static bool fills_word(const kdr_text *text, const char *p) {
    return is_word_end(text, p) || (text->continues && *p == '\\');
}

bool kdr_text_take_double(kdr_text *text, double *out) {
    kdr_text_skip_blanks(text);
    const char *p = text->p;
    if (!kdr_number_read_double(&p, text->end, out) || !fills_word(text, p))
        return false;
    text->p = p;
    return true;
}

bool kdr_text_take_int(kdr_text *text, int64_t *out) {
    kdr_text_skip_blanks(text);
    const char *p = text->p;
    if (!kdr_number_read_int(&p, text->end, out) || !fills_word(text, p))
        return false;
    text->p = p;
    return true;
}
