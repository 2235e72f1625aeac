/* FMI 2.0: a thin front over unit.h, with the host's functions as unit->host. */
#include "fmi/fmi2.h"

#include "base/elementary.h"
#include "fmi/front.h"

/* -- messages -------------------------------------------------------------------------------- */

/* A message for the host's logger, for which it is a format, and # the mark of a variable. */
static void put_literally(Text *text, const char *words)
{
    for (; *words; words++) {
        text_put_part(text, words, 1);
        if (*words == '%' || *words == '#') {
            text_put_part(text, words, 1);
        }
    }
}

static void fmi2_log(void *host, const char *instance, Status status, const char *message)
{
    const fmi2CallbackFunctions *functions = host;
    char literal[2 * MESSAGE_SIZE];
    Text text = text_in(literal, sizeof literal);
    if (functions->logger) {
        put_literally(&text, message);
        functions->logger(functions->componentEnvironment, instance, status, front_category(status),
                          literal);
    }
}

/* -- life cycle ------------------------------------------------------------------------------ */

EXPORT const char *fmi2GetTypesPlatform(void)
{
    return "default";
}

EXPORT const char *fmi2GetVersion(void)
{
    return "2.0";
}

EXPORT fmi2Component fmi2Instantiate(fmi2String instance, fmi2Type type, fmi2String guid,
                                     fmi2String resources, const fmi2CallbackFunctions *functions,
                                     fmi2Boolean visible, fmi2Boolean logging)
{
    const fmi2CallbackFunctions none = {0}, *host = functions ? functions : &none;
    Unit *unit = front_instantiate(instance, guid, resources, fmi2_log, host, sizeof *host,
                                   type == fmi2ModelExchange);
    if (unit) {
        unit->may_end_early = true;
    }
    return unit;
}

FRONT_FUNCTIONS(fmi2)

EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined,
                                      fmi2Real tolerance, fmi2Real start, fmi2Boolean stop_defined,
                                      fmi2Real stop)
{
    const char *function = "fmi2SetupExperiment";
    Status status = front_allowed(c, function, INSTANTIATED);
    status = status ? status : unit_set_tolerance(c, function, tolerance_defined, tolerance);
    return status ? status : unit_setup(c, start, stop_defined ? stop : infinity());
}

EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    const Status status = front_allowed(c, "fmi2EnterInitializationMode", INSTANTIATED);
    if (!status) {
        ((Unit *)c)->phase = INITIALISING;
    }
    return status;
}

/* -- values ---------------------------------------------------------------------------------- */

EXPORT fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                              fmi2Real value[])
{
    const Status status = front_arrays(c, "fmi2GetReal", ANY_PHASE, count, vr, value);
    return status ? status : unit_get_reals(c, vr, count, value);
}

EXPORT fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                              const fmi2Real value[])
{
    const Status status = front_arrays(c, "fmi2SetReal", SETTABLE_PHASES, count, vr, value);
    return status ? status : unit_set_reals(c, vr, count, value);
}

EXPORT fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                 fmi2Boolean value[])
{
    Status status = front_arrays(c, "fmi2GetBoolean", ANY_PHASE, count, vr, value);
    size_t k;
    for (k = 0; k < count && !status; k++) {
        status = unit_get_boolean(c, vr[k], value + k);
    }
    return status;
}

EXPORT fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                 const fmi2Boolean value[])
{
    Status status = front_arrays(c, "fmi2SetBoolean", SETTABLE_PHASES, count, vr, value);
    size_t k;
    for (k = 0; k < count && !status; k++) {
        status = unit_set_boolean(c, vr[k], value[k]);
    }
    return status;
}

/* what no variable of the unit has */
#define REFUSE_FMI2_TYPE(type)                                                                    \
    EXPORT fmi2Status fmi2Get##type(fmi2Component c, const fmi2ValueReference vr[], size_t count, \
                                    fmi2##type value[])                                           \
    {                                                                                             \
        return front_wrong_type(c, "fmi2Get" #type, count);                                       \
    }                                                                                             \
    EXPORT fmi2Status fmi2Set##type(fmi2Component c, const fmi2ValueReference vr[], size_t count, \
                                    const fmi2##type value[])                                     \
    {                                                                                             \
        return front_wrong_type(c, "fmi2Set" #type, count);                                       \
    }

REFUSE_FMI2_TYPE(Integer)
REFUSE_FMI2_TYPE(String)

FRONT_STATES(fmi2GetFMUstate, fmi2SetFMUstate, fmi2FreeFMUstate, fmi2SerializedFMUstateSize,
             fmi2SerializeFMUstate, fmi2DeSerializeFMUstate)

/* -- derivatives ----------------------------------------------------------------------------- */

EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[],
                                               size_t unknowns, const fmi2ValueReference known[],
                                               size_t knowns, const fmi2Real seed[],
                                               fmi2Real change[])
{
    const char *function = "fmi2GetDirectionalDerivative";
    const int phases = INITIALISING | RUNNING;
    Status status = front_arrays(c, function, phases, unknowns, unknown, change);
    status = status ? status : front_arrays(c, function, phases, knowns, known, seed);
    return status ? status
                  : unit_directional(c, unknown, unknowns, known, knowns, seed, change);
}

EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[],
                                              size_t count, const fmi2Integer order[],
                                              const fmi2Real value[])
{
    const char *function = "fmi2SetRealInputDerivatives";
    Status status = front_arrays(c, function, INITIALISING | RUNNING, count, vr, value);
    status = status ? status : front_arrays(c, function, INITIALISING | RUNNING, count, vr, order);
    return status ? status : unit_set_derivatives(c, vr, count, order, value);
}

EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[],
                                               size_t count, const fmi2Integer order[],
                                               fmi2Real value[])
{
    const char *function = "fmi2GetRealOutputDerivatives";
    Status status = front_arrays(c, function, AFTER_INSTANTIATION, count, vr, value);
    status = status ? status : front_arrays(c, function, AFTER_INSTANTIATION, count, vr, order);
    return status ? status : unit_get_derivatives(c, vr, count, order, value);
}

/* -- model exchange -------------------------------------------------------------------------- */

FRONT_EXCHANGE_VALUES(fmi2GetDerivatives, GET_DERIVATIVES)

EXPORT fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info)
{
    double next[2] = {0.0, 0.0};
    const Status status =
        front_exchange(c, "fmi2NewDiscreteStates", PASS_EVENTS, info ? next : NULL, 2);
    if (!status) {
        const fmi2EventInfo none = {0, 0, 0, 0, 0, 0.0};
        *info = none;
        info->valuesOfContinuousStatesChanged = next[1] > 0.0;
        info->nextEventTimeDefined = is_finite(*next);
        info->nextEventTime = is_finite(*next) ? *next : 0.0;
    }
    return status;
}

/* -- the step -------------------------------------------------------------------------------- */

EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step,
                             fmi2Boolean no_set_state_before)
{
    Status status = front_allowed(c, "fmi2DoStep", RUNNING);
    if (!status) {
        status = unit_step(c, time, step);
        /* a step that ended early: the host asks for fmi2LastSuccessfulTime */
        status = !status && ((Unit *)c)->made < step ? STATUS_DISCARD : status;
    }
    return status;
}

EXPORT fmi2Status fmi2CancelStep(fmi2Component c)
{
    return front_refuse(c, "fmi2CancelStep", "no step is under way");
}

/* A status the unit does not have; the host goes on. */
static fmi2Status no_status(fmi2Component c)
{
    return c ? fmi2Discard : fmi2Error;
}

#define REFUSE_STATUS(name, type)                                                                 \
    EXPORT fmi2Status fmi2##name(fmi2Component c, const fmi2StatusKind kind, type *value)         \
    {                                                                                             \
        return no_status(c);                                                                      \
    }

REFUSE_STATUS(GetStatus, fmi2Status)
REFUSE_STATUS(GetIntegerStatus, fmi2Integer)
REFUSE_STATUS(GetStringStatus, fmi2String)

EXPORT fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    if (!c || !value || kind != fmi2LastSuccessfulTime) {
        return no_status(c);
    }
    *value = ((Unit *)c)->point;
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind,
                                       fmi2Boolean *value)
{
    if (!c || !value || kind != fmi2Terminated) {
        return no_status(c);
    }
    *value = 0;
    return fmi2OK;
}
