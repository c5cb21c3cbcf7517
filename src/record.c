#include "record.h"

#include "build_info.h"
#include "identity.h"
#include "second_opinion.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

void write_provenance(FILE *stream, const char *what, const struct scene *scene) {
    fprintf(stream, "# %s\n# wisplab %s, commit %s, program %s, %s\n", what, WISPLAB_VERSION,
            WISPLAB_COMMIT, program_hash(), WISPLAB_COMPILER);
    if (scene) {
        char hash[HASH_SIZE];
        scene_hash(scene, hash);
        fprintf(stream, "# scene %s, hash %s\n", scene->name, hash);
    }
}

/* --- frames --- */

struct frame_writer {
    struct atomic_file file;
    int named; /* the column names are written, with the first frame */
    int error; /* errno of the first failure, or 0 */
};

static void write_names(FILE *stream, const struct model *model) {
    for (int i = 0; i < model->column_count; i++)
        fprintf(stream, "\t%s", model->columns[i]);
    fputc('\n', stream);
}

static int write_frame(void *ctx, const struct model *model, double t, const double *rows) {
    struct frame_writer *writer = ctx;
    FILE *stream = writer->file.stream;
    const int columns = model->column_count;
    if (!writer->named)
        write_names(stream, model);
    writer->named = 1;
    for (int i = 0; i < model->row_count; i++) {
        fprintf(stream, "%.17g", t);
        for (int j = 0; j < columns; j++)
            fprintf(stream, "\t%.17g", rows[i * columns + j]);
        fputc('\n', stream);
    }
    if (fflush(stream)) /* now, so that a killed run keeps its frames and a full disk shows */
        writer->error = errno;
    return writer->error ? OUTPUT_FAILED : 0;
}

static int open_frames(struct frame_writer *writer, const struct scene *scene,
                       const struct settings *settings, const char *folder, char *reason) {
    char path[PATH_SIZE];
    writer->error = 0;
    path_format(path, "%s/states.tsv", folder);
    if (atomic_open(&writer->file, path, reason))
        return -1;
    json_t *json = settings_to_json(scene, settings);
    char *text = json_dumps(json, JSON_COMPACT | JSON_REAL_PRECISION(6));
    write_provenance(writer->file.stream, "states at the frames: s, m, m/s", scene);
    fprintf(writer->file.stream, "# settings %s\nt", text);
    free(text);
    json_decref(json);
    writer->named = 0;
    return 0;
}

static int close_frames(struct frame_writer *writer, const struct run_result *result,
                        char *reason) {
    if (result->outcome != OUTPUT_FAILED)
        return atomic_commit(&writer->file, reason);
    snprintf(reason, REASON_SIZE, "%.120s: cannot write: %.100s", writer->file.path,
             writer->error ? strerror(writer->error) : result->reason);
    atomic_discard(&writer->file);
    return -1;
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

/* CPU seconds of one run, from as many as fill two milliseconds. */
static double time_once(const struct scene *scene, const struct settings *settings,
                        const struct watch *watch) {
    double total = 0;
    int runs = 0;
    while (total < 2e-3 && !(watch && watch->stop && *watch->stop)) {
        struct run_result result;
        simulate(scene, settings, NULL, &(struct watch){.stop = watch ? watch->stop : NULL},
                 &result);
        total += result.cpu_seconds;
        runs++;
        if (runs >= 10000)
            break;
    }
    return runs ? total / runs : NAN;
}

static json_t *time_run(const struct scene *scene, const struct settings *settings,
                        const struct watch *watch) {
    json_t *seconds = json_array();
    for (int i = 0; i < settings->timings; i++) {
        const double once = time_once(scene, settings, watch);
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

static json_t *result_to_json(const struct scene *scene, const struct settings *settings,
                              const struct run_result *result) {
    char scene_text[HASH_SIZE], run_text[HASH_SIZE];
    scene_hash(scene, scene_text);
    run_hash(scene, settings, run_text);
    const int failed = result->outcome != FINISHED;
    return json_pack(
        "{s:s, s:s, s:o, s:f, s:i, s:o, s:i, s:o, s:o, s:f, s:o, s:s, s:s, s:O, s:o, s:o, s:o}",
        "status", outcome_name(result->outcome), "reason", result->reason, "failure_time",
        failed ? json_real(result->time) : json_null(), "simulated_time", result->time, "frames",
        result->frames, "wisps", result->wisps > 0 ? json_integer(result->wisps) : json_null(),
        "unknowns", settings->unknowns, "terms", terms_to_json(scene), "counters",
        counters_to_json(&result->counters), "cpu_seconds", result->cpu_seconds, "seconds",
        seconds_to_json(settings, result), "run_hash", run_text, "scene_hash", scene_text, "scene",
        scene->source, "settings", settings_to_json(scene, settings), "build", build_to_json(),
        "machine", machine_to_json());
}

static int write_json(const json_t *json, const char *folder, char *reason) {
    char path[PATH_SIZE];
    struct atomic_file file;
    path_format(path, "%s/run.json", folder);
    if (atomic_open(&file, path, reason))
        return -1;
    if (!json || json_dumpf(json, file.stream, JSON_INDENT(2) | JSON_REAL_PRECISION(17))) {
        atomic_discard(&file);
        snprintf(reason, REASON_SIZE, "%.150s: cannot write: %s", path, strerror(errno));
        return -1;
    }
    fputc('\n', file.stream);
    return atomic_commit(&file, reason);
}

/* A run that took all the memory it may, or nearly, left none to write that down with. */
static void lift_memory_limit(void) {
    struct rlimit limit;
    getrlimit(RLIMIT_AS, &limit);
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_AS, &limit);
}

enum outcome record_run(const struct scene *scene, const struct settings *settings,
                        const char *folder, const struct watch *watch, char *reason) {
    struct frame_writer writer;
    struct kept_frames kept = {0};
    struct two_observers two = {{write_frame, &writer}, {keep_frame, &kept}};
    const struct observer write_only = two.first, write_and_keep = {both, &two};
    const int checked = settings->method->checked_by != NULL;
    struct run_result result;

    if (open_frames(&writer, scene, settings, folder, reason))
        return OUTPUT_FAILED;
    simulate(scene, settings, checked ? &write_and_keep : &write_only, watch, &result);
    lift_memory_limit();
    if (close_frames(&writer, &result, reason)) {
        kept_frames_free(&kept);
        return OUTPUT_FAILED;
    }
    json_t *json = result_to_json(scene, settings, &result);
    if (checked && result.outcome == FINISHED)
        json_object_set_new(json, "second_opinion", second_opinion(scene, settings, &kept, watch));
    if (settings->timings > 0 && result.outcome == FINISHED)
        json_object_set_new(json, "cpu_seconds_repeated", time_run(scene, settings, watch));
    kept_frames_free(&kept);
    const int failed = write_json(json, folder, reason);
    json_decref(json);
    return failed ? OUTPUT_FAILED : result.outcome;
}

/* Gives the frames of a dead process their name, up to the last complete line. */
static void keep_complete_frames(const char *folder, long pid) {
    char partial[PATH_SIZE], path[PATH_SIZE];
    path_format(partial, "%s/states.tsv.%ld.part", folder, pid);
    path_format(path, "%s/states.tsv", folder);
    FILE *file = fopen(partial, "r+");
    if (!file)
        return;
    long end = 0, at = 0;
    for (int c; (c = fgetc(file)) != EOF;) {
        at++;
        if (c == '\n')
            end = at;
    }
    const int bad = ftruncate(fileno(file), end);
    fclose(file);
    if (bad || rename(partial, path))
        unlink(partial);
}

int record_death(const struct scene *scene, const struct settings *settings, const char *folder,
                 long pid, enum outcome outcome, const char *why, double reached, char *reason) {
    struct run_result result = {.outcome = outcome, .time = reached};
    snprintf(result.reason, REASON_SIZE, "%s", why);
    keep_complete_frames(folder, pid);
    json_t *json = result_to_json(scene, settings, &result);
    const int code = write_json(json, folder, reason);
    json_decref(json);
    return code;
}
