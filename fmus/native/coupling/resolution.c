/* Signals that vary faster than the steps: said loudly instead of computed wrongly. */
#include <string.h>

#include "base/elementary.h"
#include "base/matrix.h"
#include "constants.h"
#include "coupling/composite.h"

enum { TOO_LONG = 2 };
static const double UNRESOLVED_ERROR = 0.05; /* of a signal's largest value: its cubic no longer follows it */
static const double SIGNAL_NOISE = 1e-9; /* of what all weights can pull: below it a signal is cancellation */
/* times the largest force: what a resonance makes in three revolutions */
static const double LARGEST_FORCE_FACTOR = 10.0;
static const double UNFOLLOWED_TURN = 0.5; /* rad per step of the slowest vibration: what cubics miss gathers */
static const double RUNAWAY_GROWTH = 2.0; /* in a step: no resolved motion grows so fast */
/* such steps in a row, and unresolved ones in all: a transient that dies sooner is left to the estimate */
enum { RUNAWAY_STEPS = 4, PERSISTENT_STEPS = 20 };

/* Lowest natural frequency along an axis [rad/s]. */
static double slowest(Composite *c, const LinearRotor *rotor, const double *stiffness)
{
    const int n = rotor->stations;
    const size_t size = (size_t)(n * n) * sizeof(double);
    double *square = c->decay, *work = c->decay + n * n, radius;
    memcpy(work, stiffness, size);
    memcpy(square, rotor->mass, size);
    if (matrix_solve(1, n, n, work, square)) {
        return 0.0;
    }
    radius = spectral_radius(n, square, work);
    return radius > 0.0 ? 1.0 / square_root(radius) : 0.0;
}

/* Exchange the masses of all balancers and those on the rotor's planes. */
static void swap_masses(Composite *c)
{
    Unit *rotor = c->parts->unit;
    double *carried = rotor->real + rotor->layout.inputs.first;
    int k;
    for (k = 0; k < rotor->layout.sizes.planes; k++) {
        const double mass = carried[k];
        carried[k] = c->masses[k];
        c->masses[k] = mass;
    }
}

/* Element (i, j) of a real matrix whose element, or a pair of rows and columns, is this. */
static double real_element(const double *element, int parts, int i, int j)
{
    /* a complex element is [re, -im; im, re] */
    return parts == 1 || i % 2 == j % 2 ? element[0] : i % 2 ? element[1] : -element[1];
}

/* What is left after `step` [s] of the rotor's longest-lived vibration, at most 1. */
static double left_of_vibration(Composite *c, double step)
{
    Unit *unit = c->parts->unit;
    const Rotor *own = unit->own;
    const int n = 4 * own->stations;
    const double *matrix;
    int i, j;
    composite_added_masses(c, c->masses);
    swap_masses(c);
    matrix = rotor_matrix(unit, c->course->resolution.top, step);
    swap_masses(c);
    for (i = 0; i < n && matrix; i++) {
        for (j = 0; j < n; j++) {
            const int parts = own->parts, element = (j / parts) * own->rows + i / parts;
            c->decay[i * n + j] = real_element(matrix + parts * element, parts, i, j);
        }
    }
    return matrix ? smaller(1.0, spectral_radius(n, c->decay, c->decay + n * n)) : 1.0;
}

/* Smallest modulus of an eigenvalue of the rotor's free motion [1/s]; 0 for one without. */
static double slowest_rate(Composite *c)
{
    Unit *unit = c->parts->unit;
    const Rotor *own = unit->own;
    const TaylorStep *taylor = &own->taylor;
    const int n = 4 * own->stations;
    const double speed = rotor_inputs(unit)[0];
    double *inverse = c->decay + n * n, radius;
    int i, k, wrong;
    swap_masses(c);
    wrong = rotor_make_taylor(unit);
    swap_masses(c);
    if (wrong) {
        return 0.0;
    }
    memset(c->decay, 0, 2 * (size_t)(n * n) * sizeof(double));
    for (i = 0; i < n; i++) {
        const int parts = taylor->parts, row = (i - n / 2) / parts * taylor->length;
        for (k = 0; k < n && i >= n / 2; k++) {
            const int element = row + k / parts * parts;
            c->decay[i * n + k] =
                real_element(taylor->still + element, parts, i, k) +
                speed * real_element(taylor->per_speed + element, parts, i, k);
        }
        if (i < n / 2) {
            c->decay[i * n + n / 2 + i] = 1.0;
        }
        inverse[i * n + i] = 1.0;
    }
    if (matrix_solve(1, n, n, c->decay, inverse)) {
        return 0.0;
    }
    radius = spectral_radius(n, inverse, c->decay);
    return radius > 0.0 ? 1.0 / radius : 0.0;
}

/* Angle [rad] by which a push of 1 m/s turns a weight until it is forgotten. */
static double turn_of(const Weights *weights, double speed)
{
    const double slowing = weights_damping_rate(weights);
    return 1.0 / (weights->kappa * weights->track_radius * larger(speed, slowing));
}

/* Unbalance that the weights can balance [kg m]. */
static double capacity(const Composite *c)
{
    double sum = 0.0;
    int k;
    for (k = 1; k < c->parts_without_motor; k++) {
        const Balls *balls = part_balls(c->parts + k);
        if (balls) {
            const Weights *weights = &balls->track.weights;
            sum += weights->count * weights->mass * weights->track_radius;
        }
    }
    return sum;
}

/* How far the rotor moves [m]. */
static double rotor_reach(const Composite *c, double pull, double pace)
{
    const Unit *unit = c->parts->unit;
    const int n = ((const Rotor *)unit->own)->stations;
    const double *start = unit->real + unit->layout.parameters.count - 4 * n;
    double out = 0.0;
    int k;
    for (k = 0; k < 2 * n; k += 2) {
        const double *rate = start + 2 * n;
        out = larger(out, hypotenuse(start[k], start[k + 1]) +
                              hypotenuse(rate[k], rate[k + 1]) / pace);
    }
    return pull / (c->course->resolution.mass * pace * pace) + out;
}

void resolution_begin(Unit *unit)
{
    Composite *c = unit->own;
    Course *course = c->course;
    Unit *rotor = c->parts->unit;
    Rotor *own = rotor->own;
    const int n = own->stations;
    LinearRotor loaded;
    const double weights = capacity(c), top = course->drive.fastest;
    double least = SIGNAL_NOISE * weights * top * top, unbalance = 0.0;
    int k;
    composite_added_masses(c, c->masses);
    loaded = linear_rotor_with_added_mass(&own->rotor, c->masses, own->loaded_mass);
    for (k = 0; k < n; k++) {
        unbalance += hypotenuse(loaded.unbalance[2 * k], loaded.unbalance[2 * k + 1]);
    }
    course->resolution.top = top;
    course->resolution.mass = sum_of(loaded.mass, n * n);
    course->resolution.pace = larger(top, smaller(slowest(c, &loaded, loaded.stiffness_x),
                                       slowest(c, &loaded, loaded.stiffness_y)));
    course->resolution.reach = rotor_reach(c, (weights + unbalance) * top * top, course->resolution.pace);
    course->resolution.most = LARGEST_FORCE_FACTOR * composite_largest_force(c);
    for (k = 0; k < c->force_count; k++) {
        c->forces[k].largest = larger(least, magnitude(c->forces[k].now.value));
    }
    least /= course->resolution.mass;
    for (k = 0; k < c->planes; k++) {
        c->accelerations[k].largest = larger(least, magnitude(c->accelerations[k].now.value));
        memset(c->swung + k, 0, sizeof *c->swung);
    }
    for (k = 0; k < c->force_count; k++) {
        Swung *plane = c->swung + c->member_planes[k];
        const Balls *balls = part_balls(c->parts + c->members[k]);
        plane->turned = larger(plane->turned, balls ? turn_of(&balls->track.weights, top) : 0.0);
    }
    course->resolution.slowest = slowest_rate(c);
    course->resolution.judged_step = course->resolution.summed_error = 0.0;
    course->resolution.grown = course->resolution.unresolved = 0.0;
    course->total.error = 0.0;
}

/* Take over another length of the steps [s]. */
static void change_step(Composite *c, double step)
{
    Course *course = c->course;
    course->resolution.judged_step = step;
    course->resolution.blind = 1.0;
    course->resolution.decay = natural_exp(-step * course->resolution.pace / TAU);
    if (course->loop.gain > WEAK_LOOP ||
        (course->resolution.pace > course->resolution.top && step * course->resolution.pace > UNFOLLOWED_TURN)) {
        course->resolution.decay = larger(course->resolution.decay, left_of_vibration(c, step));
    }
    course->resolution.turn_decay = natural_exp(-step * course->resolution.top / TAU);
    course->resolution.renewed = 1.0 - natural_exp(-step * course->resolution.pace);
    course->resolution.moved = (1.0 + course->loop.gain) * smaller(step, 1.0 / course->resolution.pace) /
                    (course->resolution.mass * course->resolution.pace);
}

/* Steps too long for a signal: what that makes of it, with a number that `what` has room for. */
static int refuse_steps(Unit *unit, int signal, const char *before, const char *what, double number)
{
    const Composite *c = unit->own;
    Text *reason = unit_reason(unit);
    text_format(reason, "coupling steps of %3 s are too long at t = %6 s: %s",
                c->course->resolution.judged_step, unit_host_time(unit, c->course->clock.time), before);
    composite_name_signal(c, signal, reason);
    text_format(reason, what, number);
    text_put(reason, "; use more coupling.steps_per_rev, or a tolerance");
    return 1;
}

static int runs_away(Unit *unit)
{
    Composite *c = unit->own;
    Course *course = c->course;
    int grows = 0, beyond = 0, k;
    for (k = 0; k < c->force_count; k++) {
        beyond |= c->forces[k].largest > course->resolution.most;
    }
    for (k = 0; k < c->force_count && beyond; k++) {
        const Signal *force = c->forces + k;
        grows |= magnitude(force->now.value) >
                 larger(course->resolution.most, RUNAWAY_GROWTH * magnitude(force->last[0]));
    }
    course->resolution.grown = grows ? course->resolution.grown + 1.0 : 0.0;
    if (course->resolution.grown >= RUNAWAY_STEPS) {
        return refuse_steps(unit, 0, "", " is beyond all that the scene can make of it and has "
                            "grown 2-fold or more in each of the last 4 steps", 0.0);
    }
    return 0;
}

/* Count a step that has ended far from where the one before led. */
static int count_lost(Unit *unit, int number, const Signal *signal)
{
    Course *course = ((Composite *)unit->own)->course;
    course->resolution.unresolved += 1.0;
    if (course->resolution.unresolved >= PERSISTENT_STEPS) {
        return refuse_steps(unit, number, "", " has ended 20 steps far from where the one before "
                            "led, now by %2 of its largest value",
                            signal->prediction_error / signal->largest);
    }
    return 0;
}

/* Estimate of the error by the planes' motion and the forces' pushes; the signal it is of. */
static double estimate(Composite *c, double step, double times, double signal_error, int *cause)
{
    Course *course = c->course;
    double worst = 0.0;
    int k;
    course->resolution.summed_error = course->resolution.decay * course->resolution.summed_error + times * signal_error;
    for (k = 0; k < c->planes; k++) {
        Swung *plane = c->swung + k;
        const Signal *signal = c->accelerations + k;
        const Complex now = complex_scaled(1.0 / course->resolution.pace, signal->now.value);
        Complex place;
        plane->speed = complex_sum(
            plane->speed, complex_scaled(course->resolution.renewed, complex_difference(now, plane->speed)));
        place = complex_scaled(1.0 / course->resolution.pace, plane->speed);
        plane->place = complex_sum(
            plane->place, complex_scaled(course->resolution.renewed, complex_difference(place, plane->place)));
        course->resolution.reach = larger(course->resolution.reach, magnitude(plane->place));
        plane->swung = course->resolution.turn_decay * plane->swung + times * signal->prediction_error;
        if (plane->swung * plane->turned * step > worst) {
            worst = plane->swung * plane->turned * step;
            *cause = c->unknowns + k;
        }
    }
    if (course->resolution.summed_error * course->resolution.moved > worst * course->resolution.reach) {
        worst = course->resolution.summed_error * course->resolution.moved / course->resolution.reach;
        *cause = 0;
    }
    return worst;
}

int resolution_check(Unit *unit, double step)
{
    Composite *c = unit->own;
    Course *course = c->course;
    double signal_error = 0.0, times, worst;
    const Signal *lost = NULL;
    int k, cause = 0, lost_number = 0;
    if (step != course->resolution.judged_step) {
        change_step(c, step);
    }
    for (k = 0; k < c->force_count + c->planes; k++) {
        const Signal *signal =
            k < c->force_count ? c->forces + k : c->accelerations + (k - c->force_count);
        signal_error += k < c->force_count ? signal->prediction_error : 0.0;
        if (signal->prediction_error > MISS_PER_ERROR * UNRESOLVED_ERROR * signal->largest) {
            lost = signal;
            lost_number = k < c->force_count ? k : c->unknowns + k - c->force_count;
        }
    }
    /* a first step has no past to be judged by: the second one's miss is its miss too */
    times = (course->resolution.blind > 0.0 ? 2.0 : 1.0) / MISS_PER_ERROR;
    course->resolution.blind = signal_error == 0.0;
    worst = estimate(c, step, times, signal_error, &cause);
    if (worst > course->total.error) {
        course->total.error = worst;
        if (worst >= REFUSED_ERROR) {
            return refuse_steps(unit, cause, "what the cubics miss of ",
                                " moves the units %2 times as far as they move at all", worst);
        }
        if (worst >= STATED_ERROR) {
            unit_warn_once(unit, TOO_LONG, course->clock.time,
                           "steps too long for signals that vary faster: coupling.error is the "
                           "relative error of the motion; use more coupling.steps_per_rev, or a "
                           "tolerance");
        }
    }
    return (lost && count_lost(unit, lost_number, lost)) || runs_away(unit);
}
