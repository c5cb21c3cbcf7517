#include "cli.h"

#include "base/complain.h"
#include "base/options.h"
#include "integrators/plugin.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

/* --- what was given --- */

static int option_index(const struct command *command, const char *name, size_t length) {
    for (int i = 0; command->options[i].name; i++)
        if (strlen(command->options[i].name) == length &&
            strncmp(command->options[i].name, name, length) == 0)
            return i;
    return -1;
}

const char *const *argument_list(const struct arguments *arguments, const char *name, int *count) {
    const int i = option_index(arguments->command, name, strlen(name));
    *count = i < 0 ? 0 : arguments->option[i].count;
    return i < 0 ? NULL : arguments->option[i].value;
}

const char *argument_text(const struct arguments *arguments, const char *name) {
    int count;
    const char *const *values = argument_list(arguments, name, &count);
    return count ? values[count - 1] : NULL;
}

const char *argument_or(const struct arguments *arguments, const char *name, const char *absent) {
    const char *text = argument_text(arguments, name);
    return text ? text : absent;
}

int argument_given(const struct arguments *arguments, const char *name) {
    int count;
    argument_list(arguments, name, &count);
    return count > 0;
}

static int is_among(const char *const *list, const char *name) {
    while (*list && strcmp(*list, name) != 0)
        list++;
    return *list != NULL;
}

void argument_command(const struct arguments *arguments, const char *const *but, char *text,
                      size_t size) {
    const struct cli_option *options = arguments->command->options;
    size_t used = (size_t)snprintf(text, size, "wisplab %s", arguments->command->name);
    for (int i = 0; options[i].name; i++)
        for (int k = 0; k < arguments->option[i].count && used < size; k++)
            if (!is_among(but, options[i].name))
                used += (size_t)snprintf(text + used, size - used, " --%s%s%s", options[i].name,
                                         options[i].argument ? " " : "",
                                         options[i].argument ? arguments->option[i].value[k] : "");
}

int argument_positive(const struct arguments *arguments, const char *name, double absent,
                      double *value) {
    const char *text = argument_text(arguments, name);
    *value = absent;
    if (!text || (parse_real(text, value) == 0 && *value > 0))
        return 0;
    return complain(-1, "--%s %.60s: must be a positive number", name, text);
}

int argument_whole(const struct arguments *arguments, const char *name, int absent, int most,
                   int *value) {
    double number;
    if (argument_positive(arguments, name, absent, &number))
        return -1;
    if (number != floor(number) || number > most)
        return complain(-1, "--%s %g: must be a whole number up to %d", name, number, most);
    *value = (int)number;
    return 0;
}

int argument_steppers(const struct arguments *arguments, const char *const **names, int *count) {
    *names = argument_list(arguments, "stepper", count);
    for (int i = 0; i < *count; i++)
        if (!stepper_find((*names)[i]))
            return complain(-1, "no stepper '%s'; `wisplab list steppers` names them", (*names)[i]);
    return 0;
}

int argument_states(const struct arguments *arguments, enum states_format absent,
                    enum states_format *format) {
    const char *name = argument_or(arguments, "states", states_format_names[absent]);
    for (int i = 0; i < STATES_FORMATS; i++)
        if (strcmp(name, states_format_names[i]) == 0) {
            *format = (enum states_format)i;
            return 0;
        }
    return complain(-1, "--states %.60s: must be text, binary or none", name);
}

int argument_limits(const struct arguments *arguments, double default_mebibytes,
                    struct run_limits *limits) {
    double mebibytes;
    *limits = (struct run_limits){.seconds = 0};
    if (argument_positive(arguments, "time-limit", 0, &limits->seconds) ||
        argument_positive(arguments, "memory-limit", default_mebibytes, &mebibytes))
        return -1;
    limits->bytes = mebibytes * 1024 * 1024;
    return 0;
}

int argument_manner(const struct arguments *arguments, struct manner *manner) {
    *manner = (struct manner){.fresh = argument_given(arguments, "fresh"),
                              .show_progress = !argument_given(arguments, "no-progress")};
    return argument_limits(arguments, 4096, &manner->limits) ||
                   argument_whole(arguments, "jobs", (int)sysconf(_SC_NPROCESSORS_ONLN), 1024,
                                  &manner->jobs)
               ? -1
               : 0;
}

/* --- reading it --- */

/* The nearest name by the number of letters that stand at the same place from either end. */
static const char *nearest_option(const struct command *command, const char *name, size_t length) {
    const char *nearest = NULL;
    size_t best = length / 2;
    for (int i = 0; command->options[i].name; i++) {
        const char *other = command->options[i].name;
        size_t front = 0, back = 0;
        while (front < length && other[front] && other[front] == name[front])
            front++;
        while (back + front < length && back + front < strlen(other) &&
               other[strlen(other) - 1 - back] == name[length - 1 - back])
            back++;
        if (front + back > best) {
            best = front + back;
            nearest = other;
        }
    }
    return nearest;
}

/* Reads one option that begins at argv[i]; returns the number of words used, or -1. */
static int read_option(struct arguments *arguments, int argc, char **argv, int i) {
    const char *name = argv[i] + 2;
    const char *equals = strchr(name, '=');
    const size_t length = equals ? (size_t)(equals - name) : strlen(name);
    const struct command *command = arguments->command;
    const int at = option_index(command, name, length);

    if (at < 0) {
        const char *nearest = nearest_option(command, name, length);
        return complain(-1, "%s: no option --%.*s%s%s%s; see wisplab %s --help", command->name,
                        (int)length, name, nearest ? "; did you mean --" : "",
                        nearest ? nearest : "", nearest ? "?" : "", command->name);
    }
    const struct cli_option *option = &command->options[at];
    const int takes_next = option->argument && !equals;
    if (!option->argument && equals)
        return complain(-1, "--%s takes no value", option->name);
    const char *value = equals ? equals + 1 : takes_next && i + 1 < argc ? argv[i + 1] : "";
    if (option->argument && !*value) /* an empty one too: no folder, file or number is */
        return complain(-1, "--%s needs a value: --%s %s", option->name, option->name,
                        option->argument);
    if (arguments->option[at].count >= (option->repeats ? CLI_REPEATS_MAX : 1))
        return complain(-1, "--%s is given too often", option->name);
    for (int k = 0; k < arguments->option[at].count && option->repeats == CLI_DISTINCT; k++)
        if (strcmp(arguments->option[at].value[k], value) == 0)
            return complain(-1, "--%s %.100s is given twice", option->name, value);
    arguments->option[at].value[arguments->option[at].count++] = value;
    return takes_next ? 2 : 1;
}

static int read_arguments(struct arguments *arguments, int argc, char **argv) {
    const struct command *command = arguments->command;
    for (int i = 0; i < argc;) {
        if (strcmp(argv[i], "-v") == 0)
            argv[i] = (char *)"--verbose";
        if (strncmp(argv[i], "--", 2) == 0) {
            const int used = read_option(arguments, argc, argv, i);
            if (used < 0)
                return -1;
            i += used;
        } else if (argv[i][0] == '-' && argv[i][1] != '\0') {
            return complain(-1, "%s: no option %s; options begin with two dashes", command->name,
                            argv[i]);
        } else if (arguments->word_count < command->words_most) {
            arguments->words[arguments->word_count++] = argv[i++];
        } else {
            return complain(-1, "%s: '%s' is one word too many; usage: wisplab %s %s",
                            command->name, argv[i], command->name, command->usage);
        }
    }
    if (arguments->word_count < command->words_least)
        return complain(-1, "%s: something is missing; usage: wisplab %s %s", command->name,
                        command->name, command->usage);
    return 0;
}

/* --- help --- */

static void print_command_help(const struct command *command) {
    printf("wisplab %s %s\n%s\n", command->name, command->usage, command->summary);
    if (command->options[0].name)
        printf("\noptions\n");
    for (int i = 0; command->options[i].name; i++) {
        char left[64];
        snprintf(left, sizeof left, "--%s %s", command->options[i].name,
                 command->options[i].argument ? command->options[i].argument : "");
        printf("  %-26s %s\n", left, command->options[i].help);
    }
    printf("\n%s", command->details);
}

static int load_plugins(const struct arguments *arguments) {
    int count;
    const char *const *files = argument_list(arguments, "plugin", &count);
    char reason[REASON_SIZE];
    for (int i = 0; i < count; i++)
        if (plugin_load(files[i], reason))
            return complain(-1, "--plugin %s", reason);
    return 0;
}

int cli_run(const struct command *command, int argc, char **argv) {
    struct arguments arguments = {.command = command};
    for (int i = 0; i < argc; i++) {
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) {
            print_command_help(command);
            return 0;
        }
    }
    return read_arguments(&arguments, argc, argv) || load_plugins(&arguments)
               ? 1
               : command->run(&arguments);
}
