#include "contact/resistance.h"

#include "base/cubic.h"
#include "base/elementary.h"
#include "constants.h"
#include "contact/contact.h"
#include "weights/weights.h"

int find_sides(const SlidingGroup *group, Complex acceleration, double angle, double angle_rate,
               double rotor_speed, double *sides)
{
    const double turning = rotor_speed + angle_rate;
    const double centrifugal = group->radius * (turning * turning);
    int k;
    if (magnitude(acceleration) < centrifugal) {
        return 0;
    }
    for (k = 0; k < group->count; k++) {
        const Complex load = complex_product(acceleration, rect(1.0, -angle - group->offset[k]));
        sides[k] = centrifugal >= load.re ? 1.0 : -1.0;
    }
    return group->count;
}

void sliding_drive(const SlidingGroup *group, Complex acceleration, Complex slope, double angle,
                   double angle_rate, double rotor_speed, double angular_acceleration,
                   const double *sides, int side_count, double *drive, double *drive_slope)
{
    const double turning = rotor_speed + angle_rate;
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
        z = complex_product(acceleration, unit);
        dz = complex_product(slope, unit);
        load += mass * pull;
        g += group->lever * z.im + pull * z.re;
        dg += group->lever * (dz.im - angle_rate * z.re) + pull * (dz.re + angle_rate * z.im);
    }
    g = share * (g - load * centrifugal) - group->spin_share * angular_acceleration;
    angle_acceleration = g - group->damping_rate * angle_rate;
    dg -= 2.0 * load * group->radius * turning * (angular_acceleration + angle_acceleration);
    *drive = g;
    *drive_slope = share * dg;
}

int sliding_substep(const SlidingGroup *group, double *angle, double *angle_rate,
                    const Complex *ends, double rotor_speed, double angular_acceleration,
                    const double *response, double step, double *sides, Failure *failure)
{
    const double *s = response + 1, *t = response + 6; /* to g0..g3 */
    const double end_speed = rotor_speed + angular_acceleration * step;
    double g0, g1, free_rate, free_angle, new_rate, new_angle, change = 0.0;
    int side_count = find_sides(group, ends[0], *angle, *angle_rate, rotor_speed, sides);
    int iteration;
    sliding_drive(group, ends[0], ends[1], *angle, *angle_rate, rotor_speed, angular_acceleration,
                  sides, side_count, &g0, &g1);
    free_rate = response[0] * *angle_rate + s[0] * g0 + s[1] * g1;
    free_angle = *angle + response[5] * *angle_rate + t[0] * g0 + t[1] * g1;
    new_rate = free_rate;
    new_angle = free_angle;
    /* kept during the iteration, which a load that changes sides in it would not let converge */
    side_count = find_sides(group, ends[2], free_angle, free_rate, end_speed, sides);
    for (iteration = 0; iteration < MAX_ITERATIONS; iteration++) {
        const double last_angle = new_angle, last_rate = new_rate, last_change = change;
        double end, slope, g2, g3;
        sliding_drive(group, ends[2], ends[3], new_angle, new_rate, end_speed, angular_acceleration,
                      sides, side_count, &end, &slope);
        hermite(g0, g1, end, slope, step, &g2, &g3);
        new_rate = free_rate + s[2] * g2 + s[3] * g3;
        new_angle = free_angle + t[2] * g2 + t[3] * g3;
        change = absolute(new_angle - last_angle) + absolute(new_rate - last_rate) * step;
        if (converged(change, last_change, new_angle)) {
            *angle = new_angle;
            *angle_rate = new_rate;
            return FINE;
        }
    }
    return fail(failure, FAILURE_SLIDE, "weights", 0, step, *angle, *angle_rate,
                magnitude(ends[0]));
}
