/* How fast does a step carry news? The thesis's section 3.1: a change at the tip of Rosenblum's
 * hair, of fifteen particles, makes the root react only fifteen evaluations later. An evaluation
 * carries news as far as a force reaches; so a step of an explicit method carries it as many times
 * as far as it evaluates forces one on the other, and a step that solves a linear system, to the
 * end. An explicit step must carry news at least as fast as a wave runs along the hair: that is why
 * its rate grows with the number of nodes (Courant, Friedrichs & Lewy 1928). */
#include "experiments/common/sets.h"
#include "graph.h"
#include "history.h"
#include "model/model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Fifteen particles with the one at the root, which is node 1 here. */
#define HAIR "wisps=({root=[0.0,0.0,0.0];direction=[1.0,0.0,0.0];length=0.3;nodes=16;})"
enum { NODES = 16, FREE = NODES - 2, STEPS_MOST = 4 * NODES, COLUMNS_MOST = 8 };

/* Whose forces. */
static const struct law {
    const char *name, *scene, *set;
} laws[] = {
    {"springs alone", "swing", "material={bending=\"none\";}"},
    {"skip springs", "swing", NULL},
    {"hinges", "swing", "material={bending=\"hinge\";}"},
    {"Rosenblum's", "rosenblum", NULL},
    {"Rosenblum's without hinges", "rosenblum", "material.bending_stiffness=0"},
    {"Anjyo's", "anjyo", NULL},
};
enum { SPRINGS, SKIP, HINGES, ROSENBLUM, NO_HINGES, ANJYO, LAWS };

/* --- a real hair --- */

/* Bent, so that every force acts; the tip `aside` further to the side. */
static void bend(struct model *model, double *rows, double aside) {
    model->problem->sample(model, rows);
    for (int i = 2; i < NODES; i++) {
        double *x = rows + i * model->column_count + 2;
        x[1] += 2e-3 * sin(1.3 * i);
        x[2] += 2e-3 * cos(2.1 * i);
    }
    rows[(NODES - 1) * model->column_count + 4] += aside;
    model->problem->restore(model, rows);
}

struct hair {
    struct model *model;
    struct stepper *stepper;
    double rows[NODES * COLUMNS_MOST];
    double t;
};

static int hair_open(struct hair *hair, const struct scene *scene,
                     const struct stepper_method *method, double aside) {
    *hair = (struct hair){
        .model = scene->problem->create(scene, scene->problem->default_treatment(method), 1)};
    if (!hair->model)
        return -1;
    bend(hair->model, hair->rows, aside);
    hair->stepper = any_stepper(method, &hair->model->parts[0].system);
    return hair->stepper ? 0 : 1;
}

static void hair_close(struct hair *hair) {
    if (hair->stepper)
        hair->stepper->method->free(hair->stepper);
    if (hair->model)
        hair->model->problem->free(hair->model);
}

static int hair_step(struct hair *hair, double h) {
    struct part *part = &hair->model->parts[0];
    const int code = any_step(hair->stepper, &hair->t, h, part->q, part->v);
    hair->model->problem->sample(hair->model, hair->rows);
    return code;
}

/* --- how far a force reaches --- */

/* How many nodes away from that of unknown k an acceleration differs by a bit. */
static int farthest(const double *a, const double *b, int size, int each, int k) {
    int most = -1;
    for (int i = 0; i < size; i++) {
        const int apart = abs(i / each - k / each);
        if (a[i] != b[i] && apart > most)
            most = apart;
    }
    return most;
}

static int measure_reach(const struct scene *scene, struct reach *reach) {
    struct model *model = scene->problem->create(scene, 0, 1);
    double rows[NODES * COLUMNS_MOST];
    *reach = (struct reach){-1, -1};
    if (!model)
        return -1;
    struct part *part = &model->parts[0];
    const int size = part->system.size, each = size / FREE;
    double *a = calloc(2 * (size_t)size, sizeof *a), *b = a ? a + size : NULL;
    int code = a ? 0 : -1;
    bend(model, rows, 0);
    code = code ? code : system_acceleration(&part->system, 0, part->q, part->v, a);
    for (int k = 0; k < 2 * size && !code; k++) {
        double *x = k < size ? &part->q[k] : &part->v[k - size];
        int *most = k < size ? &reach->position : &reach->velocity;
        const double kept = *x;
        *x += k < size ? 1e-5 : 1e-2;
        code = system_acceleration(&part->system, 0, part->q, part->v, b);
        *x = kept;
        const int here = farthest(a, b, size, each, k % size);
        *most = here > *most ? here : *most;
    }
    free(a);
    scene->problem->free(model);
    return code;
}

/* --- the count on the graph, and by bits --- */

struct count {
    const struct law *law;
    const struct stepper_method *method;
    struct reach reach;
    struct arrival by_node[FREE]; /* on the graph */
    int bits;                     /* steps until node 2 differs; -1: it does not */
    int solves;                   /* linear systems, until news is there */
    int is_adaptive;              /* its steps depend on all nodes: bits tell nothing */
};

/* Steps until the first free node of two hairs differs. */
static int count_bits(struct count *count, const struct scene *scene) {
    const double h = 0.5 / stepper_usual_rate(count->method);
    struct hair still, moved = {.model = NULL};
    int code = hair_open(&still, scene, count->method, 0);
    code = code ? code : hair_open(&moved, scene, count->method, 1e-3);
    count->bits = -1;
    for (int step = 1; !code && step <= STEPS_MOST && count->bits < 0; step++) {
        code = hair_step(&still, h) || hair_step(&moved, h);
        const size_t row = 2 * (size_t)still.model->column_count;
        if (memcmp(still.rows + row, moved.rows + row,
                   (size_t)still.model->column_count * sizeof(double)) != 0)
            count->bits = step;
    }
    hair_close(&still);
    hair_close(&moved);
    return code < 0 ? -1 : 0;
}

/* Returns 0, 1 where the method does not take it, or -1. */
static int take_count(struct count *count, const struct law *law,
                      const struct stepper_method *method, const struct scene *scene,
                      struct reach reach) {
    *count = (struct count){.law = law,
                            .method = method,
                            .reach = reach,
                            .bits = -1,
                            .is_adaptive = (method->capabilities & STEPPER_ADAPTIVE) != 0};
    const int code =
        graph_arrivals(method, FREE, reach, STEPS_MOST, count->by_node, &count->solves);
    return code || count->is_adaptive ? code : count_bits(count, scene);
}

/* A method that chooses its step, or a Krylov space, by a norm over the whole hair tells all nodes
 * of the tip by that. */
static const char *compared(const struct count *count) {
    const int graph = count->by_node[0].step, bits = count->bits;
    if (count->is_adaptive || (bits >= 0 && (graph < 0 || bits < graph)))
        return "its own choices tell all nodes at once";
    return bits == graph ? "same" : bits < 0 ? "rounded away" : "rounded away at first";
}

static double number(int x) {
    return x < 0 ? (double)NAN : x;
}

#define NEWS_COLUMNS(X)                                                                           \
    X("method", "-", "the stepper", "%s", count->method->name)                                    \
    X("law", "-", "whose forces", "%s", count->law->name)                                         \
    X("reach", "1", "how many nodes away a force feels a position", "%.17g",                      \
      number(count->reach.position))                                                              \
    X("velocity_reach", "1", "how many nodes away it feels a velocity; 0: its own only", "%.17g", \
      number(count->reach.velocity))                                                              \
    X("step", "-", "evaluates or solves: what a step does", "%s",                                 \
      count->solves > 0 ? "solves" : "evaluates")                                                 \
    X("steps", "1", "steps until node 2 hears, on the graph of couplings", "%.17g",               \
      number(root->step))                                                                         \
    X("evaluations", "1", "evaluations of forces until node 2 hears", "%.17g",                    \
      number(root->evaluations))                                                                  \
    X("nodes_per_step", "1", "nodes that a step passes the news on by", "%.17g",                  \
      (FREE - 1) / number(root->step))                                                            \
    X("bits", "1", "steps until two hairs whose tips are 1 mm apart differ at node 2", "%.17g",   \
      number(count->bits))                                                                        \
    X("compared", "-", "whether the bits agree with the graph", "%s", compared(count))

#define ARRIVAL_COLUMNS(X)                                                          \
    X("method", "-", "the stepper", "%s", count->method->name)                      \
    X("law", "-", "whose forces", "%s", count->law->name)                           \
    X("node", "1", "number of the node; 15 is the tip", "%d", i + 2)                \
    X("step", "1", "steps until it hears", "%.17g", number(count->by_node[i].step)) \
    X("evaluations", "1", "evaluations of forces until it hears", "%.17g",          \
      number(count->by_node[i].evaluations))

static void write_count(FILE *news, FILE *arrivals, const struct count *count) {
    const struct arrival *root = &count->by_node[0];
    WRITE_ROW(news, NEWS_COLUMNS);
    for (int i = 0; i < FREE; i++)
        WRITE_ROW(arrivals, ARRIVAL_COLUMNS);
}

/* --- rates by number of nodes --- */

/* Nodes that a step of the method passes news on by, where forces reach one node: on a chain that
 * is long enough for the first step not to count. */
static double nodes_per_step(const struct stepper_method *method) {
    enum { LONG = 121 };
    struct arrival arrivals[LONG];
    const struct reach reach = {1, 1};
    int solves;
    if (graph_arrivals(method, LONG, reach, 4 * LONG, arrivals, &solves) || arrivals[0].step < 0)
        return NAN;
    return (LONG - 1.) / arrivals[0].step;
}

/* The longest step up to which linear theory finds all steps stable, s. */
static double longest_stable(const struct stepper_method *method, const struct mode *mode) {
    double h = 1e-4 / mode->frequency;
    while (h < 1e4 / mode->frequency && is_stable(method, mode, 1.001 * h))
        h *= 1.001;
    return h;
}

static double wave_speed(const struct wisp *wisp) {
    return sqrt(wisp->stretch_stiffness / (wisp->hair_count * wisp->hair_density));
}

/* The explicit method whose limit is nearest to what news asks for. */
struct nearest {
    const char *method;
    double ratio;
};

/* swing with springs alone and so many nodes. */
static const struct scene *spring_hair(struct plan *plan, int nodes) {
    struct sets sets = {0};
    set_add(&sets, "material={bending=\"none\";}");
    set_add(&sets, "wisps=({root=[0.0,0.0,0.0];direction=[1.0,0.0,0.0];length=0.3;nodes=%d;})",
            nodes);
    return plan_scene(plan, yardstick_scene, sets.list, sets.count);
}

#define RATE_COLUMNS(X)                                                                            \
    X("method", "-", "the stepper", "%s", method->name)                                            \
    X("nodes", "1", "nodes of the hair", "%d", nodes[i])                                           \
    X("nodes_per_step", "1", "nodes that a step passes news on by", "%.17g", passed)               \
    X("news_rate", "Hz", "rate at which that is as fast as the stretch wave runs", "%.17g", asked) \
    X("stable_rate", "Hz", "rate from which on linear theory calls the method stable", "%.17g",    \
      stable)

static int write_rates(struct plan *plan, FILE *stream, struct nearest *nearest) {
    enum { HAIRS = 6 };
    static const int nodes[HAIRS] = {4, 6, 11, 21, 41, 81};
    const struct scene *hair[HAIRS];
    for (int i = 0; i < HAIRS; i++)
        if (!(hair[i] = spring_hair(plan, nodes[i])))
            return -1;
    for (int m = 0; stepper_methods[m]; m++) {
        const struct stepper_method *method = stepper_methods[m];
        if (method->capabilities & (STEPPER_ADAPTIVE | STEPPER_IMPLICIT) ||
            !stepper_is_predictable(method))
            continue;
        const double passed = nodes_per_step(method);
        for (int i = 0; i < HAIRS; i++) {
            const struct wisp *wisp = hair[i]->wisps;
            const struct mode mode = stiffest_mode(hair[i]);
            const double asked = wave_speed(wisp) / (passed * wisp_spacing(wisp));
            const double stable = 1 / longest_stable(method, &mode);
            WRITE_ROW(stream, RATE_COLUMNS);
            if (stable / asked < nearest->ratio)
                *nearest = (struct nearest){method->name, stable / asked};
        }
    }
    return 0;
}

/* --- sentences --- */

/* What is known of all counts. */
struct summary {
    int at_once, solving;                  /* of those that solve: in the first step */
    int same, hidden, told;                /* bits against the graph */
    int never, of_anjyo;                   /* hears, of Anjyo's */
    struct arrival euler[LAWS], rk4[LAWS]; /* at the root */
};

static void add_count(struct summary *sum, const struct count *count) {
    const int law = (int)(count->law - laws), step = count->by_node[0].step;
    const int same = count->bits == step;
    const int told = !same && count->bits >= 0 && (step < 0 || count->bits < step);
    sum->same += !count->is_adaptive && same;
    sum->told += !count->is_adaptive && told;
    sum->hidden += !count->is_adaptive && !same && !told;
    if (law == ANJYO) {
        sum->of_anjyo++;
        sum->never += step < 0;
        return;
    }
    sum->solving += count->solves > 0;
    sum->at_once += count->solves > 0 && step == 1;
    if (strcmp(count->method->name, "euler") == 0)
        sum->euler[law] = count->by_node[0];
    if (strcmp(count->method->name, "rk4") == 0)
        sum->rk4[law] = count->by_node[0];
}

static int up(int x, int by) {
    return (x + by - 1) / by;
}

/* « un changement de mouvement au bout du cheveu (dû à une collision par exemple) ne fera réagir le
 * cheveu à la racine que quinze évaluations plus tard, soit huit images plus tard »; two
 * evaluations are a frame. */
static void state_claim(struct statements *statements, const struct summary *sum) {
    const int with = sum->euler[ROSENBLUM].evaluations, without = sum->euler[NO_HINGES].evaluations;
    statements_add(
        statements,
        thesis_row("news", "news arrivals", holds_if(with == 15), with, "1", "fifteen evaluations"),
        "A change at the tip of Rosenblum's hair makes the root react “only fifteen evaluations "
        "later, that is eight frames” (section 3.1): it is %d evaluations and %d frames later, for "
        "hinges reach two particles, and explicit Euler moves one only an evaluation after it is "
        "pushed; without hinges it is %d and %d.",
        with, up(with, 2), without, up(without, 2));
}

static void state_news(struct statements *statements, const struct summary *sum,
                       const struct nearest *nearest) {
    statements_add(
        statements,
        our_row("news", "news arrivals", HOLDS, sum->euler[SPRINGS].step, "1", "explicit"),
        "News from the tip reaches the first of %d free nodes after %d steps of explicit Euler "
        "with springs alone, a node an evaluation, and after %d with skip springs, two nodes an "
        "evaluation; Runge-Kutta 4, with four evaluations a step, takes %d and %d steps.",
        FREE, sum->euler[SPRINGS].step, sum->euler[SKIP].step, sum->rk4[SPRINGS].step,
        sum->rk4[SKIP].step);
    statements_add(statements,
                   our_row("news", "news", holds_if(sum->at_once == sum->solving), sum->at_once,
                           "1", "implicit"),
                   "A step that solves a linear system for the whole hair carries news to its end, "
                   "in %d of %d pairs of such a method and a law.",
                   sum->at_once, sum->solving);
    statements_add(
        statements,
        our_row("news", "news", holds_if(sum->same > sum->hidden + sum->told), sum->same, "1",
                "bits"),
        "Two hairs whose tips are 1 mm apart first differ at the root in the step that the graph "
        "says, to the bit, in %d of %d pairs of a law and a fixed-step method; in %d rounding "
        "hides it for longer, and in %d, of methods with a norm over all nodes, they do earlier.",
        sum->same, sum->same + sum->hidden + sum->told, sum->hidden, sum->told);
    statements_add(statements,
                   thesis_row("news", "news", holds_if(sum->never == sum->of_anjyo), sum->never,
                              "1", "no way back"),
                   "In Anjyo's hair no force goes from the tip to the root (section 3.3): on its "
                   "graph no news ever does, with %d of %d methods.",
                   sum->never, sum->of_anjyo);
    statements_add(
        statements,
        our_row("news", "rates", holds_if(nearest->ratio >= 0.99), nearest->ratio, "1", "waves"),
        "No explicit method is stable at a rate at which its steps carry news more slowly than the "
        "stretch wave runs, which grows with the number of segments; the nearest, %s, needs %.3g "
        "times that rate.",
        nearest->method, nearest->ratio);
}

/* --- all --- */

enum { NEWS, ARRIVALS, RATES, TABLES };
static const struct table_form tables[TABLES] = {
    {"news",
     "steps until a change at the tip of a hair of fifteen particles (16 nodes, of which 0 and 1 "
     "rest) is at node 2. reach: how many nodes away a force feels a position, and a velocity "
     "(nan: not at all; 0: its own only); steps, evaluations: on the graph of these couplings "
     "(nan: never); nodes a step: 13 over steps; bits: steps until two real hairs whose tips are 1 "
     "mm apart differ there (nan: not in 64, or not asked, of a method that chooses its steps)",
     COLUMNS(NEWS_COLUMNS)},
    {"arrivals",
     "after how many steps and evaluations each node has heard of a change at the tip, node 15, on "
     "the graph of couplings; nan: never, or not before node 2 has",
     COLUMNS(ARRIVAL_COLUMNS)},
    {"rates",
     "swing with springs alone and so many nodes: how many nodes a step carries news, the rate at "
     "which that is as fast as the stretch wave runs (Hz), and from which on linear theory calls "
     "the method stable (Hz)",
     COLUMNS(RATE_COLUMNS)},
};

static int count_law(struct plan *plan, const struct law *law, FILE *const *streams,
                     struct summary *sum) {
    const char *const sets[] = {HAIR, law->set};
    const struct scene *scene = plan_scene(plan, law->scene, sets, law->set ? 2 : 1);
    struct reach reach;
    if (!scene)
        return -1;
    int code = measure_reach(scene, &reach);
    for (int m = 0; stepper_methods[m] && code >= 0; m++) {
        struct count count;
        code = take_count(&count, law, stepper_methods[m], scene, reach);
        if (code)
            continue;
        write_count(streams[NEWS], streams[ARRIVALS], &count);
        add_count(sum, &count);
    }
    if (code < 0)
        snprintf(plan->reason, REASON_SIZE, "out of memory");
    return code < 0 ? -1 : 0;
}

int news_tabulate(struct plan *plan) {
    FILE *streams[TABLES];
    struct summary sum = {.at_once = 0};
    struct nearest nearest = {"none", INFINITY};
    if (output_tables(&plan->output, streams, tables, TABLES, "", NULL))
        return -1;
    for (int i = 0; i < LAWS; i++)
        if (count_law(plan, &laws[i], streams, &sum))
            return -1;
    if (write_rates(plan, streams[RATES], &nearest))
        return -1;
    state_claim(&plan->output.statements, &sum);
    state_news(&plan->output.statements, &sum, &nearest);
    return 0;
}
