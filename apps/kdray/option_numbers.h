/* Numbers in options, read strictly: the whole word, finite, in range. What is wrong is told in one sentence that names
 * the option and what was expected, and ends the program with the status of wrong usage. */
#ifndef KDR_APPS_KDRAY_OPTION_NUMBERS_H
#define KDR_APPS_KDRAY_OPTION_NUMBERS_H

#include <argp.h>
#include <stdbool.h>
#include <stdint.h>

/* A whole number from min to max. */
uint64_t kdr_option_whole(struct argp_state *state, const char *option, const char *text, uint64_t min, uint64_t max);

/* A number that is at least min and at most max. */
double kdr_option_between(struct argp_state *state, const char *option, const char *text, double min, double max);

/* A number above min and below max, neither of them included. */
double kdr_option_inside(struct argp_state *state, const char *option, const char *text, double min, double max);

/* A number above 0 and at most max. */
float kdr_option_positive(struct argp_state *state, const char *option, const char *text, float max);

/* X,Y,Z. */
void kdr_option_triple(struct argp_state *state, const char *option, const char *text, float out[3]);

/* WIDTHxHEIGHT, each from 1 to limit. */
void kdr_option_size(struct argp_state *state, const char *option, const char *text, uint32_t limit, uint32_t *width,
                     uint32_t *height);

/* AXIS=POSITION: x, y or z, and a finite number or a percentage from 0% to 100%. */
void kdr_option_position(struct argp_state *state, const char *option, const char *text, uint32_t *axis, double *value,
                         bool *percent);

#endif
