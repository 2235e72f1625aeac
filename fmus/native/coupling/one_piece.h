/* The machine of a composite in one piece: its motion by series in place of signals that its parts exchange.

   The state stays where it is, in the memories of the parts, as it is at the start of a step; a series of the
   step is a function of that and is made where there is none.  Reading between the ends of a step is an
   evaluation of the series. */
#ifndef AUTOBALANCER_ONE_PIECE_H
#define AUTOBALANCER_ONE_PIECE_H

#include <stdbool.h>

#include "machine/collocation.h"
#include "machine/machine.h"
#include "machine/phase.h"
#include "machine/rings.h"
#include "units/ring_unit.h"

enum { MOST_PATIENCE = 256 }; /* steps by series before collocation is tried again */
enum { SPEED_OF_MOTOR = 2 }; /* of the outputs that its unit computes: behind it all are of its state alone */

enum { MOST_CROWDED = 1000 }; /* steps in a row between events that follow each other too closely */
enum { KEY_NUMBERS = 8 }; /* that say what a series is of, beside forces, phases and states */
enum { MOST_READ = 16 }; /* times at once */
enum { MOST_LOOKS = 4096 }; /* of a step: MOST_TURN has fewer */

/* In a unit's memory; doubles alone. */
typedef struct {
    double order;      /* of its series */
    double fastest;    /* speed at the start, by which the machine is made: its unit of time, whether it is stiff [rad/s] */
    double stands;     /* whether the parts stand at the clock's time, and no step has been begun there */
    double largest;    /* displacement so far [m] */
    double speed, acceleration; /* of the rotor at the start of the step */
    double pushed;     /* how long after forces from outside were told the step begins [s] */
    double changes_behind; /* changes of the unbalance by then */
    double line;       /* of the motor's torque */
    double bearing_line; /* of the table of bearings that change with the speed */
    double placed;     /* whether the parts stand where the clock says they are shown */
    double looks, looked; /* times at which the step is looked at, and how many are behind */
    double event, which; /* what ends the step, and of which weight or slider: EventKind */
    double decided;    /* whether that has been decided since the start, */
    double undecided;  /* whether it is open which weights touch, and what sticks, where the parts stand */
    double leaves;     /* where the speed leaves that at the end of the step: 1 upwards, -1 downwards */
    double collocated; /* length of the step's polynomial by collocation, in the machine's time; 0: it has a series */
    double next_length; /* that the last such step suggests for the next one; 0: none has been taken */
    double collocated_steps; /* so many so far */
    double crowded;    /* steps in a row that are hardly longer than rounding of the time */
    double wait, patience; /* steps by series until collocation is tried again, and how many are waited for */
} OnePiece;

/* What outputs follow from: displacements and angles, the memories of parts, signals besides. */
typedef enum { OUTPUTS_ARE_PLACES, OUTPUTS_OF_STATE, OUTPUTS_OF_SIGNALS } OutputKind;

enum { FORCE_ORDERS = 5 };
typedef double ForceSeries[FORCE_ORDERS]; /* of a stop's force: powers of time from 0 on */

/* A place: its column among the machine's, and its number in the pair. */
typedef struct {
    int column, number;
} Output;

/* What goes with the unit. */
typedef struct {
    Machine step, instant; /* series of the step, and of the present state alone */
    bool is_made;          /* whether both are those of the parameters */
    size_t times_made;     /* how often they have been made */
    bool is_watched;       /* whether somebody reads what looks find, whatever is asked for */
    bool is_begun;         /* whether the step to come has been begun: one_piece_prepare */
    int followers;         /* parts that follow their plane's place */
    int rings;             /* parts that are rings of liquid */
    double share;          /* of the tolerance, as a run has it; 0: all of it */
    double grain;          /* of impacts, as a run has it; 0: the usual one */
    double events;         /* that a run has passed */
    double *phases;        /* in the unit's memory: of every weight the way it slides and its wall */
    double *impact;        /* scratch of impacts */
    struct Phase *step_phase, *instant_phase; /* of both machines, where they are eventful */
    bool is_eventful;      /* weights can touch or stick, or supports stick or have stops */
    double shortest;       /* of pendulums in a field of acceleration, lengths of weights and shaft; infinite: none [m] */
    bool is_stiff;         /* steps by collocation are tried */
    Collocation collocation;
    double *begun_forces;  /* in the unit's memory: from outside, at the start of the step (planes, 2) [N] */
    ForceSeries *stop_forces; /* (2, stops) scratch, of model exchange: at both ends of a step */
    double *looked_at;     /* (n, 2) scratch: displacements */
    Pair *places;          /* (width,) scratch */
    Pair *waves;           /* (2, rings) scratch */
    OutputKind kind;       /* of the outputs that were asked for last, */
    unsigned *planned_outputs; /* which are these, */
    Output *plan;          /* and their places */
    size_t planned, most_planned;
    double *key;           /* what the series is of: KEY_NUMBERS, and what follows them in one_piece_load_step */
    double *before;        /* (state_count,) scratch */
} Pieces;

typedef struct Composite Composite;

int one_piece_allocate(Unit *unit);
/* Make the machine of the parameters where it is not; 1 with the reason. */
int one_piece_make(Unit *unit);
/* From the state in the parts' memories on; 1 with the reason. */
int one_piece_begin(Unit *unit);
/* One step from where the last one ends, or from where the parts stand; 1 with the reason. */
int one_piece_step(Unit *unit);
/* The first part of a step, for who expands machines side by side: its state in the machine, the angle of the
   rotor, and whether it is to be expanded.  one_piece_step is the rest.  1 with the reason. */
int one_piece_prepare(Unit *unit, double *angle, bool *is_wanted);
/* Begin anew where the parts are shown, and something has jumped; 1 with the reason. */
int one_piece_begin_anew(Unit *unit);

/* Whether a step is hardly longer than rounding of the time; how often a step of this length in the machine's time is
   looked at; count a step; whether a station is too fast to be followed [m/s]. */
bool one_piece_is_crowded(const Composite *c);
double one_piece_choose_looks(const Composite *c, double length);
void one_piece_count_step(Unit *unit);
bool one_piece_is_too_fast(const Composite *c, double fastest);
/* Whether steps by collocation are tried, or may be once the shaft whirls far. */
bool one_piece_may_collocate(const Composite *c);

/* -- one_piece_smooth.c --------------------------------------------------------------------------- */

/* Whether what has been prepared is a step of smooth motion at which nobody looks, and only places are asked for: such
   steps may follow each other in lanes. */
bool one_piece_is_smooth(Unit *unit);
/* Take such a step of this length in the machine's time, if nothing ends it up to `until`; whether it has been taken. */
bool one_piece_take_smooth(Unit *unit, double length, double until);
/* Begin the next one; its largest displacement so far and its fastest station there; false: it is none. */
bool one_piece_next_smooth(Unit *unit, double largest, double fastest);
/* The next step is taken alone, from the places and velocities that have been written into the machine where
   `has_moved`. */
void one_piece_leave_smooth(Unit *unit, bool has_moved);

/* -- one_piece_series.c -------------------------------------------------------------------------- */

/* What a step may err. */
double one_piece_step_tolerance(const Unit *unit);
/* Order of the step that is shown. */
int one_piece_order(const Composite *c);
/* Load the state of the present step into its machine, and the angle of the rotor, where there is no series of it;
   make the series.  1 with the reason. */
int one_piece_load_step(Unit *unit, double *angle, bool *is_wanted);
int one_piece_expand(Unit *unit);
/* A step by collocation: from the state of the present step, whose rotor has this angle, solved for a length, its
   error over the tolerance; then in place of the step's series. */
void one_piece_load_collocation(Composite *c, double angle);
double one_piece_solve(const Unit *unit, double length);
void one_piece_write_collocation(Composite *c);
/* Set a machine to a state of the parts at this speed; the rotor's angle.  Set forces from outside,
   so long after they were told [s]. */
double one_piece_load(const Composite *c, Machine *machine, const double *states, double speed, double acceleration);
/* The line of the motor's torque, in the machine's time. */
void one_piece_set_line(Machine *machine, int line);
void one_piece_push(const Composite *c, Machine *machine, const double *forces, double time);

/* -- one_piece_stand.c --------------------------------------------------------------------------- */

/* A time in the step, in the machine's. */
double one_piece_time(const Composite *c, double time);
/* Let the parts stand at a time of the step, in the machine's [1]. */
void one_piece_stand_at(Unit *unit, double time);
/* The same of the rotor's angle and speed alone; of all else, where the machine's state has been loaded. */
void one_piece_stand_smooth(const Composite *c, double time);
void one_piece_stand_as_loaded(const Composite *c);
/* Let the parts stand at the time that is shown; 1 with the reason. */
int one_piece_place(Unit *unit);
/* Displacements of the stations and angles of the weights, two in a pair, at the time that is shown. */
int one_piece_places(Unit *unit, Pair *places);
/* The waves of rings, displacements and velocities (rings,), into the memories of the parts, where the rotor has this
   angle and speed. */
void one_piece_store_waves(const Composite *c, const Pair *waves, const Pair *rates, double angle, double speed);

/* -- one_piece_stiff.c --------------------------------------------------------------------------- */

/* Take a step by collocation in place of the series of this length, where it is worth it; 1 where it was. */
int one_piece_try_collocation(Unit *unit, double *length);

/* -- one_piece_phase.c --------------------------------------------------------------------------- */

/* Of each weight in what a state has of phases. */
enum { PHASE_OF_WEIGHT = 2, SLIP_OF_WEIGHT = 0, SIDE_OF_WEIGHT = 1 };

/* Numbers in a state that say the phase, beside those in the memories of the parts. */
size_t one_piece_phase_doubles(const Composite *c);
/* Memory for a machine's phases; 1 where there is none. */
int one_piece_allocate_phases(Unit *unit);
/* Whether weights can touch or stick, or supports stick, have stops or springs that end. */
bool one_piece_is_eventful(const Composite *c);
/* What does not change of a machine's phases; then that of a state of the parts. */
void one_piece_make_phase(const Composite *c, Machine *machine);
void one_piece_load_phase(const Composite *c, Machine *machine, const double *states);
/* The forces of sliders at a time of a step of this order, in the rotor's memory. */
void one_piece_place_sliders(const Composite *c, int order, double time);
/* The largest force of every stop up to a time of a step, there. */
void one_piece_place_stops(const Composite *c, int order, double time);

/* -- one_piece_events.c -------------------------------------------------------------------------- */

/* Let weights that meet where the parts stand collide, and decide who touches and sticks; 1 with the reason. */
int one_piece_meet(Unit *unit);
/* The first event of the step shortens it. */
void one_piece_find_event(Unit *unit, double *length);
/* A weight, or a slider that slips, has come to rest where the parts stand. */
void one_piece_stop_weight(const Composite *c, int weight);
void one_piece_stop_slider(const Composite *c, int slider);
/* The parts stand at the event that ends the step. */
void one_piece_pass_event(Unit *unit);

/* -- one_piece_watch.c --------------------------------------------------------------------------- */

/* Whether nobody reads what looks at the motion find: in a batch warnings are not heard. */
bool one_piece_is_unwatched(const Unit *unit);
/* Tell the units that follow their plane's place where it is, from (n, 2) displacements; 1 with the reason. */
int one_piece_place_followers(Unit *unit, const double *place, double time);
/* Look at the motion up to a time in the step; 1 with the reason. */
int one_piece_look_on(Unit *unit, double time);
/* Look at it where it is shown and the step is left, between two looks; 1 with the reason. */
int one_piece_look_here(Unit *unit);
/* Show the parts at a time in the step; 1 with the reason. */
int one_piece_show(Unit *unit, double time);

/* -- one_piece_show.c ----------------------------------------------------------------------------- */

/* Expand the state in the parts' memories, in itself and not from its step, in `instant`; 1 with the reason. */
int one_piece_expand_instant(Unit *unit, int order);
/* The same of the state at which the last step of model exchange began. */
int one_piece_expand_begin(Unit *unit, int order);

/* Compute the outputs of the parts that others need: accelerations, forces and torques; 1 with the reason. */
int one_piece_signals(Unit *unit);
/* Derivatives of the states of model exchange, of each part in turn; 1 with the reason. */
int one_piece_rates(Unit *unit, double *rates);

/* -- one_piece_sources.c -------------------------------------------------------------------------- */

/* What the outputs that are asked for follow from; without any it is all. */
OutputKind one_piece_outputs(Unit *unit);
/* Whether they are asked for what the composite finds of the run. */
bool one_piece_asks_results(const Unit *unit);
/* Write places, where nothing else is asked for; 1 with the reason. */
int one_piece_observe_places(Unit *unit);
/* The same at up to MOST_READ times in the step, (count, asked) in the order in which they are asked for. */
void one_piece_read_places(const Composite *c, const double *times, int count, double *values);

#endif
