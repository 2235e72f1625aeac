#include "contact/motion.h"

#include "base/elementary.h"
#include "base/matrix.h"
#include "base/spin.h"
#include "contact/centre.h"
#include "contact/events.h"
#include "contact/groups.h"
#include "contact/ring.h"
#include "weights/quintic_weights.h"

size_t track_scratch(int count)
{
    return ring_scratch(count);
}

static int is_offset(const Track *track)
{
    return track->offset.re != 0.0 || track->offset.im != 0.0;
}

Complex track_static_moment(const Track *track, const double *angles, Turned *turned)
{
    return complex_sum(weights_static_moment(&track->weights, angles, turned),
                       complex_scaled(weights_added_mass(&track->weights), track->offset));
}

int track_first_contacts(const Track *track, const double *angles, const double *speeds,
                         double *contacts, double *scratch, Failure *failure)
{
    const int n = track->weights.count;
    WeightsInOrder weights;
    double room = 0.0;
    int k, code;
    fill_doubles((size_t)n, 0.0, contacts);
    if (!track->solid) {
        return FINE;
    }
    code = put_in_order(track, angles, speeds, contacts, scratch, &weights, failure);
    for (k = 0; k < n && !code; k++) {
        const int alike = weights.angle_rate[k] == weights.angle_rate[(k + 1) % n];
        contacts[weights.order[k]] = alike && gap(&weights, k) <= TOUCHING_ANGLE ? 1.0 : 0.0;
        room += gap(&weights, k);
    }
    if (!code && !track->full && !(room > n * TOUCHING_ANGLE)) { /* which depends on their order */
        code = fail(failure, FAILURE_NO_ROOM, "weight_radius", n, TAU - room,
                    track->weights.track_radius, 0.0, 0.0);
    }
    return code;
}

int track_advance(const Track *track, const double *angles, const double *speeds,
                  const double *contacts, const Complex *signal, double rotor_speed,
                  const double *spin_up, double step, int stops, Moved *moved,
                  double *scratch, Failure *failure)
{
    CentreMotion motion;
    WeightsInOrder weights;
    EventStepper stepper;
    int k, code;
    motion.rotor_speed = rotor_speed;
    motion.angular_acceleration = spin_up[0];
    for (k = 0; k < 4; k++) {
        motion.signal[k] = signal[k];
    }
    if (is_offset(track)) {
        shifted(signal, track->offset, rotor_speed, spin_up, motion.signal);
    }
    moved->impulse = complex_of(0.0, 0.0);
    moved->events = 0;
    moved->reached = step;
    if (!track->eventful) {
        Quadrature memory = quadrature_empty();
        copy_doubles((size_t)track->weights.count, contacts, moved->contacts);
        return weights_advance(&track->weights, angles, speeds, motion.signal, spin_up,
                               step, moved->angles, moved->speeds, &memory, NULL, failure);
    }
    if (drifts(spin_up)) {
        return fail(failure, FAILURE_SPIN, "der(acceleration)", 0, spin_up[1], 0.0, 0.0, 0.0);
    }
    code = put_in_order(track, angles, speeds, contacts, scratch, &weights, failure);
    if (code) {
        return code;
    }
    stepper = event_stepper(&weights, &motion, stops);
    code = run(&stepper, step);
    if (code) {
        return code;
    }
    as_given(&weights, moved->angles, moved->speeds, moved->contacts);
    moved->impulse =
        complex_product(stepper.impulse, rect(1.0, -rotor_turned(&motion, stepper.time)));
    moved->events = stepper.events;
    moved->reached = stepper.time;
    return FINE;
}

int track_reaction(const Track *track, const double *angles, const double *speeds,
                   const double *contacts, Complex acceleration, Complex slope, double rotor_speed,
                   double angular_acceleration, double change, Complex *force,
                   Complex *force_slope, double *scratch, Failure *failure)
{
    const int off = is_offset(track);
    const Complex whirl = {-(rotor_speed * rotor_speed), angular_acceleration};
    const double whirl_slope = 2.0 * rotor_speed * angular_acceleration;
    if (off) {
        acceleration = complex_sum(acceleration, complex_product(whirl, track->offset));
        slope = complex_difference(slope, complex_scaled(whirl_slope, track->offset));
        slope = complex_sum(slope, complex_product(complex_of(0.0, change), track->offset));
    }
    if (track->eventful) {
        WeightsInOrder weights;
        Instant now;
        const int code = put_in_order(track, angles, speeds, contacts, scratch, &weights, failure);
        if (code) {
            return code;
        }
        now.acceleration = acceleration;
        now.slope = slope;
        now.rotor_speed = rotor_speed;
        ring_reaction(&weights, &now, angular_acceleration, force, force_slope);
    } else {
        weights_reaction(&track->weights, angles, speeds, acceleration, slope, rotor_speed,
                         angular_acceleration, change, force, force_slope, NULL);
    }
    if (off) {
        const Complex carried = complex_scaled(weights_added_mass(&track->weights), track->offset);
        *force = complex_difference(*force, complex_product(carried, whirl));
        *force_slope = complex_sum(*force_slope, complex_scaled(whirl_slope, carried));
        *force_slope = complex_difference(*force_slope,
                                          complex_product(complex_of(0.0, change), carried));
    }
    return FINE;
}

Complex track_reaction_second(const Track *track, const double *angles, const double *speeds,
                              const Complex *motion, double rotor_speed, const double *spin_up,
                              Turned *turned)
{
    const double w = rotor_speed, w1 = spin_up[0], w2 = spin_up[1];
    const Complex whirls[3] = { /* i w' - w^2 and its derivatives */
        {-w * w, w1}, {-2.0 * w * w1, w2}, {-2.0 * (w1 * w1 + w * w2), spin_up[2]}};
    const Complex carried = complex_scaled(weights_added_mass(&track->weights), track->offset);
    Complex centre[3], second;
    int k;
    for (k = 0; k < 3; k++) {
        centre[k] = complex_sum(motion[k], complex_product(whirls[k], track->offset));
    }
    second = quintic_weights_reaction_second(&track->weights, angles, speeds, centre, w, spin_up,
                                             turned);
    return complex_difference(second, complex_product(whirls[2], carried));
}

/* What rolling resistance adds to the torque. */
static int add_resistance(const Track *track, const double *angles, const double *speeds,
                          const double *contacts, const Complex *centre, double rotor_speed,
                          double angular_acceleration, double *torque, double *scratch,
                          Failure *failure)
{
    WeightsInOrder weights;
    Instant now;
    double free[2], left[2];
    const int code = put_in_order(track, angles, speeds, contacts, scratch, &weights, failure);
    int k;
    if (code) {
        return code;
    }
    now.acceleration = centre[0];
    now.slope = centre[1];
    now.rotor_speed = rotor_speed;
    weights_unhindered(&track->weights, angles, speeds, centre, angular_acceleration, 0.0, free);
    ring_turning(&weights, &now, angular_acceleration, left);
    for (k = 0; k < 2; k++) {
        torque[k] += weights_arm(&track->weights) * (free[k] - left[k]);
    }
    return FINE;
}

int track_torque(const Track *track, const double *angles, const double *speeds,
                 const double *contacts, const Complex *motion, const Complex *force,
                 double rotor_speed, double angular_acceleration, double change, double *torque,
                 double *scratch, Failure *failure)
{
    const Complex whirl = {-(rotor_speed * rotor_speed), angular_acceleration};
    const Complex whirl_slope = {-2.0 * rotor_speed * angular_acceleration, change};
    const double carried = weights_added_mass(&track->weights);
    Complex centre[2];
    int k;
    centre[0] = complex_sum(motion[0], complex_product(whirl, track->offset));
    centre[1] = complex_sum(motion[1], complex_product(whirl_slope, track->offset));
    weights_torque(&track->weights, angles, speeds, centre, angular_acceleration, change, torque);
    if (track->rolling_resistance > 0.0) {
        const int code = add_resistance(track, angles, speeds, contacts, centre, rotor_speed,
                                        angular_acceleration, torque, scratch, failure);
        if (code) {
            return code;
        }
    }
    for (k = 0; k < 2; k++) {
        const Complex pull = complex_difference(force[k], complex_scaled(carried, motion[k]));
        torque[k] += complex_product(complex_conjugate(track->offset), pull).im;
    }
    return FINE;
}
