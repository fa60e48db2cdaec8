/* The statistics of a tree, for people and as JSON. */
#ifndef KDR_APPS_KDRAY_REPORT_H
#define KDR_APPS_KDRAY_REPORT_H

#include "json.h"

#include <kdray/render.h>
#include <stdio.h>

/* References a triangle; 0 without triangles. */
double kdr_tree_duplication(const kdr_tree_stats *tree);

/* Bytes of nodes and leaves a triangle; 0 without triangles. */
double kdr_tree_bytes_per_triangle(const kdr_tree_stats *tree);

/* A line a figure. */
void kdr_report_tree(FILE *file, const kdr_tree_stats *tree);

/* Leaves by depth and by triangles, as bars of at most `columns` columns in all. */
void kdr_report_histograms(FILE *file, const kdr_tree_stats *tree, int columns);

/* The member "plan" of the innermost object: the plan as text, defaults written out. */
void kdr_report_plan_json(kdr_json *json, const kdr_build_def *def);

/* The member "tree" of the innermost object. */
void kdr_report_tree_json(kdr_json *json, const kdr_tree_stats *tree);

#endif
