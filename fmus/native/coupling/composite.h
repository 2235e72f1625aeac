/* The coupled units of a scene as one unit: rotor, balancers and motor under their own coupling.

   Inside, steps follow the scene's coupling, whatever the steps of the host; between their ends the
   units are moved under the signals of the step, so that outputs can be had at any time.  Signals are
   cubics.  All that changes while stepping lies in the unit's `memory`: the units' values and states, the
   signals, and what the scheme remembers. */
#ifndef AUTOBALANCER_COMPOSITE_H
#define AUTOBALANCER_COMPOSITE_H

#include <stdbool.h>

#include "base/cubic.h"
#include "coupling/one_piece.h"
#include "fmi/unit.h"
#include "units/rotor_unit.h"
#include "units/weights_unit.h"

#define NONE_AHEAD (-1.0) /* no time: times of a course are counted from the start */

typedef enum { SCHEME_AUTO, SCHEME_ITERATED } Scheme;

enum { UNTIL_CONVERGED = -1 }; /* corrections */
enum { VIBRATION = 5, RESIDUAL = 6 }; /* of the outputs from `results` on; the capacity in use is behind */
#define MISS_PER_ERROR 120.0 /* of a prediction over a cubic's: (h + h)^2 h^2/24 over h^4/720 */
enum { UNKNOWN_REALS = 4 }; /* of an unknown in the loop's vectors: value, and slope times step */

/* Value and slope of a signal at one point. */
typedef struct {
    Complex value, slope;
} Knot;

/* A coupling signal: its end now, and how it went over the step before. */
typedef struct {
    Knot now;
    Complex last[SIGNAL_ORDERS];
    double last_step;        /* [s] */
    double prediction_error; /* how far the last step ended from the extrapolation of the one before */
    double largest;          /* modulus so far */
} Signal;

/* A unit of the composite; the first is the rotor, the last a motor of limited power if there is one. */
typedef struct {
    Unit *unit;
    int plane;       /* of the rotor, from 0 */
    int force_number; /* number of its force, from 0; -1: its whole effect is its added mass */
    int speed_input;  /* value reference of `speed`, -1 for one that is not told */
    int brief;       /* value reference of `shortest_stopped_step`, -1 for one that never stops */
    int place;       /* value reference of `x`, -1 for one that is not told its plane's place */
    int torque;      /* value reference of `torque` as output, -1 for one that has none */
    size_t first;    /* value reference of its first parameter in the composite, */
    size_t observed; /* and of its first output */
} Part;

/* Of composite.c: where the units stand, in time since the start. */
typedef struct {
    double started;             /* whether forces and accelerations agree yet */
    double begin, time, length; /* ends of the last step, and its length [s] */
    double within, shown;       /* whether the units stand within it, not at its end; and where [s] */
    double jumped;              /* whether an input has jumped since the last step */
} Clock;

/* Of composite.c: how the rotor turns. */
typedef struct {
    double set_at, speed, acceleration; /* time of the drive [s], and what it was then */
    double fastest;                   /* speed so far, and that of the parameter [rad/s] */
    double first_speed, first_acceleration;
    double pushed_at; /* when forces from outside were told last [s] */
    double next_corner, passed; /* of a profile that the rotor follows by itself: the corner ahead [s],
                                   NONE_AHEAD, and how many are behind */
    double steepest;                   /* acceleration of the profile [rad/s^2] */
    double next_change,
        changes_behind; /* of the unbalance: as next_corner, and how many changes are behind */
} DriveSignal;

/* Of motor_shaft.c: the motor. */
typedef struct {
    double spin_scale;                   /* what makes a force of its acceleration [kg m] */
    double speed_reached;                /* in the step that is being tried [rad/s] */
    double torque[2], torque_reached[2]; /* on its shaft and their slopes, now and there */
} ShaftDrive;

/* Of startup.c: the division of a communication step. */
typedef struct {
    double crossing;                   /* whether a negligible step over a jump of an input is next, */
    double negligible;                 /* and its length [s] */
    double length, halvings, piece;    /* communication step, its division, pieces taken */
    double ends;                       /* when the communication step is over [s] */
    double first_step;                 /* whether it is the one at the start */
    double no_past;                    /* no step has been taken since the start or a jump */
} Division;

/* Of iterated.c: forces and accelerations that are to agree. */
typedef struct {
    double gain;        /* of the loop */
    double corrections; /* corrector passes, or UNTIL_CONVERGED */
    double rounding;    /* of forces that cancel [N] */
    double tolerance;   /* residual that counts as converged */
    double largest;     /* force so far, as the scheme knows it */
    double reached;     /* the same with the step that is being tried */
    double residual;    /* of the forces in the last step, relative to it */
    double solved_step; /* the step that the loop's inverse is for [s] */
    double ahead;       /* time to an event in the pass that failed for it, else below 0 [s] */
} Loop;

/* Of contacts.c: brief steps behind an event. */
typedef struct {
    double steps_left, brief_steps; /* brief steps still to take, and taken */
    double begun_at;                /* when the step that holds the event began [s] */
    double worst;                   /* residual of the step before them */
    double ended;                   /* when the last of them ended [s] */
    double learned_step;            /* `solved_step` before them */
} Event;

/* Of adaptive.c: steps that a tolerance chooses. */
typedef struct {
    double allowed, rung;  /* tolerance, 0 for fixed steps; step as 2^(-rung/4) */
    double largest_motion; /* of a plane, so far */
    double rested;         /* steps of this length in which nothing has moved */
    double constant_signals;           /* whether the step holds its signals at the values they end with */
} Adaptation;

/* Of resolution.c: what the steps are judged by. */
typedef struct {
    double slowest; /* rate of the rotor's slowest motion [1/s] */
    double top, mass, pace, reach, most, summed_error, judged_step, blind, decay, turn_decay, renewed;
    double moved, grown, unresolved;
} Resolution;

/* Of the run so far. */
typedef struct {
    double steps, passes, unconverged, worst_left, error; /* worst_left: residual of those */
} Totals;

/* Of verdict.c: half the largest extent of a station in the last complete revolution [m], and how far the
   rotor has turned in this one [rad]. */
typedef struct {
    double last, turned;
} Vibration;

/* What changes while stepping, apart from signals and units; doubles alone, as the state is. */
typedef struct {
    Clock clock;
    DriveSignal drive;
    ShaftDrive shaft;
    Division division;
    Loop loop;
    Event event;
    Adaptation adaptive;
    Resolution resolution;
    Totals total;
    Vibration vibration;
    OnePiece one_piece;
} Course;

/* What the acceleration of a plane moves: speed, place and errors of the last revolution. */
typedef struct {
    Complex speed, place;
    double turned, swung;
} Swung;

/* How a run goes on in place of a host, which leaves all of it 0. */
typedef struct {
    double step;          /* communication step to come, with a tolerance the time to a point to meet [s] */
    double longest;       /* that a tolerance may choose [s] */
    double share;         /* of the tolerance that a step may err */
    const double *points; /* that steps lead to, ascending [s]; NULL: steps are chosen */
    size_t count, next;   /* of the points, and the first of them that is ahead */
} Pacing;

struct Composite {
    Part *parts;
    int part_count, parts_without_motor;
    Part *motor;             /* NULL where the speed is prescribed */
    int force_count, planes; /* numbers of forces, and of planes of the rotor that exchange force */
    int unknowns;          /* what a step assumes: the forces, and a motor's acceleration as one */
    int *members;          /* (force_count,) parts that exchange force */
    int *member_planes;    /* (force_count,) their planes among those that exchange */
    int *rotor_planes;     /* (planes,) which they are of the rotor's */
    Scheme scheme;
    int corrections; /* as given */
    /* value references of the coupling's parameters, */
    size_t tolerance, steps_per_rev, top_speed, limit, rise;
    size_t corner_count;                        /* of time and speed behind the last, */
    size_t changes, change_count;               /* of changes of the unbalance, */
    size_t speed_input, outer;                  /* of speed (no motor) and forces from outside, */
    size_t results;                             /* and of the coupling's outputs */
    Pacing pacing;
    size_t made_with;                           /* changes of the unbalance that the rotor is made with */
    bool loop_failed;                           /* whether the last failure was that of the loop */
    /* in the unit's memory */
    Course *course;
    double *extent;       /* (2 n, 2) least and largest x, y of n stations in this revolution [m] */
    double *outer_forces; /* (4, rotor's planes, 2) value and derivatives as told last [N, N/s, N/s^2, N/s^3] */
    Signal *forces, *accelerations; /* (unknowns,), (planes,) */
    double *learned;  /* (4 e, 4 e) for e unknowns: `solution` before an event */
    double *solution; /* (4 e, 4 e): inverse of 1 - dG/du */
    Swung *swung;     /* (p,) */
    double *states;   /* memories of all parts, one after the other, */
    double *at_begin, *at_end; /* and those at the ends of the last step */
    size_t state_count;
    size_t real_count; /* of all parts' variables, the rotor's first */
    /* scratch */
    double *saved_reals;      /* (real_count,) */
    Complex *sent, *plane_signals; /* (e, 4), (p, 4) signals over a step */
    Knot *ends, *answers;           /* (p,), (e,) */
    double *u, *g_u, *moved, *disturbed_answers, *residual, *du, *old; /* (4 e,) as `pack` makes them */
    double *square, *work;         /* (4 e, 4 e), 2 (4 e, 4 e) */
    double *masses;                /* (rotor's planes,) */
    double *decay;                 /* 2 (4 n, 4 n) for n stations */
    struct Impacts *impacts;       /* of machine_impacts.c */
    Pieces pieces;                 /* of one_piece.c */
};

/* -- composition.c ----------------------------------------------------------------------- */

bool composite_named(const char *token);
/* Parts, layout and start values of a composite; 1 with the reason. */
int composite_build(Unit *unit, const char *token);

/* -- composite.c ----------------------------------------------------------------------------- */

/* Doubles of the unit's memory; where there is one already, pointers are set into it. */
size_t composite_memory(Composite *c, double *memory);
/* One step of the coupling, from its end to the next; 1 with the reason. */
int composite_go_on(Unit *unit);
/* Time of the next corner of a profile that the rotor follows by itself, or of the next change of its
   unbalance [s]; infinite where none is ahead. */
double composite_next_jump(const Composite *c);
/* Begin a step there; 1 with the reason. */
int composite_pass_jump(Unit *unit);
/* Take over inputs and state that the host has set; 1 with the reason where it may not. */
int composite_meet_host(Unit *unit);
/* Go to a time, over jumps, with the inputs as the host has set them; 1 with the reason. */
int composite_go_to(Unit *unit, double time);
/* Whether the last step of the coupling ends there or later. */
bool composite_reaches(const Composite *c, double time);
/* 1 with the reason where a step of this length has taken too many of the coupling since so many passes. */
int composite_refuse_many(Unit *unit, double passes, double length);

/* -- unbalance_changes.c ---------------------------------------------------------------------- */

/* Values of a change of the unbalance: its time is the first. */
enum { CHANGE_NUMBER = 1, CHANGE_AMOUNT, CHANGE_VALUES = 4 };

/* Give a part its parameters, but for the one that the coupling sets itself. */
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
/* Force on a plane over a step, in axes that turn with it; 0 where there is none. */
int outside_signal(const Composite *c, int plane, double step, Complex *signal);

/* -- course_fields.c ------------------------------------------------------------------------- */

/* Declare the doubles of a composite's state. */
void composite_fields(const Unit *unit, Fields *fields);

/* -- communication_step.c ---------------------------------- */

/* The communication step to come, which may take several of the coupling; with a tolerance one that
   is chosen, at most that long [s]; 1 with the reason. */
int composite_run_step(Unit *unit, double step);

/* -- parts.c ----------------------------------------------------------------------------------- */

/* The equations of a part: of the rotor, of weights and of a ring of liquid, NULL where it is none. */
Rotor *composite_rotor(const Composite *c);
Balls *part_balls(const Part *part);
RingUnit *part_ring(const Part *part);
/* Mass that a balancer has the rotor carry, by the port or in its force [kg]. */
double part_added_mass(const Part *part);
/* Add the loop gain to a reason. */
void composite_put_gain(Unit *unit);
/* 1, with a part's reason under its name. */
int composite_part_failed(Unit *unit, const Part *part);
/* Name of a signal: what a step assumes, and behind it the accelerations of the planes. */
void composite_name_signal(const Composite *c, int k, Text *text);
/* Whether weights could meet, or had rolling resistance, with the values that the file was built with. */
bool part_meets_as_built(const Unit *unit, const Part *part);
bool part_sticks_as_built(const Unit *unit, const Part *part);
/* The reason, and 1, where model exchange has no event indicators for what can happen. */
int composite_refuse_events(Unit *unit);
/* One step of a part. */
int composite_advance(Unit *unit, Part *part, double step);

/* -- lengths.c --------------------------------------------------------------------------------- */

/* Length of a step of so many in the fastest revolution [s], and of a communication step. */
double step_of_revolution(const Unit *unit, double steps);
double communication_length(const Unit *unit);
/* A step that is taken in one piece [s]: longer ones end at events. */
double brief_length(const Unit *unit);

/* -- system.c ------------------------------------ */

/* Step the rotor under force signals (e, 4); accelerations of the planes in c->ends. */
int composite_rotor_pass(Unit *unit, const Complex *forces, double step);
/* Step the balancers that exchange force under signals (p, 4); their forces in c->answers. */
int composite_balancer_pass(Unit *unit, const Complex *accelerations, double step);
/* Step the balancers that exchange none, once the others have finished. */
int composite_follow(Unit *unit, double step);
/* Whether an output of a part may be read. */
bool composite_asked(const Unit *unit, const Part *part);
/* Step all units of which that is so from the begin of the last step under the signals they have; for
   a time in it. */
int composite_move(Unit *unit, double step);
/* Tell a balancer where its plane is, if it follows that. */
void composite_place(const Composite *c, const Part *part);
/* Write the sum of the forces, and those from outside, on the rotor's planes. */
void composite_set_forces(Unit *unit, const Complex *forces, double step);
void composite_read_accelerations(const Composite *c, Knot *ends);
void composite_read_forces(const Composite *c, Knot *answers);
/* Speed that is prescribed for a time [rad/s]. */
double composite_speed(const Composite *c, double time);
/* Tell the units speed and acceleration at a time [s]. */
void composite_drive(Unit *unit, double time);
/* Take over the signals of a finished step; 1 with the reason when one is not finite. */
int composite_accept(Unit *unit, const Knot *accelerations, const Knot *forces, double step);
void composite_drop_past(Composite *c);

/* -- motor_shaft.c -------------------------------------- */

/* Take the motor's speed over, and tell it to all units. */
int shaft_begin(Unit *unit);
/* Tell all units how the rotor turns in the step to come: cubic of the acceleration, as a force. */
void shaft_tell(Unit *unit, const Complex *spin, double step);
/* The acceleration that the motor answers with, as a force: without a step; with one, once all
   others have done it. */
int shaft_answer(Unit *unit, Knot *spin);
int shaft_pass(Unit *unit, double step, Knot *spin);
/* Go on from the end of the step last taken. */
void shaft_accept(Composite *c);
/* Begin a step where the units stand; the acceleration there, as a force. */
Knot shaft_stand(Composite *c);
/* Of the rotor where the units stand [rad/s]. */
double shaft_speed(const Composite *c);

/* -- signals.c ---------------------------------- */

/* A signal of which the start alone is known. */
void knot_from_start(const Knot *start, Complex *signal);
/* A signal held at a value. */
void knot_held(const Knot *knot, Complex *signal);
void knot_hermite(const Knot *start, const Knot *end, double step, Complex *signal);
Knot knot_end(const Complex *signal, double step);
void signal_predicted(const Signal *signal, Complex *ahead);

/* Whether the last step is too short to predict this one: the curvature that it has left is rounding. */
bool signal_is_far(const Signal *signal, double step);
void signal_move(Signal *signal, const Knot *end, double step);

/* -- loop.c ---------------------------------------- */

/* What the loop, or a part of it, makes of u; vectors have of every unknown the value, and the slope
   times step. */
typedef int (*Response)(Unit *unit, const double *u, double step, double *answer);
void loop_pack(const Knot *ends, int count, double step, double *u);
void loop_unpack(const double *u, int count, double step, Knot *ends);
double loop_size(const double *u, int count); /* largest modulus of `count` complex numbers */
/* dG/du (rows, 4 e) by differences of size `change`. */
int loop_jacobian(Unit *unit, Response response, const double *u, const double *g_u, double change,
                  int rows, double step, double *matrix);
/* The inverse of 1 - dG/du; 1 with the reason when the loop has gain 1. */
int loop_invert(Unit *unit, const double *jacobian, double step);
void loop_rescale(Composite *c, double step);
void loop_learn(Composite *c, const double *du, const double *old, const double *now);
double loop_gain(Composite *c, const double *jacobian);
/* Bring forces and accelerations into agreement; dG/du in c->square. */
int loop_consistent_start(Unit *unit, double step);
/* Largest modulus of the eigenvalues of a (n, n) matrix, which is overwritten; work: (n, n). */
double spectral_radius(int n, double *matrix, double *work);

/* -- scales.c ------------------------------------ */

double composite_largest_force(const Composite *c);
/* On every plane of the rotor (p,), by the port or in the force [kg]. */
void composite_added_masses(const Composite *c, double *masses);

/* -- resolution.c ---------------------------- */

void resolution_begin(Unit *unit);
/* Look at the step just finished; 1 with the reason where steps are too long for the signals. */
int resolution_check(Unit *unit, double step);

/* -- iterated.c, adaptive.c, prescribed.c ------------------------------------------------------ */

void iterated_begin(Composite *c);
/* From the start on, count as converged what leaves so much of the largest force. */
void iterated_allow(Composite *c, double residual);
/* 1 with the reason where what the step left of the forces cannot be tolerated. */
int iterated_judge(Unit *unit);
/* Go on from the end of what was attempted. */
int iterated_accept(Unit *unit, double step);
/* Back to the begin of the step. */
void composite_restore(Composite *c);
void adaptive_begin(Unit *unit);
/* From the start on, let a step err by this share of the tolerance, its loop by less. */
void adaptive_allow(Composite *c, double share);
/* One accepted step of at most `longest` [s]; its length in course->clock.length. */
int adaptive_step(Unit *unit, double longest);
/* One step to the next of the points that a run prescribes. */
int prescribed_step(Unit *unit);
/* Take the loop's Jacobian from steps of this length, all of them taken back. */
int iterated_after_start(Unit *unit, double step);

/* Take a step with at most so many passes; the residual left, below 0 where it failed. */
double iterated_attempt(Unit *unit, double step, int passes);

/* -- steps.c ----------------------------------------------------------------------------------- */

/* One step, or up to an event within it. */
int iterated_step(Unit *unit, double step);
/* Go on from the end of what was attempted, with its length in course->clock.length; `met`: an event is
   there. */
int iterated_go_on(Unit *unit, double step, int met);
/* A negligible step over a jump of an input. */
int iterated_cross(Unit *unit, double step);

/* -- machine_impacts.c ---------------------------------------------------------------------- */

/* Memory for the impacts of weights; 1 when there is none. */
int impacts_allocate(Unit *unit);
/* Mobility of the planes, once the parameters are known; 1 with the reason. */
int impacts_prepare(Unit *unit);
/* Let all weights that touch, or will within `soon` [s], and the rotor collide, where any approach:
   1 in `struck`.  1 with the reason where that fails. */
int impacts_strike(Unit *unit, double soon, int *struck);

/* -- contacts.c --------------------------------------------------------------------- */

/* After an attempt that failed: 1 unless an event ended it; else the units as before and the
   step [s] that ends before the event, 0: it is here. */
int contacts_ahead(Unit *unit, double *step);
/* The units stand before an event: brief steps follow. */
void contacts_begin(Unit *unit);
/* `contacts_begin` and the first brief step. */
int contacts_strike(Unit *unit);
/* One brief step; its length in course->clock.length. */
int contacts_step(Unit *unit);

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

/* -- startup.c ------------------------------------------------------------------------ */

/* Length of the step to come [s], of the communication step it is part of. */
double startup_length(Unit *unit);
/* What follows the step that was taken; `struck`: behind an event. */
int startup_taken(Unit *unit, int struck);

#endif
