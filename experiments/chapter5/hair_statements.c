/* What a figure of chapter 5 states: measurements as they are, and claims, each of which was tried
 * on the control before. */
#include "hair_study.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static void add_row(struct hair_study *study, struct statement row, const char *text) {
    if (!row.figure) {
        row.figure = "series";
        snprintf(row.tables, sizeof row.tables, "series");
    }
    statements_add(study->statements, row, "%s", text);
}

void hair_state(struct hair_study *study, struct statement row, const char *sentence, ...) {
    char text[400];
    va_list arguments;
    if (!study->statements)
        return;
    va_start(arguments, sentence);
    vsnprintf(text, sizeof text, sentence, arguments);
    va_end(arguments);
    add_row(study, row, text);
}

static void keep_trial(struct hair_study *study, const struct statement *row) {
    const size_t size = (size_t)(study->trial_count + 1) * sizeof *study->trials;
    struct hair_trial *trials = realloc(study->trials, size);
    study->out_of_memory |= !trials;
    if (!trials)
        return;
    study->trials = trials;
    trials += study->trial_count++;
    trials->verdict = row->verdict;
    snprintf(trials->key, sizeof trials->key, "%s", row->key);
}

static int control_passes(const struct hair_study *study, const char *key) {
    for (int i = 0; i < study->trial_count; i++)
        if (strcmp(study->trials[i].key, key) == 0)
            return study->trials[i].verdict == HOLDS;
    return 0;
}

void hair_claim(struct hair_study *study, struct statement row, const char *sentence, ...) {
    char text[400];
    va_list arguments;
    if (!study->statements) {
        keep_trial(study, &row);
        return;
    }
    va_start(arguments, sentence);
    vsnprintf(text, sizeof text, sentence, arguments);
    va_end(arguments);
    if (row.verdict == HOLDS && control_passes(study, row.key)) {
        const size_t used = strlen(text);
        row.verdict = TELLS_NOTHING;
        snprintf(text + used, sizeof text - used, " So it is %s, too.", study->question->without);
    }
    add_row(study, row, text);
}
