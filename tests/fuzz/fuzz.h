/* What the fuzz targets share. A target is LLVMFuzzerTestOneInput of one kind of file; libFuzzer
 * calls it, or replay.c with the files of a corpus. */
#ifndef WISPLAB_FUZZ_H
#define WISPLAB_FUZZ_H

#include "base/files.h"

#include <stddef.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Writes the input as `name` into a folder of this process, in memory, which is removed at its end;
 * the path is static. */
const char *fuzz_file(const char *name, const uint8_t *data, size_t size);

/* Ends the process if a refusal is not one line. */
void fuzz_refusal(const char *reason);

#endif
