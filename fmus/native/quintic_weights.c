#include "quintic_weights.h"

#include "elementary.h"
#include "quintic.h"

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

/* Drive Im(a e^{-i theta}) in this direction of size `lever`, and its time derivatives along the
   motion. */
static void along_track_of(const Complex *motion, Complex direction, double rate,
                           double damping_rate, double *drive)
{
    const Complex along = complex_product(motion[0], direction);
    const Complex slope = complex_product(motion[1], direction);
    const double faster = along.im - damping_rate * rate;
    drive[0] = along.im;
    drive[1] = slope.im - along.re * rate;
    drive[2] = complex_product(motion[2], direction).im - 2.0 * slope.re * rate -
               along.re * faster - along.im * rate * rate;
}

/* What the rates t[k] make of g's derivatives. */
static double sum_of(const double *t, const double *g)
{
    return t[0] * g[0] + t[1] * g[1] + t[2] * g[2];
}

/* Angle and rate of one weight in this direction after `step`, in place; order 6. */
static int substep(double *angle, double *angle_rate, const Complex *start, const Complex *end,
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
    free_rate = response[0] * *angle_rate + sum_of(s, begin);
    free_angle = *angle + response[7] * *angle_rate + sum_of(t, begin);
    new_angle = free_angle;
    new_rate = free_rate;
    for (iteration = 0; iteration < MAX_ITERATIONS; iteration++) {
        const double last_angle = new_angle, last_rate = new_rate, last_change = change;
        along_track_of(end, direction_at(direction, new_angle - from, lever, new_angle), new_rate,
                       damping_rate, reached);
        quintic_hermite(begin, reached, 1, step, higher);
        new_rate = free_rate + sum_of(s + 3, higher);
        new_angle = free_angle + sum_of(t + 3, higher);
        change = absolute(new_angle - last_angle) + absolute(new_rate - last_rate) * step;
        if (converged(change, last_change, new_angle)) {
            *angle = new_angle;
            *angle_rate = new_rate;
            return FINE;
        }
    }
    return fail(failure, FAILURE_NOT_CONVERGED, "weights", 0, step, *angle, *angle_rate,
                magnitude(start[0]));
}

int quintic_weights_advance(const Weights *weights, const double *angles, const double *speeds,
                            const Complex *signal, double step, double *new_angles,
                            double *new_speeds, QuinticQuadrature *memory, Turned *turned,
                            Failure *failure)
{
    const double lever = -1.0 / (weights->kappa * weights->track_radius);
    const double damping_rate = weights_damping_rate(weights);
    const double *response;
    Complex first[3]; /* at the end of the first substep, mostly the only one */
    double h;
    int k, j, code, count;
    code = weights_substeps(weights->count, angles, speeds, signal, lever, 0.0, damping_rate, step,
                            &count, failure);
    if (code) {
        return code;
    }
    h = count > 1 ? step / count : step;
    response = quadrature_of(memory, damping_rate, h);
    quintic_at(signal, h, first);
    for (k = 0; k < weights->count && !code; k++) {
        /* the iteration's end is judged by the angle: turns behind a weight must not loosen it */
        const double behind = weights_turns_behind(angles[k]);
        double angle = angles[k] - behind, speed = speeds[k];
        Complex ends[2][3];
        code = substep(&angle, &speed, signal, first, lever, turned_by(turned + 2 * k, angle),
                       damping_rate, response, h, failure);
        for (j = 2; j <= count && !code; j++) {
            quintic_at(signal, j * h, ends[j % 2]);
            code = substep(&angle, &speed, j > 2 ? ends[(j - 1) % 2] : first, ends[j % 2], lever,
                           turned_by(turned + 2 * k, angle), damping_rate, response, h, failure);
        }
        new_angles[k] = angle + behind;
        new_speeds[k] = speed;
    }
    return code;
}

Complex quintic_weights_reaction_second(const Weights *weights, const double *angles,
                                        const double *speeds, const Complex *motion,
                                        double rotor_speed, Turned *turned)
{
    const double lever = -1.0 / (weights->kappa * weights->track_radius);
    const double damping_rate = weights_damping_rate(weights), w = rotor_speed;
    Complex total = {0.0, 0.0};
    int k;
    for (k = 0; k < weights->count; k++) {
        const double nu = speeds[k];
        const Complex unit = turned_by(turned + 2 * k, angles[k]);
        double g[3], nu_1, nu_2, nu_3;
        Complex second, third, fourth, sum;
        along_track_of(motion, complex_scaled(lever, complex_conjugate(unit)), nu, damping_rate, g);
        nu_1 = g[0] - damping_rate * nu;
        nu_2 = g[1] - damping_rate * nu_1;
        nu_3 = g[2] - damping_rate * nu_2;
        /* derivatives of e^{i theta} of order 2 to 4, over e^{i theta} */
        second = complex_of(-nu * nu, nu_1);
        third = complex_of(-3.0 * nu * nu_1, nu_2 - nu * nu * nu);
        fourth = complex_of(nu * nu * nu * nu - 3.0 * nu_1 * nu_1 - 4.0 * nu * nu_2,
                            nu_3 - 6.0 * nu * nu * nu_1);
        sum = complex_sum(fourth, complex_product(complex_of(0.0, 2.0 * w), third));
        sum = complex_difference(sum, complex_scaled(w * w, second));
        total = complex_sum(total, complex_product(sum, unit));
    }
    return complex_scaled(-weights->mass * weights->track_radius, total);
}
