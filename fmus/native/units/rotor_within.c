/* The rotor at a time within a step: e^{Zt} times the state alone, by its Taylor series, where a step
   matrix for every such time would cost a hundred times as much. */
#include <string.h>

#include "base/elementary.h"
#include "rotor/propagator.h"
#include "units/rotor.h"

/* A mode may turn so far in a piece [rad]: beyond, terms cancel, and a matrix keeps more digits. */
static const double SOFT = 3.0;
static const double NEGLIGIBLE = 1e-16; /* of the sum: a term, and the one before */
enum { MOST_TERMS = 60, MOST_PIECES = 12 }; /* more cost as much as a matrix */

size_t rotor_rates_doubles(int n, int p, int orders)
{
    /* rows of v' are full, a force turns and goes on to its derivative */
    const size_t motion = 4 * (size_t)n, forces = 2 * (size_t)orders * (size_t)p;
    return motion / 2 * (motion + forces + 2) + motion / 2 + 2 * forces + 2;
}

/* The elements of Z that are not 0, row by row, x and y alternating. */
static void sort_rates(Rotor *own, const double *z)
{
    Rates *rates = &own->rates;
    const int size = own->columns * own->parts, width = own->columns;
    int i, j, count = 0;
    rates->size = size;
    for (i = 0; i < size; i++) {
        rates->first[i] = count;
        for (j = 0; j < size; j++) {
            const double *element = z + 2 * ((i / 2) * width + j / 2);
            const double value = own->axes == 2
                                     ? z[rotor_column(own, i) * width + rotor_column(own, j)]
                                 : i % 2 == j % 2 ? element[0]
                                 : i % 2          ? element[1]
                                                  : -element[1];
            if (value != 0.0) {
                rates->column[count] = j;
                rates->value[count++] = value;
            }
        }
    }
    rates->first[size] = count;
}

/* Fastest that a state can change by itself [rad/s], at most. */
static double quickest(const Rotor *own)
{
    const Rates *rates = &own->rates;
    const int displacements = 2 * own->stations;
    double stiffest = 0.0, slowing = 0.0;
    int i, k;
    for (i = displacements; i < 2 * displacements; i++) {
        double stiffness = 0.0, damping = 0.0;
        for (k = rates->first[i]; k < rates->first[i + 1]; k++) {
            if (rates->column[k] < displacements) {
                stiffness += absolute(rates->value[k]);
            } else if (rates->column[k] < 2 * displacements) {
                damping += absolute(rates->value[k]);
            }
        }
        stiffest = larger(stiffest, stiffness);
        slowing = larger(slowing, damping);
    }
    return larger(square_root(stiffest), slowing);
}

int rotor_rates(Unit *unit)
{
    Rotor *own = unit->own;
    Rates *rates = &own->rates;
    const double speed = rotor_drive(unit)[0];
    double *z = own->matrix_scratch;
    LinearRotor loaded;
    Failure failure;
    if (rotor_is_of(unit, &rates->of, speed)) {
        return 0;
    }
    loaded = rotor_anew(unit, &rates->of);
    if (generator(&loaded, speed, own->turning, own->orders, z,
                  z + (size_t)own->columns * (size_t)(own->columns * own->parts), &failure)) {
        return unit_failed(unit, &failure, NULL, 0);
    }
    sort_rates(own, z);
    rates->quickest = quickest(own);
    rotor_made(unit, &rates->of, speed);
    return 0;
}

/* Z times a state (size,) times `factor`, its elements from `first` up to `end`. */
static void changes(const Rates *rates, int first, int end, const double *state, double factor,
                    double *change)
{
    int i, k;
    for (i = first; i < end; i++) {
        double sum = 0.0;
        for (k = rates->first[i]; k < rates->first[i + 1]; k++) {
            sum += rates->value[k] * state[rates->column[k]];
        }
        change[i] = factor * sum;
    }
}

/* Whether a term no longer counts beside its sum, in displacements and in velocities. */
static int vanishes(int count, const double *term, const double *sum)
{
    double small = 0.0, large = 0.0;
    int k;
    for (k = 0; k < count; k++) {
        small = larger(small, absolute(term[k]));
        large = larger(large, absolute(sum[k]));
    }
    return small <= NEGLIGIBLE * large;
}

/* A state (size,), `time` on; 0 where the series does not end.  `term` and `next`: (size,) each. */
static int advance_series(const Rates *rates, int half, double time, double *sum, double *term, double *next)
{
    const int size = rates->size;
    int k, i, small = 0;
    memcpy(term, sum, (size_t)size * sizeof(double));
    for (k = 1; k < MOST_TERMS && !small; k += 2) {
        changes(rates, 0, size, term, time / k, next);
        changes(rates, 0, size, next, time / (k + 1), term);
        for (i = 0; i < size; i++) {
            sum[i] += next[i];
            sum[i] += term[i];
        }
        /* one term alone may be 0 before the last */
        small = vanishes(half, term, sum) && vanishes(half, next, sum) &&
                vanishes(half, term + half, sum + half) && vanishes(half, next + half, sum + half);
    }
    return small;
}

int rotor_within(Rotor *own, double time)
{
    const Rates *rates = &own->rates;
    const int half = 2 * own->stations, planes = 2 * own->planes, size = rates->size;
    /* of the acceleration's derivatives the last one asks for velocities alone */
    const int quintic = own->orders == QUINTIC_ORDERS;
    const int first = quintic ? 0 : half, end = quintic ? size : 2 * half;
    double *sum = own->operand, *term = rates->work, *next = term + size;
    double *out = own->result + 2 * half;
    const double turned = rates->quickest * time;
    const int pieces = turned <= MOST_PIECES * SOFT ? 1 + (int)(turned / SOFT) : 0;
    int k;
    if (!pieces) {
        return 0;
    }
    for (k = 0; k < pieces; k++) {
        if (!advance_series(rates, half, time / pieces, sum, term, next)) {
            return 0;
        }
    }
    changes(rates, 0, size, sum, 1.0, term);
    changes(rates, first, end, term, 1.0, next);
    memcpy(own->result, sum, 2 * (size_t)half * sizeof(double));
    rotor_vectors_at(own->rotor.planes, own->planes, own->stations, term + half, out);
    rotor_vectors_at(own->rotor.planes, own->planes, own->stations, next + half, out + planes);
    if (quintic) {
        changes(rates, half, 2 * half, next, 1.0, term);
        rotor_vectors_at(own->rotor.planes, own->planes, own->stations, term + half,
                         out + 2 * planes);
    }
    return 1;
}
