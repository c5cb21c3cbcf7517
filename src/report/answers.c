#include "answers.h"

#include "base/files.h"
#include "html.h"
#include "integrators/configurations.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double targets[] = {1e-2, 1e-3, 1e-4}; /* m */
enum { TARGETS = sizeof targets / sizeof *targets, TALLIES_MAX = 64 };

/* Something counted under a name, for the short answer above the long one. */
struct tally {
    char name[96];
    int count, of;
};

/* An answer as it is made: in full to `stream`, and counted. */
struct answer {
    const struct report *report;
    FILE *stream;
    struct tally tallies[TALLIES_MAX];
    int tally_count;
};

/* The tally of that name, made where there is none; the last one where there are too many. */
static struct tally *tally_of(struct answer *answer, const char *name) {
    int i = 0;
    while (i < answer->tally_count && strcmp(answer->tallies[i].name, name) != 0)
        i++;
    if (i == TALLIES_MAX)
        return &answer->tallies[TALLIES_MAX - 1];
    if (i == answer->tally_count) {
        answer->tallies[answer->tally_count++] = (struct tally){.count = 0};
        snprintf(answer->tallies[i].name, sizeof answer->tallies[i].name, "%s", name);
    }
    return &answer->tallies[i];
}

static void count(struct answer *answer, const char *name, int holds) {
    struct tally *tally = tally_of(answer, name);
    tally->count += holds;
    tally->of++;
}

/* --- what is there --- */

static const struct report_part *find_part(const struct report *report, const char *name) {
    for (int i = 0; i < report->part_count; i++)
        if (strcmp(report->parts[i].experiment->name, name) == 0)
            return &report->parts[i];
    return NULL;
}

static int has_part(const struct report *report, const char *name) {
    const struct report_part *part = find_part(report, name);
    return part && part->included;
}

static void say_missing(FILE *stream, const struct report *report, const char *name) {
    const struct report_part *part = find_part(report, name);
    html_print(stream, "Not in this report: experiment %s", name);
    html_print(stream, "%s%s. ", part && part->note[0] ? ", " : "",
               part ? part->note : " is not one of this program");
}

/* A table of an included part. Returns 0, or -1 with a reason. */
static int load(struct text_table *table, const struct report *report, const char *experiment,
                const char *name, const char *suffix, char *reason) {
    char path[PATH_SIZE];
    if (path_format(path, "%s/%s/%s%s.tsv", report->root, experiment, name, suffix) == 0)
        return text_table_read(table, path, reason);
    snprintf(reason, REASON_SIZE, "the path of table %.80s is too long", name);
    return -1;
}

static int is_finished(const struct text_table *table, int row) {
    return strcmp(text_table_cell(table, row, "status"), "finished") == 0;
}

/* Calls `use` for each scene of work-precision, by the name of its files. Returns 0 or its code. */
static int each_scene(struct answer *answer,
                      int (*use)(struct answer *answer, const char *scene, char *reason),
                      char *reason) {
    struct text_table scenes;
    if (load(&scenes, answer->report, "work-precision", "scenes", "", reason))
        return -1;
    int code = 0;
    for (int i = 0; i < scenes.row_count && !code; i++)
        code = use(answer, text_table_cell(&scenes, i, "file"), reason);
    text_table_free(&scenes);
    return code;
}

/* --- was the thesis's choice right? --- */

static const char as_method[] = "as a method (for its accuracy none was clearly cheaper)",
                  as_treatment[] = "as a treatment (no farther from the exact motion than the "
                                   "method's own error)";

/* The run of explicit Euler with projection whose rate is nearest to the thesis's, or -1. */
static int thesis_run(const struct text_table *points) {
    int nearest = -1;
    double least = INFINITY;
    for (int i = 0; i < points->row_count; i++) {
        const double away = fabs(log(thesis_recipe.rate * text_table_number(points, i, "setting")));
        if (strcmp(text_table_cell(points, i, "method"), thesis_recipe.stepper) == 0 &&
            strcmp(text_table_cell(points, i, "treatment"), thesis_recipe.treatment) == 0 &&
            away < least) {
            least = away;
            nearest = i;
        }
    }
    return nearest;
}

/* The cheapest finished run of a treatment (NULL: any) with at most this error, or -1. */
static int cheapest_within(const struct text_table *points, const char *treatment, double error) {
    int best = -1;
    for (int i = 0; i < points->row_count; i++)
        if (is_finished(points, i) &&
            (!treatment || strcmp(text_table_cell(points, i, "treatment"), treatment) == 0) &&
            text_table_number(points, i, "error") <= error &&
            (best < 0 || text_table_number(points, i, "cpu_median") <
                             text_table_number(points, best, "cpu_median")))
            best = i;
    return best;
}

static void judge_choice(struct answer *answer, const char *scene, const struct text_table *points,
                         double treatment_error) {
    FILE *stream = answer->stream;
    const int run = thesis_run(points);
    if (run < 0)
        return;
    const double error = text_table_number(points, run, "error"),
                 cpu = text_table_number(points, run, "cpu_median"),
                 rate = 1 / text_table_number(points, run, "setting");
    html_print(stream, "%s, at %.0f Hz, the run nearest to 9000 Hz: ", scene, rate);
    if (!is_finished(points, run)) {
        html_print(stream, "no, it ended as %s. ", text_table_cell(points, run, "status"));
        count(answer, as_method, 0);
        return;
    }
    const int best = cheapest_within(points, "projection", error);
    const double ratio = cpu / text_table_number(points, best, "cpu_median");
    count(answer, as_method, ratio < 1.1);
    if (ratio < 1.1)
        html_print(stream,
                   "as a method, yes: no run is as accurate (%.2g mm) and clearly cheaper "
                   "(%.3g ms). ",
                   1e3 * error, 1e3 * cpu);
    else
        html_print(stream,
                   "as a method, no: it costs %.2g times what %s does for an error no larger "
                   "(%.2g mm, %.3g ms). ",
                   ratio, text_table_cell(points, best, "method"), 1e3 * error, 1e3 * cpu);
    if (treatment_error > 0) {
        count(answer, as_treatment, treatment_error <= error);
        html_print(stream,
                   "As a treatment, %s: projection is %.2g mm from the exact constrained "
                   "motion, %.2g times the method's error. ",
                   treatment_error > error ? "no" : "yes", 1e3 * treatment_error,
                   treatment_error / error);
    }
}

static int answer_choice(struct answer *answer, const char *scene, char *reason) {
    const struct report *report = answer->report;
    struct text_table points, references;
    if (load(&points, report, "work-precision", scene, "", reason))
        return -1;
    if (load(&references, report, "work-precision", scene, "-reference", reason)) {
        text_table_free(&points);
        return -1;
    }
    const int row = text_table_find(&references, "projection", NULL);
    judge_choice(answer, scene, &points,
                 row < 0 ? NAN : text_table_number(&references, row, "treatment_error"));
    text_table_free(&references);
    text_table_free(&points);
    return 0;
}

/* Of the thesis's own scenes, each run at 9000 Hz: whether another stepper was nearer to the tight
 * solution and cheaper. */
static int answer_scenes(FILE *stream, const struct report *report, char *reason) {
    int there = 0, finished = 0, beaten = 0;
    char rate[32];
    snprintf(rate, sizeof rate, "%.0f Hz", thesis_recipe.rate);
    for (int i = 0; i < report->part_count; i++) {
        struct text_table table;
        const struct report_part *part = &report->parts[i];
        char path[PATH_SIZE];
        if (!part->included ||
            path_format(path, "%s/%s/steppers.tsv", report->root, part->experiment->name) ||
            !file_exists(path))
            continue;
        if (text_table_read(&table, path, reason))
            return -1;
        const int own = text_table_find(&table, thesis_recipe.stepper, rate);
        int better = 0;
        for (int k = 0; own >= 0 && k < table.row_count; k++)
            better |= is_finished(&table, k) &&
                      text_table_number(&table, k, "distance") <
                          text_table_number(&table, own, "distance") &&
                      text_table_number(&table, k, "cpu_per_frame") <
                          text_table_number(&table, own, "cpu_per_frame");
        there += own >= 0;
        finished += own >= 0 && is_finished(&table, own);
        beaten += better;
        text_table_free(&table);
    }
    if (there > 0)
        html_print(stream,
                   "On the thesis's own scenes, at 9000 Hz, it finished on %d of %d, and on "
                   "%d of them another stepper was both nearer to the tight solution and "
                   "cheaper. ",
                   finished, there, beaten);
    return 0;
}

/* --- what would one choose? --- */

static void answer_target(struct answer *answer, const char *scene, const struct text_table *points,
                          const struct text_table *references, double target) {
    FILE *stream = answer->stream;
    char name[96];
    int best = -1;
    for (int i = 0; i < references->row_count; i++) {
        const char *treatment = text_table_cell(references, i, "treatment");
        const double off = text_table_number(references, i, "treatment_error");
        /* errors of method and treatment add at most; bare wisps have no treatment */
        const int run = cheapest_within(points, treatment, target - (off > 0 ? off : 0));
        if (run >= 0 && (best < 0 || text_table_number(points, run, "cpu_median") <
                                         text_table_number(points, best, "cpu_median")))
            best = run;
    }
    snprintf(name, sizeof name, "to %g mm %.60s", 1e3 * target,
             best < 0 ? "none" : text_table_cell(points, best, "method"));
    count(answer, name, 1);
    fputs("<tr><td>", stream);
    html_print(stream, "%s", scene);
    fprintf(stream, "</td><td class=\"number\">%g</td><td>", 1e3 * target);
    if (best < 0) {
        fputs("none of the runs reaches it</td><td>–</td><td>–</td><td>–</td></tr>\n", stream);
        return;
    }
    html_print(stream, "%s", text_table_cell(points, best, "method"));
    fputs("</td><td>", stream);
    html_print(stream, "%s", text_table_cell(points, best, "treatment"));
    fprintf(stream, "</td><td class=\"number\">%.3g</td><td class=\"number\">%.3g</td></tr>\n",
            text_table_number(points, best, "setting"),
            1e3 * text_table_number(points, best, "cpu_median"));
}

static int answer_targets(struct answer *answer, const char *scene, char *reason) {
    const struct report *report = answer->report;
    struct text_table points, references;
    if (load(&points, report, "work-precision", scene, "", reason))
        return -1;
    if (load(&references, report, "work-precision", scene, "-reference", reason)) {
        text_table_free(&points);
        return -1;
    }
    for (int i = 0; i < TARGETS; i++)
        answer_target(answer, scene, &points, &references, targets[i]);
    text_table_free(&references);
    text_table_free(&points);
    return 0;
}

/* --- where does each method fail? --- */

static int is_failure(const char *status) {
    return *status && strcmp(status, "finished") != 0 && strcmp(status, "refused") != 0 &&
           strcmp(status, "left out") != 0;
}

/* Whether row i is the first of its method and treatment. */
static int is_first(const struct text_table *points, int i) {
    const int first = text_table_find(points, text_table_cell(points, i, "method"),
                                      text_table_cell(points, i, "treatment"));
    return first == i;
}

/* How many of a method's runs with a treatment failed, in which ways, and from which setting on
 * none did. Settings of a method stand in the table from coarse to fine. */
static void answer_method(struct answer *answer, const char *scene, const struct text_table *points,
                          int i) {
    const char *method = text_table_cell(points, i, "method"),
               *treatment = text_table_cell(points, i, "treatment");
    FILE *stream = answer->stream;
    char kinds[200] = "";
    const char *note = "";
    int runs = 0, failures = 0, refused = 0;
    double from = NAN;
    for (int k = i; k < points->row_count; k++) {
        const char *status = text_table_cell(points, k, "status");
        if (strcmp(text_table_cell(points, k, "method"), method) != 0 ||
            strcmp(text_table_cell(points, k, "treatment"), treatment) != 0)
            continue;
        const int failed = is_failure(status);
        if (failed || is_finished(points, k)) {
            count(answer, method, failed);
            runs++;
        }
        refused += strcmp(status, "refused") == 0;
        failures += failed;
        if (failed || refused)
            note = text_table_cell(points, k, "note");
        if (failed && !strstr(kinds, status))
            snprintf(kinds + strlen(kinds), sizeof kinds - strlen(kinds), "%s%s",
                     kinds[0] ? ", " : "", status);
        if (failed)
            from = NAN;
        else if (is_finished(points, k) && isnan(from))
            from = text_table_number(points, k, "setting");
    }
    fputs("<tr><td>", stream);
    html_print(stream, "%s", scene);
    fputs("</td><td>", stream);
    html_print(stream, "%s", method);
    fputs("</td><td>", stream);
    html_print(stream, "%s", treatment);
    fprintf(stream, "</td><td>%d of %d</td><td>", failures, runs);
    html_print(stream, "%s", refused ? "refused" : failures ? kinds : "–");
    fputs("</td><td>", stream);
    if (isnan(from))
        fputs("none", stream);
    else
        fprintf(stream, "%.3g", from);
    fputs("</td><td>", stream);
    html_print(stream, "%s", note);
    fputs("</td></tr>\n", stream);
}

static int answer_failures(struct answer *answer, const char *scene, char *reason) {
    const struct report *report = answer->report;
    struct text_table points;
    if (load(&points, report, "work-precision", scene, "", reason))
        return -1;
    for (int i = 0; i < points.row_count; i++)
        if (is_first(&points, i))
            answer_method(answer, scene, &points, i);
    text_table_free(&points);
    return 0;
}

/* --- tables that answer a question by themselves --- */

/* Returns 1 where it was read, 0 where it is not there, -1 with a reason. */
static int read_table(struct text_table *table, const struct report *report, const char *experiment,
                      const char *name, char *reason) {
    char path[PATH_SIZE];
    if (!has_part(report, experiment) ||
        path_format(path, "%s/%s/%s.tsv", report->root, experiment, name) || !file_exists(path))
        return 0;
    return text_table_read(table, path, reason) ? -1 : 1;
}

/* Likewise; `folded`: to be opened by whoever wants it. */
static int show_table(FILE *stream, const struct report *report, const char *experiment,
                      const char *name, int folded, char *reason) {
    struct text_table table;
    const int code = read_table(&table, report, experiment, name, reason);
    if (code <= 0)
        return code;
    if (folded)
        fprintf(stream, "<details><summary>%s.tsv: %d rows</summary>\n", name, table.row_count);
    fputs("<p class=\"about\">", stream);
    html_text(stream, table.about);
    fprintf(stream, " (<a href=\"%s/%s.tsv\">data</a>)</p>\n", experiment, name);
    html_table(stream, &table, NULL);
    if (folded)
        fputs("</details>\n", stream);
    text_table_free(&table);
    return 1;
}

/* --- the section --- */

static void ask(FILE *stream, const char *question) {
    fputs("<h3>", stream);
    html_text(stream, question);
    fputs("</h3>\n", stream);
}

/* The scenes' answers between two pieces of markup, and above them the short one. Returns 0, or -1
 * with a reason. */
static int write_answer(FILE *stream, const struct report *report,
                        int (*use)(struct answer *answer, const char *scene, char *reason),
                        void (*sum_up)(FILE *stream, const struct answer *answer),
                        const char *before, const char *after, char *reason) {
    char *text = NULL;
    size_t size;
    struct answer answer = {.report = report, .stream = open_memstream(&text, &size)};
    if (!answer.stream) {
        snprintf(reason, REASON_SIZE, "out of memory");
        return -1;
    }
    int code = each_scene(&answer, use, reason);
    if (fclose(answer.stream) && !code) {
        snprintf(reason, REASON_SIZE, "out of memory");
        code = -1;
    }
    if (!code) {
        fputs("<p class=\"answer\">", stream);
        sum_up(stream, &answer);
        fprintf(stream, "</p>\n%s%s%s", before, text, after);
    }
    free(text);
    return code;
}

static void sum_up_choice(FILE *stream, const struct answer *answer) {
    if (answer->tally_count == 0)
        html_print(stream, "No scene of this report has such a run.");
    for (int i = 0; i < answer->tally_count; i++)
        html_print(stream, "%s %s on %d of %d scenes%s", i ? "," : "Right", answer->tallies[i].name,
                   answer->tallies[i].count, answer->tallies[i].of,
                   i + 1 == answer->tally_count ? "." : "");
}

static int write_choice(FILE *stream, const struct report *report, char *reason) {
    int code = 0;
    ask(stream, "Was explicit Euler with projection at 9000 Hz, the thesis's choice, right?");
    if (has_part(report, "work-precision"))
        code = write_answer(stream, report, answer_choice, sum_up_choice, "<p>", "</p>\n", reason);
    fputs("<p>", stream);
    if (!has_part(report, "work-precision"))
        say_missing(stream, report, "work-precision");
    if (!code)
        code = answer_scenes(stream, report, reason);
    fputs("</p>\n", stream);
    return code;
}

/* Target by target: the methods, and on how many scenes. */
static void sum_up_targets(FILE *stream, const struct answer *answer) {
    for (int t = 0; t < TARGETS; t++) {
        char prefix[32];
        int said = 0;
        snprintf(prefix, sizeof prefix, "to %g mm ", 1e3 * targets[t]);
        html_print(stream, "%s%g mm: ", t ? "; " : "", 1e3 * targets[t]);
        for (int i = 0; i < answer->tally_count; i++)
            if (strncmp(answer->tallies[i].name, prefix, strlen(prefix)) == 0)
                html_print(stream, "%s%s (%d)", said++ ? ", " : "",
                           answer->tallies[i].name + strlen(prefix), answer->tallies[i].of);
    }
    html_print(stream, " – in parentheses: on so many scenes.");
}

static int write_targets(FILE *stream, const struct report *report, char *reason) {
    ask(stream, "What would one choose today for 10, 1 and 0.1 mm?");
    if (has_part(report, "work-precision"))
        return write_answer(
            stream, report, answer_targets, sum_up_targets,
            "<p>The cheapest run whose error, with that of its treatment against the exact "
            "constrained motion, is no larger. A setting is a step, s, or a relative tolerance."
            "</p>\n<div class=\"wide\"><table><thead><tr><th>scene</th><th>mm</th><th>method</th>"
            "<th>treatment</th><th>setting</th><th>CPU ms</th></tr></thead><tbody>\n",
            "</tbody></table></div>\n", reason);
    fputs("<p>", stream);
    say_missing(stream, report, "work-precision");
    fputs("</p>\n", stream);
    return 0;
}

/* Those that fail somewhere, and those that never did. */
static void sum_up_failures(FILE *stream, const struct answer *answer) {
    for (int fails = 1; fails >= 0; fails--) {
        int said = 0;
        for (int i = 0; i < answer->tally_count; i++) {
            const struct tally *tally = &answer->tallies[i];
            if ((tally->count > 0) != fails)
                continue;
            html_print(stream, "%s%s",
                       said++  ? ", "
                       : fails ? "Failed: "
                               : "Never failed: ",
                       tally->name);
            if (fails)
                html_print(stream, " in %d of %d runs", tally->count, tally->of);
        }
        fputs(said ? ". " : "", stream);
    }
}

/* From which rate on each stepper stays stable, scene by scene, with the treatment that stands
 * first there, and what happens below. Returns 1, 0 where there is no such table, -1 with a reason.
 */
static int sum_up_limits(FILE *stream, const struct report *report, char *reason) {
    struct text_table table;
    const int code = read_table(&table, report, "stability", "largest-step", reason);
    if (code <= 0)
        return code;
    const char *scene = "", *treatment = "";
    for (int i = 0; i < table.row_count; i++) {
        const char *kind = text_table_cell(&table, i, "kind");
        const int next = strcmp(text_table_cell(&table, i, "scene"), scene) != 0;
        if (next) {
            scene = text_table_cell(&table, i, "scene");
            treatment = text_table_cell(&table, i, "treatment");
            html_print(stream, "%sLongest stable steps on %s (%s): ", i ? ". " : "", scene,
                       treatment);
        }
        if (strcmp(text_table_cell(&table, i, "treatment"), treatment) != 0)
            continue;
        html_print(stream, "%s%s ", next ? "" : "; ", text_table_cell(&table, i, "stepper"));
        if (strcmp(kind, "none") == 0)
            html_print(stream, "any");
        else if (isnan(text_table_number(&table, i, "unstable_step")))
            html_print(stream, "%s", kind);
        else if (isnan(text_table_number(&table, i, "step")))
            html_print(stream, "none that was tried (%s)", kind);
        else
            html_print(stream, "1/%.4g s, then %s", text_table_number(&table, i, "rate"), kind);
    }
    html_print(stream, "%s", table.row_count ? "." : "No stepper was tried.");
    text_table_free(&table);
    return 1;
}

static int write_failures(FILE *stream, const struct report *report, char *reason) {
    ask(stream, "Where does each method fail?");
    fputs("<p class=\"answer\">", stream);
    int code = sum_up_limits(stream, report, reason);
    if (code == 0)
        say_missing(stream, report, "stability");
    if (code >= 0 && !has_part(report, "work-precision"))
        say_missing(stream, report, "work-precision");
    fputs("</p>\n", stream);
    if (code >= 0 && has_part(report, "work-precision"))
        code = write_answer(
            stream, report, answer_failures, sum_up_failures,
            "<details><summary>Runs of work-precision</summary>\n<div class=\"wide\">"
            "<table><thead><tr><th>scene</th><th>method</th><th>treatment</th><th>failed</th>"
            "<th>how</th><th>none fails from setting</th><th>the last one's reason</th></tr>"
            "</thead><tbody>\n",
            "</tbody></table></div></details>\n", reason);
    if (code >= 0)
        code = show_table(stream, report, "stability", "largest-step", 1, reason);
    if (code >= 0)
        code = show_table(stream, report, "stability", "failures", 1, reason);
    return code < 0 ? -1 : 0;
}

/* What the smallest model of each scene has, by the table's columns between its name and how far it
 * was compared, and what that saves. Returns 1, 0 where there is no such table, -1 with a reason.
 */
static int sum_up_needs(FILE *stream, const struct report *report, char *reason) {
    struct text_table table;
    const int code = read_table(&table, report, "needs", "smallest", reason);
    if (code <= 0)
        return code;
    const int from = text_table_column(&table, "scene") + 1,
              to = text_table_column(&table, "compared");
    for (int i = 0; i < table.row_count; i++) {
        const double ratio = text_table_number(&table, i, "cost_ratio");
        html_print(stream, "%s%s: ", i ? " " : "", text_table_cell(&table, i, "scene"));
        for (int k = from, said = 0; k < to && isfinite(ratio); k++) {
            const char *cell = text_table_cell(&table, i, table.name[k]);
            if (strcmp(cell, "-") != 0)
                html_print(stream, "%s%s", said++ ? ", " : "", cell);
        }
        if (isfinite(ratio))
            html_print(stream, ", at %.2g of the full model's cost.", ratio);
        else
            html_print(stream, "no answer.");
    }
    text_table_free(&table);
    return 1;
}

static int write_needs(FILE *stream, const struct report *report, char *reason) {
    ask(stream, "What does each scene need?");
    fputs("<p class=\"answer\">", stream);
    int code = sum_up_needs(stream, report, reason);
    if (code == 0)
        say_missing(stream, report, "needs");
    fputs("</p>\n", stream);
    if (code > 0)
        code = show_table(stream, report, "needs", "smallest", 0, reason);
    return code < 0 ? -1 : 0;
}

int answers_write(FILE *stream, const struct report *report, char *reason) {
    fputs("<section id=\"answers\"><h2>Answers</h2>\n", stream);
    int code = write_choice(stream, report, reason);
    if (!code)
        code = write_targets(stream, report, reason);
    if (!code)
        code = write_failures(stream, report, reason);
    if (!code)
        code = write_needs(stream, report, reason);
    fputs("</section>\n", stream);
    return code;
}
