/* Pictures of a drawing program made fit for a page with others: smaller, and with ids of their
 * own.
 */
#ifndef WISPLAB_SVG_H
#define WISPLAB_SVG_H

#include <stdio.h>

/* Writes the text of an .svg from the attributes of its first tag on to its end. Ids and what
 * refers to them begin with `prefix`. What cannot be seen is left out: the drawing program's
 * titles, groups without content, blanks between tags. Lines are written in tenths of the picture's
 * unit, each point from the one before; the marks' own shapes, which are drawn at many sizes, are
 * as they were. */
void svg_write(FILE *stream, const char *attributes, const char *prefix);

#endif
