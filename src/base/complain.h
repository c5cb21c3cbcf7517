/* What the program says on the terminal: names that it was given are made visible. */
#ifndef WISPLAB_COMPLAIN_H
#define WISPLAB_COMPLAIN_H

/* Says one line on standard error and returns the exit code given. */
int complain(int code, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* The complaint of a process that is about to end wherever it is, in a signal's handler or without
 * memory; in place of a line of progress. */
void complain_last(const char *why);

/* Says one line on standard output. */
void say(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
