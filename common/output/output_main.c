/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "common/output/output_main.h"

#include "common/output/check.h"
#include "common/output/describe.h"
#include "common/output/plot.h"
#include "common/output/print.h"
#include "common/output/vtk.h"
#include "common/settings/part_list.h"

int output_main(int argc, char **argv, const program_options *options,
                ehd_status run(const program *self, void *own, ehd_error *error),
                ehd_status check(const char *path, ehd_error *error),
                ehd_status describe(const char *path, ehd_error *error)) {
    ehd_error error = {""};
    ehd_status status;
    program self;

    program_start(&self, argc, argv, options);
    if (self.check)
        status = check ? check(self.check, &error) : output_check(self.check, NULL, &error);
    else if (self.describe)
        status = describe && !part_list_is(self.describe) ? describe(self.describe, &error)
                                                          : scene_describe(&self, &error);
    else if (self.print)
        status = output_print(&self, &error);
    else if (self.plot)
        status = output_plot(&self, &error);
    else if (self.vtk)
        status = output_vtk(&self, &error);
    else
        status = run(&self, options->own, &error);
    return program_finish(&self, status, &error);
}
