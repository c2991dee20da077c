/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses between two builds of the library. The shared object of FMUs contains the library for any
 * x86-64 processor and for x86-64-v3 (AVX2, FMA; since 2013). The dynamic linker chooses one of
 * them when it loads the object. Only the shared object of FMUs contains this file. */
#include "romrun/library/ehdrom.h"

// clang, used for static analysis, does not have the name x86-64-v3
#ifdef __clang__
#define HAS_V3 (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
#else
#define HAS_V3 __builtin_cpu_supports("x86-64-v3")
#endif

#define CHOOSE(function)                                                                           \
    extern __typeof__(function) function##_any, function##_v3;                                     \
    static __typeof__(function) *resolve_##function(void) {                                        \
        __builtin_cpu_init();                                                                      \
        return HAS_V3 ? function##_v3 : function##_any;                                            \
    }                                                                                              \
    __typeof__(function) function __attribute__((ifunc("resolve_" #function)));

CHOOSE(ehdrom_model_open)
CHOOSE(ehdrom_model_close)
CHOOSE(ehdrom_model_error)
CHOOSE(ehdrom_contact_create)
CHOOSE(ehdrom_contact_free)
CHOOSE(ehdrom_contact_error)
CHOOSE(ehdrom_contact_read)
CHOOSE(ehdrom_contact_set_number)
CHOOSE(ehdrom_contact_set_accuracy)
CHOOSE(ehdrom_solve)
CHOOSE(ehdrom_start)
CHOOSE(ehdrom_step)
CHOOSE(ehdrom_accept)
CHOOSE(ehdrom_differentiate)
CHOOSE(ehdrom_respond)
CHOOSE(ehdrom_slide)
CHOOSE(ehdrom_slide_step)
CHOOSE(ehdrom_state_size)
CHOOSE(ehdrom_state_save)
CHOOSE(ehdrom_state_restore)
