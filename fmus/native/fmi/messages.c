/* What an instance says: warnings, and errors with what was attempted and the reason. */
#include <stdarg.h>

#include "fmi/unit.h"

/* As text_format, with the values as a list. */
static void format_values(Text *text, const char *format, va_list values)
{
    for (; *format; format++) {
        size_t plain = 0;
        while (format[plain] && format[plain] != '%') {
            plain++;
        }
        text_put_part(text, format, plain);
        format += plain;
        if (!*format) {
            return;
        }
        switch (*++format) {
        case 's':
            text_put(text, va_arg(values, const char *));
            break;
        case 'u':
            text_integer(text, va_arg(values, unsigned long));
            break;
        case 'v':
            text_number(text, va_arg(values, double));
            break;
        default:
            text_rounded(text, va_arg(values, double), *format - '0');
        }
    }
}

void text_format(Text *text, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    format_values(text, format, values);
    va_end(values);
}

Text *unit_reason(Unit *unit)
{
    unit->reason = text_in(unit->reason_buffer, sizeof unit->reason_buffer);
    return &unit->reason;
}

int unit_fail(Unit *unit, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    format_values(unit_reason(unit), format, values);
    va_end(values);
    return 1;
}

int unit_failed(Unit *unit, const Failure *failure, const double *values, size_t count)
{
    failure_words(unit_reason(unit), failure, values, count);
    return 1;
}

Status unit_report(Unit *unit, Status status, const char *what)
{
    Text text = text_in(unit->message_buffer, sizeof unit->message_buffer);
    text_format(&text, "%s at t = %v s: %s: %s", unit->name, unit->time, what, unit->reason.at);
    unit->log(unit->host, unit->name, status, text.at);
    return status;
}

void unit_warn_once(Unit *unit, int bit, double time, const char *words)
{
    if (!(unit->warned & bit)) {
        Text text = text_in(unit->message_buffer, sizeof unit->message_buffer);
        unit->warned |= bit;
        text_format(&text, "%s at t = %v s: %s", unit->name, time, words);
        unit->log(unit->host, unit->name, STATUS_WARNING, text.at);
    }
}

Status unit_refuse(Unit *unit, const char *function, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    format_values(unit_reason(unit), format, values);
    va_end(values);
    return unit_report(unit, STATUS_ERROR, function);
}
