#include "contact/events.h"

#include "base/elementary.h"
#include "base/roots.h"
#include "constants.h"
#include "contact/event_functions.h"
#include "contact/groups.h"
#include "contact/impacts.h"

#define LOCATED 1e-12     /* of the substep */
#define MOST_SUBSTEPS 100000 /* substeps and events within a communication step */

EventStepper event_stepper(WeightsInOrder *weights, const CentreMotion *motion, bool stops)
{
    EventStepper stepper;
    stepper.weights = weights;
    stepper.motion = motion;
    stepper.stops = stops;
    stepper.time = 0.0;
    stepper.impulse = complex_of(0.0, 0.0);
    stepper.events = 0;
    return stepper;
}

/* Substeps of what is left of a step; 0 when they are too many. */
static int substeps_of(const EventStepper *stepper, double left, double step)
{
    /* as weights_advance, so that weights that meet nothing move in its substeps */
    const WeightsInOrder *weights = stepper->weights;
    const CentreMotion *motion = stepper->motion;
    const Track *track = weights->track;
    double strongest;
    const double fastest =
        fastest_rate(weights->count, weights->angle_rate, motion->signal, track->lever,
                     track->spin_share * motion->spin.rates[0], track->damping_rate, step,
                     &strongest);
    const double turns = left * fastest / TURN_PER_SUBSTEP;
    if (!(turns < MOST_SUBSTEPS)) {
        fail(weights->failure, TOO_MANY_SUBSTEPS, turns, left, strongest,
             largest_of(weights->count, weights->angle_rate));
        return 0;
    }
    return 1 + (int)turns;
}

/* Set where the groups are, and how fast, after `length`. */
static void move_groups(const EventFunctions *functions, const Instant *later, double length)
{
    Groups *groups = &functions->weights->groups;
    int i;
    for (i = 0; i < groups->runs.count; i++) {
        move_group(functions->weights, i, &functions->now, later, length, &groups->end_middle[i],
                   &groups->end_rate[i]);
    }
}

static double candidate_value(void *event, double time)
{
    return event_value(event, time);
}

/* Time of the first event of those that show at the ends of a stretch, to `width`; `event->kind` is
   -1 when there is none. */
static double find_candidate(EventFunctions *functions, const Instant *later, double length,
                             double width, EventFunction *event)
{
    const WeightsInOrder *weights = functions->weights;
    double first = length;
    int kind, i;
    event->kind = -1;
    for (kind = 0; kind < KINDS; kind++) {
        const int count = may_happen(functions, kind) ? weights->groups.runs.count : 0;
        for (i = 0; i < count && !weights->failure->code; i++) {
            EventFunction candidate;
            if (!find_event_function(functions, kind, i, later, length, &candidate)) {
                continue;
            }
            if (event->kind >= 0 && candidate.upper >= first &&
                event_value(&candidate, first) >= 0.0) {
                continue;
            }
            first = find_crossing(candidate_value, &candidate, candidate.start,
                                  smaller(candidate.upper, first), width);
            *event = candidate;
        }
    }
    return first;
}

static void collide_at_time(EventStepper *stepper, int closed)
{
    const Instant now = find_instant(stepper->motion, stepper->time);
    const Complex blow = collide_weights(stepper->weights, &now, closed);
    const Complex turn = rect(1.0, now.spin.angle);
    stepper->impulse = complex_sum(stepper->impulse, complex_product(blow, turn));
}

/* Change what an event changes; breaking away changes nothing but the groups. */
static void apply_event(EventStepper *stepper, const EventFunction *event)
{
    WeightsInOrder *weights = stepper->weights;
    const Runs *groups = &weights->groups.runs;
    int k;
    if (event->kind == GAP_CLOSES) {
        collide_at_time(stepper, event->where);
    } else if (event->kind == PULLED_OPEN) {
        weights->joined[event->where] = 0;
    } else if (event->kind == COMES_TO_REST) {
        const int first = groups->first[event->group];
        for (k = first; k < first + groups->size[event->group]; k++) {
            weights->angle_rate[k % weights->count] = 0.0;
        }
    }
}

/* Move to the first event before `until`, or there; returns the kind of event, or -1. */
static int advance_substep(EventStepper *stepper, double until)
{
    WeightsInOrder *weights = stepper->weights;
    const CentreMotion *motion = stepper->motion;
    const double begin = stepper->time, length = until - begin, width = LOCATED * length;
    const Groups *groups = &weights->groups;
    Instant later = find_instant(motion, until);
    EventFunctions functions;
    EventFunction event, other;
    double first;
    int i;
    functions.weights = weights;
    functions.motion = motion;
    functions.begin = begin;
    functions.now = find_instant(motion, begin);
    find_groups(weights, &functions.now);
    move_groups(&functions, &later, length);
    first = find_candidate(&functions, &later, length, width, &event);
    while (event.kind >= 0 && !weights->failure->code) {
        double sooner;
        later = find_instant(motion, begin + first);
        move_groups(&functions, &later, first);
        /* what came and went within the longer stretch may show only in the shorter one */
        sooner = find_candidate(&functions, &later, first, width, &other);
        if (other.kind < 0 || sooner >= first - width) {
            break;
        }
        first = sooner;
        event = other;
    }
    if (weights->failure->code) {
        return -1;
    }
    for (i = 0; i < groups->runs.count; i++) {
        if (!groups->resting[i]) { /* rounding must not make resting weights creep */
            place_group(weights, groups->runs.first[i], groups->runs.size[i], groups->end_middle[i],
                  groups->end_rate[i]);
        }
    }
    stepper->time = event.kind < 0 ? until : begin + first;
    if (event.kind >= 0) {
        stepper->events++;
        apply_event(stepper, &event);
    }
    return event.kind;
}

int advance_events(EventStepper *stepper, double step)
{
    const Failure *failure = stepper->weights->failure;
    int k;
    if (approaching(stepper->weights, 0.0)) {
        collide_at_time(stepper, -1);
    }
    for (k = 0; k < MOST_SUBSTEPS && !failure->code; k++) {
        const double left = step - stepper->time;
        const int count = substeps_of(stepper, left, step);
        if (count) {
            const int kind = advance_substep(stepper, count == 1 ? step : stepper->time + left / count);
            if (failure->code || stepper->time >= step || (stepper->stops && kind >= 0)) {
                return failure->code;
            }
        }
    }
    if (failure->code) {
        return failure->code;
    }
    return fail(stepper->weights->failure, "more than %u substeps and events of the weights in %6 s, %6 s "
                "reached: use smaller communication steps",
                (unsigned long)MOST_SUBSTEPS, step, stepper->time);
}
