/* Tables and sentences of `speed`, from the samples alone. */
#include "experiments/common/measure.h"
#include "experiments/common/statements.h"
#include "speed.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double thesis_seconds = 28474; /* of the whole scene on an R4400 (section 5.6) */

struct tables {
    const struct scene *scene;
    const struct choices *choices;
    const struct samples *samples;
    struct output *output;
};

#define QUARTILES(X, name, unit, meaning, q) QUARTILE_COLUMNS(X, name, unit, meaning, "%.4g", q)

/* --- scenes --- */

/* `group`: "scene", or "thousand" wisps in it. */
static const struct series *scene_series(const struct tables *tables, const char *group,
                                         const struct choice *choice, int threads) {
    char name[32];
    snprintf(name, sizeof name, "%d threads", threads);
    return series_find(tables->samples, group, choice->subject, name);
}

/* The samples are ns of a simulated second. */
static struct quartiles times_real_time(const struct series *series) {
    const struct quartiles ns = series_quartiles(series);
    return (struct quartiles){1e9 / ns.median, 1e9 / ns.upper, 1e9 / ns.lower};
}

#define SCENE_COLUMNS(X)                                              \
    X("target", "m", "the error that is allowed", "%g", c->target)    \
    X("who", "-", "recipe: the thesis's; best: the cheapest", "%s",   \
      c->is_recipe ? "recipe" : "best")                               \
    X("method", "-", "the configuration", "%s", c->method)            \
    TREATED_COLUMN(X, c->treatment)                                   \
    X("setting", "s or 1", "step, s, or rtol", "%.17g", c->setting)   \
    X("error", "m", "error of that run", "%.6g", c->error)            \
    X("threads", "1", "threads that share the wisps", "%d", threads)  \
    QUARTILES(X, "real_time", "1", "simulated over wall time", speed) \
    X("over_thesis", "1", "the thesis's 28474 s over this", "%.4g",   \
      is_thesis ? thesis_seconds *speed.median / tables->scene->duration : (double)NAN)

static int write_scenes(const struct tables *tables) {
    const int is_thesis = strcmp(tables->scene->name, thesis_scene) == 0;
    FILE *stream =
        output_table(tables->output, "scenes",
                     "the whole scene without frames; setting: step, s, or rtol; real_time: "
                     "simulated over wall time, median and quartiles over rounds; over_thesis: the "
                     "thesis's 28474 s over this; nan: the scene is not the thesis's",
                     tables->scene, COLUMNS(SCENE_COLUMNS));
    if (!stream)
        return -1;
    for (int i = 0; i < tables->choices->count; i++)
        for (int threads = 1; threads <= THREADS; threads++) {
            const struct choice *c = &tables->choices->choice[i];
            const struct quartiles speed =
                times_real_time(scene_series(tables, "scene", c, threads));
            WRITE_ROW(stream, SCENE_COLUMNS);
        }
    return 0;
}

static const struct choice *choice_of(const struct tables *tables, double target, int is_recipe) {
    for (int i = 0; i < tables->choices->count; i++)
        if (tables->choices->choice[i].target == target &&
            tables->choices->choice[i].is_recipe == is_recipe)
            return &tables->choices->choice[i];
    return NULL;
}

/* "600 Hz", or "rtol 1e-4". */
static const char *setting_of(const struct choice *choice, char words[32]) {
    const int adaptive = (stepper_find(choice->method)->capabilities & STEPPER_ADAPTIVE) != 0;
    if (adaptive)
        snprintf(words, 32, "rtol %.3g", choice->setting);
    else
        snprintf(words, 32, "%.5g Hz", 1 / choice->setting);
    return words;
}

static void state_scene(const struct tables *tables, const struct choice *choice) {
    char setting[32];
    const struct quartiles one = times_real_time(scene_series(tables, "scene", choice, 1)),
                           two = times_real_time(scene_series(tables, "scene", choice, 2)),
                           gain = ratio_quartiles(scene_series(tables, "scene", choice, 1),
                                                  scene_series(tables, "scene", choice, 2));
    statements_add(
        &tables->output->statements,
        our_row("speed", "scenes", HOLDS, two.median, "1", "real time, %s", choice->subject),
        "Within %g mm, %s in treatment %s at %s (error %.2g mm) runs %s %.3g times as fast as real "
        "time on one thread and %.3g times on two, a gain of %.3g (%.3g to %.3g).",
        1e3 * choice->target, choice->method, choice->treatment, setting_of(choice, setting),
        1e3 * choice->error, tables->scene->name, one.median, two.median, gain.median, gain.lower,
        gain.upper);
}

static void state_thousand(const struct tables *tables, const struct choice *choice) {
    const struct quartiles two = times_real_time(scene_series(tables, "thousand", choice, THREADS));
    char setting[32];
    if (isfinite(two.median))
        statements_add(&tables->output->statements,
                       our_row("speed", "samples", HOLDS, two.median, "1", "thousand wisps, %s",
                               choice->subject),
                       "A thousand wisps on the same head, which stand out from it at first, run "
                       "by %s at %s %.3g (%.3g to %.3g) times as fast as real time on two threads "
                       "through the first fifth of a second of the gust.",
                       choice->method, setting_of(choice, setting), two.median, two.lower,
                       two.upper);
}

/* Both just within the target: one over the other. */
static void state_targets(const struct tables *tables) {
    for (int i = 0; i < tables->choices->count; i++) {
        const struct choice *best = &tables->choices->choice[i],
                            *recipe = choice_of(tables, best->target, 1);
        char setting[32];
        state_scene(tables, best);
        state_thousand(tables, best);
        if (best->is_recipe || !recipe)
            continue;
        const struct quartiles ratio = ratio_quartiles(scene_series(tables, "scene", recipe, 1),
                                                       scene_series(tables, "scene", best, 1));
        statements_add(&tables->output->statements,
                       our_row("speed", "scenes choices", holds_if(ratio.lower > 1), ratio.median,
                               "1", "over the recipe, %g mm", 1e3 * best->target),
                       "Within %g mm the thesis's recipe at %s takes %.3g (%.3g to %.3g) times as "
                       "long on %s as %s.",
                       1e3 * best->target, setting_of(recipe, setting), ratio.median, ratio.lower,
                       ratio.upper, tables->scene->name, best->method);
    }
}

/* --- steps --- */

#define STEP_COLUMNS(X)                                                               \
    SCENE_COLUMN(X, s->subject)                                                       \
    X("method", "-", "the configuration", "%s", s->name)                              \
    QUARTILES(X, "ns", "ns", "a step of one wisp", series_quartiles(s))               \
    QUARTILES(X, "euler_steps", "1", "a step of one wisp over one of explicit Euler", \
              ratio_quartiles(s, series_find(tables->samples, "step", s->subject, "euler")))

static int write_steps(const struct tables *tables) {
    FILE *stream = output_table(tables->output, "steps",
                                "a step of one wisp, ns, in full parts as wide as runs' are, and "
                                "over one of explicit Euler, round by round; median and quartiles",
                                tables->scene, COLUMNS(STEP_COLUMNS));
    if (!stream)
        return -1;
    for (int i = 0; i < tables->samples->count; i++) {
        const struct series *s = &tables->samples->series[i];
        if (strcmp(s->group, "step") == 0)
            WRITE_ROW(stream, STEP_COLUMNS);
    }
    return 0;
}

static void state_step(const struct tables *tables, const char *method) {
    const struct quartiles ratio =
        ratio_quartiles(series_find(tables->samples, "step", step_sets[0], method),
                        series_find(tables->samples, "step", step_sets[0], "euler"));
    if (isfinite(ratio.median))
        statements_add(&tables->output->statements,
                       our_row("speed", "steps", HOLDS, ratio.median, "1", "step of %s", method),
                       "A step of %s costs %.3g (%.3g to %.3g) steps of explicit Euler on %s.",
                       method, ratio.median, ratio.lower, ratio.upper, step_sets[0]);
}

/* --- sizes --- */

#define SIZE_COLUMNS(X)                                                                         \
    X("along", "-", "wisps, nodes or samples: what is varied", "%s", s->group)                  \
    X("number", "1", "number of these", "%s", s->subject)                                       \
    X("candidate", "-", "the method, and along wisps its threads", "%s", s->name)               \
    QUARTILES(X, "ns", "ns", "time of a wisp's simulated second along wisps, else of its step", \
              series_quartiles(s))

static int write_sizes(const struct tables *tables) {
    static const char *const groups[] = {"wisps", "nodes", "samples"};
    FILE *stream = output_table(tables->output, "sizes",
                                "along wisps: ns of wall time for a simulated second of a wisp at "
                                "the method's usual rate, candidate: method and threads; along "
                                "nodes and samples: ns for a step of a wisp; median and quartiles",
                                tables->scene, COLUMNS(SIZE_COLUMNS));
    if (!stream)
        return -1;
    for (size_t g = 0; g < sizeof groups / sizeof *groups; g++) {
        for (int i = 0; i < tables->samples->count; i++) {
            const struct series *s = &tables->samples->series[i];
            if (strcmp(s->group, groups[g]) == 0)
                WRITE_ROW(stream, SIZE_COLUMNS);
        }
        fprintf(stream, "\n\n");
    }
    return 0;
}

#define MEMORY_COLUMNS(X)                                                           \
    SCENE_COLUMN(X, step_sets[s])                                                   \
    X("method", "-", "the configuration", "%s", sized_methods[m])                   \
    X("bytes", "byte", "memory of a wisp, of the model and of its stepper", "%.0f", \
      note_find(tables->samples, "memory", step_sets[s], sized_methods[m]))

static int write_memory(const struct tables *tables) {
    FILE *stream =
        output_table(tables->output, "memory", "bytes of a wisp, of the model and of its stepper",
                     tables->scene, COLUMNS(MEMORY_COLUMNS));
    if (!stream)
        return -1;
    for (int s = 0; s < STEP_SETS; s++)
        for (int m = 0; m < SIZED_METHODS; m++)
            WRITE_ROW(stream, MEMORY_COLUMNS);
    return 0;
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

#define PEER_COLUMNS(X)                                                                     \
    X("question", "-", "the scene and how exact", "%s", question)                           \
    X("who", "-", "a method of ours, or another program", "%s", s->name)                    \
    X("setting", "s or 1", "longest step, s, or loosest rtol that is exact enough", "%.6g", \
      note_find(tables->samples, "peer setting", question, s->name))                        \
    X("error", "m", "error of that run", "%.6g",                                            \
      note_find(tables->samples, "peer error", question, s->name))                          \
    QUARTILES(X, "ns", "ns", "time of a simulated second of a wisp", series_quartiles(s))   \
    QUARTILES(X, "over_own", "1", "such a time over that of our cheapest method",           \
              ratio_quartiles(s, own))

static int write_peers(const struct tables *tables) {
    FILE *stream =
        output_table(tables->output, "peers",
                     "swing, exact enough: the longest step, s, or loosest rtol that is (setting), "
                     "its error, m, ns for a simulated second of a wisp, and that over the "
                     "cheapest of the program's own methods, round by round; median and quartiles",
                     tables->scene, COLUMNS(PEER_COLUMNS));
    if (!stream)
        return -1;
    for (int k = 0; k < PEER_QUESTIONS; k++) {
        const char *question = peer_questions[k].name;
        const struct series *own = cheapest(tables, question, 1);
        for (int i = 0; i < tables->samples->count; i++) {
            const struct series *s = &tables->samples->series[i];
            if (strcmp(s->group, "peer") == 0 && strcmp(s->subject, question) == 0)
                WRITE_ROW(stream, PEER_COLUMNS);
        }
    }
    return 0;
}

static void state_peer(const struct tables *tables, const char *question, const char *who) {
    const struct series *own = cheapest(tables, question, 1);
    const struct quartiles ratio =
        ratio_quartiles(series_find(tables->samples, "peer", question, who), own);
    struct statement row = our_row("speed", "peers", holds_if(ratio.lower > 1), ratio.median, "1",
                                   "%s, %s", question, who);
    if (isfinite(ratio.median)) {
        statements_add(&tables->output->statements, row,
                       "On %s: %s takes %.3g (%.3g to %.3g) times as long as %s here.", question,
                       who, ratio.median, ratio.lower, ratio.upper, own->name);
    } else {
        row.verdict = NOT_REACHED;
        statements_add(&tables->output->statements, row, "On %s: %s does not get so near.",
                       question, who);
    }
}

int write_speed_tables(const struct scene *scene, const struct choices *choices,
                       const struct samples *samples, struct output *output) {
    static const char *const peers[] = {"plain loop, Euler", "plain loop, RK4", "GSL rk8pd",
                                        "stock CVODE, KLU"};
    static const char *const stepped[] = {"linear-euler", "bdf2", "implicit-euler"};
    const struct tables tables = {scene, choices, samples, output};
    if (write_scenes(&tables) || write_steps(&tables) || write_sizes(&tables) ||
        write_memory(&tables) || write_peers(&tables))
        return -1;
    state_targets(&tables);
    for (size_t i = 0; i < sizeof stepped / sizeof *stepped; i++)
        state_step(&tables, stepped[i]);
    for (int k = 0; k < PEER_QUESTIONS; k++)
        for (size_t i = 0; i < sizeof peers / sizeof *peers; i++)
            state_peer(&tables, peer_questions[k].name, peers[i]);
    return 0;
}
