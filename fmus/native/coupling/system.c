#include <string.h>

#include "base/elementary.h"
#include "base/matrix.h"
#include "coupling/composite.h"

/* -- forces and accelerations ---------------------------------------------------------------- */

static void add_signal(const Composite *c, size_t first, int plane, const Complex *signal)
{
    Unit *rotor = c->parts->unit;
    const size_t planes = (size_t)rotor->layout.sizes.planes;
    int k;
    for (k = 0; k < SIGNAL_ORDERS; k++) {
        double *force = rotor->real + first + 2 * (planes * (size_t)k + (size_t)plane);
        force[0] += signal[k].re;
        force[1] += signal[k].im;
    }
}

void composite_set_forces(Unit *unit, const Complex *forces, double step)
{
    const Composite *c = unit->own;
    Unit *rotor = c->parts->unit;
    const int planes = rotor->layout.sizes.planes;
    size_t first;
    const size_t count = rotor->equations->signals(&rotor->layout, &first);
    int k;
    memset(rotor->real + first, 0, SIGNAL_ORDERS * count * sizeof(double));
    for (k = 0; k < c->force_count; k++) {
        add_signal(c, first, c->parts[c->members[k]].plane, forces + SIGNAL_ORDERS * k);
    }
    for (k = 0; k < planes; k++) {
        Complex signal[SIGNAL_ORDERS];
        if (outside_signal(c, k, step, signal)) {
            add_signal(c, first, k, signal);
        }
    }
}

/* The end of the `index`-th of `count` vectors, all values standing before all slopes. */
static Knot knot_of(const Unit *unit, int index, int count)
{
    const double *values = unit->real + unit->layout.computed.first;
    const double *value = values + 2 * index, *slope = values + 2 * (count + index);
    Knot knot;
    knot.value = complex_of(value[0], value[1]);
    knot.slope = complex_of(slope[0], slope[1]);
    return knot;
}

void composite_read_accelerations(const Composite *c, Knot *ends)
{
    const Unit *rotor = c->parts->unit;
    int k;
    for (k = 0; k < c->planes; k++) {
        ends[k] = knot_of(rotor, c->rotor_planes[k], rotor->layout.sizes.planes);
    }
}

void composite_read_forces(const Composite *c, Knot *answers)
{
    int k;
    for (k = 0; k < c->force_count; k++) {
        answers[k] = knot_of(c->parts[c->members[k]].unit, 0, 1);
    }
}

/* -- steps ----------------------------------------------------------------------------------- */

/* Whether a part met an event in the step and went no further. */
static bool ended_early(Composite *c, const Part *part, double step)
{
    if (part->unit->made < step) {
        c->course->loop.ahead = part->unit->made;
        return 1;
    }
    return 0;
}

int composite_rotor_pass(Unit *unit, const Complex *forces, double step)
{
    Composite *c = unit->own;
    c->course->total.passes += 1.0;
    if (c->motor) {
        shaft_tell(unit, forces + SIGNAL_ORDERS * c->force_count, step);
    }
    composite_set_forces(unit, forces, step);
    if (composite_advance(unit, c->parts, step) || ended_early(c, c->parts, step)) {
        return 1;
    }
    composite_read_accelerations(c, c->ends);
    return 0;
}

void composite_place(const Composite *c, const Part *part)
{
    Unit *rotor = c->parts->unit;
    const double *planes;
    if (part->place >= 0) {
        rotor->equations->observe(rotor);
        planes = rotor->real + rotor->layout.observed.first + 1 + 4 * rotor->layout.sizes.stations;
        memcpy(part->unit->real + part->place, planes + 2 * part->plane, 2 * sizeof(double));
    }
}

int composite_balancer_pass(Unit *unit, const Complex *accelerations, double step)
{
    Composite *c = unit->own;
    int k;
    for (k = 0; k < c->force_count; k++) {
        Part *part = c->parts + c->members[k];
        copy_doubles(2 * SIGNAL_ORDERS, &accelerations[SIGNAL_ORDERS * c->member_planes[k]].re,
                     part->unit->real + part->unit->layout.inputs.first);
        composite_place(c, part);
        if (composite_advance(unit, part, step) || ended_early(c, part, step)) {
            return 1;
        }
    }
    composite_read_forces(c, c->answers);
    return c->motor &&
           (shaft_pass(unit, step, c->answers + c->force_count) || ended_early(c, c->motor, step));
}

int composite_follow(Unit *unit, double step)
{
    Composite *c = unit->own;
    int k;
    for (k = 1; k < c->parts_without_motor; k++) {
        Part *part = c->parts + k;
        if (part->force_number < 0) {
            composite_place(c, part);
            if (composite_advance(unit, part, step)) {
                return 1;
            }
        }
    }
    return 0;
}

bool composite_asked(const Unit *unit, const Part *part)
{
    const Layout *layout = &part->unit->layout;
    const size_t count = layout->real_count - layout->computed.first;
    size_t k;
    for (k = 0; k < unit->asked_count && unit->asked; k++) {
        if (unit->asked[k] - part->observed < count ||
            unit->asked[k] - ((const Composite *)unit->own)->results - RESIDUAL < 2) {
            return 1;
        }
    }
    return !unit->asked;
}

int composite_move(Unit *unit, double step)
{
    Composite *c = unit->own;
    int k;
    for (k = 0; k < c->part_count; k++) {
        Part *part = c->parts + k;
        if (k && part != c->motor && !composite_asked(unit, part)) {
            continue; /* the rotor's place and speed may be asked for by others */
        }
        composite_place(c, part);
        if (composite_advance(unit, part, step)) {
            return 1;
        }
    }
    return 0;
}

double composite_speed(const Composite *c, double time)
{
    const DriveSignal *drive = &c->course->drive;
    return drive->speed + (time - drive->set_at) * drive->acceleration;
}

void composite_drive(Unit *unit, double time)
{
    const Composite *c = unit->own;
    int k;
    for (k = 0; k < c->part_count && !c->motor; k++) { /* which has a shaft of its own */
        const Part *part = c->parts + k;
        if (part->speed_input >= 0) {
            double *speed = part->unit->real + part->speed_input;
            speed[0] = composite_speed(c, time);
            speed[1] = c->course->drive.acceleration;
        }
    }
}

/* -- the present signals --------------------------------------------------------------------- */

int composite_accept(Unit *unit, const Knot *accelerations, const Knot *forces, double step)
{
    Composite *c = unit->own;
    int k;
    for (k = 0; k < c->planes; k++) {
        signal_move(c->accelerations + k, accelerations + k, step);
    }
    for (k = 0; k < c->unknowns; k++) {
        const Complex value = forces[k].value;
        if (!is_finite(value.re) || !is_finite(value.im)) {
            Text *reason = unit_reason(unit);
            composite_name_signal(c, k, reason);
            text_format(reason,
                        " is not finite at t = %6 s: the coupling diverged; use smaller steps",
                        unit_host_time(unit, c->course->clock.time + step));
            return 1;
        }
        signal_move(c->forces + k, forces + k, step);
    }
    if (c->motor) {
        shaft_accept(c);
    }
    c->course->division.no_past = 0.0;
    return 0;
}

static void forget(Signal *signal)
{
    knot_from_start(&signal->now, signal->last);
    signal->last_step = 0.0;
}

void composite_drop_past(Composite *c)
{
    int k;
    for (k = 0; k < c->planes; k++) {
        forget(c->accelerations + k);
    }
    for (k = 0; k < c->unknowns; k++) {
        forget(c->forces + k);
    }
    c->course->division.no_past = 1.0;
}
