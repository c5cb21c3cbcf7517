/* Man pages, printed at build time. */
#ifndef WISPLAB_MAN_H
#define WISPLAB_MAN_H

/* Prints text as it is: no letter of it is markup, at the start of a line neither. */
void roff(const char *text);

/* Prints wisplab-scene(5), from the table of settings. Returns an exit code. */
int man_scene(void);

#endif
