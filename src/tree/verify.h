/* Checks every invariant of a finished tree. Slow and plain: what tests and users trust. */
#ifndef KDR_TREE_VERIFY_H
#define KDR_TREE_VERIFY_H

#include "tree/tree.h"

/* NULL if the tree is right, otherwise a sentence; static storage. Cost: O(references x depth). */
const char *kdr_tree_verify(const kdr_tree *tree);

#endif
