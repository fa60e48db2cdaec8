/* How far a commit is, told to whom it concerns, and whether it is to go on.
 *
 * Workers tell as they finish subtrees, in shares of the budget of references, which every split divides among its two
 * sides without a rest: so the sum grows to the whole, whatever becomes of the tree. Nobody waits to tell: while one
 * worker does, others go on building. */
#ifndef KDR_BUILD_LISTENER_H
#define KDR_BUILD_LISTENER_H

#include "kdray/kdray.h"

#include <stdatomic.h>

typedef struct kdr_listener {
    kdr_progress_fn *tell;
    void *user;
    double begin, share; /* of the whole commit: where the present build begins, how much it is */
    uint64_t told;       /* by who holds `busy` */
    atomic_flag busy;
    _Atomic bool cancelled;
} kdr_listener;

/* Tells that `part` of the present build, 0 to 1, is done. False: the commit is cancelled. listener NULL: true. */
bool kdr_listener_tell(kdr_listener *listener, double part);

/* Tells that all is done. The same. */
bool kdr_listener_end(kdr_listener *listener);

#endif
