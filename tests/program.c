#include "support.h"

const char *const program_path = WISPLAB_PROGRAM;
const char *const program_method = WISPLAB_METHOD;
