/* The kinds of rotor: their start values, and how their parameters make a `LinearRotor`. */
#include <string.h>

#include "base/elementary.h"
#include "base/matrix.h"
#include "constants.h"
#include "units/rotor_unit.h"

int rotor_kind(const Layout *layout)
{
    const char *kind = layout->table->kind;
    return text_equal(kind, "planar")     ? PLANAR
           : text_equal(kind, "flexible") ? FLEXIBLE
           : text_equal(kind, "matrices") ? MATRICES
                                          : TWO_SUPPORT;
}

/* Displacement at a by a unit force at b >= a of a uniform shaft supported at 0 and span. */
static double start_compliance(double a, double b, double span)
{
    const double rest = span - b;
    return a * rest * (span * span - rest * rest - a * a) / (6.0 * span * STEEL_20_MM);
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
    real[layout_index(layout, "support[#].position", 2)] = SPACING * (n - 1);
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
                real[at++] = start_compliance(SPACING * j, SPACING * k, SPACING * (n - 1));
            }
        }
    }
}

/* Every spring, stop and slider of given matrices is at a station of its own as far as there are: x and y of its
   row. */
static void restraint_starts(const Layout *layout, double *real)
{
    static const char *const names[3] = {"cubic_row_x[#,#]", "stop_row_x[#,#]", "slider_row_x[#,#]"};
    const int of_matrices = rotor_kind(layout) == MATRICES ? layout->sizes.sliders : 0;
    const int counts[3] = {layout->sizes.cubics, layout->sizes.stops, of_matrices}, n = layout->sizes.stations;
    int which, k;
    for (which = 0; which < 3; which++) {
        double *rows = counts[which] ? real + layout_index(layout, names[which], 1) : real;
        for (k = 0; k < 2 * n * counts[which]; k++) {
            const int row = k / (2 * n), station = k / 2 % n;
            rows[k] = row % n == station ? 1.0 : 0.0;
        }
    }
}

void rotor_starts(const Layout *layout, double *real)
{
    const int kind = rotor_kind(layout), planes = layout->sizes.planes;
    size_t amount;
    int j;
    restraint_starts(layout, real);
    if (kind == PLANAR) {
        return;
    }
    if (kind == MATRICES) {
        rotor_given_starts(layout, real);
        return;
    }
    amount = layout_index(layout, "unbalance[#].amount", 1);
    for (j = 0; j < layout->sizes.unbalances; j++) {
        real[amount + 3 * (size_t)j] = j ? 0.0 : DEFAULT_UNBALANCE;
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

/* Index of the station at a place; -1 when there is none, with the reason. */
static int station_at(Unit *unit, const double *z, size_t reference)
{
    const int n = ((const Rotor *)unit->own)->stations;
    const double place = unit->real[reference];
    int station = 0, j;
    for (j = 1; j < n; j++) {
        if (absolute(z[j] - place) < absolute(z[station] - place)) {
            station = j;
        }
    }
    if (!(absolute(z[station] - place) <= SAME_PLACE * absolute(z[n - 1] - z[0]))) {
        Text *reason = unit_reason(unit);
        layout_shown(&unit->layout, reference, place, reason);
        text_format(reason, ": must be the place of a station, one of %l m", z, (size_t)n);
        return -1;
    }
    return station;
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
    Rotor *own = unit->own;
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
        own->support_stations[j] = station;
    }
    symmetric(real + shaft, given ? bent : 0, compliance);
    values.stations = z;
    values.masses = masses;
    values.carriers = real + supports + 2;
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
        return unit_failed(unit, &failure);
    }
    return misplaced >= 0; /* the reason is that of the first one */
}

size_t rotor_shortest_stopped(const Unit *unit)
{
    return unit->layout.parameters.count - 4 * (size_t)((const Rotor *)unit->own)->stations - 2;
}

/* Of each slider: support, limit, stiffness, free stroke and its middle along x and y; of each cubic spring: stiffness along x
   and y, axes, limit, support; of each stop: gap, stiffness, damping, support. */
enum { MOST_SUPPORTS = 2000 }; /* with feet */
enum { SLIDER_PARAMETERS = 9, CUBIC_PARAMETERS = 5, STOP_PARAMETERS = 4 };

/* Value reference of the first slider's first parameter. */
static size_t slider_parameters(const Unit *unit)
{
    const Sizes *sizes = &unit->layout.sizes;
    const size_t stands = sizes->sliders || sizes->stops; /* the shortest stopped step */
    return rotor_shortest_stopped(unit) + 1 - stands - SLIDER_PARAMETERS * (size_t)sizes->sliders;
}

/* Doubles of the rows of sliders, which stand before their other parameters: of given matrices. */
static size_t slider_rows(const Unit *unit)
{
    const Rotor *own = unit->own;
    return own->kind == MATRICES ? (size_t)own->slider_count * (size_t)own->stations : 0;
}

/* Let a slider along an axis stand at the one station that moves it, or across its row (n, 2): behind a spring. */
static void set_row(Slider *slider, int n, const double *row)
{
    int k, others = 0;
    for (k = 0; k < n; k++) {
        const double share = row[2 * k + slider->axis];
        if (share == 1.0) {
            slider->station = k;
        }
        others += share != 0.0;
    }
    slider->row = others == 1 && row[2 * slider->station + slider->axis] == 1.0 ? NULL : row;
    if (!others) {
        slider->limit = 0.0; /* what has it does not move along this axis */
    }
}

/* Sliders along x and y, in the order of the parameters; 1 with the reason. */
static int set_sliders(Unit *unit)
{
    Rotor *own = unit->own;
    const int supports = own->kind == PLANAR ? 1 : own->kind == MATRICES ? MOST_SUPPORTS : 2;
    const size_t rows = slider_rows(unit);
    size_t first = slider_parameters(unit);
    int k, axis;
    copy_doubles(rows, unit->real + first - rows, own->slider_rows);
    for (k = 0; k < own->slider_count; k += 2, first += SLIDER_PARAMETERS) {
        const double *real = unit->real + first;
        int station;
        if (!(real[0] >= 1.0 && real[0] <= (double)supports) || real[0] != (double)(int)real[0]) {
            Text *reason = unit_reason(unit);
            layout_shown(&unit->layout, first, real[0], reason);
            text_format(reason, supports == 1   ? ": must be 1"
                                : supports == 2 ? ": must be 1 or 2"
                                                : ": must be a whole number, 1 to %u",
                        (unsigned long)supports);
            return 1;
        }
        station = own->kind == MATRICES ? 0 : (int)real[0] - 1;
        if (own->kind == FLEXIBLE) {
            station = station_at(unit, own->values, 2 * (size_t)own->stations + (size_t)station);
        }
        for (axis = 0; axis < 2; axis++) {
            Slider *slider = own->sliders + k + axis;
            slider->station = station;
            slider->axis = axis;
            slider->row = NULL;
            slider->support = (int)real[0];
            slider->limit = real[1 + axis];
            slider->stiffness = real[3 + axis];
            slider->stroke = 0.5 * real[5 + axis];
            slider->centre = real[7 + axis];
            if (rows) {
                set_row(slider, own->stations, own->slider_rows + k * own->stations);
            }
            if (slider->row && slider->limit > 0.0 && !(slider->stiffness > 0.0)) {
                Text *reason = unit_reason(unit);
                layout_shown(&unit->layout, first + 3 + (size_t)axis, real[3 + axis], reason);
                text_put(reason, ": must be above 0, a rigid slider stands at one station");
                return 1;
            }
            if (slider->stroke > 0.0 && slider->limit > 0.0 && !(slider->stiffness > 0.0)) {
                Text *reason = unit_reason(unit);
                layout_shown(&unit->layout, first + 5 + (size_t)axis, real[5 + axis], reason);
                text_put(reason, ": needs a stiffness above 0, that of the slider's contact at the ends of its stroke");
                return 1;
            }
        }
    }
    return 0;
}

/* Cubic springs and stops, in the order of the parameters, which stand before those of sliders; 1 with the reason. */
static int set_restraints(Unit *unit)
{
    Rotor *own = unit->own;
    const size_t n = (size_t)own->stations, cubics = (size_t)own->cubic_count, stops = (size_t)own->stop_count;
    const size_t rows_of_stops = slider_parameters(unit) - slider_rows(unit) - 2 * n * stops, of_stops = rows_of_stops - STOP_PARAMETERS * stops;
    const size_t rows_of_cubics = of_stops - 2 * n * cubics, of_cubics = rows_of_cubics - CUBIC_PARAMETERS * cubics;
    double *rows = own->restraint_rows;
    size_t k;
    if (!stops && !cubics) {
        return 0;
    }
    copy_doubles(2 * n * cubics, unit->real + rows_of_cubics, rows);
    copy_doubles(2 * n * stops, unit->real + rows_of_stops, rows + 2 * n * cubics);
    for (k = 0; k < cubics; k++) {
        const size_t at = of_cubics + CUBIC_PARAMETERS * k;
        const double *real = unit->real + at;
        const CubicSpring made = {rows + 2 * n * k, {real[0], real[1]}, real[2] == 0.0, real[3],
                                  rotor_whole_parameter(unit, at + CUBIC_PARAMETERS - 1, MOST_SUPPORTS)};
        if (made.support < 0) {
            return 1;
        }
        own->cubics[k] = made;
    }
    for (k = 0; k < stops; k++) {
        const size_t at = of_stops + STOP_PARAMETERS * k;
        const double *real = unit->real + at;
        const Stop made = {rows + 2 * n * (cubics + k), real[0], real[1], real[2],
                           rotor_whole_parameter(unit, at + STOP_PARAMETERS - 1, MOST_SUPPORTS)};
        if (made.support < 0) {
            return 1;
        }
        own->stops[k] = made;
    }
    return 0;
}

/* Set the matrices by the parameters of the kind; 1 with the reason. */
static int set_matrices(Unit *unit)
{
    Rotor *own = unit->own;
    Failure failure;
    if (own->kind == FLEXIBLE) {
        return flexible(unit);
    }
    if (own->kind == MATRICES) {
        return rotor_of_matrices(unit);
    }
    if (own->kind == PLANAR) {
        linear_rotor_planar(unit->real, &own->rotor);
        return 0;
    }
    return linear_rotor_two_support(unit->real, own->unbalances, &own->rotor, &failure)
               ? unit_failed(unit, &failure)
               : 0;
}

int rotor_of_parameters(Unit *unit)
{
    Rotor *own = unit->own;
    const double *gravity = unit->real + layout_index(&unit->layout, "gravity_x", 1);
    own->rotor = linear_rotor_in(own->rotor_memory, own->stations, own->planes);
    own->rotor.gravity[0] = gravity[0];
    own->rotor.gravity[1] = gravity[1];
    own->rotor.sliders = own->slider_count > 0 || own->cubic_count > 0 || own->stop_count > 0;
    return set_matrices(unit) || set_sliders(unit) || set_restraints(unit) || rotor_set_forces(unit);
}
