/* Forces of a rotor's supports, and of the feet of bodies that carry it, on what they stand on. */
#include "base/elementary.h"
#include "base/matrix.h"
#include "units/rotor_unit.h"

/* Behind the tables of bearings: which of them a force is of, then its rows. */
enum { OF_BEARING, PER_FORCE };

/* Springs and dampers along x and y, four numbers, at a station. */
static void set_straight(Rotor *own, int force, int station, const double *values)
{
    double *row = own->force_rows + (force * own->stations + station) * BEARING_NUMBERS;
    row[0] = values[0];
    row[3] = values[1];
    row[4] = values[2];
    row[7] = values[3];
}

int rotor_whole_parameter(Unit *unit, size_t reference, int most)
{
    const double value = unit->real[reference];
    if (!(value >= 0.0 && value <= (double)most) || value != (double)(int)value) {
        Text *reason = unit_reason(unit);
        layout_shown(&unit->layout, reference, value, reason);
        text_format(reason, ": must be a whole number, 0 to %u", (unsigned long)most);
        return -1;
    }
    return (int)value;
}

static int set_given(Unit *unit)
{
    Rotor *own = unit->own;
    const size_t first = layout_index(&unit->layout, "force[#].table", 1);
    int k;
    for (k = 0; k < own->force_count; k++) {
        const size_t at = first + PER_FORCE * (size_t)k;
        const int table = rotor_whole_parameter(unit, at + OF_BEARING, own->rotor.bearings.count);
        if (table < 0) {
            return 1;
        }
        own->forces[k].bearing = table - 1;
    }
    copy_doubles((size_t)(own->force_count * own->stations * BEARING_NUMBERS),
                 unit->real + first + PER_FORCE * own->force_count, own->force_rows);
    return 0;
}

int rotor_set_forces(Unit *unit)
{
    Rotor *own = unit->own;
    int k;
    fill_doubles((size_t)(own->force_count * own->stations * BEARING_NUMBERS), 0.0, own->force_rows);
    for (k = 0; k < own->force_count; k++) {
        own->forces[k].bearing = -1;
    }
    if (own->kind == MATRICES) {
        return own->force_count ? set_given(unit) : 0;
    }
    for (k = 0; k < own->force_count; k++) {
        if (own->kind == PLANAR) {
            set_straight(own, k, 0, unit->real + 1);
        } else {
            const size_t at = layout_index(&unit->layout, "support[#].stiffness_x", k + 1);
            set_straight(own, k, own->kind == FLEXIBLE ? own->support_stations[k] : k, unit->real + at);
        }
    }
    return 0;
}

/* Add the force of a bearing whose numbers change with the speed. */
static void add_force_over_speed(const Rotor *own, int bearing, double speed, const double *motion, double *force)
{
    const int n = own->stations, line = linear_rotor_line(&own->rotor, speed, -1);
    const double *row = own->rotor.bearings.rows + bearing * n;
    double still[BEARING_NUMBERS], slope[BEARING_NUMBERS], across[4];
    int k;
    linear_rotor_bearing(&own->rotor, bearing, line, still, slope);
    combine_vectors(row, 1, n, motion, across);
    combine_vectors(row, 1, n, motion + 2 * n, across + 2);
    for (k = 0; k < BEARING_NUMBERS; k++) { /* stiffness, then damping: xx, xy, yx, yy */
        force[k / 2 % 2] += (still[k] + slope[k] * speed) * across[k / 4 * 2 + k % 2];
    }
}

/* Add the forces of cubic springs and stops at a support or foot, from 1. */
static void add_restrained(const Unit *unit, int number, double *force)
{
    const Rotor *own = unit->own;
    const double *motion = unit->memory + MOTION;
    double across[2], rate[2], by[2];
    int k;
    for (k = 0; k < own->cubic_count; k++) {
        if (own->cubics[k].support == number) {
            restraint_displacement(own->cubics[k].rows, own->stations, motion, across);
            cubic_force(own->cubics + k, across, by);
            force[0] -= by[0];
            force[1] -= by[1];
        }
    }
    for (k = 0; k < own->stop_count; k++) {
        if (own->stops[k].support == number) {
            restraint_displacement(own->stops[k].rows, own->stations, motion, across);
            restraint_displacement(own->stops[k].rows, own->stations, motion + 2 * own->stations, rate);
            stop_force(own->stops + k, (int)rotor_stop_states(unit)[STOP_DOUBLES * k + STOP_STATE], across, rate, by);
            force[0] -= by[0];
            force[1] -= by[1];
        }
    }
}

void rotor_observe_forces(const Unit *unit, double *out)
{
    const Rotor *own = unit->own;
    const double *motion = unit->memory + MOTION, speed = motion[4 * own->stations];
    const double *row = own->force_rows;
    int f, j, k;
    for (f = 0; f < own->force_count; f++, out += 2) {
        const Force *force = own->forces + f;
        out[0] = out[1] = 0.0;
        for (j = 0; j < own->stations; j++, row += BEARING_NUMBERS) {
            const double *displacement = motion + 2 * j, *velocity = displacement + 2 * own->stations;
            out[0] += row[0] * displacement[0] + row[1] * displacement[1] + row[4] * velocity[0] + row[5] * velocity[1];
            out[1] += row[2] * displacement[0] + row[3] * displacement[1] + row[6] * velocity[0] + row[7] * velocity[1];
        }
        if (force->bearing >= 0) {
            add_force_over_speed(own, force->bearing, speed, motion, out);
        }
        for (k = 0; k < own->slider_count; k++) { /* its force is that on the rotor */
            if (own->sliders[k].support == f + 1) {
                out[own->sliders[k].axis] -= rotor_slider_states(unit)[SLIDER_DOUBLES * k + HOLDS];
            }
        }
        add_restrained(unit, f + 1, out);
    }
}
