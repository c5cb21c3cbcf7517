/* A library to be loaded before the program's others (LD_PRELOAD), whose allocations fail where the
 * environment says so, in wisplab alone and not in what it starts:
 *   WISPLAB_FAIL_ALLOCATION=N      the N-th one of the process; a child counts on from its parent
 *   WISPLAB_FAIL_STACK=HASH        the first one of each process with that stack of calls
 *   WISPLAB_LIST_STACKS=FILE       the file gets the stacks that are new to a process, a line each;
 *                                  beside WISPLAB_FAIL_STACK only those that fail */
#include <dlfcn.h>
#include <errno.h>
#include <execinfo.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *old, size_t size);
extern void *__libc_memalign(size_t alignment, size_t size);

static int here; /* whether this is the program */
static long nth; /* that fails; 0: none */
static atomic_long count;
static uint64_t stack_to_fail;
static int list = -1, failed;
static __thread int inside; /* of what this library does itself */

/* Where the file is loaded that has this place: asked once for each page. */
static uint64_t base_of(void *place) {
    enum { SIZE = 1 << 12 };
    static __thread struct { uint64_t page, base; } known[SIZE];
    const uint64_t page = (uint64_t)place >> 12;
    if (known[page % SIZE].page != page) {
        Dl_info info = {0};
        known[page % SIZE].base = dladdr(place, &info) ? (uint64_t)info.dli_fbase : 0;
        known[page % SIZE].page = page;
    }
    return known[page % SIZE].base;
}

/* Of the places in their files, which are the same in every process. */
static uint64_t hash_of_stack(void) {
    enum { DEPTH = 30 };
    void *frames[DEPTH];
    uint64_t hash = 0xcbf29ce484222325u;
    const int depth = backtrace(frames, DEPTH);
    for (int i = 1; i < depth; i++)
        hash = (hash ^ ((uint64_t)frames[i] - base_of(frames[i]))) * 0x100000001b3u;
    return hash ? hash : 1;
}

static int is_new(uint64_t hash) {
    enum { SIZE = 1 << 16 };
    static _Atomic uint64_t known[SIZE];
    for (size_t i = hash % SIZE;; i = (i + 1) % SIZE) {
        uint64_t nothing = 0;
        if (known[i] == hash)
            return 0;
        if (atomic_compare_exchange_strong(&known[i], &nothing, hash))
            return 1;
    }
}

static int look_at_stack(void) {
    char line[32];
    if (inside)
        return 0;
    inside = 1;
    const uint64_t hash = hash_of_stack();
    const int fails = hash == stack_to_fail && !failed++;
    if (list >= 0 && (stack_to_fail ? fails : is_new(hash))) {
        const int length = snprintf(line, sizeof line, "%016llx\n", (unsigned long long)hash);
        if (write(list, line, (size_t)length) < 0)
            abort();
    }
    inside = 0;
    return fails;
}

static int fails(void) {
    if (!here)
        return 0;
    const int by_number = atomic_fetch_add(&count, 1) + 1 == nth,
              by_stack = (list >= 0 || stack_to_fail) && look_at_stack();
    if (by_number || by_stack)
        errno = ENOMEM;
    return by_number || by_stack;
}

__attribute__((constructor)) static void begin(void) {
    void *frames[2];
    const char *number = getenv("WISPLAB_FAIL_ALLOCATION"), *stack = getenv("WISPLAB_FAIL_STACK"),
               *file = getenv("WISPLAB_LIST_STACKS");
    if (strcmp(program_invocation_short_name, "wisplab") != 0)
        return;
    backtrace(frames, 2); /* which loads a library at its first call */
    nth = number ? strtol(number, NULL, 10) : 0;
    stack_to_fail = stack ? strtoull(stack, NULL, 16) : 0;
    list = file ? open(file, O_WRONLY | O_APPEND | O_CLOEXEC) : -1;
    here = 1;
}

void *malloc(size_t size) {
    return fails() ? NULL : __libc_malloc(size);
}

void *calloc(size_t times, size_t size) {
    return fails() ? NULL : __libc_calloc(times, size);
}

void *realloc(void *old, size_t size) {
    return fails() ? NULL : __libc_realloc(old, size);
}

void *aligned_alloc(size_t alignment, size_t size) {
    return fails() ? NULL : __libc_memalign(alignment, size);
}
