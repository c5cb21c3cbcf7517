/* How near is the kernel to what the hardware can? Evaluations against a plain twin and against
 * the machine's own rates, linear solvers, the seam, CVODE. Measured here and now, not by runs:
 * absolute times mean little, so all contestants are timed in turn and ratios count. */
#include "base/files.h"
#include "experiments/captions.h"
#include "kernel_measure.h"
#include "model/problems.h"
#include "run/record.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static int kernel_plan(struct plan *plan) {
    if (plan->scene_count > 1) {
        snprintf(plan->reason, REASON_SIZE, "experiment kernel takes the material of one scene");
        return -1;
    }
    const struct scene *scene =
        plan_scene(plan, plan->scene_count ? plan->scenes[0] : "swing-envelope", NULL, 0);
    if (!scene)
        return -1;
    if (scene->problem == &wisp_problem && scene->wisps[0].samples > 0)
        return 0;
    snprintf(plan->reason, REASON_SIZE,
             "experiment kernel needs wisps with an envelope, scene "
             "%.60s has none",
             scene->name);
    return -1;
}

/* What the file of samples begins with: program, scene and how long was measured. Samples with the
 * same heading need not be taken again. */
static char *heading_of(const struct plan *plan) {
    char *text = NULL;
    size_t size;
    FILE *stream = open_memstream(&text, &size);
    if (!stream)
        return NULL;
    write_provenance(stream,
                     plan->quick ? "samples of a quick measurement, ns per unit by round"
                                 : "samples of a full measurement, ns per unit by round",
                     plan->loaded[0]);
    fputs("group\tsubject\tcontestant\tvalues\n", stream);
    fclose(stream);
    return text;
}

/* Enters everybody and lets them run. */
static int measure_all(const struct plan *plan, const char *path, const char *heading,
                       char *reason) {
    const struct scene *scene = plan->loaded[0];
    struct atomic_file file;
    struct contest contest = {0};
    if (atomic_open(&file, path, reason))
        return -1;
    fputs(heading, file.stream);
    contest.notes = file.stream;
    enter_evaluations(&contest, scene);
    enter_solvers(&contest, scene);
    enter_steppers(&contest, scene);
    enter_contacts(&contest, scene);
    contest_run(&contest, plan->quick ? 6 : 60, file.stream);
    return atomic_commit(&file, reason);
}

/* The measuring process, whose standard error goes to `errors`. */
static void measuring(struct plan *plan, const char *path, const char *heading, int errors) {
    signal(SIGINT, SIG_DFL);
    signal(SIGTERM, SIG_DFL);
    dup2(errors, STDERR_FILENO);
    const int code = measure_all(plan, path, heading, plan->reason);
    if (code)
        fputs(plan->reason, stderr);
    _exit(code ? 2 : 0);
}

/* What it said, up to the end of it, in place of the reason. */
static void read_reason(int from, char *reason) {
    char rest[256];
    size_t used = 0;
    for (ssize_t n;
         used + 1 < REASON_SIZE && (n = read(from, reason + used, REASON_SIZE - 1 - used)) > 0;)
        used += (size_t)n;
    reason[used] = '\0';
    while (read(from, rest, sizeof rest) > 0)
        ;
    reason[strcspn(reason, "\n")] = '\0';
}

/* In a process of its own: what it allocates and what might befall it is gone with it. Returns 0, 1
 * where an integration failed, or -1. */
static int measure_apart(struct plan *plan, const char *path, const char *heading) {
    int status, errors[2] = {-1, -1};
    fflush(NULL);
    const pid_t pid = pipe(errors) ? -1 : fork();
    if (pid == 0)
        measuring(plan, path, heading, errors[1]);
    if (pid < 0) {
        snprintf(plan->reason, REASON_SIZE, "no process to measure in: %s", strerror(errno));
        close(errors[0]);
        close(errors[1]);
        return -1;
    }
    close(errors[1]);
    read_reason(errors[0], plan->reason);
    close(errors[0]);
    while (waitpid(pid, &status, 0) < 0 && errno == EINTR)
        ;
    atomic_remove_leftovers(path); /* where the process did not come to its end */
    if (WIFSIGNALED(status))
        snprintf(plan->reason, REASON_SIZE, "the measurement died of signal %d (%s)",
                 WTERMSIG(status), strsignal(WTERMSIG(status)));
    return WIFSIGNALED(status) || WEXITSTATUS(status) == 2 ? -1 : WEXITSTATUS(status);
}

/* Reads the samples, after measuring where they are not there. */
static int obtain(struct plan *plan, const char *folder, struct samples *samples) {
    char path[PATH_SIZE];
    char *heading = heading_of(plan);
    int code = heading && path_format(path, "%s/samples.tsv", folder) == 0 ? 0 : -1;
    if (code) {
        snprintf(plan->reason, REASON_SIZE, "out of memory");
    } else if (plan->fresh || !samples_read(samples, path, heading)) {
        code = measure_apart(plan, path, heading);
        if (!code && !samples_read(samples, path, heading)) {
            snprintf(plan->reason, REASON_SIZE, "%.150s: cannot be read back", path);
            code = -1;
        }
    } else {
        printf(
            "kernel: the samples of this program are there already (--fresh takes them again)\n");
    }
    free(heading);
    return code;
}

static int kernel_tabulate(struct plan *plan, const char *folder) {
    struct samples samples;
    int code = obtain(plan, folder, &samples);
    if (code)
        return code;
    code = kernel_tables(plan, &samples, folder);
    samples_free(&samples);
    return code;
}

const struct experiment kernel_experiment = {
    .name = "kernel",
    .question = "how near to the hardware are evaluations, linear solvers, the seam and contacts?",
    .plan = kernel_plan,
    .tabulate = kernel_tabulate,
    .caption = caption_kernel,
};
