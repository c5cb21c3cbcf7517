#include "outcome.h"

#include <string.h>

static const struct {
    const char *name;
    int exit_code;
} outcomes[] = {
#define X(symbol, name, code, meaning) {name, code},
    OUTCOMES(X)
#undef X
};

const char *outcome_name(enum outcome outcome) {
    return outcomes[outcome].name;
}

int outcome_exit_code(enum outcome outcome) {
    return outcomes[outcome].exit_code;
}

enum outcome outcome_from_name(const char *name) {
    int i = 0;
    while (i < OUTCOME_COUNT && strcmp(outcomes[i].name, name) != 0)
        i++;
    return (enum outcome)i;
}
