#include "commands.h"

#include "base/complain.h"
#include "build_info.h"

#include <stdio.h>
#include <string.h>

extern const struct command list_command, run_command, eval_command, experiment_command,
    plot_command, render_command, export_command, report_command, sweep_command, compare_command,
    cite_command, man_command, completion_command;

const struct command *const commands[] = {
    &list_command,       &run_command,
    &eval_command,       &experiment_command,
    &sweep_command,      &report_command,
    &compare_command,    &cite_command,
    &plot_command,       &render_command,
    &export_command,     &man_command,
    &completion_command, NULL,
};

const char program_summary[] =
    "wisplab compares time integrators on one deformable hair-wisp model.";
const char program_exit_codes[] =
    "Exit codes: 0 done, 1 the input or the command is wrong, 2 the machine failed\n"
    "(disk full, no memory, gnuplot missing), 3 the integration failed and run.json says\n"
    "how and when, 4 compare has found something worse.\n";

static void print_help(void) {
    printf("%s\n\nusage: wisplab COMMAND ...\n\n", program_summary);
    for (int i = 0; commands[i]; i++)
        if (!commands[i]->hidden)
            printf("  %-12s %s\n", commands[i]->name, commands[i]->summary);
    printf("\nTry\n"
           "  wisplab run circle --stepper rk4 --step 3.2\n"
           "  wisplab experiment circle\n"
           "  wisplab run --help\n\n");
    fputs(program_exit_codes, stdout);
}

int commands_run(int argc, char **argv) {
    const char *name = argc > 1 ? argv[1] : "--help";
    if (strcmp(name, "--version") == 0) {
        printf("wisplab %s (commit %s, %s; %s)\n", WISPLAB_VERSION, WISPLAB_COMMIT,
               WISPLAB_COMPILER, WISPLAB_LIBRARIES);
        return 0;
    }
    if (strcmp(name, "-h") == 0 || strcmp(name, "--help") == 0 || strcmp(name, "help") == 0) {
        print_help();
        return 0;
    }
    for (int i = 0; commands[i]; i++)
        if (strcmp(commands[i]->name, name) == 0)
            return cli_run(commands[i], argc - 2, argv + 2);
    return complain(1, "no command '%.60s'; see wisplab --help", name);
}
