/* The largest force of a stop between the ends of a host's step: of the polynomial that has, at both, the force and
   the derivatives of it that the equations of motion give there.

   A step of a host ends at each event, so that the force is smooth in it.  The polynomial is not that force where
   the step is long against the motion.  So it counts only where that of one derivative less has nearly the same top. */
#include "coupling/exchange_stops.h"

#include "base/elementary.h"
#include "base/matrix.h"
#include "coupling/composite.h"
#include "machine/restraints.h"
#include "rotor/first_fall.h"

enum { ORDER_OF_MOTION = FORCE_ORDERS + 1 };
#define SAME_TOP 0.01 /* of the force: two polynomials agree on the largest */

/* In powers of time in steps. */
static void read_force_series(const Machine *m, const MachineStop *stop, double step, double *series)
{
    double power = m->rate * m->rate;
    int k;
    for (k = 0; k < FORCE_ORDERS; k++, power *= step * m->rate) {
        series[k] = stop->series.pressure[k] * power;
    }
}

/* Largest value in the step of the polynomial a(s) + s^c g(s) that has so many derivatives at both ends: a(s) has those of
   the begin, and g(s) is what the end still asks for, over s^c. */
static double largest_between(const double *begin, const double *end, int c)
{
    double polynomial[2 * FORCE_ORDERS], rest[FORCE_ORDERS];
    int k, n;
    copy_doubles((size_t)c, begin, polynomial);
    polynomial_about(begin, c, 1.0, rest);
    for (k = 0; k < c; k++) {
        rest[k] = end[k] - rest[k];
    }
    for (n = 0; n < c; n++) {
        for (k = 1; k < c; k++) {
            rest[k] -= rest[k - 1];
        }
    }
    polynomial_about(rest, c, -1.0, polynomial + c);
    return largest_of_series(polynomial, 2 * c - 1, 1.0);
}

/* Of the most derivatives that are believed; that of none are the forces at the ends. */
static double top_of_force(const double *begin, const double *end)
{
    double top = largest_between(begin, end, FORCE_ORDERS), lower;
    int c;
    for (c = FORCE_ORDERS - 1; c >= 1; c--, top = lower) {
        lower = largest_between(begin, end, c);
        if (absolute(top - lower) <= SAME_TOP * top) {
            break;
        }
    }
    return top;
}

static bool presses(const Composite *c, const double *states, int stop)
{
    const double *stop_states = states + (rotor_stop_states(c->parts->unit) - c->states);
    return stop_states[STOP_DOUBLES * stop + STOP_STATE] == STOP_PRESSES;
}

/* The force of stops that press at one end of the step, and 0 of others. */
static void read_stop_forces(const Composite *c, const double *states, double step, ForceSeries *forces)
{
    const Machine *m = &c->pieces.instant;
    int k;
    for (k = 0; k < composite_rotor(c)->stop_count; k++) {
        if (presses(c, states, k)) {
            read_force_series(m, m->restraints->stops + k, step, forces[k]);
        }
    }
}

int exchange_stops_follow(Unit *unit)
{
    const Composite *c = unit->own;
    const int count = composite_rotor(c)->stop_count;
    const double step = unit->time - c->course->clock.begin;
    double *stop_states = rotor_stop_states(c->parts->unit);
    ForceSeries *begin = c->pieces.stop_forces, *end = begin + count;
    bool pressed = false;
    int k;
    for (k = 0; k < count; k++) {
        pressed |= presses(c, c->at_begin, k) || presses(c, c->states, k);
    }
    if (!pressed || !(step > 0.0)) {
        return 0;
    }
    fill_doubles(2 * (size_t)count * FORCE_ORDERS, 0.0, (double *)begin);
    if (one_piece_expand_begin(unit, ORDER_OF_MOTION)) {
        return 1;
    }
    read_stop_forces(c, c->at_begin, step, begin);
    if (one_piece_expand_instant(unit, ORDER_OF_MOTION)) { /* the last, as others read what it leaves */
        return 1;
    }
    read_stop_forces(c, c->states, step, end);
    for (k = 0; k < count; k++, stop_states += STOP_DOUBLES) {
        const bool both = presses(c, c->at_begin, k) && presses(c, c->states, k);
        const double top = both ? top_of_force(begin[k], end[k]) : larger(begin[k][0], end[k][0]);
        stop_states[STOP_LARGEST] = larger(stop_states[STOP_LARGEST], top);
    }
    return 0;
}
