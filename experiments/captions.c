#include "captions.h"

#include "base/files.h"
#include "base/text_table.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

/* folder/NAME.tsv. Returns 0, or -1 with a reason. */
static int load(struct text_table *table, const char *folder, const char *name, char *reason) {
    char path[PATH_SIZE];
    if (path_format(path, "%s/%s.tsv", folder, name) == 0)
        return text_table_read(table, path, reason);
    snprintf(reason, REASON_SIZE, "the path of table %.80s is too long", name);
    return -1;
}

/* Adds to the text; what does not fit is left out. */
__attribute__((format(printf, 2, 3))) static void say(struct caption *caption, const char *format,
                                                      ...) {
    const size_t used = strlen(caption->text);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(caption->text + used, sizeof caption->text - used, format, arguments);
    va_end(arguments);
}

static void drawn_from(struct caption *caption, const char *tables) {
    snprintf(caption->tables, sizeof caption->tables, "%s", tables);
}

static int is_finished(const struct text_table *table, int row) {
    return strcmp(text_table_cell(table, row, "status"), "finished") == 0;
}

/* The row with the least (sign 1) or greatest (-1) number in a column, or -1 where there is none.
 */
static int extreme_row(const struct text_table *table, const char *column, int sign) {
    int best = -1;
    for (int i = 0; i < table->row_count; i++) {
        const double value = text_table_number(table, i, column);
        if (!isnan(value) &&
            (best < 0 || sign * value < sign * text_table_number(table, best, column)))
            best = i;
    }
    return best;
}

/* --- circle --- */

static void say_distances(struct caption *caption, const struct text_table *table, int seconds) {
    char column[32];
    snprintf(column, sizeof column, "error_%ds", seconds);
    const int near = extreme_row(table, column, 1), far = extreme_row(table, column, -1);
    if (near < 0)
        return;
    say(caption,
        "After %d s %s (%s) is nearest to where the particle should be, %.3g m away, and %s (%s) "
        "farthest, %.3g m, on a circle of radius 0.9 m.",
        seconds, text_table_cell(table, near, "method"), text_table_cell(table, near, "treatment"),
        text_table_number(table, near, column), text_table_cell(table, far, "method"),
        text_table_cell(table, far, "treatment"), text_table_number(table, far, column));
}

static void say_radii(struct caption *caption, const struct text_table *table) {
    double worst = 0;
    int within = 0, foretold = 0;
    for (int i = 0; i < table->row_count; i++) {
        const double radius = text_table_number(table, i, "radius");
        const double apart = fabs(radius / text_table_number(table, i, "predicted") - 1);
        if (isnan(apart))
            continue;
        foretold++;
        within += apart < 1e-6;
        worst = fmax(worst, apart);
    }
    say(caption,
        "In %d of %d runs the radius is that of the method's stability function to one part in a "
        "million; the largest difference is a relative %.2g.",
        within, foretold, worst);
}

static void say_slopes(struct caption *caption, const struct text_table *slopes) {
    say(caption, "Slopes of log error over log cost:");
    for (int i = 0; i < slopes->row_count; i++)
        say(caption, "%s %s %.2f", i ? "," : "", text_table_cell(slopes, i, "method"),
            text_table_number(slopes, i, "slope"));
    say(caption, ".");
}

static void say_finished(struct caption *caption, const struct text_table *points) {
    int finished = 0, not_run = 0;
    for (int i = 0; i < points->row_count; i++) {
        const char *status = text_table_cell(points, i, "status");
        finished += is_finished(points, i);
        not_run += strcmp(status, "refused") == 0 || strcmp(status, "left out") == 0;
    }
    const int best = extreme_row(points, "error", 1);
    say(caption, " %d settings finished, %d failed, %d were refused or left out", finished,
        points->row_count - finished - not_run, not_run);
    if (best >= 0)
        say(caption, "; the smallest error is %s's, %.2g m",
            text_table_cell(points, best, "method"), text_table_number(points, best, "error"));
    say(caption, ".");
}

int caption_circle(const char *folder, const char *figure, struct caption *caption, char *reason) {
    const int chart = strcmp(figure, "work-precision") == 0, radius = strcmp(figure, "radius") == 0;
    struct text_table table;
    if (load(&table, folder, chart ? "work-precision-slopes" : radius ? "radius" : "table", reason))
        return -1;
    drawn_from(caption, chart                               ? "work-precision work-precision-slopes"
                        : radius                            ? "radius radius-predicted"
                        : strcmp(figure, "orbits-30s") == 0 ? "orbits-30s table"
                                                            : "orbits-160s table");
    if (chart)
        say_slopes(caption, &table);
    else if (radius)
        say_radii(caption, &table);
    else
        say_distances(caption, &table, strcmp(figure, "orbits-30s") == 0 ? 30 : 160);
    text_table_free(&table);
    if (!chart)
        return 0;
    if (load(&table, folder, "work-precision", reason))
        return -1;
    say_finished(caption, &table);
    text_table_free(&table);
    return 0;
}

/* --- treatments --- */

int caption_treatments(const char *folder, const char *figure, struct caption *caption,
                       char *reason) {
    struct text_table table;
    if (load(&table, folder, figure, reason))
        return -1;
    drawn_from(caption, figure);
    say(caption, "Distance from the exact constrained motion, rms over all frames:");
    for (int i = 0, said = 0; i < table.row_count; i++) {
        const double rms = text_table_number(&table, i, "rms");
        if (!isnan(rms))
            say(caption, "%s %s %.3g mm", said++ ? "," : "", table.cell[i * table.column_count],
                1e3 * rms);
    }
    say(caption, ".");
    text_table_free(&table);
    return 0;
}

/* --- races --- */

static void say_target(struct caption *caption, const struct text_table *table, double target) {
    int best = -1;
    for (int i = 0; i < table->row_count; i++) {
        const double cpu = text_table_number(table, i, "cpu_median");
        if (fabs(text_table_number(table, i, "target") / target - 1) < 1e-9 && !isnan(cpu) &&
            (best < 0 || cpu < text_table_number(table, best, "cpu_median")))
            best = i;
    }
    if (best < 0)
        say(caption, " No run is within %g mm.", 1e3 * target);
    else
        say(caption, " To %g mm: %s with %s, %.3g ms.", 1e3 * target,
            text_table_cell(table, best, "method"), text_table_cell(table, best, "treatment"),
            1e3 * text_table_number(table, best, "cpu_median"));
}

int caption_race(const char *folder, const char *figure, struct caption *caption, char *reason) {
    char name[160];
    struct text_table table;
    snprintf(name, sizeof name, "%.100s-cheapest", figure);
    if (load(&table, folder, name, reason))
        return -1;
    snprintf(caption->tables, sizeof caption->tables,
             "%.45s %.45s-cheapest %.45s-slopes %.45s-reference", figure, figure, figure, figure);
    say(caption, "The least CPU time for an integration error:");
    for (double target = 1e-2; target > 5e-5; target /= 10)
        say_target(caption, &table, target);
    text_table_free(&table);
    if (load(&table, folder, figure, reason))
        return -1;
    say_finished(caption, &table);
    text_table_free(&table);
    return 0;
}

/* --- horizon --- */

static void say_horizons(struct caption *caption, const struct text_table *table) {
    say(caption, "A start that is 1e-10 m away stays within 1 mm");
    for (int i = 0; i < table->row_count; i++) {
        const double horizon = text_table_number(table, i, "horizon"),
                     duration = text_table_number(table, i, "duration");
        say(caption, "%s on %s ", i ? "," : "", text_table_cell(table, i, "scene"));
        if (isnan(horizon))
            say(caption, "for a time that is not known (%s)", text_table_cell(table, i, "status"));
        else
            say(caption, "for %.3g of %.3g s", horizon, duration);
    }
    say(caption, ".");
}

static void say_ensembles(struct caption *caption, const struct text_table *table) {
    int there = 0, alike = 0;
    for (int i = 0; i < table->row_count; i++) {
        const double shape = text_table_number(table, i, "shape");
        there += !isnan(shape);
        alike += shape <= text_table_number(table, i, "shape_yardstick");
    }
    say(caption,
        "In %d of %d pairs of scene and stepper the mean shape is as near to the reference's as "
        "halves of the reference's own ensemble are to each other.",
        alike, there);
}

int caption_horizon(const char *folder, const char *figure, struct caption *caption, char *reason) {
    const int ensembles = strcmp(figure, "ensembles") == 0;
    struct text_table table;
    if (load(&table, folder, ensembles ? "ensembles" : "horizons", reason))
        return -1;
    drawn_from(caption, ensembles ? "ensembles" : "growth horizons");
    if (ensembles)
        say_ensembles(caption, &table);
    else
        say_horizons(caption, &table);
    text_table_free(&table);
    return 0;
}

/* --- ladder --- */

/* The cheapest method of each cell, in the order of the table. */
static void say_cells(struct caption *caption, const struct text_table *table) {
    for (int i = 0, said = 0; i < table->row_count; i++) {
        const double stiffness = text_table_number(table, i, "stretch_stiffness"),
                     zeta = text_table_number(table, i, "zeta");
        int best = -1, first = 1;
        for (int k = 0; k < table->row_count; k++) {
            const double cpu = text_table_number(table, k, "cpu_median");
            if (text_table_number(table, k, "stretch_stiffness") != stiffness ||
                text_table_number(table, k, "zeta") != zeta)
                continue;
            first &= k >= i;
            if (!isnan(cpu) && strcmp(text_table_cell(table, k, "status"), "reached") == 0 &&
                (best < 0 || cpu < text_table_number(table, best, "cpu_median")))
                best = k;
        }
        if (!first)
            continue;
        say(caption, "%s at %g N and damping %g ", said++ ? ";" : "", stiffness, zeta);
        if (best < 0)
            say(caption, "none reaches it");
        else
            say(caption, "%s, %.3g ms", text_table_cell(table, best, "method"),
                1e3 * text_table_number(table, best, "cpu_median"));
    }
}

int caption_ladder(const char *folder, const char *figure, struct caption *caption, char *reason) {
    struct text_table table;
    (void)figure;
    if (load(&table, folder, "ladder", reason))
        return -1;
    drawn_from(caption, "ladder crossings");
    say(caption, "A millimetre is cheapest with:");
    say_cells(caption, &table);
    say(caption, ".");
    text_table_free(&table);
    return 0;
}

/* --- stability --- */

/* The longest stable step of each method, and how the next one fails. */
static void say_longest_steps(struct caption *caption, const struct text_table *table) {
    say(caption, "The longest stable step:");
    for (int i = 0; i < table->row_count; i++) {
        const double step = text_table_number(table, i, "step");
        say(caption, "%s %s (%s, %s) ", i ? ";" : "", text_table_cell(table, i, "stepper"),
            text_table_cell(table, i, "scene"), text_table_cell(table, i, "treatment"));
        if (isnan(step))
            say(caption, "none that was tried");
        else
            say(caption, "%.3g ms, beyond it %s", 1e3 * step, text_table_cell(table, i, "kind"));
    }
    say(caption, ".");
}

/* How far what was measured is from theory, where there is one. */
static void say_agreement(struct caption *caption, const struct text_table *table,
                          const char *measured, const char *theory) {
    double worst = 0;
    int count = 0;
    for (int i = 0; i < table->row_count; i++) {
        const double a = text_table_number(table, i, measured),
                     b = text_table_number(table, i, theory);
        if (isnan(a) || isnan(b))
            continue;
        worst = fmax(worst, fabs(a - b) / fmax(1, fabs(b)));
        count++;
    }
    say(caption,
        "Measured by stepping the real code; where there is a stability function, at %d points, "
        "the two differ by %.2g at most.",
        count, worst);
}

int caption_stability(const char *folder, const char *figure, struct caption *caption,
                      char *reason) {
    const int limits = strcmp(figure, "limits") == 0, damping = strcmp(figure, "damping") == 0;
    struct text_table table;
    if (load(&table, folder, limits ? "largest-step" : figure, reason))
        return -1;
    drawn_from(caption, limits ? "limits largest-step failures" : figure);
    if (limits)
        say_longest_steps(caption, &table);
    else
        say_agreement(caption, &table, damping ? "damping" : "growth",
                      damping ? "damping_theory" : "theory");
    text_table_free(&table);
    return 0;
}

/* --- needs --- */

int caption_needs(const char *folder, const char *figure, struct caption *caption, char *reason) {
    struct text_table table;
    if (load(&table, folder, "smallest", reason))
        return -1;
    drawn_from(caption, "needs smallest");
    for (int i = 0; i < table.row_count; i++) {
        if (strcmp(text_table_cell(&table, i, "scene"), figure) != 0)
            continue;
        const double ratio = text_table_number(&table, i, "cost_ratio");
        if (isnan(ratio))
            say(caption, "There is no smaller model: %s.", text_table_cell(&table, i, "note"));
        else
            say(caption,
                "The smallest model within a millimetre of the full one is %.2g mm away (rms) and "
                "takes %.2g of its time; the scene as it is, %.2g mm and %.2g.",
                1e3 * text_table_number(&table, i, "change_rms"), ratio,
                1e3 * text_table_number(&table, i, "own_change_rms"),
                text_table_number(&table, i, "own_cost_ratio"));
    }
    text_table_free(&table);
    return 0;
}

/* --- hair: chapter 5 --- */

/* What --quick makes of the statements, in the table's own words. */
static void say_cut(struct caption *caption, const struct text_table *table) {
    static const char mark[] = "--quick: ";
    const char *cut = strstr(table->about, mark);
    if (cut)
        say(caption, "With --quick only %s. ", cut + strlen(mark));
}

/* What the experiment itself found of the thesis's statements. */
static void say_statements(struct caption *caption, const struct text_table *table) {
    int holds = 0, fails = 0;
    for (int i = 0; i < table->row_count; i++) {
        holds += strcmp(text_table_cell(table, i, "verdict"), "holds") == 0;
        fails += strcmp(text_table_cell(table, i, "verdict"), "does not hold") == 0;
    }
    say_cut(caption, table);
    say(caption, "Of the thesis's statements %d hold here and %d do not", holds, fails);
    for (int i = 0, said = 0; i < table->row_count; i++)
        if (strcmp(text_table_cell(table, i, "verdict"), "does not hold") == 0)
            say(caption, "%s %s", said++ ? ";" : ":", text_table_cell(table, i, "statement"));
    say(caption, ".");
}

static void say_costs(struct caption *caption, const struct text_table *table) {
    for (int i = 0; i < table->row_count; i++) {
        const double cost = text_table_number(table, i, "cpu_per_frame");
        const char *comparison = text_table_cell(table, i, "comparison");
        say(caption, "%s%s: ", i ? "; " : "", text_table_cell(table, i, "variant"));
        if (isnan(cost) || !is_finished(table, i))
            say(caption, "%s", text_table_cell(table, i, "status"));
        else
            say(caption, "%.3g ms per frame (%s)", 1e3 * cost, comparison);
    }
    say(caption, ".");
}

static void say_measured(struct caption *caption, const struct text_table *table) {
    say_cut(caption, table);
    for (int i = 0; i < table->row_count; i++)
        say(caption, "%s%s", i ? "; " : "", text_table_cell(table, i, "statement"));
    say(caption, ".");
}

int caption_hair(const char *folder, const char *figure, struct caption *caption, char *reason) {
    const int cost = strcmp(figure, "cost") == 0, series = strcmp(figure, "series") == 0;
    struct text_table table;
    if (!cost && !series && strcmp(figure, "frames") != 0 && strcmp(figure, "hair") != 0)
        return 0;
    if (load(&table, folder, cost ? "table" : "statements", reason))
        return -1;
    drawn_from(caption, cost     ? "table steppers"
                        : series ? "series statements"
                                 : "strip-cells strip");
    if (cost)
        say_costs(caption, &table);
    else if (series)
        say_measured(caption, &table);
    else
        say_statements(caption, &table);
    text_table_free(&table);
    return 0;
}

/* --- kernel --- */

static void say_range(struct caption *caption, const struct text_table *table, const char *what,
                      const char *column, const char *unit) {
    const int least = extreme_row(table, column, 1), most = extreme_row(table, column, -1);
    if (least >= 0)
        say(caption, "%s: %.3g to %.3g%s.", what, text_table_number(table, least, column),
            text_table_number(table, most, column), unit);
}

int caption_kernel(const char *folder, const char *figure, struct caption *caption, char *reason) {
    struct text_table table;
    if (load(&table, folder, figure, reason))
        return -1;
    drawn_from(caption, figure);
    if (strcmp(figure, "evaluation") == 0) {
        say_range(caption, &table, "A free node's evaluation in four lanes takes", "kernel4",
                  " ns");
        say_range(caption, &table, " A plain program takes so many times as long",
                  "twin_over_kernel4", "");
    } else if (strcmp(figure, "operations") == 0) {
        say_range(caption, &table, "Additions and products of a node, as the model needs them",
                  "additions", "");
        say_range(caption, &table, " As four lanes execute them", "additions4", "");
    } else if (strcmp(figure, "solvers") == 0) {
        say_range(caption, &table, "Factorising takes, in evaluations of the wisp's skeleton",
                  "factor_evaluations", "");
        say_range(caption, &table, " Solving", "solve_evaluations", "");
    }
    text_table_free(&table);
    return 0;
}
