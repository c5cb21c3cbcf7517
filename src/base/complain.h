/* What the program says on standard error. */
#ifndef WISPLAB_COMPLAIN_H
#define WISPLAB_COMPLAIN_H

/* Says one line on standard error and returns the exit code given. */
int complain(int code, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
