#include "markup.h"

#include "visible.h"

#include <string.h>

/* One character: what is none of a page's is shown by its number. */
static void write_visible(FILE *stream, const char **text) {
    const int length = utf8_length(*text), bytes = length > 0 ? length : 1;
    char one[8], shown[16];
    snprintf(one, sizeof one, "%.*s", bytes, *text);
    if (**text == '\n' || **text == '\t')
        fputc(**text, stream);
    else
        fputs((visible_text(one, shown, sizeof shown), shown), stream);
    *text += bytes - 1;
}

void markup_text(FILE *stream, const char *text) {
    for (; *text; text++) {
        switch (*text) {
        case '&':
            fputs("&amp;", stream);
            break;
        case '<':
            fputs("&lt;", stream);
            break;
        case '>':
            fputs("&gt;", stream);
            break;
        case '"':
            fputs("&quot;", stream);
            break;
        default:
            write_visible(stream, &text);
        }
    }
}

/* Three bytes become four letters (RFC 4648, section 4). */
void markup_base64(FILE *stream, FILE *from) {
    static const char letters[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    unsigned char bytes[3] = {0};
    for (size_t n; (n = fread(bytes, 1, 3, from)) > 0; memset(bytes, 0, 3)) {
        const unsigned all = (unsigned)bytes[0] << 16 | (unsigned)bytes[1] << 8 | bytes[2];
        for (size_t k = 0; k < 4; k++)
            fputc(k <= n ? letters[all >> (18 - 6 * k) & 63] : '=', stream);
    }
}
