/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A folder of a test's own. */
#ifndef EHD_FOLDER_H
#define EHD_FOLDER_H

/* Its name, so far as one was made. */
extern char folder[];

/* Setup and teardown of a test or a group; both return 0. */
int make_folder(void **state);
int remove_folder(void **state); // with all that is in it

/* The same, with the folder as working folder. */
int enter_folder(void **state);
int leave_folder(void **state);

#endif
