/* The figures of the thesis's chapter 5 beside each other: how nearly their scenes are one model,
 * and what a wisp costs in each. */
#include "hair_study.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A row of the thesis's tables 5.1 to 5.4, or a time that its text has. */
struct row {
    const char *label, *scene;
    const char *sets[HAIR_SETS];
    double thesis; /* CPU time, s per frame */
};

#define NO_INTERPENETRATION "contacts.interpenetration=false"
#define NO_COLLISION        "contacts.collision=false"

/* The first is what the others are measured by: wisps that do not feel each other. */
static const struct row rows[] = {
    {"5.2 none", "interactions", {NO_INTERPENETRATION, NO_COLLISION}, 0.76},
    {"5.2 all", "interactions", {NULL}, 0.91},
    {"5.1 radius 1 cm", "radii", {"envelope.radius=0.01"}, 3.92},
    {"5.1 radius 3 cm", "radii", {"envelope.radius=0.03"}, 5.14},
    {"5.3 viscosity 0.5", "viscosity", {"contacts.viscosity=0.5"}, 0.85},
    {"5.4 sphere", "sphere", {NULL}, 21.6},
    {"5.5 without", "subdivision", {"subdivision.ratio=1e-6"}, 0.88},
    {"5.5 with", "subdivision", {NULL}, 1.66},
    {"5.6 wind", "wind", {HAIR_START_PROJECTION}, 235},
};
enum { ROWS = sizeof rows / sizeof *rows, NONE = 0 };

static int count_sets(const struct row *row) {
    int count = 0;
    while (count < HAIR_SETS && row->sets[count])
        count++;
    return count;
}

static int chapter5_plan(struct plan *plan) {
    const struct stepper_method *recipe = stepper_find(thesis_recipe.stepper);
    plan->run_seconds = 300;
    if (plan_has_no_steppers(plan, "figures") || plan_has_no_scenes(plan))
        return -1;
    for (int i = 0; i < ROWS; i++) {
        const struct scene *scene =
            plan_scene(plan, rows[i].scene, rows[i].sets, count_sets(&rows[i]));
        if (!scene)
            return -1;
        const struct run_request request = hair_timed_request(plan, scene, recipe);
        if (plan_add(plan, scene, &request, "figures", "%s", rows[i].label))
            return -1;
    }
    return 0;
}

/* --- how nearly they are one model --- */

static void add(char *list, size_t size, int differs, const char *name) {
    if (differs)
        list_add(list, size, "%s", name);
}

/* In what a scene is off the common model: the defaults, 30 cm on 11 nodes. */
static void deviations(const struct scene *scene, char *list, size_t size) {
    const struct wisp *wisp = &scene->wisps[0];
    const struct interaction_settings *contact = &scene->interaction;
    list[0] = '\0';
    add(list, size, wisp->length != 0.30, "length");
    add(list, size, wisp->length == 0.30 && wisp->nodes != 11, "nodes");
    add(list, size, wisp->radius != 0.02, "radius");
    add(list, size, wisp->bending != BENDING_SKIP, "bending");
    add(list, size, wisp->bending_stiffness != 1e-5, "bending stiffness");
    add(list, size, wisp->drag_rate != 4, "drag");
    add(list, size, wisp->frequency != 10, "envelope's frequency");
    add(list, size, contact->threshold != 0.9, "threshold");
    add(list, size, contact->viscosity != 5, "viscosity");
    add(list, size, !contact->reciprocal, "one-sided response");
    add(list, size, !contact->interpenetration && !contact->collision, "no wisp contact");
    if (!list[0])
        snprintf(list, size, "nothing");
}

static const char *bending_name(enum bending bending) {
    return bending == BENDING_SKIP ? "skip" : bending == BENDING_HINGE ? "hinge" : "none";
}

#define MODEL_COLUMNS(X)                                                                       \
    X("figure", "-", "figure of the thesis, and the row", "%s", rows[i].label)                 \
    SCENE_COLUMN(X, rows[i].scene)                                                             \
    X("wisps", "1", "number of wisps", "%d", scene->wisp_count)                                \
    X("length", "m", "length of a wisp", "%g", wisp->length)                                   \
    X("nodes", "1", "nodes of a wisp", "%d", wisp->nodes)                                      \
    X("radius", "m", "radius of the envelope", "%g", wisp->radius)                             \
    X("bending", "-", "the law of bending", "%s", bending_name(wisp->bending))                 \
    X("bending_stiffness", "N m^2", "of a wisp", "%g", wisp->bending_stiffness)                \
    X("drag", "1/s", "drag of the air over the mass", "%g", wisp->drag_rate)                   \
    X("frequency", "Hz", "frequency of the envelope", "%g", wisp->frequency)                   \
    X("threshold", "1", "threshold between interpenetration and collision", "%g",              \
      contact->threshold)                                                                      \
    X("viscosity", "1/s", "viscosity of interpenetration", "%g", contact->viscosity)           \
    X("reciprocal", "1", "1 where both wisps of a contact feel it", "%d", contact->reciprocal) \
    X("deviates", "-", "in what it is off the common model", "%s", list)

static int write_models(struct plan *plan) {
    char list[200];
    FILE *stream =
        output_table(&plan->output, "models",
                     "what the scenes have: length, m; radius, m; bending stiffness, N m^2; drag, "
                     "1/s; frequency of the envelope, Hz; threshold; viscosity, 1/s; deviates: "
                     "from the default material and contacts, and from 30 cm on 11 nodes",
                     NULL, COLUMNS(MODEL_COLUMNS));
    for (int i = 0; i < ROWS && stream; i++) {
        const struct scene *scene = plan->cases[i].run.scene;
        const struct wisp *wisp = &scene->wisps[0];
        const struct interaction_settings *contact = &scene->interaction;
        deviations(scene, list, sizeof list);
        WRITE_ROW(stream, MODEL_COLUMNS);
    }
    return stream ? 0 : -1;
}

/* --- what a wisp costs --- */

struct price {
    struct spread cpu;               /* s per frame, of a wisp of the scene */
    double thesis;                   /* likewise */
    double evaluations, contacts;    /* per frame and wisp: of forces; with wisps and bodies */
    double ours, least, most, ratio; /* over the first row's: ours with its spread, the thesis's */
};

static int read_prices(struct plan *plan, struct price *prices) {
    for (int i = 0; i < ROWS; i++) {
        const struct scene *scene = plan->cases[i].run.scene;
        const double wisps = scene->wisp_count;
        struct run_files files;
        if (run_read(&files, plan->cases[i].run.folder, plan->reason))
            return -1;
        const struct cost cost = run_cost(&files);
        const struct spread cpu = hair_per_frame(&cost, scene);
        const double frames = hair_frames(&cost, scene);
        prices[i] = (struct price){
            .cpu = {cpu.median / wisps, cpu.least / wisps, cpu.greatest / wisps},
            .thesis = rows[i].thesis / wisps,
            .evaluations = run_number(&files, "counters.force_evaluations") / frames / wisps,
            .contacts = (run_number(&files, "counters.wisp_contacts") +
                         run_number(&files, "counters.body_contacts")) /
                        frames / wisps};
        run_free(&files);
    }
    for (int i = 0; i < ROWS; i++) {
        struct price *price = &prices[i];
        const struct price *none = &prices[NONE];
        price->ours = price->cpu.median / none->cpu.median;
        price->least = i == NONE ? 1 : price->cpu.least / none->cpu.greatest;
        price->most = i == NONE ? 1 : price->cpu.greatest / none->cpu.least;
        price->ratio = price->thesis / none->thesis;
    }
    return 0;
}

#define PRICE_COLUMNS(X)                                                                    \
    X("figure", "-", "figure of the thesis, and the row", "%s", rows[i].label)              \
    X("cpu", "s", "CPU time of a wisp for a frame: median of repeated runs", "%.17g",       \
      price->cpu.median)                                                                    \
    X("least", "s", "least CPU time of repeated runs", "%.17g", price->cpu.least)           \
    X("greatest", "s", "greatest CPU time of repeated runs", "%.17g", price->cpu.greatest)  \
    X("ours", "1", "cpu over the first row's", "%.17g", price->ours)                        \
    X("ours_least", "1", "the least that the spreads allow", "%.17g", price->least)         \
    X("ours_greatest", "1", "the greatest that the spreads allow", "%.17g", price->most)    \
    X("thesis", "1", "the thesis's time over that of its first row", "%.17g", price->ratio) \
    X("evaluations", "1", "evaluations of forces, per wisp and frame", "%.17g",             \
      price->evaluations)                                                                   \
    X("contacts", "1", "contacts with wisps and bodies, per wisp and frame", "%.17g",       \
      price->contacts)

static int write_prices(struct plan *plan, const struct price *prices) {
    FILE *stream = output_table(
        &plan->output, "figures",
        "what a wisp of the scene takes for a frame: CPU time, s, of repeated runs; over the first "
        "row's, with what the spreads allow, and the thesis's (up to four wisps are computed side "
        "by side, for the price of one: where there are two, each is twice as expensive); "
        "evaluations of forces; contacts, at all ticks of a frame, with wisps and bodies",
        NULL, COLUMNS(PRICE_COLUMNS));
    for (int i = 0; i < ROWS && stream; i++) {
        const struct price *price = &prices[i];
        WRITE_ROW(stream, PRICE_COLUMNS);
    }
    return stream ? 0 : -1;
}

/* Counts the pairs of rows of which the one that costs the thesis more has more to compute here:
 * more evaluations, or as many and more contacts. Rows that cost it the same to 5 % are no pair. */
static void state_order(struct statements *statements, const struct price *prices) {
    int pairs = 0, same = 0;
    for (int i = 0; i < ROWS; i++)
        for (int j = 0; j < ROWS; j++) {
            const struct price *expensive = &prices[i], *cheap = &prices[j];
            if (expensive->ratio < 1.05 * cheap->ratio)
                continue;
            const double more = expensive->evaluations / cheap->evaluations;
            pairs++;
            same += more > 1.01 || (more > 0.99 && expensive->contacts > cheap->contacts);
        }
    statements_add(statements,
                   thesis_row("figures", "figures", holds_if(same == pairs), same, "1", "order"),
                   "What took longer in the thesis has more evaluations or more contacts: of %d "
                   "pairs of figures %d have.",
                   pairs, same);
}

static void state_all(struct plan *plan, struct statements *statements,
                      const struct price *prices) {
    for (int i = 0; i < ROWS; i++) {
        const struct price *price = &prices[i];
        char list[200];
        deviations(plan->cases[i].run.scene, list, sizeof list);
        const struct statement row =
            our_row("figures", "figures models", isfinite(price->ours) ? HOLDS : NOT_REACHED,
                    price->ours, "1", "%s", rows[i].label);
        if (i == NONE)
            statements_add(statements, row,
                           "A wisp of figure %s, by which the others are measured, takes %.3g ms "
                           "of CPU time and %.0f evaluations a frame.",
                           rows[i].label, 1e3 * price->cpu.median, price->evaluations);
        else
            statements_add(
                statements, row,
                "A wisp of figure %s costs %.2f times (%.2f to %.2f) what one of 5.2 costs without "
                "interaction, and %.2f times in the thesis; it has %.0f evaluations and %.1f "
                "contacts a frame, and what is off the common model is %s.",
                rows[i].label, price->ours, price->least, price->most, price->ratio,
                price->evaluations, price->contacts, list);
    }
    state_order(statements, prices);
}

static int chapter5_tabulate(struct plan *plan) {
    struct price prices[ROWS];
    if (read_prices(plan, prices) || write_models(plan) || write_prices(plan, prices) ||
        plan_open_statements(plan, NULL, NULL))
        return -1;
    state_all(plan, &plan->output.statements, prices);
    return 0;
}

const struct experiment chapter5_experiment = {
    .name = "chapter5",
    .question = "how nearly are its figures one model, and what does a wisp cost in each?",
    .thesis = "chapter 5",
    .chapter = CHAPTER_THESIS,
    .place = 14,
    .headline = "order",
    .quick_seconds = 2,
    .full_seconds = 8,
    .plan = chapter5_plan,
    .tabulate = chapter5_tabulate,
};
