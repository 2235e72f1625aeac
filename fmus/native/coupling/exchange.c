#include "coupling/exchange.h"

#include <string.h>

#include "base/elementary.h"
#include "coupling/composite.h"
#include "coupling/exchange_events.h"
#include "coupling/exchange_stops.h"
#include "units/angle.h"

Status exchange_begin(Unit *unit)
{
    if (unit->equations != &COMPOSITE_EQUATIONS) {
        return unit_refuse(unit, "instantiation failed",
                           "the unit is for co-simulation, not for model exchange");
    }
    unit->for_model_exchange = true;
    ((Composite *)unit->own)->parts->unit->for_model_exchange = true;
    return STATUS_OK;
}

/* Get or set the states of a part, or get nominal values; their number, without values that alone. */
static size_t part_states(const Part *of, ExchangeCall call, double *values)
{
    Unit *part = of->unit;
    const Equations *equations = part->equations;
    const size_t plain = equations->states ? equations->states(&part->layout) : 0,
                 turns = plain && equations->turns;
    double *memory = part->memory + (turns ? ANGLE_SIZE : 0);
    size_t k;
    if (!values || !plain) {
        return turns + plain;
    }
    if (call == SET_STATES) {
        if (turns) {
            angle_start(part->memory, *values);
        }
        memcpy(memory, values + turns, plain * sizeof(double));
    } else {
        *values = call == GET_STATES ? angle_total(part->memory) : 1.0;
        for (k = 0; k < plain; k++) {
            values[turns + k] =
                call == GET_STATES ? memory[k] : equations->nominals[2 * k >= plain];
        }
    }
    return turns + plain;
}

/* The same of all parts. */
static size_t states(const Unit *unit, ExchangeCall call, double *values)
{
    const Composite *c = unit->own;
    size_t count = 0;
    int k;
    for (k = 0; k < c->part_count; k++) {
        count += part_states(c->parts + k, call, values ? values + count : NULL);
    }
    return count;
}

size_t exchange_count(Unit *unit)
{
    return unit->equations == &COMPOSITE_EQUATIONS ? states(unit, GET_STATES, NULL) : 0;
}

/* 1 with the reason where a rate is not finite. */
static int refuse_infinite(Unit *unit, const double *rates, size_t count)
{
    size_t k;
    for (k = 0; k < count; k++) {
        if (!is_finite(rates[k])) {
            return unit_fail(unit, "the derivative of continuous state %u is not finite; the states that were "
                             "set are too large, or too fast", (unsigned long)k + 1);
        }
    }
    return 0;
}

static int find_derivatives(Unit *unit, double *rates)
{
    int wrong = unit_refresh(unit, COMPUTED);
    if (!wrong && !(((const Composite *)unit->own)->course->clock.started > 0.0)) {
        wrong = unit_refresh(unit, OBSERVED);
    }
    wrong = wrong || (unit->for_model_exchange ? composite_meet_host(unit) : one_piece_place(unit));
    return wrong || one_piece_rates(unit, rates) || refuse_infinite(unit, rates, exchange_count(unit));
}

Status exchange_derivative(Unit *unit, size_t state, double *value)
{
    double *rates = ((const Composite *)unit->own)->saved_reals; /* more than states, and no step is under way */
    if (find_derivatives(unit, rates)) {
        return unit_report(unit, STATUS_ERROR, "reading failed");
    }
    *value = rates[state];
    return STATUS_OK;
}

/* Whether the host has come to a time since the start, or to what is that time among its own numbers. */
static bool is_due(const Unit *unit, double time)
{
    return time <= unit->time * (1.0 + TIME_ROUNDING) || unit_host_time(unit, time) <= unit->point;
}

/* The time is that of the host, and inputs are known. */
static int meet_host(Unit *unit)
{
    int wrong = unit_refresh(unit, COMPUTED);
    if (!wrong && !(((const Composite *)unit->own)->course->clock.started > 0.0)) {
        wrong = unit_refresh(unit, OBSERVED);
    }
    return wrong || composite_meet_host(unit);
}

Status exchange_indicator(Unit *unit, size_t indicator, double *value)
{
    double *values = ((const Composite *)unit->own)->saved_reals;
    if (meet_host(unit) || exchange_events_look(unit, values)) {
        return unit_report(unit, STATUS_ERROR, "reading failed");
    }
    *value = values[indicator];
    return STATUS_OK;
}

/* An integrator's step begins here, with the drive and the forces from outside as the host says them now: at its end
   it says them anew. */
static void begin_host_step(const Unit *unit)
{
    const Composite *c = unit->own;
    const DriveSignal *drive = &c->course->drive;
    OnePiece *one_piece = &c->course->one_piece;
    memcpy(c->pieces.begun_forces, c->outer_forces, outside_count(c) * sizeof(double));
    one_piece->pushed = unit->time - drive->pushed_at;
    one_piece->speed = composite_speed_now(unit);
    one_piece->acceleration = c->motor ? 0.0 : drive->acceleration;
}

/* Pass the events that are due; when the next is that a time is known of, and whether states have changed. */
static int pass_events(Unit *unit, double *next)
{
    const Composite *c = unit->own;
    double jump;
    if (unit_refresh(unit, OBSERVED)) {
        return 1;
    }
    for (jump = composite_next_jump(c); is_due(unit, jump); jump = composite_next_jump(c)) {
        unit->stale = COMPUTED;
        if (composite_pass_jump(unit)) {
            return 1;
        }
    }
    *next = unit_host_time(unit, jump);
    next[1] = 0.0;
    if (exchange_indicators(unit)) {
        bool changed = false;
        if (meet_host(unit) || exchange_events_pass(unit, &changed)) {
            return 1;
        }
        begin_host_step(unit);
        next[1] = changed;
        unit->stale = COMPUTED;
    }
    return 0;
}

/* Follow the vibration and the stops since the integrator's step before. */
static int complete_step(Unit *unit)
{
    Composite *c = unit->own;
    Clock *clock = &c->course->clock;
    if (unit_refresh(unit, OBSERVED)) {
        return 1;
    }
    verdict_follow(c, composite_speed_now(unit), unit->time - clock->begin);
    if (exchange_stops_follow(unit)) {
        return 1;
    }
    memcpy(c->at_begin, c->states, c->state_count * sizeof(double));
    begin_host_step(unit);
    clock->begin = unit->time;
    unit->stale = OBSERVED; /* what was read before is that of the step before */
    return 0;
}

static int call_on(Unit *unit, ExchangeCall call, double *values)
{
    int wrong = 0;
    switch (call) {
    case GET_DERIVATIVES:
        return find_derivatives(unit, values);
    case PASS_EVENTS:
        return pass_events(unit, values);
    case COMPLETE_STEP:
        return complete_step(unit);
    case GET_INDICATORS:
        return meet_host(unit) || exchange_events_look(unit, values);
    case ENTER_MODE:
        return 0;
    case SET_TIME:
        unit_go_to(unit, *values);
        break;
    default:
        wrong = unit_refresh(unit, call == SET_STATES ? COMPUTED : OBSERVED); /* begun, at least */
        if (!wrong) {
            states(unit, call, values);
        }
    }
    if (call >= SET_STATES && unit->stale < COMPUTED) {
        unit->stale = COMPUTED;
    }
    return wrong;
}

Status exchange_call(Unit *unit, const char *function, ExchangeCall call, double *values, size_t count)
{
    const size_t expected = call <= SET_STATES       ? exchange_count(unit)
                            : call == GET_INDICATORS ? exchange_indicators(unit)
                            : call == PASS_EVENTS    ? 2
                                                     : call == SET_TIME;
    size_t k;
    if (!unit->for_model_exchange) {
        return unit_refuse(unit, function, "the instance is for co-simulation");
    }
    if (count != expected) {
        return unit_refuse(unit, function, "there must be as many values as continuous states, or as "
                           "event indicators");
    }
    for (k = 0; k < count && (call == SET_STATES || call == SET_TIME); k++) {
        if (!is_finite(values[k])) {
            return unit_refuse(unit, function, "values must be finite numbers");
        }
    }
    return call_on(unit, call, values) ? unit_report(unit, STATUS_ERROR, function) : STATUS_OK;
}
