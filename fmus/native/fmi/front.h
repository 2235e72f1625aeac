/* What the functions of both versions of FMI share.  An instance is a unit; unit->host is what its host
   gave: whom to send messages to. */
#ifndef AUTOBALANCER_UNIT_FRONT_H
#define AUTOBALANCER_UNIT_FRONT_H

#include <stdbool.h>

#include "coupling/exchange.h"
#include "fmi/export.h"
#include "fmi/state.h"
#include "fmi/unit.h"

enum {
    ANY_PHASE = INSTANTIATED | INITIALISING | RUNNING | TERMINATED,
    AFTER_INSTANTIATION = INITIALISING | RUNNING | TERMINATED,
    SETTABLE_PHASES = INSTANTIATED | INITIALISING | RUNNING
};

/* The file that says what a unit or a composite starts from, and what the latter is made of. */
#define COMPOSITION "composition.txt"

/* As unit_instantiate; what a short token is the identity of is read from the folder of the FMU's
   resources. The unit gets a copy of `host`, of that size; `for_model_exchange`: for model
   exchange. */
Unit *front_instantiate(const char *name, const char *token, const char *resources, Log log,
                        const void *host, size_t size, bool for_model_exchange);
/* Log category of a message, as the model description names it. */
const char *front_category(Status status);
/* STATUS_OK when there is an instance and the call may be made now, */
Status front_allowed(Unit *unit, const char *function, int phases);
/* and its arrays are there, if there are `count` elements to take. */
Status front_arrays(Unit *unit, const char *function, int phases, size_t count, const void *a,
                    const void *b);
/* The error of a call for what the unit does not have, */
Status front_refuse(Unit *unit, const char *function, const char *why);
/* and of one for so many values of a type that no variable has. */
Status front_wrong_type(Unit *unit, const char *function, size_t count);

Status front_end_initialisation(Unit *unit, const char *function);
Status front_terminate(Unit *unit, const char *function);
Status front_reset(Unit *unit, const char *function);
/* A call of model exchange. */
Status front_exchange(Unit *unit, const char *function, ExchangeCall call, double *values, size_t count);
/* Clear a flag of the host, which passes NULL where it does not need it. */
#define FRONT_CLEAR(flag)                                                                         \
    if (flag) {                                                                                   \
        *flag = 0;                                                                                \
    }

/* The functions that both versions of FMI have alike.  Warnings and errors are logged even where the host
   has switched debug messages off. */
#define FRONT_FUNCTIONS(fmi)                                                                      \
    EXPORT int fmi##SetDebugLogging(void *instance, fmi##Boolean on, size_t count,                \
                                    const fmi##String categories[])                               \
    {                                                                                             \
        return instance ? STATUS_OK : STATUS_ERROR;                                               \
    }                                                                                             \
    EXPORT void fmi##FreeInstance(void *instance)                                                 \
    {                                                                                             \
        if (instance) {                                                                           \
            unit_free(instance);                                                                  \
        }                                                                                         \
    }                                                                                             \
    EXPORT int fmi##ExitInitializationMode(void *instance)                                        \
    {                                                                                             \
        return front_end_initialisation(instance, #fmi "ExitInitializationMode");                 \
    }                                                                                             \
    EXPORT int fmi##Terminate(void *instance)                                                     \
    {                                                                                             \
        return front_terminate(instance, #fmi "Terminate");                                       \
    }                                                                                             \
    EXPORT int fmi##Reset(void *instance)                                                         \
    {                                                                                             \
        return front_reset(instance, #fmi "Reset");                                               \
    }                                                                                             \
    EXPORT int fmi##SetTime(void *instance, double time)                                          \
    {                                                                                             \
        return front_exchange(instance, #fmi "SetTime", SET_TIME, &time, 1);                      \
    }                                                                                             \
    EXPORT int fmi##CompletedIntegratorStep(void *instance, fmi##Boolean no_set_state_before,     \
                                            fmi##Boolean *enter_event_mode,                       \
                                            fmi##Boolean *terminate)                              \
    {                                                                                             \
        FRONT_CLEAR(enter_event_mode)                                                             \
        FRONT_CLEAR(terminate)                                                                    \
        return front_exchange(instance, #fmi "CompletedIntegratorStep", COMPLETE_STEP, NULL, 0);  \
    }                                                                                             \
    FRONT_EXCHANGE(fmi##EnterEventMode, ENTER_MODE)                                               \
    FRONT_EXCHANGE(fmi##EnterContinuousTimeMode, ENTER_MODE)                                      \
    FRONT_EXCHANGE_VALUES(fmi##SetContinuousStates, SET_STATES)                                   \
    FRONT_EXCHANGE_VALUES(fmi##GetContinuousStates, GET_STATES)                                   \
    FRONT_EXCHANGE_VALUES(fmi##GetNominalsOfContinuousStates, GET_NOMINALS)                       \
    FRONT_EXCHANGE_VALUES(fmi##GetEventIndicators, GET_INDICATORS)

/* Of model exchange: calls without values, and with one of each continuous state. */
#define FRONT_EXCHANGE(function, call)                                                            \
    EXPORT int function(void *instance)                                                           \
    {                                                                                             \
        return front_exchange(instance, #function, call, NULL, 0);                                \
    }
#define FRONT_EXCHANGE_VALUES(function, call)                                                     \
    EXPORT int function(void *instance, double *values, size_t count)                             \
    {                                                                                             \
        return front_exchange(instance, #function, call, values, count);                          \
    }

/* Of the state, under the names of either version. */
#define FRONT_STATES(get, set, release, size_of, serialise, deserialise)                          \
    EXPORT int get(void *instance, void **state)                                                  \
    {                                                                                             \
        return unit_save(instance, state);                                                        \
    }                                                                                             \
    EXPORT int set(void *instance, void *state)                                                   \
    {                                                                                             \
        return unit_restore(instance, state);                                                     \
    }                                                                                             \
    EXPORT int release(void *instance, void **state)                                              \
    {                                                                                             \
        return unit_free_state(instance, state);                                                  \
    }                                                                                             \
    EXPORT int size_of(void *instance, void *state, size_t *size)                                 \
    {                                                                                             \
        return unit_measure_state(instance, state, size);                                         \
    }                                                                                             \
    EXPORT int serialise(void *instance, void *state, unsigned char *bytes, size_t size)          \
    {                                                                                             \
        return unit_serialise(instance, state, bytes, size);                                      \
    }                                                                                             \
    EXPORT int deserialise(void *instance, const unsigned char *bytes, size_t size, void **state) \
    {                                                                                             \
        return unit_deserialise(instance, bytes, size, state);                                    \
    }

#endif
