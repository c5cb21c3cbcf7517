/* All commands, and the program that they make. */
#ifndef WISPLAB_COMMANDS_H
#define WISPLAB_COMMANDS_H

#include "cli.h"

/* In the order of help; NULL-terminated. */
extern const struct command *const commands[];

/* What --help says of the program and of its exit codes, in the man page too. */
extern const char program_summary[], program_exit_codes[];

/* The program: returns its exit code. */
int commands_run(int argc, char **argv);

#endif
