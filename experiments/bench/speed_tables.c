/* Tables and sentences of `speed`, from the samples alone. */
#include "base/files.h"
#include "experiments/common/measure.h"
#include "experiments/common/statements.h"
#include "speed.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double thesis_seconds = 28474; /* of the whole scene on an R4400 (section 5.6) */
static const char thesis_scene[] = "wind";

struct tables {
    const struct scene *scene;
    const struct choices *choices;
    const struct samples *samples;
    const char *folder;
    struct statements *statements;
    char *reason;
};

static void put(FILE *stream, struct quartiles q) {
    fprintf(stream, "\t%.4g\t%.4g\t%.4g", q.median, q.lower, q.upper);
}
#define TRIPLE(name) "\t" name "\t" name "_lower\t" name "_upper"

/* --- scenes --- */

static const struct series *scene_series(const struct tables *tables, const struct choice *choice,
                                         int threads) {
    char name[32];
    snprintf(name, sizeof name, "%d threads", threads);
    return series_find(tables->samples, "scene", choice->subject, name);
}

/* The samples are ns of a simulated second. */
static struct quartiles times_real_time(const struct series *series) {
    const struct quartiles ns = series_quartiles(series);
    return (struct quartiles){1e9 / ns.median, 1e9 / ns.upper, 1e9 / ns.lower};
}

static int write_scenes(const struct tables *tables) {
    struct atomic_file file;
    const int is_thesis = strcmp(tables->scene->name, thesis_scene) == 0;
    if (open_table(
            &file, tables->folder, "scenes",
            "the whole scene without frames; real_time: simulated over wall time, median and "
            "quartiles over rounds; over_thesis: the thesis's 28474 s over this; nan: the "
            "scene is not the thesis's",
            tables->scene,
            "target\twho\tmethod\ttreatment\tstep\terror\tthreads" TRIPLE(
                "real_time") "\tover_thesis",
            tables->reason))
        return -1;
    for (int i = 0; i < tables->choices->count; i++)
        for (int threads = 1; threads <= THREADS; threads++) {
            const struct choice *c = &tables->choices->choice[i];
            const struct quartiles speed = times_real_time(scene_series(tables, c, threads));
            fprintf(file.stream, "%g\t%s\t%s\t%s\t%.17g\t%.6g\t%d", c->target,
                    c->is_recipe ? "recipe" : "best", c->method, c->treatment, c->step, c->error,
                    threads);
            put(file.stream, speed);
            fprintf(file.stream, "\t%.4g\n",
                    is_thesis ? thesis_seconds * speed.median / tables->scene->duration : NAN);
        }
    return atomic_commit(&file, tables->reason);
}

static const struct choice *choice_of(const struct tables *tables, double target, int is_recipe) {
    for (int i = 0; i < tables->choices->count; i++)
        if (tables->choices->choice[i].target == target &&
            tables->choices->choice[i].is_recipe == is_recipe)
            return &tables->choices->choice[i];
    return NULL;
}

static void state_scene(const struct tables *tables, const struct choice *choice) {
    char key[64];
    const struct quartiles one = times_real_time(scene_series(tables, choice, 1)),
                           two = times_real_time(scene_series(tables, choice, 2)),
                           gain = ratio_quartiles(scene_series(tables, choice, 1),
                                                  scene_series(tables, choice, 2));
    snprintf(key, sizeof key, "real time, %s", choice->subject);
    const struct statement row = {
        .key = key, .figure = "speed", .tables = "scenes", .value = two.median, .unit = "1"};
    statements_add(tables->statements, row,
                   "Within %g mm, %s in treatment %s at %.5g Hz (error %.2g mm) runs %s %.3g times "
                   "as fast as real time on one thread and %.3g times on two, a gain of %.3g (%.3g "
                   "to %.3g).",
                   1e3 * choice->target, choice->method, choice->treatment, 1 / choice->step,
                   1e3 * choice->error, tables->scene->name, one.median, two.median, gain.median,
                   gain.lower, gain.upper);
}

/* Both just within the target: one over the other. */
static void state_targets(const struct tables *tables) {
    for (int i = 0; i < tables->choices->count; i++) {
        const struct choice *best = &tables->choices->choice[i],
                            *recipe = choice_of(tables, best->target, 1);
        char key[64];
        state_scene(tables, best);
        if (best->is_recipe || !recipe)
            continue;
        const struct quartiles ratio =
            ratio_quartiles(scene_series(tables, recipe, 1), scene_series(tables, best, 1));
        snprintf(key, sizeof key, "over the recipe, %g mm", 1e3 * best->target);
        const struct statement row = {.key = key,
                                      .figure = "speed",
                                      .tables = "scenes choices",
                                      .verdict = holds_if(ratio.lower > 1),
                                      .value = ratio.median,
                                      .unit = "1"};
        statements_add(
            tables->statements, row,
            "Within %g mm the thesis's recipe at %.5g Hz takes %.3g (%.3g to %.3g) times "
            "as long on %s as %s.",
            1e3 * best->target, 1 / recipe->step, ratio.median, ratio.lower, ratio.upper,
            tables->scene->name, best->method);
    }
}

/* --- steps --- */

static int write_steps(const struct tables *tables) {
    struct atomic_file file;
    if (open_table(&file, tables->folder, "steps",
                   "a step of one wisp, ns, in parts of four full lanes, and over one of explicit "
                   "Euler, round by round; median and quartiles",
                   tables->scene, "scene\tmethod" TRIPLE("ns") TRIPLE("euler_steps"),
                   tables->reason))
        return -1;
    for (int i = 0; i < tables->samples->count; i++) {
        const struct series *s = &tables->samples->series[i];
        if (strcmp(s->group, "step") != 0)
            continue;
        fprintf(file.stream, "%s\t%s", s->subject, s->name);
        put(file.stream, series_quartiles(s));
        put(file.stream,
            ratio_quartiles(s, series_find(tables->samples, "step", s->subject, "euler")));
        fputc('\n', file.stream);
    }
    return atomic_commit(&file, tables->reason);
}

static void state_step(const struct tables *tables, const char *method) {
    const struct quartiles ratio =
        ratio_quartiles(series_find(tables->samples, "step", step_sets[0], method),
                        series_find(tables->samples, "step", step_sets[0], "euler"));
    char key[64];
    snprintf(key, sizeof key, "step of %s", method);
    const struct statement row = {
        .key = key, .figure = "speed", .tables = "steps", .value = ratio.median, .unit = "1"};
    if (isfinite(ratio.median))
        statements_add(tables->statements, row,
                       "A step of %s costs %.3g (%.3g to %.3g) steps of explicit Euler on %s.",
                       method, ratio.median, ratio.lower, ratio.upper, step_sets[0]);
}

/* --- sizes --- */

static int write_sizes(const struct tables *tables) {
    static const char *const groups[] = {"wisps", "nodes", "samples"};
    struct atomic_file file;
    if (open_table(&file, tables->folder, "sizes",
                   "along wisps: ns of wall time for a simulated second of a wisp at the method's "
                   "usual rate, contestant: method and threads; along nodes and samples: ns for a "
                   "step of a wisp; median and quartiles",
                   tables->scene, "along\tnumber\tcontestant" TRIPLE("ns"), tables->reason))
        return -1;
    for (size_t g = 0; g < sizeof groups / sizeof *groups; g++) {
        for (int i = 0; i < tables->samples->count; i++) {
            const struct series *s = &tables->samples->series[i];
            if (strcmp(s->group, groups[g]) != 0)
                continue;
            fprintf(file.stream, "%s\t%s\t%s", s->group, s->subject, s->name);
            put(file.stream, series_quartiles(s));
            fputc('\n', file.stream);
        }
        fprintf(file.stream, "\n\n");
    }
    return atomic_commit(&file, tables->reason);
}

static int write_memory(const struct tables *tables) {
    struct atomic_file file;
    if (open_table(&file, tables->folder, "memory",
                   "bytes of a wisp, of the model and of its stepper", tables->scene,
                   "scene\tmethod\tbytes", tables->reason))
        return -1;
    for (int s = 0; s < STEP_SETS; s++)
        for (int m = 0; m < SIZED_METHODS; m++)
            fprintf(file.stream, "%s\t%s\t%.0f\n", step_sets[s], sized_methods[m],
                    note_find(tables->samples, "memory", step_sets[s], sized_methods[m]));
    return atomic_commit(&file, tables->reason);
}

/* --- peers --- */

static int is_own(const struct series *series) {
    return stepper_find(series->name) != NULL;
}

/* The cheapest of the program's own methods, or of the others; NULL: there is none. */
static const struct series *cheapest(const struct tables *tables, const char *question, int own) {
    const struct series *best = NULL;
    for (int i = 0; i < tables->samples->count; i++) {
        const struct series *s = &tables->samples->series[i];
        if (strcmp(s->group, "peer") == 0 && strcmp(s->subject, question) == 0 &&
            is_own(s) == own &&
            (!best || series_quartiles(s).median < series_quartiles(best).median))
            best = s;
    }
    return best;
}

static int write_peers(const struct tables *tables) {
    struct atomic_file file;
    if (open_table(&file, tables->folder, "peers",
                   "swing, exact enough: the longest step, s, or loosest rtol that is (setting), "
                   "its error, m, ns for a simulated second of a wisp, and that over the cheapest "
                   "of the program's own methods, round by round; median and quartiles",
                   tables->scene, "question\twho\tsetting\terror" TRIPLE("ns") TRIPLE("over_own"),
                   tables->reason))
        return -1;
    for (int k = 0; k < PEER_QUESTIONS; k++) {
        const char *question = peer_questions[k].name;
        const struct series *own = cheapest(tables, question, 1);
        for (int i = 0; i < tables->samples->count; i++) {
            const struct series *s = &tables->samples->series[i];
            if (strcmp(s->group, "peer") != 0 || strcmp(s->subject, question) != 0)
                continue;
            fprintf(file.stream, "%s\t%s\t%.6g\t%.6g", question, s->name,
                    note_find(tables->samples, "peer setting", question, s->name),
                    note_find(tables->samples, "peer error", question, s->name));
            put(file.stream, series_quartiles(s));
            put(file.stream, ratio_quartiles(s, own));
            fputc('\n', file.stream);
        }
    }
    return atomic_commit(&file, tables->reason);
}

static void state_peer(const struct tables *tables, const char *question, const char *who) {
    const struct series *own = cheapest(tables, question, 1);
    const struct quartiles ratio =
        ratio_quartiles(series_find(tables->samples, "peer", question, who), own);
    char key[96];
    snprintf(key, sizeof key, "%s, %s", question, who);
    struct statement row = {.key = key,
                            .figure = "speed",
                            .tables = "peers",
                            .verdict = holds_if(ratio.lower > 1),
                            .value = ratio.median,
                            .unit = "1"};
    if (isfinite(ratio.median)) {
        statements_add(tables->statements, row,
                       "On %s: %s takes %.3g (%.3g to %.3g) times as long as %s here.", question,
                       who, ratio.median, ratio.lower, ratio.upper, own->name);
    } else {
        row.verdict = NOT_REACHED;
        statements_add(tables->statements, row, "On %s: %s does not get so near.", question, who);
    }
}

int write_speed_tables(const struct scene *scene, const struct choices *choices,
                       const struct samples *samples, const char *folder, char *reason) {
    static const char *const peers[] = {"plain loop, Euler", "plain loop, RK4", "GSL rk8pd",
                                        "stock CVODE, KLU"};
    static const char *const stepped[] = {"linear-euler", "bdf2", "implicit-euler"};
    struct statements statements;
    const struct tables tables = {scene, choices, samples, folder, &statements, reason};
    if (statements_open(&statements, folder, scene, NULL, reason))
        return -1;
    const int code = write_scenes(&tables) || write_steps(&tables) || write_sizes(&tables) ||
                             write_memory(&tables) || write_peers(&tables)
                         ? -1
                         : 0;
    if (!code) {
        state_targets(&tables);
        for (size_t i = 0; i < sizeof stepped / sizeof *stepped; i++)
            state_step(&tables, stepped[i]);
        for (int k = 0; k < PEER_QUESTIONS; k++)
            for (size_t i = 0; i < sizeof peers / sizeof *peers; i++)
                state_peer(&tables, peer_questions[k].name, peers[i]);
    }
    return statements_close(&statements, code, reason);
}
