/* One run of a composite from memory to memory, in as many calls as the caller likes.

   The coupling goes on as harness/master/cosimulation.py has it: communication steps are the
   caller's, given, chosen by a tolerance, or led to prescribed points.  A call shares nothing with
   one of another run. */
#ifndef AUTOBALANCER_RUN_H
#define AUTOBALANCER_RUN_H

#include <stddef.h>

#include "fmi/export.h"

/* How the steps are chosen from the start on. */
typedef struct {
    double share;         /* of the tolerance that one may err; 0: as usual */
    const double *points; /* that they lead to, ascending [s]; NULL: to none.  Kept by the caller */
    size_t count;         /* of the points */
    double residual;      /* of the largest force that may stay in the loop then */
    double grain;         /* of impacts in one piece, over the usual one; 0: that */
} Steps;

/* Communication steps up to a time. */
typedef struct {
    double begin;   /* where the run is [s] */
    double end;     /* that must be met [s] */
    double step;    /* given steps [s]; 0: they are chosen, or prescribed, */
    double longest; /* and at most that long [s] */
    size_t count;   /* of given steps */
    size_t done;    /* of them; written */
} Stretch;

/* A run, and what it has done since its start, as the last call has left it. */
typedef struct {
    double time, steps, passes, unconverged, worst_residual, estimated_error, unresolved;
    double one_piece, order; /* whether the machine goes on in one piece, and the order of its series */
    double collocated;    /* steps by collocation, of a stiff machine */
    double loop_failed;   /* whether the reason is that the loop does not close */
    const char *reason;   /* why the call failed; empty where it did not */
    const char *warnings; /* of the units, a line each */
} Run;

/* A run of the composite with this text; NULL without memory.  Where the text is refused every start
   is, with the reason. */
EXPORT Run *autobalancer_run_new(const char *token);
EXPORT void autobalancer_run_free(Run *run);
/* From the start values; 0, or 1 with the reason. */
EXPORT int autobalancer_run_start(Run *run, const Steps *steps);
/* At most so many communication steps; rows (most, 1 + asked) take the time and the outputs behind
   each.  How many were taken; fewer than `most` where the stretch is over or one has failed. */
EXPORT size_t autobalancer_run_on(Run *run, Stretch *stretch, const unsigned *outputs, size_t asked,
                                  size_t most, double *rows);
/* Present values of variables. */
EXPORT int autobalancer_run_read(Run *run, const unsigned *references, size_t count, double *values);

#endif
