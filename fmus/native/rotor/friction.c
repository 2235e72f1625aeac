#include "rotor/friction.h"

#include "base/elementary.h"
#include "base/matrix.h"
#include "base/spin.h"
#include "rotor/first_fall.h"

enum { TERMS = MOST_COEFFICIENTS - 1 }; /* 0.5^18/18! is far below rounding */
enum { MOST_STRETCHES = 10000, SWEEPS = 10000 };
static const double REACH = 0.5, SERIES_CONVERGED = 1e-15;
static const double LIMIT_ROUNDING = 1e-12; /* of a limit: a force so near to it has reached it */

/* How the rotor turns over a stretch: Taylor coefficients of its speed and its acceleration. */
enum { SPEEDS = 5, RATES = 4 };
typedef struct {
    double angle, speed[SPEEDS], spin_up[RATES];
} Turning;

/* Over a stretch h from time t on. */
static Turning turning_of(const Drive *drive, double t, double h)
{
    const double *rates = drive->spin_up;
    const Drift more = drift(rates, t);
    Turning found;
    int k;
    found.angle = drive->angle + drive->speed * t + 0.5 * rates[0] * t * t + more.angle;
    found.spin_up[0] = rates[0] + more.acceleration;
    found.spin_up[1] = h * more.slope;
    found.spin_up[2] = h * h * (rates[2] + t * rates[3]) / 2.0;
    found.spin_up[3] = h * h * h * rates[3] / 6.0;
    found.speed[0] = drive->speed + rates[0] * t + more.speed;
    for (k = 0; k < RATES; k++) {
        found.speed[k + 1] = h * found.spin_up[k] / (k + 1);
    }
    return found;
}

static int place_of(const FrictionStep *method, int j)
{
    return method->sliders[j].axis * (method->smooth->dof / 2) + method->sliders[j].station;
}

static int is_rigid(const Slider *slider)
{
    return slider->stiffness == 0.0 && slider->limit > 0.0;
}

size_t friction_size(int stations, int planes, int count)
{
    const size_t dof = 2 * (size_t)stations, p = (size_t)planes, m = (size_t)count;
    const size_t series = TERMS + 1;
    return dof * m + series * (2 * dof + m + dof + 2 + 2 * p + 2) + 2 * dof * dof + dof + m * m +
           2 * m + 2 * dof + 2 * m + m;
}

static double *next_block(double **memory, size_t count)
{
    double *first = *memory;
    *memory += count;
    return first;
}

/* Largest sum of a row's absolute values in half of a matrix (dof, 2 dof). */
static double row_norm(int dof, int half, const double *matrix)
{
    double norm = 0.0;
    int i, k;
    for (i = 0; i < dof; i++) {
        double sum = 0.0;
        for (k = 0; k < dof; k++) {
            sum += absolute(matrix[i * 2 * dof + half * dof + k]);
        }
        norm = larger(norm, sum);
    }
    return norm;
}

static void set_norms(FrictionStep *method)
{
    const VariableSpeedStep *smooth = method->smooth;
    const int dof = smooth->dof, m = method->count;
    int i, j;
    copy_doubles(2 * (size_t)dof * dof, smooth->still, method->matrix);
    for (i = 0; i < dof; i++) {
        for (j = 0; j < m; j++) {
            method->matrix[i * 2 * dof + place_of(method, j)] -=
                method->push[i * m + j] * method->sliders[j].stiffness;
        }
    }
    method->norms[0] = row_norm(dof, 0, method->matrix);
    method->norms[1] = row_norm(dof, 0, smooth->per_speed);
    method->norms[2] = row_norm(dof, 1, method->matrix);
    method->norms[3] = row_norm(dof, 1, smooth->per_speed);
}

int friction_step(const LinearRotor *rotor, const VariableSpeedStep *smooth, const Slider *sliders,
                  int count, double *memory, FrictionStep *made, Failure *failure)
{
    const int n = rotor->stations, dof = 2 * n, p = rotor->plane_count;
    const size_t m = (size_t)count, size = (size_t)dof, series = TERMS + 1;
    double *mass;
    int i, j;
    made->smooth = smooth;
    made->sliders = sliders;
    made->count = count;
    made->push = next_block(&memory, size * m);
    made->motion = next_block(&memory, series * 2 * size);
    made->forces = next_block(&memory, series * m);
    made->pushes = next_block(&memory, series * size);
    made->turn = next_block(&memory, series * 2);
    made->drive = next_block(&memory, series * (2 * (size_t)p + 2));
    made->matrix = next_block(&memory, 2 * size * size);
    made->rate = next_block(&memory, size);
    made->mobility = next_block(&memory, m * m);
    made->hold = next_block(&memory, 2 * m);
    made->state = next_block(&memory, 2 * size);
    made->slider_states = next_block(&memory, 2 * m);
    made->limits = next_block(&memory, m);
    for (i = 0; i < count; i++) {
        for (j = 0; j < i; j++) {
            if (is_rigid(sliders + i) && is_rigid(sliders + j) &&
                place_of(made, i) == place_of(made, j)) {
                return fail(failure, FAILURE_RIGID_SLIDERS, "sliders", 0, 0.0, 0.0, 0.0, 0.0);
            }
        }
    }
    mass = made->matrix;
    matrix_per_axis(1, 2, n, n, rotor->mass, mass);
    fill_doubles(size * m, 0.0, made->push);
    for (j = 0; j < count; j++) {
        made->push[place_of(made, j) * count + j] = 1.0;
    }
    if (matrix_solve(1, dof, count, mass, made->push)) {
        return fail(failure, FAILURE_SINGULAR, "mass", 0, 0.0, 0.0, 0.0, 0.0);
    }
    set_norms(made);
    return FINE;
}

void friction_at_start(const Slider *sliders, int count, const double *rates, double *slider_states)
{
    int j;
    for (j = 0; j < count; j++, slider_states += 2) {
        const double rate = rates[2 * sliders[j].station + sliders[j].axis];
        slider_states[SLIPS] = slider_states[HOLDS] = 0.0;
        if (sliders[j].limit == 0.0) {
            slider_states[SLIPS] = 1.0; /* and never sticks */
        } else if (is_rigid(sliders + j) && rate != 0.0) {
            slider_states[SLIPS] = copy_sign(1.0, rate);
            slider_states[HOLDS] = -slider_states[SLIPS] * sliders[j].limit;
        }
    }
}

void friction_at_jump(const Slider *sliders, int count, const double *rates, double *slider_states)
{
    int j;
    for (j = 0; j < count; j++, slider_states += 2) {
        if (is_rigid(sliders + j)) {
            friction_at_start(sliders + j, 1, rates, slider_states);
        } else if (sliders[j].limit != 0.0 &&
                   slider_states[SLIPS] * rates[2 * sliders[j].station + sliders[j].axis] < 0.0) {
            slider_states[SLIPS] = 0.0;
        }
    }
}

/* Length of a stretch from time t on [s]. */
static double stretch_of(const FrictionStep *method, const Drive *drive, double t)
{
    const Turning now = turning_of(drive, t, 1.0);
    const double *norms = method->norms, *rates = now.spin_up;
    const double w = absolute(now.speed[0]);
    const double rate = square_root(norms[0] + w * norms[1]) + norms[2] + w * norms[3] + w;
    double h = REACH / (rate + square_root(absolute(rates[0])));
    while (h * h * h * (absolute(rates[1]) + h * (absolute(rates[2]) + h * absolute(rates[3]))) >
           REACH * REACH * REACH) {
        h *= 0.5;
    }
    return h;
}

/* Coefficients of e^{i beta} over a stretch h. */
static void set_turn(const Turning *turning, double h, int terms, double *turn)
{
    const Complex first = rect(1.0, turning->angle);
    int k, j;
    turn[0] = first.re;
    turn[1] = first.im;
    for (k = 0; k < terms; k++, turn += 2) {
        const double factor = h / (k + 1);
        double re = 0.0, im = 0.0;
        for (j = 0; j < SPEEDS && j <= k; j++) {
            re += turning->speed[j] * turn[-2 * j];
            im += turning->speed[j] * turn[1 - 2 * j];
        }
        turn[2] = -factor * im;
        turn[3] = factor * re;
    }
}

/* Coefficient of w^2 - i w'. */
static Complex pull_of(const Turning *turning, int k)
{
    double square = 0.0;
    int j;
    for (j = 0; j <= k; j++) {
        square += j < SPEEDS && k - j < SPEEDS ? turning->speed[j] * turning->speed[k - j] : 0.0;
    }
    return complex_of(square, k < RATES ? -turning->spin_up[k] : 0.0);
}

/* to (rows of `width`, from row m on) += coefficients of e^{i beta}, times a complex factor. */
static void add_turned(const double *turn, int terms, int m, int width, double re, double im,
                       double *x, double *y)
{
    int k;
    for (k = m; k <= terms; k++, turn += 2) {
        x[k * width] += turn[0] * re - turn[1] * im;
        y[k * width] += turn[0] * im + turn[1] * re;
    }
}

/* Coefficients (terms + 1, dof) of what moves the rotor over a stretch h from t on; without unbalance
   and gravity when `alone`. */
static void set_pushes(FrictionStep *method, const Drive *drive, const Turning *turning, double t,
                       double h, int terms, int alone)
{
    const VariableSpeedStep *smooth = method->smooth;
    const int p = smooth->plane_count, width = 2 * p + 2, dof = smooth->dof;
    double *values = method->drive;
    int k, i, m;
    set_turn(turning, h, terms, method->turn);
    fill_doubles((size_t)(terms + 1) * width, 0.0, values);
    for (i = 0; i < p; i++) {
        double cubic[2][4];
        for (k = 0; k < 2; k++) {
            const double *f = drive->forces + 2 * i + k;
            const double f0 = f[0], f1 = f[2 * p], f2 = f[4 * p], f3 = f[6 * p];
            cubic[k][0] = f0 + t * (f1 + t * (f2 / 2.0 + t * f3 / 6.0));
            cubic[k][1] = h * (f1 + t * (f2 + t * f3 / 2.0));
            cubic[k][2] = h * h * (f2 + t * f3) / 2.0;
            cubic[k][3] = h * h * h * f3 / 6.0;
        }
        for (m = 0; m < 4 && m <= terms; m++) {
            if (smooth->turning_force) {
                add_turned(method->turn, terms, m, width, cubic[0][m], cubic[1][m], values + i,
                           values + p + i);
            } else {
                values[m * width + i] = cubic[0][m];
                values[m * width + p + i] = cubic[1][m];
            }
        }
    }
    for (m = 0; m < 2 * SPEEDS - 1 && m <= terms && !alone; m++) {
        const Complex pull = pull_of(turning, m);
        add_turned(method->turn, terms, m, width, pull.re, pull.im, values + 2 * p,
                   values + 2 * p + 1);
    }
    for (k = 0; k <= terms; k++, values += width) {
        double *push = method->pushes + k * dof;
        for (i = 0; i < dof; i++) {
            push[i] = !k && !alone && smooth->falling ? smooth->falling[i] : 0.0;
            for (m = 0; m < 2 * p; m++) {
                push[i] += smooth->force[i * 2 * p + m] * values[m];
            }
            push[i] += smooth->unbalance[2 * i] * values[2 * p] +
                       smooth->unbalance[2 * i + 1] * values[2 * p + 1];
        }
    }
}

/* Forces of rigid sliders that stick, from the rates without them, which become 0 there. */
static int stop(FrictionStep *method, const double *slider_states, double *rate, double *forces)
{
    const int m = method->count, dof = method->smooth->dof;
    int i, j, row = 0, stuck = 0;
    for (j = 0; j < m; j++) {
        stuck += is_rigid(method->sliders + j) && slider_states[2 * j + SLIPS] == 0.0;
    }
    for (i = 0; i < m; i++) {
        int column = 0;
        if (!is_rigid(method->sliders + i) || slider_states[2 * i + SLIPS] != 0.0) {
            continue;
        }
        for (j = 0; j < m; j++) {
            if (is_rigid(method->sliders + j) && slider_states[2 * j + SLIPS] == 0.0) {
                method->mobility[row * stuck + column++] = method->push[place_of(method, i) * m + j];
            }
        }
        method->hold[row++] = -rate[place_of(method, i)];
    }
    if (!stuck) {
        return 0;
    }
    if (matrix_solve(1, stuck, 1, method->mobility, method->hold)) {
        return 1;
    }
    for (j = 0, row = 0; j < m; j++) {
        if (is_rigid(method->sliders + j) && slider_states[2 * j + SLIPS] == 0.0) {
            forces[j] = method->hold[row++];
            for (i = 0; i < dof; i++) {
                rate[i] += method->push[i * m + j] * forces[j];
            }
        }
    }
    for (j = 0; j < m; j++) {
        if (is_rigid(method->sliders + j) && slider_states[2 * j + SLIPS] == 0.0) {
            rate[place_of(method, j)] = 0.0;
        }
    }
    return 0;
}

/* Taylor coefficients of motion and friction over a stretch h from t on; those that the plane
   forces alone make when state is NULL. */
static int set_series(FrictionStep *method, const double *state, const double *slider_states,
                      const Drive *drive, double t, double h, int terms, Failure *failure)
{
    const VariableSpeedStep *smooth = method->smooth;
    const int dof = smooth->dof, m = method->count, width = 2 * dof;
    const Turning turning = turning_of(drive, t, h);
    /* a rotor may be the same at every speed */
    const int changes = method->norms[1] > 0.0 || method->norms[3] > 0.0;
    double *motion = method->motion, *rate = method->rate;
    int i, j, k, back;
    set_pushes(method, drive, &turning, t, h, terms, !state);
    for (k = 0; k < width * dof; k++) {
        method->matrix[k] = smooth->still[k] + turning.speed[0] * smooth->per_speed[k];
    }
    fill_doubles((size_t)width, 0.0, motion);
    if (state) {
        copy_doubles((size_t)width, state, motion);
    }
    for (k = 0; k <= terms; k++, motion += width) {
        double *forces = method->forces + k * m;
        for (j = 0; j < m; j++) {
            const Slider *slider = method->sliders + j;
            const int sticks = slider_states[2 * j + SLIPS] == 0.0;
            const double *at = motion + place_of(method, j);
            if (k) {
                forces[j] = sticks ? -slider->stiffness * *at : 0.0;
            } else {
                forces[j] = !state || (sticks && is_rigid(slider)) ? 0.0 : slider_states[2 * j + HOLDS];
                if (sticks && is_rigid(slider)) {
                    motion[dof + place_of(method, j)] = 0.0;
                }
            }
        }
        matrix_product(1, dof, width, 1, method->matrix, motion, rate);
        for (i = 0; i < dof; i++) {
            rate[i] += method->pushes[k * dof + i];
            for (j = 0; j < m; j++) {
                rate[i] += method->push[i * m + j] * forces[j];
            }
            for (back = 1; back < SPEEDS && back <= k && changes; back++) {
                const double faster = turning.speed[back], *then = motion - back * width;
                for (j = 0; j < width && faster != 0.0; j++) {
                    rate[i] += faster * smooth->per_speed[i * width + j] * then[j];
                }
            }
        }
        if (stop(method, slider_states, rate, forces)) {
            return fail(failure, FAILURE_SINGULAR, "mobility", 0, 0.0, 0.0, 0.0, 0.0);
        }
        for (i = 0; i < dof && k < terms; i++) {
            motion[width + i] = h / (k + 1) * motion[dof + i];
            motion[width + dof + i] = h / (k + 1) * rate[i];
        }
    }
    return FINE;
}

int friction_resolve(FrictionStep *method, const double *state, double *slider_states, const Drive *drive,
                     double t, Failure *failure)
{
    const int m = method->count, dof = method->smooth->dof;
    double *found = method->hold, *free = method->hold + m, *without = method->slider_states;
    int j, k, resting = 0, sweep, code, settled = 0;
    copy_doubles(2 * (size_t)m, slider_states, without);
    for (j = 0; j < m; j++) {
        method->limits[j] = 0.0;
        found[j] = 0.0;
        if (is_rigid(method->sliders + j) &&
            (slider_states[2 * j + SLIPS] == 0.0 || state[dof + place_of(method, j)] == 0.0)) {
            method->limits[j] = method->sliders[j].limit;
            without[2 * j + SLIPS] = 1.0; /* as if without them */
            without[2 * j + HOLDS] = 0.0;
            resting++;
        }
    }
    if (!resting) {
        return FINE;
    }
    code = set_series(method, state, without, drive, t, 1.0, 1, failure);
    if (code) {
        return code;
    }
    for (j = 0; j < m; j++) {
        found[j] = 0.0;
        free[j] = method->motion[3 * dof + place_of(method, j)];
    }
    for (sweep = 0; sweep < SWEEPS && !settled; sweep++) {
        settled = 1;
        for (j = 0; j < m; j++) {
            const double *mobility = method->push + place_of(method, j) * m;
            const double limit = method->limits[j], before = found[j];
            double rate = free[j];
            for (k = 0; k < m; k++) {
                rate += mobility[k] * found[k];
            }
            found[j] = smaller(larger(before - rate / mobility[j], -limit), limit);
            settled &= absolute(found[j] - before) <= SERIES_CONVERGED * limit;
        }
    }
    for (j = 0; j < m; j++) {
        if (method->limits[j] > 0.0) {
            slider_states[2 * j + SLIPS] =
                absolute(found[j]) < method->limits[j] ? 0.0 : -copy_sign(1.0, found[j]);
            slider_states[2 * j + HOLDS] = found[j];
        }
    }
    return FINE;
}

/* Column of the series: one quantity's coefficients, times `sign`, plus `base`. */
static void column(const double *from, int stride, double sign, double base, double *to)
{
    int k;
    for (k = 0; k <= TERMS; k++) {
        to[k] = sign * from[k * stride];
    }
    to[0] += base;
}

/* Acceleration by all limits at the place of a slider. */
static double mobility_of(const FrictionStep *method, int j)
{
    double limits = 0.0;
    int k;
    for (k = 0; k < method->count; k++) {
        limits += place_of(method, k) == place_of(method, j) ? method->sliders[k].limit : 0.0;
    }
    return method->push[place_of(method, j) * method->count + j] * limits;
}

/* When, as a fraction of a stretch [s], which slider changes first: -1 for none. */
static double first_event(const FrictionStep *method, const double *slider_states, double stretch, int *which)
{
    const int m = method->count, dof = method->smooth->dof;
    double function[TERMS + 1], first = 1.0;
    int j, side;
    *which = -1;
    for (j = 0; j < m; j++) {
        const double limit = method->sliders[j].limit, slips = slider_states[2 * j + SLIPS];
        /* where a slider starts from rest the first acceleration may be rounding, too */
        const double still = LIMIT_ROUNDING * stretch * mobility_of(method, j);
        const double sticking[3] = {LIMIT_ROUNDING * limit, 0.0,
                                    0.5 * still * stretch * method->sliders[j].stiffness};
        const double slipping[3] = {0.0, still, 0.0};
        for (side = 0; side < (slips != 0.0 ? 1 : 2) && limit > 0.0; side++) {
            double found;
            if (slips != 0.0) {
                column(method->motion + dof + place_of(method, j), 2 * dof, slips, 0.0, function);
            } else {
                column(method->forces + j, m, side ? 1.0 : -1.0, limit, function);
            }
            found = first_fall(function, TERMS + 1, first, slips != 0.0 ? slipping : sticking);
            if (found < first) {
                first = found;
                *which = j;
            }
        }
    }
    return first;
}

/* The sliders after the event of slider j; `arrived`: by a motion, not at once. */
static int change_sliders(FrictionStep *method, double *state, double *slider_states, const Drive *drive, double t,
                  int j, int arrived, Failure *failure)
{
    double *own = slider_states + 2 * j;
    if (own[SLIPS] == 0.0) {
        own[SLIPS] = -copy_sign(1.0, own[HOLDS]);
        own[HOLDS] = -own[SLIPS] * method->sliders[j].limit;
        return FINE;
    }
    own[SLIPS] = 0.0;
    state[method->smooth->dof + place_of(method, j)] = 0.0;
    return arrived && is_rigid(method->sliders + j)
               ? friction_resolve(method, state, slider_states, drive, t, failure)
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

int friction_advance(FrictionStep *method, double *state, double *slider_states, const Drive *drive,
                     double step, int stops, double *reached, Failure *failure)
{
    const int dof = method->smooth->dof, m = method->count;
    double time = 0.0;
    int count, k, code = friction_resolve(method, state, slider_states, drive, 0.0, failure);
    for (count = 0; count < MOST_STRETCHES && !code; count++) {
        /* no longer than what is left: forces of short steps may have any slope */
        const double stretch = smaller(stretch_of(method, drive, time), step - time);
        const int last = stretch == step - time;
        double fraction;
        int which;
        code = set_series(method, state, slider_states, drive, time, stretch, TERMS, failure);
        if (code) {
            return code;
        }
        fraction = first_event(method, slider_states, stretch, &which);
        for (k = 0; k < 2 * dof; k++) {
            state[k] = value_at(method->motion + k, 2 * dof, fraction);
        }
        for (k = 0; k < m; k++) {
            slider_states[2 * k + HOLDS] = value_at(method->forces + k, m, fraction);
        }
        if (which < 0 && last) {
            *reached = step;
            return FINE;
        }
        time += fraction * stretch;
        if (which >= 0) {
            code = change_sliders(method, state, slider_states, drive, time, which, fraction > 0.0, failure);
            if (stops) {
                *reached = time;
                return code;
            }
        }
    }
    return code ? code
                : fail(failure, FAILURE_STRETCHES, "step", MOST_STRETCHES, step, time, 0.0, 0.0);
}

int friction_motion(FrictionStep *method, const double *state, const double *slider_states,
                    const Drive *drive, double t, double *rates, double *jerks, Failure *failure)
{
    const int dof = method->smooth->dof;
    const double stretch = stretch_of(method, drive, t), *motion = method->motion;
    int k, code = set_series(method, state, slider_states, drive, t, stretch, 2, failure);
    for (k = 0; k < dof && !code; k++) {
        rates[k] = motion[dof + k];
        rates[dof + k] = motion[3 * dof + k] / stretch;
        jerks[k] = 2.0 * motion[5 * dof + k] / (stretch * stretch);
    }
    return code;
}

int friction_plane_motion(FrictionStep *method, const double *state, double *slider_states,
                          const Drive *drive, double t, double *acceleration, double *jerk,
                          Failure *failure)
{
    const VariableSpeedStep *smooth = method->smooth;
    const int dof = smooth->dof, planes = 2 * smooth->plane_count;
    double *rates = method->state, *jerks = method->rate;
    int k, code = friction_motion(method, state, slider_states, drive, t, rates, jerks, failure);
    if (code) {
        return code;
    }
    matrix_product(1, planes, dof, 1, smooth->planes, rates + dof, acceleration);
    matrix_product(1, planes, dof, 1, smooth->planes, jerks, jerk);
    for (k = 0; k < method->count; k++) {
        slider_states[2 * k + HOLDS] = method->forces[k];
    }
    return FINE;
}
