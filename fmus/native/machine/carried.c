#include "machine/carried.h"

#include "base/elementary.h"
#include "base/matrix.h"

enum { LOOK_ORDER = 3 };
#define SLOWEST_PACE 1e-6 /* 1/s */

CarriedWeights *carried_allocate(Unit *unit, int count, int lobes)
{
    const size_t n = (size_t)count;
    CarriedWeights *c = unit_allocate(unit, 1, sizeof *c);
    if (!c) {
        return NULL;
    }
    c->phase = phase_allocate(unit, 1, count, 0);
    c->impact = unit_allocate(unit, phase_impact_doubles(1, count), sizeof(double));
    c->scratch = unit_allocate(unit, ring_scratch(count), sizeof(double));
    c->rates = unit_allocate(unit, n, sizeof(double));
    return !c->phase || !c->impact || !c->scratch || !c->rates || machine_allocate(unit, &c->step, 1, count, 1, lobes) ||
                   machine_allocate(unit, &c->at, 1, count, 1, lobes) ||
                   collocation_allocate(unit, &c->collocation, 1, count) ||
                   relaxation_allocate(unit, &c->relaxation, count)
               ? NULL
               : c;
}

static void make_carried(const CarriedWeights *c, Machine *m, Carried *now, double rate)
{
    static const Number row[1] = {1.0};
    machine_take_carried(m, now, rate);
    machine_take_weights(m, row, c->track);
    machine_take_mobility(m, c->track->mobility);
    m->phase = c->track->eventful ? c->phase : NULL;
    if (m->phase) {
        phase_take_track(m, 0, c->track);
    }
}

void carried_set_pace(CarriedWeights *c, double fastest)
{
    const double rate = scaled_by_power(1.0, binary_exponent(larger(fastest, SLOWEST_PACE)));
    if (c->step.rate != rate) {
        make_carried(c, &c->step, &c->step_now, rate);
        make_carried(c, &c->at, &c->at_now, rate);
    }
}

void carried_take(CarriedWeights *c, const Track *track)
{
    int k;
    c->track = track;
    c->step.rate = 0.0; /* of other weights */
    c->fastest = 0.0;
    c->slowest = infinity();
    c->phase->grain = 1.0;
    c->phase->slider_count = 0;
    for (k = 0; k < track->weights.count; k++) {
        const Weights one = weights_single(&track->weights, k);
        c->fastest = larger(c->fastest, weights_damping_rate(&one));
        c->slowest = smaller(c->slowest, weights_damping_rate(&one));
    }
}

/* -- where the weights stand ------------------------------------------------------------------------------ */

static void load_motion(CarriedWeights *c, const Complex *signal, int orders, const Spin *spin)
{
    const double t = c->step.per_rate;
    double over = t, factor = 1.0;
    int k;
    c->start.speed[0] = spin->speed * t;
    c->start.speed_order = 0;
    for (k = 0; k < SIGNAL_ORDERS; k++) {
        over *= t;
        factor /= k ? k : 1;
        c->start.signal[k] = k < orders ? pair_of(over * factor * signal[k].re, over * factor * signal[k].im) : pair_zero();
        c->start.speed[k + 1] = spin->rates[k] * over * factor / (k + 1);
        c->start.speed_order = c->start.speed[k + 1] != 0.0 ? k + 1 : c->start.speed_order;
    }
}

static void load_weights(CarriedWeights *c, const double *angles, const double *speeds, const double *contacts)
{
    Machine *m = &c->step;
    int w;
    m->motion[0] = m->velocity[0] = pair_zero();
    m->collocated_order = 0;
    for (w = 0; w < m->weight_count; w++) {
        pair_set(&m->motion[1 + w / 2], w % 2, angles[w]);
        pair_set(&m->velocity[1 + w / 2], w % 2, speeds[w] * m->per_rate);
    }
    if (!m->phase) {
        return;
    }
    phase_order_track(m, c->track, 0);
    for (w = 0; w < m->weight_count; w++) {
        PhaseWeight *own = m->phase->weights + w;
        own->joined = own->ahead >= 0 && (own->lasts || contacts[w] != 0.0);
        own->slip = own->grip > 0.0 && speeds[w] != 0.0 ? copy_sign(1.0, speeds[w]) : 0.0;
        own->side = 1.0;
    }
    phase_group(m);
}

void carried_load(CarriedWeights *c, const Complex *signal, int orders, const Spin *spin, const double *angles,
                  const double *speeds, const double *contacts)
{
    load_motion(c, signal, orders, spin);
    machine_carry(&c->step, &c->start, 0.0);
    load_weights(c, angles, speeds, contacts);
}

int carried_look(CarriedWeights *c, const double *angles, const double *speeds, const double *contacts,
                 const Instant *plane, Failure *failure)
{
    Machine *m = &c->step;
    if (!(c->step.rate > 0.0)) {
        carried_set_pace(c, absolute(plane->spin.speed) + largest_of(c->track->weights.count, speeds));
    }
    carried_load(c, plane->motion, 2, &plane->spin, angles, speeds, contacts);
    if (!m->phase) {
        machine_expand(m, 0.0, LOOK_ORDER);
    } else if (phase_decide(m, 0.0, LOOK_ORDER)) {
        return fail(failure, "no solution was found for which weights touch and which stick");
    }
    return FINE;
}

double carried_acceleration(const CarriedWeights *c, int weight)
{
    return phase_acceleration(&c->step, weight) * c->step.rate * c->step.rate;
}
