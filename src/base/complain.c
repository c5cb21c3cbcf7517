#include "complain.h"

#include "files.h"
#include "visible.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { LINE_SIZE = 4 * PATH_SIZE };

/* One line stays one line, and tells the terminal nothing. */
static void print_line(FILE *stream, const char *format, va_list arguments) {
    char line[LINE_SIZE], shown[LINE_SIZE];
    vsnprintf(line, sizeof line, format, arguments);
    visible_text(line, shown, sizeof shown);
    fprintf(stream, "%s\n", shown);
}

int complain(int code, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    fputs("wisplab: ", stderr);
    print_line(stderr, format, arguments);
    va_end(arguments);
    return code;
}

void complain_last(const char *why) {
    const char *const parts[] = {isatty(STDERR_FILENO) ? "\r\033[K" : "", "wisplab: ", why, "\n"};
    for (int i = 0; i < 4; i++)
        if (write(STDERR_FILENO, parts[i], strlen(parts[i])) < 0)
            return;
}

void say(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    print_line(stdout, format, arguments);
    va_end(arguments);
}
