/* Gravity in the step of the rotor's unit: the sag about which it moves, and what its planes feel. */
#include <string.h>

#include "unit_rotor.h"

/* Sag at the present speed and added masses in own->sag, x and y alternating. */
static int find_sag(Unit *unit)
{
    Rotor *own = unit->own;
    const int n = own->stations;
    const double *masses = unit->real + unit->layout.inputs.first, speed = rotor_drive(unit)[0];
    const size_t size = (size_t)own->planes * sizeof(double);
    LinearRotor loaded;
    Failure failure;
    int k;
    if (own->sag_known && own->sag_speed == speed && !memcmp(own->sag_mass, masses, size)) {
        return 0;
    }
    own->sag_known = 0;
    loaded = linear_rotor_with_added_mass(&own->rotor, masses, own->loaded_mass);
    if (linear_rotor_sag(&loaded, speed, own->state, own->matrix_scratch, &failure)) {
        return unit_failed(unit, &failure, NULL, 0);
    }
    for (k = 0; k < n; k++) {
        own->sag[2 * k] = own->state[own->axes == 1 ? 2 * k : k];
        own->sag[2 * k + 1] = own->state[own->axes == 1 ? 2 * k + 1 : n + k];
    }
    memcpy(own->sag_mass, masses, size);
    own->sag_speed = speed;
    own->sag_known = 1;
    return 0;
}

int rotor_lift(Unit *unit)
{
    Rotor *own = unit->own;
    int k;
    if (find_sag(unit)) {
        return 1;
    }
    for (k = 0; k < 2 * own->stations; k++) {
        own->operand[k] -= own->sag[k];
    }
    own->lifted = 1;
    return 0;
}

void rotor_lower(Rotor *own)
{
    double *planes = own->result + 4 * own->stations;
    int k;
    for (k = 0; own->lifted && k < 2 * own->stations; k++) {
        own->result[k] += own->sag[k];
    }
    for (k = 0; k < 2 * own->planes; k++) {
        planes[k] -= own->rotor.gravity[k % 2];
    }
}
