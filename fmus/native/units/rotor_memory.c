/* Where a rotor remembers its speed and what holds it, and all that holds it together. */
#include "units/rotor_unit.h"

double *rotor_speed_now(const Unit *unit)
{
    return unit->memory + MOTION + 4 * ((const Rotor *)unit->own)->stations;
}

double *rotor_slider_states(const Unit *unit)
{
    return unit->memory + MOTION + 4 * ((const Rotor *)unit->own)->stations + 2;
}

double *rotor_stop_states(const Unit *unit)
{
    return rotor_slider_states(unit) + SLIDER_DOUBLES * ((const Rotor *)unit->own)->slider_count;
}

Holds rotor_holds(const Rotor *own)
{
    const Holds made = {own->sliders, own->cubics, own->stops, own->slider_count, own->cubic_count, own->stop_count};
    return made;
}
