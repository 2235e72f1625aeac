#include "weights/liquid.h"

#include "base/elementary.h"

int liquid_check(const Liquid *liquid, Failure *failure)
{
    return liquid->float_radius < liquid->chamber_radius
               ? FINE
               : fail(failure, "float_radius = %v m: must be smaller than chamber_radius = %v m",
                      liquid->float_radius, liquid->chamber_radius);
}

double liquid_gap(const Liquid *liquid)
{
    return liquid->chamber_radius - liquid->float_radius;
}

double liquid_mass(const Liquid *liquid)
{
    /* the factored difference of squares keeps its digits in a thin gap */
    const double area = PI * liquid_gap(liquid) * (liquid->chamber_radius + liquid->float_radius);
    return liquid->density * area * liquid->height;
}

double liquid_added_mass(const Liquid *liquid)
{
    return liquid->density * PI * (liquid->chamber_radius * liquid->chamber_radius) *
           liquid->height;
}

double liquid_clearance(const Liquid *liquid, Complex displacement)
{
    return liquid_gap(liquid) - hypotenuse(displacement.re, displacement.im);
}
