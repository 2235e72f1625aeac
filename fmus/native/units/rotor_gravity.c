/* Gravity in the step of the rotor's unit: the sag about which it moves, and what its planes feel. */
#include "units/rotor_unit.h"

/* Sag at the present speed and added masses in own->sag. */
static int find_sag(Unit *unit)
{
    Rotor *own = unit->own;
    const double speed = rotor_inputs(unit)[0];
    LinearRotor loaded;
    Failure failure;
    if (rotor_is_of(unit, &own->sag_of, speed)) {
        return 0;
    }
    loaded = rotor_anew(unit, &own->sag_of);
    if (linear_rotor_sag(&loaded, speed, own->sag, own->matrix_scratch, &failure)) {
        return unit_failed(unit, &failure);
    }
    rotor_made(unit, &own->sag_of, speed);
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
    own->lifted = true;
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
