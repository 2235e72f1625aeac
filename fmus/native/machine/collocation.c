/* Newton's method for a step of a stiff machine: its points, their passes and its error. */
#include "machine/collocation.h"

#include "base/elementary.h"
#include "base/matrix.h"

enum { MOST_PASSES = 14, MANY_PASSES = 10 };
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

/* The part of the unknowns that is displacements over `largest`, the rest over 1: its largest number. */
static double size_of_motion(const Collocation *c, const double *places, double largest)
{
    const int n = c->displacements;
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
        collocation_accelerate(c, rule->nodes[i] * length, c->scratch, c->scratch + d, c->rates + i * d);
        collocation_keep_holds(c, i + 1);
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
        collocation_solve_mode(c, mode);
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
    const int d = c->unknowns, stations = c->displacements, shaft = c->at->drive.motor ? d - 1 : d;
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
    collocation_solve_mode(c, 0);
    for (k = 0; k < d; k++) {
        error[k] = absolute(off[k] + own * c->right[k].re);
        if (k < stations || k == shaft) {
            error[k] = larger(error[k], smaller(length, 1.0) * absolute(c->right[k].re));
        }
    }
    return size_of_motion(c, error, largest);
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
    collocation_accelerate(c, time, state, state + d, state + 2 * d);
    collocation_differentiate(c, time, state);
    return collocation_factorise(c, length);
}

double collocation_solve(Collocation *c, double length, double tolerance, double largest)
{
    const double enough = larger(LEFT_BY_PASSES * tolerance, ROUNDING_OF_PASSES);
    const int renewed = c->at->carried ? 0 : 1; /* passes with the derivatives at the start */
    double before = infinity(), left_before = 0.0;
    int k;
    collocation_differentiate(c, 0.0, c->start);
    if (collocation_factorise(c, length)) {
        return infinity();
    }
    fill_doubles((size_t)(c->rule->stages * c->unknowns), 0.0, c->speeds);
    place_points(c, length);
    for (k = 0; k < MOST_PASSES; k++) {
        const double moved = correct_points(c, length, largest), left = moved / before;
        /* with the same derivatives passes leave more and less in turn: what those of the middle leave of an error
           that is even about it is odd, and the other way round */
        const double most_left = larger(left, left_before);
        c->passes = k + 1;
        if (moved <= enough || (k > renewed && most_left < 1.0 && moved * most_left <= enough * (1.0 - most_left))) {
            return error_of_points(c, length, largest) / tolerance;
        }
        if (!(k < 2 || left <= SLOWEST_PASSES)) {
            break;
        }
        before = moved;
        left_before = k > renewed ? left : 0.0;
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
