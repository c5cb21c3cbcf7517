/* The allocator of the program, libraries included: the system's, and a word where it fails. */
#include "memory.h"

#include <dlfcn.h>
#include <errno.h>

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define __SANITIZE_ADDRESS__
#endif
#endif

#ifndef __SANITIZE_ADDRESS__ /* which has an allocator of its own, that ends the program too */

/* The next one of that name behind this program's, at its first call. */
#define NEXT(name)                 \
    static __typeof__(&name) next; \
    if (!next)                     \
        *(void **)&next = dlsym(RTLD_NEXT, #name);

static void *had(void *memory, size_t bytes) {
    if (!memory && bytes > 0) {
        memory_failed(bytes);
        errno = ENOMEM;
    }
    return memory;
}

void *malloc(size_t bytes) {
    NEXT(malloc)
    return had(next(bytes), bytes);
}

void *calloc(size_t count, size_t bytes) {
    NEXT(calloc)
    return had(next(count, bytes), count * bytes);
}

void *realloc(void *old, size_t bytes) {
    NEXT(realloc)
    return had(next(old, bytes), bytes);
}

void *aligned_alloc(size_t alignment, size_t bytes) {
    NEXT(aligned_alloc)
    return had(next(alignment, bytes), bytes);
}

#endif
