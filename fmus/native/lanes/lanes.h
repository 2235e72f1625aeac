/* The series of several machines side by side, one in each lane of a processor's vectors, and those of the weights of
   one machine.

   lanes.c compiles the recurrence of machine/ once more, with numbers of several machines or weights, and for processors
   with wider vectors (AVX2) another time.  Who calls it has machines of one number each; both are told as doubles. */
#ifndef AUTOBALANCER_LANES_H
#define AUTOBALANCER_LANES_H

#include <stdbool.h>

#include "fmi/unit.h"
#include "machine/blocks.h"

enum { LANES = 4 };

typedef struct Lanes Lanes;
struct Machine;

/* A machine that goes on beside others. */
typedef struct {
    const int *shape;       /* that of all */
    const void *motor;      /* NULL: the speed is prescribed */
    const NumberBlock *constants, *state, *results; /* of machine/blocks.h */
    double angle;
    int is_new; /* whether constants are others than last time in this lane */
} LaneMachine;

/* The weights of one machine, all on round races. */
typedef struct {
    const struct LaneFunctions *by;
    int weights;
    int *track_of;               /* (weights,) number of the track; behind, up to a multiple of LANES, that of the last */
    double *known, *pull, *moved; /* (tracks, 2) of the order to come: MachineTrack, and its acceleration less `known` */
    double *found;               /* (weights, 2): directions at the start, or forces */
    void *fours;
} WeightsBeside;

/* What vectors of some kind compute. */
typedef struct LaneFunctions {
    /* Several machines; NULL here and up to take_out: those take longer so than one after the other.  Memory for machines of
       such sizes, as machine_allocate has it; NULL where there is none. */
    Lanes *(*allocate)(Unit *unit, int stations, int weights, int tracks, int lobes);
    /* Expand as machine_expand does, one to LANES machines of one shape. */
    void (*expand)(Lanes *lanes, const LaneMachine *machines, int count, int order);
    /* Machines that stay in their lanes for many steps, without motors.  All numbers are (LANES,), times
       in the machines'.  Load their state; */
    int (*load)(Lanes *lanes, const LaneMachine *machines, int count, int order);
    /* expand it at these angles and speeds of the rotors; */
    void (*expand_on)(Lanes *lanes, const double *angles, const double *speeds, int order);
    /* the largest terms of order k: Terms of machine/blocks.h, with the largest displacements so far; */
    void (*find_terms)(const Lanes *lanes, int k, const double *largest, Terms *terms);
    /* the first or second number of a column of the motion at some time; */
    void (*read_place)(const Lanes *lanes, int column, int number, int order, const double *times, double *places);
    /* the state becomes that at the end of a step, with the largest displacement and velocity there; rates: one over the
       units of time [1/s]; */
    void (*go_to_end)(Lanes *lanes, int order, const double *times, const double *rates, double *places, double *speeds);
    /* the state of a lane, as its machine has it. */
    void (*take_out)(const Lanes *lanes, int lane, double *motion, double *velocity);
    /* The sums of a series of x and y, whose coefficients stand `stride` doubles apart, up to an order at some times: as
       series_at of machine/pace.c has them.  Times and sums have memory for `count` rounded up to a multiple of LANES. */
    void (*sum_beside)(const double *series, int stride, int order, const double *times, int count, double *x, double *y);
    /* Directions of LANES angles, as x and y. */
    void (*find_directions)(const double *angles, double *directions);
    /* Memory for so many weights; NULL where there is none. */
    WeightsBeside *(*allocate_beside)(Unit *unit, int weights, int tracks);
    /* series_weight_start: WEIGHT_NUMBERS numbers of each weight, `stride` doubles apart, the angle and the speed of the
       rotor, and those of each weight in it. */
    void (*start_beside)(WeightsBeside *beside, const double *numbers, size_t stride, double angle, double turning,
                         const double *angles, const double *rates);
    /* series_weight_advance and _force, from `known` and speeds on the track; */
    void (*push_beside)(WeightsBeside *beside, int k, const double *speeds, double carried);
    /* series_weight_finish, from `pull` and `moved`: speeds on the track of order k + 1; w' of order k is `gained`. */
    void (*take_beside)(WeightsBeside *beside, int k, double gained, const double *per, double *speeds);
    /* Those of lanes/copies.h. */
    void (*expand_simple)(struct Machine *machine, double angle, int order);
    void (*go_through)(const struct Machine *machine, int order, bool is_beside);
    void (*reach_end)(struct Machine *machine, int order, double time);
} LaneFunctions;

extern const LaneFunctions lane_functions, wide_functions; /* where HAS_LANES, HAS_WIDE_VECTORS */
/* Those of the widest vectors that this processor has; NULL: there are none. */
const LaneFunctions *lanes_of_processor(void);

#endif
