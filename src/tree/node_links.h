/* Of each node its parent and the box of its cell: an annex for traversals that go up again (SPEC T3). 28 bytes a node.
 * Those of the unused node 1 have no meaning; the root is its own parent. */
#ifndef KDR_TREE_NODE_LINKS_H
#define KDR_TREE_NODE_LINKS_H

#include "tree/tree.h"

/* Makes the links from the nodes. False, and nothing held, when there is no memory. */
bool kdr_tree_add_links(kdr_tree *tree, kdr_bulk *bulk);

#endif
