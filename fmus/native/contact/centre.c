#include "contact/centre.h"

#include "base/cubic.h"
#include "base/spin.h"

Instant instant(const CentreMotion *motion, double time)
{
    Instant now;
    now.acceleration = cubic_value(motion->signal, time);
    now.slope = cubic_slope(motion->signal, time);
    now.rotor_speed = motion->rotor_speed + motion->angular_acceleration * time;
    return now;
}

double rotor_turned(const CentreMotion *motion, double time)
{
    return time * (motion->rotor_speed + 0.5 * motion->angular_acceleration * time);
}

void shifted(const Complex *signal, Complex offset, double rotor_speed, const double *spin_up,
             Complex *result)
{
    const double angular_acceleration = spin_up[0], w = rotor_speed;
    const Complex whirl = {-(rotor_speed * rotor_speed), angular_acceleration};
    result[0] = complex_sum(signal[0], complex_product(whirl, offset));
    result[1] = complex_difference(
        signal[1], complex_scaled(2.0 * rotor_speed * angular_acceleration, offset));
    result[2] = complex_difference(
        signal[2], complex_scaled(2.0 * angular_acceleration * angular_acceleration, offset));
    result[3] = signal[3];
    if (drifts(spin_up)) {
        const Complex whirls[3] = {
            {0.0, spin_up[1]},
            {-2.0 * w * spin_up[1], spin_up[2]},
            {-6.0 * angular_acceleration * spin_up[1] - 2.0 * w * spin_up[2], spin_up[3]}};
        int k;
        for (k = 0; k < 3; k++) {
            result[k + 1] = complex_sum(result[k + 1], complex_product(whirls[k], offset));
        }
    }
}

void shift_quintic(Complex *signal, Complex offset, double rotor_speed, const double *spin_up)
{
    const double w1 = spin_up[0], w2 = spin_up[1], w3 = spin_up[2], w4 = spin_up[3];
    const double fourth = 2.0 * rotor_speed * w4 + 8.0 * w1 * w3 + 6.0 * w2 * w2;
    const double fifth = 10.0 * w1 * w4 + 20.0 * w2 * w3;
    shifted(signal, offset, rotor_speed, spin_up, signal);
    signal[4] = complex_difference(signal[4], complex_scaled(fourth, offset));
    signal[5] = complex_difference(signal[5], complex_scaled(fifth, offset));
}
