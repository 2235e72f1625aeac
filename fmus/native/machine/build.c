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

void machine_take_rotor(Machine *machine, const LinearRotor *rotor, double rate)
{
    const int n = rotor->stations, square = n * n;
    const double t = 1.0 / rate;
    int k;
    machine->weight_count = machine->track_count = 0;
    machine->width = n;
    machine->unknowns = 2 * n;
    machine->drive.motor = NULL;
    machine->rate = rate;
    machine->per_rate = t;
    copy_doubles((size_t)square, rotor->mass, machine->mass);
    for (k = 0; k < square; k++) {
        const double inner = rotor->internal_damping[k] * t;
        machine->stiffness[k] = pair_scaled(pair_of(rotor->stiffness_x[k], rotor->stiffness_y[k]), t * t);
        machine->damping[k] = pair_scaled(pair_of(rotor->damping_x[k], rotor->damping_y[k]), t);
        machine->damping[k] = pair_sum(machine->damping[k], pair_both(inner));
        machine->internal_damping[k] = inner;
        machine->gyroscopic[k] = rotor->gyroscopic[k];
    }
    machine->crossed = rotor->crossed;
    for (k = 0; k < square && rotor->crossed; k++) {
        machine->cross_stiffness[k] = pair_scaled(pair_of(rotor->stiffness_xy[k], rotor->stiffness_yx[k]), t * t);
        machine->cross_damping[k] = pair_scaled(pair_of(rotor->damping_xy[k], rotor->damping_yx[k]), t);
    }
    machine->turns = any_of(rotor->internal_damping, square) || any_of(rotor->gyroscopic, square);
    for (k = 0; k < n; k++) {
        machine->unbalance[k] = pair_of(rotor->unbalance[2 * k], rotor->unbalance[2 * k + 1]);
    }
    machine->gravity = pair_scaled(pair_of(rotor->gravity[0], rotor->gravity[1]), t * t);
}

void machine_take_liquid(Machine *machine, const double *row, double mass)
{
    const int n = machine->stations;
    int i, j;
    for (i = 0; i < n; i++) {
        for (j = 0; j < n; j++) {
            machine->mass[i * n + j] += row[i] * (mass * row[j]);
        }
    }
}

static void take_weight(SeriesWeight *made, const Weights *one, double per_rate)
{
    const double radius = one->track_radius;
    made->moment = one->mass * radius;
    made->share = one->mass / one->kappa;
    made->lever = 1.0 / (one->kappa * radius);
    made->damping_rate = weights_damping_rate(one) * per_rate;
    made->roll = (one->kappa - 1.0) * (radius + one->radius);
    made->inertia = made->roll * one->mass * (radius + one->radius);
    made->torque = one->drag * radius * radius * per_rate;
}

void machine_take_weights(Machine *machine, const double *row, const Track *track)
{
    MachineTrack *made = machine->tracks + machine->track_count++;
    const int count = track->weights.count;
    int k;
    made->first = machine->weight_count;
    made->end = made->first + count;
    made->row = row;
    made->offset = pair_of(track->offset.re, track->offset.im);
    made->is_off = track->offset.re != 0.0 || track->offset.im != 0.0;
    made->mass = weights_added_mass(&track->weights);
    for (k = 0; k < count; k++) {
        const Weights one = weights_single(&track->weights, k);
        take_weight(machine->weights + made->first + k, &one, machine->per_rate);
    }
    machine->weight_count = made->end;
    machine->width = machine->stations + (made->end + 1) / 2;
    machine_take_liquid(machine, row, made->mass);
    for (k = 0; k < machine->stations && made->is_off; k++) {
        machine->unbalance[k] = pair_add_scaled(machine->unbalance[k], made->offset, row[k] * made->mass);
    }
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
            drive->inertia += machine->weights[j].inertia;
        }
    }
}
