/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "romrun/calibrate/recording.h"

#include "common/training/pool.h"
#include "fullrun/full_march.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct recorder {
    const program *caller;
    const training_set *set;
    recording *recordings; // [num_trajectories]
    size_t num_done;
    progress progress;
} recorder;

/* The march of one trajectory. */
typedef struct trajectory_run {
    recording *target;
    march march;
} trajectory_run;

void recording_free(recording *self) {
    free(self->steps);
    *self = (recording){0};
}

// ---- one trajectory

static ehd_status store_step(void *sink, const march_step *step, size_t index, ehd_error *error) {
    trajectory_run *self = sink;
    recording *target = self->target;

    if (target->num_steps == target->room) {
        size_t room = 2 * target->room + 64;
        recorded_step *steps = realloc(target->steps, room * sizeof *steps);
        if (!steps) return ehd_no_memory(error, "trajectory");
        target->steps = steps;
        target->room = room;
    }
    target->steps[target->num_steps++] = (recorded_step){
        .frame = step->frame,
        .load_frame = isnan(step->frame.approach) ? step->frame
                                                  : frame_of_load(target->reference->kind,
                                                                  &step->frame, step->scalars.load),
        .step = step->step,
        // the march resets the forecast at a jump, so last_step is then 0
        .jump = index > 0 && self->march.state.forecast.last_step == 0,
        .scalars = frame_to_reference(&step->scalars, &step->frame, target->reference)};
    return EHD_OK;
}

static ehd_status record_trajectory(void *shared, void *worker, size_t number, size_t parent,
                                    ehd_error *error) {
    recorder *owner = shared;
    const trajectory_scene *given = &owner->set->trajectories[number];
    full_settings settings = full_default_settings();
    full_march *full = NULL;
    trajectory_run self = {.target = &owner->recordings[number]};
    (void)worker, (void)parent;

    settings.tolerance = 1e-12; // tolerance of the solutions that models are trained on
    self.target->reference = &given->contact;
    ehd_status status = full_march_create(&full, &given->contact, &settings,
                                          given->scene.transient.start_film, error);
    if (status) return status;
    self.march = (march){
        .reference = &given->contact,
        .histories = given->histories,
        .settings = march_settings_of(&given->scene, given->histories, given->scene.approach),
        .solver = full_march_solver(full),
        .store = store_step,
        .sink = &self};
    status = march_whole(self.target->reason, &self.march, error);
    full_march_free(full);
    return status;
}

static ehd_status finish_trajectory(void *shared, void *worker, size_t number, size_t parent,
                                    ehd_error *error) {
    recorder *owner = shared;
    const recording *done = &owner->recordings[number];
    char name[POINT_NAME];
    (void)worker, (void)parent, (void)error;

    training_point_name(name, done->reference);
    if (done->reason[0])
        program_warn(owner->caller, "trajectory %zu (%s): not converged: %s", number + 1, name,
                     done->reason);
    progress_show(&owner->progress, ++owner->num_done, name);
    return EHD_OK;
}

// ---- all

ehd_status recordings_make(recording *recordings, const program *caller, const training_set *set,
                           size_t num_workers, ehd_error *error) {
    size_t num = set->num_trajectories;
    recorder self = {.caller = caller, .set = set, .recordings = recordings};
    const pool_work work = {.num_points = num,
                            .num_workers = num_workers,
                            .shared = &self,
                            .solve = record_trajectory,
                            .finish = finish_trajectory};

    if (num == 0) return EHD_OK;
    progress_start(&self.progress, caller, num);
    self.progress.rest = NAN;
    const ehd_status status = pool_run(&work, error);
    progress_finish(&self.progress);
    return status;
}

const char *recording_check(const recording *self, const trained_range *range) {
    for (size_t i = 0; i < self->num_steps; i++) {
        const contact_frame *now = &self->steps[i].load_frame;
        ehd_contact contact;
        frame_contact(&contact, now, self->reference);
        const bool jumped = i == 0 || self->steps[i - 1].jump;
        frame_rates rates = {0};
        if (!jumped) rates = frame_rates_between(now, &self->steps[i - 1].load_frame);
        const char *reason =
            trained_range_check(range, NULL, contact_place_of_any(&contact), &rates);
        if (reason) return reason;
    }
    return NULL;
}
