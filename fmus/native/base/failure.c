#include "base/failure.h"

int fail(Failure *failure, int code, int where, double first, double second, double third,
         double fourth)
{
    failure->code = code;
    failure->where = where;
    failure->value[0] = first;
    failure->value[1] = second;
    failure->value[2] = third;
    failure->value[3] = fourth;
    return code;
}
