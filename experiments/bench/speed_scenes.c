/* Whole scenes in this process, as `wisplab run` has them but without frames. */
#include "base/text_table.h"
#include "experiments/common/measure.h"
#include "integrators/configurations.h"
#include "run/simulation.h"
#include "scene/scene_load.h"
#include "speed.h"

#include <stdlib.h>
#include <string.h>

const char thesis_scene[] = "wind";

/* --- choices --- */

static void take(struct choice *choice, const struct text_table *table, int row) {
    const char *who = text_table_cell(table, row, "who");
    choice->target = text_table_number(table, row, "target");
    choice->setting = text_table_number(table, row, "setting");
    choice->error = text_table_number(table, row, "error");
    choice->is_recipe = strcmp(who, "recipe") == 0;
    snprintf(choice->subject, sizeof choice->subject, "%g mm, %.20s", 1e3 * choice->target, who);
    snprintf(choice->method, sizeof choice->method, "%s", text_table_cell(table, row, "method"));
    snprintf(choice->treatment, sizeof choice->treatment, "%s",
             text_table_cell(table, row, "treatment"));
}

struct choices *choices_read(const char *folder, char *reason) {
    struct choices *choices = zeros(sizeof *choices);
    struct text_table table;
    char path[PATH_SIZE];
    path_format(path, "%s/choices.tsv", folder);
    if (hash_file(path, choices->hash)) {
        snprintf(reason, REASON_SIZE, "%.200s: cannot be read", path);
        choices_free(choices);
        return NULL;
    }
    if (text_table_read(&table, path, reason)) {
        choices_free(choices);
        return NULL;
    }
    choices->choice = zeros((size_t)table.row_count * sizeof *choices->choice);
    for (int row = 0; row < table.row_count; row++)
        take(&choices->choice[choices->count++], &table, row);
    text_table_free(&table);
    return choices;
}

void choices_free(struct choices *choices) {
    if (choices)
        free(choices->choice);
    free(choices);
}

/* --- runs --- */

struct timed_run *timed_run(const struct scene *scene, const struct run_request *request) {
    struct timed_run *run = zeros(sizeof *run);
    char reason[REASON_SIZE];
    run->scene = scene;
    if (settings_resolve(scene, request, &run->settings, reason))
        give_up("%s with %s: %s", scene->name, request->stepper, reason);
    return run;
}

void timed_run_do(void *timed_run) {
    const struct timed_run *run = timed_run;
    struct run_result result;
    simulate(run->scene, &run->settings, NULL, NULL, &result);
    if (result.outcome != FINISHED)
        give_up("%s with %s: %s", run->scene->name, run->settings.method->name, result.reason);
}

struct scene *bench_scene(const char *name, const char *const *sets, int set_count) {
    char reason[REASON_SIZE];
    struct scene *scene = scene_load(name, sets, set_count, reason);
    if (!scene)
        give_up("%s", reason);
    return scene;
}

/* One thread by its CPU time, which others on the machine hardly change; several by the clock. */
static void enter_threads(struct contest *contest, const char *group, const struct scene *scene,
                          const struct choice *choice) {
    const struct configuration method = configuration_of(stepper_find(choice->method));
    struct run_request request =
        configuration_request(&method, choice->setting, scene->run.atol / scene->run.rtol);
    request.treatment = choice->treatment;
    for (request.threads = 1; request.threads <= THREADS; request.threads++) {
        char name[32];
        snprintf(name, sizeof name, "%d threads", request.threads);
        (request.threads == 1 ? contest_add : contest_add_wall)(contest, group, choice->subject,
                                                                name, scene->duration, timed_run_do,
                                                                timed_run(scene, &request));
    }
}

/* A thousand wisps in the gust of the thesis's scene, on the same head, by the best method within
 * the first target. There is no start for them: they stand out from it at first. */
static void enter_thousand(struct contest *contest, const struct choices *choices) {
    static const char *const sets[] = {
        "wisps.[0].count=1000", "duration=0.2",
        "style={times=[0.0]; accelerations=([0.0,-9.81,0.0]);}",
        "wind={kind=\"gust\"; velocity=[4.0,0.0,0.0]; hold=1.0; decay=0.082;}"};
    const struct scene *scene = bench_scene("wind-settle", sets, (int)(sizeof sets / sizeof *sets));
    int first = 0;
    while (first < choices->count && choices->choice[first].is_recipe)
        first++;
    if (first < choices->count)
        enter_threads(contest, "thousand", scene, &choices->choice[first]);
}

void enter_scenes(struct contest *contest, const struct scene *scene,
                  const struct choices *choices) {
    for (int i = 0; i < choices->count; i++)
        enter_threads(contest, "scene", scene, &choices->choice[i]);
    if (strcmp(scene->name, thesis_scene) == 0)
        enter_thousand(contest, choices);
}
