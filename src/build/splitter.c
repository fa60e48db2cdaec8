/* The table of splitters, and the rules for the axis that they share. */
#include "build/splitter.h"

#include "base/check.h"

const kdr_splitter *kdr_splitter_for(kdr_split_rule rule) {
    static const kdr_splitter *const rows[] = {
        [KDR_SPLIT_BINNED] = &kdr_split_binned,
        [KDR_SPLIT_SPACE] = &kdr_split_space,
        [KDR_SPLIT_OBJECT] = &kdr_split_object,
        [KDR_SPLIT_SWEEP] = &kdr_split_sweep,
    };
    KDR_CHECK((size_t)rule < sizeof rows / sizeof rows[0]);
    return rows[rule];
}

/* Axes by falling extent of the cell, equal ones by number. */
static uint32_t by_extent(const kdr_box *cell, uint32_t sets[3]) {
    double extent[3];
    uint32_t left = 7;
    for (int k = 0; k < 3; k++)
        extent[k] = (double)cell->hi[k] - cell->lo[k];
    for (int i = 0; i < 3; i++) {
        int longest = -1;
        for (int k = 0; k < 3; k++)
            if ((left >> k & 1) && (longest < 0 || extent[k] > extent[longest]))
                longest = k;
        sets[i] = 1u << longest;
        left &= ~sets[i];
    }
    return 3;
}

uint32_t kdr_single_axes(kdr_axis_rule rule, const kdr_box *cell, uint32_t depth, uint32_t sets[3]) {
    if (rule == KDR_AXIS_LONGEST)
        return by_extent(cell, sets);
    for (uint32_t i = 0; i < 3; i++)
        sets[i] = 1u << (depth + i) % 3;
    return 3;
}
