/* Numbers in text, read without the locale: '.' is the decimal point everywhere.
 *
 * The idea: up to 19 digits are gathered as an integer (more are dropped, a relative error under 1e-18), turned to
 * double and scaled by powers of ten up to 1e22, which doubles hold exactly. A number of at most 15 digits and an
 * exponent within 22 is the nearest double; others suffer at most 20 roundings of 2^-53 each, far below the 2^-24 of
 * one unit in the last place of a float. So the float is the nearest or its neighbour, without a slow path.
 * Cost: one multiplication a digit. */
#ifndef KDR_MESH_NUMBER_H
#define KDR_MESH_NUMBER_H

#include <stdbool.h>
#include <stdint.h>

/* Reads a number at *p, before end, and moves *p past it. Takes sign, digits, point, exponent, and "nan", "inf",
 * "infinity" in any case, also as some compilers' libraries print them ("1.#QNAN", "-nan(ind)"). Too large: infinite.
 * False, *p unchanged, when no number begins there. */
bool kdr_number_read_double(const char **p, const char *end, double *out);

/* Digits with a sign; false also when it does not fit. */
bool kdr_number_read_int(const char **p, const char *end, int64_t *out);

/* The same; short numbers without a sign, which most are, need no call. */
static inline bool kdr_number_read_index(const char **p, const char *end, int64_t *out) {
    const char *q = *p;
    int64_t value = 0;
    for (; q < end && (unsigned char)(*q - '0') < 10 && value < 100000000; q++)
        value = 10 * value + (*q - '0');
    if (q == *p || value >= 100000000)
        return kdr_number_read_int(p, end, out);
    *p = q;
    *out = value;
    return true;
}

#endif
