/* The step of the rotor's unit: matrices kept by speed and length of the step, and their use. */
#include <string.h>

#include "base/elementary.h"
#include "base/matrix.h"
#include "base/spin.h"
#include "units/rotor_unit.h"

/* The kept matrix that was asked for longest ago, or one never used. */
static Kept *oldest(Rotor *own)
{
    Kept *found = own->kept;
    int k;
    for (k = 1; k < KEPT_MATRICES && found->of.made; k++) {
        if (!own->kept[k].of.made || own->kept[k].last < found->last) {
            found = own->kept + k;
        }
    }
    return found;
}

/* Fail: the bearings' tables do not hold a speed. */
static int rotor_outside(Unit *unit, double speed)
{
    const Bearings *b = &((const Rotor *)unit->own)->rotor.bearings;
    return unit_fail(unit, "speed = %6 rad/s: must be %6 to %6 rad/s, the speeds of the bearings' table; "
                     "keep the speed within them, or give the table rows for this one",
                     speed, b->speeds[0], b->speeds[b->speed_count - 1]);
}

/* Step matrix by columns; NULL with the reason. */
static const double *rotor_matrix(Unit *unit, double speed, double step)
{
    Rotor *own = unit->own;
    LinearRotor loaded;
    Failure failure;
    Kept *kept;
    int k;
    own->clock++;
    for (k = 0; k < KEPT_MATRICES; k++) {
        kept = own->kept + k;
        if (kept->step == step && rotor_is_of(unit, &kept->of, speed)) {
            kept->last = own->clock;
            return kept->matrix;
        }
    }
    if (!linear_rotor_holds(&own->rotor, speed)) {
        rotor_outside(unit, speed);
        return NULL;
    }
    kept = oldest(own);
    loaded = rotor_anew(unit, &kept->of);
    if (step_matrix(&loaded, speed, step, own->turning, own->unsorted, own->matrix_scratch,
                    &failure)) {
        unit_failed(unit, &failure);
        return NULL;
    }
    matrix_transposed(own->parts, own->rows, own->columns, own->unsorted, kept->matrix);
    kept->step = step;
    kept->last = own->clock;
    rotor_made(unit, &kept->of, speed);
    return kept->matrix;
}

/* Of a line of the bearings' table. */
static int make_taylor_of(Unit *unit, int line)
{
    Rotor *own = unit->own;
    const Holds holds = rotor_holds(own);
    LinearRotor loaded;
    Failure failure;
    if (rotor_is_of(unit, &own->taylor_of, line)) {
        return 0;
    }
    loaded = rotor_anew(unit, &own->taylor_of);
    loaded.bearings.line = line;
    if (taylor_step_in(own->taylor_memory, &loaded, &holds, own->matrix_scratch, &own->taylor, &failure)) {
        return unit_failed(unit, &failure);
    }
    rotor_made(unit, &own->taylor_of, line);
    return 0;
}

int rotor_make_first_taylor(Unit *unit)
{
    const LinearRotor *rotor = &((const Rotor *)unit->own)->rotor;
    return make_taylor_of(unit, rotor->bearings.count ? linear_rotor_line(rotor, rotor_inputs(unit)[0], -1) : 0);
}

int rotor_make_taylor(Unit *unit)
{
    const double speed = rotor_inputs(unit)[0];
    return linear_rotor_holds(&((const Rotor *)unit->own)->rotor, speed) ? rotor_make_first_taylor(unit)
                                                                         : rotor_outside(unit, speed);
}

/* What moves the rotor from where the inputs were set, `ago` [s]. */
static Excitation excitation_since(Unit *unit, double ago)
{
    const Rotor *own = unit->own;
    const double *in = rotor_inputs(unit);
    const Spin start = spin_of(0.0, in[0], in + SPIN_UP);
    Excitation excitation;
    excitation.forces = in + SPUN;
    excitation.planes = own->planes;
    excitation.turning_force = own->turning;
    excitation.spin = start;
    excitation.spin.angle = unit->memory[REST] - spin_after(&start, ago).angle;
    return excitation;
}

/* Whether a step of this length ends at an event of a slider. */
static bool stops(const Unit *unit, double length)
{
    const Rotor *own = unit->own;
    const double shortest =
        own->slider_count || own->stop_count ? unit->real[rotor_shortest_stopped(unit)] : 0.0;
    return unit->may_end_early && shortest > 0.0 && length >= shortest;
}

/* What moves the rotor a time later [s]; its forces in `forces`. */
static Excitation excitation_later(const Excitation *now, double time, double *forces)
{
    const int count = 2 * now->planes;
    Excitation later = *now;
    int order, higher, k;
    for (k = 0; k < count; k++) {
        for (order = 0; order < SIGNAL_ORDERS; order++) {
            double power = 1.0, sum = 0.0;
            for (higher = order; higher < SIGNAL_ORDERS; higher++) {
                sum += now->forces[higher * count + k] * power;
                power *= time / (higher - order + 1);
            }
            forces[order * count + k] = sum;
        }
    }
    later.forces = forces;
    later.spin = spin_after(&now->spin, time);
    return later;
}

/* Time up to which the speed stays on its line of the bearings' table, at most `step` [s]. */
static double time_on_line(const LinearRotor *rotor, int line, const Spin *spin, double step)
{
    enum { ROW_LOOKS = 16, ROW_HALVINGS = 60 };
    const Bearings *b = &rotor->bearings;
    const double low = line > 0 ? b->speeds[line] : -infinity();
    const double high = line < b->speed_count - 2 ? b->speeds[line + 1] : infinity();
    int look, k;
    for (look = 1; look <= ROW_LOOKS; look++) {
        double inside = step * (look - 1) / ROW_LOOKS, outside = step * look / ROW_LOOKS, speed = spin_after(spin, outside).speed;
        if (low <= speed && speed <= high) {
            continue;
        }
        for (k = 0; k < ROW_HALVINGS; k++) {
            const double middle = 0.5 * (inside + outside);
            speed = spin_after(spin, middle).speed;
            if (low <= speed && speed <= high) {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        return outside;
    }
    return step;
}

/* From row to row of the bearings' table. */
static int advance_over_rows(Unit *unit, double *state, double *slider_states, double step)
{
    enum { MOST_ROWS = 1000 };
    Rotor *own = unit->own;
    const LinearRotor *rotor = &own->rotor;
    const Excitation first = excitation_since(unit, 0.0);
    Failure failure;
    double done = 0.0;
    int rows;
    for (rows = 0; rows < MOST_ROWS; rows++) {
        const Excitation now = excitation_later(&first, done, own->later_forces);
        const double ahead = spin_after(&now.spin, 1e-6 * (step - done)).speed;
        const int line = linear_rotor_line(rotor, ahead, -1);
        const double part = time_on_line(rotor, line, &now.spin, step - done);
        if (!linear_rotor_holds(rotor, now.spin.speed)) {
            return rotor_outside(unit, now.spin.speed);
        }
        if (make_taylor_of(unit, line)) {
            return 1;
        }
        if (taylor_advance(&own->taylor, state, slider_states, &now, part, stops(unit, step), &own->reached, &failure)) {
            return unit_failed(unit, &failure);
        }
        done += own->reached;
        if (own->reached < part || done >= step) {
            own->reached = done < step ? done : step;
            return 0;
        }
    }
    return unit_fail(unit, "the speed passes more than %u rows of the bearings' table in a step", (unsigned long)MOST_ROWS);
}

/* `rotor_propagate` by Taylor series, sliders in own->slider_states. */
static int propagate_series(Unit *unit, double step)
{
    Rotor *own = unit->own;
    const size_t motion = 4 * (size_t)own->stations;
    const Excitation excitation = excitation_since(unit, 0.0);
    double *state = own->result, *slider_states = own->slider_states;
    Failure failure;
    int code = FINE;
    if (rotor_make_taylor(unit)) {
        return 1;
    }
    copy_doubles(motion, unit->memory + MOTION, state);
    if (!unit->frozen) {
        copy_doubles(holds_doubles(&own->taylor.holds), rotor_slider_states(unit), slider_states);
        if (step != 0.0 && own->rotor.bearings.count) {
            if (advance_over_rows(unit, state, slider_states, step)) {
                return 1;
            }
        } else {
            code = step != 0.0
                       ? taylor_advance(&own->taylor, state, slider_states, &excitation, step,
                                        stops(unit, step), &own->reached, &failure)
                       : taylor_resolve(&own->taylor, state, slider_states, &excitation, 0.0, &failure);
        }
    }
    if (code || taylor_plane_motion(&own->taylor, state, slider_states, &excitation, own->reached,
                                    state + motion, &failure)) {
        return unit_failed(unit, &failure);
    }
    return 0;
}

/* Derivatives of the displacements at the present time, of order 1 to 3, in own->motion; how the rotor
   turns. */
static int find_motion(Unit *unit, Spin *spin)
{
    Rotor *own = unit->own;
    const double *state = unit->memory + MOTION, ago = state[4 * own->stations + 1];
    const Excitation excitation = excitation_since(unit, ago);
    Failure failure;
    int code = FINE;
    *spin = spin_after(&excitation.spin, ago);
    if (rotor_make_taylor(unit)) {
        return 1;
    }
    if (!unit->frozen) {
        copy_doubles(holds_doubles(&own->taylor.holds), rotor_slider_states(unit), own->slider_states);
        code = ago == 0.0 ? taylor_resolve(&own->taylor, state, own->slider_states, &excitation,
                                           0.0, &failure)
                          : FINE;
    }
    if (code || taylor_motion(&own->taylor, state, own->slider_states, &excitation, ago,
                              own->motion, &failure)) {
        return unit_failed(unit, &failure);
    }
    return 0;
}

int rotor_torque_now(Unit *unit, double *torque)
{
    const Rotor *own = unit->own;
    Spin spin;
    if (find_motion(unit, &spin)) {
        return 1;
    }
    linear_rotor_torque(&own->rotor, unit->memory + MOTION, own->motion, &spin, torque);
    return 0;
}

void rotor_rotated(const double *pairs, size_t count, double c, double s, double *to)
{
    size_t k;
    for (k = 0; k < 2 * count; k += 2) {
        const double x = pairs[k], y = pairs[k + 1];
        to[k] = x * c - y * s;
        to[k + 1] = x * s + y * c;
    }
}

/* own->result = matrix own->operand. */
static void rotor_apply(Rotor *own, const double *matrix)
{
    const int rows = own->rows, columns = own->columns;
    int i, k;
    if (own->axes == 1) {
        fill_doubles(2 * (size_t)rows, 0.0, own->result);
        add_multiples(2, rows, columns, own->operand, matrix, 2 * (size_t)rows, own->result);
        return;
    }
    for (i = 0; i < rows; i += 4) { /* two axes: 4 rows a station and plane */
        const double *m = matrix + i;
        double a = 0.0, b = 0.0, c = 0.0, d = 0.0;
        for (k = 0; k < columns; k++, m += rows) {
            const double factor = own->operand[k];
            a += factor * m[0];
            b += factor * m[1];
            c += factor * m[2];
            d += factor * m[3];
        }
        own->result[i] = a;
        own->result[i + 1] = b;
        own->result[i + 2] = c;
        own->result[i + 3] = d;
    }
}

/* State, forces and turn that a step begins with, in own->operand, less the sag; 1 with the reason. */
static int set_operand(Unit *unit)
{
    Rotor *own = unit->own;
    const size_t p = (size_t)own->planes, forces = 4 * (size_t)own->stations;
    const size_t turn = forces + 2 * SIGNAL_ORDERS * p;
    const Complex turned = turned_by(own->turned, unit->memory[REST]);
    copy_doubles(forces, unit->memory + MOTION, own->operand);
    if (own->turning) {
        rotor_rotated(rotor_inputs(unit) + SPUN, SIGNAL_ORDERS * p, turned.re, turned.im,
                      own->operand + forces);
    } else {
        copy_doubles(turn - forces, rotor_inputs(unit) + SPUN, own->operand + forces);
    }
    own->operand[turn] = turned.re;
    own->operand[turn + 1] = turned.im;
    return linear_rotor_heavy(&own->rotor) && rotor_lift(unit);
}

/* `rotor_propagate`, the acceleration with gravity's. */
static int propagate(Unit *unit, double step)
{
    Rotor *own = unit->own;
    const double *matrix;
    if (own->rotor.sliders || unit->for_model_exchange || rotor_inputs(unit)[SPIN_UP] != 0.0 ||
        drifts(rotor_inputs(unit) + SPIN_UP)) {
        return propagate_series(unit, step);
    }
    if (set_operand(unit)) {
        return 1;
    }
    matrix = rotor_matrix(unit, rotor_inputs(unit)[0], step);
    if (!matrix) {
        return 1;
    }
    rotor_apply(own, matrix);
    return 0;
}

int rotor_propagate(Unit *unit, double step)
{
    Rotor *own = unit->own;
    own->lifted = false;
    own->reached = step;
    if (propagate(unit, step)) {
        return 1;
    }
    if (linear_rotor_heavy(&own->rotor)) {
        rotor_lower(own);
    }
    return 0;
}

void rotor_put(Rotor *own, const double *planes, double angle, double speed, double *out)
{
    const size_t n = 2 * (size_t)own->planes;
    size_t k;
    copy_doubles(2 * n, planes, out);
    if (own->turning) {
        const Complex turned = turned_by(own->turned, angle);
        /* (a e^{-i beta})' = (j - i w a) e^{-i beta} */
        for (k = 0; k < n; k += 2) {
            out[n + k] += speed * out[k + 1];
            out[n + k + 1] -= speed * out[k];
        }
        rotor_rotated(out, n, turned.re, -turned.im, out);
    }
}

int rotor_outputs_now(Unit *unit, double *out)
{
    Rotor *own = unit->own;
    if (rotor_propagate(unit, 0.0)) {
        return 1;
    }
    rotor_put(own, own->result + 4 * own->stations, unit->memory[REST], rotor_inputs(unit)[0], out);
    return 0;
}
