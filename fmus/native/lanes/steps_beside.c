/* Steps of machines that stay in their lanes: their lengths, the motion at times in them, and their ends.  A part of the
   text of lanes.c. */
#include <string.h>

#include "base/pair.h"
#include "lanes/lane_machine.h"

static inline Number larger_of(Number a, Number b)
{
    return __builtin_elementwise_max(a, b);
}

static void to_lanes(const double *from, Number *to)
{
    memcpy(to, from, sizeof *to);
}

static void from_lanes(Number from, double *to)
{
    memcpy(to, &from, sizeof from);
}

static void expand_on(Lanes *lanes, const double *angles, const double *speeds, int order)
{
    Number angle;
    to_lanes(angles, &angle);
    to_lanes(speeds, lanes->machine.speed);
    machine_expand(&lanes->machine, angle, order);
}

/* The same sums as those of `terms_of` in machine/pace.c. */
static void find_terms(const Lanes *lanes, int k, const double *largest, Terms *terms)
{
    const Machine *m = &lanes->machine;
    const Pair *motion = m->motion + k * m->width;
    Number of_rotor = number_of(0.0), of_weights = of_rotor, finite = of_rotor, per_largest;
    int i, lane;
    to_lanes(largest, &per_largest);
    per_largest = 1.0 / per_largest;
    for (i = 0; i < m->width; i++) {
        const Number x = number_size(motion[i].x), y = number_size(motion[i].y);
        if (i < m->stations) {
            of_rotor = larger_of(of_rotor, per_largest * larger_of(x, y));
        } else {
            of_weights = larger_of(of_weights, larger_of(x, y));
        }
        finite += 0.0 * x + 0.0 * y;
    }
    of_rotor += finite;
    of_weights += finite;
    for (lane = 0; lane < LANES; lane++) {
        terms[lane].rotor = of_rotor[lane];
        terms[lane].weights = of_weights[lane];
    }
}

/* The sum of a series, whose coefficients stand `stride` apart, up to an order at a time: of numbers, and of pairs. */
#define SUM sum_of_series
#define Sum Number
#define Time Number
#define Coefficient Number
#define AT(at) (*(at))
#define PLUS(a, b) ((a) + (b))
#define TIMES(a, time) ((a) * (time))
#include "base/series_sum_template.h"

#define SUM sum_of_pairs
#define Sum Pair
#define Time Number
#define Coefficient Pair
#define AT(at) (*(at))
#define PLUS(a, b) pair_sum(a, b)
#define TIMES(a, time) pair_scaled(a, time)
#include "base/series_sum_template.h"

static void read_place(const Lanes *lanes, int column, int number, int order, const double *times, double *places)
{
    const Machine *m = &lanes->machine;
    const Number *series = (const Number *)(m->motion + column) + number;
    Number time;
    to_lanes(times, &time);
    from_lanes(sum_of_series(series, 2 * m->width, order, time), places);
}

static void go_to_end(Lanes *lanes, int order, const double *times, const double *rates, double *places, double *speeds)
{
    Machine *m = &lanes->machine;
    Number time, rate, place = number_of(0.0), speed = place;
    int i;
    to_lanes(times, &time);
    to_lanes(rates, &rate);
    for (i = 0; i < m->width; i++) {
        const Pair q = sum_of_pairs(m->motion + i, m->width, order, time);
        const Pair v = pair_scaled(sum_of_pairs(m->velocity + i, m->width, order - 1, time), rate);
        m->motion[i] = q;
        m->velocity[i] = pair_scaled(v, 1.0 / rate);
        if (i < m->stations) {
            place = larger_of(place, larger_of(number_size(q.x), number_size(q.y)));
            speed = larger_of(speed, larger_of(number_size(v.x), number_size(v.y))) + (0.0 * v.x + 0.0 * v.y);
        }
    }
    from_lanes(place, places);
    from_lanes(speed, speeds);
}

static void take_out(const Lanes *lanes, int lane, double *motion, double *velocity)
{
    const Machine *m = &lanes->machine;
    const double *q = (const double *)m->motion + lane, *v = (const double *)m->velocity + lane;
    int k;
    for (k = 0; k < 2 * m->width; k++, q += LANES, v += LANES) {
        motion[k] = *q;
        velocity[k] = *v;
    }
}
