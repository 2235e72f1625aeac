#include "weights/quintic_weights.h"

#include "base/elementary.h"
#include "base/quintic.h"
#include "base/spin.h"
#include "constants.h"

QuinticQuadrature quintic_quadrature_empty(void)
{
    QuinticQuadrature empty = {-1.0, -1.0, {0.0}};
    return empty;
}

/* Exact response of rate and angle over a step to the rate and to g's derivatives 0 to 5. */
static const double *quadrature_of(QuinticQuadrature *memory, double damping_rate, double step)
{
    double phi[8], power = 1.0;
    int k;
    if (memory->damping_rate != damping_rate || memory->step != step) {
        phi_functions(-damping_rate * step, 7, phi);
        for (k = 0; k < 7; k++) {
            memory->response[k] = power * phi[k];
            power *= step;
            memory->response[7 + k] = power * phi[k + 1];
        }
        memory->damping_rate = damping_rate;
        memory->step = step;
    }
    return memory->response;
}

/* What moves weights at one time: acceleration of the track's centre, and lag s w', by which a free
   weight falls behind, with their derivatives of order 1 and 2. */
typedef struct {
    Complex motion[3];
    double lag[3];
} Driven;

/* The lag `time` after the start of a step; spin_up (4,) as for `drift`. */
static void lag_at(const Weights *weights, const double *spin_up, double time, double *lag)
{
    const double share = weights_spin_share(weights);
    const Drift more = drift(spin_up, time);
    lag[0] = share * (spin_up[0] + more.acceleration);
    lag[1] = share * more.slope;
    lag[2] = share * (spin_up[2] + time * spin_up[3]);
}

static Driven driven_at(const Weights *weights, const Complex *signal, const double *spin_up,
                        double time)
{
    Driven driven;
    quintic_at(signal, time, driven.motion);
    lag_at(weights, spin_up, time, driven.lag);
    return driven;
}

/* Drive Im(a e^{-i theta}) in this direction of size `lever`, less the lag, and its time derivatives
   along the motion. */
static void along_track_of(const Driven *by, Complex direction, double rate, double damping_rate,
                           double *drive)
{
    const Complex along = complex_product(by->motion[0], direction);
    const Complex slope = complex_product(by->motion[1], direction);
    drive[0] = along.im - by->lag[0];
    drive[1] = slope.im - along.re * rate - by->lag[1];
    drive[2] = complex_product(by->motion[2], direction).im - 2.0 * slope.re * rate -
               along.re * (drive[0] - damping_rate * rate) - along.im * rate * rate - by->lag[2];
}

/* What the rates t[k] make of g's derivatives. */
static double weighted_sum(const double *t, const double *g)
{
    return t[0] * g[0] + t[1] * g[1] + t[2] * g[2];
}

/* Angle and rate of one weight in this direction after `step`, in place; order 6. */
static int substep(double *angle, double *angle_rate, const Driven *start, const Driven *end,
                   double lever, Complex unit, double damping_rate, const double *response,
                   double step, Failure *failure)
{
    const Complex direction = complex_scaled(lever, complex_conjugate(unit));
    const double from = *angle;
    const double *s = response + 1, *t = response + 8; /* to g's derivatives */
    double begin[3], reached[3], higher[3];
    double free_rate, free_angle, new_rate, new_angle, change = 1.0;
    int iteration;
    along_track_of(start, direction, *angle_rate, damping_rate, begin);
    free_rate = response[0] * *angle_rate + weighted_sum(s, begin);
    free_angle = *angle + response[7] * *angle_rate + weighted_sum(t, begin);
    new_angle = free_angle;
    new_rate = free_rate;
    for (iteration = 0; iteration < MAX_ITERATIONS; iteration++) {
        const double last_angle = new_angle, last_rate = new_rate, last_change = change;
        along_track_of(end, direction_at(direction, new_angle - from, lever, new_angle), new_rate,
                       damping_rate, reached);
        quintic_hermite(begin, reached, 1, step, higher);
        new_rate = free_rate + weighted_sum(s + 3, higher);
        new_angle = free_angle + weighted_sum(t + 3, higher);
        change = absolute(new_angle - last_angle) + absolute(new_rate - last_rate) * step;
        if (converged(change, last_change, new_angle)) {
            *angle = new_angle;
            *angle_rate = new_rate;
            return FINE;
        }
    }
    return fail(failure, FAILURE_NOT_CONVERGED, "weights", 0, step, *angle, *angle_rate,
                magnitude(start->motion[0]));
}

int quintic_weights_advance(const Weights *weights, const double *angles, const double *speeds,
                            const Complex *signal, const double *spin_up, double step,
                            double *new_angles, double *new_speeds, QuinticQuadrature *memory,
                            Turned *turned, Failure *failure)
{
    const double lever = -1.0 / (weights->kappa * weights->track_radius);
    const double damping_rate = weights_damping_rate(weights);
    const double lag = weights_spin_share(weights) * spin_up[0];
    const double *response;
    Driven begin, first; /* at the end of the first substep, mostly the only one */
    double h;
    int k, j, code = FINE, count;
    for (k = 0; weights->each && k < weights->count && !code; k++) {
        const Weights one = weights_single(weights, k);
        code = quintic_weights_advance(&one, angles + k, speeds + k, signal, spin_up, step,
                                       new_angles + k, new_speeds + k, memory, turned + 2 * k,
                                       failure);
    }
    if (weights->each) {
        return code;
    }
    code = weights_substeps(weights->count, angles, speeds, signal, lever, lag, damping_rate, step,
                            &count, failure);
    if (code) {
        return code;
    }
    h = count > 1 ? step / count : step;
    response = quadrature_of(memory, damping_rate, h);
    begin = driven_at(weights, signal, spin_up, 0.0);
    first = driven_at(weights, signal, spin_up, h);
    for (k = 0; k < weights->count && !code; k++) {
        /* the iteration's end is judged by the angle: turns behind a weight must not loosen it */
        const double behind = weights_turns_behind(angles[k]);
        double angle = angles[k] - behind, speed = speeds[k];
        Driven ends[2];
        ends[1] = first;
        code = substep(&angle, &speed, &begin, &first, lever, turned_by(turned + 2 * k, angle),
                       damping_rate, response, h, failure);
        for (j = 2; j <= count && !code; j++) {
            ends[j % 2] = driven_at(weights, signal, spin_up, j * h);
            code = substep(&angle, &speed, ends + (j - 1) % 2, ends + j % 2, lever,
                           turned_by(turned + 2 * k, angle), damping_rate, response, h, failure);
        }
        new_angles[k] = angle + behind;
        new_speeds[k] = speed;
    }
    return code;
}

Complex quintic_weights_reaction_second(const Weights *weights, const double *angles,
                                        const double *speeds, const Complex *motion,
                                        double rotor_speed, const double *spin_up,
                                        Turned *turned)
{
    const double lever = -1.0 / (weights->kappa * weights->track_radius);
    const double damping_rate = weights_damping_rate(weights), w = rotor_speed;
    const double w1 = spin_up[0], w2 = spin_up[1], w3 = spin_up[2];
    const double rates[4] = {w1, w2, w3, 0.0};
    /* of (u'' + 2 i w u' + (i w' - w^2) u)'' with u = e^{i theta} */
    const Complex of_second = complex_of(-w * w, 5.0 * w1);
    const Complex of_first = complex_of(-4.0 * w * w1, 4.0 * w2);
    const Complex of_value = complex_of(-2.0 * (w1 * w1 + w * w2), w3);
    Complex total = {0.0, 0.0};
    Driven by;
    int k;
    for (k = 0; weights->each && k < weights->count; k++) {
        const Weights one = weights_single(weights, k);
        total = complex_sum(total, quintic_weights_reaction_second(
                                       &one, angles + k, speeds + k, motion, rotor_speed, spin_up,
                                       turned + 2 * k));
    }
    if (weights->each) {
        return total;
    }
    for (k = 0; k < 3; k++) {
        by.motion[k] = motion[k];
    }
    lag_at(weights, rates, 0.0, by.lag);
    for (k = 0; k < weights->count; k++) {
        const double nu = speeds[k];
        const Complex unit = turned_by(turned + 2 * k, angles[k]);
        double g[3], nu_1, nu_2, nu_3;
        Complex second, third, fourth, sum;
        along_track_of(&by, complex_scaled(lever, complex_conjugate(unit)), nu, damping_rate, g);
        nu_1 = g[0] - damping_rate * nu;
        nu_2 = g[1] - damping_rate * nu_1;
        nu_3 = g[2] - damping_rate * nu_2;
        /* derivatives of e^{i theta} of order 2 to 4, over e^{i theta} */
        second = complex_of(-nu * nu, nu_1);
        third = complex_of(-3.0 * nu * nu_1, nu_2 - nu * nu * nu);
        fourth = complex_of(nu * nu * nu * nu - 3.0 * nu_1 * nu_1 - 4.0 * nu * nu_2,
                            nu_3 - 6.0 * nu * nu * nu_1);
        sum = complex_sum(fourth, complex_product(complex_of(0.0, 2.0 * w), third));
        sum = complex_sum(sum, complex_product(of_second, second));
        sum = complex_sum(sum, complex_product(of_first, complex_of(0.0, nu)));
        sum = complex_sum(sum, of_value);
        total = complex_sum(total, complex_product(sum, unit));
    }
    return complex_scaled(-weights->mass * weights->track_radius, total);
}
