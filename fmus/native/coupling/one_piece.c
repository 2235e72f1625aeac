/* Which composites go on in one piece, and their machines. */
#include "coupling/one_piece.h"

#include "base/elementary.h"
#include "base/matrix.h"
#include "base/spectral_radius.h"
#include "constants.h"
#include "coupling/composite.h"
#include "machine/restraints.h"

/* Cubic springs and stops of both machines; 1 where there is no memory. */
static int allocate_restraints(Unit *unit)
{
    Composite *c = unit->own;
    Machine *const machines[2] = {&c->pieces.step, &c->pieces.instant};
    const Sizes *sizes = &c->parts->unit->layout.sizes;
    int k;
    for (k = 0; k < 2 && (sizes->cubics || sizes->stops); k++) {
        machines[k]->restraints = restraints_allocate(unit, sizes->cubics, sizes->stops);
        if (!machines[k]->restraints) {
            return 1;
        }
    }
    return 0;
}

int one_piece_allocate(Unit *unit)
{
    Composite *c = unit->own;
    Pieces *pieces = &c->pieces;
    const Sizes *sizes = &c->parts->unit->layout.sizes;
    int weights = 0, tracks = 0, lobes = 0, rings = 0, stations, k;
    for (k = 1; k < c->parts_without_motor; k++) {
        const Balls *balls = part_balls(c->parts + k);
        weights += balls ? balls->count : 0;
        tracks += balls != NULL;
        lobes = balls && c->parts[k].unit->layout.sizes.lobes > lobes ? c->parts[k].unit->layout.sizes.lobes : lobes;
        rings += part_ring(c->parts + k) != NULL;
    }
    stations = sizes->stations + rings;
    pieces->rings = rings;
    for (k = 1; k < c->parts_without_motor; k++) {
        pieces->followers += c->parts[k].place >= 0;
    }
    pieces->looked_at = unit_allocate(unit, 2 * (size_t)stations, sizeof(double));
    pieces->places = unit_allocate(unit, (size_t)stations + ((size_t)weights + 1) / 2, sizeof(Pair));
    pieces->waves = unit_allocate(unit, 2 * (size_t)rings, sizeof(Pair));
    pieces->most_planned = unit->layout.real_count;
    pieces->planned = unit->layout.real_count + 1; /* none yet */
    pieces->planned_outputs = unit_allocate(unit, pieces->most_planned, sizeof(unsigned));
    pieces->plan = unit_allocate(unit, pieces->most_planned, sizeof(Output));
    pieces->key = unit_allocate(unit, KEY_NUMBERS + outside_count(c) + one_piece_phase_doubles(c) + c->state_count,
                                sizeof(double));
    pieces->before = unit_allocate(unit, c->state_count, sizeof(double));
    pieces->stop_forces = unit_allocate(unit, 2 * (size_t)sizes->stops, sizeof(ForceSeries));
    return !pieces->planned_outputs || !pieces->plan || !pieces->looked_at || !pieces->places || !pieces->waves || !pieces->key || !pieces->before ||
           !pieces->stop_forces ||
           machine_allocate(unit, &pieces->step, stations, weights, tracks, lobes) ||
           machine_allocate_beside(unit, &pieces->step, weights, tracks) ||
           machine_allocate(unit, &pieces->instant, stations, weights, tracks, lobes) ||
           (rings && machine_allocate_rings(unit, &pieces->step, rings, tracks)) ||
           (rings && machine_allocate_rings(unit, &pieces->instant, rings, tracks)) ||
           collocation_allocate(unit, &pieces->collocation, stations, weights) || one_piece_allocate_phases(unit) ||
           allocate_restraints(unit);
}

/* -- stiff ones ----------------------------------------------------------------------------------- */

/* Numbers of a bearing that changes with the speed; none: of what it does not have. */
enum { NO_NUMBER = -1, K_XX, K_XY, K_YX, K_YY, C_XX, C_XY, C_YX, C_YY };

/* Add what the bearings that change with the speed have of one of their numbers in a row of the table. */
static void add_of_table(const LinearRotor *rotor, int number, int table_row, double *matrix)
{
    const Bearings *tables = &rotor->bearings;
    const int n = rotor->stations;
    int b, i, j;
    for (b = 0; b < tables->count && number >= 0; b++) {
        const double *row = tables->rows + b * n;
        const double value = tables->values[(b * tables->speed_count + table_row) * BEARING_NUMBERS + number];
        for (i = 0; i < n; i++) {
            for (j = 0; j < n; j++) {
                matrix[i * n + j] += row[i] * value * row[j];
            }
        }
    }
}

/* Square root of the largest modulus of an eigenvalue of mass^-1 matrix, or that itself where it is no
   stiffness [1/s]; below 0 where the mass is singular.  With that number of bearings, in a row of their table. */
static double rate_of(const Composite *c, const double *matrix, int number, int table_row)
{
    const LinearRotor *rotor = &composite_rotor(c)->rotor;
    const int n = rotor->stations;
    const size_t square = (size_t)n * (size_t)n;
    double *mass = c->square, *found = mass + square, *work = found + square, radius;
    copy_doubles(square, rotor->mass, mass);
    copy_doubles(square, matrix, found);
    add_of_table(rotor, number, table_row, found);
    if (matrix_solve(1, n, n, mass, found)) {
        return -1.0;
    }
    radius = spectral_radius(n, found, work);
    return number >= K_XX && number <= K_YY ? square_root(radius) : radius;
}

/* About the fastest rate of rotor and weights [1/s], none of which the other slows down: whether collocation is
   worth a trial. */
static double fastest_of(const Composite *c)
{
    const LinearRotor *rotor = &composite_rotor(c)->rotor;
    const double *const matrices[BEARING_NUMBERS] = {
        rotor->stiffness_x, rotor->stiffness_xy, rotor->stiffness_yx, rotor->stiffness_y,
        rotor->damping_x,   rotor->damping_xy,   rotor->damping_yx,   rotor->damping_y};
    double fastest = rate_of(c, rotor->internal_damping, NO_NUMBER, 0);
    int k, w = 0;
    do { /* of every row of a table */
        for (k = 0; k < BEARING_NUMBERS; k++) {
            if (rotor->crossed || k == K_XX || k == K_YY || k == C_XX || k == C_YY) {
                fastest = larger(fastest, rate_of(c, matrices[k], k, w));
            }
        }
    } while (++w < rotor->bearings.speed_count);
    for (k = 1; k < c->parts_without_motor; k++) {
        const Balls *balls = part_balls(c->parts + k);
        for (w = 0; balls && w < balls->count; w++) {
            const Weights one = weights_single(&balls->track.weights, w);
            fastest = larger(fastest, weights_damping_rate(&one));
        }
    }
    return fastest;
}

/* -- the machine ----------------------------------------------------------------------------- */

static void make(const Composite *c, double rate, Machine *machine)
{
    const LinearRotor *rotor = &composite_rotor(c)->rotor;
    int k;
    machine_take_rotor(machine, rotor, rate);
    if (machine->restraints) {
        restraints_take(machine, composite_rotor(c)->cubics, composite_rotor(c)->stops);
    }
    for (k = 1; k < c->parts_without_motor; k++) {
        const Part *part = c->parts + k;
        const double *row = rotor->planes + part->plane * rotor->stations;
        const Balls *balls = part_balls(part);
        const RingUnit *ring = part_ring(part);
        if (balls) {
            machine_take_weights(machine, row, &balls->track);
        } else if (ring) {
            machine_take_ring(machine, row, &ring->ring);
        } else {
            machine_take_liquid(machine, row, part_added_mass(part));
        }
    }
    if (c->motor) {
        machine_take_motor(machine, c->motor->unit->own);
    }
    if (c->pieces.is_eventful) {
        one_piece_make_phase(c, machine);
    }
}

/* A weight swings as a pendulum of its race's radius; the shaft of a motor by its unbalance U as one of I/U. */
static double shortest_pendulum(const Composite *c, const Machine *m)
{
    double shortest = infinity(), moment = 0.0;
    int k;
    for (k = 1; k < c->parts_without_motor; k++) {
        const Balls *balls = part_balls(c->parts + k);
        shortest = balls ? smaller(shortest, balls->track.weights.track_radius) : shortest;
    }
    for (k = 0; k < m->stations && c->motor; k++) {
        moment += hypotenuse(pair_x(m->unbalance[k]), pair_y(m->unbalance[k]));
    }
    return moment > 0.0 ? smaller(shortest, m->drive.inertia / moment) : shortest;
}

int one_piece_make(Unit *unit)
{
    Composite *c = unit->own;
    Pieces *pieces = &c->pieces;
    if (composite_follow_changes(unit)) {
        return 1;
    }
    if (!pieces->is_made) {
        /* a power of two rounds nothing, so that it does not matter which */
        const double fastest = c->course->one_piece.fastest, rate = scaled_by_power(1.0, binary_exponent(fastest));
        pieces->is_eventful = one_piece_is_eventful(c);
        pieces->step.phase = pieces->is_eventful ? pieces->step_phase : NULL;
        pieces->instant.phase = pieces->is_eventful ? pieces->instant_phase : NULL;
        pieces->is_stiff = !pieces->is_eventful && !pieces->step.restraints && fastest_of(c) > STIFF_RATE * fastest;
        make(c, rate, &pieces->step);
        make(c, rate, &pieces->instant);
        pieces->shortest = shortest_pendulum(c, &pieces->step);
        pieces->is_made = true;
        pieces->times_made++;
        pieces->key[0] = not_a_number();
    }
    return 0;
}

/* -- the start ------------------------------------------------------------------------------- */

/* A displacement to judge errors by before there is any [m]: what unbalances would leave of a free rotor, or of
   one that supports hold, the start's, and the sag. */
static double first_displacement(const Composite *c)
{
    const Machine *m = &c->pieces.step;
    const int all = m->stations, n = all - m->waves; /* of the rotor */
    const double mass = sum_of(m->mass, all * all);
    const double speed = c->course->drive.fastest * m->per_rate;
    double moment = 0.0, largest = 0.0, softest = infinity();
    int k;
    for (k = 0; k < n; k++) {
        const Pair own = m->stiffness[k * all + k];
        softest = smaller(softest, smaller(pair_x(own), pair_y(own)));
        const Pair heavy = pair_scaled(m->gravity, mass);
        const double stiffness = larger(pair_x(m->stiffness[k * all + k]), mass);
        moment += hypotenuse(pair_x(m->unbalance[k]), pair_y(m->unbalance[k]));
        largest = larger(largest, hypotenuse(pair_x(heavy), pair_y(heavy)) / stiffness);
    }
    for (k = 0; k < m->weight_count; k++) {
        const struct SeriesRace *race = m->weights[k].race;
        moment = larger(moment, race ? race->mass * race->radius : m->weights[k].moment);
    }
    if (softest > mass * speed * speed) { /* supports hold it */
        moment *= mass * speed * speed / softest;
    }
    return larger(largest, moment / mass);
}

int one_piece_begin(Unit *unit)
{
    Composite *c = unit->own;
    OnePiece *one_piece = &c->course->one_piece;
    const double *place = c->parts->unit->memory + MOTION;
    const int n = composite_rotor(c)->stations;
    one_piece->fastest = c->course->drive.fastest;
    if (one_piece_make(unit)) {
        return 1;
    }
    c->pieces.is_begun = false;
    one_piece->stands = one_piece->placed = 1.0;
    one_piece->undecided = c->pieces.is_eventful;
    one_piece->line = -1.0;
    one_piece->bearing_line = 0.0;
    one_piece->largest = larger(first_displacement(c), largest_of(2 * n, place));
    if (!(one_piece->largest > 0.0)) {
        one_piece->largest = 1.0; /* nothing moves it */
    }
    return 0;
}
