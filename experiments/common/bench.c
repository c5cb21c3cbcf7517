#include "bench.h"

#include "base/files.h"
#include "integrators/plugin.h"
#include "run/program.h"

int bench_run(struct plan *plan, const char *measurement, const char *scene) {
    char program[PATH_SIZE];
    struct run_limits limits = plan->limits;
    size_t argc = 0, plugged = 0;
    while (plugins()[plugged].method)
        plugged++;
    const char *argv[7 + 2 * (plugged + (size_t)plan->set_count)];
    argv[argc++] = program;
    argv[argc++] = measurement;
    argv[argc++] = scene;
    argv[argc++] = plan->output.folder;
    limits.seconds *= 10; /* of CPU time, which is that by the clock on a machine that is as busy */
    if (plan->quick)
        argv[argc++] = "--quick";
    if (plan->fresh)
        argv[argc++] = "--fresh";
    for (int i = 0; i < plan->set_count; i++) {
        argv[argc++] = "--set";
        argv[argc++] = plan->sets[i];
    }
    for (const struct plugin *p = plugins(); p->method; p++) {
        argv[argc++] = "--plugin";
        argv[argc++] = p->path;
    }
    argv[argc] = NULL;
    if (path_beside_program("wisplab-bench", program))
        return fail_with(plan->reason, "wisplab-bench: not known where it is");
    const int code = program_run(argv, &limits, plan->reason);
    return code == 0 ? 0 : code == 3 ? 1 : -1;
}
