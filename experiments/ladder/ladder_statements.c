/* What the ladder answers: who is cheapest where, which kind of method, and whose price does not
 * depend on stiffness. */
#include "ladder.h"

#include <math.h>
#include <string.h>

enum { ALL, EXPLICIT, IMPLICIT };
static int is_of(const struct search *s, int kind) {
    const struct stepper_method *method = s->configuration->method;
    return kind == ALL || ((method->capabilities & STEPPER_IMPLICIT) != 0) == (kind == IMPLICIT);
}

static int was_asked(const struct ladder *ladder, int kind) {
    for (int i = 0; i < ladder->count; i++)
        if (is_of(&ladder->search[i], kind))
            return 1;
    return 0;
}

/* The cheapest search of a cell, of all, of explicit methods or of implicit ones, besides one; or
 * NULL. */
static const struct search *cheapest(const struct ladder *ladder, int cell, int kind,
                                     const struct search *besides) {
    const struct search *best = NULL;
    for (int i = 0; i < ladder->count; i++) {
        const struct search *s = &ladder->search[i];
        if (s->cell == cell && is_of(s, kind) && s != besides && ladder_has_cost(s) &&
            (!best || s->cost.counted < best->cost.counted))
            best = s;
    }
    return best;
}

static double least_cost(const struct ladder *ladder, int cell, int kind) {
    const struct search *s = cheapest(ladder, cell, kind, NULL);
    return s ? s->cost.counted : NAN;
}

/* --- one cell --- */

/* The methods of a cell that are not known to be more expensive than the cheapest. */
static void list_tied(const struct ladder *ladder, const struct search *best, char text[512]) {
    struct rival rivals[RIVALS_MOST];
    int count = 0;
    for (int i = 0; i < ladder->count && count < RIVALS_MOST; i++) {
        const struct search *s = &ladder->search[i];
        if (s != best && s->cell == best->cell && ladder_has_cost(s) && !ladder_is_apart(best, s))
            rivals[count++] =
                (struct rival){s->configuration->name, s->cost.counted, s->cost.cpu.median};
    }
    list_rivals(text, rivals, count);
}

/* "At EA = 90 N, for such hair," */
static void name_place(char text[160], const struct cell *cell) {
    if (cell->hair->rigid)
        snprintf(text, 160, "For %s,", cell->hair->phrase);
    else
        snprintf(text, 160, "At EA = %g N, for %s,", cell->stiffness, cell->hair->phrase);
}

/* The cheapest method of a cell, with those that it is tied with, or the next. */
static void state_cell(struct statements *statements, const struct plan *plan, int at) {
    const struct ladder *ladder = plan->memo;
    const struct cell *cell = &ladder->cell[at];
    const struct search *best = cheapest(ladder, at, ALL, NULL);
    const struct search *next = best ? cheapest(ladder, at, ALL, best) : NULL;
    char place[160], tied[512] = "", runner_up[128] = "";
    name_place(place, cell);
    const struct statement row =
        our_row(cell->hair->figure, "ladder", best ? HOLDS : NOT_REACHED,
                best ? 1e3 * best->cost.cpu.median : NAN, "ms", "%s", plan->subjects[at].name);
    if (best)
        list_tied(ladder, best, tied);
    if (next)
        snprintf(runner_up, sizeof runner_up, "; %s is next with %.3g ms",
                 next->configuration->name, 1e3 * next->cost.cpu.median);
    if (tied[0])
        statements_add(statements, row,
                       "%s a millimetre is cheapest with %s (%.3g ms)%s, too close to tell apart.",
                       place, best->configuration->name, row.value, tied);
    else if (best)
        statements_add(statements, row,
                       "%s a millimetre is cheapest with %s, %.3g ms of CPU time at %s %.3g%s%s.",
                       place, best->configuration->name, row.value,
                       configuration_is_adaptive(best->configuration) ? "rtol" : "h =",
                       ladder_setting(plan, best, best->place.reached),
                       configuration_is_adaptive(best->configuration) ? "" : " s", runner_up);
    else
        statements_add(statements, row, "%s no method reaches a millimetre.", place);
}

/* --- one kind of hair --- */

/* Counts of the cells of a kind in which explicit methods are ahead, implicit ones, and neither. */
struct order {
    int explicit_first, implicit_first, tied;
};

static struct order order_of(const struct ladder *ladder, int first, int count) {
    struct order order = {0, 0, 0};
    for (int cell = first; cell < first + count; cell++) {
        const struct search *one = cheapest(ladder, cell, EXPLICIT, NULL),
                            *other = cheapest(ladder, cell, IMPLICIT, NULL);
        if (!one || !other)
            continue;
        order.explicit_first += cost_is_less(&one->cost, &other->cost);
        order.implicit_first += cost_is_less(&other->cost, &one->cost);
        order.tied += !ladder_is_apart(one, other);
    }
    return order;
}

static void state_crossings(struct statements *statements, const struct ladder *ladder, int first,
                            int count) {
    const struct hair *hair = ladder->cell[first].hair;
    for (int k = 0; k + 1 < count; k++) {
        const struct cell *cell = &ladder->cell[first + k];
        const double stiffness[2] = {cell->stiffness, cell[1].stiffness},
                     explicits[2] = {least_cost(ladder, first + k, EXPLICIT),
                                     least_cost(ladder, first + k + 1, EXPLICIT)},
                     implicits[2] = {least_cost(ladder, first + k, IMPLICIT),
                                     least_cost(ladder, first + k + 1, IMPLICIT)},
                     at = ladder_crossing(stiffness, explicits, implicits);
        const struct statement row = our_row(hair->figure, "ladder crossings", HOLDS, at, "N",
                                             "order, %s, %d", hair->name, k);
        if (!isnan(at))
            statements_add(statements, row,
                           "For %s the best explicit and the best implicit method cost the same at "
                           "EA = %.2g N.",
                           hair->phrase, at);
    }
}

/* Where the cheapest explicit and the cheapest implicit method change places: one crossing, or none
 * because one kind is ahead everywhere. */
static void state_order(struct statements *statements, const struct ladder *ladder, int first,
                        int count) {
    const struct hair *hair = ladder->cell[first].hair;
    const struct order order = order_of(ladder, first, count);
    state_crossings(statements, ladder, first, count);
    if (order.explicit_first > 0 && order.implicit_first > 0)
        return;
    const int one_kind = order.explicit_first + order.implicit_first;
    const struct statement row =
        our_row(hair->figure, "ladder crossings",
                one_kind + order.tied > 0                                    ? HOLDS
                : was_asked(ladder, EXPLICIT) && was_asked(ladder, IMPLICIT) ? NOT_REACHED
                                                                             : NOT_ASKED,
                NAN, NULL, "order, %s", hair->name);
    if (row.verdict == HOLDS && one_kind == 0)
        statements_add(statements, row,
                       "For %s explicit and implicit methods are tied at every stiffness tried.",
                       hair->phrase);
    else if (row.verdict == HOLDS)
        statements_add(statements, row,
                       "For %s a millimetre is cheaper with %s methods at every stiffness tried%s.",
                       hair->phrase, order.explicit_first ? "explicit" : "implicit",
                       order.tied ? " at which the two are not tied" : "");
    else
        statements_add(statements, row,
                       "For %s explicit and implicit methods cannot be compared, for %s.",
                       hair->phrase,
                       row.verdict == NOT_ASKED ? "one kind was left out"
                                                : "at no stiffness both reach a millimetre");
}

/* What a configuration's costs are between, s, where it reaches the target in every cell of a kind.
 */
struct range {
    const struct configuration *configuration; /* NULL: nobody does */
    double least, most;
};

static struct range range_of(const struct ladder *ladder, int first, int count,
                             const struct configuration *configuration) {
    struct range range = {configuration, INFINITY, 0};
    for (int cell = first; cell < first + count; cell++) {
        const struct search *s = ladder_search(ladder, cell, configuration);
        if (!ladder_has_cost(s))
            return (struct range){NULL, NAN, NAN};
        range.least = fmin(range.least, s->cost.counted);
        range.most = fmax(range.most, s->cost.counted);
    }
    return range;
}

/* The configuration of which the most that a millimetre can cost is least. */
static struct range best_range(const struct plan *plan, int first, int count) {
    struct range best = {NULL, NAN, NAN};
    for (int c = 0; c < plan->configuration_count; c++) {
        const struct range range = range_of(plan->memo, first, count, &plan->configurations[c]);
        if (range.configuration && (!best.configuration || range.most < best.most))
            best = range;
    }
    return best;
}

/* Whether a price does not depend on stiffness, by what is counted. The control is explicit Euler:
 * if its price grew no more, then nothing here would be stiff. */
static void state_price(struct statements *statements, const struct plan *plan, int first,
                        int count) {
    const double flat = 1.5;
    const struct ladder *ladder = plan->memo;
    const struct cell *soft = &ladder->cell[first], *stiff = &ladder->cell[first + count - 1];
    const struct range best = best_range(plan, first, count);
    char euler[160] = "", place[160] = "F";
    if (count < 2)
        return;
    if (first > 0) /* the first kind is hair as the scene has it */
        snprintf(place, sizeof place, "For %s, f", soft->hair->phrase);
    double grown = NAN;
    for (int c = 0; c < plan->configuration_count; c++)
        if (strcmp(plan->configurations[c].name, "euler") == 0) {
            const struct range range = range_of(ladder, first, count, &plan->configurations[c]);
            grown = range.configuration ? range.most / range.least : INFINITY;
            if (range.configuration)
                snprintf(euler, sizeof euler, ", and explicit Euler up to %.2g times as much",
                         grown);
            else
                snprintf(euler, sizeof euler, ", and explicit Euler does not always reach it");
        }
    const double times = best.most / best.least;
    const struct statement row = our_row(soft->hair->figure, "ladder",
                                         !best.configuration ? NOT_REACHED
                                         : !(times < flat)   ? HOLDS_NOT
                                         : grown < flat      ? TELLS_NOTHING
                                                             : HOLDS,
                                         times, "1", "price, %s", soft->hair->name);
    if (!best.configuration)
        statements_add(statements, row,
                       "For %s no method reaches a millimetre at every stiffness from %g to %g N.",
                       soft->hair->phrase, soft->stiffness, stiff->stiffness);
    else
        statements_add(statements, row,
                       "%srom EA = %g to %g N a millimetre costs %s %s%.2g times its least%s.",
                       place, soft->stiffness, stiff->stiffness, best.configuration->name,
                       times < flat ? "about the same, at most " : "up to ", times, euler);
}

/* How far rigid segments are from the stiffest hair, of the cell before, by their reference
 * solutions.
 */
static int state_rigid(struct statements *statements, struct plan *plan, int at) {
    const struct ladder *ladder = plan->memo;
    struct verdict verdict = {NAN, FINISHED, NAN};
    struct run_files stiffest;
    if (plan_read(plan, &plan->cases[at - 1], &stiffest))
        return -1;
    const int code = stiffest.outcome == FINISHED
                         ? judge_runs(plan, at, 1, plan->subjects[at].scene, &stiffest, &verdict)
                         : 0;
    run_free(&stiffest);
    const double apart = verdict.error;
    const struct statement row =
        our_row("ladder", "ladder", isnan(apart) ? NOT_REACHED : holds_if(apart <= LADDER_TARGET),
                1e3 * apart, "mm", "rigid segments, as a model");
    if (isnan(apart))
        statements_add(
            statements, row,
            "What rigid segments make of hair is not known: a reference solution failed.");
    else
        statements_add(statements, row,
                       "Hair of rigid segments stays within %.2g mm (rms) of hair of EA = %g N.",
                       row.value, ladder->cell[at - 1].stiffness);
    return code;
}

int ladder_state(struct statements *statements, struct plan *plan) {
    const struct ladder *ladder = plan->memo;
    for (int first = 0, count; first < ladder->cell_count; first += count) {
        for (count = 1;
             first + count < ladder->cell_count && ladder_goes_on(ladder, first + count);)
            count++;
        if (!ladder->cell[first].hair->rigid) {
            state_price(statements, plan, first, count);
            state_order(statements, ladder, first, count);
        } else if (first > 0 && state_rigid(statements, plan, first)) {
            return -1;
        }
        for (int cell = first; cell < first + count; cell++)
            state_cell(statements, plan, cell);
    }
    if (plan->quick)
        statements_add(
            statements, our_row("ladder", NULL, NOT_REACHED, NAN, NULL, "left out"),
            "Real hair (16800 N), hair of 41 nodes, the dampings 0.02, 0.1 and 0.5, converged "
            "Newton iterations and conjugate gradients are left out of --quick.");
    return 0;
}
