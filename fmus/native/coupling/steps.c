/* A step of the iterated scheme, which ends before an event if there is one. */
#include "base/elementary.h"
#include "constants.h"
#include "coupling/composite.h"

int iterated_go_on(Unit *unit, double step, int met)
{
    Course *course = ((Composite *)unit->own)->course;
    course->clock.length = step;
    if (iterated_accept(unit, step)) {
        return 1;
    }
    if (met) {
        contacts_begin(unit);
        course->event.worst = course->loop.residual;
    }
    return 0;
}

int iterated_step(Unit *unit, double step)
{
    Composite *c = unit->own;
    Course *course = c->course;
    /* a first step, or one behind brief steps, has no past to be predicted from and would cost an order */
    const bool is_far = c->unknowns && signal_is_far(c->forces, step);
    const bool is_first = is_far || course->division.no_past > 0.0;
    const int all = course->loop.corrections < 0.0 || (is_first && course->loop.corrections > 0.0);
    const int passes = all ? MAX_PASSES : (int)course->loop.corrections + 1;
    int met = 0;
    for (;;) {
        course->loop.residual = iterated_attempt(unit, step, passes);
        if (course->loop.residual >= 0.0) {
            break;
        }
        if (contacts_ahead(unit, &step)) {
            return 1;
        }
        if (step == 0.0) {
            return contacts_strike(unit);
        }
        met = 1;
    }
    return iterated_go_on(unit, step, met);
}

int iterated_cross(Unit *unit, double step)
{
    Composite *c = unit->own;
    while (iterated_attempt(unit, step, MAX_PASSES) < 0.0) {
        int struck;
        composite_restore(c);
        if (c->course->loop.ahead < 0.0 || impacts_strike(unit, 2.0 * step, &struck)) {
            return 1;
        }
        if (!struck) {
            return unit_fail(unit, "weights meet, part or stick at the very time %6 s at which an input or the "
                             "drive jumps: move that time by a thousandth of a revolution",
                             unit_host_time(unit, c->course->clock.time));
        }
    }
    return iterated_accept(unit, step);
}
