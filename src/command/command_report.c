/* wisplab report: every experiment, and one page of all. */
#include "base/complain.h"
#include "base/files.h"
#include "base/progress.h"
#include "cli.h"
#include "experiments/registry.h"
#include "report/report.h"

#include <time.h>

static const struct cli_option options[] = {
    {"quick", NULL, "a small, stated subset, in less than two minutes on two cores", 0},
    {"fresh", NULL, "run again what is there already", 0},
    {"jobs", "N", "runs at a time; timed runs are always alone (default: processors)", 0},
    {"out", "DIR", "root folder of results (default results)", 0},
    CLI_PLUGIN_OPTION,
    CLI_LIMIT_OPTIONS,
    {0},
};

/* Wall time that an experiment is known to take, s; 0: it is left out. */
static double seconds_of(const struct experiment *experiment, int quick) {
    const double own = quick ? experiment->quick_seconds : experiment->full_seconds;
    return !quick && own == 0 ? 60 : own;
}

/* Whether an experiment comes before another that is listed before it: it has a place, and the
 * other one none or a later one. */
static int comes_before(const struct experiment *experiment, const struct experiment *other) {
    return experiment->place > 0 && (other->place == 0 || experiment->place < other->place);
}

/* All experiments, in the order of their places. */
static void add_parts(struct report *report) {
    for (int i = 0; experiments[i] && report->part_count < REPORT_PARTS_MAX; i++) {
        int at = report->part_count++;
        for (; at > 0 && comes_before(experiments[i], report->parts[at - 1].experiment); at--)
            report->parts[at] = report->parts[at - 1];
        report->parts[at] = (struct report_part){.experiment = experiments[i]};
    }
}

/* Says what the part must do without. Which parts there are depends on nothing but --quick: a slow
 * machine takes longer. */
static void plan_part(const struct report *report, struct report_part *part) {
    part->included = seconds_of(part->experiment, report->quick) > 0;
    if (!part->included)
        snprintf(part->note, REASON_SIZE, "left out of --quick");
    else if (report->quick)
        snprintf(part->note, REASON_SIZE, "cut to its --quick subset");
}

/* The experiment's runs, tables and figures. An experiment whose integrations left nothing to
 * tabulate is a part of the report that says so. Returns 0 or an exit code. */
static int do_part(const struct report *report, struct report_part *part,
                   const struct manner *manner) {
    struct manner own = *manner;
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    part->since = (double)now.tv_sec - 0.1; /* file systems' clocks are a tick behind */
    struct plan plan = {.experiment = part->experiment,
                        .quick = report->quick,
                        .fresh = manner->fresh,
                        .out = report->root,
                        .trajectories = trajectories_create()};
    int code = run_experiment(&plan, &own);
    if (own.nothing_left) {
        snprintf(part->note, REASON_SIZE, "failed: %.350s", plan.reason);
        part->included = 0;
        code = 0;
    }
    plan_free(&plan);
    trajectories_free(plan.trajectories);
    return code;
}

/* The share of the whole that is done before part i, by what the parts are known to take. */
static double done_before(const struct report *report, int i) {
    double before = 0, all = 0;
    for (int k = 0; k < report->part_count; k++) {
        const double own = seconds_of(report->parts[k].experiment, report->quick);
        before += k < i ? own : 0;
        all += own;
    }
    return before / all;
}

static int write_page(const struct report *report) {
    char reason[REASON_SIZE];
    const int code = report_write(report, reason);
    if (code)
        return complain(code > 0 ? 3 : 2, "%s", reason);
    say("report: %s/report.html", report->root);
    return 0;
}

static int make_report(const struct arguments *arguments) {
    char command[512];
    struct report report = {.root = argument_or(arguments, "out", "results"),
                            .quick = argument_given(arguments, "quick"),
                            .command = command};
    struct manner manner;
    argument_command(arguments, (const char *const[]){"out", "no-progress", NULL}, command,
                     sizeof command);
    const double start = monotonic_seconds();
    int code = 0;
    if (argument_manner(arguments, &manner))
        return 1;
    add_parts(&report);
    for (int i = 0; i < report.part_count && !code; i++) {
        plan_part(&report, &report.parts[i]);
        progress_of_whole("report", start, done_before(&report, i), done_before(&report, i + 1));
        if (report.parts[i].included)
            code = do_part(&report, &report.parts[i], &manner);
        else
            say("%s: %s", report.parts[i].experiment->name, report.parts[i].note);
    }
    return code ? code : write_page(&report);
}

const struct command report_command = {
    .name = "report",
    .usage = "[--quick] [--fresh] [--jobs N] [--out DIR]",
    .summary = "every experiment, and one page of all: report.html",
    .details =
        "The page is DIR/report.html: figures, tables, methods, machine, in one file that needs\n"
        "no other; its links to data are relative to it. On two cores it takes less than half\n"
        "an hour, with --quick less than two minutes; what was left out is said there. Runs that\n"
        "are there already are not run again.\n"
        "\n"
        "  wisplab report --quick\n"
        "  wisplab report --out /tmp/everything\n",
    .options = options,
    .run = make_report,
};
