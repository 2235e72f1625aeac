/* What the parts show of each other: forces, places, torques, as separate units exchange them. */
#include <string.h>

#include "base/elementary.h"
#include "coupling/composite.h"

void knot_from_start(const Knot *start, Complex *signal)
{
    signal[0] = start->value;
    signal[1] = start->slope;
    signal[2] = signal[3] = complex_of(0.0, 0.0);
}

/* -- forces -------------------------------------------------------------------------------------- */

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

void composite_set_forces(const Unit *unit, const Complex *forces)
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
        Knot seen;
        if (outside_knot(unit, k, &seen)) {
            knot_from_start(&seen, signal);
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

void composite_read_forces(const Composite *c, Knot *answers)
{
    int k;
    for (k = 0; k < c->force_count; k++) {
        answers[k] = knot_of(c->parts[c->members[k]].unit, 0, 1);
    }
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

/* -- torques ------------------------------------------------------------------------------------- */

/* Torque of all units on the shaft, and its slope; 1 with the reason. */
static int read_torque(Unit *unit, double *torque)
{
    const Composite *c = unit->own;
    int k;
    torque[0] = torque[1] = 0.0;
    for (k = 0; k < c->parts_without_motor; k++) {
        const Part *part = c->parts + k;
        if (part->torque >= 0) {
            if (part->unit->equations->observe_torques(part->unit)) {
                return composite_part_failed(unit, part);
            }
            torque[0] += part->unit->real[part->torque];
            torque[1] += part->unit->real[part->torque + 1];
        }
    }
    return 0;
}

int composite_answer_torque(Unit *unit)
{
    const Composite *c = unit->own;
    Unit *motor = c->motor->unit;
    double *input = motor->real + motor->layout.inputs.first;
    memset(input, 0, SIGNAL_ORDERS * sizeof(double));
    if (read_torque(unit, input)) {
        return 1;
    }
    return motor->equations->outputs(motor) && composite_part_failed(unit, c->motor);
}
