/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/output/plot.h"

#include "common/program/output_file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

enum { MOST_COLUMNS = 2, LINE = 512 };

/* Finds the script beside the build or the installation that the program belongs to. */
static ehd_status find_script(char script[PATH_MAX], ehd_error *error) {
    static const char *const places[] = {"../share/ehdrom/lib/plot.py",
                                         "../../../scenes/lib/plot.py"};
    char self[PATH_MAX];
    const ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);

    self[length > 0 ? length : 0] = '\0';
    char *slash = strrchr(self, '/');
    if (slash) *slash = '\0';
    for (size_t i = 0; i < sizeof places / sizeof *places; i++)
        if (snprintf(script, PATH_MAX, "%s/%s", self, places[i]) < PATH_MAX &&
            access(script, R_OK) == 0)
            return EHD_OK;
    return ehd_fail(error, EHD_UNAVAILABLE,
                    "--plot: found no plot.py beside %s, expected it where ehdrom is built or "
                    "installed",
                    self);
}

/* Returns the format that the name of the output ends with, or NULL. */
static const char *format_of(const char *output) {
    static const char *const formats[] = {"png", "svg", "pdf"};
    const char *dot = strrchr(output, '.');

    for (size_t i = 0; dot && i < sizeof formats / sizeof *formats; i++)
        if (strcmp(dot + 1, formats[i]) == 0) return formats[i];
    return NULL;
}

/* Reads the last line that the script writes to the pipe, without its end. A longer line is cut. */
static void read_line(char line[LINE], int from) {
    FILE *stream = fdopen(from, "r");
    char *next = NULL;
    size_t room = 0;

    *line = '\0';
    if (!stream) {
        close(from);
        return;
    }
    while (getline(&next, &room, stream) > 0)
        if (*next != '\n') snprintf(line, LINE, "%.*s", (int)strcspn(next, "\n"), next);
    free(next);
    fclose(stream);
}

/* Runs a command that writes to `picture`. Returns the status that its exit code stands for. */
static ehd_status run(char *const command[], FILE *picture, const char *path, ehd_error *error) {
    posix_spawn_file_actions_t actions;
    int ends[2], outcome = 0;
    char line[LINE];
    pid_t process;

    if (pipe2(ends, O_CLOEXEC)) return ehd_fail(error, EHD_IO, "--plot: cannot create a pipe");
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, fileno(picture), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
    const int failure = posix_spawnp(&process, command[0], &actions, NULL, command, environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    read_line(line, ends[0]);
    if (failure)
        return ehd_fail(error, EHD_UNAVAILABLE, "--plot: cannot run %s: %s", command[0],
                        strerror(failure));
    while (waitpid(process, &outcome, 0) < 0 && errno == EINTR)
        ;
    if (!WIFEXITED(outcome))
        return ehd_fail(error, EHD_INTERNAL, "%s: the script of --plot was ended", path);
    const int code = WEXITSTATUS(outcome);
    if (code == 0) return EHD_OK;
    const bool known = code == EHD_DATA || code == EHD_NOINPUT || code == EHD_UNAVAILABLE;
    return ehd_fail(error, known ? (ehd_status)code : EHD_INTERNAL, "%s: %s", path, line);
}

ehd_status output_plot(const program *caller, ehd_error *error) {
    const char *const inputs[] = {caller->plot, NULL}, *format = format_of(caller->output);
    char script[PATH_MAX];
    output_file out;

    if (!format)
        return ehd_fail(error, EHD_USAGE, "%s: found another ending, expected .png, .svg or .pdf",
                        caller->output);
    if (caller->num_arguments != 0 && caller->num_arguments != MOST_COLUMNS)
        return ehd_fail(error, EHD_USAGE,
                        "--plot: found %zu columns, expected none, or two of a table",
                        caller->num_arguments);
    if (access(caller->plot, R_OK) != 0)
        return ehd_fail(error, EHD_NOINPUT, "%s: found nothing (%s), expected a readable file",
                        caller->plot, strerror(errno));
    ehd_status status = output_file_check_inputs(caller->output, inputs, error);
    if (!status) status = find_script(script, error);
    if (!status) status = output_file_create(&out, caller->output, caller->force, error);
    if (status) return status;
    const bool columns = caller->num_arguments > 0;
    char *command[] = {(char *)"python3",
                       (char *)"-B", // leaves no compiled files beside the script
                       script,
                       (char *)format,
                       (char *)caller->plot,
                       columns ? (char *)caller->arguments[0] : NULL,
                       columns ? (char *)caller->arguments[1] : NULL,
                       NULL};
    status = run(command, out.stream, caller->plot, error);
    // Debian's packages belong to the Python of Debian, which may be hidden by another one in PATH
    command[0] = (char *)"/usr/bin/python3";
    if (status == EHD_UNAVAILABLE && access(command[0], X_OK) == 0)
        status = run(command, out.stream, caller->plot, error);
    if (!status) return output_file_finish(&out, error);
    output_file_drop(&out);
    return status;
}
