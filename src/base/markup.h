/* Texts and files within HTML, SVG and XML. */
#ifndef WISPLAB_MARKUP_H
#define WISPLAB_MARKUP_H

#include <stdio.h>

/* A user's text: no character in it is markup, and control characters are shown as numbers. */
void markup_text(FILE *stream, const char *text);

/* The rest of a file as base64. */
void markup_base64(FILE *stream, FILE *from);

#endif
