#include "replay.h"

#include <math.h>

#include "../log/log_shift.h"

/* A vehicle without thrust that does not move for so long is parked: it stands, or floats, and what
 * holds it is no force of the model. (W-B would become smaller with each minute of it.) */
#define PARKED_US 3000000u
#define PARKED_MPS 0.03
#define PARKED_RADPS 0.03

/* Each DoF that is used as a thruster. */
static void one_per_dof(const log_use_t *use, const auvid_identifier_t *id,
                        auvid_allocation_config_t *cfg)
{
    auvid_allocation_defaults(cfg);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if ((use->dofs >> j & 1u) != 0) {
            auvid_thruster_t *input = &cfg->thruster[cfg->thrusters++];
            input->wrench[j] = AUVID_C(1.0);
            input->max_N = id->metric.cfg.tau_max[j];
            input->min_N = -input->max_N;
            cfg->dofs = (uint8_t)(cfg->dofs | 1u << j);
        }
    }
}

auvid_status_t replay_attach(const log_use_t *use, replay_inputs_t *inputs, auvid_identifier_t *id)
{
    bool known = use->uncertain;
    auvid_uncertain_config_t cfg = {.nominal_lag_s = AUVID_C(0.01)}; /* no errors */
    auvid_allocation_config_t thrusters;
    if (!known && !use->reference) {
        return AUVID_OK;
    }
    if (known) {
        thrusters = *use->vehicle->allocation;
        cfg = use->vehicle->uncertain;
        cfg.fractions = false; /* the allocation gives newtons */
    } else {
        one_per_dof(use, id, &thrusters);
    }
    auvid_status_t status = auvid_allocation_init(&inputs->allocation, &thrusters);
    if (status >= 0) {
        status =
            auvid_identifier_attach_uncertain(id, &inputs->uncertain, &cfg, &inputs->allocation);
    }
    if (status >= 0 && use->reference) {
        status = auvid_identifier_attach_instruments(id, &inputs->instruments);
    }
    return status;
}

/* Who takes the samples. */
typedef struct {
    const log_set_t *logs;
    const log_use_t *use;
    void (*take)(void *context, const log_sample_t *now);
    void *context;
    uint64_t moved_us; /* when the vehicle last had thrust or moved; 0: not yet known */
} taker_t;

static bool is_parked(taker_t *to, const log_sample_t *now)
{
    bool moves = to->moved_us == 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        moves = moves || fabs((double)now->wrench[j]) > 0.0 ||
                fabs((double)now->nu[j]) > (j < AUVID_ROLL ? PARKED_MPS : PARKED_RADPS);
    }
    to->moved_us = moves ? now->t_us : to->moved_us;
    return now->t_us > to->moved_us + PARKED_US;
}

/* Passes on a sample; its known force is in the model. */
static void pass(taker_t *to, const log_sample_t *now)
{
    if (!log_set_has(to->logs, now->t_us) || is_parked(to, now)) {
        return;
    }
    if (to->use->calibrated != NULL && now->has_known) {
        (void)auvid_calibrated_force(to->use->calibrated, now->t_us, &now->known);
    }
    to->take(to->context, now);
}

/* Passes on the samples of a log in the order of time. */
static int read_log(log_t *log, taker_t *to)
{
    log_reader_t reader;
    log_shift_t shift = {0};
    log_sample_t now, late;
    int status = log_reader_begin(&reader, log, to->use);
    while (status == 0 && (status = log_reader_next(&reader, &now)) == 0) {
        uint64_t t_us = log->shift_us < 0 ? now.input_us : now.t_us;
        status = log->shift_us != 0 ? log_shift_split(&shift, log->shift_us, &now) : 0;
        while (log_shift_due(&shift, t_us, &late)) {
            pass(to, &late);
        }
        pass(to, &now);
    }
    log_shift_end(&shift);
    return status == CSV_END ? 0 : status;
}

/* Takes the samples of all logs. */
static int each_sample(const log_set_t *logs, const log_use_t *use,
                       void (*take)(void *context, const log_sample_t *now), void *context)
{
    taker_t to = {logs, use, take, context, 0};
    int status = 0;
    auvid_calibrated_clear(use->calibrated);
    for (int i = 0; i < logs->logs && status == 0; ++i) {
        status = read_log(&logs->log[i], &to);
    }
    return status;
}

/* When a stream that must not be interpolated for as long as the velocities had its last row. */
typedef struct {
    uint64_t attitude_us, input_us;
} rows_t;

/* Ends the record at a gap in the rows of a stream. Velocities may be further apart than rows: they
 * are linear between samples, but an input that is held for as long is another one. (Masses were
 * 15 % too small in logs of a simulator with gaps of 0.8 s that were bridged.) */
static void break_at_gap(const log_use_t *use, auvid_recorder_t *recorder, uint64_t t_us,
                         uint64_t *last_us)
{
    uint32_t gap_us = use->gap_us > recorder->cell_us ? use->gap_us : recorder->cell_us;
    if (use->gap_us > 0 && *last_us > 0 && t_us - *last_us > gap_us) {
        auvid_recorder_break(recorder);
    }
    *last_us = t_us;
}

/* An identifier, and what it needs of a sample. */
typedef struct {
    const log_use_t *use;
    replay_inputs_t *inputs;
    bool works;
    auvid_identifier_t *id;
    rows_t last;
} feed_t;

void replay_note_change(replay_inputs_t *inputs, const auvid_identifier_t *id, uint64_t t_us)
{
    const auvid_change_test_t *test = &id->change_test;
    if (id->metric.sets.recorded != inputs->sets) {
        inputs->sets = id->metric.sets.recorded;
        inputs->set_us[0] = inputs->set_us[1];
        inputs->set_us[1] = t_us;
    }
    if (test->changed != 0 && test->set != inputs->changed_set) {
        inputs->changed_set = test->set;
        inputs->changed_us = inputs->set_us[0];
    }
}

/* Feeds the samples of a row. */
static void feed(void *context, const log_sample_t *now)
{
    feed_t *f = context;
    auvid_identifier_t *id = f->id;
    auvid_allocation_result_t thrust = {0};
    bool has_thrusters = log_has_thrusters(f->use);
    if (id->attached.uncertain != NULL && !has_thrusters) {
        (void)auvid_allocation_solve(&f->inputs->allocation, now->wrench, &thrust);
    }
    while (f->works && auvid_identifier_work(id, AUVID_DEFAULT_BUDGET) == AUVID_PENDING) {
    }
    replay_note_change(f->inputs, id, now->t_us);
    if (now->has_reference) {
        (void)auvid_instruments_reference(&f->inputs->instruments, now->t_us, now->reference);
    }
    if (now->has_attitude) {
        break_at_gap(f->use, &id->recorder, now->t_us, &f->last.attitude_us);
        (void)auvid_identifier_attitude(id, now->t_us, now->attitude, now->nu + AUVID_ROLL);
    }
    if (now->velocity != 0) {
        (void)auvid_identifier_velocity(id, now->t_us, now->nu, now->velocity);
    }
    if (now->has_input) {
        break_at_gap(f->use, &id->recorder, now->input_us, &f->last.input_us);
        (void)auvid_identifier_applied(id, now->input_us, now->wrench,
                                       has_thrusters ? now->force_N : thrust.force_N);
    }
}

int replay_identify(const log_set_t *logs, const log_use_t *use, replay_inputs_t *inputs,
                    bool works, auvid_identifier_t *id)
{
    inputs->set_us[0] = inputs->set_us[1] = inputs->changed_us = 0;
    inputs->sets = inputs->changed_set = 0;
    int status = each_sample(logs, use, feed, &(feed_t){use, inputs, works, id, {0, 0}});
    (void)auvid_identifier_close(id);
    return status;
}

/* A recorder, and who takes its cells. */
typedef struct {
    auvid_recorder_t recorder;
    replay_take_t *take;
    void *context;
    bool gap;
    const log_use_t *use;
    rows_t last;
} cells_t;

/* Records a sample and passes on the cells that it completes. */
static void record(void *context, const log_sample_t *now)
{
    cells_t *c = context;
    auvid_sample_t cell;
    auvid_status_t status = AUVID_OK;
    if (now->has_attitude) {
        break_at_gap(c->use, &c->recorder, now->t_us, &c->last.attitude_us);
        (void)auvid_recorder_attitude(&c->recorder, now->t_us, now->attitude, now->nu + AUVID_ROLL);
    }
    if (now->velocity != 0) {
        (void)auvid_recorder_velocity(&c->recorder, now->t_us, now->nu, now->velocity);
    }
    if (now->has_input) {
        break_at_gap(c->use, &c->recorder, now->input_us, &c->last.input_us);
        (void)auvid_recorder_input(&c->recorder, now->input_us, now->wrench, NULL);
    }
    while (status == AUVID_OK || status == AUVID_GAP) {
        status = auvid_recorder_pop(&c->recorder, &cell);
        c->gap = c->gap || status == AUVID_GAP;
        if (status == AUVID_OK) {
            c->take(c->context, &cell, c->gap);
            c->gap = false;
        }
    }
}

int replay_cells(const log_set_t *logs, const log_use_t *use, const auvid_recorder_config_t *cfg,
                 replay_take_t *take, void *context)
{
    cells_t cells = {.take = take, .context = context, .gap = true, .use = use};
    (void)auvid_recorder_init(&cells.recorder, cfg);
    return each_sample(logs, use, record, &cells);
}
