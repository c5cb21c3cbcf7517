/* Scenes that start from a saved state: to the bit where nothing is converted, to rounding where
 * samples change from distances to particles, and one line where the state is of something else. */
#include "base/hash.h"
#include "base/table.h"
#include "model/problems.h"
#include "run/identity.h"
#include "run/results.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static char *folder;
static const char *scene_path, *state_path;

/* Hair of unlike lengths on a head that is turned, falling over itself. */
static const char scene_text[] =
    "duration = 0.1; frame_rate = 30.0; gravity = [0.0, -9.81, 0.0]; material = { };\n"
    "envelope = { }; contacts = { };\n"
    "body = ( { name = \"head\"; center = [0.0, 0.0, 0.0]; radii = [0.075, 0.115, 0.095];\n"
    "           friction = 50.0; elasticity = 0.1; offset = 1.0e-4; } );\n"
    "wisps = ( { scalp = \"head\"; count = 3; length = 0.30; nodes = 7; },\n"
    "          { root = [0.0, -0.2, 0.0]; direction = [1.0, 0.2, 0.1]; length = 0.2; nodes = 5; "
    "},\n"
    "          { scalp = \"head\"; count = 2; length = 0.30; nodes = 7; crown = [1, 0, 0]; } );\n"
    "head = { times = [0.0]; positions = ([0.1, 0.2, 0.3]); rotations = ([0.5, -0.4, 0.8]); };\n";

static void open_folder(void) {
    folder = folder_make();
    scene_path = file_write(folder, "hair.cfg", scene_text);
    state_path = printed("%s/state.tsv", folder);
}

static void save_state(const char *treatment) {
    WORKS("run", scene_path, "--treatment", treatment, "--out", folder, "--save", state_path,
          "--no-progress");
}

/* What a model of a treatment starts with. */
struct rows {
    struct scene *scene;
    struct model *model;
    double *row;
    int count, columns;
};

static void start_of(enum wisp_treatment treatment, int lanes, struct rows *rows) {
    rows->scene = LAB_LOAD(scene_path, "start=state.tsv");
    rows->model = lab_model(rows->scene, (int)treatment, lanes);
    rows->count = rows->model->row_count;
    rows->columns = rows->model->column_count;
    rows->row = test_room((size_t)(rows->count * rows->columns) * sizeof *rows->row);
    wisp_problem.sample(rows->model, rows->row);
}

/* The last frame of the file, as numbers. */
static void read_rows(struct table *table) {
    char reason[REASON_SIZE];
    cr_assert_eq(table_read(table, state_path, reason), 0, "%s", reason);
}

/* The start as a file of its own. */
static void write_rows(const struct rows *rows) {
    FILE *file = fopen(state_path, "w");
    cr_assert(file);
    fprintf(file, "t");
    for (int j = 0; j < rows->columns; j++)
        fprintf(file, "\t%s", rows->model->columns[j]);
    for (int i = 0; i < rows->count; i++)
        for (int j = -1; j < rows->columns; j++)
            fprintf(file, "%c%.17g", j < 0 ? '\n' : '\t',
                    j < 0 ? 0 : rows->row[i * rows->columns + j]);
    fputc('\n', file);
    fclose(file);
}

/* A particle's distance from its node along the line between them, and its rate. */
static void distance_of(const double *row, int sample, double *r, double *rate) {
    const double *e = row + 8 + 6 * sample;
    *r = *rate = 0;
    for (int k = 0; k < 3; k++)
        *r += (e[k] - row[2 + k]) * (e[k] - row[2 + k]);
    *r = sqrt(*r);
    for (int k = 0; k < 3; k++)
        *rate += (e[3 + k] - row[5 + k]) * (e[k] - row[2 + k]) / *r;
}

/* Distances along the half-lines that wisps have on the turned head. */
static void check_on_lines(const struct rows *rows, const struct table *saved) {
    struct placement head;
    head_placement(&rows->scene->around.head, 0, &head);
    for (int w = 0, first = 0; w < rows->scene->wisp_count; w++) {
        const struct wisp *wisp = &rows->scene->wisps[w];
        struct strand *s = lab_strand(wisp, WISP_PENALTY);
        strand_turn(s, &head);
        strand_load(s, rows->row + first * rows->columns + 2, rows->columns);
        for (int at = 8; at < 4 * wisp->nodes; at++) {
            const double r = table_value(saved, first + at / 4, 9 + 2 * (at % 4));
            cr_assert(fabs(s->r[at] - r) <= 1e-15, "wisp %d, sample %d: %g, not %g", w, at,
                      s->r[at], r);
        }
        first += wisp->nodes;
    }
}

/* What a run has left is what the next one starts with, to the bit; the free nodes, that is, in
 * parts of any size. */
Test(start, the_same_columns_give_the_same_bits, .init = open_folder) {
    static const int pairs[][2] = {{WISP_PROJECTION, WISP_PROJECTION},
                                   {WISP_PROJECTION, WISP_GENERALISED},
                                   {WISP_GENERALISED, WISP_PROJECTION},
                                   {WISP_GENERALISED, WISP_GENERALISED},
                                   {WISP_PENALTY, WISP_PENALTY}};
    for (size_t p = 0; p < sizeof pairs / sizeof *pairs; p++)
        for (int lanes = 1; lanes <= LAB_LANES; lanes = lab_wider(lanes)) {
            struct rows rows;
            struct table saved;
            save_state(treatment_names[pairs[p][0]]);
            read_rows(&saved);
            start_of((enum wisp_treatment)pairs[p][1], lanes, &rows);
            cr_assert_eq(saved.row_count, rows.count, "%d rows, not one frame", saved.row_count);
            double moved = 0;
            for (int i = 0; i < rows.count; i++)
                for (int j = 0; j < rows.columns; j++) {
                    const double x = rows.row[i * rows.columns + j];
                    cr_assert_eq(table_value(&saved, i, j + 1), x, "%s to %s: row %d, column %d",
                                 treatment_names[pairs[p][0]], treatment_names[pairs[p][1]], i, j);
                    moved = j == 6 ? fmax(moved, fabs(x)) : moved;
                }
            cr_assert_gt(moved, 0.1, "nothing moves: no state worth saving");
            table_free(&saved);
        }
}

/* Distances become particles that far away, which become the same distances. */
Test(start, distances_and_particles_are_converted, .init = open_folder) {
    for (int treatment = WISP_PROJECTION; treatment <= WISP_GENERALISED; treatment += 2) {
        struct rows particles, back;
        struct table saved;
        save_state(treatment_names[treatment]);
        read_rows(&saved);
        start_of(WISP_PENALTY, 4, &particles);
        check_on_lines(&particles, &saved);
        write_rows(&particles);
        start_of((enum wisp_treatment)treatment, 4, &back);
        for (int i = 0; i < back.count; i++) {
            const double *e = particles.row + i * particles.columns,
                         *d = back.row + i * back.columns;
            for (int k = 0; k < 8; k++)
                cr_assert(e[k] == d[k] && d[k] == table_value(&saved, i, k + 1), "a node differs");
            for (int j = 0; j < 4; j++) {
                const double r0 = table_value(&saved, i, 9 + 2 * j),
                             rate0 = table_value(&saved, i, 10 + 2 * j);
                double r, rate;
                distance_of(e, j, &r, &rate);
                cr_assert(fabs(r - r0) <= 1e-15 && (d[1] < 2 || fabs(rate - rate0) <= 1e-13),
                          "row %d, sample %d: r %.17g, not %.17g; rate %g, not %g", i, j, r, r0,
                          rate, rate0);
                cr_assert(fabs(d[8 + 2 * j] - r0) <= 1e-15 &&
                              (d[1] < 2 || fabs(d[9 + 2 * j] - rate0) <= 1e-13),
                          "row %d, sample %d: back at %.17g, not %.17g", i, j, d[8 + 2 * j], r0);
            }
        }
        table_free(&saved);
    }
}

/* Nothing but the clock's times differs: ticks and frames of the second piece fall on those of the
 * whole. */
Test(start, a_run_in_two_pieces_is_the_run, .init = open_folder) {
    for (int treatment = 0; treatment < TREATMENTS; treatment++) {
        const struct run_request request = {.stepper = "rk4",
                                            .treatment = treatment_names[treatment]};
        struct scene *scene = LAB_LOAD(scene_path, "duration=0.2");
        struct lab_run whole, piece;
        double worst = 0;
        lab_run(scene, &request, &whole);
        save_state(treatment_names[treatment]);
        scene = LAB_LOAD(scene_path, "start=state.tsv");
        lab_run(scene, &request, &piece);
        cr_assert(whole.frames == 7 && piece.frames == 4);
        for (int i = 0; i < 4 * piece.rows * piece.columns; i++)
            worst = fmax(worst, fabs(piece.row[i] - whole.row[i + 3 * piece.rows * piece.columns]));
        cr_assert_leq(worst, 1e-10, "%s: %g", treatment_names[treatment], worst);
    }
}

/* --- what identifies it --- */

static void hash_of(const char *path, char hash[HASH_SIZE]) {
    struct scene *scene = LAB_LOAD(path, "start=state.tsv");
    scene_hash(scene, hash);
}

Test(start, the_content_is_in_the_hash, .init = open_folder) {
    char hash[4][HASH_SIZE];
    struct scene *without = lab_load(scene_path, NULL, 0);
    scene_hash(without, hash[0]);
    save_state("generalised");
    hash_of(scene_path, hash[1]);
    const char *const elsewhere = folder_make();
    char *text = file_read(state_path);
    const char *const other = file_write(elsewhere, "hair.cfg", scene_text);
    file_write(elsewhere, "state.tsv", text);
    hash_of(other, hash[2]);
    char *digit = strrchr(text, '.') + 1; /* of the last number */
    *digit = *digit == '3' ? '4' : '3';
    file_write(elsewhere, "state.tsv", text);
    hash_of(other, hash[3]);
    cr_assert_str_neq(hash[0], hash[1], "without a start it is the same scene");
    cr_assert_str_eq(hash[1], hash[2], "the folder is in the hash");
    cr_assert_str_neq(hash[1], hash[3], "the content is not in the hash");
}

/* --- saving --- */

Test(start, save_is_the_last_frame_of_a_finished_run, .init = open_folder) {
    save_state("generalised");
    char *saved = file_read(state_path), *states = file_read(printed("%s/states.tsv", folder));
    const char *rows = strstr(saved, "\n0.1");
    cr_assert(saved && states && rows);
    const size_t frame = strlen(rows), all = strlen(states), head = strlen(saved) - frame;
    cr_assert_str_eq(rows, states + all - frame, "not the last frame");
    cr_assert_eq(strncmp(saved, states, head), 0, "not the table's head");
    cr_assert_eq(count_lines(strstr(saved, "\nt\t") + 1), 1 + 5 * 7 + 5, "not one frame");
    cr_assert_eq(count_files(folder, ".part"), 0, "a temporary file is left");
    remove(state_path);
    FAILS(3, "", "run", scene_path, "--stepper", "euler", "--rate", "1000", "--out", folder,
          "--save", state_path, "--no-progress");
    cr_assert(!file_exists(state_path), "a run that failed is saved");
    FAILS(2, "folder.tsv", "run", scene_path, "--out", folder, "--save",
          printed("%s/no/such/folder.tsv", folder), "--no-progress");
    FAILS(1, "--save", "run", scene_path, "--out", folder, "--save", "", "--no-progress");
}

/* --- what is wrong --- */

static void refuse(const char *text, const char *set, const char *says) {
    const char *sets[] = {"start=state.tsv", set ? set : "seed=1"};
    if (text)
        file_write(folder, "state.tsv", text);
    lab_refuse(scene_path, sets, 2,
               (const char *[]){printed("%s: --set: start: ", scene_path), says}, 2);
}

/* The text with `word` in place of field `field` of row `row`, counted from the end. */
static char *with(const char *text, int row, int field, const char *word) {
    const char *at = text + strlen(text) - 1;
    while (at[-1] != '\n' || row-- > 0)
        at--;
    for (int i = 0; i < field; i++)
        at = strchr(at, '\t') + 1;
    return printed("%.*s%s%s", (int)(at - text), text, word, at + strcspn(at, "\t\n"));
}

Test(start, states_of_something_else_are_refused, .init = open_folder) {
    static const struct {
        int row, field;
        const char *word, *says;
    } wrong[] = {
        {3, 5, "nan", "finite"},
        {3, 9, "inf", "finite"},
        {3, 4, "x", "column 5: 'x' is not a number"},
        {3, 12, "1\r", "carriage return"},
        {3, 2, "9", "node"},
        {3, 1, "0", "wisp"},
        {39, 3, "0.5", "head has it"},
        {38, 4, "0.5", "head has"},
        {38, 7, "0.1", "head has"},
        {0, 0, "0.2", "row"},
    };
    save_state("generalised");
    char *good = file_read(state_path);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        char *text = with(good, wrong[i].row, wrong[i].field, wrong[i].word);
        refuse(text, NULL, wrong[i].says);
    }
    good[strlen(good) - 1] = '\0';
    refuse(good, NULL, "not complete");
    *(strrchr(good, '\n') + 1) = '\0';
    refuse(good, NULL, "has 39 rows");
    strstr(strstr(good, "\nt\t"), "vx")[0] = 'w';
    refuse(good, NULL, "no column 'vx'");
    save_state("generalised");
    refuse(NULL, "wisps.[0].count=4", "rows");
    refuse(NULL, "wisps.[1].nodes=4", "wisp");
    refuse(NULL, "envelope.samples=5", "r4");
    refuse(NULL, "envelope.samples=3", "columns");
    refuse(NULL, "head.rotations=([0.5, -0.4, 0.81])", "head has it at t = 0");
    refuse(NULL, "body.[0].radii=[0.075, 0.115, 0.096]", "head has it at t = 0");
    /* of nine digits the head's nodes are near enough */
    LAB_LOAD(scene_path, "start=state.tsv");
    LAB_LOAD(scene_path, "start=state.tsv", "head.positions=([0.1000001, 0.2, 0.3])");
    refuse(NULL, "head.positions=([0.10001, 0.2, 0.3])", "head has it at t = 0");
}
