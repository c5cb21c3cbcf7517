/* What a run leaves: states.tsv or states.npy (or no states) and, where the settings ask for it,
 * diagnostics.tsv, both written frame by frame, and run.json. */
#ifndef WISPLAB_RECORD_H
#define WISPLAB_RECORD_H

#include "simulation.h"

/* Runs a case in this process and writes its tables and `folder`/run.json, which get their names
 * together, run.json last, when all are complete. With settings->timings, the run is then repeated
 * for its CPU time, without output or diagnoses, until there are so many times; a long one without
 * diagnoses is the first of them itself, less its frames. With a cross-check, the other method runs
 * too and the largest difference is recorded. Returns how the run ended, and in `how`, which may be
 * NULL, what it took; the reason of a REFUSED or OUTPUT_FAILED is in `reason` (REASON_SIZE). */
enum outcome record_run(const struct scene *scene, const struct settings *settings,
                        const char *folder, const struct watch *watch, struct run_result *how,
                        char *reason);

/* Undoes limit_memory: a run that took all the memory it may, or nearly, left none to write that
 * down with. */
void lift_memory_limit(void);

/* Writes run.json for a run whose process died or was ended after `reached` seconds, and keeps the
 * complete frames that it had written: the folder's only temporary files are its. Names appear as
 * record_run's. Returns 0, or -1 with a reason. */
int record_death(const struct scene *scene, const struct settings *settings, const char *folder,
                 enum outcome outcome, const char *why, double reached, char *reason);

/* The `#` lines at the top of every table: program, scene, hash; `what` says what it is. */
void write_provenance(FILE *stream, const char *what, const struct scene *scene);

#endif
