#include "base/failure.h"

#include <stdarg.h>

#include "base/text.h"

int fail(Failure *failure, const char *format, ...)
{
    Text words = text_in(failure->words, sizeof failure->words);
    va_list values;
    va_start(values, format);
    text_format_values(&words, format, values);
    va_end(values);
    return failure->code = 1;
}
