/* wisplab cite: what a paper that uses the program should name. */
#include "base/complain.h"
#include "build_info.h"
#include "cli.h"
#include "integrators/stepper.h"

#include <stdio.h>
#include <string.h>

/* As CITATION.cff has it, with the build that was used. */
static const char entries[] =
    "@software{wisplab,\n"
    "  title   = {wisplab: a testbed for the time integration of deformable hair wisps},\n"
    "  author  = {{The wisplab authors}},\n"
    "%s"
    "  version = {%s},\n"
    "  license = {GPL-3.0-or-later},\n"
    "  note    = {commit %s}\n"
    "}\n"
    "\n"
    "@mastersthesis{plante1999,\n"
    "  title  = {Mouvements et interactions de la chevelure par m{\\`e}ches d{\\'e}formables},\n"
    "  author = {Plante, {\\'E}ric},\n"
    "  school = {Universit{\\'e} de Montr{\\'e}al},\n"
    "  type   = {M{\\'e}moire de ma{\\^i}trise},\n"
    "  year   = {1999}\n"
    "}\n";

static int is_named_before(const struct arguments *arguments, int word) {
    for (int i = 0; i < word; i++)
        if (strcmp(arguments->words[i], arguments->words[word]) == 0)
            return 1;
    return 0;
}

static int cite(const struct arguments *arguments) {
    for (int i = 0; i < arguments->word_count; i++)
        if (!stepper_find(arguments->words[i]))
            return complain(1, "no stepper '%.60s'; `wisplab list steppers` names them",
                            arguments->words[i]);
    printf(entries, *WISPLAB_YEAR ? "  year    = {" WISPLAB_YEAR "},\n" : "", WISPLAB_VERSION,
           WISPLAB_COMMIT);
    for (int i = 0; i < arguments->word_count; i++)
        if (!is_named_before(arguments, i))
            printf("\n%% %s: %s\n", arguments->words[i],
                   stepper_find(arguments->words[i])->reference);
    return 0;
}

static const struct cli_option options[] = {CLI_PLUGIN_OPTION, {0}};

const struct command cite_command = {
    .name = "cite",
    .usage = "[STEPPER ...]",
    .summary = "what a paper that uses the program should name, as BibTeX",
    .details = "The program with its version, and the thesis whose model it integrates; of each\n"
               "stepper that is named, where it comes from, once.\n"
               "\n"
               "  wisplab cite bdf2 cvode >> paper.bib\n",
    .options = options,
    .words_most = CLI_WORDS_MAX,
    .first_word = "steppers",
    .run = cite,
};
