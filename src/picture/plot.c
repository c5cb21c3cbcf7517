#include "plot.h"

#include "base/memory.h"
#include "integrators/configurations.h"
#include "run/program.h"
#include "tips.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* --- what a script is told --- */

/* name = 'value', quoted for gnuplot: a quote inside is doubled. */
static void assign(FILE *stream, const char *name, const char *value) {
    fprintf(stream, "%s='", name);
    for (; *value; value++)
        fprintf(stream, *value == '\'' ? "''" : "%c", *value);
    fputs("'; ", stream);
}

static double linear_light(double part) {
    return part <= 0.04045 ? part / 12.92 : pow((part + 0.055) / 1.055, 2.4);
}

/* The colour, or where that is too pale for words on white, a darker one of the same hue. Letters
 * need a contrast of 4.5 (WCAG 2.1, 1.4.3): white's light is 1, and 0.05 is added to both. */
static void write_ink(FILE *stream, const char *colour) {
    unsigned red, green, blue;
    double dark = 1, light;
    if (sscanf(colour, "#%2x%2x%2x", &red, &green, &blue) != 3)
        return;
    do {
        light = 0.2126 * linear_light(dark * red / 255) +
                0.7152 * linear_light(dark * green / 255) +
                0.0722 * linear_light(dark * blue / 255);
        dark *= 0.98;
    } while ((1 + 0.05) / (light + 0.05) < 4.7);
    dark /= 0.98;
    fprintf(stream, "#%02X%02X%02X ", (unsigned)(dark * red), (unsigned)(dark * green),
            (unsigned)(dark * blue));
}

/* How the program's configurations are drawn: lists of words, a word for each. */
static void write_styles(FILE *stream, const struct configuration *all) {
    fputs("CONFIGURATIONS='", stream);
    for (int i = 0; all[i].name; i++)
        fprintf(stream, "\"%s\" ", all[i].name);
    fputs("'; COLOURS='", stream);
    for (int i = 0; all[i].name; i++)
        fprintf(stream, "%s ", all[i].colour);
    fputs("'; INKS='", stream);
    for (int i = 0; all[i].name; i++)
        write_ink(stream, all[i].colour);
    fputs("'; MARKS='", stream);
    for (int i = 0; all[i].name; i++)
        fprintf(stream, "%d ", all[i].mark);
    fputs("'; ADAPTIVE='", stream);
    for (int i = 0; all[i].name; i++)
        if (all[i].method->capabilities & STEPPER_ADAPTIVE)
            fprintf(stream, "\"%s\" ", all[i].name);
    fputs("'", stream);
}

/* A path that gnuplot takes for one: names that begin with < or | are commands to it. */
static void assign_folder(FILE *stream, const char *name, const char *folder) {
    char path[PATH_SIZE];
    if (folder[0] == '/' || path_format(path, "./%s", folder))
        assign(stream, name, folder);
    else
        assign(stream, name, path);
}

/* To be freed. */
static char *variables_of(const char *plots, const char *folder, const char *to,
                          const struct plot_paper *paper, const char *format) {
    struct configuration *all = memory_needed(configurations_choose(CONFIGURATION_ANY, 0));
    char *text = NULL;
    size_t size;
    FILE *stream = memory_needed(open_memstream(&text, &size));
    assign_folder(stream, "plots", plots);
    assign_folder(stream, "data", folder);
    assign_folder(stream, "out", to);
    assign(stream, "format", format);
    assign(stream, "paper", paper ? paper->task : "");
    assign_folder(stream, "layout", paper ? paper->layout : "");
    write_styles(stream, all);
    fclose(stream);
    free(all);
    return memory_needed(text);
}

/* --- one drawing --- */

/* gnuplot's own words, the last line of what it said, without the place in the script. */
static void say_error(FILE *errors, const char *name, char *reason) {
    char line[512], last[512] = "gnuplot failed";
    rewind(errors);
    while (fgets(line, sizeof line, errors)) {
        line[strcspn(line, "\n")] = '\0';
        if (strspn(line, " ^\t") < strlen(line))
            snprintf(last, sizeof last, "%s", line);
    }
    const char *text = strstr(last, ": ");
    snprintf(reason, REASON_SIZE, "the figures of %s: %.180s", name,
             last[0] == '"' && text ? text + 2 : last);
}

/* Letters and bytes are the same wherever a figure is drawn. Set once, for drawings may be made
 * side by side. */
static void set_locale(void) {
    setenv("LC_ALL", "C.UTF-8", 1);
}

int plot_draw(const char *name, const char *folder, const char *to, const struct plot_paper *paper,
              const char *format, char *reason) {
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    char plots[PATH_SIZE], script[PATH_SIZE];
    path_format(plots, "%s/plots", data_folder());
    path_format(script, "%s/%s.gp", plots, name);
    if (!file_exists(script))
        return fail_with(reason, "%.150s: no such script", script);
    char *variables = variables_of(plots, folder, to, paper, format);
    const char *const argv[] = {"gnuplot", "-d", "-e", variables, script, NULL};

    FILE *errors = tmpfile();
    const struct program_words words = {-1, errors ? fileno(errors) : -1};
    int status = 0, out_of_time;
    pthread_once(&once, set_locale);
    const int error = errors ? program_finish(argv, &(struct run_limits){.seconds = 0}, &words,
                                              &status, &out_of_time)
                             : errno;
    if (error)
        snprintf(reason, REASON_SIZE, "gnuplot cannot be started (%s); Debian: gnuplot-nox",
                 strerror(error));
    else if (WIFSIGNALED(status))
        snprintf(reason, REASON_SIZE, "the figures of %s: gnuplot died of signal %d (%s)", name,
                 WTERMSIG(status), strsignal(WTERMSIG(status)));
    else if (status)
        say_error(errors, name, reason);
    free(variables);
    if (errors)
        fclose(errors);
    return error || status ? -1 : 0;
}

int plot_empty_folder(const char *from, const char *to, char *reason) {
    int code = 0;
    DIR *dir = opendir(from);
    for (struct dirent *entry; dir && (entry = readdir(dir)) != NULL;) {
        char source[PATH_SIZE], target[PATH_SIZE];
        struct stat status;
        if (entry->d_name[0] == '.' || path_format(source, "%s/%s", from, entry->d_name))
            continue;
        if (to && !code && (stat(source, &status) || status.st_size == 0))
            code = fail_with(reason, "gnuplot wrote an empty %.150s", entry->d_name);
        if (!to || code)
            unlink(source);
        else if (path_format(target, "%s/%s", to, entry->d_name) || file_put(source, target))
            code = fail_with(reason, "%.150s: cannot write: %s", target, strerror(errno));
    }
    if (dir)
        closedir(dir);
    rmdir(from);
    return code;
}

static int has_files(const char *folder, const char *pattern) {
    glob_t found;
    files_like(folder, pattern, &found);
    const int any = found.gl_pathc > 0;
    globfree(&found);
    return any;
}

static int make_tips(const char *folder, char *reason) {
    glob_t found;
    int code = files_like(folder, "*.svg", &found);
    for (size_t i = 0; i < found.gl_pathc && !code; i++)
        code = tips_make(found.gl_pathv[i], reason);
    globfree(&found);
    return code;
}

/* Every figure of plots/NAME.gp, all or none. */
static int plot_script(const char *name, const char *folder, char *reason) {
    static const char *const formats[] = {"svg", "png"}, *const patterns[] = {"*.svg", "*.png"};
    char drawing[PATH_SIZE];
    if (temporary_folder(folder, drawing, reason))
        return -1;
    for (int i = 0; i < 2; i++) {
        int code = plot_draw(name, folder, drawing, NULL, formats[i], reason);
        if (!code && !has_files(drawing, patterns[i]))
            code =
                fail_with(reason, "the figures of %s: gnuplot has drawn no %s", name, formats[i]);
        if (!code && i == 1) /* all is there */
            code = make_tips(drawing, reason);
        if (code) {
            char other[REASON_SIZE];
            plot_empty_folder(drawing, NULL, other);
            return -1;
        }
    }
    return plot_empty_folder(drawing, folder, reason);
}

int plot_diagnostics(const char *folder, char *reason) {
    if (!has_files(folder, "diagnostics*.tsv"))
        return 0;
    return plot_script("diagnostics", folder, reason) ? -1 : 1;
}

int plot_experiment(const char *name, const char *folder, char *reason) {
    return plot_script(name, folder, reason) || plot_diagnostics(folder, reason) < 0 ? -1 : 0;
}
