/* A text of its own: the recurrence of machine/ with numbers of several machines. */
#include "lanes/lane_names.h"

#include "lanes/copies.h"
#include "lanes/lanes.h"
#include "lanes/places_beside.c"
#include "lanes/steps_beside.c"
#include "lanes/weights_beside.c"
#include "machine/allocate.c"
#include "machine/blocks.c"
#include "machine/factors.c"
#include "machine/race_series.c"
#include "machine/series.c"
#include "machine/shaft_series.c"
#include "machine/unknowns.c"
#include "machine/weights_series.c"

/* -- machines -------------------------------------------------------------------------------------------- */

static Lanes *lanes_allocate(Unit *unit, int stations, int weights, int tracks, int lobes)
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

/* Blocks of all lanes at once. */
static void gather_all(const NumberBlock *lanes, const NumberBlock *const *machines, int count)
{
    int number;
    for (number = 0; number < count; number++) {
        const double *a = machines[0][number].first, *b = machines[1][number].first;
        const double *c = machines[2][number].first, *d = machines[3][number].first;
        Number *to = (Number *)lanes[number].first;
        size_t k;
        for (k = 0; k < lanes[number].count; k++) {
            to[k] = (Number){a[k], b[k], c[k], d[k]};
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

typedef double Two __attribute__((vector_size(16), aligned(8)));

/* The first two of four numbers that stand one behind the other of two machines. */
static inline void scatter_two(const double *from, double *one, double *other)
{
    const Two a = *(const Two *)from, b = *(const Two *)(from + LANES);
    *(Two *)one = __builtin_shufflevector(a, b, 0, 2);
    *(Two *)other = __builtin_shufflevector(a, b, 1, 3);
}

/* The same of all lanes together. */
static void scatter_all(const NumberBlock *lanes, const LaneMachine *machines, int count)
{
    int number;
    for (number = 0; number < count; number++) {
        const double *from = lanes[number].first;
        const size_t numbers = lanes[number].count;
        double *const to[LANES] = {machines[0].results[number].first, machines[1].results[number].first,
                                   machines[2].results[number].first, machines[3].results[number].first};
        size_t k;
        for (k = 0; k + 1 < numbers; k += 2, from += 2 * LANES) {
            scatter_two(from, to[0] + k, to[1] + k);
            scatter_two(from + 2, to[2] + k, to[3] + k);
        }
        for (; k < numbers; k++, from += LANES) {
            to[0][k] = from[0];
            to[1][k] = from[1];
            to[2][k] = from[2];
            to[3][k] = from[3];
        }
    }
}

/* The machines into the lanes; how many blocks come out of them. */
static int load_lanes(Lanes *lanes, const LaneMachine *machines, int count, int order)
{
    Machine *m = &lanes->machine;
    const NumberBlock *state[LANES];
    int lane, constants, states;
    machine_reshape(m, machines->shape);
    m->drive.motor = machines->motor;
    constants = machine_constants(m, lanes->constants);
    states = machine_state(m, lanes->state);
    for (lane = 0; lane < LANES; lane++) {
        const LaneMachine *one = machines + (lane < count ? lane : 0); /* the others go along */
        if (one->is_new || lane >= count) {
            gather(lanes->constants, one->constants, constants, lane);
        }
        state[lane] = one->state;
    }
    gather_all(lanes->state, state, states);
    return machine_results(m, order, lanes->results);
}

static void lanes_expand(Lanes *lanes, const LaneMachine *machines, int count, int order)
{
    const int results = load_lanes(lanes, machines, count, order);
    Number angle;
    int lane;
    for (lane = 0; lane < LANES; lane++) {
        angle[lane] = machines[lane < count ? lane : 0].angle;
    }
    machine_expand(&lanes->machine, angle, order);
    if (count == LANES) {
        scatter_all(lanes->results, machines, results);
        return;
    }
    for (lane = 0; lane < count; lane++) {
        scatter(lanes->results, machines[lane].results, results, lane);
    }
}

/* Narrow vectors of x86-64 take longer for four machines than these take one after the other. */
#if defined(HAS_WIDE_VECTORS) && !defined(WIDE_VECTORS)
#define OF_MACHINES NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL
#else
#define OF_MACHINES lanes_allocate, lanes_expand, load_lanes, expand_on, find_terms, read_place, go_to_end, take_out
#endif

const LaneFunctions LANE_NAME(functions) = {
    OF_MACHINES,   sum_beside,  find_directions_beside, allocate_beside,   start_beside,
    push_beside,   take_beside, copies_expand_simple,   copies_go_through, copies_reach_end,
};
