/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Library for LD_PRELOAD that makes one call of a program fail, or ends the program at that call.
 * From main on, it counts the calls of the kind FAULT_KIND from 1, over all threads:
 *
 *     memory  malloc, calloc, realloc, aligned allocations, and mmap of memory
 *     open    open, fopen            read   read, pread, fread of a regular file
 *     write   write, pwrite          sync   fsync, fdatasync
 *     close   of a regular file      rename rename, link, unlink
 *     map     mmap of a regular file
 *
 * FAULT_HOW selects the effect at call number FAULT_AT:
 *
 *     fail    the call fails with ENOMEM, EIO or, if it writes, ENOSPC
 *     last    this call and all later ones fail, as on a full disk
 *     short   half of the data is written; of a mapped file only the first page is mapped
 *     kill    the process ends before the call
 *     tear    the process ends during a write, at the first page boundary in the data
 *     power   the process ends; each page written since the last sync of its file may have any
 *             earlier state on the disk, and a file that has grown may have its earlier size
 *
 * Each reading of the monotonic clock advances the clock by a fifth of a second. Actions that
 * depend on the clock, such as checkpoints, therefore also happen in short runs, at the same place
 * in each run.
 *
 * The file FAULT_LOG receives the number of calls at exit and, at the fault, the library that made
 * the call. */
#include <dlfcn.h>
#include <errno.h>
#include <execinfo.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

enum kind { MEMORY, OPEN, READ, WRITE, SYNC, CLOSE, RENAME, MAP, NUM_KINDS };
enum how { FAIL, LAST, SHORT, KILL, TEAR, POWER, NUM_HOWS };
enum { PAGE = 4096 };

static const char *const kinds[NUM_KINDS] = {"memory", "open",  "read",   "write",
                                             "sync",   "close", "rename", "map"};
static const char *const hows[NUM_HOWS] = {"fail", "last", "short", "kill", "tear", "power"};

static int wanted_kind = -1, wanted_how;
static long wanted_call; // 0: no call fails, calls are only counted
static atomic_long num_calls;
static atomic_bool counting;

static int find(const char *const *names, int count, const char *name) {
    for (int i = 0; i < count; i++)
        if (name && strcmp(names[i], name) == 0) return i;
    return -1;
}

// ---- the log, written without stdio or memory

static void log_line(const char *word, long number, const char *library) {
    char line[512];
    const char *path = getenv("FAULT_LOG");
    const int log = path ? (int)syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_APPEND) : -1;
    const int length = snprintf(line, sizeof line, "%s %ld %s\n", word, number, library);

    if (log >= 0) {
        syscall(SYS_write, log, line, (size_t)length);
        syscall(SYS_close, log);
    }
}

__attribute__((destructor)) static void log_count(void) {
    if (atomic_load(&counting)) log_line("calls", atomic_load(&num_calls), "-");
}

/* Logs the library that made the call. Libc and this library make calls for other libraries and are
 * skipped. The programs contain HDF5, whose internal functions have no names (Makefile). On the
 * stack, up to two such functions may stand between a public function of HDF5 and the call. */
static void log_fault(long call) {
    enum { DEPTH = 32, MOST_NAMELESS = 3 };
    void *frames[DEPTH];
    const int depth = backtrace(frames, DEPTH);
    const char *library = "?";
    int num_nameless = 0;

    for (int i = 0; i < depth && num_nameless < MOST_NAMELESS; i++) {
        Dl_info found;
        if (!dladdr(frames[i], &found) || !found.dli_fname) continue;
        const char *slash = strrchr(found.dli_fname, '/'),
                   *name = slash ? slash + 1 : found.dli_fname;
        if (found.dli_sname && strncmp(found.dli_sname, "H5", 2) == 0) {
            library = "libhdf5";
            break;
        }
        const bool between = strncmp(name, "libc.", 5) == 0 || strcmp(name, "inject.so") == 0;
        if (num_nameless > 0 || (!between && strncmp(name, "lib", 3) != 0)) num_nameless++;
        if (num_nameless <= 1) library = name;
        if (num_nameless == 0 && !between) break;
    }
    log_line("fault", call, library);
}

// ---- deciding whether a call fails

static _Noreturn void end(void) {
    syscall(SYS_kill, getpid(), SIGKILL);
    for (;;)
        pause();
}

// functions of libc behind malloc, calloc, realloc, memalign and free
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *memory, size_t size);
void *__libc_memalign(size_t alignment, size_t size);
void __libc_free(void *memory);

// ---- data that may not be on the disk yet

typedef struct written_file {
    dev_t device;
    ino_t inode;
    off_t size;  // size at the last sync
    int file;    // descriptor that belongs to this record
    bool longer; // data behind `size` are on the disk
} written_file;

/* Earlier content of a written part of a page. */
typedef struct change {
    struct change *before;
    written_file *of; // file that was written
    off_t at;
    size_t size;
    bool kept; // the write has reached the disk
    unsigned char bytes[PAGE];
} change;

enum { MAX_FILES = 64 };
static written_file written_files[MAX_FILES];
static int num_written_files;
static change *changes; // the latest first

static written_file *find_written(int file) {
    struct stat about;
    char path[64];
    written_file *found = written_files;

    if (fstat(file, &about) != 0) return NULL;
    while (found < written_files + num_written_files &&
           (found->device != about.st_dev || found->inode != about.st_ino))
        found++;
    if (found < written_files + num_written_files) return found;
    if (num_written_files == MAX_FILES) return NULL;
    snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    *found = (written_file){.device = about.st_dev,
                            .inode = about.st_ino,
                            .file = (int)syscall(SYS_openat, AT_FDCWD, path, O_RDWR),
                            .size = about.st_size};
    num_written_files++;
    return found;
}

/* Stores the bytes that a write will replace. Only one thread may write. */
static void remember(int file, off_t at, size_t size) {
    written_file *of = wanted_how == POWER && wanted_call ? find_written(file) : NULL;

    while (of && size > 0) {
        const size_t to_page = PAGE - (size_t)at % PAGE, part = size < to_page ? size : to_page;
        change *one = __libc_calloc(1, sizeof *one);
        if (!one) return;
        *one = (change){.before = changes, .of = of, .at = at, .size = part};
        syscall(SYS_pread64, of->file, one->bytes, part, at);
        changes = one;
        at += (off_t)part;
        size -= part;
    }
}

/* Marks everything written to the file as being on the disk. */
static void forget(int file) {
    struct stat about;
    written_file *of = wanted_how == POWER && wanted_call ? find_written(file) : NULL;

    for (change **link = &changes; of && *link;) {
        change *one = *link;
        if (one->of != of) {
            link = &one->before;
            continue;
        }
        *link = one->before;
        __libc_free(one);
    }
    if (of && fstat(file, &about) == 0) of->size = about.st_size;
}

/* Returns a pseudo-random bit; the sequence depends only on FAULT_AT (Knuth, The Art of Computer
 * Programming 2, 3.3.4). */
static bool toss(void) {
    static uint64_t state;
    if (!state) state = (uint64_t)wanted_call;
    state = state * 6364136223846793005u + 1442695040888963407u;
    return state >> 63;
}

/* Decides whether a write has reached the disk. If a later write to the same page has reached the
 * disk, this write has reached it too. Otherwise the decision is random. */
static bool is_kept(const change *one) {
    for (const change *later = changes; later != one; later = later->before)
        if (later->kept && later->of == one->of && later->at / PAGE == one->at / PAGE) return true;
    return toss();
}

static void lose_power(void) {
    for (change *one = changes; one; one = one->before) {
        one->kept = is_kept(one);
        if (!one->kept) syscall(SYS_pwrite64, one->of->file, one->bytes, one->size, one->at);
        if (one->kept && one->at + (off_t)one->size > one->of->size) one->of->longer = true;
    }
    for (int f = 0; f < num_written_files; f++)
        if (!written_files[f].longer)
            syscall(SYS_ftruncate, written_files[f].file, written_files[f].size);
}

/* Counts the call and returns true if it is to fail. With KILL and POWER it does not return. */
static bool is_hit(int kind) {
    if (kind != wanted_kind || !atomic_load(&counting)) return false;
    const long call = atomic_fetch_add(&num_calls, 1) + 1;
    const bool hit =
        call == wanted_call || (wanted_how == LAST && wanted_call && call > wanted_call);
    if (!hit) return false;
    if (call == wanted_call) {
        const int before = errno;
        atomic_store(&counting, false); // backtrace may allocate memory
        log_fault(call);
        atomic_store(&counting, true);
        errno = before;
    }
    if (wanted_how == POWER) lose_power();
    if (wanted_how == KILL || wanted_how == POWER) end();
    return true;
}

static bool is_regular(int file) {
    struct stat about;
    return fstat(file, &about) == 0 && S_ISREG(about.st_mode);
}

// ---- memory

static void *refused(void) {
    errno = ENOMEM;
    return NULL;
}

void *malloc(size_t size) {
    return is_hit(MEMORY) ? refused() : __libc_malloc(size);
}

void *calloc(size_t count, size_t size) {
    return is_hit(MEMORY) ? refused() : __libc_calloc(count, size);
}

void *realloc(void *memory, size_t size) {
    return is_hit(MEMORY) ? refused() : __libc_realloc(memory, size);
}

void *memalign(size_t alignment, size_t size) {
    return is_hit(MEMORY) ? refused() : __libc_memalign(alignment, size);
}

void *aligned_alloc(size_t alignment, size_t size) {
    return is_hit(MEMORY) ? refused() : __libc_memalign(alignment, size);
}

int posix_memalign(void **memory, size_t alignment, size_t size) {
    if (is_hit(MEMORY)) return ENOMEM;
    *memory = __libc_memalign(alignment, size);
    return *memory ? 0 : ENOMEM;
}

/* Returns the descriptor of a new file in memory with the first page of `file`. */
static int cut_copy(int file) {
    char page[PAGE] = "";
    const int copy = (int)syscall(SYS_memfd_create, "cut", 0);
    if (syscall(SYS_pread64, file, page, sizeof page, 0) >= 0)
        syscall(SYS_write, copy, page, sizeof page);
    return copy;
}

void *mmap(void *address, size_t length, int protection, int flags, int file, off_t offset) {
    if (flags & MAP_ANONYMOUS && is_hit(MEMORY)) {
        errno = ENOMEM;
        return MAP_FAILED;
    }
    if (!(flags & MAP_ANONYMOUS) && is_regular(file) && is_hit(MAP)) {
        if (wanted_how != SHORT) {
            errno = EIO;
            return MAP_FAILED;
        }
        file = cut_copy(file);
    }
    return (void *)syscall(SYS_mmap, address, length, protection, flags, file, offset); // NOLINT
}

// ---- files

static int fail_with(int reason) {
    errno = reason;
    return -1;
}

static int open_mode(int flags, va_list *arguments) {
    return flags & (O_CREAT | __O_TMPFILE) ? va_arg(*arguments, int) : 0;
}

#define OPEN_FUNCTION(name)                                                                        \
    int name(const char *path, int flags, ...) {                                                   \
        va_list arguments;                                                                         \
        va_start(arguments, flags);                                                                \
        const int mode = open_mode(flags, &arguments);                                             \
        va_end(arguments);                                                                         \
        if (is_hit(OPEN)) return fail_with(EIO);                                                   \
        return (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);                              \
    }
OPEN_FUNCTION(open)
OPEN_FUNCTION(open64)

static ssize_t read_at(int file, void *data, size_t size, off_t offset, bool positioned) {
    if (is_regular(file) && is_hit(READ)) return fail_with(EIO);
    return positioned ? syscall(SYS_pread64, file, data, size, offset)
                      : syscall(SYS_read, file, data, size);
}

ssize_t read(int file, void *data, size_t size) {
    return read_at(file, data, size, 0, false);
}

ssize_t pread(int file, void *data, size_t size, off_t offset) {
    return read_at(file, data, size, offset, true);
}

ssize_t pread64(int file, void *data, size_t size, off_t offset) {
    return read_at(file, data, size, offset, true);
}

static ssize_t write_at(int file, const void *data, size_t size, off_t offset, bool positioned) {
    bool torn = false;

    if (is_regular(file) && is_hit(WRITE)) {
        const off_t at = positioned ? offset : lseek(file, 0, SEEK_CUR);
        const size_t to_page = PAGE - (size_t)at % PAGE;
        if (wanted_how == TEAR) {
            if (to_page >= size) end(); // within a page all or nothing is written
            size = to_page;
            torn = true;
        } else if (wanted_how == SHORT && size > 1) {
            size /= 2;
        } else {
            return fail_with(ENOSPC);
        }
    }
    if (is_regular(file)) remember(file, positioned ? offset : lseek(file, 0, SEEK_CUR), size);
    const ssize_t written = positioned ? syscall(SYS_pwrite64, file, data, size, offset)
                                       : syscall(SYS_write, file, data, size);
    if (torn) end();
    return written;
}

ssize_t write(int file, const void *data, size_t size) {
    return write_at(file, data, size, 0, false);
}

ssize_t pwrite(int file, const void *data, size_t size, off_t offset) {
    return write_at(file, data, size, offset, true);
}

ssize_t pwrite64(int file, const void *data, size_t size, off_t offset) {
    return write_at(file, data, size, offset, true);
}

/* Does not sync: the tests need no data on the real disk. */
int fsync(int file) {
    if (is_hit(SYNC)) return fail_with(EIO);
    forget(file);
    return 0;
}

int fdatasync(int file) {
    return fsync(file);
}

ssize_t copy_file_range(int from, off64_t *from_place, int to, off64_t *to_place, size_t size,
                        unsigned flags) {
    struct stat about;
    const off_t at = to_place ? *to_place : lseek(to, 0, SEEK_CUR);

    if (fstat(from, &about) == 0 && size > (size_t)about.st_size) size = (size_t)about.st_size;
    remember(to, at, size);
    return syscall(SYS_copy_file_range, from, from_place, to, to_place, size, flags);
}

/* Closes the file even if the call fails. */
int close(int file) {
    const bool hit = is_regular(file) && is_hit(CLOSE);
    const int outcome = (int)syscall(SYS_close, file);
    return hit ? fail_with(EIO) : outcome;
}

int rename(const char *from, const char *to) {
    return is_hit(RENAME) ? fail_with(EIO)
                          : (int)syscall(SYS_renameat, AT_FDCWD, from, AT_FDCWD, to);
}

int unlink(const char *path) {
    return is_hit(RENAME) ? fail_with(EIO) : (int)syscall(SYS_unlinkat, AT_FDCWD, path, 0);
}

// ---- streams: stdio would bypass the functions above, so streams call them through cookies

static ssize_t read_stream(void *cookie, char *data, size_t size) {
    return read((int)(intptr_t)cookie, data, size);
}

static ssize_t write_stream(void *cookie, const char *data, size_t size) {
    const ssize_t written = write((int)(intptr_t)cookie, data, size);
    return written < 0 ? 0 : written;
}

static int seek_stream(void *cookie, off64_t *offset, int from) {
    *offset = lseek((int)(intptr_t)cookie, *offset, from);
    return *offset < 0 ? -1 : 0;
}

static int close_stream(void *cookie) {
    return close((int)(intptr_t)cookie);
}

static const cookie_io_functions_t stream_functions = {
    .read = read_stream, .write = write_stream, .seek = seek_stream, .close = close_stream};

static FILE *stream_of(int file, const char *mode) {
    FILE *stream = fopencookie((void *)(intptr_t)file, mode, stream_functions); // NOLINT
    if (stream) stream->_fileno = file; // the result of fileno
    return stream;
}

static FILE *open_stream(const char *path, const char *mode) {
    const int flags =
        *mode == 'r' ? O_RDONLY : O_WRONLY | O_CREAT | (*mode == 'w' ? O_TRUNC : O_APPEND);

    if (is_hit(OPEN)) {
        errno = EIO;
        return NULL;
    }
    const int file = (int)syscall(SYS_openat, AT_FDCWD, path, flags, 0666);
    if (file < 0) return NULL;
    FILE *stream = stream_of(file, mode);
    if (!stream) syscall(SYS_close, file);
    return stream;
}

FILE *fopen(const char *path, const char *mode) {
    return open_stream(path, mode);
}

FILE *fdopen(int file, const char *mode) {
    return stream_of(file, mode);
}

FILE *fopen64(const char *path, const char *mode) {
    return open_stream(path, mode);
}

// ---- the clock

int clock_gettime(clockid_t which, struct timespec *now) {
    static atomic_long num_asked;
    if (which != CLOCK_MONOTONIC && which != CLOCK_THREAD_CPUTIME_ID)
        return (int)syscall(SYS_clock_gettime, which, now);
    const long fifths = atomic_fetch_add(&num_asked, 1);
    *now = (struct timespec){.tv_sec = fifths / 5, .tv_nsec = fifths % 5 * 200000000};
    return 0;
}

// ---- counting starts at main, after the libraries have been loaded

typedef int main_function(int, char **, char **);
static main_function *true_main;

static int counted_main(int argc, char **argv, char **environment) {
    atomic_store(&counting, true);
    return true_main(argc, argv, environment);
}

int __libc_start_main(main_function *program, int argc, char **argv, void (*init)(void),
                      void (*fini)(void), void (*rtld_fini)(void), void *stack_end) {
    typedef int start_function(main_function *, int, char **, void (*)(void), void (*)(void),
                               void (*)(void), void *);
    start_function *start;
    void *symbol = dlsym(RTLD_NEXT, "__libc_start_main");
    const char *call = getenv("FAULT_AT");

    wanted_kind = find(kinds, NUM_KINDS, getenv("FAULT_KIND"));
    wanted_how = find(hows, NUM_HOWS, getenv("FAULT_HOW"));
    wanted_call = call ? strtol(call, NULL, 10) : 0;
    true_main = program;
    memcpy(&start, &symbol, sizeof start);
    return start(counted_main, argc, argv, init, fini, rtld_fini, stack_end);
}
