/* What an experiment found, in sentences: the rows of statements.tsv in its folder. Terminal,
 * captions and report print these rows; whoever wants to say something of an experiment adds one.
 */
#ifndef WISPLAB_STATEMENTS_H
#define WISPLAB_STATEMENTS_H

#include "base/text_table.h"

struct scene;

/* What came of a claim. A control is a run in which what the claim is about is switched off: a
 * claim that it passes too says nothing of that. X(symbol, word in the table, meaning) */
#define VERDICTS(X)                                                                     \
    X(HOLDS, "holds", "the runs show what the sentence claims")                         \
    X(HOLDS_NOT, "does not hold", "they show otherwise, and the sentence says what")    \
    X(TELLS_NOTHING, "tells nothing", "they show it, and so does the control")          \
    X(NOT_REACHED, "not reached",                                                       \
      "no run got there: it was cut, or failed before, or what it is about never came") \
    X(NOT_ASKED, "not asked", "the runs that would tell were left out by the user's choice")

enum claim_verdict {
#define X(symbol, word, meaning) symbol,
    VERDICTS(X)
#undef X
        VERDICT_COUNT
};

static inline enum claim_verdict holds_if(int shown) {
    return shown ? HOLDS : HOLDS_NOT;
}

/* The questions that a report begins with. X(symbol, word in the table, question) */
#define QUESTIONS(X)                                                                   \
    X(ANSWERS_NONE, "-", "")                                                           \
    X(ANSWERS_CHOICE, "choice",                                                        \
      "Was explicit Euler with projection at 9000 Hz, the thesis's choice, right?")    \
    X(ANSWERS_TARGETS, "targets", "What would one choose today for 10, 1 and 0.1 mm?") \
    X(ANSWERS_FAILURES, "failures", "Where does each method fail?")                    \
    X(ANSWERS_NEEDS, "needs", "What does each scene need?")

enum question {
#define X(symbol, word, text) symbol,
    QUESTIONS(X)
#undef X
        QUESTION_COUNT
};

/* The word and the text of a question; static storage. */
const char *question_word(enum question question);
const char *question_text(enum question question);

/* Whose claim it is. */
enum whose { OURS, THESIS };

/* A row but for its sentence. */
struct statement {
    char key[192];      /* names the row; no other row of the table has it */
    const char *figure; /* under which it stands, without .svg; NULL: none */
    char tables[192];   /* that it follows from, without .tsv, separated by blanks; empty: none */
    enum question answers;
    enum claim_verdict verdict;
    enum whose by;
    double value;     /* on which the verdict rests */
    const char *unit; /* of it, as "mm" or "frame"; "1": a ratio or a number; NULL: no value */
};

/* A row of what we found, or of what the thesis claims, that answers no question; its key (printf)
 * is last. `tables`: NULL for none. */
#define our_row(...)    statement_row(OURS, __VA_ARGS__)
#define thesis_row(...) statement_row(THESIS, __VA_ARGS__)
struct statement statement_row(enum whose by, const char *figure, const char *tables,
                               enum claim_verdict verdict, double value, const char *unit,
                               const char *key, ...) __attribute__((format(printf, 7, 8)));

/* Adds to a list in a sentence (printf), after ", " where there is something. What does not fit in
 * its `size` is left out. */
void list_add(char *list, size_t size, const char *item, ...) __attribute__((format(printf, 3, 4)));

/* Who is tied with the cheapest: what it is put in order by, s, and the CPU time that is shown, s.
 */
struct rival {
    const char *name;
    double counted, cpu;
};
enum { RIVALS_MOST = 64 };

/* Puts rivals in order, and writes how a sentence goes on that has named the cheapest: ", b (3 ms)
 * and c (5 ms)", of more than three the first three and how many more. */
void list_rivals(char text[512], struct rival *rivals, int count);

/* --- the one writer --- */

/* The table while it is written. */
struct statements {
    struct atomic_file file;
};

/* Opens folder/statements.tsv; `cut` is what --quick or a budget left out, or NULL. Returns 0, or
 * -1 with one line in `reason`. */
int statements_open(struct statements *statements, const char *folder, const struct scene *scene,
                    const char *cut, char *reason);

/* Adds a row with its sentence (printf): subject, verb, number with unit, a stop. What the thesis
 * claims is first said in short, then after ": " what was found. It is one line: tabs and line ends
 * in it become blanks. A value that is not finite is left out. */
void statements_add(struct statements *statements, struct statement row, const char *sentence, ...)
    __attribute__((format(printf, 3, 4)));

/* Where scenes were changed by the user: a row that what follows is of those, and nothing is said
 * of the scenes as they are. */
void statements_of_changed(struct statements *statements, const char *const *sets, int set_count);

/* Ends the table: commits it, or where `code` is not 0 discards it and returns that. Returns 0, or
 * -1 with one line in `reason`. */
int statements_close(struct statements *statements, int code, char *reason);

/* --- the one reader --- */

/* What was found of a claim: what is behind its first ": ", or NULL where there is none. */
const char *statement_finding(const char *sentence);

/* Reads folder/statements.tsv as a table of the columns key, figure, question, statement, verdict,
 * value, unit, by, tables, in which - stands for nothing. Returns 0, or -1 with one line in
 * `reason`: it is not there, lacks a column, a cell is empty, a verdict is none of VERDICTS, or a
 * claim of the thesis has no finding. */
int statements_read(struct text_table *rows, const char *folder, char *reason);

/* Prints the rows of folder/statements.tsv to the terminal: verdict, whose, sentence. Returns 0, or
 * -1 with one line in `reason`. */
int statements_print(const char *folder, char *reason);

#endif
