/* The functions of FMI 3.0 for what the units do not have: other types of variables.
   Each is refused with a reason. */
#include "fmi3.h"
#include "unit_front.h"

static fmi3Status wrong_type(fmi3Instance instance, const char *function, size_t count)
{
    if (!instance) {
        return fmi3Error;
    }
    return count ? (fmi3Status)unit_refuse(front_unit(instance), function,
                                           "the unit has variables of Float64 and Boolean only")
                 : fmi3OK;
}

EXPORT fmi3Status fmi3GetFloat32(fmi3Instance instance, const fmi3ValueReference vr[],
                                 size_t count, fmi3Float32 values[], size_t value_count)
{
    (void)vr;
    (void)values;
    (void)value_count;
    return wrong_type(instance, "fmi3GetFloat32", count);
}

EXPORT fmi3Status fmi3GetInt8(fmi3Instance instance, const fmi3ValueReference vr[], size_t count,
                              fmi3Int8 values[], size_t value_count)
{
    (void)vr;
    (void)values;
    (void)value_count;
    return wrong_type(instance, "fmi3GetInt8", count);
}

EXPORT fmi3Status fmi3GetUInt8(fmi3Instance instance, const fmi3ValueReference vr[], size_t count,
                               fmi3UInt8 values[], size_t value_count)
{
    (void)vr;
    (void)values;
    (void)value_count;
    return wrong_type(instance, "fmi3GetUInt8", count);
}

EXPORT fmi3Status fmi3GetInt16(fmi3Instance instance, const fmi3ValueReference vr[], size_t count,
                               fmi3Int16 values[], size_t value_count)
{
    (void)vr;
    (void)values;
    (void)value_count;
    return wrong_type(instance, "fmi3GetInt16", count);
}

EXPORT fmi3Status fmi3GetUInt16(fmi3Instance instance, const fmi3ValueReference vr[],
                                size_t count, fmi3UInt16 values[], size_t value_count)
{
    (void)vr;
    (void)values;
    (void)value_count;
    return wrong_type(instance, "fmi3GetUInt16", count);
}

EXPORT fmi3Status fmi3GetInt32(fmi3Instance instance, const fmi3ValueReference vr[], size_t count,
                               fmi3Int32 values[], size_t value_count)
{
    (void)vr;
    (void)values;
    (void)value_count;
    return wrong_type(instance, "fmi3GetInt32", count);
}

EXPORT fmi3Status fmi3GetUInt32(fmi3Instance instance, const fmi3ValueReference vr[],
                                size_t count, fmi3UInt32 values[], size_t value_count)
{
    (void)vr;
    (void)values;
    (void)value_count;
    return wrong_type(instance, "fmi3GetUInt32", count);
}

EXPORT fmi3Status fmi3GetInt64(fmi3Instance instance, const fmi3ValueReference vr[], size_t count,
                               fmi3Int64 values[], size_t value_count)
{
    (void)vr;
    (void)values;
    (void)value_count;
    return wrong_type(instance, "fmi3GetInt64", count);
}

EXPORT fmi3Status fmi3GetUInt64(fmi3Instance instance, const fmi3ValueReference vr[],
                                size_t count, fmi3UInt64 values[], size_t value_count)
{
    (void)vr;
    (void)values;
    (void)value_count;
    return wrong_type(instance, "fmi3GetUInt64", count);
}

EXPORT fmi3Status fmi3GetString(fmi3Instance instance, const fmi3ValueReference vr[],
                                size_t count, fmi3String values[], size_t value_count)
{
    (void)vr;
    (void)values;
    (void)value_count;
    return wrong_type(instance, "fmi3GetString", count);
}

EXPORT fmi3Status fmi3GetBinary(fmi3Instance instance, const fmi3ValueReference vr[],
                                size_t count, size_t sizes[], fmi3Binary values[],
                                size_t value_count)
{
    (void)vr;
    (void)sizes;
    (void)values;
    (void)value_count;
    return wrong_type(instance, "fmi3GetBinary", count);
}

EXPORT fmi3Status fmi3GetClock(fmi3Instance instance, const fmi3ValueReference vr[], size_t count,
                               fmi3Clock values[])
{
    (void)vr;
    (void)values;
    return wrong_type(instance, "fmi3GetClock", count);
}

EXPORT fmi3Status fmi3SetFloat32(fmi3Instance instance, const fmi3ValueReference vr[],
                                 size_t count, const fmi3Float32 values[], size_t value_count)
{
    (void)vr;
    (void)values;
    (void)value_count;
    return wrong_type(instance, "fmi3SetFloat32", count);
}

EXPORT fmi3Status fmi3SetInt8(fmi3Instance instance, const fmi3ValueReference vr[], size_t count,
                              const fmi3Int8 values[], size_t value_count)
{
    (void)vr;
    (void)values;
    (void)value_count;
    return wrong_type(instance, "fmi3SetInt8", count);
}

EXPORT fmi3Status fmi3SetUInt8(fmi3Instance instance, const fmi3ValueReference vr[], size_t count,
                               const fmi3UInt8 values[], size_t value_count)
{
    (void)vr;
    (void)values;
    (void)value_count;
    return wrong_type(instance, "fmi3SetUInt8", count);
}

EXPORT fmi3Status fmi3SetInt16(fmi3Instance instance, const fmi3ValueReference vr[], size_t count,
                               const fmi3Int16 values[], size_t value_count)
{
    (void)vr;
    (void)values;
    (void)value_count;
    return wrong_type(instance, "fmi3SetInt16", count);
}

EXPORT fmi3Status fmi3SetUInt16(fmi3Instance instance, const fmi3ValueReference vr[],
                                size_t count, const fmi3UInt16 values[], size_t value_count)
{
    (void)vr;
    (void)values;
    (void)value_count;
    return wrong_type(instance, "fmi3SetUInt16", count);
}

EXPORT fmi3Status fmi3SetInt32(fmi3Instance instance, const fmi3ValueReference vr[], size_t count,
                               const fmi3Int32 values[], size_t value_count)
{
    (void)vr;
    (void)values;
    (void)value_count;
    return wrong_type(instance, "fmi3SetInt32", count);
}

EXPORT fmi3Status fmi3SetUInt32(fmi3Instance instance, const fmi3ValueReference vr[],
                                size_t count, const fmi3UInt32 values[], size_t value_count)
{
    (void)vr;
    (void)values;
    (void)value_count;
    return wrong_type(instance, "fmi3SetUInt32", count);
}

EXPORT fmi3Status fmi3SetInt64(fmi3Instance instance, const fmi3ValueReference vr[], size_t count,
                               const fmi3Int64 values[], size_t value_count)
{
    (void)vr;
    (void)values;
    (void)value_count;
    return wrong_type(instance, "fmi3SetInt64", count);
}

EXPORT fmi3Status fmi3SetUInt64(fmi3Instance instance, const fmi3ValueReference vr[],
                                size_t count, const fmi3UInt64 values[], size_t value_count)
{
    (void)vr;
    (void)values;
    (void)value_count;
    return wrong_type(instance, "fmi3SetUInt64", count);
}

EXPORT fmi3Status fmi3SetString(fmi3Instance instance, const fmi3ValueReference vr[],
                                size_t count, const fmi3String values[], size_t value_count)
{
    (void)vr;
    (void)values;
    (void)value_count;
    return wrong_type(instance, "fmi3SetString", count);
}

EXPORT fmi3Status fmi3SetBinary(fmi3Instance instance, const fmi3ValueReference vr[],
                                size_t count, const size_t sizes[], const fmi3Binary values[],
                                size_t value_count)
{
    (void)vr;
    (void)sizes;
    (void)values;
    (void)value_count;
    return wrong_type(instance, "fmi3SetBinary", count);
}

EXPORT fmi3Status fmi3SetClock(fmi3Instance instance, const fmi3ValueReference vr[], size_t count,
                               const fmi3Clock values[])
{
    (void)vr;
    (void)values;
    return wrong_type(instance, "fmi3SetClock", count);
}
