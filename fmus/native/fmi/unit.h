/* A co-simulation slave whose Reals are one array, indexed by value reference.

   A unit adds its equations in `Equations`, in the order parameters, begin, step, outputs (and
   observe for what is computed only when read).  Everything else is here; FMI's functions are
   thin fronts over it.  Instances share nothing, so that each may have a thread of its own. */
#ifndef AUTOBALANCER_UNIT_H
#define AUTOBALANCER_UNIT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/failure.h"
#include "fmi/fields.h"
#include "fmi/unit_token.h"
#include "fmi/variables.h"

#define TIME_ROUNDING 1e-12 /* of a time or a step: less is no step */

/* As both versions of FMI number them. */
typedef enum { STATUS_OK, STATUS_WARNING, STATUS_DISCARD, STATUS_ERROR, STATUS_FATAL } Status;

/* How stale the outputs are, ascending: torques, which few read and are dear, and what else is
   observed, and what is computed. */
enum { FRESH, WITHOUT_TORQUES, OBSERVED, COMPUTED, BEGINNING };

/* Where in its life an instance is. */
enum { INSTANTIATED = 1, INITIALISING = 2, RUNNING = 4, TERMINATED = 8 };

typedef struct Unit Unit;

/* What a unit supplies.  Functions that return int return 0, or 1 with unit->reason written. */
typedef struct {
    const char *name;
    /* Bytes of what the equations need (`own`) besides `memory`; its doubles, NULL: none. */
    size_t own_size;
    size_t (*memory_size)(const Layout *layout);
    /* Declare what `memory` may hold in a state, see fields.h; NULL where there is none. */
    void (*fields)(const Unit *unit, Fields *fields);
    /* Start values that depend on index and size; then what the equations allocate; or NULL. */
    void (*starts)(const Layout *layout, double *real);
    int (*allocate)(Unit *unit);
    /* Make the physical model from the parameters. */
    int (*parameters)(Unit *unit);
    /* Whether a tunable parameter may be set now, 0, or 1 with the reason; NULL: it may. */
    int (*untunable)(Unit *unit, size_t reference);
    /* Go on with tunable parameters that have changed; NULL: `parameters`. */
    int (*tune)(Unit *unit);
    /* Set `memory` to the initial state. */
    int (*begin)(Unit *unit);
    /* Move `memory` and the computed outputs to the end of the step [s]; one that ends early says
       so in unit->made. */
    int (*step)(Unit *unit, double step);
    /* Compute the outputs from `memory` and the inputs as they are now. */
    int (*outputs)(Unit *unit);
    /* Compute the outputs declared as observed, without torques, */
    int (*observe)(Unit *unit);
    /* and these; NULL where there are none; whether an observed output is one. */
    int (*observe_torques)(Unit *unit);
    bool (*is_torque)(const Unit *unit, size_t reference);
    /* Signals come as value and derivatives: their number, and their first value reference; NULL:
       there are none. */
    size_t (*signals)(const Layout *layout, size_t *first);
    /* How far beside an input outputs are smooth; NULL: see derivatives.c. */
    double (*reach)(const Unit *unit, size_t input);
    /* Time derivative of an output that is no signal; `value`, 0, is left where it is not known;
       NULL: there are none. */
    int (*slope)(Unit *unit, size_t reference, double *value);
    /* Continuous states of model exchange, NULL: none.  Their number behind an angle as in angle.h, which
       comes first where there is one (`turns`), the others being doubles of `memory` behind it; nominal
       values of the first and the second half of these. */
    size_t (*states)(const Layout *layout);
    int turns;
    double nominals[2];
    /* Value of the one Boolean output, from observed outputs; NULL: there is none. */
    int (*verdict)(const Unit *unit);
} Equations;

/* Writes a message for people; `host` is what the front keeps. */
typedef void (*Log)(void *host, const char *instance_name, Status status, const char *message);

enum { REASON_SIZE = 2048, MESSAGE_SIZE = 2560 };

struct Unit {
    const Equations *equations;
    Layout layout;
    char token[TOKEN_SIZE];
    char *name;
    /* Values of all variables, the state of the equations and the Booleans, one block of memory behind the
       other: what changes while the instance lives. */
    double *real, *memory;
    unsigned char *boolean;
    size_t memory_count;
    double *starts; /* what the variables start from, */
    unsigned char *flags; /* and the Booleans */
    double *before; /* `memory` before a step, for one that fails */
    double *change; /* change of the outputs by the inputs, */
    double *beside; /* by one of them, */
    double *kept; /* and what the instance holds while it is found */
    const unsigned *asked; /* outputs that are read, where others need not be computed; else NULL */
    size_t asked_count;
    /* `time` is that since the start, the sum of the steps, with what rounding has left of it: equations
       know no other, so that a run is the same wherever the host's time begins [s] */
    double time, time_left;
    double start, point, stop; /* of the host: its start, the communication point reached, and the end of the
                                  experiment, infinite when not defined [s] */
    double tolerance; /* that the host asks for, where it does; relative */
    double taken_tolerance; /* value of the coupling's that is the tolerance of an experiment; 0: none is */
    bool asks_tolerance;
    double made;               /* length of the last step, less than asked where it ended early [s] */
    size_t first_boolean; /* value reference, as the version of FMI has it */
    bool one_step_per_call;  /* whether a composite's step ends with the first of its own */
    bool may_end_early;      /* whether the host takes a step that ends early */
    bool for_model_exchange; /* whether the instance is for model exchange: the host sets state and
                                time */
    int phase, stale;
    bool frozen; /* whether outputs keep to what they found to stick, for derivatives */
    int warned; /* warnings given, a bit each */
    void *own;
    void *allocated; /* list of all memory */
    Text reason;
    char reason_buffer[REASON_SIZE];
    char message_buffer[MESSAGE_SIZE];
    Log log;
    void *host;
};

extern const Equations COMPOSITE_EQUATIONS;
extern const Equations ROTOR_EQUATIONS, LIQUID_EQUATIONS, RING_EQUATIONS, WEIGHTS_EQUATIONS, MOTOR_EQUATIONS;

/* Zeroed memory that goes with the instance, or NULL. */
void *unit_allocate(Unit *unit, size_t count, size_t size);

/* -- life cycle; NULL is returned, and an error given, after a reason is logged -------------- */

Unit *unit_instantiate(const char *name, const char *token, Log log, void *host);
/* Give a zeroed unit, no composite, all that it needs while it lives, in `allocated`, and the start values
   that follow its token in the text; `rest`: where the text goes on.  1 with the reason when something is
   wrong. */
int unit_build(Unit *unit, const char *name, const char *text, const char **rest);
/* The same of one whose layout, start values and equations are known. */
int unit_build_arrays(Unit *unit, const char *name);
/* Bytes of what changes, from unit->real on. */
size_t unit_values_size(const Unit *unit);
void unit_free(Unit *unit);
/* As new: start values, no state, all of the above kept. */
void unit_reset(Unit *unit);
Status unit_setup(Unit *unit, double start, double stop);
/* The tolerance of the experiment, where one is defined; `function`: that says so. */
Status unit_set_tolerance(Unit *unit, const char *function, int defined, double tolerance);
/* Model exchange: the host goes to a time, later or earlier [s]. */
void unit_go_to(Unit *unit, double point);
/* Check every parameter and start the equations. */
Status unit_exit_initialisation(Unit *unit);
/* One communication step; STATUS_ERROR with the reason logged when it fails: hosts repeat what is
   discarded, some for ever.  After a failure the state is that of before the step. */
Status unit_step(Unit *unit, double time, double step);
/* The error of a call that is wrong by itself, with the reason as in text_format. */
Status unit_refuse(Unit *unit, const char *function, const char *format, ...);

/* -- values ---------------------------------------------------------------------------------- */

/* 0, or 1 with everything that is not allowed in values of these variables; NULL: of the first ones. */
int unit_check(Unit *unit, const unsigned *references, size_t count, const double *values);
Status unit_get_reals(Unit *unit, const unsigned *references, size_t count, double *values);
/* The same of references that are known, whose outputs may be as stale as `unit_level` says: for who
   reads them again and again. */
int unit_level(const Unit *unit, const unsigned *references, size_t count);
Status unit_read(Unit *unit, int level, const unsigned *references, size_t count, double *values);
Status unit_set_reals(Unit *unit, const unsigned *references, size_t count, const double *values);
/* One Boolean, 0 or 1. */
Status unit_get_boolean(Unit *unit, unsigned reference, int *value);
Status unit_set_boolean(Unit *unit, unsigned reference, int value);
/* FMI's own way to an input's and an output's derivatives. */
Status unit_set_derivatives(Unit *unit, const unsigned *references, size_t count,
                            const int *orders, const double *values);
Status unit_get_derivatives(Unit *unit, const unsigned *references, size_t count,
                            const int *orders, double *values);
/* Change of `unknowns` (outputs) for a change `seed` of `knowns`: inputs, before the end of initialisation
   also parameters. */
Status unit_directional(Unit *unit, const unsigned *unknowns, size_t unknown_count,
                        const unsigned *knowns, size_t known_count, const double *seed,
                        double *change);

/* -- for the equations ----------------------------------------------------------------------- */

/* Whether an output is the torque or its slope, where a unit ends with them. */
bool unit_ends_with(const Unit *unit, size_t reference);
/* Bring the outputs up to date so far that `stale` is at most `level`; 0, or 1 with the reason. */
int unit_refresh(Unit *unit, int level);
/* Begin the reason anew and return it. */
Text *unit_reason(Unit *unit);
/* A new reason, as in text_format; returns 1. */
int unit_fail(Unit *unit, const char *format, ...);
/* The same for a failure of the core. */
int unit_failed(Unit *unit, const Failure *failure);
/* The host's time of a time since the start [s]. */
double unit_host_time(const Unit *unit, double time);
/* Log a warning the first time it applies in this instance: `bit` says which; `time` since the start. */
void unit_warn_once(Unit *unit, int bit, double time, const char *words);
/* Log an error with what was attempted and the reason, and return the status. */
Status unit_report(Unit *unit, Status status, const char *what);

#endif
