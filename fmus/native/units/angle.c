#include "units/angle.h"

#include "base/elementary.h"
#include "constants.h"

void angle_fields(Fields *fields)
{
    const double *angle = fields_here(fields);
    fields_whole(fields, "turns", angle + TURNS, 1, -MOST_COUNTED, MOST_COUNTED);
    fields_within(fields, "rest of the angle", angle + REST, 1, -TAU, TAU);
    fields_number(fields, "carry of the angle", angle + CARRY, 1);
}

void angle_start(double *angle, double start)
{
    angle[TURNS] = angle[REST] = angle[CARRY] = 0.0;
    angle_turn(angle, start);
}

void angle_turn(double *angle, double by)
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

double angle_total(const double *angle)
{
    return angle[TURNS] * TAU + (angle[REST] + (angle[TURNS] * TURN_ROUNDING - angle[CARRY]));
}
