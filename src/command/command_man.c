/* wisplab man, wisplab completion: the man page and bash's completion, printed at build time from
 * the tables that --help is printed from. */
#include "base/complain.h"
#include "build_info.h"
#include "commands.h"
#include "man.h"

#include <stdio.h>
#include <string.h>

/* --- wisplab(1) --- */

static void roff_option(const struct cli_option *option) {
    roff(".TP\n\\fB\\-\\-", option->name, "\\fR");
    if (option->argument)
        roff(" \\fI", option->argument, "\\fR");
    roff("\n", option->help, option->repeats ? "; may be given more than once\n" : "\n");
}

static void roff_command(const struct command *command) {
    roff(".SS wisplab ", command->name, " ");
    roff("", command->usage, "\n");
    roff("", command->summary, "\n");
    for (int i = 0; command->options[i].name; i++)
        roff_option(&command->options[i]);
    roff(".PP\n.nf\n", command->details, ".fi\n");
}

static int print_program(void) {
    printf(".TH WISPLAB 1 \"\" \"wisplab %s\" \"User Commands\"\n", WISPLAB_VERSION);
    printf(".SH NAME\nwisplab \\- compare time integrators on one deformable hair\\-wisp model\n");
    printf(".SH SYNOPSIS\n.B wisplab\n.I COMMAND\n.RI [ OPTION ]...\n");
    printf(".SH DESCRIPTION\n");
    roff("", program_summary, "\n.SH COMMANDS\n");
    for (int i = 0; commands[i]; i++)
        if (!commands[i]->hidden)
            roff_command(commands[i]);
    roff(".SH EXIT STATUS\n", program_exit_codes, ".SH SEE ALSO\n.BR wisplab\\-scene (5)\n");
    return 0;
}

static int man(const struct arguments *arguments) {
    const char *page = arguments->word_count ? arguments->words[0] : NULL;
    if (!page)
        return print_program();
    if (strcmp(page, "scene") == 0)
        return man_scene();
    return complain(1, "man: no page '%.60s'; there is scene, and without a word the program's",
                    page);
}

/* --- bash --- */

/* What an option's value or a command's first word is completed from: a kind that `wisplab list`
 * knows, by the option's name. */
static const struct {
    const char *option, *kind;
} completed[] = {
    {"scene", "scenes"},  {"stepper", "steppers"}, {"treatment", "treatments"},
    {"linear", "linear"}, {"set", "settings"},
};

static void bash_names(void) {
    printf("# The names of a kind, once each; the kinds; the options of steppers and solvers.\n"
           "_wisplab_names() {\n"
           "    case $1 in\n"
           "    kinds) \"${COMP_WORDS[0]}\" list | grep '^[a-z]*$' ;;\n"
           "    options) { \"${COMP_WORDS[0]}\" list steppers -v; \"${COMP_WORDS[0]}\" list linear "
           "-v; } |\n"
           "        sed -n 's/^\\t--option \\([^=]*=\\).*/\\1/p' | sort -u ;;\n"
           "    settings) \"${COMP_WORDS[0]}\" list settings | sed 's/\\t.*/=/' ;;\n"
           "    *) \"${COMP_WORDS[0]}\" list \"$1\" | cut -f 1 | sort -u ;;\n"
           "    esac 2>/dev/null\n"
           "}\n\n");
}

/* The shell's words that complete the value of an option: nothing where it is a number. */
static void bash_value(const struct command *command, const struct cli_option *option) {
    const char *kind = strcmp(option->name, "option") == 0 ? "options" : NULL;
    for (size_t i = 0; i < sizeof completed / sizeof *completed; i++)
        if (strcmp(completed[i].option, option->name) == 0)
            kind = completed[i].kind;
    printf("    %s:--%s)", command->name, option->name);
    if (kind)
        printf(" words=$(_wisplab_names %s)%s", kind,
               strcmp(kind, "scenes") == 0 ? " files=yes" : "");
    else if (strcmp(option->argument, "DIR") == 0 || strcmp(option->argument, "FILE") == 0)
        printf(" files=yes");
    printf(" ;;\n");
}

/* By command and the word before: the value of an option, an option, or the first word. */
static void bash_command(const struct command *command) {
    for (int i = 0; command->options[i].name; i++)
        if (command->options[i].argument)
            bash_value(command, &command->options[i]);
    printf("    %s:*)\n        case $current in\n        -*) words='", command->name);
    for (int i = 0; command->options[i].name; i++)
        printf("--%s ", command->options[i].name);
    printf("--help' ;;\n");
    if (command->first_word)
        printf("        *) words=$(_wisplab_names %s)%s ;;\n", command->first_word,
               strcmp(command->first_word, "scenes") == 0 ? " files=yes" : "");
    printf("        esac ;;\n");
}

static int completion(const struct arguments *arguments) {
    (void)arguments;
    printf("# bash completion of wisplab %s, written by it\n\n", WISPLAB_VERSION);
    bash_names();
    printf("_wisplab() {\n"
           "    local current=${COMP_WORDS[COMP_CWORD]} place words= files=\n"
           "    place=${COMP_WORDS[1]}:${COMP_WORDS[COMP_CWORD - 1]}\n"
           "    [ \"$COMP_CWORD\" -gt 1 ] || place=command\n"
           "    case $place in\n"
           "    command) words='");
    for (int i = 0; commands[i]; i++)
        if (!commands[i]->hidden)
            printf("%s ", commands[i]->name);
    printf("--help --version' ;;\n");
    for (int i = 0; commands[i]; i++)
        if (!commands[i]->hidden)
            bash_command(commands[i]);
    printf("    esac\n"
           "    COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
           "    case ${COMPREPLY[*]} in *=) compopt -o nospace 2>/dev/null ;; esac\n"
           "    if [ -n \"$files\" ]; then\n"
           "        compopt -o filenames 2>/dev/null\n"
           "        COMPREPLY+=($(compgen -f -- \"$current\"))\n"
           "    fi\n"
           "    return 0\n"
           "}\n\n"
           "complete -F _wisplab wisplab\n");
    return 0;
}

static const struct cli_option options[] = {{0}};

const struct command man_command = {
    .name = "man",
    .usage = "[scene]",
    .summary = "print the man page of the program, or of scene files",
    .details = "",
    .options = options,
    .words_most = 1,
    .hidden = 1,
    .run = man,
};

const struct command completion_command = {
    .name = "completion",
    .usage = "",
    .summary = "print bash's completion",
    .details = "",
    .options = options,
    .hidden = 1,
    .run = completion,
};
