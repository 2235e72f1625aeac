/* What a communication step is divided into: at the start, and where an input jumps.

   Weights under heavy drag d are pulled into the rotor's motion within 1/d: a cubic over the whole step
   with the slope of that first instant is wrong by d times the step, while its loop converges. So a step
   without a past is divided into parts that double. Where the rotor's acceleration jumps, the units'
   outputs are still those before the jump, so a negligible part of the step is taken on its own. */
#include "base/elementary.h"
#include "constants.h"
#include "coupling/composite.h"

/* The communication step to come [s]: a run says it, else the parameters do. */
static double communication(const Unit *unit)
{
    const double step = ((const Composite *)unit->own)->pacing.step;
    return step > 0.0 ? step : communication_length(unit);
}

/* How often a step without a past is halved, so that nothing is steep in its first part. */
static int halvings(const Composite *c, double step)
{
    double largest = 0.0, change = 0.0, allowed;
    int k, steep = 0;
    for (k = 0; k < c->unknowns; k++) {
        const Signal *force = c->forces + k;
        largest = larger(largest, larger(magnitude(force->now.value), force->largest));
        change = larger(change, step * magnitude(force->now.slope));
    }
    if (change > STEEP_FORCE_CHANGE * largest && largest > 0.0) {
        for (allowed = FIRST_CHANGE * largest; allowed < change && steep < MOST_HALVINGS; steep++) {
            allowed *= 2.0;
        }
    }
    return steep;
}

static void divide(const Composite *c, Course *course)
{
    course->division.piece = course->division.halvings = 0.0;
    if (course->division.no_past > 0.0 && c->unknowns) {
        course->division.halvings = halvings(c, course->division.length);
    }
}

double startup_length(Unit *unit)
{
    const Composite *c = unit->own;
    Course *course = c->course;
    int parts;
    if (course->clock.jumped > 0.0) {
        const double step = communication(unit);
        course->clock.jumped = 0.0;
        course->division.crossing = 1.0;
        course->division.negligible = smaller(KINK_STEP * step, brief_length(unit));
        course->division.length = step - course->division.negligible;
        course->division.ends = course->clock.time + step;
    }
    if (course->division.crossing > 0.0) {
        return course->division.negligible;
    }
    if (course->division.length == 0.0) {
        course->division.length = communication(unit);
        course->division.ends = course->clock.time + course->division.length;
        course->division.first_step = course->division.no_past;
        divide(c, course);
    }
    parts = (int)course->division.halvings -
            (course->division.piece > 0.0 ? (int)course->division.piece - 1 : 0);
    return scaled_by_power(course->division.length, -parts);
}

int startup_taken(Unit *unit, int struck)
{
    Composite *c = unit->own;
    Course *course = c->course;
    const double length = course->division.length;
    if (course->event.steps_left > 0.0) {
        return 0;
    }
    if (struck && course->adaptive.allowed == 0.0) { /* what is left of the communication step */
        const double left = course->division.ends - course->clock.time;
        course->division.length = left > TIME_ROUNDING * communication_length(unit) ? left : 0.0;
        course->division.first_step = 1.0;
        divide(c, course);
    }
    if (struck) {
        return 0;
    }
    if (course->division.crossing > 0.0) {
        course->division.crossing = 0.0;
        composite_drop_past(c);
        course->division.piece = course->division.halvings = course->division.first_step = 0.0;
        return 0;
    }
    course->division.piece += 1.0;
    if (course->division.piece <= course->division.halvings) {
        return 0;
    }
    course->division.length = 0.0;
    return course->division.first_step > 0.0 && course->division.halvings > 0.0 &&
           iterated_after_start(unit, length);
}
