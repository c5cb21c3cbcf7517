/* What the program says on the terminal: names that it was given are made visible. */
#ifndef WISPLAB_COMPLAIN_H
#define WISPLAB_COMPLAIN_H

/* Says one line on standard error and returns the exit code given. */
int complain(int code, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Says one line on standard output. */
void say(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
