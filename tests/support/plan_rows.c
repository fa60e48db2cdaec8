#include "support/plan_rows.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#define COUNT(rows) (sizeof(rows) / sizeof(rows)[0])

const char *const split_rows[] = {"split=binned",
                                  "split=binned empty-bonus=0.5 retract=yes straddle=clip",
                                  "split=space straddle=clip",
                                  "split=object",
                                  "split=sweep",
                                  "split=sweep events=3",
                                  "split=sweep straddle=clip",
                                  "split=sweep events=3 straddle=clip retract=yes box-weight=1",
                                  "quality=best"};
const size_t split_row_count = COUNT(split_rows);

const char *const axis_rows[] = {"axis=best", "axis=longest", "axis=robin"};
const size_t axis_row_count = COUNT(axis_rows);

const char *const share_rows[] = {
    "share=none",       "share=serial/1",  "share=serial/2",  "share=serial/3",    "share=serial/7",
    "share=serial/64",  "share=line/1",    "share=line/2",    "share=line/3",      "share=line/7",
    "share=line/64",    "share=grid/1",    "share=grid/2",    "share=grid/3",      "share=grid/7",
    "share=grid/64",    "share=cluster/1", "share=cluster/2", "share=cluster/3",   "share=cluster/7",
    "share=cluster/64", "share=line/1024", "share=grid/1024", "share=serial/1024", "share=cluster/1024",
};
const size_t share_row_count = COUNT(share_rows);

const char *const order_rows[] = {"order=dfs", "order=bfs"};
const size_t order_row_count = COUNT(order_rows);

kdr_build_def plan_of_words(char text[PLAN_ROW_TEXT], const char *split, const char *axis, const char *share,
                            const char *order) {
    char problem[200];
    kdr_build_def def = kdr_default_build_def();
    snprintf(text, PLAN_ROW_TEXT, "%s %s %s %s", split, axis, share, order);
    if (kdr_build_def_parse(text, &def, problem, sizeof problem) != KDR_OK)
        fail_msg("%s: %s", text, problem);
    return def;
}
