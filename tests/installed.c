/* What stands beside the program: man page, completion, and the program where it is installed. */
#include "command/commands.h"
#include "support.h"

#include <criterion/criterion.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* --- man page --- */

/* Every command and every option that --help knows, each in its own command's part. */
Test(man, page_has_every_option_of_every_command) {
    struct finished *f = WORKS("man");
    for (int i = 0; commands[i]; i++) {
        const char *const head = printed("\n.SS wisplab %s ", commands[i]->name);
        char *part = strstr(f->out, head);
        cr_assert_eq(part != NULL, !commands[i]->hidden, "%s", commands[i]->name);
        if (!part)
            continue;
        char *end = strstr(part + 1, "\n.SS ");
        if (end)
            *end = '\0';
        for (const struct cli_option *o = commands[i]->options; o->name; o++) {
            char text[128] = "\n\\fB\\-\\-";
            for (const char *c = o->name; *c; c++)
                snprintf(text + strlen(text), sizeof text - strlen(text), *c == '-' ? "\\-" : "%c",
                         *c);
            snprintf(text + strlen(text), sizeof text - strlen(text), "\\fR");
            cr_assert(strstr(part, text), "%s lacks --%s", commands[i]->name, o->name);
        }
        if (end)
            *end = '\n';
    }
    cr_assert(strstr(f->out, ".SH EXIT STATUS") && strstr(f->out, ".SH NAME"));
}

/* --- completion --- */

/* What bash offers for the last of these words, each between blanks, one run of bash for all. */
static const char *complete(const char *words) {
    const struct finished *f = shell(
        "bash -c '. %s && COMP_WORDS=(%s %s) && COMP_CWORD=$((${#COMP_WORDS[@]} - 1)) && "
        "_wisplab && echo \" ${COMPREPLY[*]} \"'",
        file_write(folder_make(), "wisplab.bash", WORKS("completion")->out), program_path, words);
    cr_assert_eq(f->code, 0, "%s: %s", words, f->out);
    return f->out;
}

static const struct {
    const char *words;
    const char *offers[4];
    const char * not [2];
} completions[] = {
    {"\"\"", {"run", "report", "list", "eval"}, {"man", "completion"}},
    {"rep", {"report"}, {"run"}},
    {"list \"\"", {"scenes", "steppers", "settings", "experiments"}, {"circle"}},
    {"run sw", {"swing", "swing-envelope"}, {"circle"}},
    {"run swing --stepper \"\"", {"rk4", "implicit-euler", "reference"}, {"swing"}},
    {"run swing --treatment p", {"projection", "penalty"}, {"free"}},
    {"run swing --linear \"\"", {"direct", "klu", "cholmod", "cg"}, {"rk4"}},
    {"run swing --set material.d", {"material.drag_rate="}, {"material"}},
    {"run swing --option n", {"newton.iterations="}, {"max_order="}},
    {"run swing --st", {"--step", "--stepper"}, {"--rate"}},
    {"experiment w", {"work-precision", "wind"}, {"circle"}},
    {"experiment circle --scene sw", {"swing"}, {"rk4"}},
    {"report --", {"--quick", "--out", "--jobs", "--help"}, {"--stepper"}},
};

Test(man, completion_offers_what_the_tables_have) {
    for (size_t i = 0; i < sizeof completions / sizeof *completions; i++) {
        const char *word, *offered = complete(completions[i].words);
        for (int k = 0; k < 4 && completions[i].offers[k]; k++) {
            word = printed(" %s ", completions[i].offers[k]);
            cr_assert(strstr(offered, word), "wisplab %s: no%sin%s", completions[i].words, word,
                      offered);
        }
        for (int k = 0; k < 2 && completions[i].not [k]; k++) {
            word = printed(" %s ", completions[i].not [k]);
            cr_assert(!strstr(offered, word), "wisplab %s:%sin%s", completions[i].words, word,
                      offered);
        }
    }
}

/* A number is not completed, and least of all with options. */
Test(man, completion_offers_nothing_for_a_number) {
    const char *const offered = complete("run swing --step \"\"");
    cr_assert_eq(strspn(offered, " \n"), strlen(offered), "'%s'", offered);
}

/* --- installed --- */

Test(installed, program_works_from_any_folder) {
    static const char *const files[] = {
        "bin/wisplab",
        "bin/wisplab-bench",
        "share/man/man1/wisplab.1",
        "share/man/man5/wisplab-scene.5",
        "share/bash-completion/completions/wisplab",
        "share/wisplab/experiments/circle.cfg",
        "share/wisplab/experiments/figure.inc",
        "share/wisplab/experiments/wind-start.tsv",
        "share/wisplab/experiments/parting-start.tsv",
        "share/wisplab/experiments/wind-start-projection.tsv",
        "share/wisplab/experiments/scipy_swing.py",
        "share/wisplab/plots/style.gp",
        "share/wisplab/plots/work-precision.gp",
    };
    static const char *const commands_there[] = {
        "%s/bin/wisplab list scenes | grep -q ^wind-settle",
        "%s/bin/wisplab run circle --no-progress",
        "%s/bin/wisplab run wind --duration 0.01 --no-progress --out wind",
        "%s/bin/wisplab experiment interactions --quick --no-progress",
        "%s/bin/wisplab experiment kernel --time-limit 0.05 2>&1 | grep 'bench: out of time'",
    };
    const char *path;
    const char *const prefix = folder_make();
    const char *const elsewhere = folder_make();
    SHELL(WISPLAB_CMAKE " --install " WISPLAB_BUILD_DIR " --prefix %s", prefix);
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        path = printed("%s/%s", prefix, files[i]);
        cr_assert(file_exists(path), "%s is not installed", files[i]);
    }
    for (size_t i = 0; i < sizeof commands_there / sizeof *commands_there; i++)
        SHELL("cd %s && %s", elsewhere, printed(commands_there[i], prefix));
    path = printed("%s/results/interactions/series.svg", elsewhere);
    cr_assert(file_exists(path), "no figure");
}

/* The library can become a shared one: it knows neither its own place nor another process's. */
Test(installed, library_is_position_independent) {
    SHELL("cd %s && ld -shared -o whole.so --whole-archive %s/libwisplab-core.a && "
          "! nm -D whole.so | grep -e ptrace -e __executable_start",
          folder_make(), WISPLAB_BUILD_DIR);
}

/* README's first command is to name the commit, so it brings git where there is none. */
Test(installed, bootstrap_brings_git) {
    char text[4096] = "";
    const char *const folder = folder_make();
    const char *script = file_write(folder, "dpkg-query", "#!/bin/sh\nexit 0\n");
    chmod(script, 0755);
    const char *const path = printed("PATH=%s", folder);
    script = printed("%s/../bootstrap.sh", WISPLAB_TESTS_DIR);
    const struct launch shell = {.program = "/usr/bin/env"};
    struct finished *f = PROGRAM(&shell, path, "/bin/sh", script);
    snprintf(text, sizeof text, "%.4000s ", f->err);
    text[strcspn(text, "\n")] = ' ';
    cr_expect(f->code == 1 && strstr(text, "would install") && strstr(text, " git "), "%d: '%s'",
              f->code, f->err);
}
