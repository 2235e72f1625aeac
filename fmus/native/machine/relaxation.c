#include "machine/relaxation.h"

#include "base/elementary.h"

enum { MOST_ITERATIONS = 12, MOST_TERMS = 120 };
#define LEFT_BY_ITERATION 0.02 /* of the tolerance */
#define SLOWEST_ITERATION 0.5  /* what one leaves of the one before, at most */
#define SUMMED_FALL 20.0       /* of d t: beyond, integrals follow from each other without a loss of digits */
#define CLEAR_PART 0.05        /* of e^{-d t}: below, the polynomial has nearly all of it */
#define LAST_POWER 4e-3        /* of the last power: 2^-11 is what it has beyond lower ones, eight times for safety */

int relaxation_allocate(Unit *unit, Relaxation *r, int weights)
{
    const Radau *rule = &RADAU_SEVEN;
    const int n = RELAXED_POINTS;
    int i, j, k;
    r->of = unit_allocate(unit, (size_t)weights, sizeof *r->of);
    r->ends = unit_allocate(unit, 2 * (size_t)weights, sizeof(double));
    for (k = 0; k < n; k++) { /* the slope of the polynomial through the integrals up to the points */
        for (j = 0; j < n; j++) {
            double sum = 0.0;
            for (i = 0; i < n; i++) {
                sum += rule->powers[k * n + i] * rule->matrix[i * n + j];
            }
            r->powers[k][j] = (k + 1) * sum;
        }
    }
    return !r->of || !r->ends;
}

/* -- integrals -------------------------------------------------------------------------------------------- */

/* Integrals of e^{-d (t - s)} (s/h)^k ds up to t = share h. */
static void integrate_powers(double drag, double length, double share, double *to)
{
    const double time = share * length, fallen = drag * time, left = natural_exp(-fallen);
    double power = 1.0;
    int j, k;
    for (k = 0; k < RELAXED_POINTS; k++, power *= share) {
        double term = 1.0, sum = 0.0;
        if (fallen > SUMMED_FALL) {
            to[k] = ((k ? power : 1.0 - left) - (k ? k / length * to[k - 1] : 0.0)) / drag;
            continue;
        }
        for (j = 0; j < MOST_TERMS && term > 1e-17 * sum; j++) { /* none is negative */
            sum += term / (j + k + 1);
            term *= fallen / (j + 1);
        }
        to[k] = time * power * left * sum;
    }
}

static void prepare(const Relaxation *r, Relaxed *made, double drag, double length)
{
    const int n = RELAXED_POINTS;
    const double *nodes = RADAU_SEVEN.nodes;
    double integrals[RELAXED_POINTS], start = 0.0;
    int i, j, k;
    made->drag = drag;
    made->length = length;
    for (i = 0; i < n; i++) {
        const double time = nodes[i] * length;
        double power = 1.0;
        made->fall[i] = natural_exp(-drag * time);
        integrate_powers(drag, length, nodes[i], integrals);
        made->coasted[i] = integrals[0];
        made->falling[i] = (integrals[0] - time * made->fall[i]) / drag;
        for (j = 0; j < n; j++) {
            made->places[i][j] = made->speeds[j] = 0.0;
        }
        for (k = 0; k < n; k++, power *= nodes[i]) {
            const double place = (time * power / (k + 1) - integrals[k]) / drag;
            for (j = 0; j < n; j++) {
                made->places[i][j] += place * r->powers[k][j];
                made->speeds[j] += integrals[k] * r->powers[k][j]; /* of the last point in the end */
            }
        }
    }
    for (j = 0; j < n; j++) {
        start += r->powers[0][j] * made->fall[j];
    }
    made->part = 1.0 - start;
}

/* -- N ------------------------------------------------------------------------------------------------------ */

/* How the plane moves at the start and the points. */
static void watch_plane(Relaxation *r, Machine *m, double length)
{
    const Carried start = *m->carried;
    const MachineTrack *track = m->tracks;
    int i;
    for (i = 0; i <= RELAXED_POINTS; i++) {
        machine_carry(m, &start, i ? RADAU_SEVEN.nodes[i - 1] * length : 0.0);
        r->felt[i] = m->carried->signal[0];
        if (track->is_off) {
            m->speed_order = m->carried->speed_order;
            r->felt[i] = pair_sum(r->felt[i], pair_product(track->offset, machine_turn_twice(m, 0)));
        }
        r->spun[i] = m->speed[1];
    }
    machine_carry(m, &start, 0.0);
}

static double push(const Relaxation *r, SeriesWeight *weight, int point, double angle)
{
    weight->rate[0] = pair_zero();
    series_weight_start(weight, angle);
    series_weight_advance(weight, 0, NULL, r->felt[point], 0.0, r->spun[point]);
    return weight->free - r->spun[point];
}

/* -- a step --------------------------------------------------------------------------------------------------- */

/* Take the part of e^{-d t} out of the values, N at the start being `first`; it. */
static double take_fall(const Relaxation *r, const Relaxed *by, double first, double *values)
{
    double start = 0.0, part = 0.0;
    int j;
    for (j = 0; j < RELAXED_POINTS; j++) {
        start += r->powers[0][j] * values[j];
    }
    if (by->part > CLEAR_PART) {
        part = (first - start) / by->part;
        for (j = 0; j < RELAXED_POINTS; j++) {
            values[j] -= part * by->fall[j];
        }
    }
    return part;
}

/* What is left out, about: the last power, and what the part of e^{-d t} does in its turn. */
static double error_of(const Relaxation *r, const Relaxed *by, const double *values, double part, double first,
                       double speed, double slope)
{
    const double square = by->drag * by->drag, fallen = absolute(speed - first / by->drag) / by->drag;
    double last = 0.0;
    int j;
    for (j = 0; j < RELAXED_POINTS; j++) {
        last += r->powers[RELAXED_POINTS - 1][j] * values[j];
    }
    return (LAST_POWER * absolute(last) + absolute(part) * (slope / square + fallen)) / square;
}

/* Move one weight; its error [rad]. */
static double move_weight(const Relaxation *r, SeriesWeight *weight, const Relaxed *by, double angle, double speed,
                          double enough, double *end)
{
    const int n = RELAXED_POINTS;
    const double first = push(r, weight, 0, angle);
    double values[RELAXED_POINTS], angles[RELAXED_POINTS], before = infinity(), slope = 0.0;
    int i, j, k;
    for (i = 0; i < n; i++) {
        double sum = 0.0;
        for (j = 0; j < n; j++) {
            sum += by->places[i][j];
        }
        angles[i] = angle + by->coasted[i] * speed + sum * first;
        slope = larger(slope, weight->lever * hypotenuse(pair_x(r->felt[i + 1]), pair_y(r->felt[i + 1])));
    }
    for (k = 0; k < MOST_ITERATIONS; k++) {
        double moved = 0.0, part, left;
        for (i = 0; i < n; i++) {
            values[i] = push(r, weight, i + 1, angles[i]);
        }
        part = take_fall(r, by, first, values);
        for (i = 0; i < n; i++) {
            double sum = angle + by->coasted[i] * speed + part * by->falling[i];
            for (j = 0; j < n; j++) {
                sum += by->places[i][j] * values[j];
            }
            moved = absolute(sum - angles[i]) <= moved ? moved : absolute(sum - angles[i]); /* no number too */
            angles[i] = sum;
        }
        left = moved / before;
        if (moved <= enough || (k > 0 && left < 1.0 && moved * left <= enough * (1.0 - left))) {
            end[0] = angles[n - 1];
            end[1] = by->fall[n - 1] * (speed + part * by->length);
            for (j = 0; j < n; j++) {
                end[1] += by->speeds[j] * values[j];
            }
            return error_of(r, by, values, part, first, speed, slope);
        }
        if (!(k < 1 || left <= SLOWEST_ITERATION)) {
            break;
        }
        before = moved;
    }
    return infinity();
}

double relaxation_step(Relaxation *r, Machine *m, double length, double tolerance)
{
    const int n = m->weight_count, first = m->stations;
    double worst = 0.0, *angles = r->ends, *speeds = angles + n;
    Relaxed *by = r->of;
    int w;
    watch_plane(r, m, length);
    for (w = 0; w < n; w++) {
        SeriesWeight *weight = m->weights + w;
        double end[2] = {0.0, 0.0}, error;
        by = w > 0 && weight->damping_rate == m->weights[w - 1].damping_rate ? by : r->of + w;
        if (by->drag != weight->damping_rate || by->length != length) {
            prepare(r, by, weight->damping_rate, length);
        }
        error = move_weight(r, weight, by, pair_at(m->motion[first + w / 2], w % 2),
                            pair_at(m->velocity[first + w / 2], w % 2), LEFT_BY_ITERATION * tolerance, end);
        worst = error <= worst ? worst : error;
        if (!(worst <= tolerance)) {
            return worst / tolerance;
        }
        angles[w] = end[0];
        speeds[w] = end[1];
    }
    for (w = 0; w < n; w++) {
        pair_set(&m->motion[first + w / 2], w % 2, angles[w]);
        pair_set(&m->velocity[first + w / 2], w % 2, speeds[w]);
    }
    return worst / tolerance;
}
