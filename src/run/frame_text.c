#include "frame_text.h"

#include "base/digits.h"

#include <stdlib.h>
#include <string.h>

/* Rows of a task, and tasks of a round: a round's text fits the second cache. */
enum { TASK_ROWS = 16, ROUND_TASKS = 64 };

/* A round of rows, each task's at its own place of the room. */
struct round {
    const struct model *model;
    const double *rows;
    int row_count; /* that are left, with this round's */
    char time[DIGITS_SIZE];
    size_t time_length;
    char *room;
    size_t place; /* bytes of a task */
    size_t length[ROUND_TASKS];
};

static char *put_row(const struct round *round, int i, char *text) {
    const int columns = round->model->column_count;
    const double *row = round->rows + (size_t)i * (size_t)columns;
    memcpy(text, round->time, DIGITS_SIZE);
    text += round->time_length;
    for (int j = 0; j <= columns; j++) {
        *text++ = '\t';
        text = digits_put(text, j < columns ? row[j] : round->model->parent[(int)row[0]]);
    }
    *text++ = '\n';
    return text;
}

static void put_rows(void *ctx, int task) {
    struct round *round = ctx;
    char *const text = round->room + (size_t)task * round->place;
    char *end = text;
    for (int i = task * TASK_ROWS; i < (task + 1) * TASK_ROWS && i < round->row_count; i++)
        end = put_row(round, i, end);
    round->length[task] = (size_t)(end - text);
}

static int make_room(struct frame_text *text, size_t size) {
    if (text->size >= size)
        return 0;
    char *room = realloc(text->room, size);
    if (!room)
        return -1;
    *text = (struct frame_text){room, size};
    return 0;
}

int frame_text_write(struct frame_text *text, FILE *stream, const struct model *model, double t,
                     const double *rows) {
    /* No number has more letters than DIGITS_SIZE, which is also what it needs of room. */
    struct round round = {.model = model,
                          .rows = rows,
                          .place =
                              (size_t)TASK_ROWS * (size_t)(model->column_count + 2) * DIGITS_SIZE};
    if (make_room(text, ROUND_TASKS * round.place))
        return -1;
    round.room = text->room;
    round.time_length = (size_t)(digits_put(round.time, t) - round.time);
    for (round.row_count = model->row_count; round.row_count > 0;) {
        const int whole = (round.row_count + TASK_ROWS - 1) / TASK_ROWS;
        const int tasks = whole < ROUND_TASKS ? whole : ROUND_TASKS;
        workers_run(model->workers, put_rows, &round, tasks);
        for (int i = 0; i < tasks; i++)
            fwrite(round.room + (size_t)i * round.place, 1, round.length[i], stream);
        round.rows += (size_t)tasks * TASK_ROWS * (size_t)model->column_count;
        round.row_count -= tasks * TASK_ROWS;
    }
    return 0;
}

void frame_text_free(struct frame_text *text) {
    free(text->room);
    *text = (struct frame_text){0};
}
