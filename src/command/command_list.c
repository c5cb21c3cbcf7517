/* wisplab list: what there is, one line each: name, tab, description. */
#include "base/complain.h"
#include "base/files.h"
#include "cli.h"
#include "experiments/common/plan.h"
#include "experiments/registry.h"
#include "model/problems.h"
#include "run/runs.h"
#include "scene/scene_settings.h"

#include <string.h>

static void list_options(const struct option_spec *specs) {
    for (int i = 0; specs && specs[i].name; i++) {
        printf("\t--option %s=", specs[i].name);
        if (specs[i].kind == OPTION_CHOICE)
            printf("%s", specs[i].choices[(int)specs[i].initial]);
        else
            printf("%g", specs[i].initial);
        printf("\t%s", specs[i].help);
        if (specs[i].kind != OPTION_CHOICE)
            printf(" (%g to %g)", specs[i].least, specs[i].most);
        putchar('\n');
    }
}

static void list_steppers(int verbose) {
    for (int i = 0; stepper_methods[i]; i++) {
        const struct stepper_method *method = stepper_methods[i];
        printf("%s\t%s\n", method->name, method->summary);
        if (verbose) {
            printf("\torder %d; %s\n", method->order, method->reference);
            list_options(method->options);
        }
    }
}

static void list_linear(int verbose) {
    for (int i = 0; linear_methods[i]; i++) {
        printf("%s\t%s\n", linear_methods[i]->name, linear_methods[i]->summary);
        if (verbose) {
            printf("\t%s\n", linear_methods[i]->reference);
            list_options(linear_methods[i]->options);
        }
    }
}

static void list_treatments(int verbose) {
    (void)verbose;
    for (int p = 0; problems[p]; p++)
        for (int i = 0; problems[p]->treatments[i].name; i++)
            printf("%s\t%s: %s\n", problems[p]->treatments[i].name, problems[p]->name,
                   problems[p]->treatments[i].summary);
}

static void list_experiments(int verbose) {
    (void)verbose;
    for (int i = 0; experiments[i]; i++) {
        char title[256];
        experiment_title(experiments[i], title);
        printf("%s\t%s\n", experiments[i]->name, title);
    }
}

/* A scene's description is the first line of its file: a comment that is one whole sentence. */
static void list_scenes(int verbose) {
    (void)verbose;
    char folder[PATH_SIZE], line[256];
    glob_t found;
    path_format(folder, "%s/experiments", data_folder());
    files_like(folder, "*.cfg", &found);
    for (size_t i = 0; i < found.gl_pathc; i++) {
        const char *name = strrchr(found.gl_pathv[i], '/') + 1;
        FILE *file = fopen(found.gl_pathv[i], "r");
        if (!file || !fgets(line, sizeof line, file))
            line[0] = '\0';
        const char *text = line + strspn(line, "# ");
        printf("%.*s\t%.*s\n", (int)strlen(name) - 4, name, (int)strcspn(text, "\n"), text);
        if (file)
            fclose(file);
    }
    globfree(&found);
}

/* A cell of a table: a stroke where there is nothing. */
static void list_cell(const char *text) {
    printf("\t%s", text && *text ? text : "-");
}

/* In columns of their own. */
static void list_setting_cells(const struct scene_setting *setting) {
    char type[40], right[REASON_SIZE], text[100];
    setting_type(setting, type, sizeof type);
    list_cell(type);
    list_cell(setting->unit);
    list_cell(setting->initial ? setting->initial : "required");
    setting_what(setting, right, sizeof right);
    list_cell(right);
    setting_problems(setting, text, sizeof text);
    list_cell(text);
    setting_with(setting, text, sizeof text);
    list_cell(text);
    list_cell(setting->meaning);
}

/* In one sentence; most are of wisps, and it says whose the others are. */
static void list_setting_sentence(const struct scene_setting *setting) {
    char right[REASON_SIZE], problem[100], with[100];
    setting_right(setting, right, sizeof right);
    setting_problems(setting, problem, sizeof problem);
    setting_with(setting, with, sizeof with);
    printf("\t%s%s%s%s: %s", right, setting->initial ? "" : " (required)", *with ? ", " : "", with,
           setting->meaning);
    if (!(setting->problems & OF_WISPS))
        printf("; of %s", problem);
}

static void list_settings(int verbose) {
    if (verbose)
        printf("name\ttype\tunit\tdefault\tvalues\tproblems\twith\tmeaning\n");
    for (const struct scene_setting *s = scene_settings; s->name; s++) {
        char path[100];
        setting_path(s, path, sizeof path);
        printf("%s", path);
        (verbose ? list_setting_cells : list_setting_sentence)(s);
        putchar('\n');
    }
}

static const struct {
    const char *name;
    void (*list)(int verbose);
} kinds[] = {
    {"scenes", list_scenes}, {"steppers", list_steppers},       {"treatments", list_treatments},
    {"linear", list_linear}, {"experiments", list_experiments}, {"settings", list_settings},
};

static int list(const struct arguments *arguments) {
    const int verbose = argument_given(arguments, "verbose");
    const char *wanted = arguments->word_count ? arguments->words[0] : NULL;
    int found = 0;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        if (wanted && strcmp(kinds[i].name, wanted) != 0)
            continue;
        if (!wanted)
            printf("%s%s\n", i ? "\n" : "", kinds[i].name);
        kinds[i].list(verbose);
        found = 1;
    }
    if (found)
        return 0;
    return complain(1,
                    "list: no '%s'; there are scenes, steppers, treatments, linear, experiments, "
                    "settings",
                    wanted);
}

static const struct cli_option options[] = {
    {"verbose", NULL, "references and options too, settings in columns (also -v)", 0},
    CLI_PLUGIN_OPTION,
    {0},
};

const struct command list_command = {
    .name = "list",
    .usage = "[scenes|steppers|treatments|linear|experiments|settings] [-v]",
    .summary = "what there is, one line each: name, tab, description",
    .details = "  wisplab list\n  wisplab list steppers -v\n  wisplab list settings\n",
    .options = options,
    .words_most = 1,
    .first_word = "kinds",
    .run = list,
};
