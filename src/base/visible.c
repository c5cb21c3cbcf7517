#include "visible.h"

#include <stdio.h>
#include <string.h>

/* RFC 3629. */
int utf8_length(const char *text) {
    const unsigned char *c = (const unsigned char *)text;
    const int more = c[0] < 0x80 ? 0 : c[0] < 0xc2 ? -1 : c[0] < 0xe0 ? 1 : c[0] < 0xf0 ? 2 : 3;
    if (more < 0 || c[0] > 0xf4 || (c[0] == 0xe0 && c[1] < 0xa0) || (c[0] == 0xed && c[1] > 0x9f) ||
        (c[0] == 0xf0 && c[1] < 0x90) || (c[0] == 0xf4 && c[1] > 0x8f))
        return 0;
    for (int i = 1; i <= more; i++)
        if ((c[i] & 0xc0) != 0x80)
            return 0;
    return more + 1;
}

int is_control(const char *text) {
    const unsigned char *c = (const unsigned char *)text;
    return c[0] < ' ' || c[0] == 0x7f || (c[0] == 0xc2 && c[1] >= 0x80 && c[1] < 0xa0);
}

void visible_text(const char *text, char *shown, size_t size) {
    size_t used = 0;
    while (*text) {
        char piece[8];
        const int length = utf8_length(text);
        if (length == 0)
            snprintf(piece, sizeof piece, "\\x%02x", (unsigned)(unsigned char)*text);
        else if (is_control(text))
            snprintf(piece, sizeof piece, "\\u%04x", (unsigned)(unsigned char)text[length - 1]);
        else
            snprintf(piece, sizeof piece, "%.*s", length, text);
        if (used + strlen(piece) >= size)
            break;
        strcpy(shown + used, piece);
        used += strlen(piece);
        text += length > 0 ? length : 1;
    }
    shown[used] = '\0';
}
