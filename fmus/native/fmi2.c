/* FMI 2.0 for co-simulation: a thin front over unit.h. */
#include "fmi2.h"

#include "elementary.h"
#include "unit.h"
#include "unit_state.h"

enum { ANY = INSTANTIATED | INITIALISING | RUNNING | TERMINATED };
enum { LIVING = INITIALISING | RUNNING | TERMINATED };

/* An instance: what the host gave, and the unit. */
typedef struct {
    fmi2CallbackFunctions functions;
    Unit *unit;
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
    static const char *const categories[] = {"logAll", "logStatusWarning", "logStatusDiscard",
                                             "logStatusError", "logStatusFatal"};
    const fmi2CallbackFunctions *functions = host;
    char literal[2 * MESSAGE_SIZE];
    Text text = text_in(literal, sizeof literal);
    if (functions->logger) {
        put_literally(&text, message);
        functions->logger(functions->componentEnvironment, instance, (fmi2Status)status,
                          categories[status], literal);
    }
}

/* -- life cycle ------------------------------------------------------------------------------ */

static Unit *unit_of(fmi2Component c)
{
    return ((Front *)c)->unit;
}

/* fmi2OK when the call may be made now, and its arrays are there. */
static fmi2Status allowed(fmi2Component c, const char *function, int phases, size_t count,
                          const void *a, const void *b)
{
    if (!c) {
        return fmi2Error;
    }
    if (count && (!a || !b)) {
        return (fmi2Status)unit_refuse(unit_of(c), function, "an array is missing");
    }
    return (fmi2Status)unit_allowed(unit_of(c), function, phases);
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
    (void)resources;
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
    unit = unit_instantiate(instance, guid, tell, &host);
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
    return front;
}

void fmi2FreeInstance(fmi2Component c)
{
    if (c) {
        unit_free(unit_of(c));
    }
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance,
                               fmi2Real start, fmi2Boolean stop_defined, fmi2Real stop)
{
    const fmi2Status status = allowed(c, "fmi2SetupExperiment", INSTANTIATED, 0, NULL, NULL);
    (void)tolerance_defined;
    (void)tolerance;
    return status ? status
                  : (fmi2Status)unit_setup(unit_of(c), start, stop_defined ? stop : infinity());
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    const fmi2Status status =
        allowed(c, "fmi2EnterInitializationMode", INSTANTIATED, 0, NULL, NULL);
    return status ? status : (fmi2Status)unit_enter_initialisation(unit_of(c));
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    const fmi2Status status =
        allowed(c, "fmi2ExitInitializationMode", INITIALISING, 0, NULL, NULL);
    return status ? status : (fmi2Status)unit_exit_initialisation(unit_of(c));
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    const fmi2Status status = allowed(c, "fmi2Terminate", RUNNING, 0, NULL, NULL);
    return status ? status : (fmi2Status)unit_terminate(unit_of(c));
}

fmi2Status fmi2Reset(fmi2Component c)
{
    const fmi2Status status = allowed(c, "fmi2Reset", ANY, 0, NULL, NULL);
    if (!status) {
        unit_reset(unit_of(c));
    }
    return status;
}

/* -- values ---------------------------------------------------------------------------------- */

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                       fmi2Real value[])
{
    const fmi2Status status = allowed(c, "fmi2GetReal", ANY, count, vr, value);
    return status ? status : (fmi2Status)unit_get_reals(unit_of(c), vr, count, value);
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                       const fmi2Real value[])
{
    const fmi2Status status =
        allowed(c, "fmi2SetReal", INSTANTIATED | INITIALISING | RUNNING, count, vr, value);
    return status ? status : (fmi2Status)unit_set_reals(unit_of(c), vr, count, value);
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                          fmi2Boolean value[])
{
    fmi2Status status = allowed(c, "fmi2GetBoolean", ANY, count, vr, value);
    size_t k;
    for (k = 0; k < count && !status; k++) {
        status = (fmi2Status)unit_get_boolean(unit_of(c), vr[k], value + k);
    }
    return status;
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                          const fmi2Boolean value[])
{
    fmi2Status status =
        allowed(c, "fmi2SetBoolean", INSTANTIATED | INITIALISING | RUNNING, count, vr, value);
    size_t k;
    for (k = 0; k < count && !status; k++) {
        status = (fmi2Status)unit_set_boolean(unit_of(c), vr[k], value[k]);
    }
    return status;
}

/* Access to a type the unit has no variables of. */
static fmi2Status wrong_type(fmi2Component c, const char *function, size_t count)
{
    if (!c) {
        return fmi2Error;
    }
    return count ? (fmi2Status)unit_refuse(unit_of(c), function,
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
    const fmi2Status status = allowed(c, "fmi2GetFMUstate", ANY, 1, state, state);
    State *saved;
    if (status) {
        return status;
    }
    saved = *state;
    if (unit_save(unit_of(c), &saved)) {
        return fmi2Error;
    }
    *state = saved;
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    const fmi2Status status = allowed(c, "fmi2SetFMUstate", ANY, 0, NULL, NULL);
    return status ? status : (fmi2Status)unit_restore(unit_of(c), state);
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    State *saved;
    if (!c) {
        return fmi2Error;
    }
    if (state) {
        saved = *state;
        unit_forget(&saved);
        *state = NULL;
    }
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    const fmi2Status status = allowed(c, "fmi2SerializedFMUstateSize", ANY, 1, state, size);
    if (!status) {
        *size = unit_state_size(unit_of(c));
    }
    return status;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[],
                                 size_t size)
{
    const fmi2Status status = allowed(c, "fmi2SerializeFMUstate", ANY, 1, state, bytes);
    return status ? status
                  : (fmi2Status)unit_serialise(unit_of(c), state, (unsigned char *)bytes, size);
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                   fmi2FMUstate *state)
{
    const fmi2Status status = allowed(c, "fmi2DeSerializeFMUstate", ANY, 1, bytes, state);
    State *saved;
    if (status) {
        return status;
    }
    saved = *state;
    if (unit_deserialise(unit_of(c), (const unsigned char *)bytes, size, &saved)) {
        return fmi2Error;
    }
    *state = saved;
    return fmi2OK;
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
                  : (fmi2Status)unit_directional(unit_of(c), unknown, unknowns, known, knowns,
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
                  : (fmi2Status)unit_set_derivatives(unit_of(c), vr, count, order, value);
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[],
                                        size_t count, const fmi2Integer order[],
                                        fmi2Real value[])
{
    const char *function = "fmi2GetRealOutputDerivatives";
    fmi2Status status = allowed(c, function, LIVING, count, vr, value);
    status = status ? status : allowed(c, function, LIVING, count, vr, order);
    return status ? status
                  : (fmi2Status)unit_get_derivatives(unit_of(c), vr, count, order, value);
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
    stepped = unit_step(unit_of(c), time, step);
    /* a step that ended early: the host asks for fmi2LastSuccessfulTime */
    return stepped == STATUS_OK && unit_of(c)->made < step ? fmi2Discard : (fmi2Status)stepped;
}

fmi2Status fmi2CancelStep(fmi2Component c)
{
    return c ? (fmi2Status)unit_refuse(unit_of(c), "fmi2CancelStep",
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
    *value = unit_of(c)->time;
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
