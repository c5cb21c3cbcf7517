/* tests/accuracy.tsv: what every stepper achieved when the table was last updated. */
#include "build_info.h"
#include "support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char header[] =
    "# Errors and costs of every stepper on the circle to 160 s, a frame every 20 s. setting: "
    "step,\n"
    "# s, or rtol = atol; error: distance from the exact position at 160 s, m; max_error: in all\n"
    "# frames; x, y: the last position, m. Methods of fixed steps must give x and y again to "
    "1e-13\n"
    "# and the counts exactly; of others, whose steps change with the processor's instructions, "
    "the\n"
    "# errors must stay within a factor 2 and the counts within 10 %. What is better than that "
    "fails\n"
    "# too: look why, and update the table by\n"
    "#   cmake --build build --target update-accuracy\n";

enum { KEY_SIZE = 160, ROWS_MAX = 512 };

struct row {
    char key[KEY_SIZE]; /* scene, treatment, stepper, option, setting, parted by tabs */
    char status[32];
    long long steps, evaluations;
    double error, max_error, x, y;
    int exact; /* of fixed steps */
};

struct rows {
    int count;
    struct row row[ROWS_MAX];
    const char *treatment;
    const struct scene *scene;
};

static void measure(const struct variant *variant, void *ctx) {
    struct rows *rows = ctx;
    const int adaptive = (variant->method->capabilities & STEPPER_ADAPTIVE) != 0;
    static const double steps[] = {0.8, 0.05}, tolerances[] = {1e-4, 1e-7};
    for (int i = 0; i < 2; i++) {
        const double setting = adaptive ? tolerances[i] : steps[i];
        const struct run_request request = {.stepper = variant->method->name,
                                            .treatment = rows->treatment,
                                            .step = adaptive ? 0 : setting,
                                            .rtol = adaptive ? setting : 0,
                                            .atol = adaptive ? setting : 0,
                                            .options = &variant->option,
                                            .option_count = variant->option != NULL};
        struct settings settings;
        struct orbit orbit;
        char reason[REASON_SIZE];
        if (settings_resolve(rows->scene, &request, &settings, reason))
            return; /* not supported */
        run_circle(rows->scene, &request, &orbit);
        cr_assert(rows->count < ROWS_MAX, "too many rows");
        struct row *row = &rows->row[rows->count++];
        snprintf(row->key, sizeof row->key, "%s\t%s\t%s\t%s\t%g", rows->scene->name,
                 rows->treatment, variant->method->name, variant->option ? variant->option : "-",
                 setting);
        snprintf(row->status, sizeof row->status, "%s", outcome_name(orbit.result.outcome));
        row->exact = !adaptive;
        row->steps = orbit.result.counters.steps;
        row->evaluations = orbit.result.counters.force_evaluations;
        row->error = orbit.error;
        row->max_error = orbit.max_error;
        row->x = orbit.x;
        row->y = orbit.y;
    }
}

static void measure_all(struct rows *rows) {
    struct scene *scene = circle_scene(160, 0.05);
    *rows = (struct rows){.scene = scene};
    for (int i = 0; scene->problem->treatments[i].name; i++) {
        rows->treatment = scene->problem->treatments[i].name;
        each_variant(measure, rows);
    }
    scene_free(scene);
}

static void write_table(const struct rows *rows, const char *path) {
    FILE *file = fopen(path, "w");
    cr_assert(file, "%s cannot be written", path);
    fprintf(file,
            "%sscene\ttreatment\tstepper\toption\tsetting\tstatus\tsteps\tforce_evaluations\terror"
            "\tmax_error\tx\ty\n",
            header);
    for (int i = 0; i < rows->count; i++) {
        const struct row *r = &rows->row[i];
        fprintf(file, "%s\t%s\t%lld\t%lld\t%.6e\t%.6e\t%.17g\t%.17g\n", r->key, r->status, r->steps,
                r->evaluations, r->error, r->max_error, r->x, r->y);
    }
    fclose(file);
}

static void read_table(struct rows *rows, const char *path) {
    char *text = file_read(path);
    cr_assert(text, "%s is not there", path);
    rows->count = 0;
    for (char *rest = text, *line; (line = strsep(&rest, "\n")) != NULL;) {
        struct row *r = &rows->row[rows->count];
        char *tab = line;
        if (line[0] == '#' || line[0] == '\0' || strncmp(line, "scene\t", 6) == 0)
            continue;
        for (int i = 0; i < 5 && tab; i++)
            tab = strchr(tab + 1, '\t');
        cr_assert(tab && rows->count < ROWS_MAX &&
                      sscanf(tab, "\t%31[^\t]\t%lld\t%lld\t%lf\t%lf\t%lf\t%lf", r->status,
                             &r->steps, &r->evaluations, &r->error, &r->max_error, &r->x,
                             &r->y) == 7,
                  "%s: cannot read '%s'", path, line);
        snprintf(r->key, sizeof r->key, "%.*s", (int)(tab - line), line);
        rows->count++;
    }
    free(text);
}

/* Errors near rounding are noise, which a factor 2 does not describe: 1e-12 is a hundred roundings
 * of each of 160 s. */
static int within_factor_2(double now, double then) {
    return now <= 2 * then + 1e-12 && now >= then / 2 - 1e-12;
}

static int within_tenth(long long now, long long then) {
    return llabs(now - then) * 10 <= then + 10;
}

static void compare(const struct row *now, const struct row *then) {
    const char *verdict = now->error > then->error ? "worse" : "better";
    cr_assert_str_eq(now->status, then->status, "%s: %s, and was %s", now->key, now->status,
                     then->status);
    if (now->exact) {
        cr_assert(now->steps == then->steps && now->evaluations == then->evaluations,
                  "%s: %lld steps and %lld evaluations, and were %lld and %lld", now->key,
                  now->steps, now->evaluations, then->steps, then->evaluations);
        cr_assert(fabs(now->x - then->x) <= 1e-13 * fmax(1, fabs(then->x)) &&
                      fabs(now->y - then->y) <= 1e-13 * fmax(1, fabs(then->y)),
                  "%s: ends at (%.17g, %.17g), and did at (%.17g, %.17g): %s", now->key, now->x,
                  now->y, then->x, then->y, verdict);
        return;
    }
    cr_assert(within_tenth(now->steps, then->steps) &&
                  within_tenth(now->evaluations, then->evaluations),
              "%s: %lld steps and %lld evaluations, and were %lld and %lld", now->key, now->steps,
              now->evaluations, then->steps, then->evaluations);
    cr_assert(within_factor_2(now->error, then->error) &&
                  within_factor_2(now->max_error, then->max_error),
              "%s: errors %.2e and %.2e, and were %.2e and %.2e: %s; if that is meant, "
              "cmake --build build --target update-accuracy",
              now->key, now->error, now->max_error, then->error, then->max_error, verdict);
}

Test(accuracy, is_what_the_table_says) {
    static struct rows now, then;
    const char *path = WISPLAB_TESTS_DIR "/accuracy.tsv";
    measure_all(&now);
    if (getenv("WISPLAB_UPDATE_ACCURACY")) {
        write_table(&now, path);
        return;
    }
    read_table(&then, path);
    for (int i = 0; i < now.count; i++) {
        int k = 0;
        while (k < then.count && strcmp(then.row[k].key, now.row[i].key) != 0)
            k++;
        cr_assert(k < then.count,
                  "the table lacks %s; cmake --build build --target update-accuracy",
                  now.row[i].key);
        compare(&now.row[i], &then.row[k]);
    }
    cr_assert_eq(now.count, then.count,
                 "%d rows of the table are of nothing; cmake --build build --target "
                 "update-accuracy",
                 then.count - now.count);
}
