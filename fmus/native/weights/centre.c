#include "weights/centre.h"

Instant find_instant(const CentreMotion *motion, double time)
{
    Instant now;
    cubic_at(motion->signal, time, now.motion);
    now.spin = spin_after(&motion->spin, time);
    return now;
}
