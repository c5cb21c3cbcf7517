#include "run_experiment.h"

#include "base/complain.h"
#include "base/files.h"
#include "picture/plot.h"
#include "run/results.h"
#include "run/runs.h"
#include "run/warnings.h"
#include "statements.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Runs those cases from the first one given that `which` chooses, the last ones first: experiments
 * name cheap scenes before costly ones, and the longest runs had best not be begun when all others
 * are done. Returns their number, or the negative of an exit code. */
static int do_chosen(const struct plan *plan, int first, struct manner *manner, const char *which,
                     char *reason) {
    struct run_case *cases = calloc((size_t)(plan->case_count - first) + 1, sizeof *cases);
    int count = 0;
    if (!cases)
        return -complain(2, "out of memory");
    for (int i = plan->case_count - 1; i >= first; i--) {
        const struct run_case *run = &plan->cases[i].run;
        char path[PATH_SIZE];
        if (!which[i - first])
            continue;
        cases[count++] = *run;
        if (manner->fresh && path_format(path, "%s/run.json", run->folder) == 0)
            unlink(path);
    }
    const int ran =
        runs_do_all(cases, count, &manner->limits, manner->jobs, manner->show_progress, reason);
    free(cases);
    if (ran < 0)
        return -complain(outcome_exit_code((enum outcome) - ran), "%s", reason);
    manner->runs += count;
    manner->new_runs += ran;
    return count;
}

/* Runs that were killed from outside twice are not there. Returns 0 or an exit code. */
static int check_there(const struct plan *plan, int first) {
    int missing = 0;
    for (int i = first; i < plan->case_count; i++)
        missing += !run_is_complete(plan->cases[i].run.folder);
    return missing ? complain(2,
                              "%s: %d runs were killed from outside and are left out; the same "
                              "command tries them again",
                              plan->experiment->name, missing)
                   : 0;
}

/* References first: how far they stretch says how far the others may. Returns 0 or an exit code. */
static int do_runs(struct plan *plan, int first, struct manner *manner, char *reason) {
    const int count = plan->case_count - first;
    char *which = calloc((size_t)count + 1, 1);
    if (!which)
        return complain(2, "out of memory");
    for (int i = 0; i < count; i++)
        which[i] = plan->cases[first + i].run.settings.method->checked_by != NULL;
    int code = do_chosen(plan, first, manner, which, reason);
    if (code >= 0 && plan_allow_strain(plan, first, which))
        code = -complain(2, "%s", plan->reason);
    for (int i = 0; i < count && code >= 0; i++)
        which[i] = !which[i] && !plan->cases[first + i].run.settings.method->checked_by;
    if (code >= 0)
        code = do_chosen(plan, first, manner, which, reason);
    free(which);
    if (code < 0)
        return -code;
    return check_there(plan, first);
}

/* The plan's runs, and then those that they call for, round by round. */
static int do_rounds(struct plan *plan, struct manner *manner) {
    const struct experiment *experiment = plan->experiment;
    if (manner->limits.seconds == 0)
        manner->limits.seconds = plan->run_seconds > 0 ? plan->run_seconds : 60;
    plan->limits = manner->limits;
    for (int first = 0, next; first < plan->case_count; first = next) {
        next = plan->case_count;
        const int code = do_runs(plan, first, manner, plan->reason);
        if (code)
            return code;
        if (experiment->refine && experiment->refine(plan))
            return complain(2, "%s", plan->reason);
    }
    if (manner->runs > 0)
        printf("%s: %d runs, %d of them new\n", experiment->name, manner->runs, manner->new_runs);
    return 0;
}

/* Marks the runs that did not finish. Returns their number, or -1 having said why. */
static int find_failures(const struct plan *plan, char *failed) {
    int count = 0;
    for (int i = 0; i < plan->case_count; i++) {
        struct run_files run;
        char reason[REASON_SIZE];
        if (run_read(&run, plan->cases[i].run.folder, reason))
            return complain(-1, "%s; --fresh runs it again", reason);
        failed[i] = run.outcome != FINISHED;
        count += failed[i];
        run_free(&run);
    }
    return count;
}

static void say_failure(const struct labelled_case *one) {
    struct run_files run;
    char reason[REASON_SIZE];
    if (run_read(&run, one->run.folder, reason))
        return;
    printf("  %s, %s: %s at t = %g s (%s)\n", one->group, one->label, outcome_name(run.outcome),
           run_number(&run, "simulated_time"),
           json_string_value(json_object_get(run.json, "reason")));
    run_free(&run);
}

/* One line for the group of case `first`, and none where an earlier case spoke for it. */
static void say_group(const struct plan *plan, const char *failed, int first) {
    const char *group = plan->cases[first].group;
    int runs = 0, failures = 0;
    for (int i = 0; i < plan->case_count; i++) {
        if (strcmp(plan->cases[i].group, group) != 0)
            continue;
        if (i < first)
            return;
        runs++;
        failures += failed[i];
    }
    if (failures > 0)
        printf("  %s: %d of %d runs did not finish\n", group, failures, runs);
}

/* Failures are results: every run that did not finish in one line, or where there are many, how
 * many in each group; the tables have them all. */
static int list_failures(const struct plan *plan) {
    enum { FEW = 12 };
    char *failed = calloc((size_t)plan->case_count + 1, 1);
    const int count = failed ? find_failures(plan, failed) : complain(-1, "out of memory");
    for (int i = 0; i < plan->case_count && count > 0; i++) {
        if (count > FEW)
            say_group(plan, failed, i);
        else if (failed[i])
            say_failure(&plan->cases[i]);
    }
    free(failed);
    return count < 0 ? -1 : 0;
}

static int tabulate_and_draw(struct plan *plan, struct manner *manner) {
    char folder[PATH_SIZE];
    const char *name = plan->experiment->name;
    if (path_format(folder, "%s/%s", plan->out, name) || make_folder(folder, plan->reason))
        return complain(2, "%s", plan->reason);
    plan->output = (struct output){.folder = folder, .reason = plan->reason};
    int code = output_close(&plan->output, plan->experiment->tabulate(plan));
    if (!code)
        code = statements_print(folder, plan->reason);
    const int undrawn = !code && !runs_interrupted() && plot_experiment(name, folder, plan->reason);
    if (runs_interrupted()) /* so may gnuplot have been, and what is measured in tabulate */
        return complain(3, "interrupted; the same command goes on from here");
    manner->nothing_left = code > 0;
    if (code || undrawn)
        return complain(code > 0 ? 3 : 2, "%s", plan->reason);
    printf("%s: tables and figures in %s\n", name, folder);
    return 0;
}

/* Variants of a scene have the warnings that it has: each is said once. Steps that are too long are
 * what experiments look for. */
static void say_warnings(const struct plan *plan) {
    json_t *said = json_object();
    for (int i = 0; i < plan->loaded_count; i++) {
        json_t *warnings = scene_warnings(plan->loaded[i], NULL), *one;
        size_t k;
        json_array_foreach(warnings, k, one) {
            if (!json_object_get(said, json_string_value(one)))
                complain(0, "warning: %s: %s", plan->loaded[i]->name, json_string_value(one));
            json_object_set(said, json_string_value(one), one);
        }
        json_decref(warnings);
    }
    json_decref(said);
}

int run_experiment(struct plan *plan, struct manner *manner) {
    plan->taken = calloc((size_t)plan->stepper_count + 1, 1);
    if (!plan->taken)
        return complain(2, "out of memory");
    if (plan->experiment->plan(plan) || plan_check(plan))
        return complain(1, "%s", plan->reason);
    say_warnings(plan);
    const int code = do_rounds(plan, manner);
    if (code)
        return code;
    return list_failures(plan) ? 2 : tabulate_and_draw(plan, manner);
}
