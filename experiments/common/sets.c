#include "sets.h"

#include <stdarg.h>
#include <stdio.h>

void set_add(struct sets *sets, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(sets->text[sets->count], SET_SIZE, format, arguments);
    va_end(arguments);
    sets->list[sets->count] = sets->text[sets->count];
    sets->count++;
}
