/* A scene's units as one: rotor, balancers and motor, whose motion is that of one machine.

   The parts keep parameters, states and outputs; the machine in one piece (one_piece.h) moves them, whatever the
   steps of the host.  All that changes while stepping lies in the unit's `memory`. */
#ifndef AUTOBALANCER_COMPOSITE_H
#define AUTOBALANCER_COMPOSITE_H

#include <stdbool.h>

#include "base/cubic.h"
#include "coupling/one_piece.h"
#include "fmi/unit.h"
#include "units/rotor_unit.h"
#include "units/weights_unit.h"

#define NONE_AHEAD (-1.0) /* no time: times of a course are counted from the start */

enum { VIBRATION = 3, RESIDUAL = 4 }; /* of the outputs from `results` on; the capacity in use is behind */

/* Value and slope of a signal at one point. */
typedef struct {
    Complex value, slope;
} Knot;

/* A unit of the composite; the first is the rotor, the last a motor of limited power if there is one. */
typedef struct {
    Unit *unit;
    int plane;        /* of the rotor, from 0 */
    int force_number; /* number of its force, from 0; -1: its whole effect is its added mass */
    int speed_input;  /* value reference of `speed`, -1 for one that is not told */
    int place;        /* value reference of `x`, -1 for one that is not told its plane's place */
    int torque;       /* value reference of `torque` as output, -1 for one that has none */
    size_t first;     /* value reference of its first parameter in the composite, */
    size_t observed;  /* and of its first output */
} Part;

/* Where the machine stands, in time since the start. */
typedef struct {
    double started;             /* whether it has been started */
    double begin, time, length; /* ends of the last step, and its length [s] */
    double within, shown;       /* whether the parts stand within it, not at its end; and where [s] */
} Clock;

/* Of drive.c and jumps.c: how the rotor turns. */
typedef struct {
    double set_at, speed, acceleration; /* time of the drive [s], and what it was then */
    double fastest;                     /* speed so far, and that of the parameter [rad/s] */
    double first_speed, first_acceleration;
    double pushed_at; /* when forces from outside were told last [s] */
    double next_corner, passed; /* of a profile that the rotor follows by itself: the corner ahead [s],
                                   NONE_AHEAD, and how many are behind */
    double next_change,
        changes_behind; /* of the unbalance: as next_corner, and how many changes are behind */
} DriveSignal;

/* Of the run so far; error: the sum of what its steps may err. */
typedef struct {
    double steps, passes, error;
} Totals;

/* Of verdict.c: vibration in the last complete revolution [m], how far the rotor has turned in this one [rad],
   and whether nothing holds the machine. */
typedef struct {
    double last, turned, drifts;
} Vibration;

/* What changes while stepping, apart from the parts; doubles alone, as the state is. */
typedef struct {
    Clock clock;
    DriveSignal drive;
    Totals total;
    Vibration vibration;
    OnePiece one_piece;
} Course;

/* How a run goes on in place of a host, which leaves all of it 0. */
typedef struct {
    const double *points; /* to stop at, ascending [s]; NULL: none */
    size_t count, next;   /* of the points, and the first of them that is ahead */
} Pacing;

struct Composite {
    Part *parts;
    int part_count, parts_without_motor;
    Part *motor;             /* NULL where the speed is prescribed */
    int force_count;         /* parts that exchange force */
    int *members;            /* (force_count,) which they are */
    /* value references of the coupling's parameters, */
    size_t tolerance, top_speed, limit, rise;
    size_t corner_count;                        /* of time and speed behind the last, */
    size_t changes, change_count;               /* of changes of the unbalance, */
    size_t speed_input, outer;                  /* of speed (no motor) and forces from outside, */
    size_t results;                             /* and of the coupling's outputs */
    Pacing pacing;
    size_t made_with;                           /* changes of the unbalance that the rotor is made with */
    /* in the unit's memory */
    Course *course;
    double *extent;       /* (2 n, 2) least and largest x, y of n stations in this revolution [m], and sums of verdict.c */
    double *outer_forces; /* (4, rotor's planes, 2) value and derivatives as told last [N, N/s, N/s^2, N/s^3] */
    double *states;       /* memories of all parts, one after the other, */
    double *at_begin;     /* and those at the start of the step */
    size_t state_count;
    size_t real_count;    /* of all parts' variables, the rotor's first */
    /* scratch */
    double *saved_reals;  /* (real_count,) */
    Complex *sent;        /* (force_count, 4) signals */
    Knot *answers;        /* (force_count,) */
    double *square;       /* 3 (n, n) for n stations */
    Pieces pieces;        /* of one_piece.c */
};

/* -- composition.c ----------------------------------------------------------------------- */

bool composite_named(const char *token);
/* Parts, layout and start values of a composite; 1 with the reason. */
int composite_build(Unit *unit, const char *token);

/* -- composite.c ----------------------------------------------------------------------------- */

/* Doubles of the unit's memory; where there is one already, pointers are set into it. */
size_t composite_memory(Composite *c, double *memory);

/* -- course.c -------------------------------------------------------------------------------- */

/* Go to a time, over jumps, with the inputs as the host has set them; 1 with the reason. */
int composite_go_to(Unit *unit, double time);
/* Whether the last step ends there or later: within these parts of a step and of a time a point of the host is its end. */
#define REACHED_OF_STEP 1e-10
#define REACHED_OF_TIME 4e-16
static inline bool composite_reaches(const Composite *c, double time)
{
    const Clock *clock = &c->course->clock;
    const double point = REACHED_OF_STEP * clock->length + REACHED_OF_TIME * absolute(time);
    return !(clock->time < time - point);
}
/* 1 with the reason where a step of this length from a time on has taken too many of the machine since so many
   passes, or will at its pace. */
int composite_refuse_many(Unit *unit, double passes, double begin, double length);
/* Whether the steps since so many passes are too few to be refused. */
bool composite_are_few(const Composite *c, double passes);

/* -- drive.c --------------------------------------------------------------------------------- */

/* The drive at the start; 1 with the reason. */
int drive_begin(Unit *unit);
/* Speed that is prescribed for a time [rad/s]. */
double composite_speed(const Composite *c, double time);
/* Of the rotor where the parts stand [rad/s]. */
double composite_speed_now(const Unit *unit);
/* Tell the units speed and acceleration at a time [s]. */
void composite_drive(Unit *unit, double time);
/* Take over speed and forces as the host has set them. */
void drive_take_inputs(Unit *unit);
/* Look out for the next change of the unbalance; 1 with the reason. */
int drive_await_change(Unit *unit);

/* -- jumps.c --------------------------------------------------------------------------------- */

/* Time of the next corner of a profile that the rotor follows by itself, or of the next change of its
   unbalance [s]; infinite where none is ahead. */
double composite_next_jump(const Composite *c);
/* Begin a step there; 1 with the reason. */
int composite_pass_jump(Unit *unit);
/* Begin a step at a time where the parts are, and where something has jumped; 1 with the reason. */
int composite_begin_anew(Unit *unit, double time);
/* Take over inputs and state that the host has set; 1 with the reason where it may not. */
int composite_meet_host(Unit *unit);

/* -- unbalance_changes.c ---------------------------------------------------------------------- */

/* Values of a change of the unbalance: its time is the first. */
enum { CHANGE_NUMBER = 1, CHANGE_AMOUNT, CHANGE_VALUES = 4 };

/* Give a part its parameters. */
void composite_give_parameters(Unit *unit, const Part *part);
/* 0, or 1 with the reason where a change is of no unbalance that the rotor has. */
int composite_refuse_number(Unit *unit, double number);
/* 1 with the reason where a change has already set this unbalance. */
int composite_untunable(Unit *unit, size_t reference);
/* Make the rotor with the unbalance that the changes so far leave, where it is not; 1 with the reason. */
int composite_follow_changes(Unit *unit);

/* -- outside.c ------------------------------------------------------------------------------- */

/* Numbers that say the forces from outside. */
size_t outside_count(const Composite *c);
/* Take them over as the host says them now; whether they are another course than that taken over before. */
void outside_take(const Unit *unit);
bool outside_jumps(const Unit *unit);
/* Derivative of that on a plane, of order 0 to 3, along the fixed axes, so long after it was told. */
Pair outside_derivative(const Composite *c, const double *forces, int plane, int order, double time);
/* Force on a plane and its slope at the unit's time, in axes that turn with it; false where there is none. */
bool outside_knot(const Unit *unit, int plane, Knot *seen);

/* -- course_fields.c ------------------------------------------------------------------------- */

/* Declare the doubles of a composite's state. */
void composite_fields(const Unit *unit, Fields *fields);

/* -- parts.c ----------------------------------------------------------------------------------- */

/* The equations of a part: of the rotor, of weights and of a ring of liquid, NULL where it is none. */
Rotor *composite_rotor(const Composite *c);
Balls *part_balls(const Part *part);
RingUnit *part_ring(const Part *part);
/* Mass that a balancer has the rotor carry, by the port or in its force [kg]. */
double part_added_mass(const Part *part);
/* 1, with a part's reason under its name. */
int composite_part_failed(Unit *unit, const Part *part);
/* Whether weights could meet, or had rolling resistance, with the values that the file was built with. */
bool part_meets_as_built(const Unit *unit, const Part *part);
bool part_sticks_as_built(const Unit *unit, const Part *part);
/* The reason, and 1, where model exchange has no event indicators for what can happen. */
int composite_refuse_events(Unit *unit);
/* Whether an output of a part may be read. */
bool composite_asked(const Unit *unit, const Part *part);

/* -- signals.c ------------------------------------------------------------------------------- */

/* A signal of which value and slope alone are known. */
void knot_from_start(const Knot *start, Complex *signal);
/* Tell a balancer where its plane is, if it follows that. */
void composite_place(const Composite *c, const Part *part);
/* Write the sum of the forces, and those from outside, on the rotor's planes. */
void composite_set_forces(const Unit *unit, const Complex *forces);
void composite_read_forces(const Composite *c, Knot *answers);
/* Let the motor answer the torque of all units; 1 with the reason. */
int composite_answer_torque(Unit *unit);

/* -- verdict.c ------------------------------------------------------------------------- */

size_t verdict_doubles(const Composite *c);
void verdict_begin(Composite *c);
/* Look at the step just taken, at this speed. */
void verdict_follow(Composite *c, double speed, double step);
/* Look at displacements (n pairs) after the rotor has turned so far since the last look [rad]. */
void verdict_look(Composite *c, const double *place, double turned);
double verdict_vibration(const Composite *c);
/* Static unbalance of rotor and weights together [kg m]; the largest share that a balancer uses of what
   its weights can supply. */
void verdict_unbalance(const Composite *c, double *left, double *used);

#endif
