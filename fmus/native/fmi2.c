/* FMI 2.0 for co-simulation: a thin front over unit.h. */
#include "fmi2.h"

#include "elementary.h"
#include "unit.h"
#include "unit_front.h"

/* An instance: what the host gave, and the unit. */
typedef struct {
    Unit *unit;
    fmi2CallbackFunctions functions;
} Front;

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
static void tell(void *host, const char *instance, Status status, const char *message)
{
    const fmi2CallbackFunctions *functions = host;
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
    (void)on;
    (void)count;
    (void)categories;
    return c ? fmi2OK : fmi2Error;
}

fmi2Component fmi2Instantiate(fmi2String instance, fmi2Type type, fmi2String guid,
                              fmi2String resources, const fmi2CallbackFunctions *functions,
                              fmi2Boolean visible, fmi2Boolean logging)
{
    fmi2CallbackFunctions host = {0};
    Unit *unit;
    Front *front;
    (void)visible;
    (void)logging;
    if (functions) {
        host = *functions;
    }
    if (type != fmi2CoSimulation) {
        tell(&host, instance ? instance : "", STATUS_ERROR,
             "instantiation failed: the unit is for co-simulation, not for model exchange");
        return NULL;
    }
    unit = front_instantiate(instance, guid, resources, tell, &host);
    front = unit ? unit_allocate(unit, 1, sizeof *front) : NULL;
    if (!front) {
        if (unit) {
            unit_free(unit);
        }
        return NULL;
    }
    front->functions = host;
    front->unit = unit;
    unit->host = &front->functions;
    unit->may_end_early = 1;
    return front;
}

void fmi2FreeInstance(fmi2Component c)
{
    if (c) {
        unit_free(front_unit(c));
    }
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance,
                               fmi2Real start, fmi2Boolean stop_defined, fmi2Real stop)
{
    const fmi2Status status = allowed(c, "fmi2SetupExperiment", INSTANTIATED, 0, NULL, NULL);
    (void)tolerance_defined;
    (void)tolerance;
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

/* Access to a type the unit has no variables of. */
static fmi2Status wrong_type(fmi2Component c, const char *function, size_t count)
{
    if (!c) {
        return fmi2Error;
    }
    return count ? (fmi2Status)unit_refuse(front_unit(c), function,
                                           "the unit has Reals and Booleans only")
                 : fmi2OK;
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                          fmi2Integer value[])
{
    (void)vr;
    (void)value;
    return wrong_type(c, "fmi2GetInteger", count);
}

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                         fmi2String value[])
{
    (void)vr;
    (void)value;
    return wrong_type(c, "fmi2GetString", count);
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                          const fmi2Integer value[])
{
    (void)vr;
    (void)value;
    return wrong_type(c, "fmi2SetInteger", count);
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                         const fmi2String value[])
{
    (void)vr;
    (void)value;
    return wrong_type(c, "fmi2SetString", count);
}

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
    return c ? (fmi2Status)unit_refuse(front_unit(c), "fmi2CancelStep",
                                       "no step is under way: steps are made while they are asked "
                                       "for")
             : fmi2Error;
}

/* A status the unit does not have; the host goes on. */
static fmi2Status no_status(fmi2Component c)
{
    return c ? fmi2Discard : fmi2Error;
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value)
{
    (void)kind;
    (void)value;
    return no_status(c);
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    if (!c || !value || kind != fmi2LastSuccessfulTime) {
        return no_status(c);
    }
    *value = front_unit(c)->time;
    return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value)
{
    (void)kind;
    (void)value;
    return no_status(c);
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    if (!c || !value || kind != fmi2Terminated) {
        return no_status(c);
    }
    *value = 0;
    return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value)
{
    (void)kind;
    (void)value;
    return no_status(c);
}
