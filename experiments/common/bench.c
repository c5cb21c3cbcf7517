#include "bench.h"

#include "base/files.h"
#include "run/program.h"

int bench_run(struct plan *plan, const char *measurement, const char *scene, const char *folder) {
    char program[PATH_SIZE];
    const char *argv[] = {program, measurement, scene, folder, NULL, NULL, NULL};
    int argc = 4;
    if (plan->quick)
        argv[argc++] = "--quick";
    if (plan->fresh)
        argv[argc++] = "--fresh";
    if (path_beside_program("wisplab-bench", program)) {
        snprintf(plan->reason, REASON_SIZE, "wisplab-bench: not known where it is");
        return -1;
    }
    const int code = program_run(argv, &plan->limits, plan->reason);
    return code == 0 ? 0 : code == 3 ? 1 : -1;
}
