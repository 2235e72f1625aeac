#include "weights/weights.h"

#include <stddef.h>

#include "base/elementary.h"
#include "constants.h"

enum { LAST_PHI = SIGNAL_ORDERS + 1 };
#define NEARBY 0.16 /* rad: the series of a turn by less leave out less than 1e-16 */

Weights weights_single(const Weights *weights, int k)
{
    const int n = weights->count;
    Weights one = *weights;
    one.count = 1;
    one.each = NULL;
    if (weights->each) {
        one.mass *= weights->each[k];
        one.drag *= weights->each[n + k];
        one.radius *= weights->each[2 * n + k];
    }
    return one;
}

double weights_mass_ratio(const Weights *weights, int k)
{
    return weights->each ? weights->each[k] : 1.0;
}

double weights_arm(const Weights *weights)
{
    return weights->mass * weights->track_radius *
           (weights->track_radius - (weights->kappa - 1.0) * weights->radius);
}

double weights_added_mass(const Weights *weights)
{
    return weights->each ? weights->mass * sum_of(weights->each, weights->count)
                         : weights->count * weights->mass;
}

double weights_spin_share(const Weights *weights)
{
    return (1.0 - (weights->kappa - 1.0) * weights->radius / weights->track_radius) /
           weights->kappa;
}

double weights_lever(const Weights *weights)
{
    return -1.0 / (weights->kappa * weights->track_radius);
}

double weights_damping_rate(const Weights *weights)
{
    return weights->drag / (weights->kappa * weights->mass);
}

/* e^{i theta} of the k-th weight. */
static Complex unit_of(Turned *turned, const double *angles, int k)
{
    return turned_by(turned ? turned + 2 * k : NULL, angles[k]);
}

double weights_track_radius(const Weights *weights, double angle)
{
    double rho = weights->track_radius;
    int n;
    for (n = 0; n < weights->lobes; n++) {
        const double *lobe = weights->lobe + 3 * n;
        rho += lobe[1] * rect(1.0, lobe[0] * (angle - lobe[2])).re;
    }
    return rho;
}

Complex weights_static_moment(const Weights *weights, const double *angles, Turned *turned)
{
    Complex sum = {0.0, 0.0};
    int k;
    for (k = 0; k < weights->count; k++) {
        const Complex unit = unit_of(turned, angles, k);
        double share = weights_mass_ratio(weights, k);
        if (weights->lobes) {
            share *= weights_track_radius(weights, angles[k]) / weights->track_radius;
        }
        sum = complex_sum(sum, complex_scaled(share, unit));
    }
    return complex_scaled(weights->mass * weights->track_radius, sum);
}

double weights_alignment(int count, const double *angles, Turned *turned)
{
    Complex sum = {0.0, 0.0};
    int k;
    for (k = 0; k < count; k++) {
        const Complex unit = unit_of(turned, angles, k);
        sum = complex_sum(sum, complex_product(unit, unit));
    }
    return magnitude(sum) / count;
}

void phi_functions(double z, double *phi)
{
    static const double factorials[LAST_PHI + 1] = {1.0, 1.0, 2.0, 6.0, 24.0, 120.0};
    double term, last;
    int j = LAST_PHI, k;
    if (z < -1.0) {
        phi[0] = natural_exp(z);
        for (k = 0; k < LAST_PHI; k++) {
            phi[k + 1] = (phi[k] - 1.0 / factorials[k]) / z;
        }
        return;
    }
    /* upward recursion loses digits for small |z|: sum the last one, the others follow downward */
    term = last = 1.0 / factorials[LAST_PHI];
    while (absolute(term) > 1e-18 * last) {
        j++;
        term *= z / j;
        last += term;
    }
    phi[LAST_PHI] = last;
    for (k = LAST_PHI - 1; k >= 0; k--) {
        phi[k] = z * phi[k + 1] + 1.0 / factorials[k];
    }
}

Quadrature quadrature_empty(void)
{
    Quadrature empty = {-1.0, -1.0, {0.0}};
    return empty;
}

const double *quadrature(Quadrature *memory, double damping_rate, double step)
{
    double phi[LAST_PHI + 1], power = 1.0;
    int k;
    if (memory->damping_rate != damping_rate || memory->step != step) {
        phi_functions(-damping_rate * step, phi);
        for (k = 0; k < LAST_PHI; k++) {
            memory->response[k] = power * phi[k];
            power *= step;
            memory->response[LAST_PHI + k] = power * phi[k + 1];
        }
        memory->damping_rate = damping_rate;
        memory->step = step;
    }
    return memory->response;
}

Driven driven_by(const Instant *now, double spin_share)
{
    const Driven driven = {{now->motion[0], now->motion[1]},
                           {spin_share * now->spin.rates[0], spin_share * now->spin.rates[1]}};
    return driven;
}

void find_forcing(const Driven *by, Complex direction, double angle_rate, double *forcing)
{
    const Complex along = complex_product(by->motion[0], direction);
    const Complex slope = complex_product(by->motion[1], direction);
    forcing[0] = along.im - by->lag[0];
    forcing[1] = slope.im - along.re * angle_rate - by->lag[1];
}

/* rect(lever, -angle) from `direction`, the same `moved` radians before: a small turn is cheap. */
static Complex direction_at(Complex direction, double moved, double lever, double angle)
{
    const double z = moved * moved, zz = z * z;
    double c, s;
    if (!(absolute(moved) < NEARBY)) {
        return rect(lever, -angle);
    }
    /* in pairs of terms: a short chain of sums takes half as long */
    c = (1.0 - z * (1.0 / 2.0)) + zz * ((1.0 / 24.0 - z * (1.0 / 720.0)) +
                                        zz * (1.0 / 40320.0 - z * (1.0 / 3628800.0)));
    s = (1.0 - z * (1.0 / 6.0)) + zz * ((1.0 / 120.0 - z * (1.0 / 5040.0)) + zz * (1.0 / 362880.0));
    return complex_product(direction, complex_of(c, -moved * s));
}

int weights_substep(double *angle, double *angle_rate, const Driven *start, const Driven *end,
                    double lever, Complex unit, const double *response, double step,
                    Failure *failure)
{
    const Complex direction = complex_scaled(lever, complex_conjugate(unit));
    const double *s = response + 1, *t = s + SIGNAL_ORDERS + 1; /* to the forcing's derivatives */
    const double from = *angle;
    double begin[2], reached[2], second, third, free_rate, free_angle, new_rate, new_angle;
    double change = 1.0; /* a weight moves less than 0.15 rad in a substep: it contracts fast */
    int iteration;
    find_forcing(start, direction, *angle_rate, begin);
    free_rate = response[0] * *angle_rate + s[0] * begin[0] + s[1] * begin[1];
    free_angle = from + t[-1] * *angle_rate + t[0] * begin[0] + t[1] * begin[1];
    new_angle = free_angle;
    new_rate = free_rate;
    for (iteration = 0; iteration < MAX_ITERATIONS; iteration++) {
        const double last_angle = new_angle, last_rate = new_rate, last_change = change;
        find_forcing(end, direction_at(direction, new_angle - from, lever, new_angle), new_rate,
                     reached);
        hermite(begin[0], begin[1], reached[0], reached[1], step, &second, &third);
        new_rate = free_rate + s[2] * second + s[3] * third;
        new_angle = free_angle + t[2] * second + t[3] * third;
        change = absolute(new_angle - last_angle) + absolute(new_rate - last_rate) * step;
        if (converged(change, last_change, new_angle)) {
            *angle = new_angle;
            *angle_rate = new_rate;
            return FINE;
        }
    }
    return fail(failure, "the weights' step of %6 s did not converge (angle %6 rad, rate %6 rad/s, "
                "acceleration %6 m/s^2): use smaller communication steps",
                step, *angle, *angle_rate, magnitude(start->motion[0]));
}

int converged(double change, double last_change, double angle)
{
    const double rounding = SUBSTEP_CONVERGED * (1.0 + absolute(angle));
    return change * change <= rounding * (last_change > 0.0 ? smaller(last_change, 1.0) : change);
}

double largest_of(int count, const double *values)
{
    double largest = absolute(values[0]);
    int k;
    for (k = 1; k < count; k++) {
        largest = larger(largest, absolute(values[k]));
    }
    return largest;
}

double fastest_rate(int count, const double *speeds, const Complex *signal, double lever,
                    double lag, double damping_rate, double step, double *strongest)
{
    /* value and slope only: corrector passes change the rest, and must not change the substeps */
    const double strength = magnitude(signal[0]) + step * magnitude(signal[1]);
    /* a run-up leaves free weights behind: they gain s w' * step, or what the drag lets them */
    const double gained = absolute(lag) * (damping_rate * step < 1.0 ? step : 1.0 / damping_rate);
    *strongest = strength;
    return largest_of(count, speeds) + square_root(-strength * lever) + gained;
}

/* Whole turns that are taken off a far angle while a step is computed [rad]: the iteration's end is
   judged by the angle, and turns behind a weight must not loosen it. */
static double turns_behind(double angle)
{
    return absolute(angle) > FAR_ANGLE ? TAU * nearest(angle / TAU) : 0.0;
}

/* Substeps that a step is taken in; 0 for angles that are not finite, and for too many. */
static int count_substeps(const Weights *weights, const double *angles, const double *speeds,
                          const CentreMotion *motion, double step, Failure *failure)
{
    const double lag = weights_spin_share(weights) * motion->spin.rates[0];
    double strongest, turns;
    const double fastest =
        fastest_rate(weights->count, speeds, motion->signal, weights_lever(weights), lag,
                     weights_damping_rate(weights), step, &strongest);
    if (!is_finite(sum_of(angles, weights->count))) {
        fail(failure, "the weights' angles %l are not finite", angles, (size_t)weights->count);
        return 0;
    }
    turns = step * fastest / TURN_PER_SUBSTEP;
    if (!(turns < MAX_SUBSTEPS)) {
        fail(failure, TOO_MANY_SUBSTEPS, turns, step, strongest, largest_of(weights->count, speeds));
        return 0;
    }
    return 1 + (int)turns;
}

static Driven driven_at(const CentreMotion *motion, double share, double time)
{
    const Instant now = find_instant(motion, time);
    return driven_by(&now, share);
}

int weights_advance(const Weights *weights, const double *angles, const double *speeds,
                    const CentreMotion *motion, double step, double *new_angles,
                    double *new_speeds, Quadrature *memory, Turned *turned, Failure *failure)
{
    const double lever = weights_lever(weights), share = weights_spin_share(weights);
    const double damping_rate = weights_damping_rate(weights);
    const double *response;
    Driven begin, first; /* at the end of the first substep, mostly the only one */
    double h;
    int k, j, count, code = FINE;
    for (k = 0; weights->each && k < weights->count && !code; k++) {
        const Weights one = weights_single(weights, k);
        code = weights_advance(&one, angles + k, speeds + k, motion, step,
                               new_angles + k, new_speeds + k, memory,
                               turned ? turned + 2 * k : NULL, failure);
    }
    if (weights->each) {
        return code;
    }
    count = count_substeps(weights, angles, speeds, motion, step, failure);
    if (!count) {
        return failure->code;
    }
    h = count > 1 ? step / count : step;
    response = quadrature(memory, damping_rate, h);
    begin = driven_at(motion, share, 0.0);
    first = driven_at(motion, share, h);
    for (k = 0; k < weights->count && !code; k++) {
        const double behind = turns_behind(angles[k]);
        double angle = angles[k] - behind, speed = speeds[k];
        Driven ends[2];
        const Driven *start = &begin, *end = &first;
        for (j = 1; j <= count && !code; j++, start = end, end = ends + j % 2) {
            const Complex unit = turned_by(turned ? turned + 2 * k : NULL, angle);
            if (j > 1) {
                ends[j % 2] = driven_at(motion, share, j * h);
            }
            code = weights_substep(&angle, &speed, start, end, lever, unit, response, h, failure);
        }
        new_angles[k] = angle + behind;
        new_speeds[k] = speed;
    }
    return code;
}

void add_derivatives(Complex unit, const double *rates, Complex *sums)
{
    const double nu = rates[0], nu_1 = rates[1], nu_2 = rates[2], squared = nu * nu;
    const Complex factors[3] = { /* derivatives of e^{i theta} of order 1 to 3, over it */
        {0.0, nu}, {-squared, nu_1}, {-3.0 * nu * nu_1, nu_2 - nu * squared}};
    int k;
    sums[0] = complex_sum(sums[0], unit);
    for (k = 1; k < 4; k++) {
        sums[k] = complex_sum(sums[k], complex_product(factors[k - 1], unit));
    }
}

void find_force(double moment, const Complex *u, const Spin *spin, Complex *force)
{
    const double w = spin->speed, w1 = spin->rates[0], w2 = spin->rates[1];
    const Complex coriolis = complex_of(0.0, 2.0 * w);
    /* with the derivatives u[k] of u = sum e^(i angle), the force is -moment times
           u'' + 2 i w u' + (i w' - w^2) u,
       and its slope -moment times
           u''' + 2 i w u'' + (3 i w' - w^2) u' + (i w'' - 2 w w') u */
    Complex value = complex_sum(u[2], complex_product(coriolis, u[1]));
    Complex slope = complex_sum(u[3], complex_product(coriolis, u[2]));
    value = complex_sum(value, complex_product(complex_of(-w * w, w1), u[0]));
    slope = complex_sum(slope, complex_product(complex_of(-w * w, 3.0 * w1), u[1]));
    slope = complex_sum(slope, complex_product(complex_of(-2.0 * w * w1, w2), u[0]));
    force[0] = complex_scaled(-moment, value);
    force[1] = complex_scaled(-moment, slope);
}

void weights_reaction(const Weights *weights, const double *angles, const double *speeds,
                      const Instant *now, Complex *force, Turned *turned)
{
    const double lever = weights_lever(weights);
    Complex sums[4] = {{0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}};
    double damping_rate = 0.0;
    Driven by;
    int k;
    for (k = 0; k < weights->count; k++) {
        Complex unit = unit_of(turned, angles, k);
        double forcing[2], rates[3];
        if (!k || weights->each) {
            const Weights one = weights_single(weights, k);
            damping_rate = weights_damping_rate(&one);
            by = driven_by(now, weights_spin_share(&one));
        }
        find_forcing(&by, complex_scaled(lever, complex_conjugate(unit)), speeds[k], forcing);
        rates[0] = speeds[k];
        rates[1] = forcing[0] - damping_rate * rates[0];
        rates[2] = forcing[1] - damping_rate * rates[1];
        if (weights->each) {
            unit = complex_scaled(weights->each[k], unit);
        }
        add_derivatives(unit, rates, sums);
    }
    find_force(weights->mass * weights->track_radius, sums, &now->spin, force);
}

void weights_unhindered(const Weights *weights, const double *angles, const double *speeds,
                        const Instant *now, double *turned)
{
    int k;
    turned[0] = turned[1] = 0.0;
    for (k = 0; k < weights->count; k++) {
        const Weights one = weights_single(weights, k);
        const double arm = weights_arm(&one) / weights_arm(weights);
        const double damping_rate = weights_damping_rate(&one);
        const Driven by = driven_by(now, weights_spin_share(&one));
        double forcing[2], bend;
        find_forcing(&by, rect(weights_lever(&one), -angles[k]), speeds[k], forcing);
        bend = forcing[0] - damping_rate * speeds[k];
        turned[0] += arm * bend;
        turned[1] += arm * (forcing[1] - damping_rate * bend);
    }
}

void weights_torque(const Weights *weights, const double *angles, const double *speeds,
                    const Instant *now, double *torque)
{
    const double size = weights->track_radius, *spin_up = now->spin.rates;
    int k;
    torque[0] = torque[1] = 0.0;
    for (k = 0; k < weights->count; k++) {
        const Weights one = weights_single(weights, k);
        const double drag = one.drag * size * size, body = one.radius;
        const double rolling = (one.kappa - 1.0) * one.mass * (size + body);
        double turned[2];
        weights_unhindered(&one, angles + k, speeds + k, now, turned);
        torque[0] += drag * speeds[k] - rolling * (body * spin_up[0] - size * turned[0]);
        torque[1] += drag * turned[0] - rolling * (body * spin_up[1] - size * turned[1]);
    }
}
