/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks that this processor has the instructions that the build may use (MARCH of the Makefile).
 */
#ifndef EHD_PROCESSOR_H
#define EHD_PROCESSOR_H

/* Marks functions that run before the check. Such functions use only instructions that every x86-64
 * processor has. */
#ifdef __x86_64__
#define ON_ANY_PROCESSOR __attribute__((target("arch=x86-64")))
#else
#define ON_ANY_PROCESSOR
#endif

/* Returns why the build cannot run here, a constant text such as "processor: found one without
 * AVX2, expected …". Returns NULL if the build can run. */
const char *processor_refusal(void);

/* Ends a program with the line of processor_refusal before main, if the build cannot run here. The
 * library does not contain this function; in a program that uses the library, ehdrom_model_open
 * returns an error instead. */
void processor_check(int argc, char **argv, char **environment);

#endif
