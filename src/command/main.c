#include "base/complain.h"
#include "commands.h"
#include "run/runs.h"

#include <gsl/gsl_errno.h>
#include <stdio.h>

int main(int argc, char **argv) {
    gsl_set_error_handler_off(); /* errors are return codes here, never aborts */
    runs_catch_signals();
    const int code = commands_run(argc, argv);
    if (fflush(stdout) || ferror(stdout))
        return complain(2, "standard output cannot be written");
    return code;
}
