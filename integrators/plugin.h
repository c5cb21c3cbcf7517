/* Steppers from outside: shared objects, each with one method, that a user names on the command
 * line. They are loaded once, before anything else is read, and stay: the processes of runs are
 * forked from this one and have them too. */
#ifndef WISPLAB_PLUGIN_H
#define WISPLAB_PLUGIN_H

#include "base/hash.h"
#include "stepper.h"

struct plugin {
    const struct stepper_method *method;
    char *path;           /* absolute */
    char hash[HASH_SIZE]; /* of the file's bytes */
};

/* Loads a plug-in and adds its method to stepper_methods. Returns 0, or -1 with one line in
 * `reason` (REASON_SIZE): the file, and why it is none, or none for this program. A plug-in that
 * crashes in this process, now or later, or calls exit, ends it with 1 and a line that says so. */
int plugin_load(const char *file, char *reason);

/* To be called before main returns: what ends the program from here on is the program. */
void plugins_let_end(void);

/* All that are loaded; ended by one without a method. */
const struct plugin *plugins(void);

/* The plug-in that a method is of; NULL: it is built in. */
const struct plugin *plugin_of(const struct stepper_method *method);

#endif
