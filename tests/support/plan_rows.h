/* The rows of the builder's tables as text, for tests that loop over all of them. */
#ifndef KDR_TESTS_SUPPORT_PLAN_ROWS_H
#define KDR_TESTS_SUPPORT_PLAN_ROWS_H

#include "kdray/kdray.h"

#include <stddef.h>

/* Words "split=..." and what goes with that splitter alone; rules for the axis; shares of every kind, the first of
 * which is none; orders. */
extern const char *const split_rows[], *const axis_rows[], *const share_rows[], *const order_rows[];
extern const size_t split_row_count, axis_row_count, share_row_count, order_row_count;

#define PLAN_ROW_TEXT 160

/* Joins words, any of which may be empty, to a plan, whose text goes to `text`. Fails the running test if it is none.
 */
kdr_build_def plan_of_words(char text[PLAN_ROW_TEXT], const char *split, const char *axis, const char *share,
                            const char *order);

#endif
