#include "memory.h"

#include "complain.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <unistd.h>

volatile sig_atomic_t memory_is_limited, memory_was_short;
void (*memory_last_word)(void);

/* Whether so many bytes more are beyond the limit of the address space. */
static int is_beyond_limit(size_t bytes) {
    char text[32] = "";
    struct rlimit limit;
    const int file = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
    if (file < 0 || read(file, text, sizeof text - 1) <= 0 || getrlimit(RLIMIT_AS, &limit))
        text[0] = '\0';
    if (file >= 0)
        close(file);
    const double room = 1 << 20; /* which the allocator asks for on top */
    const double used = strtod(text, NULL) * (double)sysconf(_SC_PAGESIZE);
    return used > 0 && used + (double)bytes + room > (double)limit.rlim_cur;
}

static void end_process(void) {
    if (memory_last_word)
        memory_last_word();
    else
        complain_last("out of memory");
    _exit(2);
}

void memory_failed(size_t bytes) {
    if (memory_is_limited && is_beyond_limit(bytes)) {
        memory_was_short = 1;
        return;
    }
    end_process();
}

void *memory_needed(void *memory) {
    if (!memory)
        end_process();
    return memory;
}

void *memory_for(void *things, size_t count, size_t *room, size_t bytes) {
    if (count <= *room)
        return things;
    *room = 2 * count + 64;
    return memory_needed(realloc(things, *room * bytes));
}
