#include "contact/groups.h"

#include "base/elementary.h"

#define INSTANT 1e-90 /* s: nothing moves, and cubes of shorter times are not told from 0 */

void fill_forcings(WeightsInOrder *weights, int first, int size, const Instant *now)
{
    const Track *track = weights->track;
    int j;
    for (j = 0; j < size; j++) {
        const int k = (first + j) % weights->count;
        const Complex z = complex_product(now->motion[0], rect(1.0, -weights->angle[k]));
        const double rate = weights->angle_rate[k], turning = now->spin.speed + rate;
        double g = track->lever * z.im - weights->spin_share[k] * now->spin.rates[0] -
                   weights->damping_rate[k] * rate;
        double f = 0.0;
        if (track->grip != 0.0) {
            const double centrifugal = track->weights.track_radius * (turning * turning);
            f = track->grip * absolute(centrifugal - z.re);
            if (rate != 0.0) {
                g -= copy_sign(f, rate);
                f = 0.0;
            }
        }
        weights->forcings[j] = weights->mass[k] * g;
        weights->limits[j] = weights->mass[k] * f;
    }
}

/* Mass of group i, and means of what its weights have of their own. */
static void find_means(WeightsInOrder *weights, int i)
{
    Groups *groups = &weights->groups;
    const int first = groups->runs.first[i], size = groups->runs.size[i];
    double mass = 0.0, damping = 0.0, share = 0.0;
    int j;
    groups->mass[i] = size;
    groups->damping_rate[i] = weights->track->damping_rate;
    groups->spin_share[i] = weights->track->spin_share;
    for (j = first; weights->track->weights.each && j < first + size; j++) {
        mass += weights->mass[j];
        damping += weights->mass[j] * weights->damping_rate[j % weights->count];
        share += weights->mass[j] * weights->spin_share[j % weights->count];
        groups->mass[i] = mass;
        groups->damping_rate[i] = damping / mass;
        groups->spin_share[i] = share / mass;
    }
}

/* One group more; `angle_acceleration` tells one that does not move yet where to. */
static void append_group(WeightsInOrder *weights, int first, int size, double angle_acceleration)
{
    Groups *groups = &weights->groups;
    const int i = groups->runs.count;
    const double rate = weights->angle_rate[first];
    groups->runs.first[i] = first;
    groups->runs.size[i] = size;
    groups->factor[i] = find_offsets(weights, first, size);
    groups->middle[i] = weights->angle[first] - weights->offset[first];
    find_means(weights, i);
    groups->angle_rate[i] = rate;
    groups->sign[i] = 0.0;
    groups->resting[i] = 0;
    if (weights->track->grip != 0.0) {
        const double way = rate != 0.0 ? rate : angle_acceleration;
        groups->resting[i] = way == 0.0;
        if (way != 0.0) {
            groups->sign[i] = copy_sign(1.0, way);
        }
    }
    groups->runs.count = i + 1;
}

/* Split a chain of touching weights into the groups in which it moves. */
static void append_groups(WeightsInOrder *weights, int first, int size, const Instant *now,
                          double slack)
{
    const Track *track = weights->track;
    Pools *pools = &weights->pools;
    int length = size, j;
    fill_forcings(weights, first, size, now);
    if (track->full) { /* a closed ring cannot open */
        for (j = 1; j < size; j++) {
            weights->forcings[0] += weights->forcings[j];
            weights->limits[0] += weights->limits[j];
        }
        length = 1;
    }
    pool_violators(pools, weights->forcings, weights->limits, weights->mass + first, length, slack);
    for (j = 0; j < pools->count; j++) {
        const int begin = pools->first[j];
        if (begin) {
            weights->joined[(first + begin - 1) % weights->count] = 0;
        }
        append_group(weights, (first + begin) % weights->count, track->full ? size : pools->size[j],
                     pools->value[j]);
    }
}

void find_groups(WeightsInOrder *weights, const Instant *now)
{
    const Track *track = weights->track;
    const Runs *chains = &weights->chains;
    const double slack = PULL * (magnitude(complex_scaled(track->lever, now->motion[0])) +
                                 absolute(now->spin.rates[0]));
    int i;
    weights->groups.runs.count = 0;
    find_chains(weights);
    for (i = 0; i < chains->count; i++) {
        if (chains->size[i] == 1 && track->grip == 0.0) {
            append_group(weights, chains->first[i], 1, 0.0);
        } else {
            append_groups(weights, chains->first[i], chains->size[i], now, slack);
        }
    }
}

SlidingGroup sliding_group(const WeightsInOrder *weights, int i)
{
    const Track *track = weights->track;
    SlidingGroup group;
    group.radius = track->weights.track_radius;
    group.lever = track->lever;
    group.grip = weights->groups.sign[i] * track->grip;
    group.damping_rate = weights->groups.damping_rate[i];
    group.count = weights->groups.runs.size[i];
    group.spin_share = weights->groups.spin_share[i];
    group.factor = weights->groups.factor[i];
    group.inertia = weights->groups.mass[i];
    group.mass = weights->mass + weights->groups.runs.first[i];
    group.offset = weights->offset + weights->groups.runs.first[i];
    return group;
}

/* -1/(kappa R) times the factor of group i [1/m]. */
static double group_lever(const WeightsInOrder *weights, int i)
{
    return weights->track->lever * weights->groups.factor[i];
}

void move_group(WeightsInOrder *weights, int i, const Instant *now, const Instant *later,
                double step, double *middle, double *rate)
{
    const Groups *groups = &weights->groups;
    const double damping_rate = groups->damping_rate[i];
    const double *response;
    *middle = groups->middle[i];
    *rate = groups->angle_rate[i];
    if (groups->resting[i]) {
        *rate = 0.0;
        return;
    }
    if (step < INSTANT) {
        return;
    }
    response = quadrature(&weights->quadrature, damping_rate, step);
    if (groups->sign[i] != 0.0) {
        const SlidingGroup group = sliding_group(weights, i);
        sliding_substep(&group, middle, rate, now, later, response, step, weights->sides,
                        weights->failure);
    } else {
        const Driven start = driven_by(now, groups->spin_share[i]);
        const Driven end = driven_by(later, groups->spin_share[i]);
        weights_substep(middle, rate, &start, &end, group_lever(weights, i), rect(1.0, *middle),
                        response, step, weights->failure);
    }
}

void find_group_acceleration(WeightsInOrder *weights, int i, double middle, double angle_rate,
                             const Instant *now, double *accelerations)
{
    const double damping_rate = weights->groups.damping_rate[i];
    double forcing[2];
    if (weights->groups.resting[i]) {
        accelerations[0] = accelerations[1] = 0.0;
        return;
    }
    if (weights->groups.sign[i] != 0.0) {
        const SlidingGroup group = sliding_group(weights, i);
        const int side_count = find_sides(&group, now, middle, angle_rate, weights->sides);
        find_sliding_forcing(&group, now, middle, angle_rate, weights->sides, side_count, forcing);
    } else {
        const Driven by = driven_by(now, weights->groups.spin_share[i]);
        find_forcing(&by, rect(group_lever(weights, i), -middle), angle_rate, forcing);
    }
    accelerations[0] = forcing[0] - damping_rate * angle_rate;
    accelerations[1] = forcing[1] - damping_rate * accelerations[0];
}

/* How many times theta'' of group i counts in `weights_unhindered`. */
static double group_arm(const WeightsInOrder *weights, int i)
{
    const Weights *all = &weights->track->weights;
    const int first = weights->groups.runs.first[i], size = weights->groups.runs.size[i];
    double sum = 0.0;
    int j;
    for (j = first; all->each && j < first + size; j++) {
        const Weights one = weights_single(all, weights->order[j % weights->count]);
        sum += weights_arm(&one) / weights_arm(all);
    }
    return all->each ? sum : size;
}

void ring_turning(WeightsInOrder *weights, const Instant *now, double *turned)
{
    const Groups *groups = &weights->groups;
    int i;
    turned[0] = turned[1] = 0.0;
    find_groups(weights, now);
    for (i = 0; i < groups->runs.count; i++) {
        double accelerations[2];
        find_group_acceleration(weights, i, groups->middle[i], groups->angle_rate[i], now,
                                accelerations);
        turned[0] += group_arm(weights, i) * accelerations[0];
        turned[1] += group_arm(weights, i) * accelerations[1];
    }
}

void ring_reaction(WeightsInOrder *weights, const Instant *now, Complex *force)
{
    const Groups *groups = &weights->groups;
    Complex sums[4] = {{0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}};
    int i;
    find_groups(weights, now);
    for (i = 0; i < groups->runs.count; i++) {
        const Complex unit = rect(groups->mass[i] * groups->factor[i], groups->middle[i]);
        double rates[3];
        rates[0] = groups->angle_rate[i];
        find_group_acceleration(weights, i, groups->middle[i], rates[0], now, rates + 1);
        add_derivatives(unit, rates, sums);
    }
    find_force(weights->track->moment, sums, &now->spin, force);
}
