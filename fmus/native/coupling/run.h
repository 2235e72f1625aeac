/* One run of a composite from memory to memory, in as many calls as the caller likes.

   Steps are those of the machine; rows are at equal parts of them, at equal distances, or at points of the caller's.
   A call shares nothing with one of another run. */
#ifndef AUTOBALANCER_RUN_H
#define AUTOBALANCER_RUN_H

#include <stddef.h>

#include "fmi/export.h"

/* How a run goes on from the start on. */
typedef struct {
    double share;         /* of what a step may err; 0: all of it */
    const double *points; /* of rows, ascending [s]; NULL: none.  Kept by the caller */
    size_t count;         /* of the points */
    double grain;         /* of impacts, over the usual one; 0: that */
    const unsigned *references; /* (changed,) of variables that start otherwise, with these values */
    const double *values;
    size_t changed;
} Steps;

/* Rows up to a time. */
typedef struct {
    double begin;   /* where the run is [s] */
    double end;     /* that must be met [s] */
    double step;    /* distance of rows [s]; 0: they are chosen, or at points, */
    double longest; /* and at most so far apart [s] */
    size_t count;   /* of rows at given distances */
    size_t done;    /* of them; written */
    double *events; /* (most,) how many events lie before each row; written, NULL: not wanted */
} Stretch;

/* A run, and what it has done since its start, as the last call has left it. */
typedef struct {
    double time, steps, passes, order; /* passes: series made; order: of the series */
    double collocated;    /* steps by collocation, of a stiff machine */
    double stiff;         /* 1: such steps are tried, or may be later; known from the start */
    const char *reason;   /* why the call failed; empty where it did not */
    const char *warnings; /* of the units, a line each */
} Run;

/* A run of the composite with this text; NULL without memory.  Where the text is refused every start
   is, with the reason. */
EXPORT Run *autobalancer_run_new(const char *token);
EXPORT void autobalancer_run_free(Run *run);
/* From the start values; 0, or 1 with the reason. */
EXPORT int autobalancer_run_start(Run *run, const Steps *steps);
/* At most so many rows (most, 1 + asked): the time and the outputs.  How many were taken; fewer than `most` where the stretch is over or one has failed. */
EXPORT size_t autobalancer_run_on(Run *run, Stretch *stretch, const unsigned *outputs, size_t asked,
                                  size_t most, double *rows);
/* Present values of variables; 0, or 1 with the reason. */
EXPORT int autobalancer_run_read(Run *run, const unsigned *references, size_t count, double *values);

#endif
