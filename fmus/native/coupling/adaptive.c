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

/* A step that has been tried, and what it showed. */
typedef struct {
    int rung;         /* of its length */
    double step;      /* [s] */
    double shortened; /* factor by which it is shorter than its rung */
    double residual;  /* of the loop; below 0: a unit could not follow it, or an event came first */
    double error;     /* estimated */
    double largest_motion; /* of a plane, so far */
    int higher, lower;     /* rungs by which the next step may be longer, and must be shorter */
    bool minute;           /* what so short a step misses of a jump moves nothing */
    bool still;            /* nothing moves at its end */
} Trial;

/* Try a step of the present rung, at most `remaining`, without leaving a sliver for the last one.
 */
static Trial try_step(Unit *unit, double longest, double remaining)
{
    Composite *c = unit->own;
    Course *course = c->course;
    Trial trial = {0};
    double chosen;
    trial.rung = (int)course->adaptive.rung;
    chosen = length_of(trial.rung, longest);
    trial.step = chosen >= remaining        ? remaining
                 : chosen > 0.5 * remaining ? 0.5 * remaining
                                            : chosen;
    trial.shortened = chosen / trial.step;
    course->adaptive.constant_signals = trial.rung < 0;
    trial.residual = iterated_attempt(unit, trial.step, MAX_PASSES);
    course->adaptive.constant_signals = 0.0;
    return trial;
}

/* Error of a step whose loop has ended, and the rungs that follow from it. */
static void judge(const Composite *c, double longest, double allowed, Trial *trial)
{
    const bool jumps = composite_rotor(c)->slider_count > 0;
    double ratio;
    trial->error = error_of(c, trial->step, &trial->largest_motion);
    ratio = trial->error > 0.0 ? AIM * allowed / trial->error : infinity();
    trial->minute = jumps && trial->rung >= MINUTE;
    trial->higher = rise(ratio, 1.0 + 1e-9, trial->shortened);
    trial->lower = -rise(ratio, 1.0, trial->shortened);
    trial->still = !jumps && (trial->rung < 0 || trial->rung < trial->higher) &&
                   rests(c, longest, trial->largest_motion);
}

/* Note a step that is good, and choose the rung of the next. */
static void accept(Course *course, const Trial *trial)
{
    Adaptation *adaptive = &course->adaptive;
    double lowest = trial->still ? smaller(trial->rung, 0.0) : 0.0;
    adaptive->rested = trial->still ? adaptive->rested + 1.0 : 0.0;
    if (adaptive->rested == RESTED) {
        adaptive->rested = 0.0;
        lowest -= RUNGS;
    }
    adaptive->rung = larger(lowest, trial->rung - trial->higher);
    if (trial->minute) {
        adaptive->rung = smaller(adaptive->rung, MINUTE);
    } else {
        course->total.error = larger(course->total.error, trial->error);
    }
    course->loop.residual = trial->residual;
    adaptive->constant_signals = trial->rung < 0;
    adaptive->largest_motion = trial->largest_motion;
}

/* Take a step back that diverges so far that a unit cannot follow; 1 with the reason, the unit's.
 */
static int retreat(Unit *unit, const Trial *trial)
{
    Composite *c = unit->own;
    if (trial->rung + 2 * RUNGS > LOWEST) {
        return 1;
    }
    composite_restore(c);
    c->course->adaptive.rung = trial->rung + 2 * RUNGS;
    return iterated_after_start(unit, 0.5 * trial->step);
}

/* Take a step back that errs too much, and choose a lower rung; 1 with the reason. */
static int reject(Unit *unit, const Trial *trial)
{
    Composite *c = unit->own;
    Course *course = c->course;
    composite_restore(c);
    if (trial->residual > SLOWEST * course->loop.tolerance &&
        iterated_after_start(unit, 0.5 * trial->step)) {
        return 1;
    }
    course->adaptive.rung = trial->rung + (trial->lower > 1 ? trial->lower : 1);
    if (trial->rung < 0 && !trial->still) {
        course->adaptive.rung = larger(course->adaptive.rung, 0.0);
        course->adaptive.rested = 0.0;
        composite_drop_past(c);
    }
    if (course->adaptive.rung > LOWEST) {
        c->loop_failed = true;
        return unit_fail(unit,
                         "tolerance %6 cannot be met at t = %6 s: the error of steps of %3 s is "
                         "still %3, loop residual %3",
                         course->adaptive.allowed, unit_host_time(unit, course->clock.time),
                         trial->step, trial->error, trial->residual);
    }
    return 0;
}

int adaptive_step(Unit *unit, double longest)
{
    Composite *c = unit->own;
    Course *course = c->course;
    const Pacing *pacing = &c->pacing;
    const double share = pacing->share > 0.0 ? pacing->share : LOCAL_SHARE;
    const double allowed = share * course->adaptive.allowed;
    /* before an event, or a point that must be met */
    double remaining = pacing->step > 0.0 ? pacing->step : infinity();
    bool event_ahead = false;
    if (course->division.no_past > 0.0) {
        course->adaptive.rung = larger(course->adaptive.rung, 0.0);
    }
    for (;;) {
        Trial trial = try_step(unit, longest, remaining);
        if (trial.residual < 0.0) {
            if (contacts_ahead(unit, &remaining)) {
                if (retreat(unit, &trial)) {
                    return 1;
                }
            } else if (remaining == 0.0) {
                return contacts_strike(unit);
            } else {
                event_ahead = true;
            }
            continue;
        }
        judge(c, longest, allowed, &trial);
        if (((trial.error <= allowed && (trial.still || trial.rung >= 0)) || trial.minute) &&
            trial.residual <= course->loop.tolerance) {
            accept(course, &trial);
            return iterated_go_on(unit, trial.step, event_ahead && trial.step == remaining);
        }
        if (reject(unit, &trial)) {
            return 1;
        }
    }
}
