/* One run of a batch: its values set, its points read, its end. */
#ifndef AUTOBALANCER_BATCH_RUN_H
#define AUTOBALANCER_BATCH_RUN_H

#include <stdbool.h>

#include "coupling/batch.h"
#include "fmi/unit.h"
#include "lanes/lanes.h"

/* All runs of a call; those before `next` have been begun. */
typedef struct {
    const Batch *batch;
    size_t runs, next, failed;
    const double *values, *ends;
    double *signals, *last;
    char *reasons;
} BatchCall;

/* The run that a unit is at. */
typedef struct {
    Unit *unit;
    size_t number, reached; /* of the run, and how many of its rows have been written */
    bool is_live;           /* whether it goes on side by side with others */
    double end, passes;     /* of the run [s]; of the coupling up to the last point */
    char *reason;
} BatchRun;

/* A unit for runs; 1 where there is none. */
int batch_run_open(BatchRun *run, const char *token, BatchCall *all);
/* Where the token was refused every run has failed, for the reason of the first. */
void batch_refuse_all(BatchCall *all);
/* Begin the next run that can go on side by side; those before that cannot are run to their ends. */
void batch_run_next(BatchRun *run, BatchCall *all);
/* Read points as far as the motion is known; whether the run goes on. */
bool batch_run_read(BatchRun *run, BatchCall *all);
/* The run has failed, with the unit's reason. */
void batch_run_fail(BatchRun *run, BatchCall *all);

/* The time of a point, and its row. */
double batch_run_point(const BatchRun *run, const BatchCall *all, size_t point);
double *batch_run_row(const BatchRun *run, const BatchCall *all, size_t point);
/* The points that the present step reaches before the next jump, up to MOST_READ, from the first on that has not been
   read; how many. */
int batch_run_points(const BatchRun *run, const BatchCall *all, double jump, double *points);

/* -- side_by_side.c -------------------------------------------------------------------------------- */

/* How many units go on side by side on this processor. */
int side_by_side_most(void);
/* Run all, with as many units. */
void side_by_side_run(BatchRun *runs, int count, BatchCall *all);

#endif
