#include "contact/spacing.h"

#include "base/elementary.h"
#include "constants.h"

double half_angle(double radius, double track)
{
    if (!(radius >= 0.0 && radius <= track * (1.0 + TRACK_SLACK))) {
        return not_a_number();
    }
    return arc_sine(smaller(1.0, radius / track));
}

double largest_radius(int count, double track)
{
    return count > 1 ? track * sine(PI / count) : track;
}

bool fits(int count, double radius, double track)
{
    return radius <= largest_radius(count, track) * (1.0 + TRACK_SLACK);
}
