/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/program/processor.h"

#include <stddef.h>

#define LACKS(name)                                                                                \
    "processor: found one without " name ", expected one with it (make MARCH=x86-64 builds for "   \
    "any)"

/* Checks the extensions that compilers use most. A processor with these extensions also has all
 * other extensions of its x86-64 level. */
ON_ANY_PROCESSOR const char *processor_refusal(void) {
#ifdef __x86_64__
    __builtin_cpu_init();
#endif
#ifdef __AVX512F__
    if (!__builtin_cpu_supports("avx512f")) return LACKS("AVX-512");
#endif
#ifdef __AVX2__
    if (!__builtin_cpu_supports("avx2")) return LACKS("AVX2");
#endif
#ifdef __FMA__
    if (!__builtin_cpu_supports("fma")) return LACKS("FMA");
#endif
#ifdef __BMI2__
    if (!__builtin_cpu_supports("bmi2")) return LACKS("BMI2");
#endif
    return NULL;
}
