#include "contact/event_functions.h"

#include "base/elementary.h"
#include "base/roots.h"
#include "contact/groups.h"

#define GAP_ROUNDING 1e-14 /* rad: a gap closes when it is less than 0 by more than this */
#define DIP 1e-12      /* rad: more than rounding */

/* Rounding of forcings; never less than what find_groups leaves together. */
static double slack_of(const WeightsInOrder *weights, int i, const Instant *now)
{
    const Complex forcing = complex_scaled(weights->track->lever, now->motion[0]);
    return PULL * weights->groups.runs.size[i] *
           (magnitude(forcing) + absolute(now->spin.rates[0]));
}

/* Least of the sums of `count` values one after the other, and after which of them. */
static double least_sum(int count, const double *values, int *where)
{
    double least = infinity(), sum = 0.0;
    int j;
    *where = 0;
    for (j = 0; j < count; j++) {
        sum += values[j];
        if (sum < least) {
            least = sum;
            *where = j;
        }
    }
    return least;
}

/* Set `forcings` to what pulls a group's weights apart: their mass times what they would be
   accelerated by beyond the group's mean. */
static void fill_relative_forcings(WeightsInOrder *weights, int i, double middle, double angle_rate,
                                   const Instant *now)
{
    const Track *track = weights->track;
    const Groups *groups = &weights->groups;
    const int first = groups->runs.first[i], size = groups->runs.size[i];
    const double grip = groups->sign[i] * track->grip, turning = now->spin.speed + angle_rate;
    const double centrifugal = track->weights.track_radius * (turning * turning);
    double mean = 0.0;
    int k;
    for (k = 0; k < size; k++) {
        const int j = (first + k) % weights->count;
        const double angle = -middle - weights->offset[first + k];
        const Complex z = complex_product(now->motion[0], rect(1.0, angle));
        weights->forcings[k] =
            track->lever * z.im - grip * absolute(centrifugal - z.re) -
            (weights->damping_rate[j] - groups->damping_rate[i]) * angle_rate -
            (weights->spin_share[j] - groups->spin_share[i]) * now->spin.rates[0];
        mean += weights->mass[j] * weights->forcings[k];
    }
    mean /= groups->mass[i];
    for (k = 0; k < size; k++) {
        weights->forcings[k] = weights->mass[first + k] * (weights->forcings[k] - mean);
    }
}

/* Least pressure in a group, as an acceleration and above rounding, and after whom. */
static double pressure_of(const EventFunctions *functions, int i, double middle, double angle_rate,
                          const Instant *now, int *where)
{
    WeightsInOrder *weights = functions->weights;
    const Groups *groups = &weights->groups;
    *where = 0;
    if (groups->resting[i]) {
        return 1.0;
    }
    fill_relative_forcings(weights, i, middle, angle_rate, now);
    return least_sum(groups->runs.size[i] - 1, weights->forcings, where) +
           slack_of(weights, i, now);
}

/* What resistance has left to hold a resting group or a part of it; negative: it moves.

   A part moves when it can push all that is before it, so the ends of the group decide. */
static double hold_of(WeightsInOrder *weights, int i, const Instant *now)
{
    const double *forcings = weights->forcings, *limits = weights->limits;
    const int size = weights->groups.runs.size[i];
    const double slack = slack_of(weights, i, now);
    double least = infinity(), forward = 0.0, backward = 0.0, forcing = 0.0, limit = 0.0;
    int k;
    fill_forcings(weights, weights->groups.runs.first[i], size, now);
    for (k = 0; k < size; k++) {
        limit += limits[k];
        forcing += forcings[k];
        forward += limits[k] + forcings[k];
        backward += limits[size - 1 - k] - forcings[size - 1 - k];
        least = smaller(smaller(least, forward), backward);
    }
    return (weights->track->full ? limit - absolute(forcing) : least) + slack;
}

static void find_state(const EventFunctions *functions, int i, const Instant *later, double time,
                       double *middle, double *rate)
{
    move_group(functions->weights, i, &functions->now, later, time, middle, rate);
}

double event_value(const EventFunction *event, double time)
{
    const EventFunctions *functions = event->functions;
    WeightsInOrder *weights = functions->weights;
    const Groups *groups = &weights->groups;
    const Instant later = find_instant(functions->motion, functions->begin + time);
    const int i = event->group, j = (i + 1) % groups->runs.count;
    double middle, rate, following, following_rate, value;
    int where;
    if (event->kind == BREAKS_AWAY) {
        return hold_of(weights, i, &later);
    }
    find_state(functions, i, &later, time, &middle, &rate);
    if (event->kind == COMES_TO_REST) {
        value = groups->sign[i] * rate;
    } else if (event->kind == PULLED_OPEN) {
        value = pressure_of(functions, i, middle, rate, &later, &where);
    } else {
        find_state(functions, j, &later, time, &following, &following_rate);
        value = event->start + (following - middle - (groups->middle[j] - groups->middle[i]));
    }
    return weights->failure->code ? not_a_number() : value;
}

/* 1 if the event has happened at the time of a least value, which is then its `upper`. */
static int dips(EventFunction *event, double time)
{
    if (time != 0.0 && event_value(event, time) < 0.0) {
        event->upper = time;
        return 1;
    }
    return 0;
}

static int gap_closes(EventFunction *event, double length)
{
    const WeightsInOrder *weights = event->functions->weights;
    const Groups *groups = &weights->groups;
    const int i = event->group, j = (i + 1) % groups->runs.count;
    const double base = groups->middle[j] - groups->middle[i];
    const double opening = groups->angle_rate[j] - groups->angle_rate[i];
    const double final_opening = groups->end_rate[j] - groups->end_rate[i];
    double final;
    event->where = (groups->runs.first[i] + groups->runs.size[i] - 1) % weights->count;
    event->start = larger(0.0, gap(weights, event->where)) + GAP_ROUNDING;
    final = event->start + (groups->end_middle[j] - groups->end_middle[i] - base);
    /* rounding must not close a gap that opens; one that dips and opens again has to */
    if (final < (smaller(opening, final_opening) < 0.0 ? 0.0 : -DIP)) {
        return 1;
    }
    return opening < 0.0 && 0.0 < final_opening &&
           dips(event, find_lowest(event->start, opening, final, final_opening, length));
}

static int pulled_open(EventFunction *event, const Instant *later)
{
    const EventFunctions *functions = event->functions;
    const WeightsInOrder *weights = functions->weights;
    const Groups *groups = &weights->groups;
    const int i = event->group;
    int behind, unused;
    if (!(pressure_of(functions, i, groups->end_middle[i], groups->end_rate[i], later, &behind) <
          0.0)) {
        return 0;
    }
    event->where = (groups->runs.first[i] + behind) % weights->count;
    event->start = pressure_of(functions, i, groups->middle[i], groups->angle_rate[i],
                               &functions->now, &unused);
    return 1;
}

static int comes_to_rest(EventFunction *event, const Instant *later, double length)
{
    const EventFunctions *functions = event->functions;
    WeightsInOrder *weights = functions->weights;
    const Groups *groups = &weights->groups;
    const int i = event->group;
    const double sign = groups->sign[i], rate = groups->angle_rate[i];
    const double end_rate = groups->end_rate[i];
    double start[2], final[2];
    event->start = sign * rate;
    if (sign * end_rate < 0.0) {
        return 1;
    }
    find_group_acceleration(weights, i, groups->middle[i], rate, &functions->now, start);
    find_group_acceleration(weights, i, groups->end_middle[i], end_rate, later, final);
    return sign * start[0] < 0.0 && 0.0 < sign * final[0] &&
           dips(event, find_lowest(sign * rate, sign * start[0], sign * end_rate, sign * final[0],
                                   length));
}

static int breaks_away(EventFunction *event, const Instant *later)
{
    const EventFunctions *functions = event->functions;
    if (!(hold_of(functions->weights, event->group, later) < 0.0)) {
        return 0;
    }
    event->start = hold_of(functions->weights, event->group, &functions->now);
    return 1;
}

bool may_happen(const EventFunctions *functions, int kind)
{
    const WeightsInOrder *weights = functions->weights;
    const int groups = weights->groups.runs.count;
    if (kind == GAP_CLOSES) {
        return weights->track->solid && groups > 1;
    }
    if (kind == PULLED_OPEN) {
        return groups < weights->count && !weights->track->full;
    }
    return weights->track->grip > 0.0;
}

int find_event_function(EventFunctions *functions, int kind, int i, const Instant *later,
                        double length, EventFunction *event)
{
    const Groups *groups = &functions->weights->groups;
    event->functions = functions;
    event->kind = kind;
    event->group = i;
    event->where = -1;
    event->start = 0.0;
    event->upper = length;
    switch (kind) {
    case GAP_CLOSES:
        return gap_closes(event, length);
    case PULLED_OPEN:
        return groups->runs.size[i] > 1 && pulled_open(event, later);
    case COMES_TO_REST:
        return groups->sign[i] != 0.0 && comes_to_rest(event, later, length);
    default:
        return groups->resting[i] && breaks_away(event, later);
    }
}
