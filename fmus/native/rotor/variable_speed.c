#include "rotor/variable_speed.h"

#include "base/cubic.h"
#include "base/elementary.h"
#include "base/matrix.h"
#include "base/quintic.h"
#include "base/signals.h"
#include "base/spin.h"
#include "constants.h"

#define ROOT 2.449489742783178 /* sqrt(6) */

/* Radau IIA with three stages: Hairer & Wanner 1996, table IV.5.6 */
static const double RADAU_NODES[STAGES] = {(4.0 - ROOT) / 10.0, (4.0 + ROOT) / 10.0, 1.0};
static const double COEFFICIENTS[STAGES][STAGES] = {
    {(88.0 - 7.0 * ROOT) / 360.0, (296.0 - 169.0 * ROOT) / 1800.0, (-2.0 + 3.0 * ROOT) / 225.0},
    {(296.0 + 169.0 * ROOT) / 1800.0, (88.0 + 7.0 * ROOT) / 360.0, (-2.0 - 3.0 * ROOT) / 225.0},
    {(16.0 - ROOT) / 36.0, (16.0 + ROOT) / 36.0, 1.0 / 9.0}};

size_t variable_speed_size(int stations, int planes, int axes)
{
    const size_t dof = (size_t)axes * stations, forces = (size_t)axes * planes;
    const size_t parts = axes == 1 ? 2 : 1;
    return parts * dof * (4 * dof + 2 * forces + axes + 1);
}

size_t variable_speed_scratch(int stations, int planes, int axes)
{
    const size_t dof = (size_t)axes * stations, forces = (size_t)axes * planes;
    const size_t parts = axes == 1 ? 2 : 1, size = 2 * dof;
    const size_t make = dof * (6 * dof + forces + axes);
    const size_t stages = STAGES * size * (STAGES * size + 1) + size * size;
    const size_t drive = 8 * dof + 8 * forces + 4 * axes, kept = 2 * size;
    return parts * ((make > stages ? make : stages) + drive + kept);
}

/* Matrices of one power of the speed: -M^-1 (K, C) side by side; K and C are overwritten. */
static void set_power(int parts, int dof, const double *inverse, double *stiffness, double *damping,
                      double *product, double *result)
{
    const size_t width = (size_t)dof * parts;
    size_t i, k;
    int half;
    for (half = 0; half < 2; half++) {
        matrix_product(parts, dof, dof, dof, inverse, half ? damping : stiffness, product);
        for (i = 0; i < (size_t)dof; i++) {
            for (k = 0; k < width; k++) {
                result[(2 * i + half) * width + k] = -product[i * width + k];
            }
        }
    }
}

/* Columns that turn the unit vector e into the unbalance, (dof, axes). */
static void set_unbalance(const LinearRotor *rotor, int axes, double *columns)
{
    const int n = rotor->stations;
    int i;
    for (i = 0; i < n; i++) {
        const double x = rotor->unbalance[2 * i], y = rotor->unbalance[2 * i + 1];
        columns[2 * i] = x;
        if (axes == 1) {
            columns[2 * i + 1] = y;
        } else {
            columns[2 * i + 1] = -y;
            columns[2 * (n + i)] = y;
            columns[2 * (n + i) + 1] = x;
        }
    }
}

int variable_speed_step(const LinearRotor *rotor, int turning_force, double *memory,
                        double *scratch, VariableSpeedStep *made, Failure *failure)
{
    const int axes = linear_rotor_isotropic(rotor) ? 1 : 2, parts = 3 - axes;
    const int n = rotor->stations, p = rotor->plane_count, dof = axes * n, forces = axes * p;
    const size_t square = (size_t)dof * dof * parts;
    double *mass = scratch, *inverse = mass + square, *damping = inverse + square;
    double *stiffness = damping + square, *damping_1 = stiffness + square;
    double *stiffness_1 = damping_1 + square, *columns = stiffness_1 + square;
    size_t k;
    made->turning_force = turning_force;
    made->orders = SIGNAL_ORDERS;
    made->axes = axes;
    made->parts = parts;
    made->dof = dof;
    made->plane_count = p;
    made->still = memory;
    made->per_speed = made->still + 2 * square;
    made->planes = made->per_speed + 2 * square;
    made->force = made->planes + (size_t)forces * dof * parts;
    made->unbalance = made->force + (size_t)forces * dof * parts;
    made->falling = linear_rotor_heavy(rotor) ? made->unbalance + (size_t)axes * dof * parts : NULL;
    if (made->falling) {
        linear_rotor_falling(rotor, made->falling);
    }
    linear_rotor_coefficients(rotor, 1.0, mass, damping_1, stiffness_1);
    linear_rotor_coefficients(rotor, 0.0, mass, damping, stiffness);
    for (k = 0; k < square; k++) {
        damping_1[k] -= damping[k];
        stiffness_1[k] -= stiffness[k];
    }
    fill_doubles(square, 0.0, inverse);
    for (k = 0; k < (size_t)dof; k++) {
        inverse[(k * dof + k) * parts] = 1.0;
    }
    if (matrix_solve(parts, dof, dof, mass, inverse)) {
        return fail(failure, FAILURE_SINGULAR, "mass", 0, 0.0, 0.0, 0.0, 0.0);
    }
    set_power(parts, dof, inverse, stiffness, damping, mass, made->still);
    set_power(parts, dof, inverse, stiffness_1, damping_1, mass, made->per_speed);
    matrix_per_axis(parts, axes, p, n, rotor->planes, made->planes);
    matrix_transposed(parts, forces, dof, made->planes, columns);
    matrix_product(parts, dof, dof, forces, inverse, columns, made->force);
    set_unbalance(rotor, axes, columns);
    matrix_product(parts, dof, dof, axes, inverse, columns, made->unbalance);
    return FINE;
}

/* Write a complex number as the k-th of `count`, for the axes in use. */
static void put_complex(const VariableSpeedStep *method, int count, int k, Complex value, double *to)
{
    to[method->parts * k] = value.re;
    to[method->axes == 1 ? 2 * k + 1 : count + k] = value.im;
}

/* to (dof) elements = force F + unbalance e, with F (p) and e one complex numbers by `put`. */
static void sum_drive(const VariableSpeedStep *method, const double *forces, const double *pull,
                      double *to, double *scratch)
{
    const int parts = method->parts, dof = method->dof, axes = method->axes;
    int k;
    matrix_product(parts, dof, axes * method->plane_count, 1, method->force, forces, to);
    matrix_product(parts, dof, axes, 1, method->unbalance, pull, scratch);
    for (k = 0; k < dof * parts; k++) {
        to[k] += scratch[k];
    }
}

/* The k-th force at time t: value and slope, of a quintic the second derivative as well. */
static void force_at(const VariableSpeedStep *method, const double *forces, int k, double t,
                     Complex *derivatives)
{
    Complex signal[QUINTIC_ORDERS];
    int order;
    for (order = 0; order < method->orders; order++) {
        const double *f = forces + 2 * (order * method->plane_count + k);
        signal[order] = complex_of(f[0], f[1]);
    }
    if (method->orders == QUINTIC_ORDERS) {
        quintic_at(signal, t, derivatives);
    } else {
        signal_at(signal, t, derivatives, derivatives + 1);
    }
}

/* Acceleration (dof) by unbalance, plane forces and gravity at time t, its derivative, and the speed. */
static double set_drive(const VariableSpeedStep *method, const double *forces, double angle,
                        double speed, const double *spin_up, double t, double *drive,
                        double *drive_slope, double *scratch)
{
    const Drift more = drift(spin_up, t);
    const double angular_acceleration = spin_up[0] + more.acceleration;
    const int p = method->plane_count, elements = method->parts * method->axes;
    double *values = scratch, *slopes = values + elements * p, *pulls = slopes + elements * p;
    double *pull_slopes = pulls + elements, *work = pull_slopes + elements;
    const double w = speed + spin_up[0] * t + more.speed;
    const Complex turn = rect(1.0, angle + speed * t + 0.5 * spin_up[0] * t * t + more.angle);
    int k;
    for (k = 0; k < p; k++) {
        Complex derivatives[3], value, slope;
        force_at(method, forces, k, t, derivatives);
        value = derivatives[0];
        slope = derivatives[1];
        if (method->turning_force) {
            value = complex_product(value, turn);
            /* value is turned already */
            slope = complex_sum(complex_product(slope, turn),
                                complex_product(complex_of(0.0, w), value));
        }
        put_complex(method, p, k, value, values);
        put_complex(method, p, k, slope, slopes);
    }
    put_complex(method, 1, 0, complex_product(complex_of(w * w, -angular_acceleration), turn), pulls);
    put_complex(method, 1, 0, complex_product(complex_of(3.0 * w * angular_acceleration, w * w * w - more.slope), turn),
        pull_slopes);
    sum_drive(method, values, pulls, drive, work);
    for (k = 0; method->falling && k < method->dof * method->parts; k++) {
        drive[k] += method->falling[k];
    }
    sum_drive(method, slopes, pull_slopes, drive_slope, work);
    return w;
}

/* Second derivative (dof) of the acceleration by unbalance and quintic plane forces at time t. */
static void set_drive_second(const VariableSpeedStep *method, const double *forces, double angle,
                             double speed, const double *spin_up, double t, double *drive_second,
                             double *scratch)
{
    const Drift more = drift(spin_up, t);
    const int p = method->plane_count, elements = method->parts * method->axes;
    double *seconds = scratch, *pulls = seconds + elements * p, *work = pulls + elements;
    const double w = speed + spin_up[0] * t + more.speed, w1 = spin_up[0] + more.acceleration;
    const double w2 = more.slope, w3 = spin_up[2] + t * spin_up[3];
    const Complex turn = rect(1.0, angle + speed * t + 0.5 * spin_up[0] * t * t + more.angle);
    const Complex pull =
        complex_of(3.0 * w1 * w1 + 4.0 * w * w2 - w * w * w * w, 6.0 * w * w * w1 - w3);
    int k;
    for (k = 0; k < p; k++) {
        Complex f[3], second;
        force_at(method, forces, k, t, f);
        second = f[2];
        if (method->turning_force) {
            second = complex_sum(second, complex_product(complex_of(0.0, 2.0 * w), f[1]));
            second = complex_sum(second, complex_product(complex_of(-w * w, w1), f[0]));
            second = complex_product(second, turn);
        }
        put_complex(method, p, k, second, seconds);
    }
    put_complex(method, 1, 0, complex_product(pull, turn), pulls);
    sum_drive(method, seconds, pulls, drive_second, work);
}

/* matrix (dof, 2 dof) = still + w per_speed. */
static void set_matrix(const VariableSpeedStep *method, double w, double *matrix)
{
    const size_t count = 2 * (size_t)method->dof * method->dof * method->parts;
    size_t k;
    for (k = 0; k < count; k++) {
        matrix[k] = method->still[k] + w * method->per_speed[k];
    }
}

/* The stages' equations: rows of stage i of the system, and its right-hand side. */
static void set_stage(const VariableSpeedStep *method, int i, const double *state,
                      const double *matrix, const double *drive, double step, double *system,
                      double *right)
{
    const int parts = method->parts, dof = method->dof, size = 2 * dof, width = STAGES * size;
    double *rows = system + (size_t)i * size * width * parts;
    int row, j, k;
    copy_doubles((size_t)dof * parts, state + dof * parts, right);
    matrix_product(parts, dof, size, 1, matrix, state, right + dof * parts);
    for (k = 0; k < dof * parts; k++) {
        right[dof * parts + k] += drive[k];
    }
    fill_doubles((size_t)size * width * parts, 0.0, rows);
    for (row = 0; row < size; row++) {
        double *to = rows + (size_t)row * width * parts;
        for (j = 0; j < STAGES; j++) {
            const double weight = step * COEFFICIENTS[i][j];
            double *block = to + (size_t)j * size * parts;
            if (row < dof) {
                block[(dof + row) * parts] -= weight;
            } else {
                const double *from = matrix + (size_t)(row - dof) * size * parts;
                for (k = 0; k < size * parts; k++) {
                    block[k] -= weight * from[k];
                }
            }
        }
        to[((size_t)i * size + row) * parts] += 1.0;
    }
}

/* State one `step` later than at the time `begin` into the cubic forces, in place. */
static int advance_part(const VariableSpeedStep *method, double *state, const double *forces,
                        double angle, double speed, const double *spin_up, double begin,
                        double step, double *scratch, Failure *failure)
{
    const int size = 2 * method->dof, parts = method->parts;
    const size_t length = (size_t)size * parts;
    double *system = scratch, *right = system + STAGES * STAGES * length * size;
    double *matrix = right + STAGES * length, *drive = matrix + length * size;
    double *drive_slope = drive + length, *work = drive_slope + length;
    size_t k;
    int i;
    for (i = 0; i < STAGES; i++) {
        const double w = set_drive(method, forces, angle, speed, spin_up,
                                   begin + RADAU_NODES[i] * step, drive, drive_slope, work);
        set_matrix(method, w, matrix);
        set_stage(method, i, state, matrix, drive, step, system, right + i * length);
    }
    if (matrix_solve(parts, STAGES * size, 1, system, right)) {
        return fail(failure, FAILURE_SINGULAR, "stages", 0, 0.0, 0.0, 0.0, 0.0);
    }
    for (k = 0; k < length; k++) {
        state[k] += step * (COEFFICIENTS[2][0] * right[k] + COEFFICIENTS[2][1] * right[length + k] +
                            COEFFICIENTS[2][2] * right[2 * length + k]);
    }
    return FINE;
}

int variable_speed_parts(const VariableSpeedStep *method, double *state, const double *forces,
                         double angle, double speed, const double *spin_up, double step,
                         int count, double *scratch, Failure *failure)
{
    const double part = step / count;
    int number;
    for (number = 0; number < count; number++) {
        const int status = advance_part(method, state, forces, angle, speed, spin_up,
                                        number * part, part, scratch, failure);
        if (status) {
            return status;
        }
    }
    return FINE;
}

/* Largest modulus among as many elements as there are displacements; NaN does not count. */
static double largest(const VariableSpeedStep *method, const double *values)
{
    const int parts = method->parts;
    double found = 0.0;
    int k;
    for (k = 0; k < method->dof * parts; k += parts) {
        found = larger(found, hypotenuse(values[k], parts == 2 ? values[k + 1] : 0.0));
    }
    return found;
}

/* Largest acceleration of a station at the start of a step. */
static double first_acceleration(const VariableSpeedStep *method, const double *state,
                                 const double *forces, double angle, double speed,
                                 const double *spin_up, double *scratch)
{
    const int dof = method->dof, parts = method->parts;
    const size_t half = (size_t)dof * parts;
    double *matrix = scratch, *drive = matrix + 2 * half * dof, *drive_slope = drive + half;
    double *acceleration = drive_slope + half, *work = acceleration + half;
    const double w = set_drive(method, forces, angle, speed, spin_up, 0.0, drive,
                               drive_slope, work);
    size_t k;
    set_matrix(method, w, matrix);
    matrix_product(parts, dof, 2 * dof, 1, matrix, state, acceleration);
    for (k = 0; k < half; k++) {
        acceleration[k] += drive[k];
    }
    return largest(method, acceleration);
}

int variable_speed_advance(const VariableSpeedStep *method, double *state, const double *forces,
                           double angle, double speed, const double *spin_up, double step,
                           double *scratch, Failure *failure)
{
    const size_t length = 2 * (size_t)method->dof * method->parts;
    double *start_state = scratch, *coarser = start_state + length, *work = coarser + length;
    const double before = largest(method, state), rate = largest(method, state + length / 2);
    const double acceleration =
        first_acceleration(method, state, forces, angle, speed, spin_up, work);
    double error = 0.0;
    size_t k;
    int halving, status;
    copy_doubles(length, state, start_state);
    for (halving = 0; halving <= PART_HALVINGS; halving++) {
        const double part = step / (1 << halving);
        double reach;
        copy_doubles(length, state, coarser);
        copy_doubles(length, start_state, state);
        status = variable_speed_parts(method, state, forces, angle, speed, spin_up,
                                      step, 1 << halving, work, failure);
        if (status) {
            return status;
        }
        for (k = 0; k < length; k++) {
            coarser[k] -= state[k];
        }
        error = largest(method, coarser) / HALVED_ERRORS;
        reach = larger(before, largest(method, state));
        if (halving && !(error > STEP_ACCURACY * reach) &&
            !(part * larger(rate, part * acceleration) > reach)) {
            return FINE;
        }
    }
    return fail(failure, FAILURE_FAST_VIBRATION, "step", 1 << PART_HALVINGS, step, error, 0.0, 0.0);
}

void variable_speed_motion(const VariableSpeedStep *method, const double *state, const double *forces,
                           double angle, double speed, const double *spin_up, double t, double *rates,
                           double *jerks, double *scratch)
{
    const int dof = method->dof, parts = method->parts;
    const size_t half = (size_t)dof * parts;
    double *matrix = scratch, *drive = matrix + 2 * half * dof, *drive_slope = drive + half;
    double *growth = drive_slope + half, *work = growth + half;
    const double angular_acceleration = spin_up[0] + drift(spin_up, t).acceleration;
    const double w = set_drive(method, forces, angle, speed, spin_up, t, drive, drive_slope, work);
    size_t k;
    set_matrix(method, w, matrix);
    copy_doubles(half, state + half, rates);
    matrix_product(parts, dof, 2 * dof, 1, matrix, state, rates + half);
    for (k = 0; k < half; k++) {
        rates[half + k] += drive[k];
    }
    matrix_product(parts, dof, 2 * dof, 1, matrix, rates, jerks);
    matrix_product(parts, dof, 2 * dof, 1, method->per_speed, state, growth);
    for (k = 0; k < half; k++) {
        jerks[k] += angular_acceleration * growth[k] + drive_slope[k];
    }
}

void variable_speed_plane_motion(const VariableSpeedStep *method, const double *state,
                                 const double *forces, double angle, double speed,
                                 const double *spin_up, double t, double *acceleration,
                                 double *jerk, double *scratch)
{
    const int dof = method->dof, parts = method->parts, planes = method->axes * method->plane_count;
    const size_t half = (size_t)dof * parts;
    double *rates = scratch, *jerks = rates + 2 * half, *work = jerks + half;
    variable_speed_motion(method, state, forces, angle, speed, spin_up, t, rates, jerks, work);
    matrix_product(parts, planes, dof, 1, method->planes, rates + half, acceleration);
    matrix_product(parts, planes, dof, 1, method->planes, jerks, jerk);
}

void variable_speed_plane_second(const VariableSpeedStep *method, const double *state,
                                 const double *forces, double angle, double speed,
                                 const double *spin_up, double t, double *second, double *scratch)
{
    const int dof = method->dof, parts = method->parts, planes = method->axes * method->plane_count;
    const size_t half = (size_t)dof * parts;
    const Drift more = drift(spin_up, t);
    /* velocity, acceleration and jerk stand side by side */
    double *rates = scratch, *jerks = rates + 2 * half, *sum = jerks + half, *term = sum + half;
    double *matrix = term + half, *work = matrix + 2 * half * dof;
    size_t k;
    variable_speed_motion(method, state, forces, angle, speed, spin_up, t, rates, jerks, term);
    set_drive_second(method, forces, angle, speed, spin_up, t, sum, term);
    set_matrix(method, speed + spin_up[0] * t + more.speed, matrix);
    matrix_product(parts, dof, 2 * dof, 1, matrix, rates + half, term);
    for (k = 0; k < half; k++) {
        sum[k] += term[k];
    }
    matrix_product(parts, dof, 2 * dof, 1, method->per_speed, rates, term);
    matrix_product(parts, dof, 2 * dof, 1, method->per_speed, state, work);
    for (k = 0; k < half; k++) {
        sum[k] += 2.0 * (spin_up[0] + more.acceleration) * term[k] + more.slope * work[k];
    }
    matrix_product(parts, planes, dof, 1, method->planes, sum, second);
}

/* x + i y of station k of (dof,) elements. */
static Complex vector_of(const VariableSpeedStep *method, const double *values, int k)
{
    const int stations = method->dof / method->axes;
    return method->axes == 1 ? complex_of(values[2 * k], values[2 * k + 1])
                             : complex_of(values[k], values[stations + k]);
}

/* a' b of which the imaginary part is meant. */
static double crossed(Complex a, Complex b)
{
    return a.re * b.im - a.im * b.re;
}

void shaft_torque(const VariableSpeedStep *method, const LinearRotor *rotor, const double *state,
                  const double *rates, const double *jerks, double angle, double speed,
                  double angular_acceleration, double *torque)
{
    const size_t half = (size_t)method->dof * method->parts;
    const double w = speed, change = angular_acceleration;
    const Complex turned = rect(1.0, angle);
    int i, k;
    torque[0] = torque[1] = 0.0;
    for (i = 0; i < rotor->stations; i++) {
        const Complex unbalance = complex_product(
            complex_of(rotor->unbalance[2 * i], rotor->unbalance[2 * i + 1]), turned);
        const Complex q = vector_of(method, state, i), v = vector_of(method, rates, i);
        const Complex a = complex_difference(vector_of(method, rates + half, i),
                                             complex_of(rotor->gravity[0], rotor->gravity[1]));
        const Complex j = vector_of(method, jerks, i);
        /* -(u* (q'' ))', u* turning at -w */
        const Complex seen = complex_of(j.re + w * a.im, j.im - w * a.re);
        torque[0] -= crossed(unbalance, a);
        torque[1] -= crossed(unbalance, seen);
        for (k = 0; k < rotor->stations; k++) {
            const double internal = rotor->internal_damping[i * rotor->stations + k];
            const Complex p = vector_of(method, state, k), r = vector_of(method, rates, k);
            const Complex b = vector_of(method, rates + half, k);
            const Complex sheared = complex_of(r.re + w * p.im, r.im - w * p.re);
            const Complex shearing = complex_of(b.re + w * r.im + change * p.im,
                                                b.im - w * r.re - change * p.re);
            torque[0] += internal * crossed(q, sheared);
            torque[1] += internal * (crossed(v, sheared) + crossed(q, shearing));
        }
    }
}

void variable_speed_torque(const VariableSpeedStep *method, const LinearRotor *rotor,
                           const double *state, const double *forces, double angle, double speed,
                           const double *spin_up, double t, double *torque, double *scratch)
{
    const size_t half = (size_t)method->dof * method->parts;
    const Drift more = drift(spin_up, t);
    double *rates = scratch, *jerks = rates + 2 * half, *work = jerks + half;
    variable_speed_motion(method, state, forces, angle, speed, spin_up, t, rates, jerks, work);
    shaft_torque(method, rotor, state, rates, jerks,
                 angle + t * (speed + 0.5 * spin_up[0] * t) + more.angle,
                 speed + spin_up[0] * t + more.speed, spin_up[0] + more.acceleration, torque);
}
