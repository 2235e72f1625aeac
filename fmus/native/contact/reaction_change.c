#include "contact/reaction_change.h"

#include "base/elementary.h"
#include "contact/contact.h"
#include "contact/groups.h"
#include "contact/resistance.h"
#include "contact/ring.h"

/* What drives the weights, and a change of it. */
typedef struct {
    Instant now, by;
    double angular_acceleration, by_angular_acceleration, by_change;
} DrivenChange;

/* Change of the mean drive of a group, per unit vector and wall, and of its time derivative. */
typedef struct {
    double load, drive, slope;
} DriveChange;

/* One term of the sums in sliding_drive. */
static void add_term(const DrivenChange *d, Complex unit, double lever, double pull, double rate,
                     DriveChange *sum)
{
    const Complex z = complex_product(d->by.acceleration, unit);
    const Complex dz = complex_product(d->by.slope, unit);
    sum->load += pull;
    sum->drive += lever * z.im + pull * z.re;
    sum->slope += lever * (dz.im - rate * z.re) + pull * (dz.re + rate * z.im);
}

/* Change of a sliding group's acceleration theta_2 and of its derivative. */
static void sliding_change(const WeightsInOrder *weights, int i, const DrivenChange *d, double theta_2,
                           double *change, double *slope_change)
{
    const SlidingGroup group = sliding_group(weights, i);
    const double middle = weights->groups.middle[i], rate = weights->groups.angle_rate[i];
    const double turning = d->now.rotor_speed + rate;
    const int side_count =
        find_sides(&group, d->now.acceleration, middle, rate, d->now.rotor_speed, weights->sides);
    const double share = side_count ? 1.0 / side_count : 1.0;
    DriveChange sum = {0.0, 0.0, 0.0};
    int k;
    if (!side_count) {
        const double factor = group_factor(group.count, group.alpha);
        add_term(d, rect(factor, -middle), group.lever, group.grip, rate, &sum);
    }
    for (k = 0; k < side_count; k++) {
        const double turn = (2 * k - group.count + 1) * group.alpha;
        add_term(d, rect(1.0, -middle - turn), group.lever, group.grip * weights->sides[k], rate,
                 &sum);
    }
    *change = share * (sum.drive - sum.load * 2.0 * group.radius * turning * d->by.rotor_speed) -
              group.spin_share * d->by_angular_acceleration;
    sum.slope -= 2.0 * sum.load * group.radius *
                 (d->by.rotor_speed * (d->angular_acceleration + theta_2) +
                  turning * (d->by_angular_acceleration + *change));
    *slope_change = share * sum.slope - group.damping_rate * *change;
}

/* Change of group i's acceleration theta_2 and of its derivative. */
static void group_change(const WeightsInOrder *weights, int i, const DrivenChange *d, double theta_2,
                         double *change, double *slope_change)
{
    const Groups *groups = &weights->groups;
    const double lever = weights->track->lever;
    if (groups->resting[i]) {
        *change = *slope_change = 0.0;
    } else if (groups->sign[i] != 0.0) {
        sliding_change(weights, i, d, theta_2, change, slope_change);
    } else {
        const double factor = group_factor(groups->runs.size[i], weights->track->alpha);
        DriveChange sum = {0.0, 0.0, 0.0};
        add_term(d, rect(factor, -groups->middle[i]), lever, 0.0, groups->angle_rate[i], &sum);
        *change = sum.drive - weights->track->spin_share * d->by_angular_acceleration;
        *slope_change = sum.slope - weights->track->damping_rate * *change -
                        weights->track->spin_share * d->by_change;
    }
}

/* The differential of ring_reaction, whose symbols these are. */
static void ring_change(WeightsInOrder *weights, const DrivenChange *d, Complex *force,
                        Complex *force_slope)
{
    const Groups *groups = &weights->groups;
    const double w = d->now.rotor_speed, by = d->by.rotor_speed;
    const double product = 2.0 * (by * d->angular_acceleration + w * d->by_angular_acceleration);
    const Complex turn = {0.0, 2.0 * w}, by_turn = {0.0, 2.0 * by};
    const Complex by_pull = {-2.0 * w * by, d->by_angular_acceleration};
    const Complex by_pull_slope = {by_pull.re, 3.0 * by_pull.im};
    const double scale = -weights->track->moment;
    Complex moment = {0.0, 0.0}, first = moment, second = moment, by_second = moment;
    Complex by_third = moment, sum;
    int i;
    find_groups(weights, &d->now, d->angular_acceleration);
    for (i = 0; i < groups->runs.count; i++) {
        const int size = groups->runs.size[i];
        const double nu = groups->angle_rate[i];
        const Complex unit =
            rect(size * group_factor(size, weights->track->alpha), groups->middle[i]);
        double theta_2, theta_3, change, slope_change;
        group_acceleration(weights, i, groups->middle[i], nu, &d->now, d->angular_acceleration,
                           &theta_2, &theta_3);
        group_change(weights, i, d, theta_2, &change, &slope_change);
        moment = complex_sum(moment, unit);
        first = complex_sum(first, complex_product(complex_of(0.0, nu), unit));
        second = complex_sum(second, complex_product(complex_of(-nu * nu, theta_2), unit));
        by_second = complex_sum(by_second, complex_product(complex_of(0.0, change), unit));
        by_third = complex_sum(by_third,
                               complex_product(complex_of(-3.0 * nu * change, slope_change), unit));
    }
    sum = complex_sum(by_second, complex_product(by_turn, first));
    sum = complex_sum(sum, complex_product(by_pull, moment));
    *force = complex_scaled(scale, sum);
    sum = complex_sum(by_third, complex_product(by_turn, second));
    sum = complex_sum(sum, complex_product(turn, by_second));
    sum = complex_sum(sum, complex_product(by_pull_slope, first));
    sum = complex_difference(sum, complex_scaled(product, moment));
    sum = complex_sum(sum, complex_product(complex_of(0.0, d->by_change), moment));
    *force_slope = complex_scaled(scale, sum);
}

/* Weights in order, what drives them and its change; about the track's centre. */
static int prepare(const Track *track, const double *angles, const double *speeds,
                   const double *contacts, Complex acceleration, Complex slope, double rotor_speed,
                   double angular_acceleration, const Instant *by, double by_angular_acceleration,
                   double by_change, double *scratch, WeightsInOrder *weights, DrivenChange *d,
                   Failure *failure)
{
    const Complex whirl = {-(rotor_speed * rotor_speed), angular_acceleration};
    const Complex by_whirl = {-2.0 * rotor_speed * by->rotor_speed, by_angular_acceleration};
    const double whirl_slope = 2.0 * rotor_speed * angular_acceleration;
    const Complex offset = track->offset, by_turn = {0.0, by_change};
    const int code = put_in_order(track, angles, speeds, contacts, scratch, weights, failure);
    if (code) {
        return code;
    }
    d->now.acceleration = complex_sum(acceleration, complex_product(whirl, offset));
    d->now.slope = complex_difference(slope, complex_scaled(whirl_slope, offset));
    d->now.rotor_speed = rotor_speed;
    d->by.acceleration = complex_sum(by->acceleration, complex_product(by_whirl, offset));
    d->by.slope = complex_difference(
        by->slope, complex_scaled(2.0 * (by->rotor_speed * angular_acceleration +
                                         rotor_speed * by_angular_acceleration), offset));
    d->by.slope = complex_sum(d->by.slope, complex_product(by_turn, offset));
    d->by_change = track->eventful ? 0.0 : by_change; /* which weights that meet do not take */
    d->by.rotor_speed = by->rotor_speed;
    d->angular_acceleration = angular_acceleration;
    d->by_angular_acceleration = by_angular_acceleration;
    return FINE;
}

int track_turning_change(const Track *track, const double *angles, const double *speeds,
                         const double *contacts, Complex acceleration, Complex slope,
                         double rotor_speed, double angular_acceleration, const Instant *by,
                         double by_angular_acceleration, double by_change, double *turned,
                         double *scratch, Failure *failure)
{
    WeightsInOrder weights;
    DrivenChange d;
    int i;
    const int code = prepare(track, angles, speeds, contacts, acceleration, slope, rotor_speed,
                             angular_acceleration, by, by_angular_acceleration, by_change, scratch,
                             &weights, &d, failure);
    turned[0] = turned[1] = 0.0;
    if (code) {
        return code;
    }
    find_groups(&weights, &d.now, angular_acceleration);
    for (i = 0; i < weights.groups.runs.count; i++) {
        const int size = weights.groups.runs.size[i];
        double theta_2, theta_3, change, slope_change;
        group_acceleration(&weights, i, weights.groups.middle[i], weights.groups.angle_rate[i],
                           &d.now, angular_acceleration, &theta_2, &theta_3);
        group_change(&weights, i, &d, theta_2, &change, &slope_change);
        turned[0] += size * change;
        turned[1] += size * slope_change;
    }
    return FINE;
}

int track_reaction_change(const Track *track, const double *angles, const double *speeds,
                          const double *contacts, Complex acceleration, Complex slope,
                          double rotor_speed, double angular_acceleration, const Instant *by,
                          double by_angular_acceleration, double by_change, Complex *force,
                          Complex *force_slope, double *scratch, Failure *failure)
{
    const Complex by_whirl = {-2.0 * rotor_speed * by->rotor_speed, by_angular_acceleration};
    const double by_whirl_slope =
        2.0 * (by->rotor_speed * angular_acceleration + rotor_speed * by_angular_acceleration);
    const Complex by_turn = {0.0, by_change};
    const Complex carried = complex_scaled(weights_added_mass(&track->weights), track->offset);
    WeightsInOrder weights;
    DrivenChange d;
    const int code = prepare(track, angles, speeds, contacts, acceleration, slope, rotor_speed,
                             angular_acceleration, by, by_angular_acceleration, by_change, scratch,
                             &weights, &d, failure);
    if (code) {
        return code;
    }
    ring_change(&weights, &d, force, force_slope);
    *force = complex_difference(*force, complex_product(carried, by_whirl));
    *force_slope = complex_sum(*force_slope, complex_scaled(by_whirl_slope, carried));
    *force_slope = complex_difference(*force_slope, complex_product(by_turn, carried));
    return FINE;
}
