#include "contact/motion.h"

#include "base/elementary.h"
#include "base/matrix.h"
#include "weights/centre.h"
#include "contact/events.h"
#include "contact/groups.h"
#include "contact/ring.h"

size_t track_scratch(int count)
{
    return ring_scratch(count);
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
    code = order_weights(track, angles, speeds, contacts, scratch, &weights, failure);
    for (k = 0; k < n && !code; k++) {
        const int alike = weights.angle_rate[k] == weights.angle_rate[(k + 1) % n];
        contacts[weights.order[k]] = alike && gap(&weights, k) <= TOUCHING_ANGLE ? 1.0 : 0.0;
        room += gap(&weights, k);
    }
    if (!code && !track->full && !(room > n * TOUCHING_ANGLE)) { /* which depends on their order */
        code = fail(failure, "weight_radius: %u weights of unequal radii need %6 rad of a track of radius "
                    "%v m, must be less than a turn",
                    (unsigned long)n, TAU - room, track->weights.track_radius);
    }
    return code;
}

int track_advance(const Track *track, const double *angles, const double *speeds,
                  const double *contacts, const CentreMotion *motion, double step, bool stops,
                  Moved *moved, double *scratch, Failure *failure)
{
    WeightsInOrder weights;
    EventStepper stepper;
    int code;
    if (drifts(motion->spin.rates)) {
        return fail(failure, "der(acceleration) = %v rad/s3: must be 0 for weights that touch or stick, "
                    "as all its derivatives", motion->spin.rates[1]);
    }
    code = order_weights(track, angles, speeds, contacts, scratch, &weights, failure);
    if (code) {
        return code;
    }
    stepper = event_stepper(&weights, motion, stops);
    code = advance_events(&stepper, step);
    if (code) {
        return code;
    }
    write_weights(&weights, moved->angles, moved->speeds, moved->contacts);
    moved->impulse = complex_product(
        stepper.impulse, rect(1.0, -spin_after(&motion->spin, stepper.time).angle));
    moved->events = stepper.events;
    moved->reached = stepper.time;
    return FINE;
}

/* What drives the weights of a track whose plane moves like that. */
static Instant centre_of(const Track *track, const Instant *plane)
{
    Instant now = *plane;
    shift_signal(now.motion, 2, track->offset, now.spin.speed, now.spin.rates);
    return now;
}

int track_reaction(const Track *track, const double *angles, const double *speeds,
                   const double *contacts, const Instant *plane, Complex *force, Turned *turned,
                   double *scratch, Failure *failure)
{
    const Instant now = centre_of(track, plane);
    const Complex carried = complex_scaled(-weights_added_mass(&track->weights), track->offset);
    if (track->eventful) {
        WeightsInOrder weights;
        const int code = order_weights(track, angles, speeds, contacts, scratch, &weights, failure);
        if (code) {
            return code;
        }
        ring_reaction(&weights, &now, force);
    } else {
        weights_reaction(&track->weights, angles, speeds, &now, force, turned);
    }
    shift_signal(force, 2, carried, now.spin.speed, now.spin.rates);
    return FINE;
}

/* Add to the torque what rolling resistance does. */
static int add_resistance(const Track *track, const double *angles, const double *speeds,
                          const double *contacts, const Instant *now, double *torque,
                          double *scratch, Failure *failure)
{
    WeightsInOrder weights;
    double free[2], left[2];
    const int code = order_weights(track, angles, speeds, contacts, scratch, &weights, failure);
    int k;
    if (code) {
        return code;
    }
    weights_unhindered(&track->weights, angles, speeds, now, free);
    ring_turning(&weights, now, left);
    for (k = 0; k < 2; k++) {
        torque[k] += weights_arm(&track->weights) * (free[k] - left[k]);
    }
    return FINE;
}

int track_torque(const Track *track, const double *angles, const double *speeds,
                 const double *contacts, const Instant *plane, const Complex *force, double *torque,
                 double *scratch, Failure *failure)
{
    const Instant now = centre_of(track, plane);
    const double carried = weights_added_mass(&track->weights);
    int k;
    weights_torque(&track->weights, angles, speeds, &now, torque);
    if (track->grip > 0.0) {
        const int code =
            add_resistance(track, angles, speeds, contacts, &now, torque, scratch, failure);
        if (code) {
            return code;
        }
    }
    for (k = 0; k < 2; k++) {
        const Complex pull = complex_difference(force[k], complex_scaled(carried, plane->motion[k]));
        torque[k] += complex_product(complex_conjugate(track->offset), pull).im;
    }
    return FINE;
}
