/* Matrices of the rigid rotor on two supports and of the flexible shaft with n discs; the parameters
   are within the limits of their variables. */
#include "base/elementary.h"
#include "base/matrix.h"
#include "constants.h"
#include "rotor/linear_rotor.h"
#include "rotor/shaft.h"

static void add_unbalance(Complex moment, double share, double *to)
{
    to[0] += share * moment.re;
    to[1] += share * moment.im;
}

/* Row (2,) that gives the displacement at a position [m from support 1] from the supports'. */
static void line_row(double position, double span, double *row)
{
    const double share = position / span;
    row[0] = 1.0 - share;
    row[1] = share;
}

int linear_rotor_two_support(const double *values, int unbalances, LinearRotor *rotor,
                             Failure *failure)
{
    const double mass = values[0], inertia = values[1], polar_inertia = values[2];
    const double span = values[3], com = values[4], tilt[2] = {-1.0 / span, 1.0 / span};
    const double *support = values + 5, *planes = support + 8, *u = planes + rotor->plane_count;
    double at_centre[2], row[2];
    int i, j, k;
    if (!(polar_inertia <= 2.0 * inertia)) {
        return fail(failure, "polar_inertia = %v kg m^2: must be 0 to 2 inertia = %6", polar_inertia,
                    2.0 * inertia);
    }
    line_row(com, span, at_centre);
    for (i = 0; i < 2; i++, support += 4) {
        for (j = 0; j < 2; j++) {
            rotor->mass[2 * i + j] =
                mass * at_centre[i] * at_centre[j] + inertia * tilt[i] * tilt[j];
            rotor->gyroscopic[2 * i + j] = polar_inertia * tilt[i] * tilt[j];
        }
        rotor->stiffness_x[3 * i] = support[0];
        rotor->stiffness_y[3 * i] = support[1];
        rotor->damping_x[3 * i] = support[2];
        rotor->damping_y[3 * i] = support[3];
    }
    for (k = 0; k < rotor->plane_count; k++) {
        line_row(planes[k], span, rotor->planes + 2 * k);
    }
    for (k = 0; k < unbalances; k++, u += 3) {
        const Complex moment = rect(u[1], u[2]);
        line_row(u[0], span, row);
        add_unbalance(moment, row[0], rotor->unbalance);
        add_unbalance(moment, row[1], rotor->unbalance + 2);
    }
    return FINE;
}

static int check_discs(int n, const Flexible *v, Failure *failure)
{
    int k;
    for (k = 1; k < n; k++) {
        if (v->stations[k] - v->stations[k - 1] <= 0.0) {
            return fail(failure, "stations = %l: must be at least two, each beyond the last [m]",
                        v->stations, (size_t)n);
        }
    }
    return v->supports[0] != v->supports[1]
               ? FINE
               : fail(failure, "supports = [%u, %u]: must be two different stations, 1 to %u",
                      (unsigned long)v->supports[0], (unsigned long)v->supports[1], (unsigned long)n);
}

static int set_shaft_unbalance(const Flexible *v, LinearRotor *rotor, double *scratch,
                               Failure *failure)
{
    const int n = rotor->stations;
    const double *z = v->stations;
    int k, j;
    for (k = 0; k < v->unbalance_count; k++) {
        const double *u = v->unbalances + 3 * k;
        int station = 0;
        for (j = 1; j < n; j++) {
            if (absolute(z[j] - u[0]) < absolute(z[station] - u[0])) {
                station = j;
            }
        }
        if (absolute(z[station] - u[0]) <= SAME_PLACE * (z[n - 1] - z[0])) {
            add_unbalance(rect(u[1], u[2]), 1.0, rotor->unbalance + 2 * station);
            continue;
        }
        if (v->compliance || u[0] < z[0] || u[0] > z[n - 1]) {
            return fail(failure, "unbalances: position = %v m: must be a disc's, one of %l, or "
                        "between them on a uniform shaft", u[0], z, (size_t)n);
        }
        beam_shares(n, z, u[0], scratch, scratch + n);
        for (j = 0; j < n; j++) {
            add_unbalance(rect(u[1], u[2]), scratch[j], rotor->unbalance + 2 * j);
        }
    }
    return FINE;
}

size_t linear_rotor_flexible_scratch(int stations)
{
    const size_t n = (size_t)stations, size = n - 2;
    return size * size + size * (2 * n - 1) + 3 * n;
}

int linear_rotor_flexible(const Flexible *values, LinearRotor *rotor, double *scratch,
                          Failure *failure)
{
    const int n = rotor->stations, size = n - 2;
    const int ends[2] = {values->supports[0] - 1, values->supports[1] - 1};
    double *delta = scratch, *work = scratch + size * size, softest = 0.0;
    double *const rows = rotor->deflection; /* all zero where every disc sits at a support */
    int k, code = check_discs(n, values, failure);
    if (code) {
        return code;
    }
    if (size > 0) {
        bending_rows(n, values->stations, ends[0], ends[1], rows);
    }
    if (values->compliance) {
        code = given_compliance(size, values->compliance, delta, failure);
    } else {
        beam_compliance(n, values->stations, rows, values->bending_stiffness, delta, work);
    }
    if (!code) {
        code = shaft_stiffness(n, delta, rows, rotor->stiffness_x, work, failure);
    }
    if (code) {
        return code;
    }
    if (values->internal_damping != 0.0 && size == 0) {
        return fail(failure, "internal_damping: a shaft with discs at its supports only cannot bend");
    }
    /* Dubovik's p belongs to the stiffness 1/delta that a disc feels where the shaft is softest */
    for (k = 0; k < size; k++) {
        softest = k ? larger(softest, delta[k * size + k]) : delta[0];
    }
    for (k = 0; k < n * n; k++) {
        rotor->internal_damping[k] = values->internal_damping * softest * rotor->stiffness_x[k];
        rotor->stiffness_y[k] = rotor->stiffness_x[k];
    }
    for (k = 0; k < n; k++) {
        rotor->mass[k * n + k] = values->masses[k];
    }
    for (k = 0; k < 2; k++) {
        const int at = ends[k] * n + ends[k];
        const double *support = values->carriers + 4 * k;
        rotor->stiffness_x[at] += support[0];
        rotor->stiffness_y[at] += support[1];
        rotor->damping_x[at] = support[2];
        rotor->damping_y[at] = support[3];
    }
    for (k = 0; k < rotor->plane_count; k++) {
        rotor->planes[k * n + values->ports[k]] = 1.0;
    }
    return set_shaft_unbalance(values, rotor, scratch, failure);
}
