#include "weights/weights.h"

#include <stddef.h>

#include "base/cubic.h"
#include "base/elementary.h"
#include "base/spin.h"
#include "constants.h"

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

int weights_check(const Weights *weights, Failure *failure)
{
    int code, k;
    if (weights->count < 1) {
        return fail(failure, FAILURE_COUNT, "count", 0, weights->count, 0.0, 0.0, 0.0);
    }
    code = demand_positive("mass", weights->mass, failure);
    code = code ? code : demand_positive("track_radius", weights->track_radius, failure);
    code = code ? code : demand_not_negative("drag", weights->drag, failure);
    for (k = 0; weights->each && k < 3 * weights->count && !code; k++) {
        const int what = k / weights->count;
        code = what == 1 ? demand_not_negative("drag_ratio", weights->each[k], failure)
                         : demand_positive(what ? "radius_ratio" : "mass_ratio", weights->each[k],
                                           failure);
    }
    if (!code && !(is_finite(weights->kappa) && weights->kappa >= 1.0)) {
        code = fail(failure, FAILURE_KAPPA, "kappa", 0, weights->kappa, 0.0, 0.0, 0.0);
    }
    return code;
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

double weights_damping_rate(const Weights *weights)
{
    return weights->drag / (weights->kappa * weights->mass);
}

/* e^{i theta} of the k-th weight. */
static Complex unit_of(Turned *turned, const double *angles, int k)
{
    return turned_by(turned ? turned + 2 * k : NULL, angles[k]);
}

Complex weights_static_moment(const Weights *weights, const double *angles, Turned *turned)
{
    Complex sum = {0.0, 0.0};
    int k;
    for (k = 0; k < weights->count; k++) {
        const Complex unit = unit_of(turned, angles, k);
        sum = complex_sum(sum, complex_scaled(weights_mass_ratio(weights, k), unit));
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

void phi_functions(double z, int count, double *phi)
{
    double inverse = 1.0, term, last; /* inverse: 1/k! */
    int j = count, k;
    if (z < -1.0) {
        double factorial = 1.0;
        phi[0] = natural_exp(z);
        for (k = 0; k < count; k++) {
            factorial *= k ? k : 1;
            phi[k + 1] = (phi[k] - 1.0 / factorial) / z;
        }
        return;
    }
    /* upward recursion loses digits for small |z|: sum the last one, the others follow downward */
    for (k = 2; k <= count; k++) {
        inverse *= k;
    }
    term = last = 1.0 / inverse;
    while (absolute(term) > 1e-18 * last) {
        j++;
        term *= z / j;
        last += term;
    }
    phi[count] = last;
    for (k = count - 1; k >= 0; k--) {
        double factorial = 1.0;
        for (j = 2; j <= k; j++) {
            factorial *= j;
        }
        phi[k] = z * phi[k + 1] + 1.0 / factorial;
    }
}

Quadrature quadrature_empty(void)
{
    Quadrature empty = {-1.0, -1.0, {0.0}};
    return empty;
}

const double *quadrature(Quadrature *memory, double damping_rate, double step)
{
    double phi[6], power = 1.0;
    int k;
    if (memory->damping_rate != damping_rate || memory->step != step) {
        phi_functions(-damping_rate * step, 5, phi);
        for (k = 0; k < 5; k++) {
            memory->response[k] = power * phi[k]; /* of the rate: to rate, g0, g1, g2, g3 */
            power *= step;
            memory->response[5 + k] = power * phi[k + 1]; /* of the angle */
        }
        memory->damping_rate = damping_rate;
        memory->step = step;
    }
    return memory->response;
}

/* Pull along the track in this direction, and its slope. */
static void along(Complex a, Complex da, Complex direction, double speed, double *value,
                  double *slope)
{
    const Complex seen = complex_product(a, direction);
    *value = seen.im;
    *slope = complex_product(da, direction).im - seen.re * speed;
}

void along_track(Complex a, Complex da, double angle, double speed, double lever, double *value,
                 double *slope)
{
    along(a, da, rect(lever, -angle), speed, value, slope);
}

Complex direction_at(Complex direction, double moved, double lever, double angle)
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

int weights_substep(double *angle, double *angle_rate, const Complex *ends, double lever,
                    Complex unit, const double *lag, const double *response, double step,
                    Failure *failure)
{
    const double *s = response + 1, *t = response + 6; /* to g0..g3 */
    double g0, g1, free_rate, free_angle, new_rate, new_angle;
    const double start = *angle;
    const Complex direction = complex_scaled(lever, complex_conjugate(unit));
    double change = 1.0; /* a weight moves less than 0.15 rad in a substep: it contracts fast */
    int iteration;
    along(ends[0], ends[1], direction, *angle_rate, &g0, &g1);
    g0 -= lag[0];
    free_rate = response[0] * *angle_rate + s[0] * g0 + s[1] * g1;
    free_angle = *angle + response[5] * *angle_rate + t[0] * g0 + t[1] * g1;
    if (drifts(lag)) {
        free_rate -= s[1] * lag[1] + s[2] * lag[2] + s[3] * lag[3];
        free_angle -= t[1] * lag[1] + t[2] * lag[2] + t[3] * lag[3];
    }
    new_angle = free_angle;
    new_rate = free_rate;
    g0 += lag[0];
    for (iteration = 0; iteration < MAX_ITERATIONS; iteration++) {
        const double last_angle = new_angle, last_rate = new_rate, last_change = change;
        double pull, slope, g2, g3;
        along(ends[2], ends[3],
              direction_at(direction, new_angle - start, lever, new_angle), new_rate, &pull, &slope);
        hermite(g0, g1, pull, slope, step, &g2, &g3);
        new_rate = free_rate + s[2] * g2 + s[3] * g3;
        new_angle = free_angle + t[2] * g2 + t[3] * g3;
        change = absolute(new_angle - last_angle) + absolute(new_rate - last_rate) * step;
        if (converged(change, last_change, new_angle)) {
            *angle = new_angle;
            *angle_rate = new_rate;
            return FINE;
        }
    }
    return fail(failure, FAILURE_NOT_CONVERGED, "weights", 0, step, *angle, *angle_rate,
                magnitude(ends[0]));
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

double weights_turns_behind(double angle)
{
    return absolute(angle) > FAR_ANGLE ? TAU * nearest(angle / TAU) : 0.0;
}

int weights_substeps(int number, const double *angles, const double *speeds, const Complex *signal,
                     double lever, double lag, double damping_rate, double step, int *count,
                     Failure *failure)
{
    double strongest, turns;
    const double fastest =
        fastest_rate(number, speeds, signal, lever, lag, damping_rate, step, &strongest);
    if (!is_finite(sum_of(angles, number))) {
        return fail(failure, FAILURE_ANGLES, "angles", 0, 0.0, 0.0, 0.0, 0.0);
    }
    turns = step * fastest / TURN_PER_SUBSTEP;
    if (!(turns < MAX_SUBSTEPS)) {
        return fail(failure, FAILURE_SUBSTEPS, "weights", 0, turns, step, strongest,
                    largest_of(number, speeds));
    }
    *count = 1 + (int)turns;
    return FINE;
}

/* Move one weight over `count` substeps of h. */
static int advance_substeps(double *angle, double *speed, int count, double h, const Complex *signal,
                double lever, const double *lag, const double *response, Turned *turned,
                Failure *failure)
{
    const int varies = drifts(lag);
    double now[4] = {lag[0], lag[1], lag[2], lag[3]};
    Complex ends[4];
    int j, code = FINE;
    ends[0] = signal[0];
    ends[1] = signal[1];
    for (j = 1; j <= count && !code; j++) {
        ends[2] = cubic_value(signal, j * h);
        ends[3] = cubic_slope(signal, j * h);
        if (varies) {
            const double time = (j - 1) * h;
            const Drift more = drift(lag, time);
            now[0] = lag[0] + more.acceleration;
            now[1] = more.slope;
            now[2] = lag[2] + time * lag[3];
        }
        code = weights_substep(angle, speed, ends, lever, turned_by(turned, *angle), now, response,
                               h, failure);
        ends[0] = ends[2];
        ends[1] = ends[3];
    }
    return code;
}

int weights_advance(const Weights *weights, const double *angles, const double *speeds,
                    const Complex *signal, const double *spin_up, double step,
                    double *new_angles, double *new_speeds, Quadrature *memory, Turned *turned,
                    Failure *failure)
{
    const double lever = -1.0 / (weights->kappa * weights->track_radius);
    const double damping_rate = weights_damping_rate(weights);
    const int n = weights->count;
    const double *response;
    double h;
    const double share = weights_spin_share(weights);
    const double lag[4] = {share * spin_up[0], share * spin_up[1], share * spin_up[2],
                           share * spin_up[3]};
    int k, count, far, code = FINE;
    for (k = 0; weights->each && k < n && !code; k++) {
        const Weights one = weights_single(weights, k);
        code = weights_advance(&one, angles + k, speeds + k, signal, spin_up, step, new_angles + k,
                               new_speeds + k, memory, turned ? turned + 2 * k : NULL, failure);
    }
    if (weights->each) {
        return code;
    }
    code = weights_substeps(n, angles, speeds, signal, lever, lag[0], damping_rate, step, &count,
                            failure);
    if (code) {
        return code;
    }
    h = count > 1 ? step / count : step;
    response = quadrature(memory, damping_rate, h);
    /* the iteration's end is judged by the angle: turns behind a weight must not loosen it */
    far = largest_of(n, angles) > FAR_ANGLE;
    for (k = 0; k < n && !code; k++) {
        const double behind = far ? TAU * nearest(angles[k] / TAU) : 0.0;
        double angle = angles[k] - behind, speed = speeds[k];
        code = advance_substeps(&angle, &speed, count, h, signal, lever, lag, response,
                    turned ? turned + 2 * k : NULL, failure);
        new_angles[k] = angle + behind;
        new_speeds[k] = speed;
    }
    return code;
}

void weights_reaction(const Weights *weights, const double *angles, const double *speeds,
                      Complex acceleration, Complex slope, double speed,
                      double angular_acceleration, double change, Complex *force,
                      Complex *force_slope, Turned *turned)
{
    const double lever = -1.0 / (weights->kappa * weights->track_radius);
    const double damping_rate = weights_damping_rate(weights);
    const double share = weights_spin_share(weights), lag = share * angular_acceleration;
    const double scale = -weights->mass * weights->track_radius;
    const Complex turn = {0.0, 2.0 * speed}, pull = {-speed * speed, angular_acceleration};
    const Complex pull_slope = {pull.re, 3.0 * angular_acceleration};
    Complex moment = {0.0, 0.0}, first = moment, second = moment, third = moment, sum;
    int k;
    *force = *force_slope = moment;
    for (k = 0; weights->each && k < weights->count; k++) {
        const Weights one = weights_single(weights, k);
        Complex part, part_slope;
        weights_reaction(&one, angles + k, speeds + k, acceleration, slope, speed,
                         angular_acceleration, change, &part, &part_slope,
                         turned ? turned + 2 * k : NULL);
        *force = complex_sum(*force, part);
        *force_slope = complex_sum(*force_slope, part_slope);
    }
    if (weights->each) {
        return;
    }
    acceleration = complex_scaled(lever, acceleration);
    slope = complex_scaled(lever, slope);
    for (k = 0; k < weights->count; k++) {
        const double nu = speeds[k], squared = nu * nu;
        const Complex unit = unit_of(turned, angles, k);
        const Complex back = complex_conjugate(unit);
        const Complex along = complex_product(acceleration, back);
        const double bend = along.im - lag - damping_rate * nu;
        const double torque_slope = complex_product(slope, back).im - along.re * nu;
        const Complex rates[3] = {
            {0.0, nu},
            {-squared, bend},
            {-3.0 * nu * bend, torque_slope - damping_rate * bend - share * change - nu * squared}};
        moment = complex_sum(moment, unit);
        first = complex_sum(first, complex_product(rates[0], unit));
        second = complex_sum(second, complex_product(rates[1], unit));
        third = complex_sum(third, complex_product(rates[2], unit));
    }
    sum = complex_sum(second, complex_product(turn, first));
    sum = complex_sum(sum, complex_product(pull, moment));
    *force = complex_scaled(scale, sum);
    sum = complex_sum(third, complex_product(turn, second));
    sum = complex_sum(sum, complex_product(pull_slope, first));
    sum = complex_difference(sum, complex_scaled(2.0 * speed * angular_acceleration, moment));
    sum = complex_sum(sum, complex_product(complex_of(0.0, change), moment));
    *force_slope = complex_scaled(scale, sum);
}

void weights_unhindered(const Weights *weights, const double *angles, const double *speeds,
                        const Complex *motion, double angular_acceleration, double change,
                        double *turned)
{
    const double lag = weights->count * weights_spin_share(weights);
    const double lever = -1.0 / (weights->kappa * weights->track_radius);
    const double damping_rate = weights_damping_rate(weights);
    double rate = 0.0, sum = 0.0, jerk = 0.0;
    int k;
    turned[0] = turned[1] = 0.0;
    for (k = 0; weights->each && k < weights->count; k++) {
        const Weights one = weights_single(weights, k);
        const double share = weights_arm(&one) / weights_arm(weights);
        double part[2];
        weights_unhindered(&one, angles + k, speeds + k, motion, angular_acceleration, change, part);
        turned[0] += share * part[0];
        turned[1] += share * part[1];
    }
    if (weights->each) {
        return;
    }
    for (k = 0; k < weights->count; k++) {
        double drawn, drawn_slope;
        along_track(motion[0], motion[1], angles[k], speeds[k], lever, &drawn, &drawn_slope);
        rate += speeds[k];
        sum += drawn;
        jerk += drawn_slope;
    }
    turned[0] = sum - (lag * angular_acceleration + damping_rate * rate);
    turned[1] = jerk - (lag * change + damping_rate * turned[0]);
}

void weights_torque(const Weights *weights, const double *angles, const double *speeds,
                    const Complex *motion, double angular_acceleration, double change,
                    double *torque)
{
    const double size = weights->track_radius, body = weights->radius, n = weights->count;
    const double drag = weights->drag * size * size;
    const double rolling = (weights->kappa - 1.0) * weights->mass * (size + body);
    double rate = 0.0, turned[2];
    int k;
    torque[0] = torque[1] = 0.0;
    for (k = 0; weights->each && k < weights->count; k++) {
        const Weights one = weights_single(weights, k);
        weights_torque(&one, angles + k, speeds + k, motion, angular_acceleration, change, turned);
        torque[0] += turned[0];
        torque[1] += turned[1];
    }
    if (weights->each) {
        return;
    }
    weights_unhindered(weights, angles, speeds, motion, angular_acceleration, change, turned);
    for (k = 0; k < weights->count; k++) {
        rate += speeds[k];
    }
    torque[0] = drag * rate - rolling * (n * body * angular_acceleration - size * turned[0]);
    torque[1] = drag * turned[0] - rolling * (n * body * change - size * turned[1]);
}
