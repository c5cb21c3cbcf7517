/* Whether a run's folder still holds what was written into it. run.json has the hashes of the run's
 * tables and one of itself: a file that is empty, cut, or of which a digit has changed is found out
 * before anybody draws from it. */
#ifndef WISPLAB_SEAL_H
#define WISPLAB_SEAL_H

#include "base/files.h"

#include <jansson.h>

/* The tables that a run may leave; ends with NULL. */
extern const char *const run_tables[];

/* Adds the hashes of the run's tables, an object of names and hashes that it takes over, to a
 * run.json that is otherwise complete, and last its own. */
void seal_add(json_t *json, json_t *files);

/* Whether run.json and the tables that it names are as they were; else what is wrong in `reason`.
 */
int seal_holds(const char *folder, char *reason);

#endif
