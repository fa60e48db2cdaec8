#include "mesh/number.h"

#include <math.h>

#define MOST_DIGITS 19 /* that always fit 64 bits */

/* Beyond these exponents every number is infinite or zero as a float, whatever its 19 digits are. */
#define MOST_EXPONENT 400

static bool is_digit(char c) { return (unsigned char)(c - '0') < 10; }

/* word is of lower-case letters, digits and signs; letters match in either case. */
static bool take_word(const char **p, const char *end, const char *word) {
    const char *q = *p;
    for (; *word; word++, q++)
        if (q == end || (*q != *word && (*word < 'a' || (*q | 32) != *word)))
            return false;
    *p = q;
    return true;
}

/* "nan", "inf" and their relatives; the sign is already read. */
static bool read_special(const char **p, const char *end, double *out) {
    const char *q = *p;
    if (take_word(&q, end, "1.#")) {
        *out = take_word(&q, end, "inf") ? (double)INFINITY : (double)NAN;
        while (q < end && ((*q >= 'A' && *q <= 'Z') || is_digit(*q)))
            q++;
    } else if (take_word(&q, end, "infinity") || take_word(&q, end, "inf")) {
        *out = (double)INFINITY;
    } else if (take_word(&q, end, "nan")) {
        *out = (double)NAN;
        if (q < end && *q == '(') {
            const char *inside = q + 1;
            while (inside < end && ((*inside | 32) >= 'a' ? (*inside | 32) <= 'z' : is_digit(*inside)))
                inside++;
            if (inside < end && *inside == ')')
                q = inside + 1;
        }
    } else {
        return false;
    }
    *p = q;
    return true;
}

/* value * 10^exponent */
static double scale(double value, int exponent) {
    static const double powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                    1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    for (; exponent > 22; exponent -= 22)
        value *= powers[22];
    for (; exponent < -22; exponent += 22)
        value /= powers[22];
    return exponent < 0 ? value / powers[-exponent] : value * powers[exponent];
}

/* The exponent after 'e', held within bounds that only zero and infinity lie beyond; 0 when none is there. */
static int64_t read_exponent(const char **p, const char *end) {
    const char *q = *p;
    if (q == end || (*q | 32) != 'e')
        return 0;
    q++;
    bool negative = q < end && *q == '-';
    if (q < end && (*q == '-' || *q == '+'))
        q++;
    if (q == end || !is_digit(*q))
        return 0;
    int64_t exponent = 0;
    for (; q < end && is_digit(*q); q++)
        if (exponent < INT64_MAX / 100)
            exponent = 10 * exponent + (*q - '0');
    *p = q;
    return negative ? -exponent : exponent;
}

bool kdr_number_read_double(const char **p, const char *end, double *out) {
    const char *q = *p;
    bool negative = q < end && *q == '-';
    if (q < end && (*q == '-' || *q == '+'))
        q++;

    // Gather digits; those that do not fit only move the point.
    const char *first = q;
    uint64_t digits = 0;
    int held = 0;
    int64_t exponent = 0;
    for (; q < end && is_digit(*q); q++) {
        if (held < MOST_DIGITS) {
            digits = 10 * digits + (uint64_t)(*q - '0');
            held += digits != 0;
        } else {
            exponent++;
        }
    }
    int64_t seen = q - first;
    if (q < end && *q == '.') {
        q++;
        const char *fraction = q;
        for (; q < end && is_digit(*q); q++) {
            if (held < MOST_DIGITS) {
                digits = 10 * digits + (uint64_t)(*q - '0');
                held += digits != 0;
                exponent--;
            }
        }
        seen += q - fraction;
        if (q < end && *q == '#')
            seen = 0;
    }
    if (seen == 0) {
        if (!read_special(&first, end, out))
            return false;
        *p = first;
    } else {
        exponent += read_exponent(&q, end);
        if (digits == 0 || exponent < -MOST_EXPONENT)
            *out = 0;
        else if (exponent > MOST_EXPONENT)
            *out = (double)INFINITY;
        else
            *out = scale((double)digits, (int)exponent);
        *p = q;
    }
    if (negative)
        *out = -*out;
    return true;
}

bool kdr_number_read_int(const char **p, const char *end, int64_t *out) {
    const char *q = *p;
    bool negative = q < end && *q == '-';
    if (q < end && (*q == '-' || *q == '+'))
        q++;
    if (q == end || !is_digit(*q))
        return false;
    int64_t value = 0;
    for (; q < end && is_digit(*q); q++) {
        if (value > (INT64_MAX - 9) / 10)
            return false;
        value = 10 * value + (*q - '0');
    }
    *out = negative ? -value : value;
    *p = q;
    return true;
}
