/* The matrix of the unknowns, less what the weights take with them, and what solves with it. */
#include "machine/machine.h"
#ifndef SIDE_BY_SIDE
#include "machine/phase.h"
#endif

/* Take off M and I, of so many stations and unknowns, what the weights take with them. */
static IN_LINE void take_off(Machine *m, int stations, int size)
{
    Number *a = m->matrix, *coupled = m->right; /* which is free until there is a right-hand side */
    int i, j, t, w;
    for (t = 0; t < m->track_count; t++) {
        const MachineTrack *track = m->tracks + t;
        for (w = track->first; w < track->end; w++) {
            const SeriesWeight *weight = m->weights + w;
            for (i = 0; i < stations; i++) {
                const Pair pushed = machine_coupled_station(track, weight, i);
                coupled[2 * i] = pair_x(pushed);
                coupled[2 * i + 1] = pair_y(pushed);
            }
            if (size > 2 * stations) {
                coupled[size - 1] = machine_coupled_shaft(m, track, weight);
            }
            for (i = 0; i < size; i++) {
                const Number scaled = weight->share * coupled[i];
                for (j = 0; j <= i; j++) {
                    a[i * size + j] -= scaled * coupled[j];
                }
            }
        }
    }
}

IN_LINE void machine_factorise_planar(Machine *m)
{
    Number *a = m->matrix, over, xx;
    take_off(m, 1, 2);
    over = 1.0 / (a[0] * a[3] - a[2] * a[2]);
    xx = a[0];
    a[0] = a[3] * over;
    a[3] = xx * over;
    a[1] = a[2] = -a[2] * over;
}

static void take_off_weights(Machine *m)
{
#if defined(HAS_COPIES) && !defined(SIDE_BY_SIDE)
    if (m->unknowns == 4) { /* whose loops are unrolled */
        take_off(m, 2, 4);
        return;
    }
#endif
    take_off(m, m->stations, m->unknowns);
}

/* Whether the matrix is inverted: numbers of a product do not wait for each other, as those of a solution by factors. */
static bool is_inverted(int size)
{
    return size <= FEW_UNKNOWNS && size % 2 == 0;
}

/* Cholesky's factor, with one over its diagonal. */
static IN_LINE void decompose(int size, Number *a)
{
    int i, j, k;
    for (j = 0; j < size; j++) {
        for (i = j; i < size; i++) {
            Number sum = a[i * size + j];
            for (k = 0; k < j; k++) {
                sum -= a[i * size + k] * a[j * size + k];
            }
            a[i * size + j] = i == j ? 1.0 / number_root(sum) : sum * a[j * size + j];
        }
    }
}

/* The inverse in place of that factor: first the factor's own. */
static IN_LINE void invert(int size, Number *a)
{
    int i, j, k;
    for (j = 0; j < size; j++) {
        for (i = j + 1; i < size; i++) {
            Number sum = number_of(0.0);
            for (k = j; k < i; k++) {
                sum -= a[i * size + k] * a[k * size + j];
            }
            a[i * size + j] = sum * a[i * size + i];
        }
    }
    for (i = 0; i < size; i++) {
        for (j = 0; j <= i; j++) {
            Number sum = a[i * size + i] * a[i * size + j];
            for (k = i + 1; k < size; k++) {
                sum += a[k * size + i] * a[k * size + j];
            }
            a[i * size + j] = a[j * size + i] = sum;
        }
    }
}

void machine_factorise(Machine *m)
{
    const int size = m->unknowns;
    Number *a = m->matrix;
    if (size == 2) {
        machine_factorise_planar(m);
        return;
    }
    take_off_weights(m);
#if defined(HAS_COPIES) && !defined(SIDE_BY_SIDE)
    switch (size) {
    case 4:
        decompose(4, a);
        invert(4, a);
        return;
    case 6:
        decompose(6, a);
        invert(6, a);
        return;
    }
#endif
    decompose(size, a);
    if (is_inverted(size)) {
        invert(size, a);
    }
}

/* By the inverse, two rows at once. */
static IN_LINE void multiply_pairs(int size, const Number *a, Number *b)
{
    Pair found[FEW_UNKNOWNS / 2];
    int i, k;
    for (i = 0; i < size / 2; i++) {
        found[i] = pair_scaled(pair_of(a[2 * i], a[2 * i + 1]), b[0]);
        for (k = 1; k < size; k++) {
            found[i] = pair_add_scaled(found[i], pair_of(a[k * size + 2 * i], a[k * size + 2 * i + 1]), b[k]);
        }
    }
    for (i = 0; i < size / 2; i++) {
        b[2 * i] = pair_x(found[i]);
        b[2 * i + 1] = pair_y(found[i]);
    }
}

IN_LINE void machine_solve_factors(const Machine *m, Number *b)
{
    const int size = m->unknowns;
    const Number *a = m->matrix;
    int i, k;
    if (is_inverted(size)) {
        multiply_pairs(size, a, b);
        return;
    }
    for (i = 0; i < size; i++) {
        Number sum = b[i];
        for (k = 0; k < i; k++) {
            sum -= a[i * size + k] * b[k];
        }
        b[i] = sum * a[i * size + i];
    }
    for (i = size - 1; i >= 0; i--) {
        Number sum = b[i];
        for (k = i + 1; k < size; k++) {
            sum -= a[k * size + i] * b[k];
        }
        b[i] = sum * a[i * size + i];
    }
}

void machine_solve(const Machine *m, Number *b)
{
#ifndef SIDE_BY_SIDE
    if (m->phase) {
        phase_solve(m, b);
        return;
    }
#endif
    machine_solve_factors(m, b);
}
