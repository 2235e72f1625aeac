/* Impacts of weights as events of the whole machine: the weights of all tracks and the rotor. */
#include <string.h>

#include "base/elementary.h"
#include "base/matrix.h"
#include "contact/impacts.h"
#include "coupling/composite.h"

struct Impacts {
    int count;         /* weights of all tracks */
    double *mass;      /* (n, n) scratch: the loaded rotor's */
    double *give;      /* (n, p) M^-1 S^T: velocities of the stations for unit impulses [1/kg] */
    double *mobility;  /* (p, p) S M^-1 S^T [1/kg] */
    double *memory;    /* of an Impact */
    WeightsInOrder *tracks; /* (parts,) */
    Failure failure;
};

int impacts_allocate(Unit *unit)
{
    Composite *c = unit->own;
    struct Impacts *impacts = unit_allocate(unit, 1, sizeof *impacts);
    const size_t n = (size_t)composite_rotor(c)->stations, p = (size_t)composite_rotor(c)->planes;
    int k;
    c->impacts = impacts;
    if (!impacts) {
        return 1;
    }
    for (k = 1; k < c->parts_without_motor; k++) {
        impacts->count += part_balls(c->parts + k) ? c->parts[k].unit->layout.sizes.weights : 0;
    }
    impacts->mass = unit_allocate(unit, n * n, sizeof(double));
    impacts->give = unit_allocate(unit, n * p, sizeof(double));
    impacts->mobility = unit_allocate(unit, p * p, sizeof(double));
    impacts->memory = unit_allocate(unit, impact_doubles(impacts->count) + 1, sizeof(double));
    impacts->tracks = unit_allocate(unit, (size_t)c->part_count, sizeof *impacts->tracks);
    return !impacts->mass || !impacts->give || !impacts->mobility || !impacts->memory ||
           !impacts->tracks;
}

int impacts_prepare(Unit *unit)
{
    Composite *c = unit->own;
    const LinearRotor *rotor = &composite_rotor(c)->rotor;
    const int n = rotor->stations, p = rotor->plane_count;
    struct Impacts *impacts = c->impacts;
    int k;
    composite_added_masses(c, c->masses);
    linear_rotor_with_added_mass(rotor, c->masses, impacts->mass);
    matrix_transposed(1, p, n, rotor->planes, impacts->give);
    if (matrix_solve(1, n, p, impacts->mass, impacts->give)) {
        return unit_fail(unit, "the rotor's mass matrix is singular");
    }
    matrix_product(1, p, n, p, rotor->planes, impacts->give, impacts->mobility);
    /* where steps do not end at impacts, a track knows the mobility of its own plane alone */
    for (k = 1; k < c->parts_without_motor; k++) {
        Balls *balls = part_balls(c->parts + k);
        if (balls) {
            balls->track.mobility = impacts->mobility[c->parts[k].plane * (p + 1)];
        }
    }
    return 0;
}

/* Put the weights of a part in order as they stand; 1 with the reason. */
static int read_track(Unit *unit, const Part *part, WeightsInOrder *weights)
{
    Failure *failure = &((Composite *)unit->own)->impacts->failure;
    const Balls *balls = part->unit->own;
    const double *angles = part->unit->memory, *speeds = angles + balls->count;
    if (order_weights(&balls->track, angles, speeds, speeds + balls->count, balls->scratch, weights,
                     failure)) {
        unit_failed(part->unit, failure);
        return composite_part_failed(unit, part);
    }
    return 0;
}

/* What drives the weights of a part before the impact. */
static Instant drive_of(const Composite *c, const Part *part)
{
    const Course *course = c->course;
    const Balls *balls = part->unit->own;
    const double spin_up[4] = {course->drive.acceleration, 0.0, 0.0, 0.0};
    Instant now;
    now.spin = spin_of(0.0, composite_speed(c, course->clock.time), spin_up);
    now.motion[0] = now.motion[1] = complex_of(0.0, 0.0);
    shift_signal(now.motion, 1, balls->track.offset, now.spin.speed, spin_up);
    if (part->force_number >= 0) {
        const Knot *plane = &c->accelerations[c->member_planes[part->force_number]].now;
        now.motion[0] = complex_sum(now.motion[0], plane->value);
    }
    return now;
}

/* Let the rotor's stations jump by the impulses on its planes. */
static void push_rotor(Composite *c, const Impact *impact)
{
    Rotor *rotor = composite_rotor(c);
    double *memory = c->parts->unit->memory, *velocity = memory + MOTION + 2 * rotor->stations;
    const Complex turn = rect(1.0, memory[REST]);
    int i, plane;
    for (plane = 0; plane < rotor->planes; plane++) {
        const Complex impulse = complex_product(impact_on_plane(impact, plane), turn);
        for (i = 0; i < rotor->stations; i++) {
            const double give = c->impacts->give[i * rotor->planes + plane];
            velocity[2 * i] += give * impulse.re;
            velocity[2 * i + 1] += give * impulse.im;
        }
    }
    if (rotor->slider_count) { /* no friction holds against an impact */
        friction_at_jump(rotor->sliders, rotor->slider_count, velocity,
                         rotor_slider_states(c->parts->unit));
    }
}

/* Take over rates and contacts; whether pairs that bounce too low are left to be solved again. */
static int apply_impact(Composite *c, Impact *impact)
{
    int k, first = 0, low = 0;
    for (k = 1; k < c->parts_without_motor; k++) {
        const Part *part = c->parts + k;
        if (part_balls(part)) {
            const Instant now = drive_of(c, part);
            WeightsInOrder *weights = c->impacts->tracks + k;
            low += impact_apply(impact, first, weights, &now);
            first += weights->count;
        }
    }
    return low;
}

/* Write the weights' speeds and contacts into the memories of their units. */
static int write_tracks(Unit *unit)
{
    Composite *c = unit->own;
    int k;
    for (k = 1; k < c->parts_without_motor; k++) {
        Unit *part = c->parts[k].unit;
        WeightsInOrder *weights = c->impacts->tracks + k;
        if (part_balls(c->parts + k)) {
            double *angles = part->memory, *speeds = angles + weights->count;
            if (weights->track->solid && align_chains(weights)) {
                unit_failed(part, weights->failure);
                return composite_part_failed(unit, c->parts + k);
            }
            write_weights(weights, angles, speeds, speeds + weights->count);
        }
    }
    return 0;
}

static bool can_meet(const Composite *c)
{
    int k, found = 0;
    for (k = 1; k < c->parts_without_motor && !found; k++) {
        const Balls *balls = part_balls(c->parts + k);
        found = balls && balls->track.solid && !balls->track.full;
    }
    return found;
}

int impacts_strike(Unit *unit, double soon, int *struck)
{
    Composite *c = unit->own;
    const int planes = composite_rotor(c)->planes;
    Impact impact =
        impact_begin(c->impacts->mobility, planes, c->impacts->count, c->impacts->memory);
    int k;
    *struck = 0;
    if (!can_meet(c)) {
        return 0;
    }
    for (k = 1; k < c->parts_without_motor; k++) {
        WeightsInOrder *weights = c->impacts->tracks + k;
        if (part_balls(c->parts + k)) {
            if (read_track(unit, c->parts + k, weights)) {
                return 1;
            }
            *struck |= approaching(weights, soon);
            impact_add(&impact, weights, c->parts[k].plane, -1, soon);
        }
    }
    if (!*struck) {
        return 0;
    }
    do {
        if (impact_solve(&impact, &c->impacts->failure)) {
            return unit_failed(unit, &c->impacts->failure);
        }
    } while (apply_impact(c, &impact));
    push_rotor(c, &impact);
    if (write_tracks(unit)) {
        return 1;
    }
    /* the step to come begins behind the impact, and what was before it predicts nothing */
    memcpy(c->at_begin, c->states, c->state_count * sizeof(double));
    composite_drop_past(c);
    return 0;
}
