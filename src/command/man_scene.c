/* wisplab-scene(5). */
#include "build_info.h"
#include "man.h"
#include "scene/scene_settings.h"

#include <stdio.h>
#include <string.h>

void roff(const char *before, const char *text, const char *after) {
    int start = 1;
    printf("%s", before);
    for (; *text; text++) {
        if (start && (*text == '.' || *text == '\''))
            printf("\\&");
        if (*text == '\\')
            printf("\\e");
        else if (*text == '-')
            printf("\\-");
        else
            putchar(*text);
        start = *text == '\n';
    }
    printf("%s", after);
}

/* Paragraphs, parted by empty lines; lines that begin with blanks are examples. */
static void paragraphs(const char *text) {
    int is_example = 0;
    while (*text) {
        const int length = (int)strcspn(text, "\n");
        char line[200];
        snprintf(line, sizeof line, "%.*s", length, text);
        if (!is_example && line[0] == ' ')
            printf(".PP\n.nf\n");
        if (is_example && line[0] != ' ')
            printf(".fi\n");
        is_example = line[0] == ' ';
        roff(*line ? "" : ".PP", line, "\n");
        text += length + (text[length] == '\n');
    }
    if (is_example)
        printf(".fi\n");
}

static const char description[] =
    "A scene is a text file of libconfig: settings, each a name, an equals sign, a value and a\n"
    "semicolon. A value is a number, true or false, a text in quotes, numbers in brackets, a list "
    "in\n"
    "parentheses, or a group of settings in braces. A # begins a comment. All units are SI.\n"
    "\n"
    "  # my-scene.cfg\n"
    "  duration = 1.0;\n"
    "  frame_rate = 30.0;\n"
    "  gravity = [0.0, -9.81, 0.0];\n"
    "  material = { drag_rate = 4.0; };\n"
    "  wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0];\n"
    "              length = 0.30; nodes = 11; } );\n"
    "\n"
    "A line that is @include and a file in quotes takes in that file, from the scene's folder, as "
    "if it\n"
    "stood there. What is wrong in a scene is said in one line: the file and the line, the "
    "setting, what\n"
    "stands there, and what would be right.\n"
    "\n"
    "Results are kept by a hash of the settings, whatever file, order or base they come from; how "
    "a scene\n"
    "is looked at (the group render) is no part of it.\n";

static const char base[] =
    "A scene may say only what differs from another one:\n"
    "\n"
    "  # stiff.cfg\n"
    "  base = \"swing\";\n"
    "  material = { stretch = \"rigid\"; };\n"
    "\n"
    "The base is the path of a file, from the folder of the file that says it, or, without a slash "
    "and\n"
    "without .cfg, the name of a shipped scene. It may have a base itself, but none that leads "
    "back.\n"
    "\n"
    "Groups are merged setting by setting, at every depth. All else is taken whole from the file "
    "that\n"
    "says it, also lists: a scene that says wisps or body has no entry of its base's. A setting "
    "that goes\n"
    "with a choice goes with it: where a scene makes the material rigid, the springs of its base "
    "are no\n"
    "longer there, and where it makes a gust of a steady wind it has to say the gust's own "
    "settings. A\n"
    "group of a base cannot be taken away. A name is not inherited: without one of its own a scene "
    "is\n"
    "called as its file. A start of the base is still read from the base's folder.\n"
    "\n"
    "The result is as if it stood in one file: such a scene has the same hash as that file, and "
    "the same\n"
    "results. An error is said where the value stands, be it in a base.\n";

static const char sets[] =
    "Commands that take a scene take --set PATH=VALUE, which changes a setting; it comes after "
    "all\n"
    "files. PATH is as below: names joined by dots, [0] being the first entry of a list, [1] the "
    "next. A\n"
    "group takes the place of the scene's, but for material, of which only what is named changes:\n"
    "\n"
    "  wisplab run swing --set material.bending=hinge --set 'wisps.[0].length=0.2'\n"
    "  wisplab run swing --set 'material={stretch=\"rigid\";}'\n"
    "\n"
    "`wisplab list settings` prints what follows, one line each, and with -v in columns.\n";

static void print_setting(const struct scene_setting *setting) {
    char right[400], with[100], problems[100], path[100];
    setting_path(setting, path, sizeof path);
    setting_right(setting, right, sizeof right);
    setting_with(setting, with, sizeof with);
    setting_problems(setting, problems, sizeof problems);
    roff(".TP\n\\fB", path, "\\fR\n");
    roff("", setting->meaning, ".\n.br\n");
    roff("", right, setting->initial ? "" : "; required");
    roff(*with ? "; " : "", with, *problems ? "; problems " : "");
    roff("", problems, "\n");
}

/* The settings of a group, and then of the groups in it. */
static void print_group(const char *group) {
    roff(".SS ", *group ? group : "the scene", "\n");
    for (const struct scene_setting *s = scene_settings; s->name; s++)
        if (strcmp(s->group, group) == 0)
            print_setting(s);
}

int man_scene(void) {
    printf(".TH WISPLAB\\-SCENE 5 \"\" \"wisplab %s\" \"File Formats\"\n", WISPLAB_VERSION);
    printf(".SH NAME\nwisplab\\-scene \\- scene files of wisplab\n.SH DESCRIPTION\n");
    paragraphs(description);
    printf(".SH A SCENE THAT BUILDS ON ANOTHER\n");
    paragraphs(base);
    printf(".SH ON THE COMMAND LINE\n");
    paragraphs(sets);
    printf(".SH SETTINGS\n");
    const char *group = NULL;
    for (const struct scene_setting *s = scene_settings; s->name; s++)
        if (!group || strcmp(s->group, group) != 0) {
            int is_first = 1;
            for (const struct scene_setting *before = scene_settings; before < s; before++)
                is_first &= strcmp(before->group, s->group) != 0;
            group = s->group;
            if (is_first)
                print_group(group);
        }
    printf(".SH SEE ALSO\n.BR wisplab (1)\n");
    return 0;
}
