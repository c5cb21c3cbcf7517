/* The pattern of a part's matrix as general sparse solvers want it. */
#ifndef WISPLAB_KERNEL_SPARSE_H
#define WISPLAB_KERNEL_SPARSE_H

#include "system/system.h"

/* Rows of each column, ascending, for a part of one wisp; one block, to be freed with free. NULL
 * where memory cannot be had. */
struct sparse_matrix *kernel_pattern_1(const void *part);
struct sparse_matrix *kernel_pattern_4(const void *part);

#endif
