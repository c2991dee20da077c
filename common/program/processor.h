/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks that this processor has the instructions that the build may use (MARCH of the Makefile). */
#ifndef EHD_PROCESSOR_H
#define EHD_PROCESSOR_H

/* Marks functions that run before the check, so that they use no such instructions. */
#ifdef __x86_64__
#define ON_ANY_PROCESSOR __attribute__((target("arch=x86-64")))
#else
#define ON_ANY_PROCESSOR
#endif

/* Why the build cannot run here, as "processor: found one without AVX2, expected …"; NULL: it can. A constant text. */
const char *processor_refusal(void);

/* Ends a program with that line before main. The library does not: ehdrom_model_open returns an error. */
void processor_check(int argc, char **argv, char **environment);

#endif
