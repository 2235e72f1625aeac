/* The phase of a machine in one piece: what the memories of its parts say of who touches and what sticks. */
#include "base/elementary.h"
#include "coupling/composite.h"
#include "machine/restraints.h"

static int weights_of(const Composite *c)
{
    int k, count = 0;
    for (k = 1; k < c->parts_without_motor; k++) {
        const Balls *balls = part_balls(c->parts + k);
        count += balls ? c->parts[k].unit->layout.sizes.weights : 0;
    }
    return count;
}

size_t one_piece_phase_doubles(const Composite *c)
{
    return PHASE_OF_WEIGHT * (size_t)weights_of(c);
}

int one_piece_allocate_phases(Unit *unit)
{
    Composite *c = unit->own;
    Pieces *pieces = &c->pieces;
    const Sizes *sizes = &c->parts->unit->layout.sizes;
    const int weights = weights_of(c), stations = sizes->stations + pieces->rings;
    pieces->impact = unit_allocate(unit, phase_impact_doubles(stations, weights), sizeof(double));
    pieces->step_phase = phase_allocate(unit, stations, weights, 2 * sizes->sliders);
    pieces->instant_phase = phase_allocate(unit, stations, weights, 2 * sizes->sliders);
    return !pieces->impact || !pieces->step_phase || !pieces->instant_phase;
}

bool one_piece_is_eventful(const Composite *c)
{
    int k;
    const Rotor *rotor = composite_rotor(c);
    bool found = rotor->slider_count > 0 || rotor->stop_count > 0;
    for (k = 0; k < rotor->cubic_count; k++) {
        found |= rotor->cubics[k].limit > 0.0;
    }
    for (k = 1; k < c->parts_without_motor; k++) {
        const Balls *balls = part_balls(c->parts + k);
        found |= balls && balls->track.eventful;
    }
    return found;
}

/* -- a machine's phase ------------------------------------------------------------------------- */

void one_piece_make_phase(const Composite *c, Machine *m)
{
    const Rotor *rotor = composite_rotor(c);
    const double t = m->per_rate;
    struct Phase *phase = m->phase;
    int k, track = 0;
    for (k = 1; k < c->parts_without_motor; k++) {
        const Balls *balls = part_balls(c->parts + k);
        if (balls) {
            phase_take_track(m, track++, &balls->track);
        }
    }
    phase->grain = c->pieces.grain > 0.0 ? c->pieces.grain : 1.0;
    phase->slider_count = 0;
    for (k = 0; k < rotor->slider_count; k++) {
        const Slider *slider = rotor->sliders + k;
        PhaseSlider *own = phase->sliders + phase->slider_count;
        if (slider->limit > 0.0) {
            own->number = k;
            own->place = slider_place(slider);
            own->axis = slider->axis;
            own->row = slider->row;
            own->limit = slider->limit * t * t;
            own->stiffness = slider->stiffness * t * t;
            own->stroke = slider->stroke;
            phase->slider_count++;
        }
    }
}

static const double *memory_in(const Composite *c, const Part *part, const double *states)
{
    return states + (part->unit->memory - c->states);
}

void one_piece_load_phase(const Composite *c, Machine *m, const double *states)
{
    struct Phase *phase = m->phase;
    const double *slider_states = states + (rotor_slider_states(c->parts->unit) - c->states);
    const double *kept = c->pieces.phases;
    const bool follows_rate = !c->parts->unit->for_model_exchange || !c->course->one_piece.decided;
    int k, w, i = 0;
    for (k = 1; k < c->parts_without_motor; k++) {
        const Balls *balls = part_balls(c->parts + k);
        const double *contacts = balls ? memory_in(c, c->parts + k, states) + 2 * balls->count : NULL;
        if (balls) {
            phase_order_track(m, &balls->track, i);
        }
        for (w = 0; balls && w < balls->count; w++, i++, kept += PHASE_OF_WEIGHT) {
            PhaseWeight *own = phase->weights + i;
            const double rate = phase_rate(m, i);
            own->joined = own->ahead >= 0 && (own->lasts || contacts[w] != 0.0);
            /* a solver of the host may go beyond where it turns round */
            own->slip = own->grip == 0.0                  ? 0.0
                        : rate == 0.0 || !follows_rate    ? kept[SLIP_OF_WEIGHT]
                                                          : copy_sign(1.0, rate);
            own->side = kept[SIDE_OF_WEIGHT] < 0.0 ? -1.0 : 1.0;
        }
    }
    for (k = 0; k < phase->slider_count; k++) {
        PhaseSlider *own = phase->sliders + k;
        const double *kept_of = slider_states + SLIDER_DOUBLES * own->number;
        own->slip = kept_of[SLIPS];
        own->force = kept_of[HOLDS] * m->per_rate * m->per_rate;
        own->side = (int)kept_of[SIDE];
        own->play = kept_of[PLAY];
        if (own->slip != 0.0) {
            own->force = -own->slip * own->limit;
        }
    }
    for (k = 0; m->restraints && k < m->restraints->stop_count; k++) {
        const double *stop_states = states + (rotor_stop_states(c->parts->unit) - c->states);
        m->restraints->stops[k].state = (int)stop_states[STOP_DOUBLES * k + STOP_STATE];
    }
    phase_group(m);
}

void one_piece_place_sliders(const Composite *c, int order, double time)
{
    const Machine *m = &c->pieces.step;
    double *slider_states = rotor_slider_states(c->parts->unit);
    const int last = order - 2;
    int k, j;
    for (k = 0; k < m->phase->slider_count; k++) {
        const PhaseSlider *own = m->phase->sliders + k;
        double force = own->hold[last];
        for (j = last - 1; j >= 0; j--) {
            force = force * time + own->hold[j];
        }
        slider_states[SLIDER_DOUBLES * own->number + HOLDS] = force * m->rate * m->rate;
        if (phase_slider_is_loose(own)) {
            const Pair *motion = m->motion;
            double moved = phase_slider_along(m, own, motion + order * m->width);
            for (j = order - 1; j >= 1; j--) {
                moved = moved * time + phase_slider_along(m, own, motion + j * m->width);
            }
            slider_states[SLIDER_DOUBLES * own->number + PLAY] = own->play + moved * time;
        }
    }
}

void one_piece_place_stops(const Composite *c, int order, double time)
{
    const Machine *m = &c->pieces.step;
    double *stop_states = rotor_stop_states(c->parts->unit);
    int k;
    for (k = 0; k < m->restraints->stop_count; k++, stop_states += STOP_DOUBLES) {
        const double largest = restraints_largest(m->restraints->stops + k, order - 2, time) * m->rate * m->rate;
        stop_states[STOP_LARGEST] = larger(stop_states[STOP_LARGEST], largest);
    }
}
