#include "work.h"

#include "base/npy.h"
#include "experiments/common/measure.h"
#include "run/frame_binary.h"
#include "run/record.h"

#include <math.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

/* --- frames --- */

/* The frames of a run that is compared, in a file that is only in memory. */
struct kept {
    FILE *stream; /* NULL: none are kept */
    char path[32];
    long long rows;
};

static int keep_open(struct kept *kept) {
    const int file = memfd_create("states.npy", MFD_CLOEXEC);
    kept->stream = file >= 0 ? fdopen(file, "w+") : NULL;
    snprintf(kept->path, sizeof kept->path, "/proc/self/fd/%d", file);
    return kept->stream ? 0 : -1;
}

static int keep(void *ctx, const struct model *model, double t, const double *rows) {
    struct kept *kept = ctx;
    if (kept->rows == 0 && frame_binary_begin(kept->stream, model))
        return OUT_OF_MEMORY;
    frame_binary_write(kept->stream, model, t, rows);
    kept->rows += model->row_count;
    return ferror(kept->stream) ? OUT_OF_MEMORY : 0;
}

/* --- the distance from the reference --- */

static void compare(const struct sweep_point *point, const char *path,
                    const struct run_files *exact, struct sweep_error *error) {
    struct trajectory own;
    struct deviation deviation;
    if (trajectory_read(&own, path, error->why))
        return;
    const int code =
        measure_deviation(point->scene, &own, exact->states, 1, &deviation, error->why);
    trajectory_free(&own);
    if (code)
        return;
    error->rms = deviation.rms;
    error->largest = deviation.largest;
    error->end = deviation.end;
    error->bound = run_number(exact, "cross_check.bound");
    if (!isnan(deviation.history_diverged))
        snprintf(error->why, REASON_SIZE,
                 "diverged contact history: from %.6g s on the reference has other wisps, and "
                 "errors are "
                 "up to then",
                 deviation.history_diverged);
    else if (isnan(error->bound))
        snprintf(error->why, REASON_SIZE, "what checks the reference could say no bound");
}

/* The errors of a run that finished, whose states are in a file. */
static void measure_error(const struct sweep *sweep, const struct sweep_point *point,
                          const char *path, struct sweep_error *error) {
    struct settings settings;
    struct run_files exact;
    char folder[PATH_SIZE], why[REASON_SIZE];
    if (sweep_reference(point, &settings, why)) {
        snprintf(error->why, REASON_SIZE, "no reference: %.300s", why);
        return;
    }
    run_folder(sweep->out, point->scene, &settings, folder);
    if (run_read_states(&exact, folder, NULL, why)) {
        snprintf(error->why, REASON_SIZE, "no reference: %.300s", why);
        return;
    }
    if (exact.outcome != FINISHED)
        snprintf(error->why, REASON_SIZE, "the reference: %s", outcome_name(exact.outcome));
    else
        compare(point, path, &exact, error);
    run_free(&exact);
}

/* --- the run --- */

static enum outcome write_cells(const struct sweep_job *job, const struct run_result *result,
                                int counted, const struct sweep_error *error, char *reason) {
    if (cells_write(job->cells, result, error->why, counted,
                    job->sweep->reference ? error : NULL) == 0)
        return result->outcome;
    snprintf(reason, REASON_SIZE, "a row of the table is too long");
    return OUTPUT_FAILED;
}

static enum outcome run_point(const struct run_case *run, const struct sweep_point *point,
                              const struct watch *watch, char *reason) {
    const struct sweep_job *job = run->ctx;
    struct sweep_error error = {NAN, NAN, NAN, NAN, ""};
    struct run_result result;
    struct kept kept = {0};
    char path[PATH_SIZE];
    const int in_folder = job->sweep->states != STATES_NONE;
    const int keeps = job->sweep->reference && !in_folder;
    const struct observer observer = {keep, &kept};
    if (keeps && keep_open(&kept)) {
        snprintf(reason, REASON_SIZE, "no memory for the states of a run");
        return OUTPUT_FAILED;
    }
    if (in_folder) {
        if (record_run(point->scene, &point->settings, run->folder, watch, &result, reason) ==
            OUTPUT_FAILED)
            return OUTPUT_FAILED;
    } else {
        simulate(point->scene, &point->settings, keeps ? &observer : NULL, watch, &result);
        lift_memory_limit();
    }
    if (keeps) {
        npy_set_rows(kept.stream, kept.rows);
        fflush(kept.stream);
    }
    if (result.outcome == FINISHED && job->sweep->reference &&
        (in_folder ? trajectory_path(run->folder, path) : path_format(path, "%s", kept.path)) == 0)
        measure_error(job->sweep, point, path, &error);
    return write_cells(job, &result, 1, &error, reason);
}

static enum outcome do_run(const struct run_case *run, const struct watch *watch, char *reason) {
    const struct sweep_job *job = run->ctx;
    struct sweep_point point;
    enum outcome outcome = OUTPUT_FAILED;
    if (sweep_open(job->sweep, job->run, &point, reason) == 0)
        outcome = run_point(run, &point, watch, reason);
    sweep_close(&point);
    return outcome;
}

/* In the parent: what the process of the run could not say any more. */
static int note_death(const struct run_case *run, enum outcome outcome, const char *why,
                      double reached, char *reason) {
    const struct sweep_job *job = run->ctx;
    const struct sweep_error none = {NAN, NAN, NAN, NAN, ""};
    struct run_result result = {.outcome = outcome, .time = reached};
    struct sweep_point point;
    snprintf(result.reason, REASON_SIZE, "%s", why);
    int code = 0;
    if (*run->folder) {
        code =
            sweep_open(job->sweep, job->run, &point, reason) ||
            record_death(point.scene, &point.settings, run->folder, outcome, why, reached, reason);
        sweep_close(&point);
    }
    return code || write_cells(job, &result, 0, &none, reason) == OUTPUT_FAILED ? -1 : 0;
}

const struct run_sink sweep_sink = {do_run, note_death};
