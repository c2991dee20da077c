/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs a program repeatedly, with a fault at another call each time (inject.c), and checks its
 * behaviour:
 *
 *     sweep [-r] [-e EVERY] [-n KILLS] KIND HOW OUTPUT COMMAND...
 *
 * sweep works in the current folder. The environment variable INJECT is the path of the library.
 * Options:
 *
 *     -r          the command takes --resume
 *     -e EVERY    only every EVERY-th call fails
 *     -n KILLS    kills runs and their continuations at random calls until each run is finished, KILLS
 *                 times in all
 *
 * A run is right in three cases: it behaves as without the fault; or it prints one line, exits with
 * a code that KIND allows (`expected`) and leaves no output; or it was killed. After each run, a
 * file with the name of the output must be complete. If the command is then started again, it must
 * make the same data to the last bit. If an external library made the refused allocation, the
 * process may end in any way. Such ends are counted separately.
 *
 * Prints one line of counts, and a line to stderr for each wrong run. The exit code is 1 if there
 * was a wrong run. */
#include <errno.h>
#include <fcntl.h>
#include <hdf5.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { LIMIT = 60, MAX_ARGUMENTS = 64, TEXT = 4096 }; // LIMIT in s, enough on a busy machine

static const char *kind, *how, *output, *inject;
static bool is_hdf5; // whether the output is HDF5; other files are compared byte by byte
static char **command;
static char *again[MAX_ARGUMENTS], resume_option[] = "--resume";
static char reference[TEXT], partial[TEXT], finishing[TEXT], saved[TEXT], draft[TEXT];

static const struct {
    const char *kind;
    int codes[4]; // exit codes allowed if the fault makes a run fail, with 0 behind them
} expected[] = {{"memory", {71}}, {"open", {66, 73, 74}}, {"read", {74}},       {"write", {73, 74}},
                {"sync", {74}},   {"close", {74}},        {"rename", {73, 74}}, {"map", {74}}};

typedef struct outcome {
    int status; // from waitpid
    bool hung;
    size_t num_lines;
    char text[TEXT]; // on stderr
    bool hit;        // the fault occurred
    long num_calls;
    char library[256]; // library that made the failing call
} outcome;

static _Noreturn void stop(const char *what) {
    perror(what);
    exit(2);
}

// ---- running

static void read_text(char text[TEXT], const char *path) {
    const int file = open(path, O_RDONLY);
    const ssize_t length = file >= 0 ? read(file, text, TEXT - 1) : 0;
    text[length > 0 ? length : 0] = '\0';
    if (file >= 0) close(file);
}

static void redirect(const char *path, int descriptor) {
    const int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (file < 0 || dup2(file, descriptor) < 0) _exit(127);
}

static void child(char **arguments, long call) {
    char at[32];
    snprintf(at, sizeof at, "%ld", call);
    redirect("sweep.out", 1);
    redirect("sweep.err", 2);
    if (call >= 0) {
        setenv("FAULT_KIND", kind, 1);
        setenv("FAULT_HOW", how, 1);
        setenv("FAULT_AT", at, 1);
        setenv("FAULT_LOG", "sweep.log", 1);
        setenv("LD_PRELOAD", inject, 1);
    }
    execvp(arguments[0], arguments);
    _exit(127);
}

static bool wait_for(pid_t process, int *status) {
    const struct timespec pause = {.tv_nsec = 1000000};
    const time_t end = time(NULL) + LIMIT;

    while (waitpid(process, status, WNOHANG) == 0) {
        if (time(NULL) >= end) {
            kill(process, SIGKILL);
            waitpid(process, status, 0);
            return false;
        }
        nanosleep(&pause, NULL);
    }
    return true;
}

static void read_log(outcome *result) {
    char text[TEXT], *rest = text;
    read_text(text, "sweep.log");
    for (char *line; (line = strsep(&rest, "\n"));) {
        sscanf(line, "calls %ld", &result->num_calls);
        if (sscanf(line, "fault %*d %255s", result->library) == 1) result->hit = true;
    }
}

/* Runs the command with the fault at `call`. If `call` is 0, calls are counted without a fault. If
 * `call` is -1, the command runs without the library. */
static outcome run(char **arguments, long call) {
    outcome result = {0};
    const int log = open("sweep.log", O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (log < 0) stop("sweep.log");
    close(log);
    const pid_t process = fork();
    if (process < 0) stop("fork");
    if (process == 0) child(arguments, call);
    result.hung = !wait_for(process, &result.status);
    read_text(result.text, "sweep.err");
    for (const char *c = result.text; *c; c++)
        result.num_lines += *c == '\n';
    read_log(&result);
    return result;
}

// ---- comparing

typedef struct comparison {
    hid_t other;
    size_t count;
    const char *differs;
} comparison;

/* Checks whether the content of a dataset depends on the real clock. */
static bool is_by_the_clock(const char *name) {
    static const char *const names[] = {"restart",          "restart_entries",
                                        "position_seconds", "position_step_seconds",
                                        "round_seconds",    "solve_seconds"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(name, names[i]) == 0) return true;
    return false;
}

static void *read_dataset(size_t *bytes, hid_t file, const char *name) {
    const hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
    const hid_t type = H5Dget_type(set), space = H5Dget_space(set);
    *bytes = (size_t)H5Sget_simple_extent_npoints(space) * H5Tget_size(type);
    void *data = malloc(*bytes + 1);
    if (set < 0 || !data || H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0) {
        free(data);
        data = NULL;
    }
    H5Sclose(space);
    H5Tclose(type);
    H5Dclose(set);
    return data;
}

/* Compares two property lists and closes them. The lists hold fill value, filters, chunks and
 * allocation time of a dataset, or the paging of a file. */
static bool same_properties(hid_t left, hid_t right) {
    const bool same = H5Pequal(left, right) > 0;
    H5Pclose(left);
    H5Pclose(right);
    return same;
}

static bool made_alike(hid_t left_file, hid_t right_file, const char *name) {
    const hid_t left = H5Dopen2(left_file, name, H5P_DEFAULT);
    const hid_t right = H5Dopen2(right_file, name, H5P_DEFAULT);
    const bool same = same_properties(H5Dget_create_plist(left), H5Dget_create_plist(right));
    H5Dclose(left);
    H5Dclose(right);
    return same;
}

static herr_t compare_one(hid_t file, const char *name, const H5L_info_t *info, void *data) {
    comparison *self = data;
    size_t left_bytes, right_bytes;
    (void)info;
    self->count++;
    if (is_by_the_clock(name)) return 0;
    if (H5Lexists(self->other, name, H5P_DEFAULT) <= 0) {
        self->differs = "a dataset is missing";
        return 1;
    }
    void *left = read_dataset(&left_bytes, file, name);
    void *right = read_dataset(&right_bytes, self->other, name);
    if (!left || !right)
        self->differs = "a dataset is damaged";
    else if (left_bytes != right_bytes || memcmp(left, right, left_bytes) != 0)
        self->differs = "data differ";
    else if (!made_alike(file, self->other, name))
        self->differs = "a dataset is made otherwise";
    free(left);
    free(right);
    return self->differs ? 1 : 0;
}

/* Compares output and reference byte by byte; returns NULL if they are equal. */
static const char *difference_of_bytes(void) {
    FILE *left = fopen(reference, "rb"), *right = fopen(output, "rb");
    int byte = 0;
    bool same = left && right;

    while (same && byte != EOF) {
        byte = getc(left);
        same = byte == getc(right);
    }
    if (left) fclose(left);
    if (right) fclose(right);
    return same ? NULL : "bytes differ";
}

/* Compares the data of output and reference. Returns NULL if the data are equal, otherwise the
 * difference. */
static const char *difference(void) {
    if (!is_hdf5) return difference_of_bytes();
    H5G_info_t info = {.nlinks = 0};
    const hid_t left = H5Fopen(reference, H5F_ACC_RDONLY, H5P_DEFAULT);
    const hid_t right = H5Fopen(output, H5F_ACC_RDONLY, H5P_DEFAULT);
    comparison self = {.other = right, .differs = left < 0 || right < 0 ? "no whole file" : NULL};
    int64_t complete = 0;

    if (!self.differs) {
        const hid_t attribute = H5Aopen(right, "complete", H5P_DEFAULT);
        H5Aread(attribute, H5T_NATIVE_INT64, &complete);
        H5Aclose(attribute);
        if (complete != 1) self.differs = "not marked complete";
    }
    if (!self.differs && !same_properties(H5Fget_create_plist(left), H5Fget_create_plist(right)))
        self.differs = "the file is made otherwise";
    if (!self.differs) H5Literate(left, H5_INDEX_NAME, H5_ITER_INC, NULL, compare_one, &self);
    if (!self.differs) H5Gget_info(right, &info);
    if (!self.differs && info.nlinks != self.count) self.differs = "more datasets";
    if (left >= 0) H5Fclose(left);
    if (right >= 0) H5Fclose(right);
    return self.differs;
}

// ---- judging

static bool exists(const char *path) {
    struct stat about;
    return stat(path, &about) == 0;
}

static bool ends_as_expected(int code) {
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++)
        for (size_t c = 0; strcmp(expected[i].kind, kind) == 0 && expected[i].codes[c]; c++)
            if (expected[i].codes[c] == code) return true;
    return false;
}

static bool is_foreign(const char *library) {
    static const char *const ours[] = {"libc.", "libyaml", "libnettle", "libpthread"};
    for (size_t i = 0; i < sizeof ours / sizeof *ours; i++)
        if (strncmp(library, ours[i], strlen(ours[i])) == 0) return false;
    return strncmp(library, "lib", 3) == 0;
}

/* Returns NULL if the process ended as it should, else the error. */
static const char *fault_of_end(const outcome *found, const outcome *without) {
    const bool deadly =
        strcmp(how, "kill") == 0 || strcmp(how, "tear") == 0 || strcmp(how, "power") == 0;
    const char *slash = strrchr(command[0], '/'), *name = slash ? slash + 1 : command[0];

    if (found->hung) return "it hangs";
    if (WIFSIGNALED(found->status))
        return deadly && WTERMSIG(found->status) == SIGKILL ? NULL : "it crashed";
    // a failing rename or unlink may leave the draft, OUTPUT.unchecked
    if (exists(draft) && strcmp(kind, "rename") != 0) return "left a draft";
    if (found->status == without->status && strcmp(found->text, without->text) == 0)
        return exists(output) ? NULL : "no output";
    if (!ends_as_expected(WEXITSTATUS(found->status))) return "another exit code";
    if (found->num_lines != 1) return "not one line";
    if (strncmp(found->text, name, strlen(name)) != 0 || found->text[strlen(name)] != ':')
        return "not led by its name";
    return exists(output) ? "it failed, but its output is there" : NULL;
}

/* If the command left a partial file and no output, starts the command again. Returns NULL if the
 * output has the data of a run without a fault, else the error. */
static const char *fault_of_recovery(const outcome *without) {
    const bool was_there = exists(output), left = exists(partial) || exists(finishing);
    const char *wrong = was_there ? difference() : NULL;

    if (wrong) return wrong;
    if (!was_there && left) {
        const outcome resumed = run(again, is_hdf5 ? -1 : 0);
        if (resumed.hung || resumed.status != without->status) {
            fprintf(stderr, "    started again: status %x, %.*s\n", (unsigned)resumed.status,
                    (int)strcspn(resumed.text, "\n"), resumed.text);
            return "not to be continued";
        }
        wrong = difference();
        if (!wrong && (exists(partial) || exists(finishing) || exists(saved)))
            wrong = "left a partial file";
    }
    return wrong;
}

/* Returns a pseudo-random number below `bound`, equal in each run (Knuth, The Art of Computer
 * Programming 2, 3.3.4). */
static long random_below(long bound) {
    static uint64_t state = 17;
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (long)((state >> 33) % (uint64_t)bound);
}

static void clean(void) {
    unlink(output);
    unlink(partial);
    unlink(finishing);
    unlink(saved);
    unlink(draft);
}

/* Sets the time of a file to 1970, so that the file seems older than the machine's start. */
static void let_be_of_long_ago(const char *path) {
    const struct timespec times[2] = {{.tv_sec = 0}, {.tv_sec = 0}};
    utimensat(AT_FDCWD, path, times, 0);
}

static void name_files(void) {
    snprintf(reference, sizeof reference, "reference-%s", output);
    snprintf(partial, sizeof partial, "%s.partial", output);
    snprintf(finishing, sizeof finishing, "%s.finishing", output);
    snprintf(saved, sizeof saved, "%s.saved", output);
    snprintf(draft, sizeof draft, "%s.unchecked", output);
}

/* Kills runs and their continuations `kills` times; returns 1 if a run was wrong. */
static int kill_often(long kills, const outcome *without) {
    long num_kills = 0, num_runs = 0, num_wrong = 0;

    while (num_kills < kills) {
        const char *wrong = NULL;
        outcome found;
        clean();
        for (char **arguments = command;; arguments = again) {
            found = run(arguments, 1 + random_below(2 * without->num_calls));
            if (found.hung || !WIFSIGNALED(found.status)) break;
            num_kills++;
            // killed after the output got its final name
            if (exists(output)) break;
        }
        if (found.hung)
            wrong = "it hangs";
        else if (!WIFSIGNALED(found.status) && found.status != without->status)
            wrong = "not to be continued";
        if (!wrong) wrong = difference();
        num_runs++;
        num_wrong += wrong != NULL;
        if (wrong)
            fprintf(stderr, "%s %s, run %ld: %s: status %x, %.*s\n", kind, how, num_runs, wrong,
                    (unsigned)found.status, (int)strcspn(found.text, "\n"), found.text);
    }
    clean();
    printf("%-7s %-5s %6ld kills of %ld runs, %ld wrong  %s\n", kind, how, num_kills, num_runs,
           num_wrong, command[0]);
    return num_wrong > 0;
}

int main(int argc, char **argv) {
    bool resumes = false;
    long every = 1, kills = 0;
    int option;

    while ((option = getopt(argc, argv, "+re:n:")) != -1) {
        if (option == 'r') resumes = true;
        if (option == 'e') every = strtol(optarg, NULL, 10);
        if (option == 'n') kills = strtol(optarg, NULL, 10);
    }
    inject = getenv("INJECT");
    if (argc - optind < 4 || argc - optind + 2 > MAX_ARGUMENTS || !inject || every < 1) {
        fputs("usage: INJECT=LIBRARY sweep [-r] [-e EVERY] [-n KILLS] KIND HOW OUTPUT COMMAND...\n",
              stderr);
        return 64;
    }
    kind = argv[optind];
    how = argv[optind + 1];
    output = argv[optind + 2];
    command = argv + optind + 3;
    int count = 0;
    for (; command[count]; count++)
        again[count] = command[count];
    if (resumes) again[count] = resume_option;
    name_files();
    setenv("HDF5_USE_FILE_LOCKING", "FALSE", 1);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);

    clean();
    const outcome without = run(command, 0);
    if (WIFSIGNALED(without.status) || rename(output, reference) != 0) stop("without a fault");
    is_hdf5 = H5Fis_hdf5(reference) > 0;

    if (kills > 0) return kill_often(kills, &without);
    long num_right = 0, num_foreign = 0, num_wrong = 0, num_done = 0, num_refused = 0;
    for (long call = 1; call <= without.num_calls; call += every) {
        clean();
        const outcome found = run(command, call);
        if (!found.hit) break; // this run has fewer calls than the run without the fault
        if (strcmp(how, "power") == 0) let_be_of_long_ago(partial);
        const char *end = fault_of_end(&found, &without), *after = fault_of_recovery(&without);
        const bool foreign = strcmp(kind, "memory") == 0 && end && !after &&
                             is_foreign(found.library) && !found.hung &&
                             (exists(output) ? difference() == NULL : true);
        num_done++;
        num_refused += found.status != without.status;
        num_foreign += foreign;
        num_right += !end && !after;
        if ((end || after) && !foreign) num_wrong++;
        if (((end || after) && !foreign) || (foreign && getenv("SHOW_FOREIGN")))
            fprintf(stderr, "%s %s %ld of %ld (%s): %s%s%s: status %x, %.*s\n", kind, how, call,
                    without.num_calls, found.library, end ? end : "", end && after ? "; " : "",
                    after ? after : "", (unsigned)found.status, (int)strcspn(found.text, "\n"),
                    found.text);
    }
    clean();
    unlink(reference);
    printf("%-7s %-5s %6ld injected %6ld failed %6ld right %5ld foreign ends %4ld wrong  %s\n",
           kind, how, num_done, num_refused, num_right, num_foreign, num_wrong, command[0]);
    return num_wrong > 0 || num_done == 0;
}
