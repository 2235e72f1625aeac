#include "base/failure.h"

#include "base/elementary.h"

int fail(Failure *failure, int code, const char *name, int where, double first, double second,
         double third, double fourth)
{
    failure->code = code;
    failure->where = where;
    failure->name = name;
    failure->value[0] = first;
    failure->value[1] = second;
    failure->value[2] = third;
    failure->value[3] = fourth;
    return code;
}

int demand_positive(const char *name, double value, Failure *failure)
{
    return is_finite(value) && value > 0.0
               ? FINE
               : fail(failure, FAILURE_NOT_POSITIVE, name, 0, value, 0.0, 0.0, 0.0);
}

int demand_not_negative(const char *name, double value, Failure *failure)
{
    return is_finite(value) && value >= 0.0
               ? FINE
               : fail(failure, FAILURE_NEGATIVE, name, 0, value, 0.0, 0.0, 0.0);
}

int demand_finite(const char *name, double value, Failure *failure)
{
    return is_finite(value) ? FINE
                            : fail(failure, FAILURE_NOT_FINITE, name, 0, value, 0.0, 0.0, 0.0);
}
