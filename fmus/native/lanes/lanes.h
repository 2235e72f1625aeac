/* The series of several machines side by side, one in each lane of a processor's vectors.

   lanes.c compiles the recurrence of machine/ once more, with numbers of several machines.  Who calls it has
   machines of one number each; both are told as blocks of doubles. */
#ifndef AUTOBALANCER_LANES_H
#define AUTOBALANCER_LANES_H

#include "fmi/unit.h"
#include "machine/blocks.h"

enum { LANES = 4 };

typedef struct Lanes Lanes;

/* A machine that goes on beside others. */
typedef struct {
    const int *shape;       /* that of all */
    const void *motor;      /* NULL: the speed is prescribed */
    const NumberBlock *constants, *state, *results; /* of machine/blocks.h */
    double angle;
    int is_new; /* whether constants are others than last time in this lane */
} LaneMachine;

/* Memory for machines of such sizes, as machine_allocate has it; NULL where there is none. */
Lanes *lanes_allocate(Unit *unit, int stations, int weights, int tracks, int lobes);
/* Expand as machine_expand does, one to LANES machines of one shape. */
void lanes_expand(Lanes *lanes, const LaneMachine *machines, int count, int order);

#endif
