/* What the program asks of the disk, seen and disturbed: these functions stand in front of the C
 * library's in the whole test program. */
#ifndef WISPLAB_TESTS_DISK_H
#define WISPLAB_TESTS_DISK_H

/* In order, while `disk_noting`: f and d for a file and a folder put there (fsync), r for a rename.
 */
extern char disk_done[64];
extern int disk_noting;

/* Called once, before the next file is removed; may be NULL. */
extern void (*disk_before_unlink)(void);

/* Whether the disk keeps one waiting, for anything from no time to a millisecond: what two
 * processes do then happens in any order. */
extern int disk_hesitates;

/* Added to the times of files: the clock of the file server against this machine's, s. */
extern long disk_clock;

#endif
