/* Text that somebody else has written, as it may be shown. */
#ifndef WISPLAB_VISIBLE_H
#define WISPLAB_VISIBLE_H

#include <stddef.h>

/* How many bytes the character takes that begins here; 0 where it is none of UTF-8. */
int utf8_length(const char *text);

/* Whether the character that begins here is a control character, C0, DEL or C1. */
int is_control(const char *text);

/* Copies a text, cut at `size` between characters. Control characters, which terminals obey, and
 * bytes that are not UTF-8 become their numbers: \u009b, \xff. */
void visible_text(const char *text, char *shown, size_t size);

#endif
