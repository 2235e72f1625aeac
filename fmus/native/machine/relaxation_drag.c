/* What a drag makes of N in a step of one length. */
#include "base/elementary.h"
#include "machine/relaxation.h"

enum { MOST_TERMS = 120 };
#define CLEAR_PART 0.05  /* of e^{-d t}: below, the polynomial has nearly all of it */

int relaxation_allocate_rule(Unit *unit, RelaxedRule *made, const Radau *rule, int weights)
{
    const int n = rule->stages;
    int i, j, k;
    made->rule = rule;
    made->beyond = scaled_by_power(8.0, 3 - 2 * n); /* Chebyshev's polynomial of the degree s - 1 */
    made->of = unit_allocate(unit, (size_t)weights, sizeof *made->of);
    for (k = 0; k < n; k++) { /* the slope of the polynomial through the integrals up to the points */
        for (j = 0; j < n; j++) {
            double sum = 0.0;
            for (i = 0; i < n; i++) {
                sum += rule->powers[k * n + i] * rule->matrix[i * n + j];
            }
            made->powers[k][j] = (k + 1) * sum;
        }
    }
    return !made->of;
}

/* The integral of e^{-f (1 - s)} s^k from 0 to 1, whose terms are all above 0. */
static double integrate_power(double fallen, double left, int k)
{
    double term = 1.0, sum = 0.0;
    int j;
    for (j = 0; j < MOST_TERMS && term > 1e-17 * sum; j++) {
        sum += term / (j + k + 1);
        term *= fallen / (j + 1);
    }
    return left * sum;
}

/* Integrals of e^{-d (t - s)} (s/h)^k ds up to t = share h.  They follow from each other by parts, f J(k) = 1 - k J(k - 1):
   forwards where f is large, else backwards, in both of which no digit is lost. */
static void integrate_powers(int powers, double drag, double length, double share, double *to)
{
    const double time = share * length, fallen = drag * time, left = natural_exp(-fallen);
    double power = time;
    int k;
    if (fallen < powers - 1) {
        to[powers - 1] = integrate_power(fallen, left, powers - 1);
        for (k = powers - 1; k > 0; k--) {
            to[k - 1] = (1.0 - fallen * to[k]) / k;
        }
    } else {
        to[0] = (1.0 - left) / fallen;
        for (k = 1; k < powers; k++) {
            to[k] = (1.0 - k * to[k - 1]) / fallen;
        }
    }
    for (k = 0; k < powers; k++, power *= share) {
        to[k] *= power;
    }
}

/* A row of what theta or theta' has by the values of a polynomial, where `fallen` is what it has by N = e^{-d t}:
   that part is taken out of the values. */
static void take_fall(int points, const Relaxed *made, double fallen, double *row, double *first)
{
    double kept = 0.0;
    int j;
    for (j = 0; j < points; j++) {
        kept += row[j] * made->fall[j];
    }
    *first = (fallen - kept) * made->first_part;
    for (j = 0; j < points; j++) {
        row[j] += (fallen - kept) * made->part[j];
    }
}

/* The part of e^{-d t} in N, by its values at the start and the points. */
static void find_part(const RelaxedRule *by, Relaxed *made)
{
    double start = 0.0;
    int j;
    for (j = 0; j < by->rule->stages; j++) {
        start += by->powers[0][j] * made->fall[j];
    }
    made->first_part = 1.0 - start > CLEAR_PART ? 1.0 / (1.0 - start) : 0.0;
    for (j = 0; j < by->rule->stages; j++) {
        made->part[j] = -by->powers[0][j] * made->first_part;
    }
}

void relaxation_prepare(const RelaxedRule *by, Relaxed *made, double drag, double length)
{
    const int n = by->rule->stages;
    const double *nodes = by->rule->nodes;
    double integrals[RELAXED_POINTS];
    int i, j, k;
    made->drag = drag;
    made->length = length;
    made->reach = made->reach_speed = 0.0;
    for (i = 0; i < n; i++) {
        made->fall[i] = natural_exp(-drag * nodes[i] * length);
    }
    find_part(by, made);
    for (i = 0; i < n; i++) {
        const double time = nodes[i] * length;
        double power = 1.0, reach = 0.0, reach_speed = 0.0;
        integrate_powers(n, drag, length, nodes[i], integrals);
        made->coasted[i] = integrals[0];
        made->steady[i] = (time - integrals[0]) / drag;
        for (j = 0; j < n; j++) {
            made->places[i][j] = made->speeds[i][j] = 0.0;
        }
        for (k = 0; k < n; k++, power *= nodes[i]) {
            const double place = (time * power / (k + 1) - integrals[k]) / drag;
            for (j = 0; j < n; j++) {
                made->places[i][j] += place * by->powers[k][j];
                made->speeds[i][j] += integrals[k] * by->powers[k][j];
            }
        }
        take_fall(n, made, (integrals[0] - time * made->fall[i]) / drag, made->places[i], &made->first[i]);
        take_fall(n, made, time * made->fall[i], made->speeds[i], &made->first_speed[i]);
        for (j = 0; j < n; j++) {
            reach += absolute(made->places[i][j]);
            reach_speed += absolute(made->speeds[i][j]);
        }
        made->reach = larger(made->reach, reach);
        made->reach_speed = larger(made->reach_speed, reach_speed);
    }
}
