/* A setting that a sweep varies, and the values that it takes, as they are written on the command
 * line: NAME=A,B,C (commas in brackets part no values), NAME=FROM..TO:N (equal steps) or
 * NAME=FROM..TO:log:N (equal ratios), both ends included, in twelve digits. No value is there
 * twice. */
#ifndef WISPLAB_VARY_H
#define WISPLAB_VARY_H

struct vary {
    char *name;
    char **value; /* as texts */
    int count, capacity;
};

/* Reads one. Returns 0, or -1 with one line in `reason` (REASON_SIZE). */
int vary_read(struct vary *vary, const char *text, char *reason);

/* A setting that has one value, whatever is in it. The same. */
int vary_fix(struct vary *vary, const char *name, const char *value, char *reason);

void vary_free(struct vary *vary);

#endif
