/* Numbers as text: the shortest digits that are read back to the same bits. */
#ifndef WISPLAB_DIGITS_H
#define WISPLAB_DIGITS_H

enum { DIGITS_SIZE = 48 };

/* Writes x as %.17g lays it out, with as few digits as strtod needs to read it back to the same
 * bits, of those the ones nearest to x: never longer than %.17g, and the same for whole numbers
 * below 2^53. Returns the end of the text, where there is a zero byte. Up to DIGITS_SIZE bytes of
 * `text` are written to, behind the end with anything. */
char *digits_put(char *text, double x);

/* As an argument of printf: a text that lives as long as the block. */
#define DIGITS(x) digits_text((char[DIGITS_SIZE]){0}, x)
const char *digits_text(char text[DIGITS_SIZE], double x);

#endif
