/* The series of several machines side by side, one in each lane of a processor's vectors, and those of the weights of
   one machine.

   lanes.c compiles the recurrence of machine/ once more, with numbers of several machines or weights, and for processors
   with wider vectors (AVX2) another time.  Who calls it has machines of one number each; both are told as doubles. */
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

/* The weights of one machine, all on round races. */
typedef struct {
    const struct LaneFunctions *by;
    int weights;
    int *track_of;               /* (weights,) number of the track; 0 behind, up to a multiple of LANES */
    double *known, *pull, *moved; /* (tracks, 2) of the order to come: MachineTrack, and its acceleration less `known` */
    double *found;               /* x of LANES weights, then y; and so on: directions at the start, or forces */
    void *fours;
} WeightsBeside;

/* What vectors of some kind compute. */
typedef struct LaneFunctions {
    /* Memory for machines of such sizes, as machine_allocate has it; NULL where there is none. */
    Lanes *(*allocate)(Unit *unit, int stations, int weights, int tracks, int lobes);
    /* Expand as machine_expand does, one to LANES machines of one shape. */
    void (*expand)(Lanes *lanes, const LaneMachine *machines, int count, int order);
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
} LaneFunctions;

extern const LaneFunctions lane_functions, wide_functions; /* where HAS_LANES, HAS_WIDE_VECTORS */
/* Those of the widest vectors that this processor has; NULL: there are none. */
const LaneFunctions *lanes_of_processor(void);

#endif
