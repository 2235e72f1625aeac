/* The rotor whose matrices are the parameters: for every pair of stations eleven numbers, then rows of
   planes, amounts and angles of unbalances, their rows, and rows of the bending. */
#include "base/elementary.h"
#include "base/matrix.h"
#include "constants.h"
#include "units/rotor_unit.h"

enum { PAIR_MASS, PAIR_DAMPING_XX, PAIR_DAMPING_XY, PAIR_DAMPING_YX, PAIR_DAMPING_YY, PAIR_STIFFNESS_XX,
       PAIR_STIFFNESS_XY, PAIR_STIFFNESS_YX, PAIR_STIFFNESS_YY, PAIR_INTERNAL, PAIR_GYROSCOPIC, PER_PAIR };

static size_t pairs_of(const Layout *layout)
{
    return (size_t)layout->sizes.stations * (size_t)layout->sizes.stations;
}

/* Where the tables of bearings begin: speeds, rows, and the numbers of each at each speed. */
static size_t tables_of(const Layout *layout)
{
    const Sizes *sizes = &layout->sizes;
    const size_t n = (size_t)sizes->stations, bends = n > 2 ? n - 2 : 1;
    return PER_PAIR * pairs_of(layout) + (size_t)sizes->planes * n + (2 + n) * (size_t)sizes->unbalances + bends * n;
}

/* Rows (count, n) of ones, each at a station of its own as far as there are. */
static void start_rows(int count, int n, double *rows)
{
    int k;
    for (k = 0; k < count; k++) {
        rows[k * n + k % n] = 1.0;
    }
}

void rotor_given_starts(const Layout *layout, double *real)
{
    const Sizes *sizes = &layout->sizes;
    const int n = sizes->stations;
    double *rows = real + PER_PAIR * pairs_of(layout), *amounts = rows + sizes->planes * n;
    size_t k;
    int j;
    fill_doubles(PER_PAIR * pairs_of(layout), 0.0, real);
    for (j = 0; j < n; j++) {
        double *of = real + PER_PAIR * (size_t)(j * n + j);
        of[PAIR_MASS] = 1.0;
        of[PAIR_DAMPING_XX] = of[PAIR_DAMPING_YY] = 40.0;
        of[PAIR_STIFFNESS_XX] = of[PAIR_STIFFNESS_YY] = 8.0e4;
    }
    fill_doubles((size_t)(sizes->planes * n), 0.0, rows);
    start_rows(sizes->planes, n, rows);
    for (j = 0; j < sizes->unbalances; j++) {
        amounts[2 * j] = j ? 0.0 : DEFAULT_UNBALANCE;
    }
    rows = amounts + 2 * sizes->unbalances;
    for (k = 0; k < (size_t)(sizes->unbalances * n); k++) {
        rows[k] = 0.0;
    }
    start_rows(sizes->unbalances, n, rows);
    rows = real + tables_of(layout);
    for (j = 0; j < sizes->tables * sizes->speeds && j < sizes->speeds; j++) {
        *rows++ = 100.0 * (j + 1);
    }
    fill_doubles((size_t)(sizes->tables * n), 0.0, rows);
    start_rows(sizes->tables, n, rows);
}

/* Fail unless the mass matrix is symmetric and positive definite. */
static int check_mass(Unit *unit)
{
    Rotor *own = unit->own;
    const int n = own->stations;
    const double *mass = own->rotor.mass;
    double *lower = own->loaded_mass; /* made anew before it is used */
    Failure failure;
    int i, j, k;
    for (i = 0; i < n; i++) {
        for (j = 0; j <= i; j++) {
            double sum = mass[i * n + j];
            if (mass[j * n + i] != sum) {
                fail(&failure, "mass[%u,%u] = %v kg: must be that of the other order, %v kg", (unsigned long)(j + 1),
                     (unsigned long)(i + 1), mass[j * n + i], sum);
                return unit_failed(unit, &failure);
            }
            for (k = 0; k < j; k++) {
                sum -= lower[i * n + k] * lower[j * n + k];
            }
            if (i == j && !(sum > 0.0)) {
                fail(&failure, "mass[%u,%u]: the mass matrix must be positive definite", (unsigned long)(i + 1),
                     (unsigned long)(i + 1));
                return unit_failed(unit, &failure);
            }
            lower[i * n + j] = i == j ? square_root(sum) : sum / lower[j * n + j];
        }
    }
    return 0;
}

/* The bearings that change with the speed; 1 with the reason. */
static int set_bearings(Unit *unit)
{
    Rotor *own = unit->own;
    Bearings *b = &own->rotor.bearings;
    const size_t first = tables_of(&unit->layout);
    int k;
    b->count = unit->layout.sizes.tables;
    if (!b->count) {
        return 0;
    }
    b->speed_count = unit->layout.sizes.speeds;
    b->speeds = unit->real + first;
    b->rows = b->speeds + b->speed_count;
    b->values = b->rows + b->count * own->stations;
    for (k = 1; k < b->speed_count; k++) {
        if (!(b->speeds[k - 1] < b->speeds[k])) {
            Text *reason = unit_reason(unit);
            layout_shown(&unit->layout, first + (size_t)k, b->speeds[k], reason);
            text_put(reason, ": must be above the speed of the row before");
            return 1;
        }
    }
    own->rotor.crossed = true;
    return 0;
}

/* The generalised unbalance from amounts, angles and rows. */
static void add_unbalances(const Sizes *sizes, const double *amounts, double *unbalance)
{
    const int n = sizes->stations;
    const double *row = amounts + 2 * sizes->unbalances;
    int k, j;
    for (k = 0; k < sizes->unbalances; k++, row += n) {
        const Complex moment = rect(amounts[2 * k], amounts[2 * k + 1]);
        for (j = 0; j < n; j++) {
            unbalance[2 * j] += row[j] * moment.re;
            unbalance[2 * j + 1] += row[j] * moment.im;
        }
    }
}

int rotor_of_matrices(Unit *unit)
{
    Rotor *own = unit->own;
    LinearRotor *rotor = &own->rotor;
    const Sizes *sizes = &unit->layout.sizes;
    const size_t pairs = pairs_of(&unit->layout), n = (size_t)own->stations;
    double *const matrices[PER_PAIR] = {
        rotor->mass,        rotor->damping_x,    rotor->damping_xy,   rotor->damping_yx,       rotor->damping_y,
        rotor->stiffness_x, rotor->stiffness_xy, rotor->stiffness_yx, rotor->stiffness_y,
        rotor->internal_damping, rotor->gyroscopic};
    const double *real = unit->real, *rows = real + PER_PAIR * pairs, *amounts = rows + (size_t)sizes->planes * n;
    size_t k;
    int what;
    for (k = 0; k < pairs; k++) {
        for (what = 0; what < PER_PAIR; what++) {
            matrices[what][k] = real[PER_PAIR * k + (size_t)what];
        }
        rotor->crossed |= rotor->damping_xy[k] != 0.0 || rotor->damping_yx[k] != 0.0 || rotor->stiffness_xy[k] != 0.0 ||
                          rotor->stiffness_yx[k] != 0.0;
    }
    copy_doubles((size_t)sizes->planes * n, rows, rotor->planes);
    add_unbalances(sizes, amounts, rotor->unbalance);
    copy_doubles((size_t)rotor->deflections * n, amounts + (2 + n) * (size_t)sizes->unbalances, rotor->deflection);
    return set_bearings(unit) || check_mass(unit);
}
