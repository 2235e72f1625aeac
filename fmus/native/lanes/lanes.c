/* A text of its own: the recurrence of machine/ with numbers of several machines. */
#include "lanes/lane_names.h"

#include "lanes/lanes.h"
#include "machine/allocate.c"
#include "machine/blocks.c"
#include "machine/factors.c"
#include "machine/race_series.c"
#include "machine/series.c"
#include "machine/shaft_series.c"
#include "machine/unknowns.c"
#include "machine/weights_series.c"

struct Lanes {
    Machine machine;
    NumberBlock *constants, *state, *results;
};

Lanes *lanes_allocate(Unit *unit, int stations, int weights, int tracks, int lobes)
{
    Lanes *lanes = unit_allocate(unit, 1, sizeof *lanes);
    const size_t blocks = BLOCKS + BLOCKS_OF_TRACK * (size_t)tracks + BLOCKS_OF_WEIGHT * (size_t)weights;
    int k;
    if (!lanes || machine_allocate(unit, &lanes->machine, stations, weights, tracks, lobes)) {
        return NULL;
    }
    lanes->constants = unit_allocate(unit, blocks, sizeof(NumberBlock));
    lanes->state = unit_allocate(unit, BLOCKS, sizeof(NumberBlock));
    lanes->results = unit_allocate(unit, BLOCKS, sizeof(NumberBlock));
    for (k = 0; k < tracks; k++) {
        lanes->machine.tracks[k].row = unit_allocate(unit, (size_t)stations, sizeof(Number));
        if (!lanes->machine.tracks[k].row) {
            return NULL;
        }
    }
    return lanes->constants && lanes->state && lanes->results ? lanes : NULL;
}

/* Blocks of one machine into its lane. */
static void gather(const NumberBlock *lanes, const NumberBlock *machine, int count, int lane)
{
    for (; count--; lanes++, machine++) {
        double *to = lanes->first + lane;
        size_t k;
        for (k = 0; k < machine->count; k++, to += LANES) {
            *to = machine->first[k];
        }
    }
}

static void scatter(const NumberBlock *lanes, const NumberBlock *machine, int count, int lane)
{
    for (; count--; lanes++, machine++) {
        const double *from = lanes->first + lane;
        size_t k;
        for (k = 0; k < machine->count; k++, from += LANES) {
            machine->first[k] = *from;
        }
    }
}

void lanes_expand(Lanes *lanes, const LaneMachine *machines, int count, int order)
{
    Machine *m = &lanes->machine;
    Number angle = number_of(0.0);
    int lane, constants, states, results;
    machine_reshape(m, machines->shape);
    m->drive.motor = machines->motor;
    constants = machine_constants(m, lanes->constants);
    states = machine_state(m, lanes->state);
    results = machine_results(m, order, lanes->results);
    for (lane = 0; lane < LANES; lane++) {
        const LaneMachine *one = machines + (lane < count ? lane : 0); /* the others go along */
        if (one->is_new || lane >= count) {
            gather(lanes->constants, one->constants, constants, lane);
        }
        gather(lanes->state, one->state, states, lane);
        angle[lane] = one->angle;
    }
    machine_expand(m, angle, order);
    for (lane = 0; lane < count; lane++) {
        scatter(lanes->results, machines[lane].results, results, lane);
    }
}
