/* Newton's method for a step of a stiff machine. */
#include "machine/collocation.h"

#include "base/elementary.h"
#include "base/matrix.h"
#include "machine/phase.h"

enum { MOST_PASSES = 14, MANY_PASSES = 10 };
#define DISTURBANCE 1e-7 /* of what moves: by which derivatives are taken */
#define LEFT_BY_PASSES 0.02 /* of the tolerance */
#define ROUNDING_OF_PASSES 1e-15
#define SLOWEST_PASSES 0.7 /* what a pass leaves of the one before, at most */
#define CAUTION 0.8
#define LEAST_FACTOR 0.1
#define MOST_FACTOR 4.0
#define UNSOLVED_FACTOR 0.4

int collocation_allocate(Unit *unit, Collocation *c, int stations, int weights)
{
    const size_t d = 2 * (size_t)stations + (size_t)weights + 1;
    c->start = unit_allocate(unit, 3 * d, sizeof(double));
    c->middle = unit_allocate(unit, 3 * d, sizeof(double));
    c->by_place = unit_allocate(unit, d * d, sizeof(double));
    c->by_speed = unit_allocate(unit, d * d, sizeof(double));
    c->places = unit_allocate(unit, MOST_STAGES * d, sizeof(double));
    c->speeds = unit_allocate(unit, MOST_STAGES * d, sizeof(double));
    c->rates = unit_allocate(unit, MOST_STAGES * d, sizeof(double));
    c->moved = unit_allocate(unit, MOST_STAGES * d, sizeof(double));
    c->scratch = unit_allocate(unit, 2 * d, sizeof(double));
    c->factors = unit_allocate(unit, MOST_MODES * d * d, sizeof(Complex));
    c->right = unit_allocate(unit, d, sizeof(Complex));
    c->rows = unit_allocate(unit, MOST_MODES * d, sizeof(int));
    c->held = unit_allocate(unit, 2 * (MOST_STAGES + 1) * (size_t)weights, sizeof(double));
    c->push = unit_allocate(unit, SIGNAL_ORDERS * (size_t)stations, sizeof(Pair));
    return !c->start || !c->middle || !c->by_place || !c->by_speed || !c->places || !c->speeds || !c->rates ||
           !c->moved || !c->scratch || !c->factors || !c->right || !c->rows || !c->push || !c->held;
}

/* -- accelerations ----------------------------------------------------------------------------------- */

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

/* Accelerations so long after the start. */
static void accelerate(const Collocation *c, double time, const double *places, const double *speeds, double *rates)
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

/* Keep what weights that touch or stick would do alone, and their loads, at the start or a point from 1 on. */
static void keep_holds(const Collocation *c, int point)
{
    const Machine *m = c->at;
    double *alone = c->held + point * m->weight_count, *load = alone + (c->rule->stages + 1) * m->weight_count;
    int w;
    for (w = 0; w < m->weight_count && m->phase; w++) {
        alone[w] = m->phase->weights[w].alone[0];
        load[w] = m->phase->weights[w].load[0];
    }
}

/* Whether no number changes the acceleration of another: weights that are carried and cannot touch. */
static bool are_apart(const Machine *m)
{
    return m->carried && !m->phase;
}

/* A column of derivatives: what the accelerations change by where one number of a state is changed. */
static void differentiate(const Collocation *c, double time, double *state, int number, double by, double *matrix)
{
    const int d = c->unknowns, column = number % d;
    const double kept = state[number], *rates = state + 2 * d;
    int k;
    state[number] += by;
    by = state[number] - kept;
    accelerate(c, time, state, state + d, c->scratch);
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
    accelerate(c, time, state, state + d, c->scratch);
    for (k = 0; k < d * d; k++) {
        matrix[k] = 0.0;
    }
    for (k = 0; k < d; k++) {
        matrix[k * d + k] = (c->scratch[k] - rates[k]) / (numbers[k] - kept[k]);
    }
    copy_doubles((size_t)d, kept, numbers);
}

/* Derivatives at a state so long after the start: places, speeds, accelerations (3, d). */
static void differentiate_all(const Collocation *c, double time, double *state)
{
    const int d = c->unknowns, first = numbers_of_stations(c->at);
    const double largest = larger(largest_of(first, state), 1e-3 * largest_of(first, state + d));
    int k;
    if (are_apart(c->at)) {
        differentiate_apart(c, time, state, state, c->by_place);
        differentiate_apart(c, time, state, state + d, c->by_speed);
        return;
    }
    for (k = 0; k < d; k++) {
        const double by = DISTURBANCE * (k < first && largest > 0.0 ? largest : 1.0);
        differentiate(c, time, state, k, by, c->by_place);
        differentiate(c, time, state, d + k, by, c->by_speed);
    }
}

void collocation_start(Collocation *c, const Machine *m, Machine *at, double angle)
{
    const int n = m->stations, first = numbers_of_stations(m), has_shaft = m->drive.motor != NULL;
    const int d = first + m->weight_count + has_shaft;
    double *places = c->start, *speeds = places + d;
    int k;
    c->rule = m->carried ? &RADAU_SEVEN : &RADAU_ELEVEN;
    c->at = at;
    c->unknowns = d;
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
    accelerate(c, 0.0, places, speeds, speeds + d);
    keep_holds(c, 0);
}

/* -- the linear systems ------------------------------------------------------------------------------- */

static Complex quotient(Complex a, Complex b)
{
    const double over = 1.0 / (b.re * b.re + b.im * b.im);
    return complex_scaled(over, complex_product(a, complex_conjugate(b)));
}

/* Factors of a matrix (d, d), with the rows that are exchanged; 1 where it is singular. */
static int factorise_complex(int d, Complex *a, int *rows)
{
    int i, j, k;
    for (k = 0; k < d; k++) {
        double most = 0.0;
        rows[k] = k;
        for (i = k; i < d; i++) {
            const double size = larger(absolute(a[i * d + k].re), absolute(a[i * d + k].im));
            if (size > most) {
                most = size;
                rows[k] = i;
            }
        }
        if (!(most > 0.0)) {
            return 1;
        }
        for (j = 0; j < d; j++) {
            const Complex kept = a[k * d + j];
            a[k * d + j] = a[rows[k] * d + j];
            a[rows[k] * d + j] = kept;
        }
        for (i = k + 1; i < d; i++) {
            const Complex part = quotient(a[i * d + k], a[k * d + k]);
            a[i * d + k] = part;
            for (j = k + 1; j < d; j++) {
                a[i * d + j] = complex_difference(a[i * d + j], complex_product(part, a[k * d + j]));
            }
        }
    }
    return 0;
}

/* b becomes the solution. */
static void solve_complex(int d, const Complex *a, const int *rows, Complex *b)
{
    int i, k;
    for (k = 0; k < d; k++) {
        const Complex kept = b[k];
        b[k] = b[rows[k]];
        b[rows[k]] = kept;
    }
    for (i = 0; i < d; i++) {
        for (k = 0; k < i; k++) {
            b[i] = complex_difference(b[i], complex_product(a[i * d + k], b[k]));
        }
    }
    for (i = d - 1; i >= 0; i--) {
        for (k = i + 1; k < d; k++) {
            b[i] = complex_difference(b[i], complex_product(a[i * d + k], b[k]));
        }
        b[i] = quotient(b[i], a[i * d + i]);
    }
}

/* Factors of 1 - h s V - (h s)^2 P for an eigenvalue s and the derivatives by speeds V and places P, of weights apart
   its diagonal alone; 1 where it is singular. */
static int factorise_mode(const Collocation *c, int mode, double length)
{
    const int d = c->unknowns, next = are_apart(c->at) ? d + 1 : 1;
    const Complex first = complex_scaled(length, c->rule->values[mode]), second = complex_product(first, first);
    Complex *a = c->factors + (size_t)(mode * d) * (size_t)d;
    int i;
    for (i = 0; i < d * d; i += next) {
        a[i] = complex_scaled(-1.0, complex_sum(complex_scaled(c->by_speed[i], first),
                                                complex_scaled(c->by_place[i], second)));
    }
    for (i = 0; i < d; i++) {
        a[i * d + i].re += 1.0;
    }
    return next == 1 && factorise_complex(d, a, c->rows + mode * d);
}

/* c->right becomes the solution. */
static void solve_mode(const Collocation *c, int mode)
{
    const int d = c->unknowns;
    const Complex *a = c->factors + (size_t)(mode * d) * (size_t)d;
    int i;
    if (!are_apart(c->at)) {
        solve_complex(d, a, c->rows + mode * d, c->right);
        return;
    }
    for (i = 0; i < d; i++) {
        c->right[i] = quotient(c->right[i], a[i * d + i]);
    }
}

/* -- a step --------------------------------------------------------------------------------------------- */

/* The part of the unknowns that is displacements over `largest`, the rest over 1: its largest number. */
static double size_of_motion(const Collocation *c, const double *places, double largest)
{
    const int n = numbers_of_stations(c->at);
    double most = 0.0;
    int k;
    for (k = 0; k < c->unknowns; k++) {
        const double size = absolute(places[k]) / (k < n ? largest : 1.0);
        most = size <= most ? most : size; /* one that is not a number too */
    }
    return most;
}

/* h times the rule's matrix by values at the points. */
static void integrate(const Collocation *c, const double *values, double length, double *to)
{
    const int d = c->unknowns, stages = c->rule->stages;
    const double *row = c->rule->matrix;
    int i, j, k;
    for (i = 0; i < stages; i++, row += stages) {
        for (k = 0; k < d; k++) {
            double sum = 0.0;
            for (j = 0; j < stages; j++) {
                sum += row[j] * values[j * d + k];
            }
            to[i * d + k] = length * sum;
        }
    }
}

/* Places at the points from the speeds there. */
static void place_points(const Collocation *c, double length)
{
    const Radau *rule = c->rule;
    const int d = c->unknowns, stages = rule->stages;
    const double *speeds = c->start + d;
    int i, k;
    integrate(c, c->speeds, length, c->places);
    for (i = 0; i < stages; i++) {
        for (k = 0; k < d; k++) {
            c->places[i * d + k] += length * rule->nodes[i] * speeds[k];
        }
    }
}

/* Correct the speeds at the points once; what the places moved by. */
static double correct_points(const Collocation *c, double length, double largest)
{
    const Radau *rule = c->rule;
    const int d = c->unknowns, stages = rule->stages;
    double *residual = c->moved, moved = 0.0;
    int i, j, k, mode;
    for (i = 0; i < stages; i++) {
        for (k = 0; k < d; k++) {
            c->scratch[k] = c->start[k] + c->places[i * d + k];
            c->scratch[d + k] = c->start[d + k] + c->speeds[i * d + k];
        }
        accelerate(c, rule->nodes[i] * length, c->scratch, c->scratch + d, c->rates + i * d);
        keep_holds(c, i + 1);
    }
    integrate(c, c->rates, length, residual);
    for (k = 0; k < stages * d; k++) {
        residual[k] -= c->speeds[k];
    }
    for (mode = 0; mode < rule->modes; mode++) {
        const double twice = mode ? 2.0 : 1.0; /* with its conjugate */
        for (k = 0; k < d; k++) {
            Complex sum = {0.0, 0.0};
            for (j = 0; j < stages; j++) {
                sum = complex_sum(sum, complex_scaled(residual[j * d + k], rule->left[mode * stages + j]));
            }
            c->right[k] = sum;
        }
        solve_mode(c, mode);
        for (i = 0; i < stages; i++) {
            for (k = 0; k < d; k++) {
                c->speeds[i * d + k] += twice * complex_product(rule->right[mode * stages + i], c->right[k]).re;
            }
        }
    }
    copy_doubles((size_t)(stages * d), c->places, c->moved);
    place_points(c, length);
    for (k = 0; k < stages * d; k++) {
        c->moved[k] = c->places[k] - c->moved[k];
    }
    for (i = 0; i < stages; i++) {
        const double size = size_of_motion(c, c->moved + i * d, largest);
        moved = size <= moved ? moved : size;
    }
    return moved;
}

/* Slope at the start of the polynomial that is 0 there and has these values at the points. */
static double first_slope(const Collocation *c, const double *values, double length)
{
    double sum = 0.0;
    int j;
    for (j = 0; j < c->rule->stages; j++) {
        sum += c->rule->slopes[j] * values[j * c->unknowns];
    }
    return sum / length;
}

/* Error of the polynomial, from its slopes at the start, which are not those of the equations there, and damped as
   stiff motions are.  Speeds of the rotor and its shaft count by where they lead within the step, or the unit of time:
   they last, while those of weights in heavy drag die down. */
static double error_of_points(const Collocation *c, double length, double largest)
{
    const int d = c->unknowns, stations = numbers_of_stations(c->at), shaft = c->at->drive.motor ? d - 1 : d;
    const double own = length * c->rule->values[0].re;
    double *off = c->scratch, *error = off + d;
    int i, k;
    for (k = 0; k < d; k++) {
        off[k] = own * (c->start[d + k] - first_slope(c, c->places + k, length));
    }
    for (k = 0; k < d; k++) {
        double sum = c->start[2 * d + k] - first_slope(c, c->speeds + k, length);
        for (i = 0; i < d; i++) {
            sum += c->by_place[k * d + i] * off[i];
        }
        c->right[k] = complex_of(own * sum, 0.0);
    }
    solve_mode(c, 0);
    for (k = 0; k < d; k++) {
        error[k] = absolute(off[k] + own * c->right[k].re);
        if (k < stations || k == shaft) {
            error[k] = larger(error[k], smaller(length, 1.0) * absolute(c->right[k].re));
        }
    }
    return size_of_motion(c, error, largest);
}

/* Factors of all modes; 1 where one is singular. */
static int factorise_modes(const Collocation *c, double length)
{
    int k;
    for (k = 0; k < c->rule->modes; k++) {
        if (factorise_mode(c, k, length)) {
            return 1;
        }
    }
    return 0;
}

/* Derivatives and factors in the middle of the step as it is known by now. */
static int refresh_modes(const Collocation *c, double length)
{
    const int d = c->unknowns, middle = c->rule->stages / 2;
    const double time = c->rule->nodes[middle] * length;
    double *state = c->middle;
    int k;
    for (k = 0; k < d; k++) {
        state[k] = c->start[k] + c->places[middle * d + k];
        state[d + k] = c->start[d + k] + c->speeds[middle * d + k];
    }
    accelerate(c, time, state, state + d, state + 2 * d);
    differentiate_all(c, time, state);
    return factorise_modes(c, length);
}

double collocation_solve(Collocation *c, double length, double tolerance, double largest)
{
    const double enough = larger(LEFT_BY_PASSES * tolerance, ROUNDING_OF_PASSES);
    const int renewed = c->at->carried ? 0 : 1; /* passes with the derivatives at the start */
    double before = infinity();
    int k;
    differentiate_all(c, 0.0, c->start);
    if (factorise_modes(c, length)) {
        return infinity();
    }
    fill_doubles((size_t)(c->rule->stages * c->unknowns), 0.0, c->speeds);
    place_points(c, length);
    for (k = 0; k < MOST_PASSES; k++) {
        const double moved = correct_points(c, length, largest), left = moved / before;
        c->passes = k + 1;
        /* with the same derivatives a pass leaves as much of the next as of the one before */
        if (moved <= enough || (k > renewed && left < 1.0 && moved * left <= enough * (1.0 - left))) {
            return error_of_points(c, length, largest) / tolerance;
        }
        if (!(k < 2 || left <= SLOWEST_PASSES)) {
            break;
        }
        before = moved;
        if (k < renewed && refresh_modes(c, length)) {
            break;
        }
    }
    return infinity();
}

double collocation_factor(const Collocation *c, double error)
{
    const double most = c->passes > MANY_PASSES ? 1.0 : MOST_FACTOR;
    if (!is_finite(error)) { /* the passes did not come together */
        return UNSOLVED_FACTOR;
    }
    return larger(LEAST_FACTOR,
                  smaller(most, CAUTION * machine_root(larger(error, 1e-12), 1.0, c->rule->stages + 1)));
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
