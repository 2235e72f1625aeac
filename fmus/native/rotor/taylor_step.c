#include "rotor/taylor_step.h"

#include "base/elementary.h"
#include "base/matrix.h"
#include "rotor/first_fall.h"

enum { TERMS = MOST_COEFFICIENTS - 1 }; /* 0.5^18/18! is far below rounding */
enum { RESTRAINT_TERMS = TERMS + 3 };
enum { MOST_STRETCHES = 10000, MOST_SWEEPS = 10000, DERIVATIVES = 3 };
static const double REACH = 0.5, SWEEP_CONVERGED = 1e-15;
static const double ROUNDING_OF_TERMS = 1e-17; /* of the largest term of a stretch */
static const double LIMIT_ROUNDING = 1e-12; /* of a limit: a force so near to it has reached it */

static int doubles_of_row(int stations, int planes)
{
    return 4 * stations + 2 * planes + 2;
}

size_t holds_doubles(const Holds *holds)
{
    return SLIDER_DOUBLES * (size_t)holds->slider_count + STOP_DOUBLES * (size_t)holds->stop_count;
}

size_t taylor_step_size(int stations, int planes, const Holds *holds)
{
    const size_t half = 2 * (size_t)stations, m = (size_t)holds->slider_count, terms = TERMS + 1;
    const size_t length = (size_t)doubles_of_row(stations, planes);
    const size_t restraints = (size_t)(holds->cubic_count + holds->stop_count);
    return 3 * half * length + half * m + terms * (length + m + 2) + (DERIVATIVES + 2) * half + m * m + 3 * m +
           holds_doubles(holds) + restraints * (half + restraint_series_size(RESTRAINT_TERMS));
}

static double *next_block(double **memory, size_t count)
{
    double *first = *memory;
    *memory += count;
    return first;
}

/* Largest sum of a row's absolute values by displacements, or by velocities. */
static double row_norm(const TaylorStep *method, int velocities, const double *matrix)
{
    double norm = 0.0;
    int i, k;
    for (i = 0; i < method->dof; i++) {
        const double *row = matrix + i * method->length + velocities * method->half;
        double sum = 0.0;
        for (k = 0; k < method->half; k++) {
            sum += absolute(row[k]);
        }
        norm = larger(norm, sum);
    }
    return norm;
}

static void set_norms(TaylorStep *method)
{
    const int dof = method->dof, m = method->count;
    int i, j, k;
    copy_doubles((size_t)dof * method->length, method->still, method->matrix);
    for (j = 0; j < m; j++) {
        for (k = 0; k < method->half; k++) {
            const double share = slider_share(method->sliders + j, k);
            for (i = 0; i < dof && share != 0.0; i++) {
                method->matrix[i * method->length + k] -= method->push[i * m + j] * method->sliders[j].stiffness * share;
            }
        }
    }
    method->norms[0] = row_norm(method, 0, method->matrix);
    method->norms[1] = row_norm(method, 0, method->per_speed);
    method->norms[2] = row_norm(method, 1, method->matrix);
    method->norms[3] = row_norm(method, 1, method->per_speed);
}

/* The rows of linear_rotor.h in what no speed changes and what is proportional to it. */
static int split_rows(const LinearRotor *rotor, TaylorStep *made, double *scratch, Failure *failure)
{
    const int unbalance = made->length - 2;
    int i, k, code = linear_rotor_rows(rotor, 0.0, made->still, scratch, failure);
    code = code ? code : linear_rotor_rows(rotor, 1.0, made->per_speed, scratch, failure);
    for (i = 0; i < made->dof && !code; i++) {
        double *still = made->still + i * made->length;
        double *per_speed = made->per_speed + i * made->length;
        for (k = 0; k < made->length; k++) {
            if (k < unbalance) {
                per_speed[k] -= still[k];
            } else { /* its pull w^2 is among what it multiplies */
                still[k] = per_speed[k];
                per_speed[k] = 0.0;
            }
        }
    }
    return code;
}

/* Columns of M^-1 by which the sliders push. */
static int set_push(const LinearRotor *rotor, TaylorStep *made, double *mass, Failure *failure)
{
    const int n = rotor->stations, m = made->count;
    int j, k;
    matrix_per_axis(1, 2, n, n, rotor->mass, mass);
    for (k = 0; k < made->half; k++) {
        for (j = 0; j < m; j++) {
            made->push[k * m + j] = slider_share(made->sliders + j, k);
        }
    }
    return matrix_solve(1, 2 * n, m, mass, made->push)
               ? fail(failure, SINGULAR_MATRIX)
               : FINE;
}

/* Acceleration of every place by a force across the row of each cubic spring and stop. */
static int set_answers(const LinearRotor *rotor, TaylorStep *made, double *mass, Failure *failure)
{
    const Holds *holds = &made->holds;
    const int n = rotor->stations;
    int j;
    for (j = 0; j < holds->cubic_count + holds->stop_count; j++) {
        const double *rows =
            j < holds->cubic_count ? holds->cubics[j].rows : holds->stops[j - holds->cubic_count].rows;
        double *answer = made->answers + j * made->half;
        matrix_per_axis(1, 2, n, n, rotor->mass, mass);
        copy_doubles((size_t)made->half, rows, answer);
        if (matrix_solve(1, 2 * n, 1, mass, answer)) {
            return fail(failure, SINGULAR_MATRIX);
        }
    }
    return FINE;
}

int taylor_step_in(double *memory, const LinearRotor *rotor, const Holds *holds, double *scratch, TaylorStep *made,
                   Failure *failure)
{
    const Slider *sliders = holds->sliders;
    const int count = holds->slider_count;
    const int n = rotor->stations, p = rotor->plane_count, isotropic = linear_rotor_isotropic(rotor);
    const size_t m = (size_t)count, half = 2 * (size_t)n, terms = TERMS + 1;
    const size_t length = (size_t)doubles_of_row(n, p);
    int i, j, code;
    made->sliders = sliders;
    made->count = count;
    made->parts = isotropic ? 2 : 1;
    made->dof = isotropic ? n : 2 * n;
    made->half = 2 * n;
    made->length = (int)length;
    made->plane_count = p;
    made->planes = rotor->planes;
    made->gravity[0] = rotor->gravity[0];
    made->gravity[1] = rotor->gravity[1];
    made->still = next_block(&memory, half * length);
    made->per_speed = next_block(&memory, half * length);
    made->matrix = next_block(&memory, half * length);
    made->push = next_block(&memory, half * m);
    made->series = next_block(&memory, terms * length);
    made->forces = next_block(&memory, terms * m);
    made->turn = next_block(&memory, terms * 2);
    made->rate = next_block(&memory, half);
    made->faster = next_block(&memory, (DERIVATIVES + 1) * half);
    made->mobility = next_block(&memory, m * m);
    made->hold = next_block(&memory, 2 * m);
    made->slider_states = next_block(&memory, holds_doubles(holds));
    made->limits = next_block(&memory, m);
    made->holds = *holds;
    made->answers = next_block(&memory, half * (size_t)(holds->cubic_count + holds->stop_count));
    made->restraint_data = memory;
    for (i = 0; i < count; i++) {
        for (j = 0; j < i; j++) {
            if (slider_is_rigid(sliders + i) && slider_is_rigid(sliders + j) &&
                slider_place(sliders + i) == slider_place(sliders + j)) {
                return fail(failure, "sliders: two rigid ones at one support and axis are one "
                            "with the sum of their limits; give that, or a stiffness");
            }
        }
    }
    code = split_rows(rotor, made, scratch, failure);
    if (!code && count) {
        code = set_push(rotor, made, scratch, failure);
    }
    if (!code) {
        code = set_answers(rotor, made, scratch, failure);
    }
    if (!code) {
        set_norms(made);
    }
    return code;
}

/* -- cubic springs and stops ------------------------------------------------------------------------ */

/* The series of a cubic spring, or of a stop behind them. */
static RestraintSeries restraint_of(const TaylorStep *method, int number)
{
    return restraint_series_in(
        method->restraint_data + (size_t)number * restraint_series_size(RESTRAINT_TERMS), RESTRAINT_TERMS);
}

static double *stop_states_of(const TaylorStep *method, double *slider_states)
{
    return slider_states + SLIDER_DOUBLES * method->holds.slider_count;
}

/* A stop is in this state from now on. */
static void turn_stop(double *stop_state, int state)
{
    stop_state[STOP_TOUCHES] += state == STOP_PRESSES && stop_state[STOP_STATE] != STOP_PRESSES;
    stop_state[STOP_STATE] = state;
}

/* Let each stop be in the state that follows from the motion. */
static void settle_stops(const TaylorStep *method, const double *state, double *slider_states)
{
    double *stop_state = stop_states_of(method, slider_states);
    int k;
    for (k = 0; k < method->holds.stop_count; k++, stop_state += STOP_DOUBLES) {
        const Stop *stop = method->holds.stops + k;
        double across[2], rate[2];
        restraint_displacement(stop->rows, method->half / 2, state, across);
        restraint_displacement(stop->rows, method->half / 2, state + method->half, rate);
        turn_stop(stop_state, stop_state_of(stop, across, rate, (int)stop_state[STOP_STATE]));
    }
}

/* Add coefficient k of the accelerations by cubic springs and stops over a stretch h. */
static void add_restraints(TaylorStep *method, const double *slider_states, int k, double h, const double *motion)
{
    const Holds *holds = &method->holds;
    const int n = method->half / 2, count = holds->cubic_count + holds->stop_count;
    const double *stop_state = slider_states + SLIDER_DOUBLES * holds->slider_count;
    int j, i;
    for (j = 0; j < count; j++) {
        const int number = j - holds->cubic_count;
        RestraintSeries series = restraint_of(method, j);
        double force[2] = {0.0, 0.0}, across[2];
        if (number < 0) {
            restraint_displacement(holds->cubics[j].rows, n, motion, across);
            restraint_displace(&series, k, across);
            cubic_series_force(holds->cubics + j, &series, k, force);
        } else {
            Stop stop = holds->stops[number];
            if (k == 0) {
                restraint_displacement(stop.rows, n, motion, across);
                restraint_displace(&series, 0, across);
            }
            restraint_displacement(stop.rows, n, motion + method->half, across);
            across[0] *= h / (k + 1);
            across[1] *= h / (k + 1);
            restraint_displace(&series, k + 1, across);
            stop.damping /= h;
            if (stop_state[STOP_DOUBLES * number + STOP_STATE] == STOP_PRESSES) {
                stop_series_force(&stop, &series, k, force);
            } else if (stop_state[STOP_DOUBLES * number + STOP_STATE] == STOP_BEYOND) {
                stop_series_pressure(&stop, &series, k);
            }
        }
        for (i = 0; i < method->half; i++) {
            method->rate[i] += method->answers[j * method->half + i] * force[i % 2];
        }
    }
}

/* The part of a stretch over which the terms left out are below rounding. */
static double part_in_reach(const TaylorStep *method)
{
    static const double SHORTER = 0.9;
    const int half = method->half;
    double part = 1.0;
    int which, k, i;
    if (!method->holds.cubic_count && !method->holds.stop_count) {
        return part;
    }
    for (which = 0; which < 2; which++) {
        double size = 0.0, last = 0.0;
        for (k = 0; k <= TERMS; k++) {
            for (i = 0; i < half; i++) {
                const double term = absolute(method->series[k * method->length + which * half + i]);
                size = larger(size, term);
                last = k >= TERMS - 1 ? larger(last, term) : last;
            }
        }
        while (last > ROUNDING_OF_TERMS * size) {
            int power;
            part *= SHORTER;
            for (power = 0; power < TERMS - 1; power++) {
                last *= SHORTER;
            }
        }
    }
    return part;
}

/* -- stretches -------------------------------------------------------------------------------------- */

double taylor_stretch(const TaylorStep *method, const Excitation *excitation, double t)
{
    const Spin now = spin_after(&excitation->spin, t);
    const double *norms = method->norms, *rates = now.rates;
    const double w = absolute(now.speed);
    const double rate = square_root(norms[0] + w * norms[1]) + norms[2] + w * norms[3] + w;
    double h = REACH / (rate + square_root(absolute(rates[0])));
    while (h * h * h *
               (absolute(rates[1]) +
                h * (absolute(rates[2]) / 2.0 + h * absolute(rates[3]) / 6.0)) >
           REACH * REACH * REACH) {
        h *= 0.5;
    }
    return h;
}

/* Whether a slider is held by a constraint: rigid, and it sticks. */
static bool is_fixed(const TaylorStep *method, const double *slider_states, int j)
{
    return slider_is_rigid(method->sliders + j) && slider_states[SLIDER_DOUBLES * j + SLIPS] == 0.0;
}

/* Forces of rigid sliders that stick, from the rates without them, which become 0 there. */
static int hold_fixed(TaylorStep *method, const double *slider_states, double *rate, double *forces)
{
    const int m = method->count;
    int i, j, row = 0, fixed = 0;
    for (j = 0; j < m; j++) {
        fixed += is_fixed(method, slider_states, j);
    }
    for (i = 0; i < m && fixed; i++) {
        const int place = slider_place(method->sliders + i);
        int column = 0;
        if (!is_fixed(method, slider_states, i)) {
            continue;
        }
        for (j = 0; j < m; j++) {
            if (is_fixed(method, slider_states, j)) {
                method->mobility[row * fixed + column++] = method->push[place * m + j];
            }
        }
        method->hold[row++] = -rate[place];
    }
    if (fixed && matrix_solve(1, fixed, 1, method->mobility, method->hold)) {
        return 1;
    }
    for (j = 0, row = 0; j < m; j++) {
        if (is_fixed(method, slider_states, j)) {
            forces[j] = method->hold[row++];
            for (i = 0; i < method->dof; i++) {
                rate[i] += method->push[i * m + j] * forces[j];
            }
        }
    }
    for (j = 0; j < m; j++) {
        if (is_fixed(method, slider_states, j)) {
            rate[slider_place(method->sliders + j)] = 0.0;
        }
    }
    return 0;
}

/* Coefficients k of the sliders' forces, but of those that `hold_fixed` finds. */
static void set_forces(TaylorStep *method, const double *slider_states, int k, double *motion)
{
    double *forces = method->forces + k * method->count;
    int j;
    for (j = 0; j < method->count; j++) {
        const Slider *slider = method->sliders + j;
        const double *own = slider_states + SLIDER_DOUBLES * j;
        const int sticks = own[SLIPS] == 0.0;
        if (k) {
            const int pulls = sticks && slider->stiffness > 0.0 && !slider_is_loose(slider, own);
            forces[j] = pulls ? -slider->stiffness * slider_along(slider, method->half / 2, motion) : 0.0;
        } else if (sticks && slider_is_rigid(slider)) {
            forces[j] = motion[method->half + slider_place(slider)] = 0.0;
        } else {
            forces[j] = own[HOLDS];
        }
    }
}

/* Coefficient k of the acceleration, without the sliders that stick. */
static void set_rate(TaylorStep *method, const SpinSeries *spin, int k, double h, const double *slider_states,
                     const double *motion)
{
    const int parts = method->parts, dof = method->dof, m = method->count;
    const int length = method->length, width = length / parts;
    /* a rotor may be the same at every speed */
    const int changes = method->norms[1] > 0.0 || method->norms[3] > 0.0;
    const double *forces = method->forces + k * m;
    double *rate = method->rate;
    int i, j, back;
    matrix_product(parts, dof, width, 1, method->matrix, motion, rate);
    for (i = 0; i < method->half && !k; i++) {
        rate[i] += method->gravity[i % 2];
    }
    for (i = 0; i < dof && m; i++) {
        for (j = 0; j < m; j++) {
            rate[i] += method->push[i * m + j] * forces[j];
        }
    }
    for (back = 1; back < SPEED_TERMS && back <= k && changes; back++) {
        if (spin->speed[back] != 0.0) {
            matrix_product(parts, dof, width, 1, method->per_speed, motion - back * length,
                           method->faster);
            add_multiple(1, method->half, spin->speed + back, method->faster, rate);
        }
    }
    add_restraints(method, slider_states, k, h, motion);
}

/* Taylor coefficients of motion and friction over a stretch h from t on. */
static int set_series(TaylorStep *method, const double *state, const double *slider_states,
                      const Excitation *excitation, double t, double h, int terms, Failure *failure)
{
    const int half = method->half, length = method->length;
    const SpinSeries spin = spin_series(&excitation->spin, t, h);
    double *motion = method->series;
    int i, k;
    fill_pushes(excitation, &spin, t, h, terms, motion + 2 * half, length, method->turn);
    copy_doubles((size_t)method->dof * length, method->still, method->matrix);
    add_multiple(1, method->dof * length, spin.speed, method->per_speed, method->matrix);
    copy_doubles(2 * (size_t)half, state, motion);
    for (k = 0; k <= terms; k++, motion += length) {
        const double factor = h / (k + 1);
        set_forces(method, slider_states, k, motion);
        set_rate(method, &spin, k, h, slider_states, motion);
        if (hold_fixed(method, slider_states, method->rate, method->forces + k * method->count)) {
            return fail(failure, SINGULAR_MATRIX);
        }
        for (i = 0; i < half && k < terms; i++) {
            motion[length + i] = factor * motion[half + i];
            motion[length + half + i] = factor * method->rate[i];
        }
    }
    return FINE;
}

int taylor_resolve(TaylorStep *method, const double *state, double *slider_states,
                   const Excitation *excitation, double t, Failure *failure)
{
    const int m = method->count, half = method->half;
    double *found = method->hold, *free = method->hold + m, *without = method->slider_states;
    int j, k, resting = 0, sweep, code, settled = 0;
    settle_stops(method, state, slider_states);
    copy_doubles(holds_doubles(&method->holds), slider_states, without);
    for (j = 0; j < m; j++) {
        const Slider *slider = method->sliders + j;
        method->limits[j] = 0.0;
        if (slider_is_rigid(slider) && (slider_states[SLIDER_DOUBLES * j + SLIPS] == 0.0 ||
                                        state[half + slider_place(slider)] == 0.0)) {
            method->limits[j] = slider->limit;
            without[SLIDER_DOUBLES * j + SLIPS] = 1.0; /* as if without them */
            without[SLIDER_DOUBLES * j + HOLDS] = 0.0;
            resting++;
        }
    }
    if (!resting) {
        return FINE;
    }
    code = set_series(method, state, without, excitation, t, 1.0, 1, failure);
    if (code) {
        return code;
    }
    for (j = 0; j < m; j++) {
        found[j] = 0.0;
        free[j] = method->series[method->length + half + slider_place(method->sliders + j)];
    }
    for (sweep = 0; sweep < MOST_SWEEPS && !settled; sweep++) {
        settled = 1;
        for (j = 0; j < m; j++) {
            const double *mobility = method->push + slider_place(method->sliders + j) * m;
            const double limit = method->limits[j], before = found[j];
            double rate = free[j];
            if (limit == 0.0) {
                continue; /* it is no rigid one at rest */
            }
            for (k = 0; k < m; k++) {
                rate += mobility[k] * found[k];
            }
            found[j] = smaller(larger(before - rate / mobility[j], -limit), limit);
            settled &= absolute(found[j] - before) <= SWEEP_CONVERGED * limit;
        }
    }
    for (j = 0; j < m; j++) {
        if (method->limits[j] > 0.0) {
            slider_states[SLIDER_DOUBLES * j + SLIPS] =
                absolute(found[j]) < method->limits[j] ? 0.0 : -copy_sign(1.0, found[j]);
            slider_states[SLIDER_DOUBLES * j + HOLDS] = found[j];
        }
    }
    return FINE;
}

/* One quantity's coefficients, times `sign`, plus `base`. */
static void read_column(const double *from, int stride, double sign, double base, double *to)
{
    int k;
    for (k = 0; k <= TERMS; k++) {
        to[k] = sign * from[k * stride];
    }
    to[0] += base;
}

/* The coefficients of a slider's displacement, or with `first` of its rate, times `sign`. */
static void read_way(const TaylorStep *method, const Slider *slider, int first, double sign, double *to)
{
    int k;
    for (k = 0; k <= TERMS; k++) {
        to[k] = sign * slider_along(slider, method->half / 2, method->series + k * method->length + first);
    }
}

/* Acceleration by all limits at the place of a slider. */
static double limit_acceleration(const TaylorStep *method, int j)
{
    const Slider *slider = method->sliders + j;
    double limits = 0.0, mobility = 0.0;
    int k;
    for (k = 0; k < method->count; k++) {
        const Slider *other = method->sliders + k;
        const int beside = !other->row && !slider->row && slider_place(other) == slider_place(slider);
        limits += k == j || beside ? other->limit : 0.0;
    }
    for (k = 0; k < method->half; k++) {
        mobility += slider_share(slider, k) * method->push[k * method->count + j];
    }
    return mobility * limits;
}

static void keep_first(const double *function, const double *rounding, int number, double *first, int *which)
{
    const double found = find_first_fall(function, TERMS + 1, *first, rounding);
    if (found < *first) {
        *first = found;
        *which = number;
    }
}

/* Ends of the free strokes, and springs that become slack behind them. */
static void look_at_strokes(const TaylorStep *method, const double *slider_states, double *first, int *which)
{
    static const double none[3] = {0.0, 0.0, 0.0};
    const int m = method->count;
    double function[TERMS + 1];
    int j, side;
    for (j = 0; j < m; j++) {
        const Slider *slider = method->sliders + j;
        const double *own = slider_states + SLIDER_DOUBLES * j;
        for (side = -1; side <= 1 && slider_is_loose(slider, own); side += 2) {
            read_way(method, slider, 0, -side, function);
            function[0] = larger(0.0, slider->stroke - side * own[PLAY]);
            keep_first(function, none, j, first, which);
        }
        if (slider->stroke > 0.0 && own[SLIPS] == 0.0 && own[SIDE] != 0.0) {
            read_column(method->forces + j, m, -own[SIDE], 0.0, function);
            function[0] = larger(0.0, function[0]);
            keep_first(function, none, j, first, which);
        }
    }
}

/* Stops that are touched or let go; they are numbered behind the sliders. */
static void look_at_stops(const TaylorStep *method, const double *slider_states, double *first, int *which)
{
    const Holds *holds = &method->holds;
    const double *own = slider_states + SLIDER_DOUBLES * holds->slider_count;
    double function[TERMS + 1];
    int j, k;
    for (j = 0; j < holds->stop_count; j++, own += STOP_DOUBLES) {
        const Stop *stop = holds->stops + j;
        const RestraintSeries series = restraint_of(method, holds->cubic_count + j);
        const double square = stop->gap * stop->gap, way = own[STOP_STATE] == STOP_APART ? 1.0 : -1.0;
        const double of_square[3] = {LIMIT_ROUNDING * square, 0.0, 0.0};
        double of_force[3] = {0.0, 0.0, 0.0};
        if (own[STOP_STATE] != STOP_PRESSES) {
            for (k = 0; k <= TERMS; k++) {
                function[k] = -way * restraint_square(&series, k);
            }
            function[0] += way * square;
            keep_first(function, of_square, holds->slider_count + j, first, which);
        }
        if (own[STOP_STATE] != STOP_APART) {
            const double sign = own[STOP_STATE] == STOP_PRESSES ? 1.0 : -1.0;
            read_column(series.pressure, 1, sign, 0.0, function);
            of_force[0] = LIMIT_ROUNDING * stop->stiffness * series.distance[0];
            keep_first(function, of_force, holds->slider_count + j, first, which);
        }
    }
}

/* When, as a fraction of a stretch [s], which slider or stop changes first: -1 for none. */
static double find_first_event(const TaylorStep *method, const double *slider_states,
                               double stretch, double until, int *which)
{
    const int m = method->count;
    double function[TERMS + 1], first = until;
    int j, side;
    *which = -1;
    look_at_strokes(method, slider_states, &first, which);
    look_at_stops(method, slider_states, &first, which);
    for (j = 0; j < m; j++) {
        const double *own = slider_states + SLIDER_DOUBLES * j;
        const double limit = method->sliders[j].limit, slips = own[SLIPS];
        if (slider_is_loose(method->sliders + j, own)) {
            continue;
        }
        /* where a slider starts from rest the first acceleration may be rounding, too */
        const double still = LIMIT_ROUNDING * stretch * limit_acceleration(method, j);
        const double sticking[3] = {LIMIT_ROUNDING * limit, 0.0,
                                    0.5 * still * stretch * method->sliders[j].stiffness};
        const double slipping[3] = {0.0, still, 0.0};
        for (side = 0; side < (slips != 0.0 ? 1 : 2) && limit > 0.0; side++) {
            double found;
            if (slips != 0.0) {
                read_way(method, method->sliders + j, method->half, slips, function);
            } else {
                read_column(method->forces + j, m, side ? 1.0 : -1.0, limit, function);
            }
            found = find_first_fall(function, TERMS + 1, first, slips != 0.0 ? slipping : sticking);
            if (found < first) {
                first = found;
                *which = j;
            }
        }
    }
    return first;
}

/* Take the rounding of a rate that has come to 0 from the velocities. */
static void stop_at(const Slider *slider, int half, double *velocity)
{
    const double rate = slider_along(slider, half / 2, velocity);
    double square = 0.0;
    int k;
    for (k = 0; k < half; k++) {
        const double share = slider_share(slider, k);
        square += share * share;
    }
    for (k = 0; k < half; k++) {
        velocity[k] -= rate / square * slider_share(slider, k);
    }
}

/* The sliders after the event of slider j; `arrived`: by a motion, not at once. */
static int change_sliders(TaylorStep *method, double *state, double *slider_states,
                          const Excitation *excitation, double t, int j, int arrived,
                          Failure *failure)
{
    const Slider *slider = method->sliders + j;
    double *friction = slider_states + SLIDER_DOUBLES * j;
    if (slider->stroke > 0.0 && friction[SLIPS] == 0.0 && absolute(friction[HOLDS]) < 0.5 * slider->limit) {
        /* at an end of the free stroke */
        const double was = friction[SIDE];
        friction[SIDE] = was != 0.0 ? 0.0 : copy_sign(1.0, friction[PLAY]);
        friction[PLAY] = (was != 0.0 ? was : friction[SIDE]) * slider->stroke;
        friction[HOLDS] = 0.0;
        return FINE;
    }
    if (friction[SLIPS] == 0.0) {
        friction[SLIPS] = -copy_sign(1.0, friction[HOLDS]);
        friction[HOLDS] = -friction[SLIPS] * slider->limit;
        return FINE;
    }
    friction[SLIPS] = 0.0;
    stop_at(slider, method->half, state + method->half);
    return arrived && slider_is_rigid(slider)
               ? taylor_resolve(method, state, slider_states, excitation, t, failure)
               : FINE;
}

static double value_at(const double *from, int stride, double s)
{
    double total = 0.0;
    int k;
    for (k = TERMS; k >= 0; k--) {
        total = total * s + from[k * stride];
    }
    return total;
}

/* A stop after its event. */
static void change_stop_at(const TaylorStep *method, const double *state, double *slider_states, int j)
{
    const Stop *stop = method->holds.stops + j;
    double *own = stop_states_of(method, slider_states) + STOP_DOUBLES * j, across[2], rate[2], beyond;
    restraint_displacement(stop->rows, method->half / 2, state, across);
    restraint_displacement(stop->rows, method->half / 2, state + method->half, rate);
    beyond = hypotenuse(across[0], across[1]) - stop->gap;
    if (own[STOP_STATE] == STOP_APART) {
        turn_stop(own, STOP_PRESSES);
    } else if (own[STOP_STATE] == STOP_PRESSES) {
        turn_stop(own, beyond > LIMIT_ROUNDING * stop->gap ? STOP_BEYOND : STOP_APART);
    } else { /* back inside, or pressing once more */
        turn_stop(own, beyond > LIMIT_ROUNDING * stop->gap ? STOP_PRESSES : STOP_APART);
    }
}

/* What is remembered of sliders and stops at a fraction of a stretch. */
static void remember(const TaylorStep *method, double fraction, double *slider_states)
{
    const Holds *holds = &method->holds;
    double *own = slider_states;
    int k;
    for (k = 0; k < holds->slider_count; k++, own += SLIDER_DOUBLES) {
        own[HOLDS] = value_at(method->forces + k, method->count, fraction);
        if (slider_is_loose(holds->sliders + k, own)) {
            int i;
            for (i = 0; i < method->half; i++) {
                const double *column = method->series + i, share = slider_share(holds->sliders + k, i);
                if (share != 0.0) {
                    own[PLAY] += share * (value_at(column, method->length, fraction) - column[0]);
                }
            }
        }
    }
    for (k = 0; k < holds->stop_count; k++, own += STOP_DOUBLES) {
        if (own[STOP_STATE] == STOP_PRESSES) {
            const double *pressure = restraint_of(method, holds->cubic_count + k).pressure;
            own[STOP_LARGEST] = larger(own[STOP_LARGEST], largest_of_series(pressure, TERMS, fraction));
        }
    }
}

int taylor_advance(TaylorStep *method, double *state, double *slider_states,
                   const Excitation *excitation, double step, int stops, double *reached,
                   Failure *failure)
{
    const Holds *holds = &method->holds;
    double time = 0.0;
    int count, k, code = taylor_resolve(method, state, slider_states, excitation, 0.0, failure);
    for (count = 0; count < MOST_STRETCHES && !code; count++) {
        /* no longer than what is left: forces of short steps may have any slope */
        const double stretch = smaller(taylor_stretch(method, excitation, time), step - time);
        double fraction, until;
        int last = stretch == step - time;
        int which;
        code = set_series(method, state, slider_states, excitation, time, stretch, TERMS, failure);
        if (code) {
            return code;
        }
        until = part_in_reach(method);
        last &= until == 1.0;
        fraction = find_first_event(method, slider_states, stretch, until, &which);
        remember(method, fraction, slider_states);
        for (k = 0; k < 2 * method->half; k++) {
            state[k] = value_at(method->series + k, method->length, fraction);
        }
        if (which < 0 && last) {
            *reached = step;
            return FINE;
        }
        time += fraction * stretch;
        if (which >= 0) {
            if (which < holds->slider_count) {
                code = change_sliders(method, state, slider_states, excitation, time, which, fraction > 0.0, failure);
            } else {
                change_stop_at(method, state, slider_states, which - holds->slider_count);
            }
            if (stops) {
                *reached = time;
                return code;
            }
        }
    }
    return code ? code
                : fail(failure, "the rotor vibrates too fast, or its sliders change too often, for a "
                       "step of %6 s: %6 s reached in %u stretches; use smaller communication steps",
                       step, time, (unsigned long)MOST_STRETCHES);
}

int taylor_motion(TaylorStep *method, const double *state, const double *slider_states,
                  const Excitation *excitation, double t, double *rates, Failure *failure)
{
    static const double factorials[DERIVATIVES] = {1.0, 1.0, 2.0};
    const int half = method->half;
    const double *velocity = method->series + half;
    int i, k;
    const int code =
        set_series(method, state, slider_states, excitation, t, 1.0, DERIVATIVES - 1, failure);
    for (k = 0; k < DERIVATIVES && !code; k++, velocity += method->length, rates += half) {
        for (i = 0; i < half; i++) {
            rates[i] = factorials[k] * velocity[i];
        }
    }
    return code;
}

int taylor_plane_motion(TaylorStep *method, const double *state, double *slider_states,
                        const Excitation *excitation, double t, double *planes, Failure *failure)
{
    const int p = method->plane_count, n = method->half / 2;
    double *rates = method->faster + method->half;
    int k;
    const int code = taylor_motion(method, state, slider_states, excitation, t, rates, failure);
    for (k = 1; k < DERIVATIVES && !code; k++, planes += 2 * p) {
        combine_vectors(method->planes, p, n, rates + k * method->half, planes);
    }
    for (k = 0; k < method->count && !code; k++) {
        slider_states[SLIDER_DOUBLES * k + HOLDS] = method->forces[k];
    }
    return code;
}
