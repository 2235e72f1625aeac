/* Derivatives of the rotor's outputs: by the inputs, exact, and by time. */
#include <string.h>

#include "base/elementary.h"
#include "base/matrix.h"
#include "units/rotor.h"

/* Change of the computed outputs by a change of the forces' values and slopes, (2p,) each. */
static int force_response(Unit *unit, const double *values, const double *slopes, double *change)
{
    Rotor *own = unit->own;
    const size_t n = (size_t)own->stations, p = (size_t)own->planes;
    const double c = cosine(unit->memory[REST]), s = sine(unit->memory[REST]);
    const double speed = rotor_drive(unit)[0], *matrix = rotor_matrix(unit, speed, 0.0);
    double *forces = own->operand + 4 * n;
    if (!matrix) {
        return 1;
    }
    if (own->slider_count) {
        if (rotor_friction_response(unit, values, slopes)) {
            return 1;
        }
        rotor_put(own, own->result + 4 * n, unit->memory[REST], speed, 0.0, change);
        return 0;
    }
    memset(own->operand, 0, (4 * n + 2 * SIGNAL_ORDERS * p + 2) * sizeof(double));
    memcpy(forces, values, 2 * p * sizeof(double));
    memcpy(forces + 2 * p, slopes, 2 * p * sizeof(double));
    if (own->turning) {
        rotor_rotated(forces, 2 * p, c, s, forces);
    }
    rotor_apply(own, matrix);
    rotor_put(own, own->result + 4 * n, unit->memory[REST], speed, 0.0, change);
    return 0;
}

/* Outputs with speed, acceleration or its slope (k = 0, 1, 2) changed by `by`. */
static int outputs_beside(Unit *unit, int k, double by, double *out)
{
    double *driven = rotor_drive(unit) + k;
    const double before = *driven;
    int wrong;
    *driven = before + by;
    wrong = rotor_outputs_now(unit, out);
    *driven = before;
    return wrong;
}

/* Add the change by speed, angular acceleration and its slope.  Outputs are cubic in the first and
   linear in the others, so that these differences are exact for any distance h. */
static int add_drive_response(Unit *unit, const double *seed, double *change)
{
    const double speed = seed[0];
    Rotor *own = unit->own;
    const double size = larger(1.0, absolute(rotor_drive(unit)[0]));
    const double far = larger(absolute(rotor_drive(unit)[1]), size * size);
    double **end = own->ends;
    int k, j;
    if (speed != 0.0) {
        if (outputs_beside(unit, 0, size, end[0]) || outputs_beside(unit, 0, -size, end[1]) ||
            outputs_beside(unit, 0, 2.0 * size, end[2]) ||
            outputs_beside(unit, 0, -2.0 * size, end[3])) {
            return 1;
        }
        for (k = 0; k < 4 * own->planes; k++) {
            change[k] += speed * (8.0 * (end[0][k] - end[1][k]) - (end[2][k] - end[3][k])) /
                         (12.0 * size);
        }
    }
    for (j = 1; j <= 2; j++) {
        if (seed[j] == 0.0) {
            continue;
        }
        if (outputs_beside(unit, j, far, end[0]) || outputs_beside(unit, j, -far, end[1])) {
            return 1;
        }
        for (k = 0; k < 4 * own->planes; k++) {
            change[k] += seed[j] * (end[0][k] - end[1][k]) / (2.0 * far);
        }
    }
    return 0;
}

/* Torque with forces (values, then slopes), angular acceleration and its slope changed by `by` times
   so much, and the speed by `faster`. */
static int torque_beside(Unit *unit, const double *forces, const double *spin, double by,
                         double faster, double *torque)
{
    double *drive = rotor_drive(unit);
    const int count = SPUN + 4 * ((const Rotor *)unit->own)->planes;
    double *kept = ((const Rotor *)unit->own)->operand;
    int k, wrong;
    memcpy(kept, drive, (size_t)count * sizeof(double));
    drive[0] += faster;
    for (k = SPIN_UP; k < count; k++) {
        drive[k] += by * (k < SPUN ? (k < SPIN_UP + 2 ? spin[k] : 0.0) : forces[k - SPUN]);
    }
    wrong = rotor_torque_now(unit, torque);
    memcpy(drive, kept, (size_t)count * sizeof(double));
    return wrong;
}

/* Change of the torque and its slope: cubic in the speed, linear in all else. */
static int rotor_torque_response(Unit *unit, const double *forces, const double *seed, double *change)
{
    const double size = larger(1.0, absolute(rotor_drive(unit)[0])), far = size * size;
    double end[6][2];
    int k;
    if (torque_beside(unit, forces, seed, far, 0.0, end[0]) ||
        torque_beside(unit, forces, seed, -far, 0.0, end[1])) {
        return 1;
    }
    for (k = 0; k < 4 && seed[0] != 0.0; k++) {
        static const double steps[4] = {1.0, -1.0, 2.0, -2.0};
        if (torque_beside(unit, forces, seed, 0.0, steps[k] * size, end[2 + k])) {
            return 1;
        }
    }
    for (k = 0; k < 2; k++) {
        change[k] = (end[0][k] - end[1][k]) / (2.0 * far);
        if (seed[0] != 0.0) {
            change[k] += seed[0] *
                         (8.0 * (end[2][k] - end[3][k]) - (end[4][k] - end[5][k])) / (12.0 * size);
        }
    }
    return 0;
}

int rotor_directional(Unit *unit, const double *seed, double *change)
{
    Rotor *own = unit->own;
    const int p = own->planes;
    const double *forces = seed + p + SPUN;
    double *values = own->ends[1], *slopes = values + 2 * p, *now = own->ends[0];
    int k;
    memset(change, 0,
           (unit->layout.computed.count + unit->layout.observed.count) * sizeof(double));
    if (rotor_outputs_now(unit, now)) {
        return 1;
    }
    for (k = 0; k < 2 * p; k++) {
        /* more mass on a plane is the force -m a less */
        values[k] = forces[k] - seed[k / 2] * now[k];
        slopes[k] = forces[2 * p + k] - seed[k / 2] * now[2 * p + k];
    }
    own->frozen = 1; /* the sliders are as the outputs found them */
    /* slopes stand behind the values */
    k = rotor_torque_response(unit, values, seed + p,
                        change + unit->layout.real_count - unit->layout.computed.first - 2) ||
        force_response(unit, values, slopes, change) ||
        add_drive_response(unit, seed + p, change);
    own->frozen = 0;
    return k;
}

int rotor_slope(Unit *unit, size_t reference, double *value)
{
    const Rotor *own = unit->own;
    const size_t n = 2 * (size_t)own->stations, p = 2 * (size_t)own->planes;
    const double *velocity = unit->memory + MOTION + n;
    const size_t output = reference - unit->layout.observed.first;
    if (reference < unit->layout.observed.first) {
        return 1;
    }
    if (reference == unit->layout.real_count - 2) {
        const int wrong = unit_refresh(unit, FRESH);
        *value = unit->real[reference + 1];
        return wrong;
    }
    if (output == 0) {
        *value = unit->memory[MOTION + 2 * n];
        return 0;
    }
    if (output <= n) {
        *value = velocity[output - 1];
        return 0;
    }
    if (output > 2 * n && output <= 2 * n + p) {
        const size_t k = output - 2 * n - 1;
        double both[2];
        rotor_vectors_at(own->rotor.planes + k / 2 * (n / 2), 1, own->stations, velocity, both);
        *value = both[k % 2];
        return 0;
    }
    return 1;
}
