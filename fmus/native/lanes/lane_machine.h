/* What the lanes hold: a machine whose numbers are of several. */
#ifndef AUTOBALANCER_LANE_MACHINE_H
#define AUTOBALANCER_LANE_MACHINE_H

#include "lanes/lanes.h"
#include "machine/machine.h"

struct Lanes {
    Machine machine;
    NumberBlock *constants, *state, *results;
};

#endif
