/* Tolerance-driven steps: the iterated scheme with step size and passes set by an error estimate.

   What limits the accuracy is the cubic that stands for a signal within a step. The cubic of the step
   before, extrapolated to the end of this one, misses the converged signal by (h + h0)^2 h^2 f''''/24,
   and the cubic of this step misses it by h^4 f''''/720 on average; so

       error = |converged - predicted| h^2 / (30 (h + h0)^2).

   Both signals belong to a loop that has converged, so the estimate holds with direct feedthrough, where
   comparing one step with two halves does not (Schierz, Arnold, Clauss 2012).

   The estimate compares ends alone and cannot see a vibration that turns whole times in a step. So steps
   are no longer than `longest`, which follows every revolution, until all rests in the rotor: until at the
   end of a step no acceleration, no slope of one and no change of a force is left that counts. After
   RESTED such steps of one length the next is twice as long, so that none is longer than a quarter of the
   time that rest has lasted: what is not stable grows meanwhile. Steps longer than `longest` hold the
   signals at their end values, order 1: cubics would amplify what they do not resolve. One that ends in
   motion is taken back, and what follows is at most `longest`. */
#include "base/elementary.h"
#include "constants.h"
#include "coupling/composite.h"

static const double LOCAL_SHARE = 0.2, AIM = 0.5, SLOWEST = 1e3;
static const double MOST_RISE = 16.0; /* of an error: four rungs */
enum { RUNGS = 4, FIRST_RUNG = 24, MINUTE = 80, LOWEST = 160, HOPELESS = 40, RESTED = 4 };

/* 2^(-k/4) */
static const double ROOTS[RUNGS] = {1.0, 0.8408964152537145, 0.7071067811865476, 0.5946035575013605};

void adaptive_begin(Unit *unit)
{
    Course *course = ((Composite *)unit->own)->course;
    course->loop.corrections = UNTIL_CONVERGED;
    course->adaptive.rung = FIRST_RUNG;
    adaptive_allow(unit->own, LOCAL_SHARE);
}

void adaptive_allow(Composite *c, double share)
{
    Course *course = c->course;
    const double allowed = RESIDUAL_SHARE * course->adaptive.allowed;
    /* whatever a step may err, forces that cancel are not told from rounding */
    iterated_allow(c, smaller(share, LOCAL_SHARE) * allowed);
    course->loop.tolerance = larger(course->loop.tolerance, share * allowed);
    course->adaptive.largest_motion = course->loop.largest / course->resolution.mass;
}

/* Part of a prediction's miss that is error of the step's own signal. */
static double share_of_miss(double step, double last_step)
{
    const double sum = step + last_step;
    return 4.0 * (step * step) / (MISS_PER_ERROR * (sum * sum));
}

/* Largest error of signals over a step that ends so, relative to `scale`. */
static double worst(const Signal *signals, const Knot *ends, int count, double step, double scale)
{
    double largest = 0.0;
    int k;
    for (k = 0; k < count; k++) {
        const double share = share_of_miss(step, signals[k].last_step);
        Complex ahead[SIGNAL_ORDERS], extrapolated;
        signal_predicted(signals + k, ahead);
        extrapolated = knot_end(ahead, step).value;
        largest = larger(largest, share * magnitude(complex_difference(ends[k].value, extrapolated)));
    }
    return scale > 0.0 ? largest / scale : 0.0;
}

static double error_of(const Composite *c, double step, double *largest_motion)
{
    const Course *course = c->course;
    int k;
    double scale;
    *largest_motion = course->adaptive.largest_motion;
    for (k = 0; k < c->planes; k++) {
        *largest_motion = larger(*largest_motion, magnitude(c->ends[k].value));
    }
    scale = *largest_motion;
    if (c->motor) { /* what the loop may leave of the shaft's force can move the rotor more than it moves */
        scale = larger(scale, course->loop.tolerance * course->loop.reached /
                                  (AIM * course->adaptive.allowed * course->resolution.mass));
    }
    return larger(larger(1.0, course->loop.gain) *
                      worst(c->forces, c->answers, c->unknowns, step, course->loop.reached),
                  worst(c->accelerations, c->ends, c->planes, step, scale));
}

/* Whole number of rungs up that an error of this ratio to the one aimed at allows, in ratio^(1/4); `slack`
   as a factor.  `shortened`: by how much the step was shorter than its rung. */
static int rise(double ratio, double slack, double shortened)
{
    const double square = shortened * shortened;
    const double left = smaller(slack * ratio, MOST_RISE) / (square * square);
    return left > 0.0 ? binary_exponent(left) - 1 : -HOPELESS;
}

/* Whether nothing moves in the rotor at the end of a step. */
static bool rests(const Composite *c, double longest, double largest_motion)
{
    const Course *course = c->course;
    const double still = LOCAL_SHARE * course->adaptive.allowed, force = still * course->loop.reached;
    const double slowness = smaller(1.0, course->resolution.slowest / course->resolution.top);
    const double motion = still * slowness * slowness * largest_motion;
    const double cancelled = larger(1.0, course->loop.gain);
    int k, moves = 0;
    for (k = 0; k < c->planes; k++) {
        const Knot *end = c->ends + k;
        moves |= !(larger(magnitude(end->value), longest * magnitude(end->slope)) < motion);
    }
    for (k = 0; k < c->unknowns; k++) {
        const Knot *end = c->answers + k;
        const double change = magnitude(complex_difference(end->value, c->forces[k].now.value));
        moves |= !(cancelled * larger(change, longest * magnitude(end->slope)) < force);
    }
    return !moves;
}

/* The length that a rung stands for [s]; below 0 it is longer than `longest`. */
static double length_of(int rung, double longest)
{
    const int powers = rung < 0 ? -((RUNGS - 1 - rung) / RUNGS) : rung / RUNGS;
    return scaled_by_power(longest * ROOTS[rung - RUNGS * powers], -powers);
}

static int refuse_step(Unit *unit, double step, double error, double residual)
{
    Composite *c = unit->own;
    c->loop_failed = true;
    return unit_fail(unit, "tolerance %6 cannot be met at t = %6 s: the error of steps of %3 s is "
                     "still %3, loop residual %3", c->course->adaptive.allowed,
                     unit_host_time(unit, c->course->clock.time), step, error, residual);
}

int adaptive_step(Unit *unit, double longest)
{
    Composite *c = unit->own;
    const int jumps = composite_rotor(c)->slider_count > 0;
    Course *course = c->course;
    const Pacing *pacing = &c->pacing;
    const double allowed = (pacing->share > 0.0 ? pacing->share : LOCAL_SHARE) * course->adaptive.allowed;
    /* before an event, or a point that must be met */
    double remaining = pacing->step > 0.0 ? pacing->step : infinity();
    int met = 0;
    if (course->division.no_past > 0.0) {
        course->adaptive.rung = larger(course->adaptive.rung, 0.0);
    }
    for (;;) {
        const int rung = (int)course->adaptive.rung;
        const double own = length_of(rung, longest);
        /* do not leave a sliver for the last step */
        const double step = own >= remaining ? remaining : own > 0.5 * remaining ? 0.5 * remaining : own;
        double residual, error, ratio, largest_motion, shortened = own / step;
        int lower, higher, minute, still;
        course->adaptive.constant_signals = rung < 0;
        residual = iterated_attempt(unit, step, MAX_PASSES);
        course->adaptive.constant_signals = 0.0;
        if (residual < 0.0 && contacts_ahead(unit, &remaining)) {
            /* a unit cannot follow a loop that diverges */
            if (rung + 2 * RUNGS > LOWEST) {
                return 1;
            }
            composite_restore(c);
            if (iterated_after_start(unit, 0.5 * step)) {
                return 1;
            }
            course->adaptive.rung = rung + 2 * RUNGS;
            continue;
        }
        if (residual < 0.0) {
            met = 1;
            if (remaining == 0.0) {
                return contacts_strike(unit);
            }
            continue;
        }
        error = error_of(c, step, &largest_motion);
        ratio = error > 0.0 ? AIM * allowed / error : infinity();
        minute = jumps && rung >= MINUTE; /* what such a step misses of a jump moves nothing */
        higher = rise(ratio, 1.0 + 1e-9, shortened);
        still = !jumps && (rung < 0 || rung < higher) && rests(c, longest, largest_motion);
        if (((error <= allowed && (still || rung >= 0)) || minute) && residual <= course->loop.tolerance) {
            double lowest = still ? smaller(rung, 0.0) : 0.0;
            course->adaptive.rested = still ? course->adaptive.rested + 1.0 : 0.0;
            if (course->adaptive.rested == RESTED) {
                course->adaptive.rested = 0.0;
                lowest -= RUNGS;
            }
            course->adaptive.rung = larger(lowest, rung - higher);
            if (minute) {
                course->adaptive.rung = smaller(course->adaptive.rung, MINUTE);
            } else {
                course->total.error = larger(course->total.error, error);
            }
            course->loop.residual = residual;
            course->adaptive.constant_signals = rung < 0;
            course->adaptive.largest_motion = largest_motion;
            return iterated_go_on(unit, step, met && step == remaining);
        }
        composite_restore(c);
        if (residual > SLOWEST * course->loop.tolerance && iterated_after_start(unit, 0.5 * step)) {
            return 1;
        }
        lower = -rise(ratio, 1.0, shortened);
        course->adaptive.rung = rung + (lower > 1 ? lower : 1);
        if (rung < 0 && !still) {
            course->adaptive.rung = larger(course->adaptive.rung, 0.0);
            course->adaptive.rested = 0.0;
            composite_drop_past(c);
        }
        if (course->adaptive.rung > LOWEST) {
            return refuse_step(unit, step, error, residual);
        }
    }
}
