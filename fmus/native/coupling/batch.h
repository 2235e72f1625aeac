/* Many runs of a composite, each with values of its own: from memory to memory, in one call.

   Machines in one piece go on side by side, in lanes of the processor's vectors, with the bits that each has
   alone.  A call shares nothing, so that threads may each make one of their own. */
#ifndef AUTOBALANCER_BATCH_H
#define AUTOBALANCER_BATCH_H

#include <stddef.h>

#include "fmi/export.h"

enum { BATCH_REASON = 512 }; /* characters of a reason, the 0 at the end included */

/* What all runs have in common. */
typedef struct {
    size_t changed;              /* variables that are set before a run, */
    const unsigned *references;  /* and which they are */
    size_t asked;                /* outputs that are read at every point, */
    const unsigned *outputs;     /* and which they are */
    size_t asked_last;           /* the same of those that are read at the end alone */
    const unsigned *last_outputs;
    size_t points;               /* times at which outputs are read, besides the start */
    int own_steps;               /* these are the ends of a composite's own steps, as many at most */
    int side_by_side;            /* most machines that go on so; 0: as many as there are lanes */
} Batch;

/* Run so often, to ends [s] (runs,), with values (runs, changed).  signals: (runs, points + 1, asked),
   at times that divide each run evenly, or with own_steps (runs, points + 1, 1 + asked), the time
   first; NaN behind the end, and from where a run has failed.  last: (runs, asked_last), NaN where
   it has.  reasons: (runs, BATCH_REASON), empty for runs that have not.  Returns the number of runs
   that have failed. */
EXPORT size_t autobalancer_runs(const char *token, const Batch *batch, size_t runs,
                                const double *values, const double *ends, double *signals,
                                double *last, char *reasons);

#endif
