#include "machine/restraints.h"

#include "base/elementary.h"

enum { COEFFICIENTS_OF_RESTRAINT = MOST_ORDER + 3 };

static int allocate_series(Unit *unit, RestraintSeries *series)
{
    double *memory = unit_allocate(unit, restraint_series_size(COEFFICIENTS_OF_RESTRAINT), sizeof(double));
    if (memory) {
        *series = restraint_series_in(memory, COEFFICIENTS_OF_RESTRAINT);
    }
    return !memory;
}

struct Restraints *restraints_allocate(Unit *unit, int cubics, int stops)
{
    struct Restraints *made = unit_allocate(unit, 1, sizeof *made);
    int k, missing = !made;
    if (missing) {
        return NULL;
    }
    made->cubic_count = cubics;
    made->stop_count = stops;
    made->cubics = unit_allocate(unit, (size_t)cubics + 1, sizeof *made->cubics);
    made->stops = unit_allocate(unit, (size_t)stops + 1, sizeof *made->stops);
    missing = !made->cubics || !made->stops;
    for (k = 0; k < cubics && !missing; k++) {
        missing = allocate_series(unit, &made->cubics[k].series);
    }
    for (k = 0; k < stops && !missing; k++) {
        missing = allocate_series(unit, &made->stops[k].series);
    }
    return missing ? NULL : made;
}

void restraints_take(Machine *m, const CubicSpring *cubics, const Stop *stops)
{
    struct Restraints *all = m->restraints;
    const double t = m->per_rate;
    int k, axis;
    for (k = 0; k < all->cubic_count; k++) {
        CubicSpring *spring = &all->cubics[k].spring;
        *spring = cubics[k];
        for (axis = 0; axis < 2; axis++) {
            spring->stiffness[axis] *= t * t;
        }
    }
    for (k = 0; k < all->stop_count; k++) {
        Stop *stop = &all->stops[k].stop;
        *stop = stops[k];
        stop->stiffness *= t * t;
        stop->damping *= t;
    }
}

/* x and y of a series of the stations (`width` columns), of order k, across a restraint. */
static void restraint_across(const Machine *m, const double *rows, const Pair *series, int k, double *across)
{
    const int own = m->stations - m->waves;
    Pair sum = pair_zero();
    int i;
    for (i = 0; i < own; i++) {
        sum = pair_add_times(sum, pair_of(rows[2 * i], rows[2 * i + 1]), series[k * m->width + i]);
    }
    across[0] = pair_x(sum);
    across[1] = pair_y(sum);
}

void restraints_across(const Machine *m, const double *rows, double *displacement, double *velocity)
{
    restraint_across(m, rows, m->motion, 0, displacement);
    restraint_across(m, rows, m->velocity, 0, velocity);
}

static void push_by(Machine *m, const double *rows, const double *force)
{
    const int own = m->stations - m->waves;
    int i;
    for (i = 0; i < own; i++) {
        m->right[2 * i] += rows[2 * i] * force[0];
        m->right[2 * i + 1] += rows[2 * i + 1] * force[1];
    }
}

/* The displacement of order k, and what follows from it. */
static void displace(const Machine *m, RestraintSeries *series, const double *rows, int k)
{
    double across[2];
    restraint_across(m, rows, m->motion, k, across);
    restraint_displace(series, k, across);
}

void restraints_push(Machine *m, int k)
{
    struct Restraints *all = m->restraints;
    double force[2];
    int j;
    for (j = 0; j < all->cubic_count; j++) {
        MachineCubic *one = all->cubics + j;
        displace(m, &one->series, one->spring.rows, k);
        cubic_series_force(&one->spring, &one->series, k, force);
        push_by(m, one->spring.rows, force);
    }
    for (j = 0; j < all->stop_count; j++) {
        MachineStop *one = all->stops + j;
        if (one->state != STOP_PRESSES) {
            continue;
        }
        if (k == 0) {
            displace(m, &one->series, one->stop.rows, 0);
        }
        displace(m, &one->series, one->stop.rows, k + 1);
        stop_series_force(&one->stop, &one->series, k, force);
        push_by(m, one->stop.rows, force);
    }
}

void restraints_complete(Machine *m, RestraintSeries *series, const double *rows, int order)
{
    int k;
    for (k = 0; k <= order; k++) {
        displace(m, series, rows, k);
    }
}

void restraints_settle(Machine *m)
{
    struct Restraints *all = m->restraints;
    int k;
    for (k = 0; k < all->stop_count; k++) {
        MachineStop *one = all->stops + k;
        double displacement[2], velocity[2];
        restraints_across(m, one->stop.rows, displacement, velocity);
        one->state = stop_state_of(&one->stop, displacement, velocity, one->state);
    }
}

double restraints_largest(const MachineStop *stop, int order, double time)
{
    return stop->state == STOP_PRESSES ? largest_of_series(stop->series.pressure, order, time) : 0.0;
}
