/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Takes away the right to run libraries that may end the process: whatever calls them then crashes,
 * in any thread, and with that the test. */
#ifndef EHD_FOREIGN_H
#define EHD_FOREIGN_H

/* HDF5, FFTW and GSL; the test fails where the process has none of them. */
void foreign_forbid(void);
void foreign_allow(void);

#endif
