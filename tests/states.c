/* Formats of a run's states: the binary file holds the numbers of the text to the bit and is read
 * wherever that is; a run that leaves none has the same result, and who needs some is told. */
#include "base/npy.h"
#include "disk.h"
#include "model/trajectory.h"
#include "run/case.h"
#include "run/record.h"
#include "run/seal.h"
#include "run/warnings.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char *folder;
static const char *path;
static char reason[REASON_SIZE];

static void open_folder(void) {
    folder = folder_make();
    path = printed("%s/states.npy", folder);
}

/* --- the file --- */

static const char *const names[] = {"t", "wisp", "node", NULL};
static const double numbers[] = {0, -0., 1. / 3, 5e-324, -INFINITY, 1e300, 0.1, 7, -2};

/* Three rows, of which the header tells `rows`. */
static void write_file(const char *const *columns, long long rows) {
    FILE *file = fopen(path, "w");
    npy_begin(file, columns);
    npy_put(file, numbers, 9);
    npy_set_rows(file, rows);
    fclose(file);
}

static void check_rows(int rows) {
    struct table table;
    cr_assert_eq(table_read(&table, path, reason), 0, "%s", reason);
    cr_assert(table.column_count == 3 && table.row_count == rows, "%d columns, %d rows",
              table.column_count, table.row_count);
    for (int i = 0; i < 3; i++)
        cr_assert_str_eq(table.name[i], names[i]);
    cr_assert_eq(memcmp(table.value, numbers, (size_t)rows * 3 * sizeof *numbers), 0);
    table_free(&table);
}

Test(states, a_numpy_file_has_every_bit, .init = open_folder) {
    write_file(names, 3);
    check_rows(3);
    FILE *file = fopen(path, "r");
    fseek(file, 0, SEEK_END);
    cr_assert_eq((ftell(file) - 9 * 8) % 64, 0, "rows begin at %ld", ftell(file) - 9 * 8);
    fclose(file);
}

/* A version, a header of so many letters, and rows: as numpy.save writes the same. */
Test(states, a_file_of_numpys_own_is_read, .init = open_folder) {
    static const char header[] = "{'descr': [('t', '<f8'), ('wisp', '<f8'), ('node', '<f8')], "
                                 "'fortran_order': False, 'shape': (3,), }";
    FILE *file = fopen(path, "w");
    fwrite("\x93NUMPY\x01\x00\x76\x00", 1, 10, file);
    fprintf(file, "%-117s\n", header);
    fwrite(numbers, sizeof *numbers, 9, file);
    fclose(file);
    check_rows(3);
}

/* What a killed run has written: whole rows are kept, and counted. */
Test(states, a_cut_file_is_mended, .init = open_folder) {
    for (int rest = 0; rest < 3; rest++) {
        write_file(names, 0);
        FILE *file = fopen(path, "r+");
        fseek(file, 0, SEEK_END);
        cr_assert_eq(ftruncate(fileno(file), ftell(file) - 5 * rest - 3), 0);
        rewind(file);
        cr_assert_eq(npy_mend(file), 0);
        fclose(file);
        check_rows(2);
    }
    path = file_write(folder, "states.npy", "\x93NUM");
    FILE *file = fopen(path, "r+");
    cr_assert_eq(npy_mend(file), -1, "there is no header");
    fclose(file);
}

static void check_refused(const char *why) {
    struct table table;
    cr_assert_eq(table_read(&table, path, reason), -1, "%s is read", why);
    cr_assert(strstr(reason, "states.npy: ") && strstr(reason, why), "'%s', not '%s'", reason, why);
}

Test(states, a_wrong_numpy_file_is_refused, .init = open_folder) {
    static const char *const headers[] = {
        "{'descr': '<f8', 'shape': (9,), }", "{'descr': [('t', '<f4')], 'shape': (9,), }",
        "{'descr': [], 'shape': (9,), }", "{'descr': [('t', '<f8'", "{'shape': (9,), }"};
    write_file(names, 4);
    check_refused("has not as many rows as it says");
    write_file(names, 2);
    check_refused("has not as many rows as it says");
    write_file(names, -1);
    check_refused("has no rows of numbers");
    path = file_write(folder, "states.npy", "\x93NUMPY\x02");
    check_refused("has no header");
    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++) {
        FILE *file = fopen(path, "w");
        fwrite("\x93NUMPY\x01\x00\x76\x00", 1, 10, file);
        fprintf(file, "%-117s\n", headers[i]);
        fwrite(numbers, sizeof *numbers, 9, file);
        fclose(file);
        check_refused("is no array of named columns");
    }
}

/* --- what a run writes, and when --- */

/* Nothing has its name before all is on the disk, run.json too, whatever the run still does after
 * its last frame, as the cross-check of a reference; and what is hashed on the way is what is
 * there. */
Test(states, have_their_names_when_all_of_the_run_is_there, .init = open_folder) {
    static const struct {
        struct run_request request;
        const char *done;
    } cases[] = {{{.states = STATES_TEXT}, "ffrrd"},
                 {{.states = STATES_BINARY}, "ffrrd"},
                 {{.states = STATES_NONE}, "frd"},
                 {{.states = STATES_TEXT, .diagnostics = 1}, "fffrrrd"},
                 {{.stepper = "reference"}, "ffrrd"}};
    struct scene *scene = LAB_LOAD("swing", "duration=0.1");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct settings settings = settings_of(scene, &cases[i].request);
        memset(disk_done, 0, sizeof disk_done);
        disk_noting = 1;
        cr_assert_eq(record_run(scene, &settings, folder, NULL, NULL, reason), FINISHED, "%s",
                     reason);
        disk_noting = 0;
        cr_expect_str_eq(disk_done, cases[i].done, "case %zu: %s", i, disk_done);
        cr_expect(seal_holds(folder, reason), "case %zu: %s", i, reason);
        cr_expect_eq(count_files(folder, ".part"), 0);
        run_remove(folder);
    }
}

/* Who dies between two names has no half run either. */
Test(states, of_a_run_that_died_at_its_names_are_sealed, .init = open_folder) {
    const struct run_request request = {0};
    struct scene *scene = LAB_LOAD("swing", "duration=0.1");
    const struct settings settings = settings_of(scene, &request);
    cr_assert_eq(record_run(scene, &settings, folder, NULL, NULL, reason), FINISHED, "%s", reason);
    path = printed("%s/run.json", folder);
    cr_assert_eq(unlink(path), 0);
    cr_assert_eq(record_death(scene, &settings, folder, CRASHED, "it died", 0.1, reason), 0, "%s",
                 reason);
    cr_assert(seal_holds(folder, reason), "%s", reason);
    const char *json = file_of(folder, "run.json");
    cr_assert(strstr(json, "\"states.tsv\": \""), "%s", json);
}

/* What nothing here reads back is said before it is written. */
Test(states, that_are_too_large_are_warned_of) {
    static const struct {
        const char *rate;
        enum states_format format;
        int warned;
    } cases[] = {{"frame_rate=30", STATES_TEXT, 0},
                 {"frame_rate=2e6", STATES_TEXT, 1},
                 {"frame_rate=2e6", STATES_BINARY, 1},
                 {"frame_rate=2e6", STATES_NONE, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct run_request request = {.states = cases[i].format};
        struct scene *scene = LAB_LOAD("swing", cases[i].rate);
        const struct settings settings = settings_of(scene, &request);
        json_t *warnings = scene_warnings(scene, &settings);
        const char *one = json_string_value(json_array_get(warnings, 0));
        cr_expect_eq(one && strstr(one, "gibibyte"), cases[i].warned, "%zu: %s", i, one);
        json_decref(warnings);
    }
}

/* --- runs --- */

static void run(const char *format, const char *name) {
    WORKS("run", "swing-envelope", "--duration", "0.2", "--states", format, "--out",
          printed("%s/%s", folder, name), "--diagnostics", "--no-progress");
}

Test(states, binary_ones_are_the_numbers_of_the_text, .init = open_folder) {
    struct trajectory text, binary;
    char where[PATH_SIZE];
    run("text", "a");
    run("binary", "b");
    cr_assert_eq(trajectory_path(printed("%s/a", folder), where), 0);
    cr_assert(strstr(where, "states.tsv"));
    cr_assert_eq(trajectory_read(&text, where, reason), 0, "%s", reason);
    cr_assert_eq(trajectory_path(printed("%s/b", folder), where), 0);
    cr_assert(strstr(where, "states.npy"));
    cr_assert_eq(trajectory_read(&binary, where, reason), 0, "%s", reason);
    cr_assert(text.frame_count == 7 && binary.frame_count == 7);
    cr_assert_eq(text.table.column_count, binary.table.column_count);
    cr_assert_eq(memcmp(text.table.value, binary.table.value,
                        sizeof(double) * (size_t)(text.table.row_count * text.table.column_count)),
                 0, "other bits");
    for (int i = 0; i < text.table.column_count; i++)
        cr_assert_str_eq(text.table.name[i], binary.table.name[i]);
    trajectory_free(&text);
    trajectory_free(&binary);
}

/* Pictures, exports, starts and evaluations. */
Test(states, binary_ones_are_read_where_text_is, .init = open_folder) {
    static const char *const files[] = {"a/states.tsv", "b/states.npy"};
    const char *accelerations[2];
    run("text", "a");
    run("binary", "b");
    for (int i = 0; i < 2; i++) {
        path = printed("%s/%s", folder, files[i]);
        accelerations[i] =
            WORKS("eval", "swing-envelope", "--treatment", "generalised", "--state", path)->out;
        WORKS("run", "swing-envelope", "--duration", "0.1", "--set", printed("start=\"%s\"", path),
              "--out", printed("%s/go-on", folder), "--no-progress");
        const char *const out = printed("%s/vtk-%d", folder, i);
        WORKS("export", printed("%s/%c", folder, "ab"[i]), "--vtk", out);
        cr_assert_eq(count_files(out, ".vtp"), 3 * 7);
    }
    cr_assert_str_eq(accelerations[0], accelerations[1]);
    path = printed("%s/b/states.npy", folder);
    cr_assert_eq(truncate(path, 1000), 0);
    FAILS(1, "has not as many rows", "run", "swing-envelope", "--set",
          printed("start=\"%s\"", path), "--out", folder);
}

Test(states, none_are_left_and_the_rest_is_the_same, .init = open_folder) {
    run("text", "a");
    run("text", "n"); /* whose file must not stay */
    run("none", "n");
    cr_assert_str_eq(file_of(folder, "a/diagnostics.tsv"), file_of(folder, "n/diagnostics.tsv"));
    path = printed("%s/n", folder);
    cr_assert_eq(count_files(path, ""), 2, "more than run.json and diagnostics.tsv");
    FAILS(1, "--states none", "export", path, "--vtk", path);
    FAILS(1, "--states none", "render", path, "--out", path);
    FAILS(1, "--save", "run", "swing-envelope", "--states", "none", "--save", path);
    FAILS(1, "text, binary or none", "run", "swing-envelope", "--states", "hdf5");
}
