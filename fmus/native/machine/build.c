/* A machine from its parts: matrices in its unit of time, added masses, the unbalance of offset tracks. */
#include "base/elementary.h"
#include "base/matrix.h"
#include "machine/machine.h"

static int any_of(const double *values, int count)
{
    int k, found = 0;
    for (k = 0; k < count; k++) {
        found |= values[k] != 0.0;
    }
    return found;
}

/* What supports and shaft pull and damp. */
static void take_supports(Machine *machine, const LinearRotor *rotor)
{
    const int own = rotor->stations, apart = machine->stations - own; /* waves stand behind them */
    const double t = machine->per_rate;
    int k;
    for (k = 0; k < own * own; k++) {
        const int to = k + k / own * apart;
        machine->stiffness[to] = pair_scaled(pair_of(rotor->stiffness_x[k], rotor->stiffness_y[k]), t * t);
        machine->damping[to] = pair_scaled(pair_of(rotor->damping_x[k], rotor->damping_y[k]), t);
        machine->damping[to] = pair_sum(machine->damping[to], pair_both(rotor->internal_damping[k] * t));
    }
    for (k = 0; k < own * own && rotor->crossed; k++) {
        const int to = k + k / own * apart;
        machine->cross_stiffness[to] = pair_scaled(pair_of(rotor->stiffness_xy[k], rotor->stiffness_yx[k]), t * t);
        machine->cross_damping[to] = pair_scaled(pair_of(rotor->damping_xy[k], rotor->damping_yx[k]), t);
    }
}

/* Add of a bearing's numbers in this order to matrices: along the axes, and across. */
static void add_bearing(int own, int n, const double *row, const double *four, double scale, Pair *along, Pair *across)
{
    int i, j;
    for (i = 0; i < own; i++) {
        for (j = 0; j < own; j++) {
            const double share = row[i] * row[j] * scale;
            along[i * n + j] = pair_sum(along[i * n + j], pair_of(share * four[0], share * four[3]));
            across[i * n + j] = pair_sum(across[i * n + j], pair_of(share * four[1], share * four[2]));
        }
    }
}

void machine_take_bearings(Machine *machine, const LinearRotor *rotor, int line)
{
    enum { DAMPING = BEARING_NUMBERS / 2 };
    const int own = rotor->stations, n = machine->stations;
    const double t = machine->per_rate;
    double still[BEARING_NUMBERS], slope[BEARING_NUMBERS];
    int b, k;
    if (!machine->varies || machine->bearing_line == line) {
        return;
    }
    take_supports(machine, rotor);
    for (k = 0; k < n * n; k++) {
        machine->stiffness_slope[k] = machine->damping_slope[k] = pair_zero();
        machine->cross_stiffness_slope[k] = machine->cross_damping_slope[k] = pair_zero();
    }
    for (b = 0; b < rotor->bearings.count; b++) {
        const double *row = rotor->bearings.rows + b * own;
        linear_rotor_bearing(rotor, b, line, still, slope);
        add_bearing(own, n, row, still, t * t, machine->stiffness, machine->cross_stiffness);
        add_bearing(own, n, row, still + DAMPING, t, machine->damping, machine->cross_damping);
        add_bearing(own, n, row, slope, t, machine->stiffness_slope, machine->cross_stiffness_slope);
        add_bearing(own, n, row, slope + DAMPING, 1.0, machine->damping_slope, machine->cross_damping_slope);
    }
    machine->bearing_line = line;
}

void machine_take_rotor(Machine *machine, const LinearRotor *rotor, double rate)
{
    const int n = machine->stations, own = rotor->stations;
    const double t = 1.0 / rate;
    int k;
    machine->weight_count = machine->track_count = machine->ring_count = 0;
    machine->width = n;
    machine->unknowns = 2 * n;
    machine->drive.motor = NULL;
    machine->rate = rate;
    machine->per_rate = t;
    for (k = 0; k < n * n && n > own; k++) { /* of waves nothing but what their rings set */
        machine->mass[k] = machine->internal_damping[k] = machine->gyroscopic[k] = 0.0;
        machine->stiffness[k] = machine->damping[k] = pair_zero();
        machine->cross_stiffness[k] = machine->cross_damping[k] = pair_zero();
    }
    take_supports(machine, rotor);
    for (k = 0; k < own * own; k++) {
        const int to = k + k / own * (n - own);
        machine->mass[to] = rotor->mass[k];
        machine->internal_damping[to] = rotor->internal_damping[k] * t;
        machine->gyroscopic[to] = rotor->gyroscopic[k];
    }
    machine->crossed = rotor->crossed;
    machine->varies = rotor->bearings.count > 0;
    machine->bearing_line = -1;
    machine->turns = any_of(rotor->internal_damping, own * own) || any_of(rotor->gyroscopic, own * own);
    for (k = 0; k < n; k++) {
        machine->unbalance[k] = k < own ? pair_of(rotor->unbalance[2 * k], rotor->unbalance[2 * k + 1]) : pair_zero();
    }
    machine->gravity = pair_scaled(pair_of(rotor->gravity[0], rotor->gravity[1]), t * t);
}

void machine_take_liquid(Machine *machine, const double *row, double mass)
{
    const int n = machine->stations, own = n - machine->waves;
    int i, j;
    for (i = 0; i < own; i++) {
        for (j = 0; j < own; j++) {
            machine->mass[i * n + j] += row[i] * (mass * row[j]);
        }
    }
}

void machine_take_weights(Machine *machine, const double *row, const Track *track)
{
    MachineTrack *made = machine->tracks + machine->track_count++;
    const int count = track->weights.count, own = machine->stations - machine->waves;
    int k;
    if (machine->waves) {
        double *wide = machine->rows + (size_t)(made - machine->tracks) * machine->stations;
        copy_doubles((size_t)own, row, wide);
        row = wide; /* the others are 0 */
    }
    made->first = machine->weight_count;
    made->end = made->first + count;
    made->row = row;
    made->offset = pair_of(track->offset.re, track->offset.im);
    made->is_off = track->offset.re != 0.0 || track->offset.im != 0.0;
    made->lobes = track->weights.lobes;
    copy_doubles(LOBE_NUMBERS * (size_t)made->lobes, track->weights.lobe, made->lobe);
    made->mass = weights_added_mass(&track->weights);
    for (k = 0; k < count; k++) {
        const Weights one = weights_single(&track->weights, k);
        SeriesWeight *weight = machine->weights + made->first + k;
        series_weight_take(weight, &one, machine->per_rate);
        weight->race = made->lobes ? machine->races[made->first + k] : NULL;
        if (weight->race) {
            series_race_take(weight, &one, made->lobe, machine->per_rate);
        }
    }
    machine->weight_count = made->end;
    machine->from_rotor &= !made->lobes;
    machine->width = machine->stations + (made->end + 1) / 2;
    machine_take_liquid(machine, row, made->mass);
    for (k = 0; k < own && made->is_off; k++) {
        machine->unbalance[k] = pair_add_scaled(machine->unbalance[k], made->offset, row[k] * made->mass);
    }
}

void machine_take_carried(Machine *machine, Carried *carried, double rate)
{
    machine->weight_count = machine->track_count = machine->ring_count = 0;
    machine->width = machine->stations;
    machine->unknowns = 2 * machine->stations;
    machine->rate = rate;
    machine->per_rate = 1.0 / rate;
    machine->drive.motor = NULL;
    machine->crossed = machine->varies = false;
    machine->turns = 0;
    machine->mass[0] = 0.0;
    machine->unbalance[0] = machine->gravity = pair_zero();
    machine->carried = carried;
    machine->from_rotor = true;
}

void machine_take_mobility(Machine *machine, double mobility)
{
    machine->mass[0] = mobility > 0.0 ? 1.0 / mobility : 0.0;
}

void machine_take_motor(Machine *machine, const Motor *motor)
{
    MachineDrive *drive = &machine->drive;
    int k, j;
    drive->motor = motor;
    drive->inertia = motor->inertia;
    machine->unknowns = 2 * machine->stations + 1;
    for (k = 0; k < machine->track_count; k++) {
        const MachineTrack *track = machine->tracks + k;
        const Pair offset = track->offset;
        drive->inertia += track->mass * (pair_x(offset) * pair_x(offset) + pair_y(offset) * pair_y(offset));
        for (j = track->first; j < track->end; j++) {
            drive->inertia += machine->weights[j].race ? 0.0 : machine->weights[j].inertia;
        }
    }
}
