/* Sweeps: what the runs are, that each is done once whoever is killed or comes along, and that what
 * a run did is in its row. */
#include "base/text_table.h"
#include "experiments/sweep/cells.h"
#include "experiments/sweep/share.h"
#include "experiments/sweep/work.h"
#include "run/results.h"
#include "support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static char *folder;
static char reason[REASON_SIZE];

static void set_up(void) {
    folder = folder_make();
}

/* --- values --- */

Test(sweep, values_are_read_as_they_are_written) {
    static const struct {
        const char *text;
        const char *values[6];
    } cases[] = {
        {"rate=300..900:3", {"300", "600", "900"}},
        {"step=1..-1:5", {"1", "0.5", "0", "-0.5", "-1"}},
        {"stiffness=10..1000:log:3", {"10", "100", "1000"}},
        {"x=1e-6..0.01:log:3", {"1e-06", "0.0001", "0.01"}},
        {"x=0.1..0.5:3", {"0.1", "0.3", "0.5"}},
        {"x=3000000000..4000000000:2", {"3000000000.0", "4000000000.0"}},
        {"bending=skip,stiff", {"skip", "stiff"}},
        {"start=../a.tsv", {"../a.tsv"}},
        {"gravity=[0.0, -9.81, 0.0],[1,2,3]", {"[0.0, -9.81, 0.0]", "[1,2,3]"}},
        {"wind={ kind = \"a,b\"; v = (1, 2); },{}", {"{ kind = \"a,b\"; v = (1, 2); }", "{}"}},
        {"material.bending=skip, stiff", {"skip", "stiff"}},
        {"name=\"a}\",\"b\"", {"\"a}\"", "\"b\""}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct vary vary;
        const size_t name = strcspn(cases[i].text, "=");
        cr_assert_eq(vary_read(&vary, cases[i].text, reason), 0, "%s", reason);
        cr_assert(strlen(vary.name) == name && strncmp(vary.name, cases[i].text, name) == 0,
                  "%s: '%s'", cases[i].text, vary.name);
        int count = 0;
        for (; cases[i].values[count]; count++)
            cr_assert(count < vary.count && strcmp(vary.value[count], cases[i].values[count]) == 0,
                      "%s: value %d is '%s'", cases[i].text, count + 1, vary.value[count]);
        cr_assert_eq(vary.count, count, "%s: %d values", cases[i].text, vary.count);
        vary_free(&vary);
    }
}

/* Both ends are there, and neighbours have equal ratios. */
Test(sweep, ranges_are_even) {
    struct vary vary;
    cr_assert_eq(vary_read(&vary, "x=0.1..0.7:log:1001", reason), 0, "%s", reason);
    cr_assert_eq(vary.count, 1001);
    cr_assert(strcmp(vary.value[0], "0.1") == 0 && strcmp(vary.value[1000], "0.7") == 0);
    for (int i = 1; i <= 1000; i++) {
        const double ratio = atof(vary.value[i]) / atof(vary.value[i - 1]);
        cr_assert(fabs(ratio / pow(7, 1e-3) - 1) < 1e-11, "%s, %s", vary.value[i - 1],
                  vary.value[i]);
    }
    vary_free(&vary);
}

/* One line that says what, and nothing is made. */
Test(sweep, what_is_wrong_is_one_line, .init = set_up) {
    static const struct {
        const char *words[6], *says;
    } cases[] = {
        {{"--vary", "rate"}, "--vary rate: write NAME=A,B,C or NAME=FROM..TO:N"},
        {{"--vary", "rate="}, "--vary rate=: write"},
        {{"--vary", "=3"}, "--vary =3: write"},
        {{"--vary", "rate=1..2"}, "a range is FROM..TO:N, or FROM..TO:log:N"},
        {{"--vary", "rate=1..2:3:4"}, "a range is"},
        {{"--vary", "rate=1..2:lag:4"}, "a range is"},
        {{"--vary", "rate=1..x:4"}, "a range is"},
        {{"--vary", "rate=1..2:1"}, "whole number from 2"},
        {{"--vary", "rate=1..2:2.5"}, "whole number from 2"},
        {{"--vary", "rate=1..2:1e9"}, "whole number from 2"},
        {{"--vary", "rate=0..2:log:3"}, "must be positive"},
        {{"--vary", "rate=-1e308..1e308:3"}, "too far apart"},
        {{"--vary", "rate=1e-300..1e300:log:3"}, "too far apart"},
        {{"--vary", "rate=1,,2"}, "a value is empty"},
        {{"--vary", "rate=1,2,"}, "a value is empty"},
        {{"--vary", "rate=1\t2"}, "cannot stand in a table"},
        {{"--vary", "rate=fast"}, "rate=fast: must be a positive number"},
        {{"--vary", "rate=300,-3"}, "rate=-3: must be a positive number"},
        {{"--vary", "draw=1.5", "--vary", "perturb=1"}, "draw=1.5: must be a whole number"},
        {{"--vary", "draw=1,2"}, "draw=1: says which displacement, and there is none"},
        {{"--vary", "stepper=rk4,euler"}, "give --stepper for each"},
        {{"--vary", "rate=300", "--step", "0.1"}, "step and rate say the same thing"},
        {{"--vary", "rate=300", "--vary", "rate=301"}, "rate=301: that setting is given twice"},
        {{"--vary", "rate=1..1:3"}, "--vary rate=1..1:3: the value 1 is given twice"},
        {{"--vary", "rate=1..1.0000000000001:3"}, "the value 1 is given twice"},
        {{"--vary", "rate=300,9000,300"}, "the value 300 is given twice"},
        {{"--vary", "rate=300,9000,3e2"}, "given twice, also as 3"},
        {{"--vary", "wisps.[0].nodes=5, 6, 5"}, "the value 5 is given twice"},
        {{"--vary", "material.bending=skip,none,skip"}, "the value skip is given twice"},
        {{"--stepper", "rk4", "--stepper", "rk4"}, "--stepper rk4 is given twice"},
        {{"--stepper", "rk5"}, "no stepper 'rk5'"},
        {{"--vary", "material.gum=1,2"}, "gum: unknown setting"},
        {{"--vary", "wisps.[0].nodes=5,1"}, "nodes: 1 is not a whole number"},
        {{"--vary", "option.gum=1,2"}, "no option 'gum'"},
        {{"--vary", "treatment=guess"}, "no treatment 'guess'"},
        {{"--set", "gravity"}, "write --set NAME=VALUE"},
        {{"--vary", "a=1..9:50000", "--vary", "b=1..9:50000"}, "runs are too many"},
    };
    const char *const out = printed("%s/out", folder);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *words[12] = {"sweep", "swing", "--out", out};
        for (int k = 0; cases[i].words[k]; k++)
            words[4 + k] = cases[i].words[k];
        program_must(NULL, 1, cases[i].says, words);
        cr_assert_not(file_exists(out), "%s: a folder was made", cases[i].says);
    }
}

/* --- rows --- */

static void read_table(struct text_table *table) {
    const char *const path = printed("%s/table.tsv", folder);
    table_must_be_read(table, folder, "table");
    cr_assert_eq(text_table_check(table, path, reason), 0, "%s", reason);
    columns_must_be_described(path);
}

static int new_of(const struct finished *f, int runs) {
    int count;
    const int new = new_runs(f, &count);
    cr_assert_eq(count, runs, "%d runs", count);
    return new;
}

/* All in the product, with the last setting first; and each is the run that `wisplab run` does. */
Test(sweep, each_row_is_that_run, .init = set_up) {
    struct text_table table;
    struct run_files run;
    struct finished *f =
        WORKS("sweep", "swing", "--duration", "0.1", "--set", "frame_rate=100", "--stepper", "rk4",
              "--stepper", "bdf2", "--vary", "wisps.[0].nodes=5,11", "--vary", "rate=6000..12000:3",
              "--out", folder);
    cr_assert_eq(new_of(f, 12), 12);
    cr_assert_eq(count_files(folder, ""), 2, "more than a table and a file of results");
    read_table(&table);
    cr_assert_eq(table.row_count, 12);
    for (int i = 0; i < 12; i++) {
        static const char *const rates[] = {"6000", "9000", "12000"};
        const char *stepper = i < 6 ? "rk4" : "bdf2", *nodes = i / 3 % 2 ? "11" : "5";
        cr_assert_eq(text_table_number(&table, i, "run"), i + 1);
        cr_assert_str_eq(text_table_cell(&table, i, "stepper"), stepper);
        cr_assert_str_eq(text_table_cell(&table, i, "wisps.[0].nodes"), nodes);
        cr_assert_str_eq(text_table_cell(&table, i, "rate"), rates[i % 3]);
        const char *const out = printed("%s/one", folder);
        PROGRAM(NULL, "run", "swing", "--duration", "0.1", "--set", "frame_rate=100", "--stepper",
                stepper, "--set", printed("wisps.[0].nodes=%s", nodes), "--rate", rates[i % 3],
                "--out", out);
        cr_assert_eq(run_read(&run, out, reason), 0, "%s", reason);
        static const struct {
            const char *column, *path;
        } same[] = {{"frames", "frames"},
                    {"wisps", "wisps"},
                    {"steps", "counters.steps"},
                    {"force_evaluations", "counters.force_evaluations"},
                    {"newton_iterations", "counters.newton_iterations"},
                    {"largest_strain", "largest_strain"},
                    {"step_least", "step_least"},
                    {"simulated_time", "simulated_time"}};
        for (size_t k = 0; k < sizeof same / sizeof *same; k++)
            cr_assert_eq(text_table_number(&table, i, same[k].column),
                         run_number(&run, same[k].path), "run %d: %s is %s, not %.17g", i + 1,
                         same[k].column, text_table_cell(&table, i, same[k].column),
                         run_number(&run, same[k].path));
        cr_assert(text_table_number(&table, i, "cpu_seconds") > 0);
        run_free(&run);
    }
}

/* Half the step, a sixteenth of the error; and what is no step of a method is a row. */
Test(sweep, errors_are_those_of_the_method, .init = set_up) {
    struct finished *f;
    struct text_table table;
    for (int with = 0; with <= 1; with++) { /* runs without an error are other runs */
        f = WORKS("sweep", "swing", "--duration", "0.2", "--stepper", "rk4", "--stepper", "cvode",
                  "--set", "material.stretch_stiffness=9", "--vary", "step=6e-5,1.2e-4,2.4e-4,1e-2",
                  "--out", folder, with ? "--reference" : NULL);
        cr_assert_eq(new_of(f, 8), 4, "'%s'", f->out);
    }
    cr_assert(strstr(f->out, "3 finished") && strstr(f->out, "1 diverged") &&
                  strstr(f->out, "4 refused"),
              "'%s'", f->out);
    read_table(&table);
    static const char *const errors[] = {"error_rms", "error_largest", "error_end"};
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++) {
            const double order = log2(text_table_number(&table, i + 1, errors[k]) /
                                      text_table_number(&table, i, errors[k]));
            cr_assert(fabs(order - 4) < 0.15, "%s: order %.3f", errors[k], order);
        }
    cr_assert(text_table_number(&table, 0, "error_largest") >
              text_table_number(&table, 0, "error_rms"));
    cr_assert(text_table_number(&table, 0, "error_rms") >
              text_table_number(&table, 0, "reference_bound"));
    cr_assert_str_eq(text_table_cell(&table, 3, "status"), "diverged");
    cr_assert(strstr(text_table_cell(&table, 4, "reason"), "this stepper chooses its steps"));
    FAILS(1, "is of wisps", "sweep", "circle", "--reference", "--out", folder);
}

/* Their folders are those of `wisplab run`, and the rows those without. */
Test(sweep, states_are_there_where_they_are_asked_for, .init = set_up) {
    struct text_table with, without;
    WORKS("sweep", "swing", "--duration", "0.1", "--vary", "rate=100,9000", "--out", folder);
    cr_assert_eq(count_files(folder, "states"), 0);
    read_table(&without);
    struct finished *f = WORKS("sweep", "swing", "--duration", "0.1", "--vary", "rate=100,9000",
                               "--states", "text", "--reference", "--out", folder);
    cr_assert_eq(new_of(f, 2), 2);
    cr_assert_eq(count_files(folder, "states.tsv"), 2);
    cr_assert_eq(count_files(folder, "run.json"), 3, "two and the reference");
    read_table(&with);
    cr_assert_str_eq(text_table_cell(&with, 0, "status"), "diverged");
    cr_assert(text_table_number(&with, 1, "error_rms") > 0);
    for (int i = 0; i < 2; i++)
        cr_assert_str_eq(text_table_cell(&with, i, "force_evaluations"),
                         text_table_cell(&without, i, "force_evaluations"));
}

/* --- each once --- */

#define RUNS 120

static struct process begin_many(void) {
    return program_start(NULL, WORDS("sweep", "swing", "--duration", "0.02", "--vary",
                                     "rate=6000..9000:60", "--vary", "wisps.[0].nodes=7,8",
                                     "--jobs", "2", "--out", folder));
}

static struct finished *do_many(void) {
    const struct process process = begin_many();
    return program_wait(&process);
}

static int lines_of(const char *path) {
    const char *text = file_read(path);
    return text ? count_lines(text) : 0;
}

static void add_lines(const char *path, void *ctx) {
    int *lines = ctx;
    if (strstr(path, "/packed-"))
        *lines += lines_of(path);
}

static int results(void) {
    int lines = 0;
    each_file(folder, add_lines, &lines);
    return lines;
}

/* The table without its column of times. */
static char *table_but_times(void) {
    char *text = file_of(folder, "table.tsv"), *kept = calloc(strlen(text) + 1, 1);
    test_owns(kept, free);
    int column = -1;
    for (char *at = text, *line; (line = strsep(&at, "\n")) != NULL;) {
        int k = 0;
        for (char *cells = line, *cell; *line != '#' && (cell = strsep(&cells, "\t")) != NULL;
             k++) {
            if (strcmp(cell, "cpu_seconds") == 0)
                column = k;
            else if (k != column)
                strcat(strcat(kept, cell), "\t");
        }
        strcat(strcat(kept, *line == '#' ? line : ""), "\n");
    }
    cr_assert(column > 0, "no column of times");
    return kept;
}

static char *undisturbed(void) {
    struct finished *f = do_many();
    cr_assert_eq(new_of(f, RUNS), RUNS);
    cr_assert_eq(results(), RUNS);
    char *table = table_but_times();
    folder = folder_make();
    return table;
}

/* By the user, and then by a machine that loses its power. */
Test(sweep, goes_on_after_an_interruption_and_after_kill_9, .init = set_up) {
    char *expected = undisturbed();
    struct finished *f;
    for (int round = 0; round < 2; round++) {
        const int signal = round ? SIGKILL : SIGINT, before = results();
        const struct process process = begin_many();
        while (results() < before + 20 && kill(process.pid, 0) == 0)
            wait_for(1e-3);
        kill(process.pid, signal);
        f = program_wait(&process);
        cr_assert_eq(f->code, round ? -SIGKILL : 3, "exit code %d: %s", f->code, f->err);
        cr_assert(round || strstr(f->err, "the same command goes on from here"), "'%s'", f->err);
    }
    const int before = results();
    cr_assert(before >= 40 && before < RUNS, "%d are there", before);
    f = do_many();
    cr_assert_eq(new_of(f, RUNS), RUNS - before, "%s", f->out);
    cr_assert_eq(results(), RUNS, "%d results: some were done twice", results());
    cr_assert_eq(count_files(folder, ".claim"), 0, "a claim is left");
    cr_assert_str_eq(table_but_times(), expected);
}

/* Each run is done by one of them, and both write the table that one alone writes. */
Test(sweep, processes_share_a_folder, .init = set_up) {
    char *expected = undisturbed();
    int shared = 0;
    for (int i = 0; i < 5 && !shared; i++) { /* one may have done all before the other begins */
        struct process processes[3];
        int new = 0, most = 0;
        folder = folder_make();
        for (int k = 0; k < 3; k++)
            processes[k] = begin_many();
        for (int k = 0; k < 3; k++) {
            struct finished *f = program_wait(&processes[k]);
            cr_assert_eq(f->code, 0, "exit code %d: %s", f->code, f->err);
            const int one = new_of(f, RUNS);
            new += one;
            most = one > most ? one : most;
        }
        cr_assert(new == RUNS &&results() == RUNS, "%d new runs, %d results", new, results());
        cr_assert_eq(count_files(folder, ".claim"), 0, "a claim is left");
        cr_assert_str_eq(table_but_times(), expected);
        shared = most < RUNS;
    }
    cr_assert(shared, "one did all the runs every time");
}

static const char *packed;

static void find_packed(const char *path, void *ctx) {
    (void)ctx;
    if (strstr(path, "/packed-"))
        packed = printed("%s", path);
}

/* Half a line is none, and one of which a digit has changed is none either. */
Test(sweep, a_line_that_is_not_whole_is_not_taken, .init = set_up) {
#define FEW "sweep", "swing", "--duration", "0.02", "--vary", "rate=6000..9000:5", "--out", folder
    PROGRAM(NULL, FEW);
    char *expected = table_but_times();
    each_file(folder, find_packed, NULL);
    char *text = file_read(packed);
    cr_assert_eq(truncate(packed, (off_t)strlen(text) - 1), 0);
    struct finished *f = PROGRAM(NULL, FEW);
    cr_assert_eq(new_of(f, 5), 1, "the line without its end was taken");
    cr_assert_str_eq(f->err, "", "nothing is damaged: '%s'", f->err);
    char *digit = strpbrk(strstr(text, "finished\t"), "123456789");
    *digit = *digit == '9' ? '8' : '9';
    folder = folder_make();
    const char *const runs = printed("%s/runs", folder);
    cr_assert_eq(make_folder(runs, reason), 0, "%s", reason);
    file_write(runs, "packed-0.tsv", text);
    f = PROGRAM(NULL, FEW);
    cr_assert_eq(new_of(f, 5), 1, "a damaged line was taken");
    cr_assert(count_lines(f->err) == 1 && strstr(f->err, "/packed-0.tsv:1: damaged; runs"), "'%s'",
              f->err);
    cr_assert_str_eq(table_but_times(), expected);
    f = PROGRAM(NULL, FEW); /* the line is there still, and nothing is left to be done */
    cr_assert_eq(new_of(f, 5), 0);
    cr_assert_str_eq(f->err, "", "'%s'", f->err);
    file_write(runs, "packed-1.tsv", "no\tline\nat all\n");
    file_write(runs, "packed-2.tsv", "nor\there\n");
    f = PROGRAM(NULL, FEW, "--stepper", "midpoint");
    cr_assert_eq(new_of(f, 5), 5);
    cr_assert(count_lines(f->err) == 1 && strstr(f->err, "damaged, and 3 more in this folder"),
              "'%s'", f->err);
}

/* --- runs that die --- */

static enum outcome die(const struct run_case *run, const struct watch *watch, char *why) {
    const struct sweep_job *job = run->ctx;
    if (job->run == 1) {
        signal(SIGSEGV, SIG_DFL); /* sanitizers catch it */
        raise(SIGSEGV);
    }
    if (job->run == 2)
        _exit(7);
    return sweep_sink.run(run, watch, why);
}

/* A run that crashes has that as its outcome, and the others go on. */
Test(sweep, a_crash_is_a_row, .init = set_up) {
    const struct run_sink sink = {die, sweep_sink.death};
    const struct run_limits limits = {.seconds = 0};
    static const char *const steppers[] = {"rk4"};
    int ran = 0;
    struct sweep sweep = {.scene = "swing",
                          .out = folder,
                          .steppers = steppers,
                          .stepper_count = 1,
                          .vary = calloc(2, sizeof *sweep.vary),
                          .vary_count = 2,
                          .states = STATES_NONE};
    cr_assert_eq(vary_read(&sweep.vary[0], "rate=6000..9000:5", reason), 0);
    cr_assert_eq(vary_read(&sweep.vary[1], "duration=0.02", reason), 0);
    cr_assert_eq(sweep_plan(&sweep, reason), 0, "%s", reason);
    cr_assert_eq(sweep_share(&sweep, &sink, &limits, 2, 0, &ran, reason), FINISHED, "%s", reason);
    cr_assert_eq(ran, 5);
    for (int i = 0; i < 5; i++) {
        const char *status = i == 1 || i == 2 ? "crashed\t" : "finished\t";
        cr_assert(strncmp(sweep.runs[i].cells, status, strlen(status)) == 0, "run %d: '%s'", i + 1,
                  sweep.runs[i].cells);
    }
    cr_assert(strstr(sweep.runs[1].cells, "signal 11") && strstr(sweep.runs[2].cells, "code 7"));
    sweep_free(&sweep);
}
