/* Events: a step ends where a unit says that something jumps, so that it holds no jump.

   Weights collide, part, stick or slide; dry supports stick, let go or turn round. The impulse of a
   collision reaches the rotor as a pulse over the two steps after it (pulse.h). The step before an event
   ends a moment earlier; the event and a pulse are taken in steps so brief that their error is lost in
   rounding, and what follows starts without a past. */
#include <string.h>

#include "composite.h"
#include "elementary.h"

static const double BRIEF = 1e-6, WIDE = 1e-4, LEAST = 0.1, ROUNDING = 1e-5, JUMP = 1e-6, GROWTH = 10.0, KINK = 1e-10,
                    AGREED = 1e-6;
enum { QUIET = 3, AWAITED = 20, MOST = 1000, TRIES = 3 };
static const double SHORTER[TRIES] = {1.0, 0.6, 0.36};

double contacts_brief(const Unit *unit)
{
    const double tolerance = unit->real[((const Composite *)unit->own)->tolerance];
    const double share = tolerance > 0.0 ? larger(LEAST, smaller(1.0, tolerance / WIDE)) : 1.0;
    return share * BRIEF * startup_size(unit);
}

int contacts_ahead(Unit *unit, double *step)
{
    Composite *c = unit->own;
    const double ahead = c->course->ahead, least = contacts_brief(unit);
    if (ahead < 0.0) {
        return 1;
    }
    composite_restore(c);
    *step = ahead > 2.0 * least ? ahead - 0.5 * least : 0.0;
    return 0;
}

static size_t loop_bytes(const Composite *c)
{
    const size_t count = (size_t)(c->orders * c->unknowns);
    return count * count * sizeof(double);
}

void contacts_begin(Unit *unit)
{
    Composite *c = unit->own;
    Course *course = c->course;
    int k;
    for (k = 0; k < c->unknowns; k++) {
        c->forces[k].largest_before = c->forces[k].largest;
    }
    for (k = 0; k < c->planes; k++) {
        c->accelerations[k].largest_before = c->accelerations[k].largest;
    }
    memcpy(c->learned, c->solution, loop_bytes(c));
    course->learned_step = course->solved_step;
    course->unpulsed = course->largest;
    course->striking = AWAITED;
    course->strikes = course->worst = course->pulse = 0.0;
    course->met = course->time;
}

static void calm(Signal *signal)
{
    signal->largest = larger(signal->largest_before, magnitude(signal->now.value));
    signal->prediction_error = 0.0;
}

/* Behind the event: nothing of a pulse is to be remembered. */
static void end(Composite *c)
{
    int k;
    for (k = 0; k < c->unknowns; k++) {
        calm(c->forces + k);
    }
    for (k = 0; k < c->planes; k++) {
        calm(c->accelerations + k);
    }
    c->course->largest = c->course->unpulsed;
    composite_drop_past(c);
}

static void relearn(Composite *c)
{
    c->course->solved_step = c->course->learned_step;
    memcpy(c->solution, c->learned, loop_bytes(c));
}

/* A brief step, not yet accepted: its residual, below 0 where it failed, and its length [s]. */
static double brief(Unit *unit, double *step)
{
    Composite *c = unit->own;
    int k;
    for (k = 0;; k++) {
        double residual;
        *step = SHORTER[k] * contacts_brief(unit);
        residual = iterated_attempt(unit, *step);
        if ((residual >= 0.0 && residual <= AGREED) || k == TRIES - 1) {
            return residual;
        }
        composite_restore(c);
        relearn(c);
        /* weights that stick answer otherwise than those that slide */
        if (k == TRIES - 2 && iterated_after_start(unit, SHORTER[TRIES - 1] * contacts_brief(unit))) {
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
static void judge(const Signal *signals, const Knot *ends, int count, double step, double largest,
                  int *jumped, int *turned)
{
    double left = 0.0, turn = 0.0, grown = 0.0;
    int k;
    for (k = 0; k < count; k++) {
        const Knot now = signals[k].now, end = ends[k];
        const Complex led = complex_sum(now.value, complex_scaled(step, now.slope));
        left = larger(left, magnitude(complex_difference(end.value, led)));
        turn = larger(turn, step * magnitude(complex_difference(end.slope, now.slope)));
        grown = larger(grown, step * magnitude(end.slope));
    }
    *jumped |= left > JUMP * larger(largest, GROWTH * grown);
    *turned |= turn > KINK * largest;
}

int contacts_step(Unit *unit)
{
    Composite *c = unit->own;
    Course *course = c->course;
    double step, residual = brief(unit, &step), motion = 0.0;
    int k, jumped = 0, turned = 0;
    for (k = 0; k < c->planes; k++) {
        motion = larger(motion, c->accelerations[k].largest_before);
    }
    judge(c->forces, c->answers, c->unknowns, step, course->unpulsed, &jumped, &turned);
    judge(c->accelerations, c->ends, c->planes, step, motion, &jumped, &turned);
    if (residual < 0.0 || iterated_accept(unit, step)) {
        return 1;
    }
    course->pulse = 0.0;
    for (k = 0; k < c->unknowns; k++) {
        course->pulse = larger(course->pulse, magnitude(c->forces[k].now.value));
    }
    /* a pulse is no measure of what forces may err by, but for its own rounding, nor of how the
       loop answers them */
    course->largest = larger(course->unpulsed, ROUNDING * course->pulse);
    relearn(c);
    course->length = step;
    course->strikes += 1.0;
    /* passes that do not agree disagree on whether the step holds an event; it is soon over */
    if (jumped || residual > AGREED) {
        course->striking = QUIET;
    } else {
        course->striking -= 1.0;
    }
    if (turned) {
        course->striking = smaller(course->striking, QUIET);
    }
    if (course->striking == 0.0) {
        end(c);
    } else if (course->strikes > MOST) {
        text_put(unit_reason(unit), "weights collide or stick without end");
        composite_put_time(&unit->reason, course->met);
        return 1;
    }
    return 0;
}
