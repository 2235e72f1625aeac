/* The step of the rotor's unit: matrices kept by speed and length of the step, and their use. */
#include <string.h>

#include "base/elementary.h"
#include "base/matrix.h"
#include "base/quintic.h"
#include "base/spin.h"
#include "rotor/propagator.h"
#include "units/rotor.h"

/* By columns, x and y alternating. */
static void sort_matrix(const Rotor *own, const double *from, double *to)
{
    const int n = own->stations, p = own->planes;
    const size_t wide = (size_t)own->columns;
    int block, i, k;
    for (k = 0; k < own->columns; k++) {
        const double *x = from + rotor_column(own, k);
        for (block = 0; block < 2 + own->orders / 2; block++) {
            const size_t size = (size_t)(block < 2 ? n : p);
            for (i = 0; i < (int)size; i++, x += wide) {
                *to++ = x[0];
                *to++ = x[size * wide];
            }
            x += size * wide; /* y have been taken with x */
        }
    }
}

/* The kept matrix that was asked for longest ago, or one never used. */
static Kept *oldest(Rotor *own)
{
    Kept *found = own->kept;
    int k;
    for (k = 1; k < KEPT_MATRICES && found->of.made; k++) {
        if (!own->kept[k].of.made || own->kept[k].last < found->last) {
            found = own->kept + k;
        }
    }
    return found;
}

const double *rotor_matrix(Unit *unit, double speed, double step)
{
    Rotor *own = unit->own;
    LinearRotor loaded;
    Failure failure;
    Kept *kept;
    int k;
    own->clock++;
    for (k = 0; k < KEPT_MATRICES; k++) {
        kept = own->kept + k;
        if (kept->step == step && rotor_is_of(unit, &kept->of, speed)) {
            kept->last = own->clock;
            return kept->matrix;
        }
    }
    kept = oldest(own);
    loaded = rotor_anew(unit, &kept->of);
    if (step_matrix(&loaded, speed, step, own->turning, own->orders, own->unsorted,
                    own->matrix_scratch, &own->doublings, &failure)) {
        unit_failed(unit, &failure, NULL, 0);
        return NULL;
    }
    if (own->axes == 2) {
        sort_matrix(own, own->unsorted, kept->matrix);
    } else {
        matrix_transposed(2, own->rows, own->columns, own->unsorted, kept->matrix);
    }
    kept->step = step;
    kept->last = own->clock;
    rotor_made(unit, &kept->of, speed);
    return kept->matrix;
}

/* (x..., y...) a block from x and y alternating, or back; complex numbers stay as they are. */
static void to_axes(const double *pairs, int axes, int blocks, int size, double *values)
{
    int b, k;
    for (b = 0; b < blocks; b++, pairs += 2 * size, values += 2 * size) {
        for (k = 0; k < size; k++) {
            values[axes == 1 ? 2 * k : k] = pairs[2 * k];
            values[axes == 1 ? 2 * k + 1 : size + k] = pairs[2 * k + 1];
        }
    }
}

static void from_axes(const double *values, int axes, int blocks, int size, double *pairs)
{
    int b, k;
    for (b = 0; b < blocks; b++, pairs += 2 * size, values += 2 * size) {
        for (k = 0; k < size; k++) {
            pairs[2 * k] = values[axes == 1 ? 2 * k : k];
            pairs[2 * k + 1] = values[axes == 1 ? 2 * k + 1 : size + k];
        }
    }
}

double *rotor_slider_states(const Unit *unit)
{
    return unit->memory + MOTION + 4 * ((const Rotor *)unit->own)->stations + 2;
}

int rotor_make_variable(Unit *unit)
{
    Rotor *own = unit->own;
    LinearRotor loaded;
    Failure failure;
    if (rotor_is_of(unit, &own->variable_of, 0.0)) {
        return 0;
    }
    loaded = rotor_anew(unit, &own->variable_of);
    if (variable_speed_step(&loaded, own->turning, own->variable_memory, own->variable_scratch,
                            &own->variable, &failure) ||
        (own->slider_count &&
         friction_step(&loaded, &own->variable, own->sliders, own->slider_count,
                       own->friction_memory, &own->friction, &failure))) {
        return unit_failed(unit, &failure, NULL, 0);
    }
    own->variable.orders = own->orders;
    rotor_made(unit, &own->variable_of, 0.0);
    return 0;
}

/* Motion of the stations, and acceleration and jerk of the planes, after `step` [s], in
   own->result; all in fixed axes, x and y alternating. */
static int propagate_variable(Unit *unit, double step)
{
    Rotor *own = unit->own;
    const int n = own->stations, p = own->planes;
    const double speed = rotor_drive(unit)[0], *spin_up = rotor_drive(unit) + SPIN_UP;
    const double angle = unit->memory[REST];
    const double *forces = rotor_drive(unit) + SPUN;
    double *planes = own->result + 4 * n;
    Failure failure;
    if (rotor_make_variable(unit)) {
        return 1;
    }
    to_axes(unit->memory + MOTION, own->axes, 2, n, own->state);
    if (step != 0.0 &&
        variable_speed_advance(&own->variable, own->state, forces, angle, speed, spin_up, step,
                               own->variable_scratch, &failure)) {
        return unit_failed(unit, &failure, NULL, 0);
    }
    variable_speed_plane_motion(&own->variable, own->state, forces, angle, speed, spin_up, step,
                                own->acceleration, own->jerk, own->variable_scratch);
    from_axes(own->state, own->axes, 2, n, own->result);
    from_axes(own->acceleration, own->axes, 1, p, planes);
    from_axes(own->jerk, own->axes, 1, p, planes + 2 * p);
    if (own->orders == QUINTIC_ORDERS) {
        variable_speed_plane_second(&own->variable, own->state, forces, angle, speed, spin_up, step,
                                    own->jerk, own->variable_scratch);
        from_axes(own->jerk, own->axes, 1, p, planes + 4 * p);
    }
    return 0;
}

/* What moves a rotor with friction, whose angle `ago` later is that in memory. */
static Drive friction_drive(Unit *unit, const double *forces, const double *spin_up, double ago)
{
    Drive drive;
    drive.forces = forces;
    drive.spin_up = spin_up;
    drive.speed = rotor_drive(unit)[0];
    drive.angle = unit->memory[REST] - ago * (drive.speed + 0.5 * spin_up[0] * ago) -
                  drift(spin_up, ago).angle;
    return drive;
}

/* Whether a step of this length ends at an event of a slider. */
static int stops(const Unit *unit, double length)
{
    const double shortest = unit->real[rotor_shortest_stopped(unit)];
    return unit->may_end_early && shortest > 0.0 && length >= shortest;
}

/* The sliders in own->held as they are `step` after the inputs were set, own->state with them. */
static int friction_move(Unit *unit, const Drive *drive, double step, Failure *failure)
{
    Rotor *own = unit->own;
    to_axes(unit->memory + MOTION, 2, 2, own->stations, own->state);
    if (unit->frozen) {
        return FINE;
    }
    memcpy(own->slider_states, rotor_slider_states(unit), 2 * (size_t)own->slider_count * sizeof(double));
    return step != 0.0
               ? friction_advance(&own->friction, own->state, own->slider_states, drive, step,
                              stops(unit, step), &own->reached, failure)
               : friction_resolve(&own->friction, own->state, own->slider_states, drive, 0.0, failure);
}

/* The same with friction, what it is after the step in own->held. */
static int propagate_friction(Unit *unit, double step)
{
    Rotor *own = unit->own;
    const int n = own->stations, p = own->planes;
    const double *spin_up = rotor_drive(unit) + SPIN_UP;
    const Drive drive = friction_drive(unit, rotor_drive(unit) + SPUN, spin_up, 0.0);
    double *planes = own->result + 4 * n;
    Failure failure;
    if (rotor_make_variable(unit)) {
        return 1;
    }
    if (friction_move(unit, &drive, step, &failure) ||
        friction_plane_motion(&own->friction, own->state, own->slider_states, &drive, own->reached,
                              own->acceleration, own->jerk, &failure)) {
        return unit_failed(unit, &failure, NULL, 0);
    }
    from_axes(own->state, 2, 2, n, own->result);
    from_axes(own->acceleration, 2, 1, p, planes);
    from_axes(own->jerk, 2, 1, p, planes + 2 * p);
    return 0;
}

/* rotor_torque_now of a rotor with friction. */
static int friction_torque(Unit *unit, double ago, double *torque)
{
    Rotor *own = unit->own;
    const double *spin_up = rotor_drive(unit) + SPIN_UP;
    const Drive drive = friction_drive(unit, rotor_drive(unit) + SPUN, spin_up, ago);
    const Drift more = drift(spin_up, ago);
    double *rates = own->variable_scratch, *jerks = rates + 4 * own->stations;
    Failure failure;
    to_axes(unit->memory + MOTION, 2, 2, own->stations, own->state);
    if (!unit->frozen) {
        memcpy(own->slider_states, rotor_slider_states(unit), 2 * (size_t)own->slider_count * sizeof(double));
    }
    if ((ago == 0.0 && !unit->frozen &&
         friction_resolve(&own->friction, own->state, own->slider_states, &drive, 0.0, &failure)) ||
        friction_motion(&own->friction, own->state, own->slider_states, &drive, ago, rates, jerks,
                        &failure)) {
        return unit_failed(unit, &failure, NULL, 0);
    }
    shaft_torque(&own->variable, &own->rotor, own->state, rates, jerks, unit->memory[REST],
                 drive.speed + spin_up[0] * ago + more.speed, spin_up[0] + more.acceleration,
                 torque);
    return 0;
}

/* Prepare own->variable and own->state for the present time; how long ago the inputs were set [s], and
   the angle then. */
static int stand_now(Unit *unit, double *ago, double *angle)
{
    Rotor *own = unit->own;
    const double speed = rotor_drive(unit)[0], *spin_up = rotor_drive(unit) + SPIN_UP;
    *ago = unit->memory[MOTION + 4 * own->stations + 1];
    *angle = unit->memory[REST] - (*ago * (speed + 0.5 * spin_up[0] * *ago) + drift(spin_up, *ago).angle);
    if (rotor_make_variable(unit)) {
        return 1;
    }
    to_axes(unit->memory + MOTION, own->axes, 2, own->stations, own->state);
    return 0;
}

int rotor_torque_now(Unit *unit, double *torque)
{
    Rotor *own = unit->own;
    double ago, angle;
    if (stand_now(unit, &ago, &angle)) {
        return 1;
    }
    if (own->slider_count) {
        return friction_torque(unit, ago, torque);
    }
    variable_speed_torque(&own->variable, &own->rotor, own->state, rotor_drive(unit) + SPUN, angle,
                          rotor_drive(unit)[0], rotor_drive(unit) + SPIN_UP, ago, torque,
                          own->variable_scratch);
    return 0;
}

int rotor_derivatives(Unit *unit, double *rates)
{
    Rotor *own = unit->own;
    const size_t n = (size_t)own->stations;
    double *moved = own->variable_scratch, *jerks = moved + 4 * n, ago, angle;
    if (stand_now(unit, &ago, &angle)) {
        return 1;
    }
    variable_speed_motion(&own->variable, own->state, rotor_drive(unit) + SPUN, angle, rotor_drive(unit)[0],
                          rotor_drive(unit) + SPIN_UP, ago, moved, jerks, jerks + 2 * n);
    rates[0] = unit->memory[MOTION + 4 * n];
    from_axes(moved, own->axes, 2, (int)n, rates + 1);
    return 0;
}

void rotor_rotated(const double *pairs, size_t count, double c, double s, double *to)
{
    size_t k;
    for (k = 0; k < 2 * count; k += 2) {
        const double x = pairs[k], y = pairs[k + 1];
        to[k] = x * c - y * s;
        to[k + 1] = x * s + y * c;
    }
}

void rotor_apply(Rotor *own, const double *matrix)
{
    const int rows = own->rows, columns = own->columns;
    int i, k;
    if (own->axes == 1) {
        fill_doubles(2 * (size_t)rows, 0.0, own->result);
        add_multiples(2, rows, columns, own->operand, matrix, 2 * (size_t)rows, own->result);
        return;
    }
    for (i = 0; i + 4 <= rows; i += 4) { /* two axes: 4 rows a station and plane */
        const double *m = matrix + i;
        double a = 0.0, b = 0.0, c = 0.0, d = 0.0;
        for (k = 0; k < columns; k++, m += rows) {
            const double factor = own->operand[k];
            a += factor * m[0];
            b += factor * m[1];
            c += factor * m[2];
            d += factor * m[3];
        }
        own->result[i] = a;
        own->result[i + 1] = b;
        own->result[i + 2] = c;
        own->result[i + 3] = d;
    }
    if (i < rows) { /* the jerk's derivative on an odd number of planes */
        const double *m = matrix + i;
        double a = 0.0, b = 0.0;
        for (k = 0; k < columns; k++, m += rows) {
            a += own->operand[k] * m[0];
            b += own->operand[k] * m[1];
        }
        own->result[i] = a;
        own->result[i + 1] = b;
    }
}

/* State, forces and turn that a step begins with, in own->operand, less the sag; 1 with the reason. */
static int set_operand(Unit *unit)
{
    Rotor *own = unit->own;
    const size_t p = (size_t)own->planes, forces = 4 * (size_t)own->stations;
    const size_t turn = forces + 2 * (size_t)own->orders * p;
    const Complex turned = turned_by(own->turned, unit->memory[REST]);
    copy_doubles(forces, unit->memory + MOTION, own->operand);
    if (own->turning) {
        rotor_rotated(rotor_drive(unit) + SPUN, (size_t)own->orders * p, turned.re, turned.im,
                      own->operand + forces);
    } else {
        copy_doubles(turn - forces, rotor_drive(unit) + SPUN, own->operand + forces);
    }
    own->operand[turn] = turned.re;
    own->operand[turn + 1] = turned.im;
    return linear_rotor_heavy(&own->rotor) && rotor_lift(unit);
}

/* `rotor_propagate`, the acceleration with gravity's. */
static int propagate(Unit *unit, double step)
{
    Rotor *own = unit->own;
    const double *matrix;
    if (own->slider_count) {
        return propagate_friction(unit, step);
    }
    if (unit->exchanges || rotor_drive(unit)[SPIN_UP] != 0.0 || drifts(rotor_drive(unit) + SPIN_UP)) {
        return propagate_variable(unit, step);
    }
    if (set_operand(unit)) {
        return 1;
    }
    if (own->whole > 0.0) {
        if (rotor_rates(unit)) {
            return 1;
        }
        if (rotor_within(own, step)) {
            return 0;
        }
        if (set_operand(unit)) {
            return 1;
        }
    }
    matrix = rotor_matrix(unit, rotor_drive(unit)[0], step);
    if (!matrix) {
        return 1;
    }
    rotor_apply(own, matrix);
    return 0;
}

int rotor_propagate(Unit *unit, double step)
{
    Rotor *own = unit->own;
    own->lifted = 0;
    own->reached = step;
    if (propagate(unit, step)) {
        return 1;
    }
    if (linear_rotor_heavy(&own->rotor)) {
        rotor_lower(own);
    }
    return 0;
}

void rotor_put(Rotor *own, const double *planes, double angle, double speed, double spin_up,
               double *out)
{
    const size_t n = 2 * (size_t)own->planes, exact = (size_t)own->orders / 2;
    size_t k;
    copy_doubles(exact * n, planes, out);
    if (own->turning) {
        const Complex turned = turned_by(own->turned, angle);
        /* (a e^{-i beta})'' = (s - 2 i w j - (w^2 + i w') a) e^{-i beta} */
        for (k = 0; exact == 3 && k < n; k += 2) {
            const double *a = planes + k, *j = a + n;
            out[2 * n + k] += speed * (2.0 * j[1] - speed * a[0]) + spin_up * a[1];
            out[2 * n + k + 1] -= speed * (2.0 * j[0] + speed * a[1]) + spin_up * a[0];
        }
        /* (a e^{-i beta})' = (j - i w a) e^{-i beta} */
        for (k = 0; k < n; k += 2) {
            out[n + k] += speed * out[k + 1];
            out[n + k + 1] -= speed * out[k];
        }
        rotor_rotated(out, exact * n / 2, turned.re, -turned.im, out);
    }
}

int rotor_outputs_now(Unit *unit, double *out)
{
    Rotor *own = unit->own;
    if (rotor_propagate(unit, 0.0)) {
        return 1;
    }
    rotor_put(own, own->result + 4 * own->stations, unit->memory[REST], rotor_drive(unit)[0],
              rotor_drive(unit)[SPIN_UP], out);
    return 0;
}
