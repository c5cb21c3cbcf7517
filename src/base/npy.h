/* Tables of doubles in the format of numpy's files (.npy, version 1.0): an array with a name for
 * each column. A header says the names and how many rows there are, the rows are little-endian
 * doubles and nothing else. */
#ifndef WISPLAB_NPY_H
#define WISPLAB_NPY_H

#include "table.h"

#include <stdio.h>

/* Writes a header for no rows as yet: names that end with NULL, of letters and digits. Errors are
 * the stream's. */
void npy_begin(FILE *stream, const char *const *names);

/* Numbers of rows, one after the other. */
void npy_put(FILE *stream, const double *number, size_t count);

/* Says in the header how many rows there are, in a file that can be written at any place. */
void npy_set_rows(FILE *stream, long long rows);

/* Cuts a file that was begun and is open for reading and writing behind its last whole row, and
 * says in its header how many there are. Returns 0, or -1 where it cannot. */
int npy_mend(FILE *file);

/* Whether a file that is read from its first byte begins as one; the next byte read is its first.
 */
int npy_is_begun(FILE *file);

/* Reads one from its first byte, ours or numpy's own, into an empty table. Returns NULL, or what is
 * wrong. */
const char *npy_read(struct table *table, FILE *file);

#endif
