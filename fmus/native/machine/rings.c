#include "machine/rings.h"

#include "base/elementary.h"

#define LEAST_SPEED 1e-6 /* of about the fastest: below, the viscosity damps no wave */

enum { COEFFICIENTS_OF_RING = MOST_ORDER + 3 };

int machine_allocate_rings(Unit *unit, Machine *machine, int count, int tracks)
{
    int k, missing;
    machine->rings = unit_allocate(unit, (size_t)count, sizeof *machine->rings);
    machine->rows = unit_allocate(unit, (size_t)tracks * (size_t)machine->stations, sizeof(double));
    machine->root = unit_allocate(unit, COEFFICIENTS_OF_RING, sizeof(double));
    missing = !machine->rings || !machine->root || !machine->rows;
    machine->waves = count;
    for (k = 0; k < count && !missing; k++) {
        machine->rings[k].swept = unit_allocate(unit, COEFFICIENTS_OF_RING, sizeof(Pair));
        machine->rings[k].slid = unit_allocate(unit, COEFFICIENTS_OF_RING, sizeof(Pair));
        missing = !machine->rings[k].swept || !machine->rings[k].slid;
    }
    return missing;
}

void machine_take_ring(Machine *machine, const double *row, const LiquidRing *ring)
{
    const int n = machine->stations, own = n - machine->waves, at = own + machine->ring_count;
    const double mass = ring_mass(ring), f = ring_hollow(ring), inertia = mass * f;
    struct MachineRing *made = machine->rings + machine->ring_count++;
    int i;
    machine_take_liquid(machine, row, mass);
    for (i = 0; i < own; i++) {
        machine->mass[at * n + i] = machine->mass[i * n + at] = inertia * row[i];
    }
    machine->mass[at * n + at] = inertia * (1.0 + f);
    made->station = at;
    made->inertia = inertia;
    made->damping = ring->wave_damping * machine->per_rate;
    made->root = ring_root_damping(ring) * square_root(machine->per_rate);
}

void rings_expand_root(Machine *m, int order)
{
    const double *w = m->speed, way = w[0] < 0.0 ? -1.0 : 1.0; /* the film is that of the speed either way */
    double *root = m->root;
    int k, j;
    root[0] = absolute(w[0]) > LEAST_SPEED || m->speed_order == 0 ? square_root(absolute(w[0])) : 0.0;
    for (k = 1; k <= order; k++) {
        double sum = k <= m->speed_order ? way * w[k] : 0.0;
        for (j = 1; j < k; j++) {
            sum -= root[j] * root[k - j];
        }
        root[k] = root[0] > 0.0 && m->speed_order > 0 ? 0.5 * sum / root[0] : 0.0;
    }
}

Pair rings_push(Machine *m, int station, int k)
{
    struct MachineRing *ring = m->rings + (station - (m->stations - m->waves));
    const int width = m->width, last = m->speed_order > 0 ? k : 0;
    const Pair rate = m->velocity[k * width + station];
    Pair sum, dragged = pair_zero();
    int j;
    ring->swept[k] = machine_times_speed(m, m->motion + station, width, k);
    ring->slid[k] = pair_difference(rate, pair_turned(ring->swept[k]));
    sum = pair_scaled(pair_turned(machine_times_speed(m, m->velocity + station, width, k)), 4.0);
    sum = pair_add_scaled(sum, machine_times_speed(m, ring->swept, 1, k), 2.0);
    dragged = pair_scaled(ring->slid[k], ring->damping);
    for (j = 0; j <= last && ring->root > 0.0; j++) {
        dragged = pair_add_scaled(dragged, ring->slid[k - j], ring->root * m->root[j]);
    }
    return pair_scaled(pair_difference(sum, dragged), ring->inertia);
}

bool machine_is_wave(const Machine *m, int station)
{
    return station >= m->stations - m->waves;
}

double rings_length(const Machine *m, double length)
{
    const double speed = absolute(m->speed[0]), change = absolute(m->speed[1]);
    double root = 0.0;
    int k;
    for (k = 0; k < m->ring_count; k++) {
        root = larger(root, m->rings[k].root);
    }
    if (root == 0.0 || change == 0.0) {
        return length;
    }
    return smaller(length, (speed <= LEAST_SPEED ? 2.0 * LEAST_SPEED : 0.5 * speed) / change);
}
