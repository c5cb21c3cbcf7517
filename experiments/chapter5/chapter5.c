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
    if (plan_has_no_steppers(plan, "figures"))
        return -1;
    if (plan->scene_count > 0) {
        snprintf(plan->reason, REASON_SIZE,
                 "experiment %s is of chapter 5's own; leave out --scene", plan->experiment->name);
        return -1;
    }
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

/* Adds a name to a list of them. */
static void add(char *list, size_t size, int differs, const char *name) {
    const size_t used = strlen(list);
    if (differs)
        snprintf(list + used, size - used, "%s%s", used ? ", " : "", name);
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

static int write_models(struct plan *plan, const char *folder) {
    struct atomic_file file;
    char list[200];
    if (open_table(&file, folder, "models",
                   "what the scenes have: length, m; radius, m; bending stiffness, N m^2; drag, "
                   "1/s; frequency of the envelope, Hz; threshold; viscosity, 1/s; deviates: from "
                   "the default material and contacts, and from 30 cm on 11 nodes",
                   NULL,
                   "figure\tscene\twisps\tlength\tnodes\tradius\tbending\tbending_stiffness\tdrag"
                   "\tfrequency\tthreshold\tviscosity\treciprocal\tdeviates",
                   plan->reason))
        return -1;
    for (int i = 0; i < ROWS; i++) {
        const struct scene *scene = plan->cases[i].run.scene;
        const struct wisp *wisp = &scene->wisps[0];
        const struct interaction_settings *contact = &scene->interaction;
        deviations(scene, list, sizeof list);
        fprintf(file.stream, "%s\t%s\t%d\t%g\t%d\t%g\t%s\t%g\t%g\t%g\t%g\t%g\t%d\t%s\n",
                rows[i].label, rows[i].scene, scene->wisp_count, wisp->length, wisp->nodes,
                wisp->radius, bending_name(wisp->bending), wisp->bending_stiffness, wisp->drag_rate,
                wisp->frequency, contact->threshold, contact->viscosity, contact->reciprocal, list);
    }
    return atomic_commit(&file, plan->reason);
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

static int write_prices(struct plan *plan, const char *folder, const struct price *prices) {
    struct atomic_file file;
    if (open_table(
            &file, folder, "figures",
            "what a wisp of the scene takes for a frame: CPU time, s, of repeated runs; over "
            "the first row's, with what the spreads allow, and the thesis's (up to four wisps "
            "are computed side by side, for the price of one: where there are two, each is "
            "twice as dear); evaluations of forces; contacts, at all ticks of a frame, with "
            "wisps and bodies",
            NULL,
            "figure\tcpu\tleast\tgreatest\tours\tours_least\tours_greatest\tthesis"
            "\tevaluations\tcontacts",
            plan->reason))
        return -1;
    for (int i = 0; i < ROWS; i++) {
        const struct price *price = &prices[i];
        fprintf(file.stream, "%s\t%.17g\t%.17g\t%.17g\t%.17g\t%.17g\t%.17g\t%.17g\t%.17g\t%.17g\n",
                rows[i].label, price->cpu.median, price->cpu.least, price->cpu.greatest,
                price->ours, price->least, price->most, price->ratio, price->evaluations,
                price->contacts);
    }
    return atomic_commit(&file, plan->reason);
}

/* Of how many pairs of rows the one that costs the thesis more has more to compute here: more
 * evaluations, or as many and more contacts. Rows that cost it the same to 5 % are no pair. */
static void state_order(struct statements *statements, const struct price *prices) {
    int pairs = 0, same = 0;
    for (int i = 0; i < ROWS; i++)
        for (int j = 0; j < ROWS; j++) {
            const struct price *dear = &prices[i], *cheap = &prices[j];
            if (dear->ratio < 1.05 * cheap->ratio)
                continue;
            const double more = dear->evaluations / cheap->evaluations;
            pairs++;
            same += more > 1.01 || (more > 0.99 && dear->contacts > cheap->contacts);
        }
    statements_add(statements,
                   (struct statement){.key = "order",
                                      .figure = "figures",
                                      .tables = "figures",
                                      .by = THESIS,
                                      .verdict = holds_if(same == pairs),
                                      .value = same,
                                      .unit = "1"},
                   "What costs the thesis more has more evaluations or more contacts here: of %d "
                   "pairs of rows %d.",
                   pairs, same);
}

static void state_all(struct plan *plan, struct statements *statements,
                      const struct price *prices) {
    for (int i = 0; i < ROWS; i++) {
        const struct price *price = &prices[i];
        char list[200];
        deviations(plan->cases[i].run.scene, list, sizeof list);
        statements_add(statements,
                       (struct statement){.key = rows[i].label,
                                          .figure = "figures",
                                          .tables = "figures models",
                                          .verdict = isfinite(price->ours) ? HOLDS : NOT_REACHED,
                                          .value = price->ours,
                                          .unit = "1"},
                       "A wisp of figure %s costs %.2f times (%.2f to %.2f) what one of 5.2 costs "
                       "without interaction, in the thesis %.2f times, with %.0f evaluations and "
                       "%.1f contacts a frame; off the common model: %s.",
                       rows[i].label, price->ours, price->least, price->most, price->ratio,
                       price->evaluations, price->contacts, list);
    }
    state_order(statements, prices);
}

static int chapter5_tabulate(struct plan *plan, const char *folder) {
    struct statements statements;
    struct price prices[ROWS];
    if (read_prices(plan, prices) || write_models(plan, folder) ||
        write_prices(plan, folder, prices) ||
        statements_open(&statements, folder, NULL, NULL, plan->reason))
        return -1;
    state_all(plan, &statements, prices);
    return statements_close(&statements, 0, plan->reason);
}

const struct experiment chapter5_experiment = {
    .name = "chapter5",
    .question = "how nearly are its figures one model, and what does a wisp cost in each?",
    .thesis = "chapter 5",
    .place = 14,
    .quick_seconds = 2,
    .full_seconds = 8,
    .plan = chapter5_plan,
    .tabulate = chapter5_tabulate,
};
