/* What the fronts for both versions of FMI share: whether a call may be made, and the state as
   pointers without type.  An instance is a structure whose first member is the unit. */
#ifndef AUTOBALANCER_UNIT_FRONT_H
#define AUTOBALANCER_UNIT_FRONT_H

#include "coupling/exchange.h"
#include "fmi/export.h"
#include "fmi/unit.h"

enum {
    ANY_PHASE = INSTANTIATED | INITIALISING | RUNNING | TERMINATED,
    AFTER_INSTANTIATION = INITIALISING | RUNNING | TERMINATED,
    SETTABLE_PHASES = INSTANTIATED | INITIALISING | RUNNING
};

/* The file that says what a unit or a composite starts from, and what the latter is made of. */
#define COMPOSITION "composition.txt"

/* As unit_instantiate; what a short token is the identity of is read from the folder of the FMU's resources.
   The instance is a copy of `host`, of that size, with the unit put in; `exchanges`: for model exchange. */
void *front_instantiate(const char *name, const char *token, const char *resources, Log log,
                        void *host, size_t size, int exchanges);
void front_free(void *instance);
Unit *front_unit(void *instance);
/* Log category of a message, as the model description names it. */
const char *front_category(Status status);
/* STATUS_OK when the call may be made now, and its arrays (if there are `count` elements to take)
   are there. */
Status front_allowed(void *instance, const char *function, int phases, size_t count,
                     const void *a, const void *b);
/* The error of a call for what the unit does not have, */
Status front_refuse(void *instance, const char *function, const char *why);
/* and of one for so many values of a type that no variable has. */
Status front_wrong_type(void *instance, const char *function, size_t count);

/* A call of model exchange. */
Status front_exchange(void *instance, const char *function, ExchangeCall call, double *values, size_t count);

Status front_save(void *instance, const char *function, void **state);
Status front_restore(void *instance, const char *function, void *state);
Status front_free_state(void *instance, void **state);
Status front_state_size(void *instance, const char *function, void *state, size_t *size);
Status front_serialise(void *instance, const char *function, void *state, void *bytes,
                       size_t size);
Status front_deserialise(void *instance, const char *function, const void *bytes, size_t size,
                         void **state);

/* Functions that both versions of FMI have, under the names of either: of the state, */
#define FRONT_STATES(get, set, release, size_of, serialise, deserialise)                          \
    EXPORT int get(void *instance, void **state)                                                  \
    {                                                                                             \
        return front_save(instance, #get, state);                                                 \
    }                                                                                             \
    EXPORT int set(void *instance, void *state)                                                   \
    {                                                                                             \
        return front_restore(instance, #set, state);                                              \
    }                                                                                             \
    EXPORT int release(void *instance, void **state)                                              \
    {                                                                                             \
        return front_free_state(instance, state);                                                 \
    }                                                                                             \
    EXPORT int size_of(void *instance, void *state, size_t *size)                                 \
    {                                                                                             \
        return front_state_size(instance, #size_of, state, size);                                 \
    }                                                                                             \
    EXPORT int serialise(void *instance, void *state, void *bytes, size_t size)                   \
    {                                                                                             \
        return front_serialise(instance, #serialise, state, bytes, size);                         \
    }                                                                                             \
    EXPORT int deserialise(void *instance, const void *bytes, size_t size, void **state)          \
    {                                                                                             \
        return front_deserialise(instance, #deserialise, bytes, size, state);                     \
    }
/* and of model exchange: calls without values, and with one of each continuous state. */
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

#endif
