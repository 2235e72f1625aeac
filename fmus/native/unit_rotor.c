/* The rotor on its supports as a unit: forces on its planes in, accelerations of the planes out; twin
   of fmus/rotor.py, with the parameters of its kinds from fmus/rotor_*.py. */
#include <string.h>

#include "elementary.h"
#include "linear_rotor.h"
#include "matrix.h"
#include "propagator.h"
#include "signals.h"
#include "unit.h"
#include "variable_speed.h"

enum { PLANAR, TWO_SUPPORT, FLEXIBLE };

/* Step matrices an instance keeps: a master that repeats steps asks for few. */
enum { KEPT_MATRICES = 8 };

/* In memory: the angle, then displacements and velocities of the stations, x and y alternating, then
   the speed the outputs belong to. */
enum { TURNS, REST, CARRY, MOTION };

static const double TURN_ROUNDING = 2.4492935982947064e-16; /* 2 pi minus its floating-point value */
static const double SPACING = 0.1; /* m, between the stations of a shaft nobody has described yet */
static const double STEEL_20_MM = 1.6e3; /* N m^2, E I of a steel shaft of 20 mm */
static const double SPAN = 0.8;          /* m, of a rotor on two supports, as declared */
static const double UNBALANCE = 2.0e-4;  /* kg m */
static const double ONTO = 1e-9; /* of the shaft's length: a place this near to a station is it */

/* A step matrix with x and y alternating in rows and columns, and what it is of. */
typedef struct {
    int used;
    uint64_t last; /* when it was asked for */
    double speed, step;
    double *added_mass; /* (p,) */
    double *matrix;
} Kept;

typedef struct {
    int kind, stations, planes, unbalances, turning;
    LinearRotor rotor;
    int axes, parts; /* as in propagator.h */
    int rows, columns; /* of a step matrix, in elements */
    double *rotor_memory, *loaded_mass;
    double *values; /* scratch for making the rotor */
    int *ports;
    Kept kept[KEPT_MATRICES];
    uint64_t clock;
    double *unsorted, *matrix_scratch;
    double *operand, *result; /* of a step matrix */
    VariableSpeedStep variable;
    int variable_made;
    double *variable_mass, *variable_memory, *variable_scratch; /* (p,) and its own */
    double *forces, *state, *acceleration, *jerk;
    double *ends[4]; /* outputs at other speeds, for derivatives */
} Own;

/* -- sizes ----------------------------------------------------------------------------------------- */

static int kind_of(const Layout *layout)
{
    const char *kind = layout->table->kind;
    return text_equal(kind, "planar") ? PLANAR : text_equal(kind, "flexible") ? FLEXIBLE
                                                                              : TWO_SUPPORT;
}

static size_t memory_size(const Layout *layout)
{
    return MOTION + 4 * (size_t)layout->sizes.stations + 1;
}

static size_t own_size(void)
{
    return sizeof(Own);
}

/* Displacement at j by a unit force at k of a uniform shaft supported at its ends. */
static double start_compliance(const double *z, size_t step, int j, int k, int last)
{
    const double zj = z[step * (size_t)j], zk = z[step * (size_t)k];
    const double zp = z[0], zq = z[step * (size_t)last];
    const double points[2][3] = {{zj, zp, zq}, {zk, zp, zq}};
    double share[2][3], sum = 0.0;
    int a, b;
    for (a = 0; a < 2; a++) {
        const double along = (points[a][0] - zp) / (zq - zp);
        share[a][0] = 1.0;
        share[a][1] = -(1.0 - along);
        share[a][2] = -along;
    }
    for (a = 0; a < 3; a++) {
        for (b = 0; b < 3; b++) {
            const double far = absolute(points[0][a] - points[1][b]);
            sum += share[0][a] * share[1][b] * (far * far * far);
        }
    }
    return sum / (12.0 * STEEL_20_MM);
}

static void flexible_starts(const Layout *layout, double *real)
{
    const int n = layout->sizes.stations;
    const size_t z = layout_index(layout, "station[#].z", 1);
    const size_t compliance = layout_index(layout, "compliance[#,#]", 1);
    size_t at = compliance;
    int j, k;
    for (j = 0; j < n; j++) {
        real[z + 2 * (size_t)j] = SPACING * j;
    }
    real[layout_index(layout, "support[2].position", 1)] = SPACING * (n - 1);
    for (j = 0; j < layout->sizes.planes; j++) {
        real[layout_index(layout, "plane[#].position", 1) + (size_t)j] =
            SPACING * ((j + n / 2) % n);
    }
    for (j = 0; j < layout->sizes.unbalances; j++) {
        real[layout_index(layout, "unbalance[#].position", 1) + 3 * (size_t)j] = SPACING * (n / 2);
    }
    if (compliance < layout->real_count) {
        for (j = 1; j < n - 1; j++) {
            for (k = j; k < n - 1; k++) {
                real[at++] = start_compliance(real + z, 2, j, k, n - 1);
            }
        }
    }
}

static void starts(const Layout *layout, double *real)
{
    const int kind = kind_of(layout), planes = layout->sizes.planes;
    size_t amount;
    int j;
    if (kind == PLANAR) {
        return;
    }
    amount = layout_index(layout, "unbalance[#].amount", 1);
    for (j = 0; j < layout->sizes.unbalances; j++) {
        real[amount + 3 * (size_t)j] = j ? 0.0 : UNBALANCE;
    }
    if (kind == FLEXIBLE) {
        flexible_starts(layout, real);
        return;
    }
    for (j = 0; j < planes; j++) {
        real[layout_index(layout, "plane[#].position", 1) + (size_t)j] =
            SPAN * (j + 1) / (planes + 1);
    }
    for (j = 0; j < layout->sizes.unbalances; j++) {
        real[amount - 1 + 3 * (size_t)j] = SPAN / (planes + 1);
    }
}

static double *doubles(Unit *unit, size_t count)
{
    return unit_allocate(unit, count, sizeof(double));
}

/* The larger of a size for one axis and for two. */
static size_t larger_of(size_t (*size)(int, int, int), int n, int p)
{
    const size_t one = size(n, p, 1), two = size(n, p, 2);
    return one > two ? one : two;
}

static size_t matrix_doubles(int n, int p, int axes)
{
    return (size_t)step_matrix_rows(n, p, axes) * (size_t)step_matrix_columns(n, p, axes) *
           (axes == 1 ? 2 : 1);
}

static int allocate(Unit *unit)
{
    Own *own = unit->own;
    const Sizes *sizes = &unit->layout.sizes;
    const int n = sizes->stations, p = sizes->planes;
    const size_t stations = (size_t)n, planes = (size_t)p, free = n > 2 ? stations - 2 : 0;
    const size_t matrix = larger_of(matrix_doubles, n, p);
    int k, missing = 0;
    own->kind = kind_of(&unit->layout);
    own->stations = n;
    own->planes = p;
    own->unbalances = sizes->unbalances;
    own->turning = !sizes->fixed_frame;
    own->rotor_memory = doubles(unit, linear_rotor_size(n, p));
    own->loaded_mass = doubles(unit, stations * stations);
    own->values = doubles(unit, 2 * stations + 3 * (size_t)sizes->unbalances + free * free +
                                    linear_rotor_flexible_scratch(n));
    own->ports = unit_allocate(unit, planes, sizeof(int));
    own->unsorted = doubles(unit, matrix);
    own->matrix_scratch = doubles(unit, larger_of(step_matrix_scratch, n, p));
    own->operand = doubles(unit, 4 * stations + 2 * SIGNAL_ORDERS * planes + 2);
    own->result = doubles(unit, 4 * stations + 4 * planes);
    own->variable_mass = doubles(unit, planes);
    own->variable_memory = doubles(unit, larger_of(variable_speed_size, n, p));
    own->variable_scratch = doubles(unit, larger_of(variable_speed_scratch, n, p));
    own->forces = doubles(unit, 2 * SIGNAL_ORDERS * planes);
    own->state = doubles(unit, 4 * stations);
    own->acceleration = doubles(unit, 2 * planes);
    own->jerk = doubles(unit, 2 * planes);
    for (k = 0; k < KEPT_MATRICES; k++) {
        own->kept[k].added_mass = doubles(unit, planes);
        own->kept[k].matrix = doubles(unit, matrix);
        missing |= !own->kept[k].added_mass || !own->kept[k].matrix;
    }
    for (k = 0; k < 4; k++) {
        own->ends[k] = doubles(unit, 4 * planes);
        missing |= !own->ends[k];
    }
    return missing || !own->rotor_memory || !own->loaded_mass || !own->values || !own->ports ||
           !own->unsorted || !own->matrix_scratch || !own->operand || !own->result ||
           !own->variable_mass || !own->variable_memory || !own->variable_scratch ||
           !own->forces || !own->state || !own->acceleration || !own->jerk;
}

/* -- parameters ------------------------------------------------------------------------------------ */

static int planar(Unit *unit)
{
    Own *own = unit->own;
    const double *real = unit->real;
    Planar values;
    Failure failure;
    values.mass = real[0];
    values.stiffness[0] = real[1];
    values.stiffness[1] = real[2];
    values.damping[0] = real[3];
    values.damping[1] = real[4];
    values.internal_damping = real[5];
    values.unbalance = real[6];
    values.unbalance_angle = real[7];
    if (linear_rotor_planar(&values, &own->rotor, &failure)) {
        return unit_failed(unit, &failure, NULL, 0);
    }
    return 0;
}

/* Stiffness and damping of both supports, from the first of them on: x, y, x, y each. */
static void support_values(const double *real, double *stiffness, double *damping)
{
    int s, axis;
    for (s = 0; s < 2; s++) {
        for (axis = 0; axis < 2; axis++) {
            stiffness[2 * s + axis] = real[4 * s + axis];
            damping[2 * s + axis] = real[4 * s + 2 + axis];
        }
    }
}

static int two_support(Unit *unit)
{
    Own *own = unit->own;
    const double *real = unit->real;
    TwoSupport values;
    Failure failure;
    values.mass = real[0];
    values.inertia = real[1];
    values.polar_inertia = real[2];
    values.span = real[3];
    values.com = real[4];
    support_values(real + 5, values.stiffness, values.damping);
    values.planes = real + 13;
    values.unbalance_count = own->unbalances;
    values.unbalances = real + 13 + own->planes;
    if (linear_rotor_two_support(&values, &own->rotor, &failure)) {
        return unit_failed(unit, &failure, NULL, 0);
    }
    return 0;
}

/* Index of the station at a place; -1 when there is none, with the reason. */
static int station_at(Unit *unit, const double *z, size_t reference)
{
    const int n = ((const Own *)unit->own)->stations;
    const double place = unit->real[reference];
    int nearest = 0, j;
    for (j = 1; j < n; j++) {
        if (absolute(z[j] - place) < absolute(z[nearest] - place)) {
            nearest = j;
        }
    }
    if (!(absolute(z[nearest] - place) <= ONTO * absolute(z[n - 1] - z[0]))) {
        Text *reason = unit_reason(unit);
        layout_shown(&unit->layout, reference, place, reason);
        text_put(reason, ": must be the place of a station, one of ");
        text_list(reason, z, (size_t)n);
        text_put(reason, " m");
        return -1;
    }
    return nearest;
}

/* The compliance (n - 2, n - 2) from its upper triangle. */
static void symmetric(const double *triangle, int size, double *compliance)
{
    int j, k;
    for (j = 0; j < size; j++) {
        for (k = j; k < size; k++) {
            compliance[j * size + k] = compliance[k * size + j] = *triangle++;
        }
    }
}

static int flexible(Unit *unit)
{
    Own *own = unit->own;
    const int n = own->stations, bent = n - 2;
    const int given = text_equal(unit->layout.table->shaft, "compliance");
    const size_t supports = 2 * (size_t)n, shaft = supports + 10;
    const size_t damping = shaft + (given ? (size_t)(bent * (bent + 1) / 2) : 1);
    const size_t ports = damping + 1, unbalances = ports + (size_t)own->planes;
    const double *real = unit->real;
    double *z = own->values, *masses = z + n, *kept = masses + n;
    double *compliance = kept + 3 * own->unbalances, *scratch = compliance + bent * bent;
    Flexible values;
    Failure failure;
    int j, misplaced = -1;
    for (j = 0; j < n; j++) {
        z[j] = real[2 * j];
        masses[j] = real[2 * j + 1];
    }
    for (j = 0; j < 2; j++) {
        const int station = station_at(unit, z, supports + (size_t)j);
        if (station < 0) {
            return 1;
        }
        values.supports[j] = station + 1;
    }
    support_values(real + supports + 2, values.support_stiffness, values.support_damping);
    symmetric(real + shaft, given ? bent : 0, compliance);
    values.stations = z;
    values.masses = masses;
    values.bending_stiffness = real[shaft];
    values.compliance = given ? compliance : NULL;
    values.internal_damping = real[damping];
    values.unbalance_count = 0;
    values.unbalances = kept;
    values.ports = own->ports;
    for (j = 0; j < own->unbalances; j++) {
        const double *unbalance = real + unbalances + 3 * (size_t)j;
        /* one without amount may keep its default place, where there is no station */
        if (unbalance[1] != 0.0) {
            memcpy(kept + 3 * values.unbalance_count++, unbalance, 3 * sizeof(double));
        }
    }
    for (j = own->planes - 1; j >= 0; j--) {
        own->ports[j] = station_at(unit, z, ports + (size_t)j);
        if (own->ports[j] < 0) {
            own->ports[j] = 0;
            misplaced = j;
        }
    }
    if (linear_rotor_flexible(&values, &own->rotor, scratch, &failure)) {
        return failure.code == FAILURE_NOT_ELASTIC
                   ? unit_failed(unit, &failure, scratch, (size_t)(bent * bent))
                   : unit_failed(unit, &failure, z, (size_t)n);
    }
    return misplaced >= 0; /* the reason is that of the first one */
}

static int parameters(Unit *unit)
{
    Own *own = unit->own;
    int k, wrong;
    own->rotor = linear_rotor_in(own->rotor_memory, own->stations, own->planes);
    wrong = own->kind == PLANAR        ? planar(unit)
            : own->kind == TWO_SUPPORT ? two_support(unit)
                                       : flexible(unit);
    if (wrong) {
        return 1;
    }
    own->axes = linear_rotor_isotropic(&own->rotor) ? 1 : 2;
    own->parts = 3 - own->axes;
    own->rows = step_matrix_rows(own->stations, own->planes, own->axes);
    own->columns = step_matrix_columns(own->stations, own->planes, own->axes);
    for (k = 0; k < KEPT_MATRICES; k++) {
        own->kept[k].used = 0;
    }
    own->variable_made = 0;
    return 0;
}

/* -- the angle ------------------------------------------------------------------------------------- */

/* The angle (turns, remainder, carry) turned by `by` [rad]; Kahan's summation. */
static void turn_by(double *angle, double by)
{
    double turns = angle[TURNS], carry = angle[CARRY], total;
    const double rest = angle[REST];
    if (absolute(by) > PI) {
        const double part = ieee_remainder(by, TAU), whole = nearest((by - part) / TAU);
        by = part;
        turns += whole;
        carry += whole * TURN_ROUNDING;
    }
    by -= carry;
    total = rest + by;
    carry = (total - rest) - by;
    if (total > PI) {
        total -= TAU;
        turns += 1.0;
        carry += TURN_ROUNDING;
    } else if (total < -PI) {
        total += TAU;
        turns -= 1.0;
        carry -= TURN_ROUNDING;
    }
    angle[TURNS] = turns;
    angle[REST] = total;
    angle[CARRY] = carry;
}

/* Vectors (x, y alternating) turned by the angle with this cosine and sine. */
static void rotated(double *pairs, size_t count, double c, double s)
{
    size_t k;
    for (k = 0; k < 2 * count; k += 2) {
        const double x = pairs[k], y = pairs[k + 1];
        pairs[k] = x * c - y * s;
        pairs[k + 1] = x * s + y * c;
    }
}

static int begin(Unit *unit)
{
    const Own *own = unit->own;
    const size_t motion = 4 * (size_t)own->stations;
    const double *start = unit->real + unit->layout.parameters.count - motion;
    memset(unit->memory, 0, MOTION * sizeof(double));
    turn_by(unit->memory, start[-1]);
    memcpy(unit->memory + MOTION, start, motion * sizeof(double));
    return 0;
}

/* -- the step -------------------------------------------------------------------------------------- */

/* Inputs: added masses, then speed and acceleration, then forces. */
static const double *added_masses(const Unit *unit)
{
    return unit->real + unit->layout.inputs.first;
}

static double *drive(Unit *unit)
{
    return unit->real + unit->layout.inputs.first + ((const Own *)unit->own)->planes;
}

/* Where the k-th element of blocks with x and y alternating stands when every block is (x..., y...);
   `ends` are where the blocks end, in pairs. */
static int alternating(const int *ends, int k)
{
    int block = 0, first, size;
    while (k / 2 >= ends[block]) {
        block++;
    }
    first = block ? ends[block - 1] : 0;
    size = ends[block] - first;
    return 2 * first + (k / 2 - first) + (k % 2) * size;
}

static void sort_matrix(const Own *own, const double *from, double *to)
{
    const int n = own->stations, p = own->planes;
    const int rows[4] = {n, 2 * n, 2 * n + p, 2 * n + 2 * p};
    const int columns[7] = {n,
                            2 * n,
                            2 * n + p,
                            2 * n + 2 * p,
                            2 * n + 3 * p,
                            2 * n + 4 * p,
                            2 * n + 4 * p + 1};
    int j, k;
    for (j = 0; j < own->rows; j++) {
        const double *row = from + (size_t)alternating(rows, j) * (size_t)own->columns;
        for (k = 0; k < own->columns; k++) {
            *to++ = row[alternating(columns, k)];
        }
    }
}

/* The kept matrix that was asked for longest ago, or one never used. */
static Kept *oldest(Own *own)
{
    Kept *found = own->kept;
    int k;
    for (k = 1; k < KEPT_MATRICES && found->used; k++) {
        if (!own->kept[k].used || own->kept[k].last < found->last) {
            found = own->kept + k;
        }
    }
    return found;
}

/* Step matrix with x and y alternating in rows and columns; NULL with the reason. */
static const double *matrix_of(Unit *unit, double speed, double step)
{
    Own *own = unit->own;
    const size_t size = (size_t)own->planes * sizeof(double);
    const double *masses = added_masses(unit);
    LinearRotor loaded;
    Failure failure;
    Kept *kept;
    int k;
    own->clock++;
    for (k = 0; k < KEPT_MATRICES; k++) {
        kept = own->kept + k;
        if (kept->used && kept->speed == speed && kept->step == step &&
            !memcmp(kept->added_mass, masses, size)) {
            kept->last = own->clock;
            return kept->matrix;
        }
    }
    kept = oldest(own);
    kept->used = 0;
    loaded = linear_rotor_with_added_mass(&own->rotor, masses, own->loaded_mass);
    if (step_matrix(&loaded, speed, step, own->turning,
                    own->axes == 1 ? kept->matrix : own->unsorted, own->matrix_scratch,
                    &failure)) {
        unit_failed(unit, &failure, NULL, 0);
        return NULL;
    }
    if (own->axes == 2) {
        sort_matrix(own, own->unsorted, kept->matrix);
    }
    memcpy(kept->added_mass, masses, size);
    kept->speed = speed;
    kept->step = step;
    kept->last = own->clock;
    kept->used = 1;
    return kept->matrix;
}

/* (x..., y...) a block from x and y alternating, or back; nothing changes for complex numbers. */
static void to_axes(const double *pairs, int axes, int blocks, int size, double *values)
{
    int b, k;
    for (b = 0; b < blocks; b++, pairs += 2 * size, values += 2 * size) {
        for (k = 0; k < size; k++) {
            values[axes == 1 ? 2 * k : k] = pairs[2 * k];
            values[axes == 1 ? 2 * k + 1 : size + k] = pairs[2 * k + 1];
        }
    }
}

static void from_axes(const double *values, int axes, int blocks, int size, double *pairs)
{
    int b, k;
    for (b = 0; b < blocks; b++, pairs += 2 * size, values += 2 * size) {
        for (k = 0; k < size; k++) {
            pairs[2 * k] = values[axes == 1 ? 2 * k : k];
            pairs[2 * k + 1] = values[axes == 1 ? 2 * k + 1 : size + k];
        }
    }
}

static int make_variable(Unit *unit)
{
    Own *own = unit->own;
    const size_t size = (size_t)own->planes * sizeof(double);
    const double *masses = added_masses(unit);
    LinearRotor loaded;
    Failure failure;
    if (own->variable_made && !memcmp(own->variable_mass, masses, size)) {
        return 0;
    }
    own->variable_made = 0;
    loaded = linear_rotor_with_added_mass(&own->rotor, masses, own->loaded_mass);
    if (variable_speed_step(&loaded, own->turning, own->variable_memory, own->variable_scratch,
                            &own->variable, &failure)) {
        return unit_failed(unit, &failure, NULL, 0);
    }
    memcpy(own->variable_mass, masses, size);
    own->variable_made = 1;
    return 0;
}

/* Motion of the stations, and acceleration and jerk of the planes, after `step` [s], in
   own->result; all in fixed axes, x and y alternating. */
static int propagate_variable(Unit *unit, double step)
{
    Own *own = unit->own;
    const int n = own->stations, p = own->planes;
    const double speed = drive(unit)[0], spin_up = drive(unit)[1], angle = unit->memory[REST];
    const double *forces = drive(unit) + 2;
    double *planes = own->result + 4 * n;
    Failure failure;
    if (make_variable(unit)) {
        return 1;
    }
    to_axes(unit->memory + MOTION, own->axes, 2, n, own->state);
    if (step != 0.0 &&
        variable_speed_advance(&own->variable, own->state, forces, angle, speed, spin_up, step,
                               own->variable_scratch, &failure)) {
        return unit_failed(unit, &failure, NULL, 0);
    }
    variable_speed_plane_motion(&own->variable, own->state, forces, angle, speed, spin_up, step,
                                own->acceleration, own->jerk, own->variable_scratch);
    from_axes(own->state, own->axes, 2, n, own->result);
    from_axes(own->acceleration, own->axes, 1, p, planes);
    from_axes(own->jerk, own->axes, 1, p, planes + 2 * p);
    return 0;
}

static int propagate(Unit *unit, double step)
{
    Own *own = unit->own;
    const size_t n = (size_t)own->stations, p = (size_t)own->planes;
    const size_t forces = 4 * n, turn = forces + 2 * SIGNAL_ORDERS * p;
    const double c = cosine(unit->memory[REST]), s = sine(unit->memory[REST]);
    const double *matrix;
    if (drive(unit)[1] != 0.0) {
        return propagate_variable(unit, step);
    }
    matrix = matrix_of(unit, drive(unit)[0], step);
    if (!matrix) {
        return 1;
    }
    memcpy(own->operand, unit->memory + MOTION, forces * sizeof(double));
    memcpy(own->operand + forces, drive(unit) + 2, (turn - forces) * sizeof(double));
    if (own->turning) {
        rotated(own->operand + forces, SIGNAL_ORDERS * p, c, s);
    }
    own->operand[turn] = c;
    own->operand[turn + 1] = s;
    matrix_product(own->parts, own->rows, own->columns, 1, matrix, own->operand, own->result);
    return 0;
}

/* Computed outputs from acceleration and jerk of the planes in fixed axes. */
static void put(const Own *own, const double *planes, double angle, double speed, double *out)
{
    const size_t n = 2 * (size_t)own->planes;
    size_t k;
    memcpy(out, planes, 2 * n * sizeof(double));
    if (own->turning) {
        /* (a e^{-i beta})' = (j - i w a) e^{-i beta} */
        for (k = 0; k < n; k += 2) {
            out[n + k] += speed * out[k + 1];
            out[n + k + 1] -= speed * out[k];
        }
        rotated(out, n, cosine(angle), -sine(angle));
    }
}

static int step(Unit *unit, double length)
{
    Own *own = unit->own;
    const double speed = drive(unit)[0], spin_up = drive(unit)[1];
    const size_t motion = 4 * (size_t)own->stations;
    double *end_speed = unit->memory + MOTION + motion;
    if (propagate(unit, length)) {
        return 1;
    }
    turn_by(unit->memory, length * (speed + 0.5 * spin_up * length));
    memcpy(unit->memory + MOTION, own->result, motion * sizeof(double));
    *end_speed = speed + spin_up * length;
    put(own, own->result + motion, unit->memory[REST], *end_speed,
        unit->real + unit->layout.computed.first);
    return 0;
}

/* The computed outputs as they are with the present inputs. */
static int outputs_now(Unit *unit, double *out)
{
    const Own *own = unit->own;
    if (propagate(unit, 0.0)) {
        return 1;
    }
    put(own, own->result + 4 * own->stations, unit->memory[REST], drive(unit)[0], out);
    return 0;
}

static int outputs(Unit *unit)
{
    const Own *own = unit->own;
    unit->memory[MOTION + 4 * own->stations] = drive(unit)[0];
    return outputs_now(unit, unit->real + unit->layout.computed.first);
}

/* Rows of a matrix (count, n) times vectors (x, y alternating). */
static void vectors_at(const double *rows, int count, int n, const double *vectors, double *result)
{
    int i, j;
    for (i = 0; i < count; i++, result += 2) {
        result[0] = result[1] = 0.0;
        for (j = 0; j < n; j++) {
            result[0] += rows[i * n + j] * vectors[2 * j];
            result[1] += rows[i * n + j] * vectors[2 * j + 1];
        }
    }
}

static double largest_bending(const Own *own, const double *stations)
{
    const LinearRotor *rotor = &own->rotor;
    double largest = 0.0;
    int i;
    for (i = 0; i < rotor->deflections; i++) {
        double bending[2];
        vectors_at(rotor->deflection + i * own->stations, 1, own->stations, stations, bending);
        largest = larger(largest, hypotenuse(bending[0], bending[1]));
    }
    return largest;
}

static void observe(Unit *unit)
{
    const Own *own = unit->own;
    const double *memory = unit->memory, *motion = memory + MOTION;
    const size_t count = 4 * (size_t)own->stations;
    double *out = unit->real + unit->layout.observed.first;
    out[0] = memory[TURNS] * TAU +
             (memory[REST] + (memory[TURNS] * TURN_ROUNDING - memory[CARRY]));
    memcpy(out + 1, motion, count * sizeof(double));
    out += 1 + count;
    vectors_at(own->rotor.planes, own->planes, own->stations, motion, out);
    out[2 * own->planes] = largest_bending(own, motion);
}

static size_t signals(const Layout *layout, size_t *first)
{
    *first = layout->inputs.first + (size_t)layout->sizes.planes + 2;
    return 2 * (size_t)layout->sizes.planes;
}

/* -- derivatives ----------------------------------------------------------------------------------- */

/* Change of the computed outputs by a change of the forces' values and slopes, (2p,) each. */
static int force_response(Unit *unit, const double *values, const double *slopes, double *change)
{
    Own *own = unit->own;
    const size_t n = (size_t)own->stations, p = (size_t)own->planes;
    const double c = cosine(unit->memory[REST]), s = sine(unit->memory[REST]);
    const double speed = drive(unit)[0], *matrix = matrix_of(unit, speed, 0.0);
    double *forces = own->operand + 4 * n;
    if (!matrix) {
        return 1;
    }
    memset(own->operand, 0, (4 * n + 2 * SIGNAL_ORDERS * p + 2) * sizeof(double));
    memcpy(forces, values, 2 * p * sizeof(double));
    memcpy(forces + 2 * p, slopes, 2 * p * sizeof(double));
    if (own->turning) {
        rotated(forces, 2 * p, c, s);
    }
    matrix_product(own->parts, own->rows, own->columns, 1, matrix, own->operand, own->result);
    put(own, own->result + 4 * n, unit->memory[REST], speed, change);
    return 0;
}

/* Outputs with speed or acceleration (k = 0, 1) changed by `by`. */
static int outputs_beside(Unit *unit, int k, double by, double *out)
{
    double *driven = drive(unit) + k;
    const double before = *driven;
    int wrong;
    *driven = before + by;
    wrong = outputs_now(unit, out);
    *driven = before;
    return wrong;
}

/* Add the change by speed and angular acceleration.  Outputs are cubic in the one and linear in the
   other, so that these differences are exact for any distance h. */
static int add_drive_response(Unit *unit, double speed, double spin_up, double *change)
{
    Own *own = unit->own;
    const double size = larger(1.0, absolute(drive(unit)[0]));
    const double far = larger(absolute(drive(unit)[1]), size * size);
    double **end = own->ends;
    int k;
    if (speed != 0.0) {
        if (outputs_beside(unit, 0, size, end[0]) || outputs_beside(unit, 0, -size, end[1]) ||
            outputs_beside(unit, 0, 2.0 * size, end[2]) ||
            outputs_beside(unit, 0, -2.0 * size, end[3])) {
            return 1;
        }
        for (k = 0; k < 4 * own->planes; k++) {
            change[k] += speed * (8.0 * (end[0][k] - end[1][k]) - (end[2][k] - end[3][k])) /
                         (12.0 * size);
        }
    }
    if (spin_up != 0.0) {
        if (outputs_beside(unit, 1, far, end[0]) || outputs_beside(unit, 1, -far, end[1])) {
            return 1;
        }
        for (k = 0; k < 4 * own->planes; k++) {
            change[k] += spin_up * (end[0][k] - end[1][k]) / (2.0 * far);
        }
    }
    return 0;
}

static int directional(Unit *unit, const double *seed, double *change)
{
    Own *own = unit->own;
    const int p = own->planes;
    const double *forces = seed + p + 2;
    double *values = own->ends[1], *slopes = values + 2 * p, *now = own->ends[0];
    int k;
    memset(change, 0,
           (unit->layout.computed.count + unit->layout.observed.count) * sizeof(double));
    if (outputs_now(unit, now)) {
        return 1;
    }
    for (k = 0; k < 2 * p; k++) {
        /* more mass on a plane is the force -m a less */
        values[k] = forces[k] - seed[k / 2] * now[k];
        slopes[k] = forces[2 * p + k] - seed[k / 2] * now[2 * p + k];
    }
    return force_response(unit, values, slopes, change) ||
           add_drive_response(unit, seed[p], seed[p + 1], change);
}

static int slope(Unit *unit, size_t reference, double *value)
{
    const Own *own = unit->own;
    const size_t n = 2 * (size_t)own->stations, p = 2 * (size_t)own->planes;
    const double *velocity = unit->memory + MOTION + n;
    const size_t output = reference - unit->layout.observed.first;
    if (reference < unit->layout.observed.first) {
        return 1;
    }
    if (output == 0) {
        *value = unit->memory[MOTION + 2 * n];
        return 0;
    }
    if (output <= n) {
        *value = velocity[output - 1];
        return 0;
    }
    if (output > 2 * n && output <= 2 * n + p) {
        const size_t k = output - 2 * n - 1;
        double both[2];
        vectors_at(own->rotor.planes + k / 2 * (n / 2), 1, own->stations, velocity, both);
        *value = both[k % 2];
        return 0;
    }
    return 1;
}

const Equations ROTOR_EQUATIONS = {
    "RotorOnSupports", memory_size, own_size, starts,  allocate,    parameters, begin,
    step,              outputs,     observe,  signals, directional, slope};
