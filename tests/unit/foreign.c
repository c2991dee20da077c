/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/unit/foreign.h"

#include "tests/unit/check.h"

#include <link.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

static const char *const libraries[] = {"libhdf5", "libfftw3", "libgsl"};
enum { NUM_LIBRARIES = sizeof libraries / sizeof *libraries };

typedef struct protection {
    int rights;
    size_t count[NUM_LIBRARIES]; // number of code segments
} protection;

static int protect(struct dl_phdr_info *object, size_t size, void *data) {
    protection *self = data;
    const char *slash = strrchr(object->dlpi_name, '/'), *name = slash ? slash + 1 : "";
    const ElfW(Addr) page = (ElfW(Addr))sysconf(_SC_PAGESIZE);

    (void)size;
    for (int i = 0; i < NUM_LIBRARIES; i++) {
        if (strncmp(name, libraries[i], strlen(libraries[i])) != 0) continue;
        for (int s = 0; s < object->dlpi_phnum; s++) {
            const ElfW(Phdr) *segment = &object->dlpi_phdr[s];
            if (segment->p_type != PT_LOAD || !(segment->p_flags & PF_X)) continue;
            const ElfW(Addr) begin = (object->dlpi_addr + segment->p_vaddr) / page * page;
            const ElfW(Addr) end = object->dlpi_addr + segment->p_vaddr + segment->p_memsz;
            self->count[i]++;
            // NOLINTNEXTLINE(performance-no-int-to-ptr): address given by the loader
            assert_int_equal(mprotect((void *)begin, end - begin, self->rights), 0);
        }
    }
    return 0;
}

static void protect_all(int rights) {
    protection self = {.rights = rights};

    dl_iterate_phdr(protect, &self);
    for (int i = 0; i < NUM_LIBRARIES; i++)
        assert_true(self.count[i] > 0);
}

void foreign_forbid(void) {
    protect_all(PROT_READ);
}

void foreign_allow(void) {
    protect_all(PROT_READ | PROT_EXEC);
}
