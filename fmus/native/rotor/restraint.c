#include "rotor/restraint.h"

#include "base/elementary.h"

#define STATE_ROUNDING 1e-12 /* of forces and of the gap: less does not change the state of a stop */

void restraint_displacement(const double *rows, int n, const double *stations, double *displacement)
{
    int i;
    displacement[0] = displacement[1] = 0.0;
    for (i = 0; i < n; i++) {
        displacement[0] += rows[2 * i] * stations[2 * i];
        displacement[1] += rows[2 * i + 1] * stations[2 * i + 1];
    }
}

/* -- one state -------------------------------------------------------------------------------------- */

void cubic_force(const CubicSpring *spring, const double *d, double *force)
{
    const double x = d[0] * d[0], y = d[1] * d[1], both = x + y;
    force[0] = -spring->stiffness[0] * (spring->is_radial ? both : x) * d[0];
    force[1] = -spring->stiffness[spring->is_radial ? 0 : 1] * (spring->is_radial ? both : y) * d[1];
}

double stop_pressure(const Stop *stop, const double *d, const double *v)
{
    const double r = hypotenuse(d[0], d[1]);
    const double rate = r > 0.0 ? (d[0] * v[0] + d[1] * v[1]) / r : 0.0;
    return stop->stiffness * (r - stop->gap) + stop->damping * rate;
}

double stop_pressure_rate(const Stop *stop, const double *d, const double *v, const double *a)
{
    const double r = hypotenuse(d[0], d[1]);
    const double rate = r > 0.0 ? (d[0] * v[0] + d[1] * v[1]) / r : 0.0;
    const double bend = r > 0.0 ? (d[0] * a[0] + d[1] * a[1] + v[0] * v[0] + v[1] * v[1] - rate * rate) / r : 0.0;
    return stop->stiffness * rate + stop->damping * bend;
}

double stop_rounding(const Stop *stop, const double *d, const double *v)
{
    return STATE_ROUNDING * (stop->stiffness * hypotenuse(d[0], d[1]) + stop->damping * hypotenuse(v[0], v[1]));
}

int stop_state_of(const Stop *stop, const double *d, const double *v, int state)
{
    const double r = hypotenuse(d[0], d[1]), beyond = r - stop->gap, near = STATE_ROUNDING * stop->gap;
    const double outwards = d[0] * v[0] + d[1] * v[1], pressure = stop_pressure(stop, d, v);
    const double rounding = stop_rounding(stop, d, v);
    if (beyond < -near) {
        return STOP_APART;
    }
    if (beyond <= near) {
        return outwards > 0.0 || (state == STOP_PRESSES && pressure >= -rounding) ? STOP_PRESSES : STOP_APART;
    }
    if (absolute(pressure) <= rounding && state != STOP_APART) {
        return state;
    }
    return pressure >= 0.0 ? STOP_PRESSES : STOP_BEYOND;
}

void stop_force(const Stop *stop, int state, const double *d, const double *v, double *force)
{
    const double r = hypotenuse(d[0], d[1]);
    const double pressure = state == STOP_PRESSES ? larger(0.0, stop_pressure(stop, d, v)) : 0.0;
    force[0] = force[1] = 0.0;
    if (pressure > 0.0) {
        force[0] = -pressure * d[0] / r;
        force[1] = -pressure * d[1] / r;
    }
}

/* -- series ----------------------------------------------------------------------------------------- */

size_t restraint_series_size(int coefficients)
{
    return 8 * (size_t)coefficients;
}

RestraintSeries restraint_series_in(double *memory, int coefficients)
{
    RestraintSeries made;
    made.displacement = memory;
    made.square = made.displacement + 2 * coefficients;
    made.direction = made.square + 2 * coefficients;
    made.distance = made.direction + 2 * coefficients;
    made.pressure = made.distance + coefficients;
    return made;
}

void restraint_displace(RestraintSeries *s, int k, const double *displacement)
{
    const double *d = s->displacement;
    double x = 0.0, y = 0.0;
    int j;
    s->displacement[2 * k] = displacement[0];
    s->displacement[2 * k + 1] = displacement[1];
    for (j = 0; j <= k; j++) {
        x += d[2 * j] * d[2 * (k - j)];
        y += d[2 * j + 1] * d[2 * (k - j) + 1];
    }
    s->square[2 * k] = x;
    s->square[2 * k + 1] = y;
}

double restraint_square(const RestraintSeries *s, int k)
{
    return s->square[2 * k] + s->square[2 * k + 1];
}

/* Coefficient k of r where r is above 0. */
static void add_distance(RestraintSeries *s, int k)
{
    double *r = s->distance, sum = restraint_square(s, k);
    int j;
    if (k == 0) {
        r[0] = square_root(sum);
        return;
    }
    for (j = 1; j < k; j++) {
        sum -= r[j] * r[k - j];
    }
    r[k] = 0.5 * sum / r[0];
}

void cubic_series_force(const CubicSpring *spring, const RestraintSeries *s, int k, double *force)
{
    double x = 0.0, y = 0.0;
    int j;
    for (j = 0; j <= k; j++) {
        const double *square = s->square + 2 * j, *d = s->displacement + 2 * (k - j);
        const double both = square[0] + square[1];
        x += (spring->is_radial ? both : square[0]) * d[0];
        y += (spring->is_radial ? both : square[1]) * d[1];
    }
    force[0] = -spring->stiffness[0] * x;
    force[1] = -spring->stiffness[spring->is_radial ? 0 : 1] * y;
}

void stop_series_pressure(const Stop *stop, RestraintSeries *s, int k)
{
    if (k == 0) {
        add_distance(s, 0);
    }
    add_distance(s, k + 1);
    s->pressure[k] = stop->stiffness * (s->distance[k] - (k == 0 ? stop->gap : 0.0)) +
                     stop->damping * (k + 1) * s->distance[k + 1];
}

void stop_series_force(const Stop *stop, RestraintSeries *s, int k, double *force)
{
    double *n = s->direction;
    int j, axis;
    stop_series_pressure(stop, s, k);
    for (axis = 0; axis < 2; axis++) {
        double sum = s->displacement[2 * k + axis];
        for (j = 1; j <= k; j++) {
            sum -= s->distance[j] * n[2 * (k - j) + axis];
        }
        n[2 * k + axis] = sum / s->distance[0];
        sum = 0.0;
        for (j = 0; j <= k; j++) {
            sum += s->pressure[j] * n[2 * (k - j) + axis];
        }
        force[axis] = -sum;
    }
}

/* A polynomial of this order, with its first two derivatives in the others. */
static double polynomial_at(const double *coefficients, int order, double time, double *slope, double *bend)
{
    double sum = coefficients[order];
    int k;
    *slope = *bend = 0.0;
    for (k = order - 1; k >= 0; k--) {
        *bend = *bend * time + 2.0 * *slope;
        *slope = *slope * time + sum;
        sum = sum * time + coefficients[k];
    }
    return sum;
}

double largest_of_series(const double *coefficients, int order, double until)
{
    enum { SERIES_LOOKS = 16, TOP_STEPS = 8 };
    double largest = -infinity(), slope, bend, top = 0.0;
    int k;
    for (k = 0; k <= SERIES_LOOKS; k++) {
        const double time = until * k / SERIES_LOOKS, found = polynomial_at(coefficients, order, time, &slope, &bend);
        if (found > largest) {
            largest = found;
            top = time;
        }
    }
    for (k = 0; k < TOP_STEPS; k++) { /* Newton's, where the slope is 0 */
        const double found = polynomial_at(coefficients, order, top, &slope, &bend);
        largest = larger(largest, found);
        if (!(bend < 0.0)) {
            break;
        }
        top = smaller(until, larger(0.0, top - slope / bend));
    }
    return largest;
}
