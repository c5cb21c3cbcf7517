/* Man pages, printed at build time. */
#ifndef WISPLAB_MAN_H
#define WISPLAB_MAN_H

/* Prints text as it is, no letter of it being markup, at the start of a line neither; around it,
 * markup. */
void roff(const char *before, const char *text, const char *after);

/* Prints wisplab-scene(5), from the table of settings. Returns an exit code. */
int man_scene(void);

#endif
