#include "rotor/linear_rotor.h"

#include "base/elementary.h"
#include "base/matrix.h"

#define TABLE_ROUNDING 1e-9 /* of its highest speed: how far outside a speed may be */

static int deflections_of(int stations)
{
    return stations > 2 ? stations - 2 : 1;
}

size_t linear_rotor_size(int stations, int planes)
{
    const size_t n = (size_t)stations;
    return 11 * n * n + (size_t)planes * n + 2 * n + (size_t)deflections_of(stations) * n;
}

LinearRotor linear_rotor_in(double *memory, int stations, int planes)
{
    const size_t square = (size_t)stations * stations;
    LinearRotor rotor;
    fill_doubles(linear_rotor_size(stations, planes), 0.0, memory);
    rotor.stations = stations;
    rotor.plane_count = planes;
    rotor.deflections = deflections_of(stations);
    rotor.mass = memory;
    rotor.damping_x = rotor.mass + square;
    rotor.damping_y = rotor.damping_x + square;
    rotor.stiffness_x = rotor.damping_y + square;
    rotor.stiffness_y = rotor.stiffness_x + square;
    rotor.damping_xy = rotor.stiffness_y + square;
    rotor.damping_yx = rotor.damping_xy + square;
    rotor.stiffness_xy = rotor.damping_yx + square;
    rotor.stiffness_yx = rotor.stiffness_xy + square;
    rotor.internal_damping = rotor.stiffness_yx + square;
    rotor.gyroscopic = rotor.internal_damping + square;
    rotor.planes = rotor.gyroscopic + square;
    rotor.unbalance = rotor.planes + (size_t)planes * stations;
    rotor.deflection = rotor.unbalance + 2 * (size_t)stations;
    rotor.gravity[0] = rotor.gravity[1] = 0.0;
    rotor.sliders = rotor.crossed = false;
    rotor.bearings.count = rotor.bearings.speed_count = 0;
    rotor.bearings.line = -1;
    return rotor;
}

void linear_rotor_planar(const double *values, LinearRotor *rotor)
{
    const Complex moment = rect(values[6], values[7]);
    rotor->mass[0] = values[0];
    rotor->stiffness_x[0] = values[1];
    rotor->stiffness_y[0] = values[2];
    rotor->damping_x[0] = values[3];
    rotor->damping_y[0] = values[4];
    rotor->internal_damping[0] = values[5];
    /* several planes are several ports at the one disc */
    fill_doubles((size_t)rotor->plane_count, 1.0, rotor->planes);
    rotor->unbalance[0] = moment.re;
    rotor->unbalance[1] = moment.im;
    rotor->deflection[0] = 1.0;
}

int linear_rotor_line(const LinearRotor *rotor, double speed, int line)
{
    const Bearings *b = &rotor->bearings;
    int last = b->speed_count - 2;
    if (line >= 0 && line <= last && b->speeds[line] <= speed && speed <= b->speeds[line + 1]) {
        return line;
    }
    for (line = 0; line < last && speed >= b->speeds[line + 1]; line++) {
    }
    return line;
}

bool linear_rotor_holds(const LinearRotor *rotor, double speed)
{
    const Bearings *b = &rotor->bearings;
    const double *ends = b->speeds, slack = b->count ? TABLE_ROUNDING * ends[b->speed_count - 1] : 0.0;
    return !b->count || (ends[0] - slack <= speed && speed <= ends[b->speed_count - 1] + slack);
}

void linear_rotor_bearing(const LinearRotor *rotor, int bearing, int line, double *still, double *slope)
{
    const Bearings *b = &rotor->bearings;
    const double *first = b->values + ((size_t)bearing * (size_t)b->speed_count + (size_t)line) * BEARING_NUMBERS;
    const double begin = b->speeds[line], length = b->speeds[line + 1] - begin;
    int k;
    for (k = 0; k < BEARING_NUMBERS; k++) {
        slope[k] = (first[BEARING_NUMBERS + k] - first[k]) / length;
        still[k] = first[k] - slope[k] * begin;
    }
}

int linear_rotor_isotropic(const LinearRotor *rotor)
{
    const int square = rotor->stations * rotor->stations;
    int k;
    if (rotor->sliders || rotor->crossed) {
        return 0;
    }
    for (k = 0; k < square; k++) {
        if (rotor->stiffness_x[k] != rotor->stiffness_y[k] ||
            rotor->damping_x[k] != rotor->damping_y[k]) {
            return 0;
        }
    }
    return 1;
}

LinearRotor linear_rotor_with_added_mass(const LinearRotor *rotor, const double *added_mass,
                                         double *mass)
{
    const int n = rotor->stations;
    LinearRotor loaded = *rotor;
    int i, j, k;
    for (i = 0; i < n; i++) {
        for (j = 0; j < n; j++) {
            double sum = 0.0;
            for (k = 0; k < rotor->plane_count; k++) {
                sum += rotor->planes[k * n + i] * (added_mass[k] * rotor->planes[k * n + j]);
            }
            mass[i * n + j] = rotor->mass[i * n + j] + sum;
        }
    }
    loaded.mass = mass;
    return loaded;
}

int linear_rotor_heavy(const LinearRotor *rotor)
{
    return rotor->gravity[0] != 0.0 || rotor->gravity[1] != 0.0;
}

/* What bearings that change with the speed add to matrices of two axes. */
static void add_bearings(const LinearRotor *rotor, double speed, double *damping, double *stiffness)
{
    const int n = rotor->stations, fixed = rotor->bearings.line;
    const int line = fixed < 0 ? linear_rotor_line(rotor, speed, -1) : fixed;
    double still[BEARING_NUMBERS], slope[BEARING_NUMBERS];
    int b, i, j, k;
    for (b = 0; b < rotor->bearings.count; b++) {
        const double *row = rotor->bearings.rows + b * n;
        linear_rotor_bearing(rotor, b, line, still, slope);
        for (k = 0; k < BEARING_NUMBERS; k++) {
            double *matrix = k < BEARING_NUMBERS / 2 ? stiffness : damping;
            const int to = k / 2 % 2, by = k % 2;
            const double value = still[k] + speed * slope[k];
            for (i = 0; i < n; i++) {
                for (j = 0; j < n; j++) {
                    matrix[(2 * i + to) * 2 * n + 2 * j + by] += row[i] * value * row[j];
                }
            }
        }
    }
}

/* Mass, velocity and displacement matrices (dof, dof) at a constant speed. */
static void set_coefficients(const LinearRotor *rotor, double speed, double *mass, double *damping,
                             double *stiffness)
{
    const int n = rotor->stations, isotropic = linear_rotor_isotropic(rotor);
    int i, j;
    matrix_per_axis(isotropic ? 2 : 1, isotropic ? 1 : 2, n, n, rotor->mass, mass);
    for (i = 0; i < n; i++) {
        for (j = 0; j < n; j++) {
            const int k = i * n + j;
            const double turned = speed * rotor->gyroscopic[k];
            const double followed = speed * rotor->internal_damping[k];
            if (isotropic) {
                damping[2 * k] = rotor->damping_x[k] + rotor->internal_damping[k];
                damping[2 * k + 1] = -turned;
                stiffness[2 * k] = rotor->stiffness_x[k];
                stiffness[2 * k + 1] = -followed;
            } else {
                const int xx = 4 * i * n + 2 * j, xy = xx + 1, yx = xx + 2 * n, yy = yx + 1;
                damping[xx] = rotor->damping_x[k] + rotor->internal_damping[k];
                damping[xy] = rotor->damping_xy[k] + turned;
                damping[yx] = rotor->damping_yx[k] - turned;
                damping[yy] = rotor->damping_y[k] + rotor->internal_damping[k];
                stiffness[xx] = rotor->stiffness_x[k];
                stiffness[xy] = rotor->stiffness_xy[k] + followed;
                stiffness[yx] = rotor->stiffness_yx[k] - followed;
                stiffness[yy] = rotor->stiffness_y[k];
            }
        }
    }
    add_bearings(rotor, speed, damping, stiffness);
}

int linear_rotor_sag(const LinearRotor *rotor, double speed, double *sag, double *scratch,
                     Failure *failure)
{
    const int axes = linear_rotor_isotropic(rotor) ? 1 : 2, parts = 3 - axes;
    const int dof = axes * rotor->stations;
    const size_t square = (size_t)dof * dof * parts;
    double *mass = scratch, *damping = mass + square, *stiffness = damping + square;
    double *field = stiffness + square;
    int k;
    set_coefficients(rotor, speed, mass, damping, stiffness);
    for (k = 0; k < 2 * rotor->stations; k++) {
        field[k] = rotor->gravity[k % 2];
    }
    matrix_product(parts, dof, dof, 1, mass, field, sag);
    return matrix_solve(parts, dof, 1, stiffness, sag)
               ? fail(failure, "gravity: supports without stiffness cannot carry the rotor's weight")
               : FINE;
}

int linear_rotor_rows(const LinearRotor *rotor, double speed, double *rows, double *scratch,
                      Failure *failure)
{
    const int axes = linear_rotor_isotropic(rotor) ? 1 : 2, parts = 3 - axes;
    const int n = rotor->stations, p = rotor->plane_count, dof = axes * n;
    const int width = 2 * dof + axes * (p + 1), e = 2 * dof + axes * p;
    const size_t square = (size_t)dof * dof * parts, length = (size_t)width * parts;
    const double squared = speed * speed;
    double *mass = scratch, *damping = mass + square, *stiffness = damping + square, *row = rows;
    int i, k;
    set_coefficients(rotor, speed, mass, damping, stiffness);
    fill_doubles(dof * length, 0.0, rows);
    for (i = 0; i < dof; i++, row += length) {
        const int station = i / axes, axis = i % axes;
        const double x = squared * rotor->unbalance[2 * station];
        const double y = squared * rotor->unbalance[2 * station + 1];
        for (k = 0; k < dof * parts; k++) {
            row[k] = -stiffness[i * dof * parts + k];
            row[dof * parts + k] = -damping[i * dof * parts + k];
        }
        for (k = 0; k < p; k++) {
            row[(2 * dof + axes * k + axis) * parts] = rotor->planes[k * n + station];
        }
        row[e * parts] = axis ? y : x;
        row[e * parts + 1] = axes == 1 ? y : axis ? x : -y;
    }
    return matrix_solve(parts, dof, width, mass, rows)
               ? fail(failure, SINGULAR_MATRIX)
               : FINE;
}

void combine_vectors(const double *rows, int count, int n, const double *vectors, double *result)
{
    int i, j;
    for (i = 0; i < count; i++, result += 2) {
        result[0] = result[1] = 0.0;
        for (j = 0; j < n; j++) {
            result[0] += rows[i * n + j] * vectors[2 * j];
            result[1] += rows[i * n + j] * vectors[2 * j + 1];
        }
    }
}

/* Im(a* b). */
static double crossed(Complex a, Complex b)
{
    return a.re * b.im - a.im * b.re;
}

/* a - i w b, the slope of a vector with value b in axes that turn at w. */
static Complex seen_turning(Complex a, double w, Complex b)
{
    return complex_of(a.re + w * b.im, a.im - w * b.re);
}

void linear_rotor_torque(const LinearRotor *rotor, const double *state, const double *rates,
                         const Spin *spin, double *torque)
{
    const int n = rotor->stations;
    const Complex *q = (const Complex *)(const void *)state;
    const Complex *v = (const Complex *)(const void *)rates, *a = v + n, *j = a + n;
    const Complex turned = rect(1.0, spin->angle), gravity = {rotor->gravity[0], rotor->gravity[1]};
    const double w = spin->speed, change = spin->rates[0];
    int i, k;
    torque[0] = torque[1] = 0.0;
    for (i = 0; i < n; i++) {
        const Complex unbalance = complex_product(
            complex_of(rotor->unbalance[2 * i], rotor->unbalance[2 * i + 1]), turned);
        const Complex falling = complex_difference(a[i], gravity);
        torque[0] -= crossed(unbalance, falling);
        torque[1] -= crossed(unbalance, seen_turning(j[i], w, falling));
        for (k = 0; k < n; k++) {
            const double internal = rotor->internal_damping[i * n + k];
            const Complex sheared = seen_turning(v[k], w, q[k]);
            const Complex shearing = seen_turning(seen_turning(a[k], w, v[k]), change, q[k]);
            torque[0] += internal * crossed(q[i], sheared);
            torque[1] += internal * (crossed(v[i], sheared) + crossed(q[i], shearing));
        }
    }
}
