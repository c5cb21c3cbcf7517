/* wisplab-bench kernel: evaluations against a plain twin and against the machine's own rates,
 * linear solvers, the seam, CVODE, contacts. wisplab-bench speed: whole scenes, steps, sizes, other
 * people's programs. Absolute times mean little, so all candidates are timed in turn and ratios
 * count. */
#include "base/files.h"
#include "experiments/kernel.h"
#include "integrators/plugin.h"
#include "measure.h"
#include "run/record.h"
#include "scene/scene_load.h"
#include "speed.h"

#include <gsl/gsl_errno.h>
#include <stdlib.h>
#include <string.h>

struct bench {
    const struct measurement *measurement;
    const char *scene_name, *folder;
    const char **sets; /* changes of the scene */
    int set_count, quick, fresh;
    struct scene *scene;
    struct choices *choices; /* of `speed`, else NULL */
    char reason[REASON_SIZE];
};

/* What can be asked for. */
struct measurement {
    const char *name;
    double seconds, quick_seconds; /* that the contest lasts */
    /* Reads what it measures on: 0, or -1 with a reason. */
    int (*open)(struct bench *bench);
    void (*enter)(const struct bench *bench, struct contest *contest);
    int (*write)(struct bench *bench, const struct samples *samples, struct output *output);
};

/* --- kernel --- */

static int open_kernel(struct bench *bench) {
    bench->scene = kernel_scene(bench->scene_name, bench->sets, bench->set_count, bench->reason);
    return bench->scene ? 0 : -1;
}

static void enter_kernel(const struct bench *bench, struct contest *contest) {
    enter_evaluations(contest, bench->scene);
    enter_solvers(contest, bench->scene);
    enter_steppers(contest, bench->scene);
    enter_contacts(contest, bench->scene);
    enter_small_costs(contest, bench->scene);
}

static int write_kernel(struct bench *bench, const struct samples *samples, struct output *output) {
    return write_tables(bench->scene, samples, output);
}

/* --- speed --- */

static int open_speed(struct bench *bench) {
    bench->scene = scene_load(bench->scene_name, bench->sets, bench->set_count, bench->reason);
    if (bench->scene)
        scene_name_sets(bench->scene, bench->sets, bench->set_count);
    bench->choices = bench->scene ? choices_read(bench->folder, bench->reason) : NULL;
    return bench->choices ? 0 : -1;
}

static void enter_speed(const struct bench *bench, struct contest *contest) {
    enter_scenes(contest, bench->scene, bench->choices);
    enter_steps(contest);
    enter_sizes(contest, bench->quick);
    enter_peers(contest);
}

static int write_speed(struct bench *bench, const struct samples *samples, struct output *output) {
    return write_speed_tables(bench->scene, bench->choices, samples, output);
}

static const struct measurement measurements[] = {
    {"kernel", 60, 6, open_kernel, enter_kernel, write_kernel},
    {"speed", 60, 10, open_speed, enter_speed, write_speed},
};
enum { MEASUREMENTS = sizeof measurements / sizeof *measurements };

/* --- either --- */

static const struct column sample_columns[] = {
    {"group", "-", "what is measured"},
    {"subject", "-", "what it is measured on"},
    {"candidate", "-", "who, or what is noted of it"},
    {"values", "ns", "per unit by round, a cell for each; of a note its number, in its own unit"},
    {0}};

/* What the file of samples begins with: program, scene and how long was measured. Samples with the
 * same heading need not be taken again. */
static char *heading_of(const struct bench *bench) {
    char *text = NULL;
    size_t size;
    FILE *stream = open_memstream(&text, &size);
    if (!stream)
        out_of_memory();
    write_provenance(stream,
                     bench->quick ? "samples of a quick measurement, ns per unit by round"
                                  : "samples of a full measurement, ns per unit by round",
                     bench->scene);
    if (bench->choices)
        fprintf(stream, "# choices %s\n", bench->choices->hash);
    columns_write(stream, sample_columns);
    fclose(stream);
    return text;
}

/* Enters everybody and lets them run. The samples are in memory until all are taken: who is stopped
 * leaves no file. */
static char *measure(const struct bench *bench) {
    struct contest contest = {0};
    char *text = NULL;
    size_t size;
    contest.notes = open_memstream(&text, &size);
    if (!contest.notes)
        out_of_memory();
    const struct measurement *m = bench->measurement;
    m->enter(bench, &contest);
    contest_run(&contest, bench->quick ? m->quick_seconds : m->seconds, contest.notes);
    if (fclose(contest.notes))
        out_of_memory();
    return text;
}

static int take_samples(struct bench *bench, const char *path, const char *heading) {
    struct atomic_file file;
    char *values = measure(bench);
    int code = atomic_open(&file, path, bench->reason);
    if (!code) {
        fprintf(file.stream, "%s%s", heading, values);
        code = atomic_commit(&file, bench->reason);
    }
    free(values);
    return code;
}

/* Reads the samples, after measuring where they are not there. */
static int obtain(struct bench *bench, struct samples *samples) {
    char path[PATH_SIZE];
    char *heading = heading_of(bench);
    int code = path_format(path, "%s/samples.tsv", bench->folder);
    if (code) {
        snprintf(bench->reason, REASON_SIZE, "%.150s: too long a path", bench->folder);
    } else if (bench->fresh || !samples_read(samples, path, heading)) {
        code = take_samples(bench, path, heading);
        if (!code && !samples_read(samples, path, heading)) {
            snprintf(bench->reason, REASON_SIZE, "%.150s: cannot be read back", path);
            code = -1;
        }
    } else {
        printf("%s: the samples of this program are there already (--fresh takes them again)\n",
               bench->measurement->name);
    }
    free(heading);
    return code;
}

static int tabulate(struct bench *bench, const struct samples *samples) {
    struct output output = {.folder = bench->folder, .reason = bench->reason};
    int code = output_statements(&output, bench->scene, NULL);
    if (!code) {
        statements_of_changed(&output.statements, bench->sets, bench->set_count);
        code = bench->measurement->write(bench, samples, &output);
    }
    return output_close(&output, code);
}

static int measure_and_tabulate(struct bench *bench) {
    struct samples samples;
    if (obtain(bench, &samples))
        return -1;
    const int code = tabulate(bench, &samples);
    samples_free(&samples);
    return code;
}

static int read_arguments(int argc, char **argv, struct bench *bench) {
    if (argc < 4)
        return -1;
    *bench = (struct bench){.scene_name = argv[2], .folder = argv[3]};
    bench->sets = calloc((size_t)argc, sizeof *bench->sets);
    if (!bench->sets)
        out_of_memory();
    for (int i = 0; i < MEASUREMENTS; i++)
        if (strcmp(argv[1], measurements[i].name) == 0)
            bench->measurement = &measurements[i];
    for (int i = 4; i < argc; i++) {
        if (strcmp(argv[i], "--quick") == 0)
            bench->quick = 1;
        else if (strcmp(argv[i], "--fresh") == 0)
            bench->fresh = 1;
        else if (strcmp(argv[i], "--set") == 0 && i + 1 < argc)
            bench->sets[bench->set_count++] = argv[++i];
        else if (strcmp(argv[i], "--plugin") == 0 && i + 1 < argc)
            i++; /* load_plugins takes it */
        else
            return -1;
    }
    return bench->measurement ? 0 : -1;
}

/* Those that wisplab has, for what it found may be one's. */
static int load_plugins(int argc, char **argv, char *reason) {
    for (int i = 4; i + 1 < argc; i++)
        if (strcmp(argv[i], "--plugin") == 0 && plugin_load(argv[++i], reason))
            return -1;
    return 0;
}

static int fail(const struct bench *bench, int code, const char *reason) {
    fprintf(stderr, "bench: %s\n", reason);
    free(bench->sets);
    return code;
}

static int run_bench(int argc, char **argv) {
    struct bench bench = {.measurement = NULL};
    if (read_arguments(argc, argv, &bench))
        return fail(
            &bench, 1,
            "usage: wisplab-bench kernel|speed SCENE FOLDER [--quick] [--fresh] [--set P=V]...");
    if (load_plugins(argc, argv, bench.reason) || bench.measurement->open(&bench))
        return fail(&bench, 1, bench.reason);
    const int code = make_folder(bench.folder, bench.reason) || measure_and_tabulate(&bench);
    scene_free(bench.scene);
    choices_free(bench.choices);
    if (code)
        return fail(&bench, 2, bench.reason);
    if (fflush(stdout) || ferror(stdout))
        return fail(&bench, 2, "standard output cannot be written");
    free(bench.sets);
    return 0;
}

int main(int argc, char **argv) {
    gsl_set_error_handler_off(); /* errors are return codes here, never aborts */
    const int code = run_bench(argc, argv);
    plugins_let_end();
    return code;
}
