/* Memory of a part: a struct, and lanes-wide numbers behind it. */
#ifndef WISPLAB_KERNEL_ROOM_H
#define WISPLAB_KERNEL_ROOM_H

#include "base/lanes.h"

#include <stdlib.h>

/* Zeroed memory for a struct of `head` bytes and so many lanes, which begin at *behind; for free.
 * NULL where it cannot be had. */
static inline void *room_of(size_t head, size_t lanes, lane **behind) {
    const size_t first = (head + sizeof(lane) - 1) / sizeof(lane);
    const size_t bytes = ((first + lanes) * sizeof(lane) + 63) / 64 * 64;
    void *room = aligned_alloc(64, bytes);
    if (room) {
        memset(room, 0, bytes);
        *behind = (lane *)room + first;
    }
    return room;
}

/* Takes the next `count` lanes of it; all that is put there is made of whole lanes. */
static inline void *room_take(lane **behind, size_t count) {
    void *taken = *behind;
    *behind += count;
    return taken;
}

#endif
