/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Temporary folders of tests. */
#ifndef EHD_FOLDER_H
#define EHD_FOLDER_H

/* Path of the folder; valid once a folder was made. */
extern char folder[];

/* Make and remove `folder`, as setup and teardown of a test or a group; both return 0. */
int make_folder(void **state);
int remove_folder(void **state); // with all its contents

/* Like make_folder and remove_folder, but the folder is the working directory in between. */
int enter_folder(void **state);
int leave_folder(void **state);

#endif
