/* Order and length of a step by series, and the motion in it. */
#include "machine/machine.h"

#include <stdint.h>
#include <string.h>

#include "base/elementary.h"
#include "base/roots.h"
#include "constants.h"

enum { LOOKS = 32 }; /* in a step, for a speed that leaves its line of the motor's torque */
#define BRACKET 1e-15 /* of a step: where it does */

int machine_order(double tolerance)
{
    /* about 1.7 orders for every digit: a step then costs least for its length */
    const double digits = -0.30102999566398120 * binary_exponent(tolerance);
    const int order = (int)(2.5 + 1.7 * digits);
    return order < LEAST_ORDER ? LEAST_ORDER : order > MOST_ORDER ? MOST_ORDER : order;
}

/* Read off the exponents as straight lines between powers of two. */
double machine_root(double term, double tolerance, int k)
{
    int64_t above, below, one;
    const double unit = 1.0;
    double root;
    memcpy(&above, &tolerance, sizeof above);
    memcpy(&below, &term, sizeof below);
    memcpy(&one, &unit, sizeof one);
    one += (int64_t)((double)(above - below) / k);
    memcpy(&root, &one, sizeof root);
    return root;
}

static Terms terms_of(const Machine *m, int k, double per_largest)
{
    const Pair *motion = m->motion + k * m->width;
    Terms most = {0.0, 0.0};
    double finite = 0.0;
    int i;
    for (i = 0; i < m->width; i++) {
        const double x = absolute(pair_x(motion[i])), y = absolute(pair_y(motion[i]));
        if (i < m->stations) {
            most.rotor = larger(most.rotor, per_largest * larger(x, y));
        } else {
            most.weights = larger(most.weights, larger(x, y));
        }
        finite += 0.0 * x + 0.0 * y; /* a comparison with NaN is false: `larger` does not see it */
    }
    if (m->drive.motor) {
        most.rotor = larger(most.rotor, absolute(m->speed[k - 1]) / k);
    }
    most.rotor += finite;
    most.weights += finite;
    return most;
}

/* The length of a step, at most `length`, over which a term of this order is so much. */
static double shortened(double length, double term, double tolerance, int order)
{
    return term > SMALLEST_TERM * tolerance ? smaller(length, machine_root(term, tolerance, order)) : length;
}

/* A step in which the rotor turns at most `most` [rad], where its speed is far beyond that of the unit of time. */
static double length_of_turn(const Machine *m, int order, double length, double most)
{
    while (length > 0.0 && !(absolute(machine_turned(m, order, length)) <= most)) {
        length *= 0.5;
    }
    return length;
}

double machine_length_of_terms(const Machine *m, int order, const Terms *terms, double tolerance, bool is_stiff)
{
    double length = LONGEST_STEP, finite = 0.0;
    int k;
    for (k = order - 1; k <= order; k++, terms++) {
        const bool is_short = is_stiff && terms->rotor > tolerance; /* in a step of 1 it is more */
        finite += terms->rotor + terms->weights;
        length = shortened(length, terms->weights, tolerance, k);
        length = shortened(length, terms->rotor, tolerance, is_short ? k - 1 : k);
    }
    return is_finite(finite) ? length_of_turn(m, order, length, MOST_TURN) : not_a_number();
}

double machine_length(const Machine *m, int order, double tolerance, double largest, bool is_stiff)
{
    const double per_largest = 1.0 / largest;
    const Terms terms[2] = {terms_of(m, order - 1, per_largest), terms_of(m, order, per_largest)};
    return machine_length_of_terms(m, order, terms, tolerance, is_stiff);
}

/* The sum of a series, whose coefficients stand `stride` pairs apart, up to an order at a time. */
#define SUM series_at
#define Sum Pair
#define Time double
#define Coefficient Pair
#define AT(at) (*(at))
#define PLUS(a, b) pair_sum(a, b)
#define TIMES(a, time) pair_scaled(a, time)
#include "base/series_sum_template.h"

/* The sum of Chebyshev's polynomials with these coefficients in a step by collocation: Clenshaw's recurrence. */
static Pair collocated_at(const Machine *m, const Pair *coefficients, int stride, double time)
{
    const double x = 2.0 * time / m->collocated_length - 1.0;
    const Pair twice = pair_both(2.0 * x);
    Pair sum = pair_zero(), before = sum;
    int k;
    for (k = m->collocated_order; k > 0; k--) {
        const Pair next = pair_add_times(pair_difference(coefficients[k * stride], before), sum, twice);
        before = sum;
        sum = next;
    }
    return pair_add_times(pair_difference(coefficients[0], before), sum, pair_both(x));
}

Pair machine_place(const Machine *m, int column, int order, double time)
{
    const Pair *series = m->motion + column;
    return m->collocated_order ? collocated_at(m, series, m->width, time) : series_at(series, m->width, order, time);
}

void machine_places(const Machine *m, int column, int order, const double *times, int count, double *x, double *y)
{
    const double *series = (const double *)(m->motion + column);
    int k;
    if (m->lanes && !m->collocated_order) {
        m->lanes->sum_beside(series, 2 * m->width, order, times, count, x, y);
        return;
    }
    for (k = 0; k < count; k++) {
        const Pair place = machine_place(m, column, order, times[k]);
        x[k] = pair_x(place);
        y[k] = pair_y(place);
    }
}

Pair machine_velocity(const Machine *m, int column, int order, double time)
{
    const Pair *series = m->velocity + column;
    return m->collocated_order ? collocated_at(m, series, m->width, time)
                               : series_at(series, m->width, order - 1, time);
}

void machine_reach_end(Machine *m, int order, double time)
{
    int i;
    if (m->lanes && !m->collocated_order) {
        m->lanes->reach_end(m, order, time);
        return;
    }
    for (i = 0; i < m->width; i++) {
        const Pair q = machine_place(m, i, order, time);
        m->velocity[i] = machine_velocity(m, i, order, time);
        m->motion[i] = q;
    }
}

double machine_speed_at(const Machine *m, int order, double time)
{
    const int last = m->drive.motor ? order - 1 : 1;
    double speed = m->speed[last];
    int k;
    if (m->collocated_order && m->drive.motor) {
        return pair_x(collocated_at(m, m->shaft, 1, time));
    }
    for (k = last - 1; k >= 0; k--) {
        speed = speed * time + m->speed[k];
    }
    return speed;
}

double machine_turned(const Machine *m, int order, double time)
{
    const int last = m->drive.motor ? order - 1 : 1;
    double angle = m->speed[last] * m->per[last + 1];
    int k;
    if (m->collocated_order && m->drive.motor) {
        return pair_y(collocated_at(m, m->shaft, 1, time));
    }
    for (k = last - 1; k >= 0; k--) {
        angle = angle * time + m->speed[k] * m->per[k + 1];
    }
    return angle * time;
}

/* What the line goes to beyond its end, and how far the speed is from there. */
typedef struct {
    const Machine *machine;
    int order;
    double end, sign;
} LineEnd;

static double short_of_end(void *context, double time)
{
    const LineEnd *line = context;
    return line->sign * (line->end - machine_speed_at(line->machine, line->order, time));
}

int machine_leaves_line(const Machine *m, int order, const double *ends, double *length)
{
    const double until = *length;
    LineEnd line = {m, order, 0.0, 0.0};
    int look;
    for (look = 1; look <= LOOKS; look++) {
        const double time = until * look / LOOKS, speed = machine_speed_at(m, order, time);
        line.sign = speed > ends[1] ? 1.0 : speed < ends[0] ? -1.0 : 0.0;
        if (line.sign != 0.0) {
            line.end = line.sign > 0.0 ? ends[1] : ends[0];
            *length = find_crossing(short_of_end, &line, larger(0.0, short_of_end(&line, 0.0)), time,
                                    BRACKET * time);
            return (int)line.sign;
        }
    }
    return 0;
}
