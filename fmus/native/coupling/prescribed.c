/* Prescribed: the communication points of an earlier run, with others between them.

   The same step as with a tolerance, solved as far, but of given length: two runs that meet at common
   points differ by their errors alone. Signals are held over steps longer than the longest, as there: all
   is at rest. Behind an event the way to the next point is halved: where the event falls into the last part
   of a step of the earlier run, both runs would go on with the same step, and its error would not show. A
   step whose loop cannot be solved is halved: where a support turns round in it so near its end that the
   forces decide whether it does, the acceleration jumps with them. */
#include "base/elementary.h"
#include "constants.h"
#include "coupling/composite.h"

enum { POINT_HALVINGS = 20 };

int prescribed_step(Unit *unit)
{
    Composite *c = unit->own;
    Course *course = c->course;
    Pacing *pacing = &c->pacing;
    double step = pacing->step;
    int measured = 0, met = 0, halved = 0, constant_signals;
    while (pacing->next < pacing->count &&
           pacing->points[pacing->next] <= course->clock.time * (1.0 + TIME_ROUNDING)) {
        pacing->next++;
    }
    if (pacing->next < pacing->count) {
        step = smaller(step, pacing->points[pacing->next] - course->clock.time);
    }
    constant_signals = step > BEYOND_LONGEST_STEP * pacing->longest;
    if (course->event.ended == course->clock.time && course->clock.time > 0.0 && !constant_signals) {
        step *= 0.5;
    }
    for (;;) {
        double residual;
        course->adaptive.constant_signals = constant_signals;
        residual = iterated_attempt(unit, step, MAX_PASSES);
        course->adaptive.constant_signals = 0.0;
        if (residual < 0.0) {
            if (contacts_ahead(unit, &step)) {
                return 1;
            }
            if (step == 0.0) {
                return contacts_strike(unit);
            }
            met = 1;
            continue;
        }
        if (halved == POINT_HALVINGS || residual <= course->loop.tolerance) {
            course->loop.residual = residual;
            course->adaptive.constant_signals = constant_signals;
            return iterated_go_on(unit, step, met);
        }
        composite_restore(c);
        if (measured) {
            step *= 0.5;
            halved++;
            met = 0;
        }
        /* what passes have made of the loop's Jacobian leads nowhere */
        if (iterated_after_start(unit, step)) {
            return 1;
        }
        measured = 1;
    }
}
