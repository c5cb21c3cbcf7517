/* What libconfig reads wrongly without a word, or ends the program at, is found in the text before
 * libconfig sees it: whole numbers that it would wrap, text that is not UTF-8, a byte-order mark,
 * and includes that are missing, folders, or go in a circle. */
#ifndef WISPLAB_CONFIG_TEXT_H
#define WISPLAB_CONFIG_TEXT_H

#include "base/files.h"

/* Checks a scene file and what it includes, whose paths libconfig takes from `folder` ("": the
 * current one). What is no regular file, and no folder, is left to libconfig: it can be read only
 * once. Returns 0, with the number of the file's last line, 0: not known; 1 with a reason,
 * "file:line: why"; or -1 where memory cannot be had, with one. */
int config_check_file(const char *path, const char *folder, int *lines, char *reason);

/* Checks the text of a file that need not be there. */
int config_check_scene(const char *text, const char *path, const char *folder, int *lines,
                       char *reason);

/* Checks a text that is in no file: the reason is only why. */
int config_check_text(const char *text, char *reason);

#endif
