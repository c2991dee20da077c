/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Flips single bits of the partial files of interrupted runs, and runs programs on them:
 *
 *     flip STEP [TARGET...]    flips every STEP-th bit of each target; needs a folder of with-bases.sh
 *
 * A run has limits of processor time and of time asleep. Calls for sleep return at once, and only
 * their time is counted. A run must end with an exit code that a damaged file may cause. If the run
 * succeeds, its output must equal the output of a run without the flip. Prints the failures and the
 * number of runs; the exit code is 1 if a run failed. */
#include "tests/fuzz/target.h"

#include <errno.h>
#include <fcntl.h>
#include <hdf5.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define PARTIAL FUZZ_OUTPUT ".partial"

enum {
    MAX_WAIT = 1,        // limit of sleep in a run, s
    MAX_SECONDS = 20,    // limit of processor time, s; a run takes milliseconds
    RUNS_A_PROCESS = 200 // limits the memory that HDF5 keeps from refused files
};

typedef struct interrupted {
    const char *name;
    const char *command; // interrupted command, later resumed with --resume
    int at;              // the command is killed after this percentage of its writes
} interrupted;

static const interrupted targets[] = {
    {"plan", "snapgen still-plan.yml -j 1 -q -o " FUZZ_OUTPUT, 70},
    {"trajectories", "snapgen line-plan.yml -j 1 -q -o " FUZZ_OUTPUT, 80},
    {"adaptive",
     "snapgen wide-plan.yml --adaptive -j 1 --accuracy 0.02 --start 5 -q -o " FUZZ_OUTPUT, 70},
    {"point", "snapgen point-plan.yml -j 1 -q -o " FUZZ_OUTPUT, 80},
    {"result", "fullrun time.yml --allow-untrusted -q -o " FUZZ_OUTPUT, 60},
    {"reduced", "romrun time.yml --model m-line.h5 --allow-untrusted -q -o " FUZZ_OUTPUT, 60},
    {"cases",
     "romrun line.yml --cases cases.csv --model m-line.h5 --jobs 1 --allow-untrusted -q "
     "-o " FUZZ_OUTPUT,
     90},
};
enum { NUM_TARGETS = sizeof targets / sizeof *targets };

// ---- replacements of system calls of HDF5 and the programs

// kill_at: number of the write at which the process is killed; 0: the process is not killed
static long num_writes, kill_at;
static double waited;

ssize_t pwrite(int file, const void *bytes, size_t count, off_t at) {
    if (++num_writes == kill_at) _exit(0);
    return syscall(SYS_pwrite64, file, bytes, count, at);
}

/* Replaces pwrite64 like pwrite, because HDF5 may call pwrite by this name. */
ssize_t pwrite64(int file, const void *bytes, size_t count, off64_t at) {
    return pwrite(file, bytes, count, at);
}

int nanosleep(const struct timespec *wanted, struct timespec *left) {
    if (left) *left = (struct timespec){0};
    waited += (double)wanted->tv_sec + 1e-9 * (double)wanted->tv_nsec;
    if (waited > MAX_WAIT) fuzz_complain("a run", 0, "that it waits", "");
    return 0;
}

/* Advances the monotonic clock at each reading, so that short runs also write restart slots. */
int clock_gettime(clockid_t clock, struct timespec *now) {
    const double step = 0.2;
    static double seconds = 1;
    if (clock != CLOCK_MONOTONIC) return (int)syscall(SYS_clock_gettime, clock, now);
    seconds += step;
    now->tv_sec = (time_t)seconds;
    now->tv_nsec = (long)(1e9 * (seconds - (double)now->tv_sec));
    return 0;
}

// ---- in a separate process

typedef struct shared {
    _Atomic size_t bit; // next bit to flip
    _Atomic long writes;
    _Atomic size_t refused, whole;
} shared;
static shared *told;

/* Runs the command until it is killed at the write `kill_at`. If it is not killed, stores the
 * number of writes in told->writes. */
static _Noreturn void make_partial(const interrupted *of) {
    fuzz_start(dup(STDERR_FILENO));
    const int code = fuzz_call(of->command);
    if (code) fuzz_complain(of->command, code, "that it fails", fuzz_said());
    told->writes = num_writes;
    _exit(0);
}

/* Checks that a line of the digest does not depend on when and how often the run was
 * interrupted. */
static bool is_content(const char *line, size_t length) {
    static const char *const others[] = {" attributes", " restart", "seconds"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (memmem(line, length, others[i], strlen(others[i]))) return false;
    return true;
}

static void keep_content(char *digest) {
    char *kept = digest;
    for (const char *line = digest, *next; *line; line = next) {
        next = line + strcspn(line, "\n");
        next += *next == '\n';
        const size_t length = (size_t)(next - line);
        if (!is_content(line, length)) continue;
        memmove(kept, line, length);
        kept += length;
    }
    *kept = '\0';
}

static void digest_of(char digest[1 << 13], const char *path) {
    const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    const hid_t attribute = H5Aopen(file, "content_sha256", H5P_DEFAULT),
                type = H5Aget_type(attribute);
    if (H5Tget_size(type) >= 1 << 13 || H5Aread(attribute, type, digest) < 0) *digest = '\0';
    H5Tclose(type);
    H5Aclose(attribute);
    H5Fclose(file);
    keep_content(digest);
}

static void write_bytes(const char *path, const char *bytes, size_t length) {
    const int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (file < 0 || write(file, bytes, length) != (ssize_t)length) abort();
    close(file);
}

static bool is_there(const char *path) {
    return access(path, F_OK) == 0;
}

static void limit_time(void) {
    const struct itimerval limit = {.it_value = {.tv_sec = MAX_SECONDS}};
    waited = 0;
    setitimer(ITIMER_PROF, &limit, NULL);
}

static const int allowed[] = {EHD_OK,   EHD_NOT_CONVERGED, EHD_UNTRUSTED, EHD_CANTCREATE,
                              EHD_DATA, EHD_NOINPUT,       EHD_MEMORY};

static int call_limited(const char *command, const char *bytes, size_t length) {
    unlink(FUZZ_OUTPUT);
    write_bytes(PARTIAL, bytes, length);
    limit_time();
    const int code = fuzz_call(command);
    size_t i = 0;
    while (i < sizeof allowed / sizeof *allowed && allowed[i] != code)
        i++;
    if (i == sizeof allowed / sizeof *allowed)
        fuzz_complain(command, code, "a code that no file must lead to", fuzz_said());
    if (is_there(FUZZ_OUTPUT) != (code < EHD_USAGE))
        fuzz_complain(command, code, "an output, or none", "");
    return code;
}

/* Runs two programs on the damaged partial file: the command without --resume, which may replace
 * the file, and a program that prints the file. */
static void meet_others(const interrupted *of, const char *bytes, size_t length) {
    call_limited(of->command, bytes, length);
    unlink(FUZZ_OUTPUT);
    write_bytes(PARTIAL, bytes, length);
    limit_time();
    const int code = fuzz_call("podbuild --print " PARTIAL " pressure status");
    if (code && code != EHD_DATA && code != EHD_NOINPUT)
        fuzz_complain("podbuild --print", code, "a code that no file must lead to", fuzz_said());
}

/* Resumes from the damaged file. Checks that the file is refused, or that the result equals the
 * result without a flip. */
static void meet(const interrupted *of, const char *bytes, size_t length, const char *digest) {
    char command[256], found[1 << 13];
    snprintf(command, sizeof command, "%s --resume", of->command);
    const int code = call_limited(command, bytes, length);
    if (code < EHD_USAGE) {
        told->whole++;
        digest_of(found, FUZZ_OUTPUT);
        if (strcmp(found, digest) != 0) fuzz_complain(command, code, "another content", found);
    } else {
        told->refused++;
        if (!is_there(PARTIAL)) fuzz_complain(command, code, "that the partial file is gone", "");
    }
}

/* Makes the next RUNS_A_PROCESS flips, starting with told->bit. */
static _Noreturn void run_some(const interrupted *of, char *bytes, size_t length, size_t step) {
    char digest[1 << 13], command[256];
    fuzz_start(dup(STDERR_FILENO));
    snprintf(command, sizeof command, "%s --resume", of->command);
    const int code = call_limited(command, bytes, length);
    if (code) fuzz_complain(command, code, "that it fails without a flip", fuzz_said());
    digest_of(digest, FUZZ_OUTPUT);
    for (int i = 0; i < RUNS_A_PROCESS && told->bit < 8 * length; i++, told->bit += step) {
        bytes[told->bit / 8] ^= (char)(1 << told->bit % 8);
        meet(of, bytes, length, digest);
        if (i % 4 == 0) meet_others(of, bytes, length);
        bytes[told->bit / 8] ^= (char)(1 << told->bit % 8);
    }
    exit(0);
}

// ---- all flips of a target

static int outcome_of(pid_t child) {
    int outcome;
    if (child < 0 || waitpid(child, &outcome, 0) != child) abort();
    return outcome;
}

static char *read_partial(size_t *length) {
    struct stat about;
    const int file = open(PARTIAL, O_RDONLY);
    if (file < 0 || fstat(file, &about) != 0) return NULL;
    *length = (size_t)about.st_size;
    char *bytes = malloc(*length);
    if (!bytes || read(file, bytes, *length) != about.st_size) abort();
    close(file);
    return bytes;
}

/* Interrupts the command and returns the partial file; NULL if there is none. */
static char *interrupt(const interrupted *of, size_t *length) {
    unlink(PARTIAL);
    unlink(FUZZ_OUTPUT);
    pid_t child = fork();
    if (child == 0) make_partial(of);
    if (outcome_of(child) != 0) return NULL;
    unlink(FUZZ_OUTPUT);
    child = fork();
    if (child == 0) {
        kill_at = told->writes * of->at / 100;
        make_partial(of);
    }
    return outcome_of(child) == 0 ? read_partial(length) : NULL;
}

/* Makes all flips of a target; returns how many failed. */
static size_t flip(const interrupted *of, size_t step) {
    size_t length, failed = 0, runs = 0;
    char *bytes = interrupt(of, &length);
    if (!bytes) {
        printf("%s: found no partial file, expected one\n", of->name);
        return 1;
    }
    told->refused = told->whole = 0;
    // with an odd STEP the flips reach all eight positions in a byte
    for (told->bit = 0; told->bit < 8 * length;) {
        const pid_t child = fork();
        if (child == 0) run_some(of, bytes, length, step);
        const int outcome = outcome_of(child);
        if (outcome == 0) continue;
        printf("%s: bit %zu of byte %zu: found %s %d\n", of->name, told->bit % 8, told->bit / 8,
               WIFSIGNALED(outcome) ? "signal" : "exit code",
               WIFSIGNALED(outcome) ? WTERMSIG(outcome) : WEXITSTATUS(outcome));
        fflush(stdout);
        told->bit += step;
        failed++;
    }
    runs = (8 * length + step - 1) / step;
    printf("%s: %zu bytes, %zu flips, %zu refused, %zu resumed, %zu failed\n", of->name, length,
           runs, told->refused, told->whole, failed);
    fflush(stdout);
    free(bytes);
    return failed;
}

static bool is_wanted(const char *name, int argc, char **argv) {
    bool wanted = argc < 3;
    for (int i = 2; i < argc; i++)
        wanted = wanted || strcmp(argv[i], name) == 0;
    return wanted;
}

int main(int argc, char **argv) {
    const size_t step = argc > 1 ? strtoul(argv[1], NULL, 10) : 0;
    size_t failed = 0;
    if (step == 0) {
        fputs("flip: found no STEP, expected flip STEP [TARGET...]\n", stderr);
        return EHD_USAGE;
    }
    told = mmap(NULL, sizeof *told, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (told == MAP_FAILED) abort();
    for (size_t i = 0; i < NUM_TARGETS; i++)
        if (is_wanted(targets[i].name, argc, argv)) failed += flip(&targets[i], step);
    return failed > 0;
}
