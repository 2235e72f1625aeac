/* What a machine is to a collocation: numbers of its state, accelerations with their derivatives, and a polynomial. */
#include "machine/collocation.h"

#include "base/elementary.h"
#include "base/matrix.h"
#include "machine/phase.h"

#define DISTURBANCE 1e-7 /* of what moves: by which derivatives are taken */

/* -- its state, and the accelerations there -------------------------------------------------------------- */

/* How many numbers say where the stations are. */
static int numbers_of_stations(const Machine *m)
{
    return m->carried ? 0 : 2 * m->stations;
}

/* Places and speeds of a machine, from its coefficients of order 0; its accelerations, from those of order 1. */
static void read_columns(const Machine *m, const Pair *columns, double *to)
{
    const int n = m->stations, first = numbers_of_stations(m);
    int k;
    for (k = 0; 2 * k < first; k++) {
        to[2 * k] = pair_x(columns[k]);
        to[2 * k + 1] = pair_y(columns[k]);
    }
    for (k = 0; k < m->weight_count; k++) {
        to[first + k] = pair_at(columns[n + k / 2], k % 2);
    }
}

static void write_columns(const Machine *m, const double *from, Pair *columns)
{
    const int n = m->stations, first = numbers_of_stations(m);
    int k;
    for (k = 0; 2 * k < first; k++) {
        columns[k] = pair_of(from[2 * k], from[2 * k + 1]);
    }
    for (k = 0; k < m->weight_count; k++) {
        pair_set(&columns[n + k / 2], k % 2, from[first + k]);
    }
}

void collocation_accelerate(const Collocation *c, double time, const double *places, const double *speeds, double *rates)
{
    Machine *m = c->at;
    const int n = m->stations, last = c->unknowns - 1;
    double turned = (c->speed + 0.5 * c->acceleration * time) * time;
    int k, order;
    write_columns(m, places, m->motion);
    write_columns(m, speeds, m->velocity);
    m->speed[0] = c->speed + c->acceleration * time;
    m->speed[1] = c->acceleration;
    if (m->drive.motor) {
        m->speed[0] = speeds[last];
        turned = places[last];
    }
    if (m->carried) {
        turned = machine_carry(m, &c->carried, time);
    }
    for (k = 0; k < n && !m->carried; k++) {
        Pair push = c->push[(SIGNAL_ORDERS - 1) * n + k];
        for (order = SIGNAL_ORDERS - 2; order >= 0; order--) {
            push = pair_add_scaled(c->push[order * n + k], push, time);
        }
        m->push[k] = push;
    }
    machine_expand(m, c->angle + turned, 2);
    read_columns(m, m->velocity + m->width, rates);
    if (m->drive.motor) {
        rates[last] = m->speed[1];
    }
}

void collocation_keep_holds(const Collocation *c, int point)
{
    const Machine *m = c->at;
    double *alone = c->held + point * m->weight_count, *load = alone + (c->rule->stages + 1) * m->weight_count;
    int w;
    for (w = 0; w < m->weight_count && m->phase; w++) {
        alone[w] = m->phase->weights[w].alone[0];
        load[w] = m->phase->weights[w].load[0];
    }
}

/* A column of derivatives: what the accelerations change by where one number of a state is changed. */
static void differentiate_by(const Collocation *c, double time, double *state, int number, double by, double *matrix)
{
    const int d = c->unknowns, column = number % d;
    const double kept = state[number], *rates = state + 2 * d;
    int k;
    state[number] += by;
    by = state[number] - kept;
    collocation_accelerate(c, time, state, state + d, c->scratch);
    state[number] = kept;
    for (k = 0; k < d; k++) {
        matrix[k * d + column] = (c->scratch[k] - rates[k]) / by;
    }
}

/* The same of all columns at once, of weights apart.  `numbers`: the places or the speeds of the state. */
static void differentiate_apart(const Collocation *c, double time, double *state, double *numbers, double *matrix)
{
    const int d = c->unknowns;
    const double *rates = state + 2 * d;
    double *kept = c->scratch + d;
    int k;
    copy_doubles((size_t)d, numbers, kept);
    for (k = 0; k < d; k++) {
        numbers[k] += DISTURBANCE;
    }
    collocation_accelerate(c, time, state, state + d, c->scratch);
    for (k = 0; k < d * d; k++) {
        matrix[k] = 0.0;
    }
    for (k = 0; k < d; k++) {
        matrix[k * d + k] = (c->scratch[k] - rates[k]) / (numbers[k] - kept[k]);
    }
    copy_doubles((size_t)d, kept, numbers);
}

void collocation_differentiate(const Collocation *c, double time, double *state)
{
    const int d = c->unknowns, first = c->displacements;
    const double largest = larger(largest_of(first, state), 1e-3 * largest_of(first, state + d));
    int k;
    if (c->are_apart) {
        differentiate_apart(c, time, state, state, c->by_place);
        differentiate_apart(c, time, state, state + d, c->by_speed);
        return;
    }
    for (k = 0; k < d; k++) {
        const double by = DISTURBANCE * (k < first && largest > 0.0 ? largest : 1.0);
        differentiate_by(c, time, state, k, by, c->by_place);
        differentiate_by(c, time, state, d + k, by, c->by_speed);
    }
}

void collocation_start(Collocation *c, const Machine *m, Machine *at, double angle)
{
    const int n = m->stations, first = numbers_of_stations(m), has_shaft = m->drive.motor != NULL;
    const int d = first + m->weight_count + has_shaft;
    double *places = c->start, *speeds = places + d;
    int k;
    c->rule = m->carried || m->phase ? &RADAU_SEVEN : &RADAU_ELEVEN;
    c->at = at;
    c->unknowns = d;
    c->displacements = first;
    c->are_apart = m->carried && !m->phase;
    c->angle = angle;
    c->speed = m->speed[0];
    c->acceleration = has_shaft ? 0.0 : m->speed[1];
    for (k = 0; k < SIGNAL_ORDERS * n && !m->carried; k++) {
        c->push[k] = m->push[k];
    }
    if (m->carried) {
        c->carried = *m->carried;
        at->phase = m->phase;
    }
    at->drive = m->drive;
    read_columns(m, m->motion, places);
    read_columns(m, m->velocity, speeds);
    if (has_shaft) {
        places[d - 1] = 0.0;
        speeds[d - 1] = c->speed;
    }
    collocation_accelerate(c, 0.0, places, speeds, speeds + d);
    collocation_keep_holds(c, 0);
}

/* -- the polynomial ------------------------------------------------------------------------------------- */

/* The polynomial through values at the start and the points, `stride` apart, in powers of the time. */
static void write_values(const Radau *rule, const double *values, int stride, double length, double *series)
{
    const double *row = rule->powers;
    double power = 1.0;
    int j, order;
    series[0] = values[0];
    for (order = 1; order <= rule->stages; order++, row += rule->stages) {
        power /= length;
        series[order] = 0.0;
        for (j = 0; j < rule->stages; j++) {
            series[order] += row[j] * (values[(j + 1) * stride] - values[0]) * power;
        }
    }
}

static void write_holds(const Collocation *c, double length, const Machine *m)
{
    const int n = m->weight_count;
    int w;
    for (w = 0; w < n && m->phase; w++) {
        PhaseWeight *own = m->phase->weights + w;
        write_values(c->rule, c->held + w, n, length, own->alone);
        write_values(c->rule, c->held + (c->rule->stages + 1) * n + w, n, length, own->load);
    }
}

/* Coefficients of one order of places and speeds, by a row of what each point has in them. */
static void write_order(const Collocation *c, const double *row, double scale, int order, Machine *m)
{
    const int d = c->unknowns;
    double *places = c->scratch, *speeds = places + d;
    int j, k;
    for (k = 0; k < d; k++) {
        places[k] = speeds[k] = 0.0;
        for (j = 0; j < c->rule->stages; j++) {
            places[k] += row[j] * c->places[j * d + k];
            speeds[k] += row[j] * c->speeds[j * d + k];
        }
        places[k] = places[k] * scale + (order ? 0.0 : c->start[k]);
        speeds[k] = speeds[k] * scale + (order ? 0.0 : c->start[d + k]);
    }
    write_columns(m, places, m->motion + order * m->width);
    write_columns(m, speeds, m->velocity + order * m->width);
    if (m->drive.motor) {
        m->shaft[order] = pair_of(speeds[d - 1], places[d - 1]);
        m->speed[order] = c->rule->powers ? speeds[d - 1] : m->speed[order];
    }
}

static void write_powers(const Collocation *c, double length, Machine *m)
{
    const int stages = c->rule->stages;
    double power = 1.0;
    int k, order;
    for (order = 1; order <= stages; order++) {
        power /= length;
        write_order(c, c->rule->powers + (order - 1) * stages, power, order, m);
    }
    for (k = (stages + 1) * m->width; k < (OF_POWERS + 1) * m->width; k++) {
        m->motion[k] = m->velocity[k] = pair_zero();
    }
    for (order = stages + 1; order <= OF_POWERS && m->drive.motor; order++) {
        m->speed[order] = 0.0;
    }
    write_holds(c, length, m);
}

void collocation_write(const Collocation *c, double length, Machine *m)
{
    const int stages = c->rule->stages;
    int order;
    if (c->rule->powers) {
        write_powers(c, length, m);
        return;
    }
    for (order = 0; order <= stages; order++) {
        write_order(c, c->rule->sums + order * stages, 1.0, order, m);
    }
    m->collocated_order = stages;
    m->collocated_length = length;
    if (!m->drive.motor && !m->carried) {
        m->speed[1] = c->acceleration;
    }
}
