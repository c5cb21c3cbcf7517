/* Diagnoses of chosen runs of an experiment. */
#ifndef WISPLAB_DIAGNOSTICS_H
#define WISPLAB_DIAGNOSTICS_H

#include "run/runs.h"
#include "statements.h"

/* Copies the diagnostics.tsv of a run, made with run_request.diagnostics, into an experiment's
 * folder as diagnostics-VARIANT.tsv, where the experiment's figures are drawn together with one of
 * each such table, and states how much energy no work accounts for; nothing where the run
 * failed before its second frame. Letters of `variant` that a file's name should not have become
 * '-'. Returns 0, or -1 with a reason. */
int keep_diagnostics(const struct run_case *run, const char *folder, const char *variant,
                     struct statements *statements, char *reason);

#endif
