/* Many runs of a composite, each with values of its own: from memory to memory, in one call.

   It shares nothing, so that threads may each make a call of their own. */
#ifndef AUTOBALANCER_BATCH_H
#define AUTOBALANCER_BATCH_H

#include <stddef.h>

#include "fmi/export.h"

enum { BATCH_REASON = 512 }; /* characters of a reason, the 0 at the end included */

/* What all runs have in common. */
typedef struct {
    size_t set_count;            /* variables that are set before a run, */
    const unsigned *references;  /* and which they are */
    size_t asked;                /* outputs that are read, */
    const unsigned *outputs;     /* and which they are */
    size_t points;               /* times at which outputs are read, besides the start */
    int at_own_steps; /* these are the ends of a composite's own steps, as many at most */
} Batch;

/* Run so often, to ends [s] (runs,), with values (runs, set_count).  signals: (runs, points + 1,
   asked), at times that divide each run evenly, or with at_own_steps (runs, points + 1, 1 + asked),
   the time first; NaN behind the end, and from where a run has failed.  reasons: (runs,
   BATCH_REASON), empty for runs that have not.  Returns the number of runs that have failed. */
EXPORT size_t autobalancer_runs(const char *token, const Batch *batch, size_t runs,
                                const double *values, const double *ends, double *signals,
                                char *reasons);

#endif
