/* What an instance says: warnings, and errors with what was attempted and the reason. */
#include "fmi/unit.h"

Text *unit_reason(Unit *unit)
{
    unit->reason = text_in(unit->reason_buffer, sizeof unit->reason_buffer);
    return &unit->reason;
}

int unit_failed(Unit *unit, const Failure *failure, const double *values, size_t count)
{
    failure_words(unit_reason(unit), failure, values, count);
    return 1;
}

static void log_message(Unit *unit, Status status, double time, const char *what, const char *reason)
{
    Text text = text_in(unit->message_buffer, sizeof unit->message_buffer);
    text_put(&text, unit->name);
    text_put(&text, " at t = ");
    text_number(&text, time);
    text_put(&text, " s: ");
    text_put(&text, what);
    text_put(&text, reason);
    unit->log(unit->host, unit->name, status, text.at);
}

Status unit_report(Unit *unit, Status status, const char *what)
{
    Text *reason = &unit->reason;
    char words[96];
    Text before = text_in(words, sizeof words);
    text_put(&before, what);
    text_put(&before, ": ");
    log_message(unit, status, unit->time, words, reason->at);
    return status;
}

void unit_warn_once(Unit *unit, int bit, double time, const char *words)
{
    if (!(unit->warned & bit)) {
        unit->warned |= bit;
        log_message(unit, STATUS_WARNING, time, words, "");
    }
}

Status unit_refuse(Unit *unit, const char *function, const char *why)
{
    text_put(unit_reason(unit), why);
    return unit_report(unit, STATUS_ERROR, function);
}

Status unit_allowed(Unit *unit, const char *function, int phases)
{
    static const char *const names[] = {"before initialisation has begun", "during initialisation",
                                        "after initialisation", "after the end"};
    int k = 0;
    if (unit->phase & phases) {
        return STATUS_OK;
    }
    while (!(unit->phase >> k & 1)) {
        k++;
    }
    text_put(unit_reason(unit), "not allowed ");
    text_put(&unit->reason, names[k]);
    return unit_report(unit, STATUS_ERROR, function);
}
