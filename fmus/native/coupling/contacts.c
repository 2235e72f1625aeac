/* Events: a step ends where a unit says that something jumps, so that it holds no jump.

   Weights collide, part, stick or slide; dry supports stick, let go or turn round.  The step before an
   event ends a moment earlier.  Steps so brief that their error is lost in rounding lead up to an impact,
   which lies between two of them (machine_impacts.c), or over any other event; what follows starts
   without a past. */
#include <string.h>

#include "base/elementary.h"
#include "constants.h"
#include "coupling/composite.h"

static const double SOON = 1e-3; /* of a brief step: weights that meet so soon collide now */
static const double JUMP = 1e-6, BRIEF_GROWTH = 10.0, SLOPE_JUMP = 1e-10, AGREED = 1e-6;
/* brief steps without a jump that end an event, those in which one is awaited, and the most of one */
enum { QUIET_STEPS = 3, AWAITED_STEPS = 20, MOST_BRIEF_STEPS = 1000, BRIEF_TRIES = 3 };
enum { MOST_BLOWS = 100 }; /* between two brief steps */
static const double SHORTER[BRIEF_TRIES] = {1.0, 0.6, 0.36};

int contacts_ahead(Unit *unit, double *step)
{
    Composite *c = unit->own;
    const double ahead = c->course->loop.ahead, least = brief_length(unit);
    if (ahead < 0.0) {
        return 1;
    }
    composite_restore(c);
    *step = ahead > 2.0 * least ? ahead - 0.5 * least : 0.0;
    return 0;
}

static size_t loop_bytes(const Composite *c)
{
    const size_t count = (size_t)(UNKNOWN_REALS * c->unknowns);
    return count * count * sizeof(double);
}

void contacts_begin(Unit *unit)
{
    Composite *c = unit->own;
    Course *course = c->course;
    memcpy(c->learned, c->solution, loop_bytes(c));
    course->event.learned_step = course->loop.solved_step;
    course->event.steps_left = AWAITED_STEPS;
    course->event.brief_steps = course->event.worst = 0.0;
    course->event.begun_at = course->clock.time;
}

/* Behind the event: the jump is no error of a prediction. */
static void end_event(Composite *c)
{
    int k;
    for (k = 0; k < c->unknowns; k++) {
        c->forces[k].prediction_error = 0.0;
    }
    for (k = 0; k < c->planes; k++) {
        c->accelerations[k].prediction_error = 0.0;
    }
    composite_drop_past(c);
    c->course->event.ended = c->course->clock.time + c->course->clock.length;
}

static void relearn(Composite *c)
{
    c->course->loop.solved_step = c->course->event.learned_step;
    memcpy(c->solution, c->learned, loop_bytes(c));
}

/* A brief step, not yet accepted: its residual, below 0 where it failed, and its length [s]. */
static double brief(Unit *unit, double *step)
{
    Composite *c = unit->own;
    int k = 0;
    *step = brief_length(unit);
    for (;;) {
        const double residual = iterated_attempt(unit, *step, MAX_PASSES);
        if (residual < 0.0 && c->course->loop.ahead >= SOON * *step) { /* weights meet within it */
            *step = c->course->loop.ahead;
            composite_restore(c);
            continue;
        }
        if ((residual >= 0.0 && residual <= AGREED) || k == BRIEF_TRIES - 1) {
            return residual;
        }
        composite_restore(c);
        relearn(c);
        k++;
        *step = SHORTER[k] * brief_length(unit);
        /* weights that stick answer otherwise than those that slide */
        if (k == BRIEF_TRIES - 1 && iterated_after_start(unit, *step)) {
            return -1.0;
        }
    }
}

int contacts_strike(Unit *unit)
{
    contacts_begin(unit);
    return contacts_step(unit);
}

/* Whether any of like signals jumps in a brief step, and whether its slope does. */
static void find_jumps(const Signal *signals, const Knot *ends, int count, double step, double largest,
                  int *jumped, int *turned)
{
    double left = 0.0, turn = 0.0, grown = 0.0;
    int k;
    for (k = 0; k < count; k++) {
        const Knot now = signals[k].now, end = ends[k];
        const Complex extrapolated = complex_sum(now.value, complex_scaled(step, now.slope));
        left = larger(left, magnitude(complex_difference(end.value, extrapolated)));
        turn = larger(turn, step * magnitude(complex_difference(end.slope, now.slope)));
        grown = larger(grown, step * magnitude(end.slope));
    }
    *jumped |= left > JUMP * larger(largest, BRIEF_GROWTH * grown);
    *turned |= turn > SLOPE_JUMP * largest;
}

/* All impacts within `soon` [s], those that follow from others too: a weight that is struck meets the next. */
static int strike_all(Unit *unit, double soon, int *jumped)
{
    int blow, struck = 1;
    for (blow = 0; struck && blow < MOST_BLOWS; blow++) {
        if (impacts_strike(unit, soon, &struck)) {
            return 1;
        }
        *jumped |= struck;
    }
    return 0;
}

int contacts_step(Unit *unit)
{
    Composite *c = unit->own;
    Course *course = c->course;
    double step, residual, motion = 0.0;
    int k, jumped = 0, turned = 0;
    if (strike_all(unit, SOON * brief_length(unit), &jumped)) {
        return 1;
    }
    residual = brief(unit, &step);
    for (k = 0; k < c->planes; k++) {
        motion = larger(motion, c->accelerations[k].largest);
    }
    find_jumps(c->forces, c->answers, c->unknowns, step, course->loop.largest, &jumped, &turned);
    find_jumps(c->accelerations, c->ends, c->planes, step, motion, &jumped, &turned);
    if (residual < 0.0 || iterated_accept(unit, step)) {
        return 1;
    }
    relearn(c); /* the brief steps have changed the inverse: restore it */
    course->clock.length = step;
    course->event.brief_steps += 1.0;
    /* if passes do not converge, they disagree on whether the event lies inside this step; QUIET_STEPS
       more settle it */
    if (jumped || residual > AGREED) {
        course->event.steps_left = QUIET_STEPS;
    } else {
        course->event.steps_left -= 1.0;
    }
    if (turned) {
        course->event.steps_left = smaller(course->event.steps_left, QUIET_STEPS);
    }
    if (course->event.steps_left == 0.0) {
        end_event(c);
    } else if (course->event.brief_steps > MOST_BRIEF_STEPS) {
        return unit_fail(unit, "weights collide or stick without end at t = %6 s",
                         course->event.begun_at);
    }
    return 0;
}
