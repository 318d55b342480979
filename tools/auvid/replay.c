#include "replay.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Converts one row to a sample of the library. */
typedef struct {
    uint64_t t_us;
    auvid_real_t attitude[3], nu[AUVID_DOF_COUNT], wrench[AUVID_DOF_COUNT];
} instant_t;

int replay_inputs(input_kind_t kind)
{
    return kind == INPUT_WRENCH ? CSV_WRENCH : CSV_COMMAND;
}

uint64_t replay_time_us(const csv_log_t *log, size_t row)
{
    double since = log->row[row].value[CSV_T] - log->row[0].value[CSV_T];
    return (uint64_t)(1e6 * since + 0.5) + 1000000u;
}

/* Converts row i. turns: whole revolutions that unwrap each angle so far. */
static void read_instant(const csv_log_t *log, const replay_t *replay, size_t i, double turns[3],
                         instant_t *out)
{
    const double turn = 6.283185307179586;
    const double *value = log->row[i].value;
    out->t_us = replay_time_us(log, i);
    for (int k = 0; k < 3; ++k) {
        double angle = value[CSV_ATTITUDE + k];
        double before = i > 0 ? log->row[i - 1].value[CSV_ATTITUDE + k] : angle;
        turns[k] -= floor((angle - before) / turn + 0.5);
        out->attitude[k] = (auvid_real_t)(angle + turns[k] * turn);
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        double input = value[replay_inputs(replay->kind) + j];
        out->nu[j] = (auvid_real_t)value[CSV_NU + j];
        out->wrench[j] = (auvid_real_t)((replay->dofs >> j & 1u) ? input : 0.0);
    }
}

/* Each DoF that is used as a thruster. */
static void one_per_dof(const replay_t *replay, const auvid_identifier_t *id,
                        auvid_allocation_config_t *cfg)
{
    auvid_allocation_defaults(cfg);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if ((replay->dofs >> j & 1u) != 0) {
            auvid_thruster_t *input = &cfg->thruster[cfg->thrusters++];
            input->wrench[j] = AUVID_C(1.0);
            input->max_N = id->metric.cfg.tau_max[j];
            input->min_N = -input->max_N;
            cfg->dofs = (uint8_t)(cfg->dofs | 1u << j);
        }
    }
}

auvid_status_t replay_attach(const replay_t *replay, replay_inputs_t *inputs,
                             auvid_identifier_t *id)
{
    bool known = replay->thrusters != NULL;
    auvid_uncertain_config_t cfg = {.nominal_lag_s = AUVID_C(0.01)}; /* no errors */
    auvid_allocation_config_t thrusters;
    if (!known && !replay->reference) {
        return AUVID_OK;
    }
    if (known) {
        thrusters = *replay->thrusters->allocation;
        cfg = replay->thrusters->uncertain;
        cfg.fractions = false; /* the allocation gives newtons */
    } else {
        one_per_dof(replay, id, &thrusters);
    }
    auvid_status_t status = auvid_allocation_init(&inputs->allocation, &thrusters);
    if (status >= 0) {
        status =
            auvid_identifier_attach_uncertain(id, &inputs->uncertain, &cfg, &inputs->allocation);
    }
    if (status >= 0 && replay->reference) {
        status = auvid_identifier_attach_instruments(id, &inputs->instruments);
    }
    return status;
}

/* Gives row i's reference. */
static void refer(const csv_log_t *log, size_t i, uint64_t t_us, auvid_instruments_t *instruments)
{
    auvid_real_t reference[AUVID_DOF_COUNT];
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        reference[j] = (auvid_real_t)log->row[i].value[CSV_REFERENCE + j];
    }
    (void)auvid_instruments_reference(instruments, t_us, reference);
}

void replay_identify(const csv_log_t *log, const replay_t *replay, replay_inputs_t *inputs,
                     auvid_identifier_t *id)
{
    bool uncertain = id->attached.uncertain != NULL;
    double turns[3] = {0.0};
    for (size_t i = 0; i < log->rows; ++i) {
        instant_t now;
        auvid_allocation_result_t thrust = {0};
        read_instant(log, replay, i, turns, &now);
        if (uncertain) {
            (void)auvid_allocation_solve(&inputs->allocation, now.wrench, &thrust);
            while (auvid_identifier_work(id, AUVID_DEFAULT_BUDGET) == AUVID_PENDING) {
            }
        }
        if (replay->reference) {
            refer(log, i, now.t_us, &inputs->instruments);
        }
        (void)auvid_identifier_motion(id, now.t_us, now.attitude, now.nu);
        (void)auvid_identifier_applied(id, now.t_us, now.wrench, thrust.force_N);
    }
    (void)auvid_identifier_close(id);
}

/* Makes room for one more cell. */
static bool grow(cells_t *cells, size_t *room)
{
    if (cells->cells == *room) {
        *room = *room == 0 ? 1024 : 2 * *room;
        cell_t *cell = realloc(cells->cell, *room * sizeof *cell);
        if (cell == NULL) {
            return false;
        }
        cells->cell = cell;
    }
    return true;
}

bool replay_record(const csv_log_t *log, const replay_t *replay, const auvid_recorder_config_t *cfg,
                   cells_t *cells)
{
    auvid_recorder_t recorder;
    double turns[3] = {0.0};
    size_t room = 0;
    bool gap = true;
    memset(cells, 0, sizeof *cells);
    (void)auvid_recorder_init(&recorder, cfg);
    for (size_t i = 0; i < log->rows; ++i) {
        instant_t now;
        auvid_status_t status = AUVID_OK;
        read_instant(log, replay, i, turns, &now);
        (void)auvid_recorder_attitude(&recorder, now.t_us, now.attitude, now.nu + AUVID_ROLL);
        (void)auvid_recorder_velocity(&recorder, now.t_us, now.nu, 7u);
        (void)auvid_recorder_input(&recorder, now.t_us, now.wrench, NULL);
        while (status == AUVID_OK || status == AUVID_GAP) {
            if (!grow(cells, &room)) {
                cells_free(cells);
                return false;
            }
            cell_t *cell = &cells->cell[cells->cells];
            status = auvid_recorder_pop(&recorder, &cell->sample);
            gap = gap || status == AUVID_GAP;
            if (status == AUVID_OK) {
                cell->after_gap = gap;
                gap = false;
                ++cells->cells;
            }
        }
    }
    return true;
}

void cells_free(cells_t *cells)
{
    free(cells->cell);
    memset(cells, 0, sizeof *cells);
}
