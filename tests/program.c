#include "support.h"

const char *const program_path = WISPLAB_PROGRAM;
