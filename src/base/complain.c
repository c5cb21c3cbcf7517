#include "complain.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>

int complain(int code, const char *format, ...) {
    char line[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    for (char *c = line; *c; c++)
        if (iscntrl((unsigned char)*c)) /* of a name that was given: one line stays one line */
            *c = '?';
    fprintf(stderr, "wisplab: %s\n", line);
    return code;
}
