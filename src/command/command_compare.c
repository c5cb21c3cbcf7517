/* wisplab compare: what two folders of results have otherwise. */
#include "base/complain.h"
#include "base/files.h"
#include "cli.h"
#include "report/compare.h"

#include <string.h>

enum { IS_WORSE = 4 }; /* exit code */

static const char *const words[CHANGES] = {[CHANGE_WORSE] = "worse",
                                           [CHANGE_BETTER] = "better",
                                           [CHANGE_APPEARED] = "appeared",
                                           [CHANGE_VANISHED] = "vanished"};

static void say_more(const char *word, int more) {
    if (more > 0)
        say("%-9s ... and %d more; --all lists them", word, more);
}

/* A line for each, of one kind: of what is worse up to a hundred of each table, of the others only
 * the first ten. */
static void list(const struct comparison *c, enum change change, int all) {
    const int most = all ? c->count : change == CHANGE_WORSE ? 100 : 10;
    const char *table = "";
    int count = 0;
    for (int i = 0; i < c->count; i++) {
        const struct difference *d = &c->differences[i];
        if (d->change != change)
            continue;
        if (change == CHANGE_WORSE && strcmp(d->table, table) != 0) {
            say_more(words[change], count - most);
            table = d->table;
            count = 0;
        }
        if (count++ < most)
            say("%-9s %s: %s%s%s", words[change], d->table, d->row, d->what[0] ? ": " : "",
                d->what);
    }
    say_more(words[change], count - most);
}

static void list_left_out(const struct comparison *c, int all) {
    const int most = all ? c->table_count : 10;
    int count = 0;
    for (int i = 0; i < c->table_count; i++)
        if (c->tables[i].left_out && !c->tables[i].alone && count++ < most)
            say("left out: %s: %s", c->tables[i].name, c->tables[i].left_out);
    say_more("left out:", count - most);
}

static int compare(const struct arguments *arguments) {
    char reason[REASON_SIZE];
    struct comparison comparison;
    struct compare_request request = {.older = arguments->words[0],
                                      .newer = arguments->words[1],
                                      .with_times = !argument_given(arguments, "no-times"),
                                      .complete = argument_given(arguments, "complete")};
    const char *junit = argument_text(arguments, "junit");
    const int all = argument_given(arguments, "all");
    if (argument_positive(arguments, "tolerance", 0.1, &request.tolerance))
        return 1;
    if (compare_results(&request, &comparison, reason))
        return complain(1, "%s", reason);
    for (int change = CHANGE_WORSE; change < CHANGES; change++)
        list(&comparison, (enum change)change, all);
    list_left_out(&comparison, all);
    const int *n = comparison.changes;
    int compared = 0, failures = 0;
    for (int i = 0; i < comparison.table_count; i++) {
        compared += !comparison.tables[i].left_out;
        failures += comparison.tables[i].failures;
    }
    say("%d tables: %d rows are as they were; worse %d, better %d, appeared %d, vanished %d; "
        "tables left out: %d",
        compared, n[CHANGE_NONE], n[CHANGE_WORSE], n[CHANGE_BETTER], n[CHANGE_APPEARED],
        n[CHANGE_VANISHED], comparison.left_out);
    const int unwritten = junit && compare_write_junit(&comparison, junit, reason);
    compare_free(&comparison);
    if (unwritten)
        return complain(2, "%s", reason);
    return failures > 0 ? IS_WORSE : 0;
}

static const struct cli_option options[] = {
    {"tolerance", "R", "relative: what differs by less is as it was (default 0.1)", 0},
    {"no-times", NULL, "leave out CPU times: of two machines", 0},
    {"complete", NULL, "what vanished is worse too: rows, columns and tables", 0},
    {"all", NULL, "list everything, also of many rows of one kind", 0},
    {"junit", "FILE", "write the result for programs that run tests: a case for each table", 0},
    {0},
};

const struct command compare_command = {
    .name = "compare",
    .usage = "OLD NEW [--tolerance R] [--no-times] [--complete] [--all] [--junit FILE]",
    .summary = "what two folders of results have otherwise: better, worse, new, gone",
    .details =
        "OLD and NEW are the --out of experiments, or of sweeps. Rows of the tables that both\n"
        "have are joined by what they are about (scene, method, treatment, setting, ...; in a\n"
        "sweep all that it varies), and of several rows about the same the first with the first,\n"
        "the second with the second. Looked at are errors, force evaluations, the longest stable\n"
        "steps, CPU time (beyond the spreads of both; not a sweep's, whose runs are timed once),\n"
        "status and verdict; the tables that have none of these are left out, by name.\n"
        "\n"
        "Exit code 4 where something is worse, with --complete also where something vanished: a\n"
        "row, a column that is looked at or says what rows are about, a table. Without it what\n"
        "vanished is told, and the exit code is 0: where methods are searched for their longest\n"
        "step or for the cheapest, rows come and go. 1 where OLD and NEW have nothing in common.\n"
        "\n"
        "  wisplab experiment work-precision --scene my.cfg --out before\n"
        "  wisplab experiment work-precision --scene my.cfg --out after    # another build\n"
        "  wisplab compare before after --no-times --tolerance 0.05 --junit compare.xml\n",
    .options = options,
    .words_least = 2,
    .words_most = 2,
    .run = compare,
};
