/* Iterated: step, compare the forces with those assumed, roll back and step again. */
#include <string.h>

#include "base/elementary.h"
#include "base/matrix.h"
#include "constants.h"
#include "coupling/composite.h"

static const double SLOW_BRIEF_CONVERGENCE = 0.5; /* as SLOW_CONVERGENCE, in steps across an event */
static const double HELD = 0.01; /* of the residual allowed */
enum { UNCONVERGED = 1 };

/* Residual of a loop that is solved. */
static double closed(const Course *course)
{
    return larger(CONVERGED_FORCES, GAIN_ROUNDING * course->loop.gain);
}

void iterated_allow(Composite *c, double residual)
{
    c->course->loop.tolerance = larger(residual, GAIN_ROUNDING * c->course->loop.gain);
    c->course->loop.largest = c->course->loop.rounding / c->course->loop.tolerance;
}

void iterated_begin(Composite *c)
{
    Course *course = c->course;
    course->loop.tolerance = closed(course);
    course->loop.largest =
        course->loop.rounding / (course->loop.corrections < 0.0 ? course->loop.tolerance : LOOSE_RESIDUAL);
}

/* A signal over a step that ends so. */
static void knot_continue(const Composite *c, const Knot *start, const Knot *end, double step, Complex *signal)
{
    if (c->course->adaptive.constant_signals > 0.0) {
        knot_held(end, signal);
    } else {
        knot_hermite(start, end, step, signal);
    }
}

/* Step all units once with forces that end at u. */
static int pass(Unit *unit, const double *u, double step)
{
    Composite *c = unit->own;
    int k;
    for (k = 0; k < c->unknowns; k++) {
        Knot end;
        loop_unpack(u + UNKNOWN_REALS * k, 1, step, &end);
        knot_continue(c, &c->forces[k].now, &end, step, c->sent + SIGNAL_ORDERS * k);
    }
    if (composite_rotor_pass(unit, c->sent, step)) {
        return 1;
    }
    for (k = 0; k < c->planes; k++) {
        knot_continue(c, &c->accelerations[k].now, c->ends + k, step, c->plane_signals + SIGNAL_ORDERS * k);
    }
    return composite_balancer_pass(unit, c->plane_signals, step);
}

/* Where signals are held only their values count. */
static void drop_slopes(const Composite *c, double *u)
{
    const int count = UNKNOWN_REALS * c->unknowns;
    int i;
    for (i = 0; i < count && c->course->adaptive.constant_signals > 0.0; i++) {
        u[i] = i % UNKNOWN_REALS < 2 ? u[i] : 0.0;
    }
}

void composite_restore(Composite *c)
{
    memcpy(c->states, c->at_begin, c->state_count * sizeof(double));
}

double iterated_attempt(Unit *unit, double step, int passes)
{
    Composite *c = unit->own;
    Course *course = c->course;
    const int count = UNKNOWN_REALS * c->unknowns, half = count / 2;
    /* what is left of a force makes a steep slope in a brief step */
    const double allowed = course->loop.tolerance;
    const double tolerance =
        course->event.steps_left > 0.0  ? smaller(allowed, closed(course))
        : course->adaptive.constant_signals > 0.0 ? larger(GAIN_ROUNDING * course->loop.gain, HELD * allowed)
                                      : allowed;
    /* in longer steps what brief ones learn of the slopes would be multiplied rounding */
    const double slow = course->event.steps_left > 0.0 ? SLOW_BRIEF_CONVERGENCE : SLOW_CONVERGENCE;
    double error = 0.0, error_before = 0.0;
    int number, i;
    course->loop.ahead = -1.0;
    loop_rescale(c, step);
    for (i = 0; i < c->unknowns; i++) {
        Complex assumed[SIGNAL_ORDERS];
        Knot ahead;
        if (course->adaptive.constant_signals > 0.0) {
            knot_held(&c->forces[i].now, assumed);
        } else if (signal_is_far(c->forces + i, step)) {
            knot_from_start(&c->forces[i].now, assumed);
        } else {
            signal_predicted(c->forces + i, assumed);
        }
        ahead = knot_end(assumed, step);
        loop_pack(&ahead, 1, step, c->u + UNKNOWN_REALS * i);
    }
    for (number = 1;; number++) {
        if (pass(unit, c->u, step)) {
            return -1.0;
        }
        loop_pack(c->answers, c->unknowns, step, c->g_u);
        drop_slopes(c, c->g_u);
        memcpy(c->old, c->residual, (size_t)count * sizeof(double));
        for (i = 0; i < count; i++) {
            c->residual[i] = c->g_u[i] - c->u[i];
        }
        /* of passes and steps that are taken back none counts: they can be far too large */
        course->loop.reached = larger(course->loop.largest, loop_size(c->g_u, half));
        error = course->loop.reached > 0.0 ? loop_size(c->residual, half) / course->loop.reached : 0.0;
        if (number > 1 && error > larger(tolerance, slow * error_before)) {
            loop_learn(c, c->du, c->old, c->residual);
        }
        if (number >= passes || !(error > tolerance)) {
            return error;
        }
        matrix_product(1, count, count, 1, c->solution, c->residual, c->du);
        error_before = error;
        for (i = 0; i < count; i++) {
            c->u[i] += c->du[i];
        }
        drop_slopes(c, c->u);
        composite_restore(c);
    }
}

/* 0, or 1 with the reason where what is left of the forces cannot be tolerated. */
int iterated_judge(Unit *unit)
{
    const Composite *c = unit->own;
    Course *course = c->course;
    const double residual = course->loop.residual;
    const int converges = course->loop.corrections < 0.0;
    char words[REASON_SIZE];
    Text forces = text_in(words, sizeof words);
    int k;
    if (!(residual > (converges ? course->loop.tolerance : LOOSE_RESIDUAL))) {
        return 0;
    }
    if (residual < 1.0 && !converges) {
        course->total.unconverged += 1.0;
        course->total.worst_left = larger(course->total.worst_left, residual);
        unit_warn_once(unit, UNCONVERGED, course->clock.time,
                       "a step left a residual above 1e-3 of the force: use smaller steps or more "
                       "corrections");
        return 0;
    }
    ((Composite *)unit->own)->loop_failed = true;
    for (k = 0; k < c->unknowns; k++) {
        text_put(&forces, k ? ", " : "");
        composite_name_signal(c, k, &forces);
    }
    return unit_fail(unit, "the loop did not converge at t = %6 s: %s still changes by %2 of the "
                     "largest force; use smaller steps or more corrections",
                     unit_host_time(unit, course->clock.time), words, residual);
}

int iterated_accept(Unit *unit, double step)
{
    Composite *c = unit->own;
    c->course->loop.largest = c->course->loop.reached;
    return composite_accept(unit, c->ends, c->answers, step);
}

static int respond_to_pass(Unit *unit, const double *u, double step, double *answer)
{
    Composite *c = unit->own;
    if (pass(unit, u, step)) {
        return 1;
    }
    composite_restore(c);
    loop_pack(c->answers, c->unknowns, step, answer);
    return 0;
}

/* The inverse for steps of this length, all of them taken back; an event within one: that of the
   start serves on. */
static int learn_anew(Unit *unit, double step)
{
    Composite *c = unit->own;
    const int count = UNKNOWN_REALS * c->unknowns, half = count / 2;
    double change;
    int wrong = respond_to_pass(unit, c->u, step, c->g_u);
    if (!wrong) {
        change = larger(larger(loop_size(c->u, half), loop_size(c->g_u, half)), c->course->loop.largest);
        wrong = loop_jacobian(unit, respond_to_pass, c->u, c->g_u, JACOBIAN_CHANGE * change, count, step, c->square);
    }
    if (wrong) {
        composite_restore(c);
        return c->course->loop.ahead < 0.0;
    }
    return loop_invert(unit, c->square, step);
}

int iterated_after_start(Unit *unit, double step)
{
    Composite *c = unit->own;
    const size_t states = c->state_count * sizeof(double), reals = c->real_count * sizeof(double);
    int k, wrong;
    for (k = 0; k < c->unknowns; k++) {
        Complex from_start[SIGNAL_ORDERS];
        Knot end;
        knot_from_start(&c->forces[k].now, from_start);
        end = knot_end(from_start, step);
        loop_pack(&end, 1, step, c->u + UNKNOWN_REALS * k);
    }
    /* the host may still ask for a time within the last step, or for outputs at its end */
    memcpy(c->at_end, c->at_begin, states);
    memcpy(c->saved_reals, c->parts->unit->real, reals);
    memcpy(c->at_begin, c->states, states);
    c->course->loop.ahead = -1.0;
    wrong = learn_anew(unit, step);
    memcpy(c->at_begin, c->at_end, states);
    memcpy(c->parts->unit->real, c->saved_reals, reals);
    return wrong;
}
