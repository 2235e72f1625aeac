#include "weights/liquid_ring.h"

#include "base/elementary.h"

enum { RING_ORDER = 20 };
/* rad of the rotor in one series: the fastest wave then turns by less than 2.6 and leaves 1e-12 */
#define RING_TURN 0.75
enum { MOST_RING_SERIES = 100000 };

int ring_check(const LiquidRing *ring, Failure *failure)
{
    return ring->inner_radius < ring->wall_radius
               ? FINE
               : fail(failure, "inner_radius = %v m: must be smaller than wall_radius = %v m",
                      ring->inner_radius, ring->wall_radius);
}

double ring_hollow(const LiquidRing *ring)
{
    const double ratio = ring->inner_radius / ring->wall_radius;
    return ratio * ratio;
}

double ring_mass(const LiquidRing *ring)
{
    /* the factored difference of squares keeps its digits in a thin layer */
    const double area = PI * (ring->wall_radius - ring->inner_radius) * (ring->wall_radius + ring->inner_radius);
    return ring->density * area * ring->height;
}

double ring_added_mass(const LiquidRing *ring)
{
    return ring_mass(ring) / (1.0 + ring_hollow(ring));
}

double ring_root_damping(const LiquidRing *ring)
{
    const double f = ring_hollow(ring);
    const double slow = (2.0 - square_root(2.0 * (1.0 - f))) / (1.0 + f), apart = absolute(slow - 1.0);
    const double wall = square_root(2.0) * f * (slow * slow) / (ring->wall_radius * apart);
    return wall * square_root(ring->viscosity / apart);
}

double ring_thinness(const LiquidRing *ring, Complex wave)
{
    return (1.0 - ring_hollow(ring)) * hypotenuse(wave.re, wave.im) / (ring->wall_radius - ring->inner_radius);
}

/* (re + i im) z. */
static Complex ring_times(double re, double im, Complex z)
{
    return complex_product(complex_of(re, im), z);
}

static double ring_damping_at(const LiquidRing *ring, double speed)
{
    return ring->wave_damping + ring_root_damping(ring) * square_root(absolute(speed));
}

Complex ring_acceleration(const LiquidRing *ring, const RingState *state, const Instant *now)
{
    const double f = ring_hollow(ring), w = now->spin.speed, turn = now->spin.rates[0];
    const Complex damped = ring_times(ring_damping_at(ring, w), -2.0 * (1.0 - f) * w, state->rate);
    const Complex sprung = ring_times((1.0 - f) * (w * w), (1.0 + f) * turn, state->wave);
    const Complex sum = complex_sum(now->motion[0], complex_sum(damped, sprung));
    return complex_scaled(-1.0 / (1.0 + f), sum);
}

void ring_force(const LiquidRing *ring, const RingState *state, const Instant *now, Complex *force)
{
    const double w = now->spin.speed, w1 = now->spin.rates[0], d = ring_damping_at(ring, w);
    const double d1 = w != 0.0 ? 0.5 * (d - ring->wave_damping) * w1 / w : 0.0;
    const double factor = -ring_added_mass(ring) * ring_hollow(ring);
    const Complex second = ring_acceleration(ring, state, now);
    const Complex first = complex_sum(ring_times(-d, 4.0 * w, second), ring_times(-d1 - 2.0 * w * w, 4.0 * w1, state->rate));
    force[0] = complex_difference(ring_times(-d, 4.0 * w, state->rate), complex_scaled(2.0 * w * w, state->wave));
    force[1] = complex_difference(first, complex_scaled(4.0 * w * w1, state->wave));
    force[0] = complex_scaled(factor, force[0]);
    force[1] = complex_scaled(factor, force[1]);
}

/* Coefficients of the speed, which is a polynomial of order 4, its square, and d. */
typedef struct {
    double speed[RING_ORDER + 1], square[RING_ORDER + 1], damping[RING_ORDER + 1];
    int last; /* the highest that is not 0 of the speed */
} SpeedSeries;

static void ring_expand_speed(const LiquidRing *ring, const Spin *spin, SpeedSeries *series)
{
    const double root_damping = ring_root_damping(ring);
    const double way = spin->speed < 0.0 ? -1.0 : 1.0; /* the film is that of the speed either way */
    double *w = series->speed, root[RING_ORDER + 1], factorial = 1.0;
    int k, j;
    for (k = 0; k <= RING_ORDER; k++) {
        factorial *= k > 0 ? k : 1;
        w[k] = k == 0 ? spin->speed : k <= SIGNAL_ORDERS ? spin->rates[k - 1] / factorial : 0.0;
        series->last = k == 0 || w[k] != 0.0 ? k : series->last;
    }
    for (k = 0; k <= RING_ORDER; k++) {
        double sum = k <= SIGNAL_ORDERS ? way * w[k] : 0.0;
        series->square[k] = 0.0;
        for (j = 0; j <= k; j++) {
            series->square[k] += w[j] * w[k - j];
        }
        if (k == 0) {
            root[0] = square_root(absolute(w[0]));
        } else {
            for (j = 1; j < k; j++) {
                sum -= root[j] * root[k - j];
            }
            /* a rotor that begins to turn has no film yet */
            root[k] = w[0] != 0.0 ? 0.5 * sum / root[0] : 0.0;
        }
        series->damping[k] = root_damping * root[k] + (k == 0 ? ring->wave_damping : 0.0);
    }
}

/* One series over a length. */
static void ring_advance_once(const LiquidRing *ring, const CentreMotion *motion, double length, RingState *state)
{
    const double f = ring_hollow(ring);
    Complex y[RING_ORDER + 1], sum = state->wave, rate = state->rate;
    SpeedSeries speed;
    double power = length, factorial = 1.0;
    int k, j;
    ring_expand_speed(ring, &motion->spin, &speed);
    y[0] = state->wave;
    y[1] = state->rate;
    for (k = 0; k + 2 <= RING_ORDER; k++) {
        Complex right = {0.0, 0.0};
        factorial *= k > 0 ? k : 1;
        if (k < SIGNAL_ORDERS) {
            right = complex_scaled(1.0 / factorial, motion->signal[k]);
        }
        for (j = 0; j <= k; j++) {
            const Complex moved = complex_scaled(k - j + 1.0, y[k - j + 1]);
            const double turn = j < RING_ORDER ? (j + 1.0) * speed.speed[j + 1] : 0.0;
            right = complex_sum(right, ring_times(speed.damping[j], -2.0 * (1.0 - f) * speed.speed[j], moved));
            right = complex_sum(right, ring_times((1.0 - f) * speed.square[j], (1.0 + f) * turn, y[k - j]));
        }
        y[k + 2] = complex_scaled(-1.0 / ((1.0 + f) * (k + 1.0) * (k + 2.0)), right);
    }
    for (k = 1; k <= RING_ORDER; k++, power *= length) {
        sum = complex_sum(sum, complex_scaled(power, y[k]));
        if (k < RING_ORDER) {
            rate = complex_sum(rate, complex_scaled((k + 1.0) * power, y[k + 1]));
        }
    }
    state->wave = sum;
    state->rate = rate;
}

/* Rate that series of a length must resolve: of the rotor, or of the damping [1/s]. */
static double ring_fastest(const LiquidRing *ring, const Spin *spin, double length)
{
    const double end = spin_after(spin, length).speed, fastest = larger(absolute(spin->speed), absolute(end));
    const double damping = ring->wave_damping + ring_root_damping(ring) * square_root(fastest);
    return larger(fastest, 0.5 * damping + 1e-300);
}

bool ring_resolves(const LiquidRing *ring, const Spin *spin, double length)
{
    return ring_fastest(ring, spin, length) * length < RING_TURN * MOST_RING_SERIES;
}

/* A longest length for one series: by the turn of the rotor and, as the root of a rising speed has no series at
   rest, by the time since then, down to the least length: a rotor that comes to rest has no last series. */
static double ring_longest(const LiquidRing *ring, const Spin *spin, double length, double least)
{
    double part = smaller(length, RING_TURN / ring_fastest(ring, spin, length));
    if (ring->viscosity > 0.0 && spin->rates[0] != 0.0 && spin->speed != 0.0) {
        part = smaller(part, 0.25 * absolute(spin->speed) / absolute(spin->rates[0]));
    }
    return larger(part, least);
}

void ring_advance(const LiquidRing *ring, const CentreMotion *motion, double length, RingState *state)
{
    double done = 0.0;
    while (done < length) {
        CentreMotion here = *motion;
        double part;
        int k;
        here.spin = spin_after(&motion->spin, done);
        for (k = SIGNAL_ORDERS - 2; k >= 0; k--) { /* derivatives of the cubic at this time */
            int j;
            double power = 1.0;
            for (j = k + 1; j < SIGNAL_ORDERS; j++) {
                power *= done / (j - k);
                here.signal[k] = complex_sum(here.signal[k], complex_scaled(power, motion->signal[j]));
            }
        }
        part = ring_longest(ring, &here.spin, length - done, length / MOST_RING_SERIES);
        if (done + part >= length || part <= 0.0) {
            part = length - done;
        }
        ring_advance_once(ring, &here, part, state);
        done = part == length - done ? length : done + part;
    }
}
