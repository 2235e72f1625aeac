/* FMI 3.0: a thin front over unit.h.

   Value references are unique over all types: the Reals as in FMI 2.0, then the Booleans, then the
   independent variable, time.  */
#include "fmi/fmi3.h"

#include "base/elementary.h"
#include "fmi/front.h"

/* What the host gave. */
typedef struct {
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
} Host3;

/* -- life cycle ----------------------------------------------------------------------------- */

static void fmi3_log(void *host, const char *instance, Status status, const char *message)
{
    const Host3 *to = host;
    if (to->log) {
        to->log(to->environment, status, front_category(status), message);
    }
}

static Unit *instantiate3(fmi3String name, fmi3String token, fmi3String resources,
                          const Host3 *host, bool for_model_exchange)
{
    Unit *unit =
        front_instantiate(name, token, resources, fmi3_log, host, sizeof *host, for_model_exchange);
    if (unit) {
        unit->first_boolean = unit->layout.real_count;
    }
    return unit;
}

EXPORT const char *fmi3GetVersion(void)
{
    return "3.0";
}

EXPORT fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token,
                                                fmi3String resources, fmi3Boolean visible,
                                                fmi3Boolean logging, fmi3Boolean event_mode,
                                                fmi3Boolean early_return,
                                                const fmi3ValueReference intermediate[],
                                                size_t intermediates,
                                                fmi3InstanceEnvironment environment,
                                                fmi3LogMessageCallback log,
                                                fmi3IntermediateUpdateCallback update)
{
    Host3 host = {environment, log};
    Unit *unit;
    if (event_mode || intermediates) {
        fmi3_log(&host, name, STATUS_ERROR,
             "instantiation failed: the unit has neither event mode nor intermediate variables");
        return NULL;
    }
    unit = instantiate3(name, token, resources, &host, 0);
    if (unit) {
        unit->may_end_early = early_return;
    }
    return unit;
}

EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token,
                                                 fmi3String resources, fmi3Boolean visible,
                                                 fmi3Boolean logging,
                                                 fmi3InstanceEnvironment environment,
                                                 fmi3LogMessageCallback log)
{
    const Host3 host = {environment, log};
    return instantiate3(name, token, resources, &host, 1);
}

FRONT_FUNCTIONS(fmi3)

EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean tolerance_defined,
                                              fmi3Float64 tolerance, fmi3Float64 start,
                                              fmi3Boolean stop_defined, fmi3Float64 stop)
{
    const char *function = "fmi3EnterInitializationMode";
    Status status = front_allowed(instance, function, INSTANTIATED);
    status = status ? status : unit_set_tolerance(instance, function, tolerance_defined, tolerance);
    status = status ? status : unit_setup(instance, start, stop_defined ? stop : infinity());
    if (!status) {
        ((Unit *)instance)->phase = INITIALISING;
    }
    return status;
}

/* -- values --------------------------------------------------------------------------------- */

static size_t time_reference(const Unit *unit)
{
    return unit->layout.real_count + (size_t)unit->layout.table->flag_count;
}

/* As front_arrays, for as many values as value references. */
static Status values_allowed(fmi3Instance instance, const char *function, int phases,
                             const fmi3ValueReference vr[], size_t count, const void *values,
                             size_t value_count)
{
    const Status status = front_arrays(instance, function, phases, count, vr, values);
    if (!status && value_count != count) {
        return unit_refuse(instance, function,
                           "there must be as many values as value references");
    }
    return status;
}

EXPORT fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference vr[], size_t count,
                                 fmi3Float64 values[], size_t value_count)
{
    Status status =
        values_allowed(instance, "fmi3GetFloat64", ANY_PHASE, vr, count, values, value_count);
    Unit *unit;
    size_t from = 0, k;
    if (status) {
        return status;
    }
    unit = instance;
    /* hosts read time together with others: what stands between is read at once */
    for (k = 0; k <= count && !status; k++) {
        if (k == count || vr[k] == time_reference(unit)) {
            status = unit_get_reals(unit, vr + from, k - from, values + from);
            if (k < count) {
                values[k] = unit->point;
            }
            from = k + 1;
        }
    }
    return status;
}

EXPORT fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference vr[], size_t count,
                                 const fmi3Float64 values[], size_t value_count)
{
    const Status status = values_allowed(instance, "fmi3SetFloat64", SETTABLE_PHASES, vr, count,
                                         values, value_count);
    return status ? status : unit_set_reals(instance, vr, count, values);
}

EXPORT fmi3Status fmi3GetBoolean(fmi3Instance instance, const fmi3ValueReference vr[], size_t count,
                                 fmi3Boolean values[], size_t value_count)
{
    Status status =
        values_allowed(instance, "fmi3GetBoolean", ANY_PHASE, vr, count, values, value_count);
    size_t k;
    for (k = 0; k < count && !status; k++) {
        int value = 0;
        status = unit_get_boolean(instance, vr[k], &value);
        values[k] = value != 0;
    }
    return status;
}

EXPORT fmi3Status fmi3SetBoolean(fmi3Instance instance, const fmi3ValueReference vr[], size_t count,
                                 const fmi3Boolean values[], size_t value_count)
{
    Status status = values_allowed(instance, "fmi3SetBoolean", SETTABLE_PHASES, vr, count, values,
                                   value_count);
    size_t k;
    for (k = 0; k < count && !status; k++) {
        status = unit_set_boolean(instance, vr[k], values[k]);
    }
    return status;
}

FRONT_STATES(fmi3GetFMUState, fmi3SetFMUState, fmi3FreeFMUState, fmi3SerializedFMUStateSize,
             fmi3SerializeFMUState, fmi3DeserializeFMUState)

/* -- derivatives and the step --------------------------------------------------------------- */

EXPORT fmi3Status fmi3GetDirectionalDerivative(fmi3Instance instance,
                                               const fmi3ValueReference unknowns[],
                                               size_t unknown_count,
                                               const fmi3ValueReference knowns[],
                                               size_t known_count, const fmi3Float64 seed[],
                                               size_t seed_count, fmi3Float64 change[],
                                               size_t change_count)
{
    const char *function = "fmi3GetDirectionalDerivative";
    const int phases = INITIALISING | RUNNING;
    Status status = values_allowed(instance, function, phases, unknowns, unknown_count, change,
                                   change_count);
    if (!status) {
        status = values_allowed(instance, function, phases, knowns, known_count, seed, seed_count);
    }
    return status ? status
                  : unit_directional(instance, unknowns, unknown_count, knowns,
                                     known_count, seed, change);
}

EXPORT fmi3Status fmi3GetOutputDerivatives(fmi3Instance instance, const fmi3ValueReference vr[],
                                           size_t count, const fmi3Int32 orders[],
                                           fmi3Float64 values[], size_t value_count)
{
    const char *function = "fmi3GetOutputDerivatives";
    Status status = values_allowed(instance, function, AFTER_INSTANTIATION, vr, count, values,
                                   value_count);
    if (!status) {
        status = front_arrays(instance, function, AFTER_INSTANTIATION, count, vr, orders);
    }
    return status ? status
                  : unit_get_derivatives(instance, vr, count, orders, values);
}

EXPORT fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 time, fmi3Float64 step,
                             fmi3Boolean no_set_state_before, fmi3Boolean *event_needed,
                             fmi3Boolean *terminate, fmi3Boolean *early_return,
                             fmi3Float64 *last_successful_time)
{
    Status status = front_allowed(instance, "fmi3DoStep", RUNNING);
    Unit *unit;
    if (status) {
        return status;
    }
    unit = instance;
    status = unit_step(unit, time, step);
    FRONT_CLEAR(event_needed)
    FRONT_CLEAR(terminate)
    if (early_return) {
        *early_return = !status && unit->made < step;
    }
    if (last_successful_time) {
        *last_successful_time = unit->point;
    }
    return status;
}

/* -- model exchange -------------------------------------------------------------------------- */

FRONT_EXCHANGE(fmi3EvaluateDiscreteStates, ENTER_MODE)
FRONT_EXCHANGE_VALUES(fmi3GetContinuousStateDerivatives, GET_DERIVATIVES)

/* Numbers of states, and of event indicators. */
static fmi3Status count_of(fmi3Instance instance, const char *function, size_t *count, int states)
{
    const Status status = front_arrays(instance, function, ANY_PHASE, 1, count, count);
    if (!status) {
        *count = states ? exchange_count(instance) : exchange_indicators(instance);
    }
    return status;
}

EXPORT fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, size_t *count)
{
    return count_of(instance, "fmi3GetNumberOfContinuousStates", count, 1);
}

EXPORT fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, size_t *count)
{
    return count_of(instance, "fmi3GetNumberOfEventIndicators", count, 0);
}

EXPORT fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean *update_needed,
                                           fmi3Boolean *terminate, fmi3Boolean *nominals_changed,
                                           fmi3Boolean *values_changed, fmi3Boolean *next_defined,
                                           fmi3Float64 *next_time)
{
    double next[2] = {0.0, 0.0};
    const Status status = front_exchange(instance, "fmi3UpdateDiscreteStates", PASS_EVENTS, next, 2);
    FRONT_CLEAR(update_needed)
    FRONT_CLEAR(terminate)
    FRONT_CLEAR(nominals_changed)
    if (values_changed) {
        *values_changed = next[1] > 0.0;
    }
    if (next_defined) {
        *next_defined = is_finite(*next);
    }
    if (next_time) {
        *next_time = is_finite(*next) ? *next : 0.0;
    }
    return status;
}
