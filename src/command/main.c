#include "base/complain.h"
#include "commands.h"
#include "integrators/plugin.h"
#include "run/runs.h"

#include <gsl/gsl_errno.h>
#include <stdio.h>

int main(int argc, char **argv) {
    gsl_set_error_handler_off(); /* errors are return codes here, never aborts */
    runs_catch_signals();
    int code = commands_run(argc, argv);
    plugins_let_end();
    if (code == 0 && runs_interrupted())
        code = complain(outcome_exit_code(INTERRUPTED), "interrupted, when all was done");
    if (fflush(stdout) || ferror(stdout))
        return complain(2, "standard output cannot be written");
    return code;
}
