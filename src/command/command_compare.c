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

/* A line for each, of one kind; of many that appeared or vanished only the first. */
static void list(const struct comparison *c, enum change change, int all) {
    const int most = all || change == CHANGE_WORSE ? c->count : 10;
    int shown = 0;
    for (int i = 0; i < c->count; i++) {
        const struct difference *d = &c->differences[i];
        if (d->change != change)
            continue;
        if (shown++ < most)
            say("%-9s %s: %s%s%s", words[change], d->table, d->row, d->what[0] ? ": " : "",
                d->what);
    }
    if (shown > most)
        say("%-9s ... and %d more; --all lists them", words[change], shown - most);
}

static int compare(const struct arguments *arguments) {
    char reason[REASON_SIZE];
    struct comparison comparison;
    struct compare_request request = {.older = arguments->words[0],
                                      .newer = arguments->words[1],
                                      .with_times = !argument_given(arguments, "no-times")};
    const char *junit = argument_text(arguments, "junit");
    if (argument_positive(arguments, "tolerance", 0.1, &request.tolerance))
        return 1;
    if (compare_results(&request, &comparison, reason))
        return complain(1, "%s", reason);
    for (int change = CHANGE_WORSE; change < CHANGES; change++)
        list(&comparison, (enum change)change, argument_given(arguments, "all"));
    const int *n = comparison.changes;
    say("%d tables: %d rows are as they were; worse %d, better %d, appeared %d, vanished %d",
        comparison.table_count, n[CHANGE_NONE], n[CHANGE_WORSE], n[CHANGE_BETTER],
        n[CHANGE_APPEARED], n[CHANGE_VANISHED]);
    const int worse = n[CHANGE_WORSE] > 0;
    const int unwritten = junit && compare_write_junit(&comparison, junit, reason);
    compare_free(&comparison);
    if (unwritten)
        return complain(2, "%s", reason);
    return worse ? IS_WORSE : 0;
}

static const struct cli_option options[] = {
    {"tolerance", "R", "relative: what differs by less is as it was (default 0.1)", 0},
    {"no-times", NULL, "leave out CPU times: of two machines", 0},
    {"all", NULL, "list every row, also of many that are better, new or gone", 0},
    {"junit", "FILE", "write the result for programs that run tests: a case for each table", 0},
    {0},
};

const struct command compare_command = {
    .name = "compare",
    .usage = "OLD NEW [--tolerance R] [--no-times] [--all] [--junit FILE]",
    .summary = "what two folders of results have otherwise: better, worse, new, gone",
    .details =
        "OLD and NEW are the --out of experiments. Rows of the tables that both have are joined\n"
        "by what they are about (scene, method, treatment, setting, ...); looked at are error,\n"
        "force evaluations, CPU time (beyond the spreads of both), status and verdict. Exit code\n"
        "4 where something is worse.\n"
        "\n"
        "  wisplab experiment work-precision --scene my.cfg --out before\n"
        "  wisplab experiment work-precision --scene my.cfg --out after    # another build\n"
        "  wisplab compare before after --no-times --tolerance 0.05 --junit compare.xml\n",
    .options = options,
    .words_least = 2,
    .words_most = 2,
    .run = compare,
};
