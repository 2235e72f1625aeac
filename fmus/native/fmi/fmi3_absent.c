/* The functions of FMI 3.0 for what the units do not have: variables of other types, clocks, event
   mode of co-simulation, adjoint derivatives.  Each is refused with a reason. */
#include "fmi/fmi3.h"
#include "fmi/front.h"

/* -- variables of other types ---------------------------------------------------------------- */

#define REFUSE_VALUES(name, ...)                                                                  \
    EXPORT fmi3Status fmi3##name(fmi3Instance instance, const fmi3ValueReference vr[],            \
                                 size_t count, __VA_ARGS__)                                       \
    {                                                                                             \
        return front_wrong_type(instance, "fmi3" #name, count);                                   \
    }
#define REFUSE_FMI3_TYPE(type)                                                                    \
    REFUSE_VALUES(Get##type, fmi3##type values[], size_t value_count)                             \
    REFUSE_VALUES(Set##type, const fmi3##type values[], size_t value_count)

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
REFUSE_VALUES(GetBinary, size_t sizes[], fmi3Binary values[], size_t value_count)
REFUSE_VALUES(SetBinary, const size_t sizes[], const fmi3Binary values[], size_t value_count)
REFUSE_VALUES(GetClock, fmi3Clock values[])
REFUSE_VALUES(SetClock, const fmi3Clock values[])

/* -- other interfaces ------------------------------------------------------------------------- */

EXPORT fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
    fmi3UnlockPreemptionCallback unlock)
{
    if (log) {
        log(environment, fmi3Error, front_category(STATUS_ERROR),
            "instantiation failed: the unit has no scheduled execution");
    }
    return NULL;
}

#define REFUSE_MODE(name)                                                                         \
    EXPORT fmi3Status fmi3##name(fmi3Instance instance)                                           \
    {                                                                                             \
        return front_refuse(instance, "fmi3" #name, "the unit does not have this");               \
    }
#define REFUSE(name, ...)                                                                         \
    EXPORT fmi3Status fmi3##name(fmi3Instance instance, __VA_ARGS__)                              \
    {                                                                                             \
        return front_refuse(instance, "fmi3" #name, "the unit does not have this");               \
    }
#define REFUSE_CLOCK(name, ...)                                                                   \
    REFUSE(name, const fmi3ValueReference vr[], size_t count, __VA_ARGS__)

REFUSE_MODE(EnterConfigurationMode)
REFUSE_MODE(ExitConfigurationMode)
REFUSE_MODE(EnterStepMode)
REFUSE(GetNumberOfVariableDependencies, fmi3ValueReference reference, size_t *count)
REFUSE(GetVariableDependencies, fmi3ValueReference dependent, size_t elements[],
       fmi3ValueReference independents[], size_t independent_elements[],
       fmi3DependencyKind kinds[], size_t count)
REFUSE_CLOCK(GetShiftDecimal, fmi3Float64 shifts[])
REFUSE_CLOCK(SetShiftDecimal, const fmi3Float64 shifts[])
REFUSE_CLOCK(SetIntervalDecimal, const fmi3Float64 intervals[])
REFUSE_CLOCK(GetShiftFraction, fmi3UInt64 counters[], fmi3UInt64 resolutions[])
REFUSE_CLOCK(SetShiftFraction, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
REFUSE_CLOCK(SetIntervalFraction, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
REFUSE_CLOCK(GetIntervalDecimal, fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
REFUSE_CLOCK(GetIntervalFraction, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
             fmi3IntervalQualifier qualifiers[])
REFUSE(ActivateModelPartition, fmi3ValueReference clock, fmi3Float64 time)
REFUSE(GetAdjointDerivative, const fmi3ValueReference unknowns[], size_t unknown_count,
       const fmi3ValueReference knowns[], size_t known_count, const fmi3Float64 seed[],
       size_t seed_count, fmi3Float64 change[], size_t change_count)
