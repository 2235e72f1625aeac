/* FMI 2.0: a thin front over unit.h. */
#include "fmi/fmi2.h"

#include "base/elementary.h"
#include "fmi/front.h"
#include "fmi/unit.h"

static const char WRONG_TYPE[] = "the unit has Reals and Booleans only";

/* An instance: what the host gave, and the unit. */
typedef struct {
    Unit *unit;
    fmi2CallbackFunctions functions;
} Front2;

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

/* Warnings and errors are told whether or not debug messages are asked for. */
static void fmi2_tell(void *host, const char *instance, Status status, const char *message)
{
    const fmi2CallbackFunctions *functions = &((const Front2 *)host)->functions;
    char literal[2 * MESSAGE_SIZE];
    Text text = text_in(literal, sizeof literal);
    if (functions->logger) {
        put_literally(&text, message);
        functions->logger(functions->componentEnvironment, instance, (fmi2Status)status,
                          front_category(status), literal);
    }
}

/* -- life cycle ------------------------------------------------------------------------------ */

static fmi2Status allowed(fmi2Component c, const char *function, int phases, size_t count,
                          const void *a, const void *b)
{
    return (fmi2Status)front_allowed(c, function, phases, count, a, b);
}

const char *fmi2GetTypesPlatform(void)
{
    return "default";
}

const char *fmi2GetVersion(void)
{
    return "2.0";
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count,
                               const fmi2String categories[])
{
    (void)on, (void)count, (void)categories;
    return c ? fmi2OK : fmi2Error;
}

fmi2Component fmi2Instantiate(fmi2String instance, fmi2Type type, fmi2String guid,
                              fmi2String resources, const fmi2CallbackFunctions *functions,
                              fmi2Boolean visible, fmi2Boolean logging)
{
    Front2 host = {0}, *front;
    (void)visible, (void)logging;
    if (functions) {
        host.functions = *functions;
    }
    front = front_instantiate(instance, guid, resources, fmi2_tell, &host, sizeof host,
                              type == fmi2ModelExchange);
    if (front) {
        front->unit->may_end_early = 1;
    }
    return front;
}

void fmi2FreeInstance(fmi2Component c)
{
    front_free(c);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance,
                               fmi2Real start, fmi2Boolean stop_defined, fmi2Real stop)
{
    const fmi2Status status = allowed(c, "fmi2SetupExperiment", INSTANTIATED, 0, NULL, NULL);
    (void)tolerance_defined, (void)tolerance;
    return status ? status
                  : (fmi2Status)unit_setup(front_unit(c), start, stop_defined ? stop : infinity());
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    const fmi2Status status =
        allowed(c, "fmi2EnterInitializationMode", INSTANTIATED, 0, NULL, NULL);
    return status ? status : (fmi2Status)unit_enter_initialisation(front_unit(c));
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    const fmi2Status status =
        allowed(c, "fmi2ExitInitializationMode", INITIALISING, 0, NULL, NULL);
    return status ? status : (fmi2Status)unit_exit_initialisation(front_unit(c));
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    const fmi2Status status = allowed(c, "fmi2Terminate", RUNNING, 0, NULL, NULL);
    return status ? status : (fmi2Status)unit_terminate(front_unit(c));
}

fmi2Status fmi2Reset(fmi2Component c)
{
    const fmi2Status status = allowed(c, "fmi2Reset", ANY_PHASE, 0, NULL, NULL);
    if (!status) {
        unit_reset(front_unit(c));
    }
    return status;
}

/* -- values ---------------------------------------------------------------------------------- */

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                       fmi2Real value[])
{
    const fmi2Status status = allowed(c, "fmi2GetReal", ANY_PHASE, count, vr, value);
    return status ? status : (fmi2Status)unit_get_reals(front_unit(c), vr, count, value);
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                       const fmi2Real value[])
{
    const fmi2Status status =
        allowed(c, "fmi2SetReal", SETTABLE_PHASES, count, vr, value);
    return status ? status : (fmi2Status)unit_set_reals(front_unit(c), vr, count, value);
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                          fmi2Boolean value[])
{
    fmi2Status status = allowed(c, "fmi2GetBoolean", ANY_PHASE, count, vr, value);
    size_t k;
    for (k = 0; k < count && !status; k++) {
        status = (fmi2Status)unit_get_boolean(front_unit(c), vr[k], value + k);
    }
    return status;
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                          const fmi2Boolean value[])
{
    fmi2Status status =
        allowed(c, "fmi2SetBoolean", SETTABLE_PHASES, count, vr, value);
    size_t k;
    for (k = 0; k < count && !status; k++) {
        status = (fmi2Status)unit_set_boolean(front_unit(c), vr[k], value[k]);
    }
    return status;
}

/* what no variable of the unit has */
#define REFUSE_FMI2_TYPE(type)                                                                    \
    fmi2Status fmi2Get##type(fmi2Component c, const fmi2ValueReference vr[], size_t count,        \
                             fmi2##type value[])                                                  \
    {                                                                                             \
        (void)vr, (void)value;                                                                    \
        return (fmi2Status)front_wrong_type(c, "fmi2Get" #type, count, WRONG_TYPE);               \
    }                                                                                             \
    fmi2Status fmi2Set##type(fmi2Component c, const fmi2ValueReference vr[], size_t count,        \
                             const fmi2##type value[])                                            \
    {                                                                                             \
        (void)vr, (void)value;                                                                    \
        return (fmi2Status)front_wrong_type(c, "fmi2Set" #type, count, WRONG_TYPE);               \
    }

REFUSE_FMI2_TYPE(Integer)
REFUSE_FMI2_TYPE(String)

/* -- state ----------------------------------------------------------------------------------- */

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    return (fmi2Status)front_save(c, "fmi2GetFMUstate", state);
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    return (fmi2Status)front_restore(c, "fmi2SetFMUstate", state);
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    return (fmi2Status)front_forget(c, state);
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    return (fmi2Status)front_state_size(c, "fmi2SerializedFMUstateSize", state, size);
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[],
                                 size_t size)
{
    return (fmi2Status)front_serialise(c, "fmi2SerializeFMUstate", state, bytes, size);
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                   fmi2FMUstate *state)
{
    return (fmi2Status)front_deserialise(c, "fmi2DeSerializeFMUstate", bytes, size, state);
}

/* -- derivatives ----------------------------------------------------------------------------- */

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[],
                                        size_t unknowns, const fmi2ValueReference known[],
                                        size_t knowns, const fmi2Real seed[], fmi2Real change[])
{
    const char *function = "fmi2GetDirectionalDerivative";
    fmi2Status status = allowed(c, function, INITIALISING | RUNNING, unknowns, unknown, change);
    status = status ? status : allowed(c, function, INITIALISING | RUNNING, knowns, known, seed);
    return status ? status
                  : (fmi2Status)unit_directional(front_unit(c), unknown, unknowns, known, knowns,
                                                 seed, change);
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[],
                                       size_t count, const fmi2Integer order[],
                                       const fmi2Real value[])
{
    const char *function = "fmi2SetRealInputDerivatives";
    fmi2Status status = allowed(c, function, INITIALISING | RUNNING, count, vr, value);
    status = status ? status : allowed(c, function, INITIALISING | RUNNING, count, vr, order);
    return status ? status
                  : (fmi2Status)unit_set_derivatives(front_unit(c), vr, count, order, value);
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[],
                                        size_t count, const fmi2Integer order[],
                                        fmi2Real value[])
{
    const char *function = "fmi2GetRealOutputDerivatives";
    fmi2Status status = allowed(c, function, AFTER_INSTANTIATION, count, vr, value);
    status = status ? status : allowed(c, function, AFTER_INSTANTIATION, count, vr, order);
    return status ? status
                  : (fmi2Status)unit_get_derivatives(front_unit(c), vr, count, order, value);
}

/* -- model exchange -------------------------------------------------------------------------- */

fmi2Status fmi2EnterEventMode(fmi2Component c)
{
    return (fmi2Status)front_exchange(c, "fmi2EnterEventMode", ENTER_MODE, NULL, 0);
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c)
{
    return (fmi2Status)front_exchange(c, "fmi2EnterContinuousTimeMode", ENTER_MODE, NULL, 0);
}

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info)
{
    double next = infinity();
    const Status status =
        front_exchange(c, "fmi2NewDiscreteStates", PASS_EVENTS, info ? &next : NULL, 1);
    if (!status) {
        const fmi2EventInfo none = {0, 0, 0, 0, 0, 0.0};
        *info = none;
        info->nextEventTimeDefined = is_finite(next);
        info->nextEventTime = is_finite(next) ? next : 0.0;
    }
    return (fmi2Status)status;
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean no_set_state_before,
                                       fmi2Boolean *enter_event_mode, fmi2Boolean *terminate)
{
    (void)no_set_state_before;
    if (enter_event_mode) {
        *enter_event_mode = 0;
    }
    if (terminate) {
        *terminate = 0;
    }
    return (fmi2Status)front_exchange(c, "fmi2CompletedIntegratorStep", COMPLETE_STEP, NULL, 0);
}

fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time)
{
    return (fmi2Status)front_exchange(c, "fmi2SetTime", SET_TIME, &time, 1);
}

fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t count)
{
    return (fmi2Status)front_exchange(c, "fmi2SetContinuousStates", SET_STATES, (double *)x, count);
}

#define GET_ALL(function, call)                                                                   \
    fmi2Status function(fmi2Component c, fmi2Real values[], size_t count)                         \
    {                                                                                             \
        return (fmi2Status)front_exchange(c, #function, call, values, count);                     \
    }

GET_ALL(fmi2GetContinuousStates, GET_STATES)
GET_ALL(fmi2GetDerivatives, GET_DERIVATIVES)
GET_ALL(fmi2GetNominalsOfContinuousStates, GET_NOMINALS)

fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real values[], size_t count)
{
    (void)values;
    return (fmi2Status)front_exchange(c, "fmi2GetEventIndicators", ENTER_MODE, NULL, count);
}

/* -- the step -------------------------------------------------------------------------------- */

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step,
                      fmi2Boolean no_set_state_before)
{
    const fmi2Status status = allowed(c, "fmi2DoStep", RUNNING, 0, NULL, NULL);
    Status stepped;
    (void)no_set_state_before;
    if (status) {
        return status;
    }
    stepped = unit_step(front_unit(c), time, step);
    /* a step that ended early: the host asks for fmi2LastSuccessfulTime */
    return stepped == STATUS_OK && front_unit(c)->made < step ? fmi2Discard : (fmi2Status)stepped;
}

fmi2Status fmi2CancelStep(fmi2Component c)
{
    return (fmi2Status)front_refuse(
        c, "fmi2CancelStep", "no step is under way: steps are made while they are asked for");
}

/* A status the unit does not have; the host goes on. */
static fmi2Status no_status(fmi2Component c)
{
    return c ? fmi2Discard : fmi2Error;
}

#define REFUSE_STATUS(name, type)                                                                 \
    fmi2Status fmi2##name(fmi2Component c, const fmi2StatusKind kind, type *value)                \
    {                                                                                             \
        (void)kind, (void)value;                                                                  \
        return no_status(c);                                                                      \
    }

REFUSE_STATUS(GetStatus, fmi2Status)
REFUSE_STATUS(GetIntegerStatus, fmi2Integer)
REFUSE_STATUS(GetStringStatus, fmi2String)

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    if (!c || !value || kind != fmi2LastSuccessfulTime) {
        return no_status(c);
    }
    *value = front_unit(c)->time;
    return fmi2OK;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    if (!c || !value || kind != fmi2Terminated) {
        return no_status(c);
    }
    *value = 0;
    return fmi2OK;
}
