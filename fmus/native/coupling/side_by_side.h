/* Machines that go on side by side. */
#ifndef AUTOBALANCER_SIDE_BY_SIDE_H
#define AUTOBALANCER_SIDE_BY_SIDE_H

#include "coupling/batch_run.h"
#include "coupling/composite.h"

/* The next step of a run, for the lanes. */
typedef struct {
    NumberBlock *constants, *state, *results;
    int *shape, order;
    size_t shape_size, times_made; /* the blocks are of the machine that has been made so often */
    double angle;
    bool is_wanted; /* its series is to be expanded */
    bool waits;     /* for others, until their motion is smooth too: it is loaded */
    bool is_alone;  /* the step does not go on in its lane */
} Loaded;

/* The lanes, and which machine each of them holds. */
typedef struct {
    const LaneFunctions *by; /* NULL: there are none */
    Lanes *lanes;
    const BatchRun *holds[LANES];
    size_t times_made[LANES];
} Held;

static inline Machine *machine_of(const BatchRun *run)
{
    return &((Composite *)run->unit->own)->pieces.step;
}

/* Tell which machines go into the lanes; 1 where there are no lanes, or no memory for them. */
int side_by_side_tell(BatchRun *const *runs, Loaded *const *loaded, int count, Held *held, LaneMachine *machines);

/* -- smooth_steps.c, smooth_alone.c ---------------------------------------------------------------- */

/* Let machines that are alike, and whose motion is smooth, stay in their lanes until a step of one of them does not. */
void smooth_steps(BatchRun *const *runs, Loaded *const *loaded, int count, Held *held, const LaneMachine *machines,
                  BatchCall *all);
/* The same of one machine by itself. */
void smooth_steps_alone(BatchRun *run, Loaded *loaded, BatchCall *all);

#endif
