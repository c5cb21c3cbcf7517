/* Pictures of the hair: the frames that the thesis prints, a film, and the steppers side by side.
 */
#include "hair_study.h"
#include "picture/strip.h"

#include <math.h>

enum { FILM_FRAMES = 60 };

/* Turns frame `number` of 30 a second into one of the timed runs; 0 where not all that are drawn
 * have it. */
static int frame_shown(const struct hair_study *study, int number) {
    for (int i = 0; i < study->count; i++)
        if (!study->runs[i].variant->undrawn && hair_frame_numbered(&study->runs[i], number) < 0)
            return 0;
    return 1 + (int)lround((number - 1) / 30. * study->runs[0].timed->run.scene->frame_rate);
}

/* Finds the last frame that all runs drawn have; 0: one has none. */
static int last_frame(const struct hair_study *study) {
    const double rate = study->runs[0].timed->run.scene->frame_rate;
    int last = 0;
    for (int i = 0, first = 1; i < study->count; i++) {
        const struct hair *hair = &study->runs[i].hair;
        if (study->runs[i].variant->undrawn)
            continue;
        const int frames = hair->frame_count;
        const int own = frames > 0 ? 1 + (int)lround(hair->frames[frames - 1].t * rate) : 0;
        last = first || own < last ? own : last;
        first = 0;
    }
    return last;
}

/* With --quick a head of hair is sparse: drawing takes longer than what is drawn. */
static const char *const sparse[] = {"render={ hairs = 12; }"};

static struct strip_request request_of(const struct plan *plan, const struct hair_study *study,
                                       const struct strip_row *rows, int row_count) {
    const struct hair_question *question = study->question;
    const struct scene *scene = study->subject->scene;
    return (struct strip_request){
        .rows = rows,
        .row_count = row_count,
        .sets = sparse,
        .set_count = plan->quick && scene->wisp_count > 60,
        .views = scene->wisps[0].samples > 0 ? VIEW_HAIR : VIEW_SKELETON, /* hair fills envelopes */
        .trajectories = plan->trajectories,
        .width = question->width,
        .height = question->height};
}

static int row_of(struct strip_row *row, char path[PATH_SIZE], const struct labelled_case *run,
                  const char *label) {
    *row = (struct strip_row){.label = label, .states = path, .scene = run->run.scene};
    return path_format(path, "%s/states.tsv", run->run.folder);
}

int hair_strip(struct plan *plan, const struct hair_study *study) {
    char paths[HAIR_VARIANTS][PATH_SIZE];
    struct strip_row rows[HAIR_VARIANTS] = {{0}};
    const struct hair_question *question = study->question;
    int frames[HAIR_PICTURES], row_count = 0, count = 0, main = 0;
    for (int i = 0; i < study->count; i++) {
        const struct hair_run *run = &study->runs[i];
        if (run->variant->undrawn)
            continue;
        if (i == question->main)
            main = row_count;
        if (row_of(&rows[row_count], paths[row_count], run->timed, run->variant->label))
            return -1;
        row_count++;
    }
    if (row_count == 1)
        rows[0].label = "";
    struct strip_request request = request_of(plan, study, rows, row_count);
    request.columns = question->columns;
    request.large_row = main;
    request.scale = 0.5;
    request.large = question->large ? frame_shown(study, question->large) : 0;
    for (int k = 0; k < HAIR_PICTURES && question->pictures[k]; k++)
        if ((frames[count] = frame_shown(study, question->pictures[k])) > 0)
            count++;
    if (count == 0 && (frames[0] = last_frame(study)) > 0)
        count = 1;
    return count > 0 &&
                   strip_draw(&request, frames, count, plan->output.folder, "hair", plan->reason)
               ? -1
               : 0;
}

/* --- the steppers side by side --- */

void hair_name(char name[HAIR_NAME], const struct settings *settings) {
    if (settings->method->capabilities & STEPPER_ADAPTIVE)
        snprintf(name, HAIR_NAME, "%s, rtol %g", settings->method->name, settings->stepper.rtol);
    else
        snprintf(name, HAIR_NAME, "%s, %.0f Hz", settings->method->name, 1 / settings->step);
}

enum { ERRORS_MAX = 12 };

/* Where there are many, some are shown, from the nearest to the furthest. */
int hair_errors(struct plan *plan, const struct hair_study *study, const struct hair_error *errors,
                int count, const struct labelled_case *reference, int frame) {
    char paths[ERRORS_MAX][PATH_SIZE], labels[ERRORS_MAX][HAIR_NAME + 32], solution[PATH_SIZE],
        title[128];
    struct strip_row rows[ERRORS_MAX];
    const int shown = count < ERRORS_MAX ? count : ERRORS_MAX;
    if (path_format(solution, "%s/states.tsv", reference->run.folder))
        return -1;
    for (int i = 0; i < shown; i++) {
        const struct hair_error *error = &errors[shown > 1 ? i * (count - 1) / (shown - 1) : 0];
        char name[HAIR_NAME];
        hair_name(name, &error->run->run.settings);
        snprintf(labels[i], sizeof labels[i], "%s: %.2g mm", name, 1e3 * error->distance);
        if (row_of(&rows[i], paths[i], error->run, labels[i]))
            return -1;
    }
    snprintf(title, sizeof title, "%.64s after %.3g s", study->subject->name,
             (frame - 1) / reference->run.scene->frame_rate);
    struct strip_request request = request_of(plan, study, rows, shown);
    request.reference = solution;
    request.beside = 1;
    request.columns = 4;
    request.scale = 0.75;
    request.title = title;
    return strip_draw(&request, &frame, 1, plan->output.folder, "errors", plan->reason) ? -1 : 0;
}

/* --- the film --- */

#define FILM_COLUMNS(X)                                                     \
    X("frame", "1", "number of the frame, from 1", "%d", f + 1)             \
    X("t", "s", "its time", "%.17g", main->frames[f].t)                     \
    X("distance", "m", "rms over free nodes between the two runs", "%.17g", \
      rival ? hair_distance(main, rival, f) : NAN)                          \
    X("note", "-", "why there is no distance", "%s", rival ? "" : "there is one run")

static int write_film_table(struct plan *plan, const struct hair *main, const struct hair *rival,
                            int count) {
    FILE *stream = output_table(&plan->output, "film",
                                "the frames of film.png, a sheet with one below the other",
                                plan->subjects[0].scene, COLUMNS(FILM_COLUMNS));
    for (int f = 0; f < count && stream; f++)
        WRITE_ROW(stream, FILM_COLUMNS);
    return stream ? 0 : -1;
}

static void state_film(struct hair_study *study, const char *names, double seconds,
                       double distance) {
    const struct statement row =
        our_row("film", "film", HOLDS, study->rival ? 1e3 * distance : seconds,
                study->rival ? "mm" : "s", "film");
    if (study->rival)
        hair_state(study, row,
                   "The first %.3g s, at half their speed, by %s: after them the two are %.2g mm "
                   "(rms) apart.",
                   seconds, names, 1e3 * distance);
    else
        hair_state(study, row, "The first %.3g s, at half their speed, by %s.", seconds, names);
}

/* Counts the frames of the film's time that both runs have. */
static int film_frames(const struct hair_study *study, const struct hair *main,
                       const struct hair *rival) {
    const int most = 1 + (int)lround(study->question->film * main->scene->frame_rate);
    int count = main->frame_count < most ? main->frame_count : most;
    if (rival && rival->frame_count < count)
        count = rival->frame_count;
    return count;
}

static int draw_film(struct plan *plan, struct hair_study *study, const struct hair *main,
                     const struct hair *rival) {
    const struct labelled_case *runs[] = {study->runs[study->question->main].timed, study->rival};
    const int run_count = study->rival ? 2 : 1, count = film_frames(study, main, rival);
    char paths[2][PATH_SIZE], labels[2][HAIR_NAME], names[3 * HAIR_NAME];
    struct strip_row rows[2];
    int frames[FILM_FRAMES];
    if (count < 2 || count > FILM_FRAMES)
        return 0;
    for (int i = 0; i < count; i++)
        frames[i] = i + 1;
    for (int i = 0; i < run_count; i++) {
        hair_name(labels[i], &runs[i]->run.settings);
        if (row_of(&rows[i], paths[i], runs[i], labels[i]))
            return -1;
    }
    snprintf(names, sizeof names, run_count > 1 ? "%s (left) and %s (right)" : "%s", labels[0],
             labels[1]);
    state_film(study, names, main->frames[count - 1].t,
               rival ? hair_distance(main, rival, count - 1) : NAN);
    struct strip_request request = request_of(plan, study, rows, run_count);
    request.beside = request.untitled = 1;
    request.scale = 0.75;
    if (write_film_table(plan, main, rival, count))
        return -1;
    return strip_draw(&request, frames, count, plan->output.folder, "film", plan->reason) ? -1 : 0;
}

int hair_film(struct plan *plan, struct hair_study *study) {
    const struct hair_run *main = &study->runs[study->question->main];
    struct run_files files;
    struct hair rival;
    if (!(study->question->film > 0))
        return 0;
    if (!study->rival)
        return draw_film(plan, study, &main->hair, NULL);
    if (plan_read(plan, study->rival, &files))
        return -1;
    int code = hair_open(&rival, study->rival->run.scene, files.states,
                         (enum wisp_treatment)study->rival->run.settings.treatment, plan->reason);
    if (!code)
        code = draw_film(plan, study, &main->hair, &rival);
    hair_close(&rival);
    run_free(&files);
    return code;
}
