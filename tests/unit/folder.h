/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A group's own working folder: enter_folder and leave_folder as its setup and teardown. */
#ifndef EHD_FOLDER_H
#define EHD_FOLDER_H

int enter_folder(void **state);
int leave_folder(void **state); // and removes it with all that is in it

#endif
