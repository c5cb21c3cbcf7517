/* The results of many small runs in few files: each process appends its own to one file, a line a
 * run, and reads what the others have written. A line begins with a hash of what is behind it: one
 * that a killed process or a full disk has cut is no line, and its run is to be done again. */
#ifndef WISPLAB_PACK_H
#define WISPLAB_PACK_H

#include "base/files.h"
#include "base/hash.h"

struct pack {
    char folder[PATH_SIZE];
    char own[PATH_SIZE]; /* this process's file; empty before its first line */
    int file;            /* that, open; -1: none */
    int damaged;         /* complete lines of others that are none: they were passed over */
    char first_damaged[PATH_SIZE + 16]; /* FILE:LINE of the first of them */
    struct pack_file *seen;
    int seen_count;
};

/* `folder` must be there. Returns 0, or -1 where its path is too long. */
int pack_open(struct pack *pack, const char *folder);

/* Calls take(ctx, key, cells) with each line that others have written since the last look, whoever
 * they are and on whatever host. Returns 0, or -1 with one line in `reason`. */
int pack_look(struct pack *pack, void (*take)(void *ctx, const char *key, const char *cells),
              void *ctx, char *reason);

/* Appends a line: `cells` has no newline. A process that is killed then has written it or not.
 * Returns 0, or -1 with one line in `reason`. */
int pack_append(struct pack *pack, const char *key, const char *cells, char *reason);

/* Until the lines are on the disk, or the file server has them. The same. */
int pack_settle(struct pack *pack, char *reason);

void pack_close(struct pack *pack);

#endif
