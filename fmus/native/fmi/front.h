/* What the fronts for both versions of FMI share: whether a call may be made, and the state as
   pointers without type.  An instance is a structure whose first member is the unit. */
#ifndef AUTOBALANCER_UNIT_FRONT_H
#define AUTOBALANCER_UNIT_FRONT_H

#include "coupling/exchange.h"
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
Status front_wrong_type(void *instance, const char *function, size_t count, const char *why);

/* A call of model exchange. */
Status front_exchange(void *instance, const char *function, ExchangeCall call, double *values, size_t count);

Status front_save(void *instance, const char *function, void **state);
Status front_restore(void *instance, const char *function, void *state);
Status front_forget(void *instance, void **state);
Status front_state_size(void *instance, const char *function, void *state, size_t *size);
Status front_serialise(void *instance, const char *function, void *state, void *bytes,
                       size_t size);
Status front_deserialise(void *instance, const char *function, const void *bytes, size_t size,
                         void **state);

#endif
