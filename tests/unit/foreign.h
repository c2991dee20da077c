/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Removes the permission to execute the code of libraries that may end the process. A call of such
 * a library, in any thread, then crashes the test. */
#ifndef EHD_FOREIGN_H
#define EHD_FOREIGN_H

/* Forbids HDF5, FFTW and GSL; the test fails if one of them is not loaded. */
void foreign_forbid(void);
void foreign_allow(void);

#endif
