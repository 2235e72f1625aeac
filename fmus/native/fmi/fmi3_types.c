/* The functions of FMI 3.0 for what the units do not have: other types of variables.
   Each is refused with a reason. */
#include "fmi/fmi3.h"
#include "fmi/front.h"

static fmi3Status wrong_type(fmi3Instance instance, const char *function, size_t count)
{
    return (fmi3Status)front_wrong_type(instance, function, count,
                                        "the unit has variables of Float64 and Boolean only");
}

#define REFUSE_FMI3_TYPE(type)                                                                    \
    EXPORT fmi3Status fmi3Get##type(fmi3Instance instance, const fmi3ValueReference vr[],         \
                                    size_t count, fmi3##type values[], size_t value_count)        \
    {                                                                                             \
        (void)vr, (void)values, (void)value_count;                                                \
        return wrong_type(instance, "fmi3Get" #type, count);                                      \
    }                                                                                             \
    EXPORT fmi3Status fmi3Set##type(fmi3Instance instance, const fmi3ValueReference vr[],         \
                                    size_t count, const fmi3##type values[], size_t value_count)  \
    {                                                                                             \
        (void)vr, (void)values, (void)value_count;                                                \
        return wrong_type(instance, "fmi3Set" #type, count);                                      \
    }

REFUSE_FMI3_TYPE(Float32)
REFUSE_FMI3_TYPE(Int8)
REFUSE_FMI3_TYPE(UInt8)
REFUSE_FMI3_TYPE(Int16)
REFUSE_FMI3_TYPE(UInt16)
REFUSE_FMI3_TYPE(Int32)
REFUSE_FMI3_TYPE(UInt32)
REFUSE_FMI3_TYPE(Int64)
REFUSE_FMI3_TYPE(UInt64)
REFUSE_FMI3_TYPE(String)

EXPORT fmi3Status fmi3GetBinary(fmi3Instance instance, const fmi3ValueReference vr[],
                                size_t count, size_t sizes[], fmi3Binary values[],
                                size_t value_count)
{
    (void)vr, (void)sizes, (void)values, (void)value_count;
    return wrong_type(instance, "fmi3GetBinary", count);
}

EXPORT fmi3Status fmi3SetBinary(fmi3Instance instance, const fmi3ValueReference vr[],
                                size_t count, const size_t sizes[], const fmi3Binary values[],
                                size_t value_count)
{
    (void)vr, (void)sizes, (void)values, (void)value_count;
    return wrong_type(instance, "fmi3SetBinary", count);
}

EXPORT fmi3Status fmi3GetClock(fmi3Instance instance, const fmi3ValueReference vr[], size_t count,
                               fmi3Clock values[])
{
    (void)vr, (void)values;
    return wrong_type(instance, "fmi3GetClock", count);
}

EXPORT fmi3Status fmi3SetClock(fmi3Instance instance, const fmi3ValueReference vr[], size_t count,
                               const fmi3Clock values[])
{
    (void)vr, (void)values;
    return wrong_type(instance, "fmi3SetClock", count);
}
