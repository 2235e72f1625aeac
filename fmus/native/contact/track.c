#include "contact/track.h"

#include "base/elementary.h"
#include "contact/spacing.h"

static const char TOO_LARGE[] = "weight_radius = %v m: %u weights do not fit on a track of radius %v m, the "
                                "largest that fit have %6 m";

/* FINE, or what is no lobe; a race bends inwards nowhere. */
static int check_lobes(const Weights *weights, Failure *failure)
{
    double bent = 0.0;
    int k;
    for (k = 0; k < weights->lobes; k++) {
        const double *lobe = weights->lobe + 3 * k, n = lobe[0];
        if (!(n >= 1.0 && n <= MOST_LOBES && n == nearest(n))) {
            return fail(failure, "race[%u].lobes = %v: must be a whole number from 1 to %u", (unsigned long)(k + 1), n,
                        (unsigned long)MOST_LOBES);
        }
        bent += (n > 1.0 ? n * n - 1.0 : 1.0) * lobe[1];
    }
    if (!(bent < weights->track_radius)) {
        return fail(failure, "race: the sum of (lobes^2 - 1) amplitude is %6 m, must be less than track_radius = %v m: the "
                    "race would bend inwards", bent, weights->track_radius);
    }
    return FINE;
}

/* FINE, or what does not fit together; the variables' own limits hold. */
static int check_options(const Track *track, Failure *failure)
{
    const double radius = track->weights.track_radius, size = track->weight_radius;
    const int count = track->weights.count;
    int k;
    if (check_lobes(&track->weights, failure)) {
        return failure->code;
    }
    if (track->weights.lobes && track->rolling_resistance > 0.0) {
        return fail(failure, "rolling_resistance = %v: must be 0 on a race with lobes", track->rolling_resistance);
    }
    if (track->restitution > 1.0) {
        return fail(failure, "restitution = %v: must be within 0 to 1", track->restitution);
    }
    if (!(track->mobility * weights_added_mass(&track->weights) < 1.0)) {
        return fail(failure, "track_mobility = %v 1/kg: must be 0 or more and less than %6 1/kg, one over "
                    "the mass of all weights",
                    track->mobility, 1.0 / weights_added_mass(&track->weights));
    }
    for (k = 0; track->weights.each && k < count; k++) {
        const Weights one = weights_single(&track->weights, k);
        if (!(one.radius < radius)) {
            return fail(failure, TOO_LARGE, one.radius, 1ul, radius, radius);
        }
    }
    if (!track->weights.each && !fits(count, size, radius)) {
        return fail(failure, TOO_LARGE, size, (unsigned long)count, radius, largest_radius(count, radius));
    }
    return FINE;
}

Touch track_touch(const Track *track)
{
    const Touch touch = {track->restitution, track->rolling_resistance};
    return touch;
}

int track_prepare(Track *track, Failure *failure)
{
    Weights *weights = &track->weights;
    int code, k, sizes_differ = 0;
    weights->radius = track->weight_radius;
    code = check_options(track, failure);
    if (code) {
        return code;
    }
    track->alpha = half_angle(track->weight_radius, weights->track_radius);
    track->moment = weights->mass * weights->track_radius;
    track->solid = track->alpha > 0.0 && weights->count > 1;
    for (k = 0; weights->each && k < weights->count; k++) {
        sizes_differ |= weights->each[2 * weights->count + k] != 1.0;
    }
    track->full = track->solid && !sizes_differ &&
                  weights->count * track->alpha >= PI - weights->count * TOUCHING_ANGLE;
    track->eventful =
        (track->weight_radius > 0.0 && weights->count > 1) || track->rolling_resistance > 0.0;
    return FINE;
}

Complex track_static_moment(const Track *track, const double *angles, Turned *turned)
{
    return complex_sum(weights_static_moment(&track->weights, angles, turned),
                       complex_scaled(weights_added_mass(&track->weights), track->offset));
}
