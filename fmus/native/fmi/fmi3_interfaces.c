/* The functions of FMI 3.0 for what the units do not have: clocks, event mode of co-simulation, adjoint derivatives.
   Each is refused with a reason. */
#include "fmi/fmi3.h"
#include "fmi/front.h"

static fmi3Status absent(fmi3Instance instance, const char *function)
{
    return (fmi3Status)front_refuse(instance, function, "the unit does not have this");
}

EXPORT fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
    fmi3UnlockPreemptionCallback unlock)
{
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)update,
        (void)lock, (void)unlock;
    if (log) {
        log(environment, fmi3Error, front_category(STATUS_ERROR),
            "instantiation failed: the unit has no scheduled execution");
    }
    return NULL;
}

/* -- those that differ by their names -------------------------------------------------------- */

#define REFUSE(name)                                                                              \
    EXPORT fmi3Status fmi3##name(fmi3Instance instance)                                           \
    {                                                                                             \
        return absent(instance, "fmi3" #name);                                                    \
    }

REFUSE(EnterConfigurationMode)
REFUSE(ExitConfigurationMode)
REFUSE(EnterStepMode)

/* of clocks, in seconds or as fractions of them */
#define REFUSE_DECIMALS(name, type)                                                               \
    EXPORT fmi3Status fmi3##name(fmi3Instance instance, const fmi3ValueReference vr[],            \
                                 size_t count, type values[])                                     \
    {                                                                                             \
        (void)vr, (void)count, (void)values;                                                      \
        return absent(instance, "fmi3" #name);                                                    \
    }

REFUSE_DECIMALS(GetShiftDecimal, fmi3Float64)
REFUSE_DECIMALS(SetShiftDecimal, const fmi3Float64)
REFUSE_DECIMALS(SetIntervalDecimal, const fmi3Float64)

#define REFUSE_FRACTIONS(name, type)                                                              \
    EXPORT fmi3Status fmi3##name(fmi3Instance instance, const fmi3ValueReference vr[],            \
                                 size_t count, type counters[], type resolutions[])               \
    {                                                                                             \
        (void)vr, (void)count, (void)counters, (void)resolutions;                                 \
        return absent(instance, "fmi3" #name);                                                    \
    }

REFUSE_FRACTIONS(GetShiftFraction, fmi3UInt64)
REFUSE_FRACTIONS(SetShiftFraction, const fmi3UInt64)
REFUSE_FRACTIONS(SetIntervalFraction, const fmi3UInt64)

/* -- all others ------------------------------------------------------------------------------ */

EXPORT fmi3Status fmi3GetNumberOfVariableDependencies(
    fmi3Instance instance, fmi3ValueReference reference, size_t *count)
{
    (void)reference, (void)count;
    return absent(instance, "fmi3GetNumberOfVariableDependencies");
}

EXPORT fmi3Status fmi3GetVariableDependencies(fmi3Instance instance, fmi3ValueReference dependent,
                                              size_t elements[],
                                              fmi3ValueReference independents[],
                                              size_t independent_elements[],
                                              fmi3DependencyKind kinds[], size_t count)
{
    (void)dependent, (void)elements, (void)independents, (void)independent_elements,
        (void)kinds, (void)count;
    return absent(instance, "fmi3GetVariableDependencies");
}

EXPORT fmi3Status fmi3GetIntervalDecimal(fmi3Instance instance, const fmi3ValueReference vr[],
                                         size_t count, fmi3Float64 intervals[],
                                         fmi3IntervalQualifier qualifiers[])
{
    (void)vr, (void)count, (void)intervals, (void)qualifiers;
    return absent(instance, "fmi3GetIntervalDecimal");
}

EXPORT fmi3Status fmi3GetIntervalFraction(fmi3Instance instance, const fmi3ValueReference vr[],
                                          size_t count, fmi3UInt64 counters[],
                                          fmi3UInt64 resolutions[],
                                          fmi3IntervalQualifier qualifiers[])
{
    (void)vr, (void)count, (void)counters, (void)resolutions, (void)qualifiers;
    return absent(instance, "fmi3GetIntervalFraction");
}

EXPORT fmi3Status fmi3ActivateModelPartition(fmi3Instance instance, fmi3ValueReference clock,
                                             fmi3Float64 time)
{
    (void)clock, (void)time;
    return absent(instance, "fmi3ActivateModelPartition");
}

EXPORT fmi3Status fmi3GetAdjointDerivative(fmi3Instance instance,
                                           const fmi3ValueReference unknowns[],
                                           size_t unknown_count,
                                           const fmi3ValueReference knowns[], size_t known_count,
                                           const fmi3Float64 seed[], size_t seed_count,
                                           fmi3Float64 change[], size_t change_count)
{
    (void)unknowns, (void)unknown_count, (void)knowns, (void)known_count, (void)seed,
        (void)seed_count, (void)change, (void)change_count;
    return absent(instance, "fmi3GetAdjointDerivative");
}
