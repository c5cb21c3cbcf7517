/* The command line as data: commands and options in tables, from which parsing, --help and
 * completion come. */
#ifndef WISPLAB_CLI_H
#define WISPLAB_CLI_H

#include "experiments/common/run_experiment.h"

enum { CLI_OPTIONS_MAX = 32, CLI_REPEATS_MAX = 64, CLI_WORDS_MAX = 32 };
enum { CLI_ONCE, CLI_REPEATS, CLI_DISTINCT };

/* Ends with a name of NULL. */
struct cli_option {
    const char *name;     /* without the dashes */
    const char *argument; /* its name in help; NULL: a flag */
    const char *help;
    int repeats; /* may be given more than once; CLI_DISTINCT: but no value twice */
};

/* What was given, checked against a command's table. */
struct arguments {
    const struct command *command;
    const char *words[CLI_WORDS_MAX]; /* what is no option */
    int word_count;
    struct {
        const char *value[CLI_REPEATS_MAX];
        int count;
    } option[CLI_OPTIONS_MAX]; /* in the order of the command's table */
};

struct command {
    const char *name;
    const char *usage; /* after the name */
    const char *summary;
    const char *details; /* paragraphs and examples of --help */
    const struct cli_option *options;
    int words_least, words_most;
    const char *first_word; /* for completion: what `wisplab list` calls it, or "kinds" of these */
    int hidden;             /* for the build, and not in help */
    int (*run)(const struct arguments *arguments); /* returns the exit code */
};

/* The last value of an option, or NULL or `absent`; all of a repeated one; whether a flag was
 * given. */
const char *argument_text(const struct arguments *arguments, const char *name);
const char *argument_or(const struct arguments *arguments, const char *name, const char *absent);
const char *const *argument_list(const struct arguments *arguments, const char *name, int *count);
int argument_given(const struct arguments *arguments, const char *name);

/* The command with its options as one would type it, but for those in `but`, NULL-terminated. */
void argument_command(const struct arguments *arguments, const char *const *but, char *text,
                      size_t size);

/* Values of options, `absent` where not given. All of them return 0, or -1 having said on standard
 * error why they are wrong. A positive number, and a whole one up to `most`: */
int argument_positive(const struct arguments *arguments, const char *name, double absent,
                      double *value);
int argument_whole(const struct arguments *arguments, const char *name, int absent, int most,
                   int *value);

/* --stepper, as often as it is there, and --states. */
int argument_steppers(const struct arguments *arguments, const char *const **names, int *count);
int argument_states(const struct arguments *arguments, enum states_format absent,
                    enum states_format *format);

/* The option of commands that know steppers, to be put into their tables: plug-ins are loaded
 * before a command begins. */
#define CLI_PLUGIN_OPTION \
    { "plugin", "FILE", "a stepper of your own, a shared object FILE.so", CLI_REPEATS }

/* The options that every command with runs takes, to be put into its table. */
#define CLI_LIMIT_OPTIONS                                                              \
    {"time-limit", "SECONDS",                                                          \
     "end a run that takes more CPU time; ten times that by the clock: no result", 0}, \
        {"memory-limit", "MIB", "end a run that needs more memory", 0}, {              \
        "no-progress", NULL, "show no progress line", 0                                \
    }
int argument_limits(const struct arguments *arguments, double default_mebibytes,
                    struct run_limits *limits);

/* All of how runs of experiments are done: these, --jobs and, where there is such, --fresh. */
int argument_manner(const struct arguments *arguments, struct manner *manner);

/* Runs a command with the words after its name: what it returns, or 0 after --help, or 1 having
 * said what is wrong with the words. */
int cli_run(const struct command *command, int argc, char **argv);

#endif
