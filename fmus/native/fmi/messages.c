/* What an instance says: warnings, and errors with what was attempted and the reason. */
#include <stdarg.h>

#include "fmi/unit.h"

Text *unit_reason(Unit *unit)
{
    unit->reason = text_in(unit->reason_buffer, sizeof unit->reason_buffer);
    return &unit->reason;
}

int unit_fail(Unit *unit, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    text_format_values(unit_reason(unit), format, values);
    va_end(values);
    return 1;
}

int unit_failed(Unit *unit, const Failure *failure)
{
    return unit_fail(unit, "%s", failure->words);
}

Status unit_report(Unit *unit, Status status, const char *what)
{
    Text text = text_in(unit->message_buffer, sizeof unit->message_buffer);
    text_format(&text, "%s at t = %6 s: %s: %s", unit->name, unit->point, what, unit->reason.at);
    unit->log(unit->host, unit->name, status, text.at);
    return status;
}

double unit_host_time(const Unit *unit, double time)
{
    return unit->start + time;
}

void unit_warn_once(Unit *unit, int bit, double time, const char *words)
{
    if (!(unit->warned & bit)) {
        Text text = text_in(unit->message_buffer, sizeof unit->message_buffer);
        unit->warned |= bit;
        text_format(&text, "%s at t = %6 s: %s", unit->name, unit_host_time(unit, time), words);
        unit->log(unit->host, unit->name, STATUS_WARNING, text.at);
    }
}

Status unit_refuse(Unit *unit, const char *function, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    text_format_values(unit_reason(unit), format, values);
    va_end(values);
    return unit_report(unit, STATUS_ERROR, function);
}
