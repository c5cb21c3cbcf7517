#include "record.h"

#include "base/files.h"
#include "base/hash.h"
#include "base/memory.h"
#include "base/npy.h"
#include "build_info.h"
#include "frame_binary.h"
#include "frame_text.h"
#include "identity.h"
#include "integrators/plugin.h"
#include "model/problems.h"
#include "model/state.h"
#include "reference_check.h"
#include "seal.h"
#include "warnings.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

void write_provenance(FILE *stream, const char *what, const struct scene *scene) {
    fprintf(stream, "# %s\n# wisplab %s, commit %s, program %s, %s\n", what, WISPLAB_VERSION,
            WISPLAB_COMMIT, program_hash(), WISPLAB_COMPILER);
    for (const struct plugin *p = plugins(); p->method; p++)
        fprintf(stream, "# plug-in with stepper %s, hash %s\n", p->method->name, p->hash);
    if (scene) {
        char hash[HASH_SIZE];
        scene_hash(scene, hash);
        fprintf(stream, "# scene %s, hash %s\n", scene->name, hash);
    }
}

/* --- tables --- */

/* A table of the run. It gets its name when all of the run is there: who ends the program before
 * that, while hundreds of megabytes go to the disk or a cross-check goes on, leaves no half run. */
struct run_table {
    const char *name; /* in the folder; NULL: there is none */
    struct atomic_file file;
    FILE *stream;         /* to write to; hashes what is written, if it is written but once */
    struct hashed hashed; /* where it does */
    char hash[HASH_SIZE]; /* once it is closed */
};

static int open_table(struct run_table *table, const char *folder, const char *name, int hashing,
                      char *reason) {
    char path[PATH_SIZE];
    path_format(path, "%s/%s", folder, name);
    if (atomic_open(&table->file, path, reason))
        return -1;
    table->name = name;
    table->stream = hashing ? hashed_open(&table->hashed, table->file.stream) : table->file.stream;
    if (table->stream)
        return 0;
    atomic_discard(&table->file);
    return fail_with(reason, "%.150s: cannot write: out of memory", path);
}

static int is_hashing(const struct run_table *table) {
    return table->stream && table->stream != table->file.stream;
}

static void discard_table(struct run_table *table) {
    if (is_hashing(table))
        fclose(table->stream);
    table->stream = NULL;
    atomic_discard(&table->file);
}

/* Returns 0, or -1 with a reason and nothing left of it. What a user has interrupted need not
 * outlive the machine, and has no time for the disk. */
static int close_table(struct run_table *table, enum outcome outcome, char *reason) {
    const int hashing = is_hashing(table);
    if (!table->name)
        return 0;
    if (hashing)
        fclose(table->stream); /* an error is one of the file's */
    table->stream = NULL;
    if (atomic_close(&table->file, outcome != INTERRUPTED, reason))
        return -1;
    if (hashing)
        hash_text(table->hashed.hash, table->hash);
    else if (hash_file(table->file.temporary, table->hash))
        return fail_with(reason, "%.150s: cannot read: %s", table->file.path, strerror(errno));
    return 0;
}

/* --- frames --- */

struct frame_writer {
    struct run_table states, diagnoses;
    enum states_format format;
    long long rows;
    struct frame_text text;
    int named; /* the column names are written, with the first frame */
    int error; /* errno of the first failure, or 0 */
};

static void write_diagnosis(struct frame_writer *writer, const struct diagnosis *diagnosis) {
    diagnosis_write_row(writer->diagnoses.stream, diagnosis);
    if (fflush(writer->diagnoses.stream))
        writer->error = errno;
}

/* Returns 0, or an errno. */
static int write_text(struct frame_writer *writer, const struct model *model, double t,
                      const double *rows) {
    FILE *stream = writer->states.stream;
    if (!writer->named)
        state_write_columns(stream, model);
    return frame_text_write(&writer->text, stream, model, t, rows) ? ENOMEM : 0;
}

static int write_binary(struct frame_writer *writer, const struct model *model, double t,
                        const double *rows) {
    FILE *stream = writer->states.stream;
    if (!writer->named && frame_binary_begin(stream, model))
        return ENOMEM;
    frame_binary_write(stream, model, t, rows);
    writer->rows += model->row_count;
    return 0;
}

static int write_frame(void *ctx, const struct model *model, double t, const double *rows) {
    struct frame_writer *writer = ctx;
    if (writer->format != STATES_NONE) {
        writer->error = writer->format == STATES_TEXT ? write_text(writer, model, t, rows)
                                                      : write_binary(writer, model, t, rows);
        writer->named = 1;
        /* now, so that a killed run keeps its frames and a full disk shows */
        if (fflush(writer->states.stream))
            writer->error = errno;
    }
    if (writer->diagnoses.name)
        write_diagnosis(writer, model->diagnosis);
    return writer->error ? OUTPUT_FAILED : 0;
}

/* Opens a table of a run and writes where it comes from. */
static int open_text_table(struct run_table *table, const char *folder, const char *name,
                           const char *what, const struct scene *scene,
                           const struct settings *settings, char *reason) {
    if (open_table(table, folder, name, 1, reason))
        return -1;
    json_t *json = settings_to_json(scene, settings);
    json_object_del(json, "diagnostics"); /* with them or without, states.tsv is the same */
    json_object_del(json, "states");      /* and so are diagnoses */
    char *text = json_dumps(json, JSON_COMPACT | JSON_REAL_PRECISION(6));
    write_provenance(table->stream, what, scene);
    fprintf(table->stream, "# settings %s\n", text);
    free(text);
    json_decref(json);
    return 0;
}

static int open_states(struct frame_writer *writer, const struct scene *scene,
                       const struct settings *settings, const char *folder, char *reason) {
    if (writer->format == STATES_NONE)
        return 0;
    if (writer->format == STATES_TEXT)
        return open_text_table(&writer->states, folder, "states.tsv",
                               "states at the frames: s, m, m/s", scene, settings, reason);
    return open_table(&writer->states, folder, "states.npy", 0, reason);
}

static int open_frames(struct frame_writer *writer, const struct scene *scene,
                       const struct settings *settings, const char *folder, char *reason) {
    *writer = (struct frame_writer){.format = settings->states};
    if (open_states(writer, scene, settings, folder, reason))
        return -1;
    if (!settings->diagnostics)
        return 0;
    if (open_text_table(&writer->diagnoses, folder, "diagnostics.tsv", "diagnoses of the frames",
                        scene, settings, reason)) {
        discard_table(&writer->states);
        return -1;
    }
    diagnosis_write_head(writer->diagnoses.stream);
    return 0;
}

static int close_frames(struct frame_writer *writer, const struct run_result *result,
                        char *reason) {
    int code = -1;
    frame_text_free(&writer->text);
    if (writer->format == STATES_BINARY && writer->named)
        npy_set_rows(writer->states.stream, writer->rows);
    if (result->outcome != OUTPUT_FAILED)
        code = close_table(&writer->diagnoses, result->outcome, reason) ||
                       close_table(&writer->states, result->outcome, reason)
                   ? -1
                   : 0;
    else
        snprintf(reason, REASON_SIZE, "%.120s: cannot write: %.100s", writer->states.file.path,
                 writer->error ? strerror(writer->error) : result->reason);
    if (code) {
        discard_table(&writer->diagnoses);
        discard_table(&writer->states);
    }
    return code;
}

/* A frame for each of two observers. */
struct two_observers {
    struct observer first, second;
};

static int both(void *ctx, const struct model *model, double t, const double *rows) {
    struct two_observers *two = ctx;
    const int code = two->first.frame(two->first.ctx, model, t, rows);
    return code ? code : two->second.frame(two->second.ctx, model, t, rows);
}

/* --- CPU time --- */

/* CPU seconds of one run without diagnoses, from as many as fill two milliseconds. */
static double time_once(const struct scene *scene, const struct settings *settings,
                        const struct watch *watch) {
    struct settings plain = *settings;
    double total = 0;
    int runs = 0;
    plain.diagnostics = 0;
    while (total < 2e-3 && !(watch && watch->stop && *watch->stop)) {
        struct run_result result;
        simulate(scene, &plain, NULL, &(struct watch){.stop = watch ? watch->stop : NULL}, &result);
        total += result.cpu_seconds;
        runs++;
        if (runs >= 10000)
            break;
    }
    return runs ? total / runs : NAN;
}

/* A run that takes so long, s, is the first of its own repetitions, if it was not diagnosed: they
 * take the same steps, and it has frames besides, whose time is known. */
static const double long_run = 0.1;

static json_t *time_run(const struct scene *scene, const struct settings *settings,
                        const struct run_result *result, const struct watch *watch) {
    json_t *seconds = json_array();
    const double own = result->cpu_seconds - result->frame_cpu_seconds;
    const int is_first = !settings->diagnostics && own >= long_run;
    for (int i = 0; i < settings->timings; i++) {
        const double once = i == 0 && is_first ? own : time_once(scene, settings, watch);
        if (watch && watch->stop && *watch->stop) /* the last one was cut short */
            break;
        json_array_append_new(seconds, json_real(once));
    }
    return seconds;
}

/* --- run.json --- */

static json_t *counters_to_json(const struct counters *counters) {
    json_t *json = json_object();
#define X(field, definition) json_object_set_new(json, #field, json_integer(counters->field));
    COUNTERS(X)
#undef X
    return json;
}

/* A run that took no step has none. */
static json_t *step_to_json(const struct step_range *steps, double step) {
    return steps->largest > 0 ? json_real(step) : json_null();
}

static json_t *terms_to_json(const struct scene *scene) {
    const char *names[16];
    json_t *json = json_array();
    const int count = problem_terms(scene, names, 16);
    for (int i = 0; i < count; i++)
        json_array_append_new(json, json_string(names[i]));
    return json;
}

/* Wall time by stage, and by call to the model where it was profiled. */
static json_t *seconds_to_json(const struct settings *settings, const struct run_result *result) {
    json_t *json = json_pack("{s:f, s:f, s:f}", "advance", result->advance_seconds, "ticks",
                             result->tick_seconds, "frames", result->frame_seconds);
    if (settings->profile) {
#define X(call) json_object_set_new(json, #call, json_real(result->profile.call));
        SYSTEM_CALLS(X)
#undef X
    }
    return json;
}

/* JSON has no infinity. */
static json_t *number_to_json(double number) {
    return isfinite(number) ? json_real(number) : json_null();
}

static json_t *result_to_json(const struct scene *scene, const struct settings *settings,
                              const struct run_result *result) {
    char scene_text[HASH_SIZE], run_text[HASH_SIZE];
    scene_hash(scene, scene_text);
    run_hash(scene, settings, run_text);
    const int failed = result->outcome != FINISHED;
    return json_pack(
        "{s:s, s:s, s:o, s:f, s:i, s:o, s:i, s:o, s:o, s:o, s:o, s:o, s:o, s:f, s:o, s:b, s:s, "
        "s:s, s:O, s:o, s:o, s:o}",
        "status", outcome_name(result->outcome), "reason", result->reason, "failure_time",
        failed ? json_real(result->time) : json_null(), "simulated_time", result->time, "frames",
        result->frames, "wisps", result->wisps > 0 ? json_integer(result->wisps) : json_null(),
        "unknowns", settings->unknowns, "terms", terms_to_json(scene), "warnings",
        scene_warnings(scene, settings), "counters", counters_to_json(&result->counters),
        "largest_strain", number_to_json(result->largest_strain), "step_least",
        step_to_json(&result->steps, result->steps.least), "step_largest",
        step_to_json(&result->steps, result->steps.largest), "cpu_seconds", result->cpu_seconds,
        "seconds", seconds_to_json(settings, result), "times_comparable",
        !settings->diagnostics && !settings->profile, "run_hash", run_text, "scene_hash",
        scene_text, "scene", scene->source, "settings", settings_to_json(scene, settings), "build",
        build_to_json(), "machine", machine_to_json());
}

/* Writes what goes into run.json, without a name as yet. */
static int write_json(struct atomic_file *file, json_t *json, enum outcome outcome,
                      const char *folder, char *reason) {
    char path[PATH_SIZE];
    path_format(path, "%s/run.json", folder);
    if (atomic_open(file, path, reason))
        return -1;
    if (!json || json_dumpf(json, file->stream, JSON_INDENT(2) | JSON_REAL_PRECISION(17))) {
        atomic_discard(file);
        return fail_with(reason, "%.150s: cannot write: %s", path, strerror(errno));
    }
    fputc('\n', file->stream);
    return atomic_close(file, outcome != INTERRUPTED, reason);
}

enum { TABLES = 3 }; /* that a run has at most */

/* Seals run.json, with the hashes of the closed tables, and gives it and them their names. Returns
 * 0, or -1 with a reason and nothing left. */
static int publish(json_t *json, struct run_table *const *tables, int count, enum outcome outcome,
                   const char *folder, char *reason) {
    struct atomic_file all[TABLES + 1];
    json_t *files = json_object();
    for (int i = 0; i < count; i++) {
        all[i] = tables[i]->file;
        if (tables[i]->name)
            json_object_set_new(files, tables[i]->name, json_string(tables[i]->hash));
    }
    if (json)
        seal_add(json, files);
    else
        json_decref(files);
    if (write_json(&all[count], json, outcome, folder, reason) == 0)
        return atomic_name(all, count + 1, reason);
    for (int i = 0; i < count; i++)
        atomic_discard(&all[i]);
    return -1;
}

void lift_memory_limit(void) {
    struct rlimit limit;
    memory_is_limited = 0;
    getrlimit(RLIMIT_AS, &limit);
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_AS, &limit);
}

enum outcome record_run(const struct scene *scene, const struct settings *settings,
                        const char *folder, const struct watch *watch, struct run_result *how,
                        char *reason) {
    struct frame_writer writer;
    struct kept_frames kept = {0};
    struct two_observers two = {{write_frame, &writer}, {keep_frame, &kept}};
    const struct observer write_only = two.first, write_and_keep = {both, &two};
    /* a perturbed run is a neighbour of one that is checked */
    const int checked = settings->method->checked_by && settings->perturbation == 0;
    struct run_result result;

    if (open_frames(&writer, scene, settings, folder, reason))
        return OUTPUT_FAILED;
    simulate(scene, settings, checked ? &write_and_keep : &write_only, watch, &result);
    lift_memory_limit();
    if (how)
        *how = result;
    if (close_frames(&writer, &result, reason)) {
        kept_frames_free(&kept);
        return OUTPUT_FAILED;
    }
    json_t *json = result_to_json(scene, settings, &result);
    if (checked && result.outcome == FINISHED)
        json_object_set_new(json, "cross_check", cross_check(scene, settings, &kept, watch));
    if (settings->timings > 0 && result.outcome == FINISHED)
        json_object_set_new(json, "cpu_seconds_repeated",
                            time_run(scene, settings, &result, watch));
    kept_frames_free(&kept);
    struct run_table *const tables[] = {&writer.diagnoses, &writer.states};
    const int failed = publish(json, tables, 2, result.outcome, folder, reason);
    json_decref(json);
    return failed ? OUTPUT_FAILED : result.outcome;
}

/* --- the dead --- */

/* Cuts a file behind its last complete line, which is looked for from the end: it may be long.
 * Returns 0, or -1. */
static int cut_text(FILE *file) {
    long end = fseek(file, 0, SEEK_END) ? -1 : ftell(file);
    while (end > 0 && fseek(file, end - 1, SEEK_SET) == 0 && fgetc(file) != '\n')
        end--;
    return end < 0 ? -1 : ftruncate(fileno(file), end);
}

/* Takes over a table of a dead process, with what is complete of it, or one that it was just naming
 * when it died. */
static void keep_complete(struct run_table *table, enum outcome outcome, const char *folder,
                          const char *name, int (*cut)(FILE *file)) {
    char pattern[64], reason[REASON_SIZE];
    glob_t found;
    struct atomic_file *file = &table->file;
    path_format(file->path, "%s/%s", folder, name);
    snprintf(pattern, sizeof pattern, "%s.*.part", name);
    files_like(folder, pattern, &found);
    if (found.gl_pathc > 0) {
        const int descriptor = open(found.gl_pathv[0], O_RDWR | O_NOFOLLOW | O_CLOEXEC);
        table->stream = file->stream = descriptor >= 0 ? fdopen(descriptor, "r+") : NULL;
    }
    if (file->stream) {
        snprintf(file->temporary, sizeof file->temporary, "%s", found.gl_pathv[0]);
        table->name = name;
        if (cut(file->stream) || close_table(table, outcome, reason)) {
            discard_table(table);
            table->name = NULL;
        }
    } else if (hash_file(file->path, table->hash) == 0) {
        table->name = name;
    }
    globfree(&found);
}

int record_death(const struct scene *scene, const struct settings *settings, const char *folder,
                 enum outcome outcome, const char *why, double reached, char *reason) {
    struct run_result result = {.outcome = outcome, .time = reached};
    struct run_table text = {.name = NULL}, binary = {.name = NULL}, diagnoses = {.name = NULL},
                     *const tables[TABLES] = {&diagnoses, &text, &binary};
    snprintf(result.reason, REASON_SIZE, "%s", why);
    keep_complete(&text, outcome, folder, "states.tsv", cut_text);
    keep_complete(&binary, outcome, folder, "states.npy", npy_mend);
    if (settings->diagnostics)
        keep_complete(&diagnoses, outcome, folder, "diagnostics.tsv", cut_text);
    json_t *json = result_to_json(scene, settings, &result);
    const int code = publish(json, tables, TABLES, outcome, folder, reason);
    json_decref(json);
    return code;
}
