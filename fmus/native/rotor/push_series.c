#include "rotor/push_series.h"

#include "base/cubic.h"
#include "base/elementary.h"

SpinSeries spin_series(const Spin *start, double t, double h)
{
    const Spin now = spin_after(start, t);
    SpinSeries found;
    double power = 1.0;
    int k;
    found.angle = now.angle;
    found.speed[0] = now.speed;
    for (k = 0; k < SPIN_TERMS; k++) {
        found.spin_up[k] = power * now.rates[k];
        power *= h / (k + 1);
        found.speed[k + 1] = power * now.rates[k];
    }
    return found;
}

/* Coefficients of e^{i beta}. */
static void fill_turn(const SpinSeries *spin, double h, int terms, double *turn)
{
    const Complex first = rect(1.0, spin->angle);
    int k, j;
    turn[0] = first.re;
    turn[1] = first.im;
    for (k = 0; k < terms; k++, turn += 2) {
        const double factor = h / (k + 1);
        double re = 0.0, im = 0.0;
        for (j = 0; j < SPEED_TERMS && j <= k; j++) {
            re += spin->speed[j] * turn[-2 * j];
            im += spin->speed[j] * turn[1 - 2 * j];
        }
        turn[2] = -factor * im;
        turn[3] = factor * re;
    }
}

/* Coefficient of w^2 - i w'. */
static Complex pull_of(const SpinSeries *spin, int k)
{
    double square = 0.0;
    int j;
    for (j = 0; j <= k; j++) {
        square += j < SPEED_TERMS && k - j < SPEED_TERMS ? spin->speed[j] * spin->speed[k - j] : 0.0;
    }
    return complex_of(square, k < SPIN_TERMS ? -spin->spin_up[k] : 0.0);
}

/* Coefficients of a force from its derivatives, which stand `stride` doubles apart. */
static void shift_force(const double *force, int stride, double t, double h, Complex *coefficients)
{
    double power = 1.0;
    int k, j;
    for (k = 0; k < SIGNAL_ORDERS; k++, power *= h / k) {
        double re = 0.0, im = 0.0;
        for (j = SIGNAL_ORDERS - 1; j >= k; j--) {
            const double factor = t / (j - k + 1);
            re = force[j * stride] + factor * re;
            im = force[j * stride + 1] + factor * im;
        }
        coefficients[k] = complex_of(power * re, power * im);
    }
}

/* Add coefficients of e^{i beta} times a complex factor and the power m. */
static void add_turned(const double *turn, int terms, int m, int stride, Complex factor, double *to)
{
    int k;
    for (k = m; k <= terms; k++, turn += 2) {
        to[k * stride] += turn[0] * factor.re - turn[1] * factor.im;
        to[k * stride + 1] += turn[0] * factor.im + turn[1] * factor.re;
    }
}

void fill_pushes(const Excitation *excitation, const SpinSeries *spin, double t, double h,
                 int terms, double *pushes, int stride, double *turn)
{
    const int p = excitation->planes;
    int i, k, m;
    fill_turn(spin, h, terms, turn);
    for (k = 0; k <= terms; k++) {
        for (i = 0; i < 2 * p + 2; i++) {
            pushes[k * stride + i] = 0.0;
        }
    }
    for (i = 0; i < p; i++) {
        Complex force[SIGNAL_ORDERS];
        shift_force(excitation->forces + 2 * i, 2 * p, t, h, force);
        for (m = 0; m < SIGNAL_ORDERS && m <= terms; m++) {
            if (excitation->turning_force) {
                add_turned(turn, terms, m, stride, force[m], pushes + 2 * i);
            } else {
                pushes[m * stride + 2 * i] = force[m].re;
                pushes[m * stride + 2 * i + 1] = force[m].im;
            }
        }
    }
    for (m = 0; m < 2 * SPEED_TERMS - 1 && m <= terms; m++) {
        add_turned(turn, terms, m, stride, pull_of(spin, m), pushes + 2 * p);
    }
}
