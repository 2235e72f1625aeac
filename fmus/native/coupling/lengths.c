/* Lengths of steps that follow from the parameters. */
#include "base/elementary.h"
#include "constants.h"
#include "coupling/composite.h"

double step_of_revolution(const Unit *unit, double steps)
{
    return TAU / (((const Composite *)unit->own)->course->drive.fastest * steps);
}

double communication_length(const Unit *unit)
{
    const double steps = unit->real[((const Composite *)unit->own)->steps_per_rev];
    return step_of_revolution(unit, steps > 0.0 ? steps : DEFAULT_STEPS);
}

double brief_length(const Unit *unit)
{
    const double tolerance = unit->real[((const Composite *)unit->own)->tolerance];
    const double share = tolerance > 0.0 ? larger(SMALLEST_BRIEF_SHARE, smaller(1.0, tolerance / FULL_BRIEF_TOLERANCE)) : 1.0;
    return share * BRIEF_STEP * communication_length(unit);
}
