/* Frames as text: whatever their length and however many threads write them, the table that one
 * loop over its numbers prints. */
#include "run/frame_text.h"

#include "base/digits.h"
#include "model/state.h"
#include "support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 5, ROWS_MOST = 3000, NODES = 3 };

static const char *const columns[] = {"wisp", "node", "x", "y", "z", NULL};

static void fill(double *rows, int *parent) {
    for (int i = 0; i < ROWS_MOST; i++) {
        double *row = rows + i * COLUMNS;
        row[0] = i / NODES;
        row[1] = i % NODES;
        for (int k = 2; k < COLUMNS; k++)
            row[k] = sin(1.7 * i + k) * pow(10, i % 40 - 20);
        parent[i / NODES] = i / NODES / 2;
    }
}

/* The slow twin. */
static void print_rows(FILE *stream, const struct model *model, double t, const double *rows) {
    for (int i = 0; i < model->row_count; i++) {
        fputs(DIGITS(t), stream);
        for (int k = 0; k < COLUMNS; k++)
            fprintf(stream, "\t%s", DIGITS(rows[i * COLUMNS + k]));
        fprintf(stream, "\t%d\n", model->parent[(int)rows[i * COLUMNS]]);
    }
}

Test(frame_text, any_number_of_rows_and_threads_makes_the_same_table) {
    static const int counts[] = {1, 2, 15, 16, 17, 200, 1023, 1024, 1025, 2048, ROWS_MOST};
    double *rows = test_room(ROWS_MOST * COLUMNS * sizeof *rows);
    int *parent = test_room(ROWS_MOST * sizeof *parent);
    fill(rows, parent);
    for (int threads = 1; threads <= 3; threads++) {
        struct frame_text text = {0};
        struct model model = {.columns = columns,
                              .column_count = COLUMNS,
                              .parent = parent,
                              .workers = workers_create(threads)};
        for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
            char *written, *expected;
            size_t size, expected_size;
            FILE *stream = open_memstream(&written, &size),
                 *twin = open_memstream(&expected, &expected_size);
            model.row_count = counts[i];
            state_write_columns(stream, &model);
            cr_assert_eq(frame_text_write(&text, stream, &model, 1. / 3, rows), 0);
            print_rows(twin, &model, 1. / 3, rows);
            fclose(stream);
            fclose(twin);
            const char *rows_written = written;
            while (*rows_written == '#' || *rows_written == 't') /* what the columns are */
                rows_written = strchr(rows_written, '\n') + 1;
            cr_assert(size - (size_t)(rows_written - written) == expected_size &&
                          memcmp(rows_written, expected, expected_size) == 0,
                      "%d rows, %d threads: another table", counts[i], threads);
            free(written);
            free(expected);
        }
        workers_free(model.workers);
        frame_text_free(&text);
    }
}
