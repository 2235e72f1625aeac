/* What is made for a speed and the masses that the planes carry, and how it is laid out. */
#include <string.h>

#include "units/rotor_unit.h"

static const double *added_masses(const Unit *unit)
{
    return unit->real + unit->layout.inputs.first;
}

double *rotor_inputs(Unit *unit)
{
    return unit->real + unit->layout.inputs.first + ((const Rotor *)unit->own)->planes;
}

bool rotor_is_of(const Unit *unit, const MadeFor *of, double speed)
{
    const size_t size = (size_t)((const Rotor *)unit->own)->planes * sizeof(double);
    return of->made && of->speed == speed && !memcmp(of->added_mass, added_masses(unit), size);
}

LinearRotor rotor_anew(Unit *unit, MadeFor *of)
{
    Rotor *own = unit->own;
    of->made = false;
    return linear_rotor_with_added_mass(&own->rotor, added_masses(unit), own->loaded_mass);
}

void rotor_made(const Unit *unit, MadeFor *of, double speed)
{
    const size_t size = (size_t)((const Rotor *)unit->own)->planes * sizeof(double);
    memcpy(of->added_mass, added_masses(unit), size);
    of->speed = speed;
    of->made = true;
}
