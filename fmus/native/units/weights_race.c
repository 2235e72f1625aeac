#include "units/weights_race.h"

#include "base/elementary.h"
#include "constants.h"

enum { RACE_ORDER = 20, ANSWER_ORDER = 1, SPIN_ORDERS = 5 };
#define RACE_TERM 1e-14   /* rad: the last terms of the angles' series */
#define LONGEST_TURN 2.0  /* rad of the rotor, and of a weight, in a substep */

RaceSeries *race_allocate(Unit *unit, int count, int lobes)
{
    RaceSeries *race = unit_allocate(unit, 1, sizeof *race);
    int k, missing = !race;
    if (missing) {
        return NULL;
    }
    race->weights = unit_allocate(unit, (size_t)count, sizeof *race->weights);
    race->pull = unit_allocate(unit, SERIES_LENGTH, sizeof(Pair));
    race->spin = unit_allocate(unit, SERIES_LENGTH, sizeof(Pair));
    race->speed = unit_allocate(unit, SERIES_LENGTH, sizeof(Number));
    missing = !race->weights || !race->pull || !race->spin || !race->speed;
    for (k = 0; k < count && !missing; k++) {
        race->weights[k].unit = unit_allocate(unit, SERIES_LENGTH, sizeof(Pair));
        race->weights[k].rate = unit_allocate(unit, SERIES_LENGTH, sizeof(Pair));
        race->weights[k].race = series_race_allocate(unit, lobes);
        missing |= !race->weights[k].unit || !race->weights[k].rate || !race->weights[k].race;
    }
    race->count = count;
    return missing ? NULL : race;
}

void race_take(RaceSeries *race, const Track *track)
{
    int k;
    race->offset = pair_of(track->offset.re, track->offset.im);
    race->per_rate = 1.0;
    for (k = 0; k < race->count; k++) {
        const Weights one = weights_single(&track->weights, k);
        series_weight_take(race->weights + k, &one, 1.0);
        series_race_take(race->weights + k, &one, track->weights.lobe, 1.0);
    }
}

/* The unit of time, of a rotor that turns like that. */
static void set_time(RaceSeries *race, double fastest)
{
    const double per_rate = scaled_by_power(1.0, -binary_exponent(larger(fastest, 1e-30)));
    int k;
    for (k = 0; k < race->count; k++) {
        race->weights[k].race->slowing *= per_rate / race->per_rate;
    }
    race->per_rate = per_rate;
}

/* Series of what drives the weights, in the rotor's axes as they stand at the start. */
static void set_motion(RaceSeries *race, const CentreMotion *motion, int order)
{
    const double t = race->per_rate;
    double over = t, factor = 1.0;
    Complex signal[SIGNAL_ORDERS];
    int k, j;
    for (k = 0; k <= order + 1; k++) {
        race->speed[k] = k == 0 ? motion->spin.speed * t : 0.0;
    }
    for (k = 0; k < SIGNAL_ORDERS; k++) {
        over *= t;
        factor /= k ? k : 1;
        race->speed[k + 1] = motion->spin.rates[k] * over * factor / (k + 1);
        signal[k] = complex_scaled(over * factor, motion->signal[k]);
    }
    race->spin[0] = pair_of(1.0, 0.0);
    for (k = 0; k <= order; k++) {
        Pair sum = pair_zero(), pull = pair_zero();
        for (j = 0; j <= k && j < SPIN_ORDERS; j++) {
            sum = pair_add_scaled(sum, race->spin[k - j], race->speed[j]);
        }
        race->spin[k + 1] = pair_scaled(pair_turned(sum), 1.0 / (k + 1));
        for (j = 0; j <= k && j < SIGNAL_ORDERS; j++) {
            pull = pair_sum(pull, pair_product(pair_of(signal[j].re, signal[j].im), race->spin[k - j]));
        }
        race->pull[k] = pair_turned_back(pull);
    }
}

/* The series of a weight up to that of order `order` of its acceleration. */
static void expand(RaceSeries *race, int w, double angle, double speed, int order)
{
    const Turning rotor = {race->speed, SPIN_ORDERS - 1};
    SeriesWeight *weight = race->weights + w;
    int k;
    weight->rate[0] = pair_both(race->speed[0] + speed);
    series_weight_start(weight, angle);
    series_race_start(weight, angle, speed, race->speed[0]);
    for (k = 0; k <= order; k++) {
        const double carried = (k + 1) * race->speed[k + 1], per[2] = {1.0 / (k + 1), 1.0 / (k + 2)};
        const double turning = pair_x(weight->rate[k]) - race->speed[k];
        series_race_advance(weight, k, pair_turned(race->pull[k]), turning, carried, rotor);
        series_weight_finish(weight, k, weight->free, per);
        series_race_finish(weight, k, weight->free, carried, 0.0, race->pull[k]);
    }
}

/* Coefficient of order k of the angle in the rotor, 1 or more. */
static double angle_term(const RaceSeries *race, int w, int k)
{
    return (pair_x(race->weights[w].rate[k - 1]) - race->speed[k - 1]) / k;
}

static double power_of(double base, int exponent)
{
    double product = 1.0;
    while (exponent-- > 0) {
        product *= base;
    }
    return product;
}

/* A time over which the last terms are small. */
static double length_of(const RaceSeries *race, const double *speeds, double left)
{
    double length = smaller(left, LONGEST_TURN);
    int w, k;
    for (w = 0; w < race->count; w++) {
        const double rate = absolute(race->speed[0]) + absolute(speeds[w]) * race->per_rate;
        length = rate * length > LONGEST_TURN ? LONGEST_TURN / rate : length;
        for (k = RACE_ORDER; k <= RACE_ORDER + 1; k++) {
            const double term = absolute(angle_term(race, w, k));
            while (length > 0.0 && term * power_of(length, k) > RACE_TERM) {
                length *= 0.8;
            }
        }
    }
    return length;
}

static CentreMotion motion_after(const CentreMotion *motion, double time)
{
    CentreMotion after = *motion;
    int k;
    for (k = SIGNAL_ORDERS - 2; k >= 0; k--) {
        int j;
        double factor = 1.0;
        for (j = k + 1; j < SIGNAL_ORDERS; j++) {
            factor *= time / (j - k);
            after.signal[k] = complex_sum(after.signal[k], complex_scaled(factor, motion->signal[j]));
        }
    }
    after.spin = spin_after(&motion->spin, time);
    return after;
}

/* Set angles and speeds to those of the series at a time. */
static void place(const RaceSeries *race, double time, double *angles, double *speeds)
{
    int w, k;
    for (w = 0; w < race->count; w++) {
        double angle = 0.0, speed = 0.0;
        for (k = RACE_ORDER + 1; k >= 1; k--) {
            const double term = angle_term(race, w, k);
            angle = (angle + term) * time;
            speed = speed * time + k * term;
        }
        angles[w] += angle;
        speeds[w] = speed / race->per_rate;
    }
}

int race_advance(RaceSeries *race, double *angles, double *speeds, const CentreMotion *motion, double step,
                 Failure *failure)
{
    const double fastest = absolute(motion->spin.speed) + 1.0 / step;
    double done = 0.0;
    int steps = 0, w;
    set_time(race, fastest + largest_of(race->count, speeds));
    while (done < step) {
        const CentreMotion now = motion_after(motion, done);
        double length, left = (step - done) / race->per_rate;
        set_motion(race, &now, RACE_ORDER);
        for (w = 0; w < race->count; w++) {
            expand(race, w, angles[w], speeds[w] * race->per_rate, RACE_ORDER);
        }
        length = length_of(race, speeds, left);
        if (!(length > 0.0) || !is_finite(angle_term(race, 0, RACE_ORDER)) || ++steps > MAX_SUBSTEPS) {
            return fail(failure, TOO_MANY_SUBSTEPS, step / larger(1e-300, length * race->per_rate), step,
                        magnitude(motion->signal[0]), largest_of(race->count, speeds));
        }
        place(race, length, angles, speeds);
        done = length < left ? done + length * race->per_rate : step;
    }
    return FINE;
}

void race_sum(const SeriesWeight *weights, int count, const Pair *spin, Pair offset, double speed, double rate,
              Complex *force, double *torque)
{
    const Pair back = pair_of(pair_x(spin[0]), -pair_y(spin[0]));
    double scale = rate * rate;
    Pair sums[2];
    int k, w;
    for (k = 0; k < 2; k++, scale *= rate) {
        sums[k] = pair_zero();
        torque[k] = 0.0;
        for (w = 0; w < count; w++) {
            sums[k] = pair_sum(sums[k], series_race_push(weights + w, k));
            torque[k] += series_race_turning(weights + w, k, spin, offset) * scale;
        }
        sums[k] = k ? pair_difference(sums[1], pair_scaled(pair_turned(sums[0]), speed)) : sums[0];
        force[k] = complex_of(pair_x(pair_product(sums[k], back)) * scale, pair_y(pair_product(sums[k], back)) * scale);
    }
}

void race_answer(RaceSeries *race, const double *angles, const double *speeds, const Instant *centre, Complex *force,
                 double *torque, double *accelerations)
{
    CentreMotion motion = {{centre->motion[0], centre->motion[1], {0.0, 0.0}, {0.0, 0.0}}, centre->spin};
    double rate;
    int w;
    set_time(race, absolute(centre->spin.speed) + largest_of(race->count, speeds));
    rate = 1.0 / race->per_rate;
    set_motion(race, &motion, ANSWER_ORDER);
    for (w = 0; w < race->count; w++) {
        expand(race, w, angles[w], speeds[w] * race->per_rate, ANSWER_ORDER);
        if (accelerations) {
            accelerations[w] = 2.0 * angle_term(race, w, 2) * rate * rate;
        }
    }
    if (force) {
        race_sum(race->weights, race->count, race->spin, race->offset, race->speed[0], rate, force, torque);
    }
}
