/* The functions of FMI 3.0 for what the units do not have: model exchange, clocks, events.
   Each is refused with a reason. */
#include "fmi3.h"
#include "unit_front.h"

static fmi3Status absent(fmi3Instance instance, const char *function)
{
    return instance ? (fmi3Status)unit_refuse(front_unit(instance), function,
                                              "the unit does not have this")
                    : fmi3Error;
}

static fmi3Instance wrong_interface(fmi3InstanceEnvironment environment,
                                    fmi3LogMessageCallback log)
{
    if (log) {
        log(environment, fmi3Error, front_category(STATUS_ERROR),
            "instantiation failed: the unit is for co-simulation only");
    }
    return NULL;
}

EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token,
                                                 fmi3String resources, fmi3Boolean visible,
                                                 fmi3Boolean logging,
                                                 fmi3InstanceEnvironment environment,
                                                 fmi3LogMessageCallback log)
{
    (void)name;
    (void)token;
    (void)resources;
    (void)visible;
    (void)logging;
    return wrong_interface(environment, log);
}

EXPORT fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
    fmi3UnlockPreemptionCallback unlock)
{
    (void)name;
    (void)token;
    (void)resources;
    (void)visible;
    (void)logging;
    (void)update;
    (void)lock;
    (void)unlock;
    return wrong_interface(environment, log);
}

EXPORT fmi3Status fmi3EnterEventMode(fmi3Instance instance)
{
    return absent(instance, "fmi3EnterEventMode");
}

EXPORT fmi3Status fmi3GetNumberOfVariableDependencies(
    fmi3Instance instance, fmi3ValueReference reference, size_t *count)
{
    (void)reference;
    (void)count;
    return absent(instance, "fmi3GetNumberOfVariableDependencies");
}

EXPORT fmi3Status fmi3GetVariableDependencies(fmi3Instance instance, fmi3ValueReference dependent,
                                              size_t elements[],
                                              fmi3ValueReference independents[],
                                              size_t independent_elements[],
                                              fmi3DependencyKind kinds[], size_t count)
{
    (void)dependent;
    (void)elements;
    (void)independents;
    (void)independent_elements;
    (void)kinds;
    (void)count;
    return absent(instance, "fmi3GetVariableDependencies");
}

EXPORT fmi3Status fmi3EnterConfigurationMode(fmi3Instance instance)
{
    return absent(instance, "fmi3EnterConfigurationMode");
}

EXPORT fmi3Status fmi3ExitConfigurationMode(fmi3Instance instance)
{
    return absent(instance, "fmi3ExitConfigurationMode");
}

EXPORT fmi3Status fmi3GetIntervalDecimal(fmi3Instance instance, const fmi3ValueReference vr[],
                                         size_t count, fmi3Float64 intervals[],
                                         fmi3IntervalQualifier qualifiers[])
{
    (void)vr;
    (void)count;
    (void)intervals;
    (void)qualifiers;
    return absent(instance, "fmi3GetIntervalDecimal");
}

EXPORT fmi3Status fmi3GetIntervalFraction(fmi3Instance instance, const fmi3ValueReference vr[],
                                          size_t count, fmi3UInt64 counters[],
                                          fmi3UInt64 resolutions[],
                                          fmi3IntervalQualifier qualifiers[])
{
    (void)vr;
    (void)count;
    (void)counters;
    (void)resolutions;
    (void)qualifiers;
    return absent(instance, "fmi3GetIntervalFraction");
}

EXPORT fmi3Status fmi3GetShiftDecimal(fmi3Instance instance, const fmi3ValueReference vr[],
                                      size_t count, fmi3Float64 shifts[])
{
    (void)vr;
    (void)count;
    (void)shifts;
    return absent(instance, "fmi3GetShiftDecimal");
}

EXPORT fmi3Status fmi3GetShiftFraction(fmi3Instance instance, const fmi3ValueReference vr[],
                                       size_t count, fmi3UInt64 counters[],
                                       fmi3UInt64 resolutions[])
{
    (void)vr;
    (void)count;
    (void)counters;
    (void)resolutions;
    return absent(instance, "fmi3GetShiftFraction");
}

EXPORT fmi3Status fmi3SetIntervalDecimal(fmi3Instance instance, const fmi3ValueReference vr[],
                                         size_t count, const fmi3Float64 intervals[])
{
    (void)vr;
    (void)count;
    (void)intervals;
    return absent(instance, "fmi3SetIntervalDecimal");
}

EXPORT fmi3Status fmi3SetIntervalFraction(fmi3Instance instance, const fmi3ValueReference vr[],
                                          size_t count, const fmi3UInt64 counters[],
                                          const fmi3UInt64 resolutions[])
{
    (void)vr;
    (void)count;
    (void)counters;
    (void)resolutions;
    return absent(instance, "fmi3SetIntervalFraction");
}

EXPORT fmi3Status fmi3SetShiftDecimal(fmi3Instance instance, const fmi3ValueReference vr[],
                                      size_t count, const fmi3Float64 shifts[])
{
    (void)vr;
    (void)count;
    (void)shifts;
    return absent(instance, "fmi3SetShiftDecimal");
}

EXPORT fmi3Status fmi3SetShiftFraction(fmi3Instance instance, const fmi3ValueReference vr[],
                                       size_t count, const fmi3UInt64 counters[],
                                       const fmi3UInt64 resolutions[])
{
    (void)vr;
    (void)count;
    (void)counters;
    (void)resolutions;
    return absent(instance, "fmi3SetShiftFraction");
}

EXPORT fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance instance)
{
    return absent(instance, "fmi3EvaluateDiscreteStates");
}

EXPORT fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean *update_needed,
                                           fmi3Boolean *terminate, fmi3Boolean *nominals_changed,
                                           fmi3Boolean *values_changed, fmi3Boolean *next_defined,
                                           fmi3Float64 *next_time)
{
    (void)update_needed;
    (void)terminate;
    (void)nominals_changed;
    (void)values_changed;
    (void)next_defined;
    (void)next_time;
    return absent(instance, "fmi3UpdateDiscreteStates");
}

EXPORT fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance)
{
    return absent(instance, "fmi3EnterContinuousTimeMode");
}

EXPORT fmi3Status fmi3CompletedIntegratorStep(fmi3Instance instance,
                                              fmi3Boolean no_set_state_before,
                                              fmi3Boolean *enter_event_mode,
                                              fmi3Boolean *terminate)
{
    (void)no_set_state_before;
    (void)enter_event_mode;
    (void)terminate;
    return absent(instance, "fmi3CompletedIntegratorStep");
}

EXPORT fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 time)
{
    (void)time;
    return absent(instance, "fmi3SetTime");
}

EXPORT fmi3Status fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64 states[],
                                          size_t count)
{
    (void)states;
    (void)count;
    return absent(instance, "fmi3SetContinuousStates");
}

EXPORT fmi3Status fmi3GetContinuousStateDerivatives(
    fmi3Instance instance, fmi3Float64 derivatives[], size_t count)
{
    (void)derivatives;
    (void)count;
    return absent(instance, "fmi3GetContinuousStateDerivatives");
}

EXPORT fmi3Status fmi3GetEventIndicators(fmi3Instance instance, fmi3Float64 indicators[],
                                         size_t count)
{
    (void)indicators;
    (void)count;
    return absent(instance, "fmi3GetEventIndicators");
}

EXPORT fmi3Status fmi3GetContinuousStates(fmi3Instance instance, fmi3Float64 states[],
                                          size_t count)
{
    (void)states;
    (void)count;
    return absent(instance, "fmi3GetContinuousStates");
}

EXPORT fmi3Status fmi3GetNominalsOfContinuousStates(
    fmi3Instance instance, fmi3Float64 nominals[], size_t count)
{
    (void)nominals;
    (void)count;
    return absent(instance, "fmi3GetNominalsOfContinuousStates");
}

EXPORT fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, size_t *count)
{
    (void)count;
    return absent(instance, "fmi3GetNumberOfEventIndicators");
}

EXPORT fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, size_t *count)
{
    (void)count;
    return absent(instance, "fmi3GetNumberOfContinuousStates");
}

EXPORT fmi3Status fmi3EnterStepMode(fmi3Instance instance)
{
    return absent(instance, "fmi3EnterStepMode");
}

EXPORT fmi3Status fmi3ActivateModelPartition(fmi3Instance instance, fmi3ValueReference clock,
                                             fmi3Float64 time)
{
    (void)clock;
    (void)time;
    return absent(instance, "fmi3ActivateModelPartition");
}
