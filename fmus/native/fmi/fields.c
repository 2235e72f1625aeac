#include "fmi/fields.h"

#include <float.h>
#include <string.h>

#include "base/elementary.h"

Fields fields_of(const double *memory, size_t count, const double *real, Text *reason)
{
    Fields fields;
    fields.next = memory;
    fields.end = memory + count;
    fields.real = real;
    fields.owner = NULL;
    fields.wrong = 0;
    fields.reason = reason;
    return fields;
}

const void *fields_here(const Fields *fields)
{
    return fields->next;
}

/* Go on behind so many doubles; 1 where there is nothing to look at: the table or a field before is wrong. */
static int fields_pass(Fields *fields, const char *name, const double *place, size_t count)
{
    if (fields->wrong) {
        return 1;
    }
    if (place != fields->next || count > (size_t)(fields->end - place)) {
        text_format(fields->reason, "the table of its fields is wrong at %s", name);
        fields->wrong = 1;
        return 1;
    }
    fields->next += count;
    return 0;
}

static void refuse_field(Fields *fields, const char *name, size_t index, double value)
{
    if (fields->owner) {
        text_format(fields->reason, "%s: ", fields->owner);
    }
    text_format(fields->reason, "%s[%u] = %v: must be ", name, (unsigned long)index + 1, value);
    fields->wrong = 1;
}

void fields_number(Fields *fields, const char *name, const double *place, size_t count)
{
    fields_within(fields, name, place, count, -DBL_MAX, DBL_MAX);
}

void fields_within(Fields *fields, const char *name, const double *place, size_t count, double least,
                   double most)
{
    size_t k;
    if (fields_pass(fields, name, place, count)) {
        return;
    }
    for (k = 0; k < count && !fields->wrong; k++) {
        if (!(place[k] >= least && place[k] <= most)) {
            refuse_field(fields, name, k, place[k]);
            text_format(fields->reason, most == DBL_MAX ? "a finite number, at least %v"
                                                               : "a number from %v to %v", least, most);
        }
    }
}

void fields_whole(Fields *fields, const char *name, const double *place, size_t count, double least,
                  double most)
{
    size_t k;
    if (fields_pass(fields, name, place, count)) {
        return;
    }
    for (k = 0; k < count && !fields->wrong; k++) {
        if (!(place[k] >= least && place[k] <= most && place[k] == nearest(place[k]))) {
            refuse_field(fields, name, k, place[k]);
            text_format(fields->reason, "a whole number from %v to %v", least, most);
        }
    }
}

void fields_flag(Fields *fields, const char *name, const double *place)
{
    fields_whole(fields, name, place, 1, 0.0, 1.0);
}

void fields_same(Fields *fields, const char *name, const double *place, size_t count,
                 const double *others)
{
    size_t k;
    if (fields_pass(fields, name, place, count)) {
        return;
    }
    for (k = 0; k < count && !fields->wrong; k++) {
        if (memcmp(place + k, others + k, sizeof *place)) {
            refuse_field(fields, name, k, place[k]);
            text_format(fields->reason, "%v, as in the variables", others[k]);
        }
    }
}

void fields_any(Fields *fields, const double *place, size_t count)
{
    fields_pass(fields, "values", place, count);
}

int fields_wrong(Fields *fields)
{
    if (!fields->wrong && fields->next != fields->end) {
        text_put(fields->reason, "the table of its fields ends too early");
        fields->wrong = 1;
    }
    return fields->wrong;
}
