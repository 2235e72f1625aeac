#include "contact/resistance.h"

#include "base/elementary.h"
#include "constants.h"

int find_sides(const SlidingGroup *group, const Instant *now, double angle, double angle_rate,
               double *sides)
{
    const double turning = now->spin.speed + angle_rate;
    const double centrifugal = group->radius * (turning * turning);
    int k;
    if (magnitude(now->motion[0]) < centrifugal) {
        return 0;
    }
    for (k = 0; k < group->count; k++) {
        const Complex load = complex_product(now->motion[0], rect(1.0, -angle - group->offset[k]));
        sides[k] = centrifugal >= load.re ? 1.0 : -1.0;
    }
    return group->count;
}

void find_sliding_forcing(const SlidingGroup *group, const Instant *now, double angle,
                          double angle_rate, const double *sides, int side_count, double *forcing)
{
    const double spin_up = now->spin.rates[0], turning = now->spin.speed + angle_rate;
    const double centrifugal = group->radius * turning * turning;
    const Complex middle = rect(1.0, -angle);
    const int terms = side_count ? side_count : 1;
    const double share = side_count ? 1.0 / group->inertia : 1.0;
    double g = 0.0, dg = 0.0, load = 0.0, angle_acceleration;
    int k;
    for (k = 0; k < terms; k++) {
        double pull = group->grip, mass = 1.0;
        Complex unit, z, dz;
        if (side_count) {
            unit = complex_product(middle, rect(1.0, -group->offset[k]));
            mass = group->mass[k];
            unit = complex_scaled(mass, unit);
            pull *= sides[k];
        } else { /* the sum over the group is known */
            unit = complex_scaled(group->factor, middle);
        }
        z = complex_product(now->motion[0], unit);
        dz = complex_product(now->motion[1], unit);
        load += mass * pull;
        g += group->lever * z.im + pull * z.re;
        dg += group->lever * (dz.im - angle_rate * z.re) + pull * (dz.re + angle_rate * z.im);
    }
    g = share * (g - load * centrifugal) - group->spin_share * spin_up;
    angle_acceleration = g - group->damping_rate * angle_rate;
    dg -= 2.0 * load * group->radius * turning * (spin_up + angle_acceleration);
    forcing[0] = g;
    forcing[1] = share * dg;
}

int sliding_substep(const SlidingGroup *group, double *angle, double *angle_rate,
                    const Instant *now, const Instant *later, const double *response, double step,
                    double *sides, Failure *failure)
{
    const double *s = response + 1, *t = response + 6; /* to g0..g3 */
    double begin[2], reached[2], second, third;
    double free_rate, free_angle, new_rate, new_angle, change = 0.0;
    int side_count = find_sides(group, now, *angle, *angle_rate, sides);
    int iteration;
    find_sliding_forcing(group, now, *angle, *angle_rate, sides, side_count, begin);
    free_rate = response[0] * *angle_rate + s[0] * begin[0] + s[1] * begin[1];
    free_angle = *angle + response[5] * *angle_rate + t[0] * begin[0] + t[1] * begin[1];
    new_rate = free_rate;
    new_angle = free_angle;
    /* kept during the iteration, which a load that changes sides in it would not let converge */
    side_count = find_sides(group, later, free_angle, free_rate, sides);
    for (iteration = 0; iteration < MAX_ITERATIONS; iteration++) {
        const double last_angle = new_angle, last_rate = new_rate, last_change = change;
        find_sliding_forcing(group, later, new_angle, new_rate, sides, side_count, reached);
        hermite(begin[0], begin[1], reached[0], reached[1], step, &second, &third);
        new_rate = free_rate + s[2] * second + s[3] * third;
        new_angle = free_angle + t[2] * second + t[3] * third;
        change = absolute(new_angle - last_angle) + absolute(new_rate - last_rate) * step;
        if (converged(change, last_change, new_angle)) {
            *angle = new_angle;
            *angle_rate = new_rate;
            return FINE;
        }
    }
    return fail(failure, "the sliding weights' step of %6 s did not converge (angle %6 rad, rate %6 "
                "rad/s, acceleration %6 m/s^2): use smaller steps",
                step, *angle, *angle_rate, magnitude(now->motion[0]));
}
