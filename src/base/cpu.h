/* What the machine can do, and how far the user lets us go. */
#ifndef KDR_BASE_CPU_H
#define KDR_BASE_CPU_H

#include "kdray/kdray.h"

/* The widest instruction set of this machine that kdray was compiled for. */
kdr_isa kdr_cpu_isa(void);

/* Whether kdray can use this set here. Scalar always. */
bool kdr_cpu_has_isa(kdr_isa isa);

/* Lowers it by the limit and by the environment variable KDR_ISA (a name of kdr_isa_name; empty is the same as unset).
 * A limit that the machine lacks is none: it is wider than what is here, or of another kind of machine.
 * False when KDR_ISA is no such name or names a set that the machine lacks; *out is then unchanged. */
bool kdr_cpu_choose_isa(kdr_isa limit, kdr_isa *out);

/* Seconds of a clock that never goes back. */
double kdr_cpu_seconds(void);

#endif
