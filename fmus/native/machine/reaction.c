/* What weights push their rotor with. */
#include "machine/phase.h"

/* y'' of order k, a weight at y = e E + R p from its plane's centre, without that of e E. */
static Pair second_of(const Machine *m, const SeriesWeight *weight, const Weights *one, int k)
{
    Pair second = pair_scaled(weight->unit[k + 2], (k + 1.0) * (k + 2.0));
    int j;
    for (j = 0; j <= k && m->from_rotor; j++) {
        const double speed = j <= m->speed_order ? 2.0 * m->speed[j] : 0.0;
        second = pair_add_scaled(second, pair_turned(weight->unit[k - j + 1]), speed * (k - j + 1));
        second = pair_sum(second, pair_product(machine_turn_twice(m, j), weight->unit[k - j]));
    }
    return pair_scaled(second, one->track_radius);
}

/* Torque on the rotor of what resists a weight's rolling, of order k: it slides, or rests. */
static double resistance_of(const Machine *m, int w, int k)
{
    const PhaseWeight *own = m->phase->weights + w;
    const SeriesWeight *weight = m->weights + w;
    if (own->grip == 0.0) {
        return 0.0;
    }
    if (m->phase->groups[own->group].rests) {
        return weight->moment / weight->lever * (own->alone[k] - phase_turning(m, weight, k + 1) * (k + 1));
    }
    return own->slip * own->side * own->grip * weight->moment * own->load[k];
}

/* Torque of a weight about the plane's centre of order k: of its drag, of its body, which eta = R theta' - r w turns,
   of resistance, and of its force at a track's centre that is off. */
static double torque_of(const Machine *m, const MachineTrack *track, int w, const Weights *one, int k)
{
    const SeriesWeight *weight = m->weights + w;
    const double spun = k < m->speed_order ? m->speed[k + 1] * (k + 1) : 0.0;
    const double turned = phase_turning(m, weight, k + 1) * (k + 1) - spun;
    const double speed = pair_at(m->velocity[k * m->width + m->stations + w / 2], w % 2);
    double sum = weight->torque * speed +
                 one->mass * weight->roll * (one->track_radius * turned - one->radius * spun);
    int j;
    for (j = 0; j <= k && track->is_off; j++) {
        const Pair felt = pair_sum(pair_turned(track->pull[k - j]), second_of(m, weight, one, k - j));
        sum -= one->mass * pair_crossed(pair_product(track->offset, m->spin[j]), felt);
    }
    return m->phase ? sum + resistance_of(m, w, k) : sum;
}

/* Add the derivatives of order 0 to 3 of m R e^{i theta} to their sums, from those of theta. */
static void add_moment(Pair moment, const double *rates, Pair *sums)
{
    const double nu = rates[0], nu_1 = rates[1], nu_2 = rates[2], squared = nu * nu;
    const Pair factors[3] = {pair_of(0.0, nu), pair_of(-squared, nu_1), pair_of(-3.0 * nu * nu_1, nu_2 - nu * squared)};
    int k;
    sums[0] = pair_sum(sums[0], moment);
    for (k = 1; k < 4; k++) {
        sums[k] = pair_sum(sums[k], pair_product(factors[k - 1], moment));
    }
}

/* Force and its slope, in the machine's time, of weights on a round race.  In the rotor's axes, where they move slowly,
   it is with the derivatives of u = sum of m (e + R e^{i theta})
       -(u'' + 2 i w u' + (i w' - w^2) u). */
static void push_round(const Machine *m, const MachineTrack *track, Pair back, Pair *force)
{
    const double w = m->speed[0], w_1 = m->speed_order > 0 ? m->speed[1] : 0.0, w_2 = m->speed_order > 1 ? 2.0 * m->speed[2] : 0.0;
    const Pair coriolis = pair_of(0.0, 2.0 * w);
    Pair u[4] = {pair_scaled(track->offset, track->mass), pair_zero(), pair_zero(), pair_zero()}, sum;
    int k;
    for (k = track->first; k < track->end; k++) {
        const Pair *speed = m->velocity + m->stations + k / 2;
        const double rates[3] = {pair_at(speed[0], k % 2), pair_at(speed[m->width], k % 2),
                                 2.0 * pair_at(speed[2 * m->width], k % 2)};
        add_moment(pair_scaled(pair_product(m->weights[k].unit[0], back), m->weights[k].moment), rates, u);
    }
    sum = pair_sum(u[2], pair_product(coriolis, u[1]));
    force[0] = pair_negative(pair_sum(sum, pair_product(pair_of(-w * w, w_1), u[0])));
    sum = pair_sum(u[3], pair_product(coriolis, u[2]));
    sum = pair_sum(sum, pair_product(pair_of(-w * w, 3.0 * w_1), u[1]));
    force[1] = pair_negative(pair_sum(sum, pair_product(pair_of(-2.0 * w * w_1, w_2), u[0])));
}

/* The same on one that is not. */
static void push_race(const Machine *m, const MachineTrack *track, Pair back, Pair *force)
{
    Pair sums[2];
    int k, w;
    for (k = 0; k < 2; k++) {
        sums[k] = pair_scaled(pair_product(track->offset, m->spin[k + 2]), -track->mass * ((k + 1.0) * (k + 2.0)));
        for (w = track->first; w < track->end; w++) {
            sums[k] = pair_sum(sums[k], series_race_push(m->weights + w, k));
        }
    }
    force[0] = pair_product(sums[0], back);
    force[1] = pair_product(pair_difference(sums[1], pair_scaled(pair_turned(sums[0]), m->speed[0])), back);
}

void machine_reaction(const Machine *m, int number, const Track *of, Complex *force, double *torque)
{
    const MachineTrack *track = m->tracks + number;
    const Pair back = pair_of(pair_x(m->spin[0]), -pair_y(m->spin[0]));
    double scale = m->rate * m->rate;
    Pair push[2];
    int k, w;
    if (track->lobes) {
        push_race(m, track, back, push);
    } else {
        push_round(m, track, back, push);
    }
    for (k = 0; k < 2; k++, scale *= m->rate) {
        force[k] = complex_of(pair_x(push[k]) * scale, pair_y(push[k]) * scale);
        if (torque) {
            torque[k] = 0.0;
        }
        for (w = track->first; w < track->end && torque; w++) {
            const Weights one = weights_single(&of->weights, w - track->first);
            torque[k] += scale * (track->lobes ? series_race_turning(m->weights + w, k, m->spin, track->offset)
                                               : torque_of(m, track, w, &one, k));
        }
    }
}
