/*
 * Thrusters: the model, its log and its connection to the identifier. auvid_thrusters_wrench.c
 * computes a candidate's wrench from the log.
 *
 * The log is a ring of slots of equal length, each with the mean command of each thruster. Slots
 * have no timestamps: the newest complete one ends at end_us, and a list contains the intervals
 * that the log skips.
 */
#include "auvid/thrusters.h"

#include <string.h>

#include "auvid/identifier.h"
#include "../base/auvid_math_internal.h"
#include "../base/auvid_refusal_internal.h"
#include "../metric/auvid_metric_sets_internal.h"
#include "../models/auvid_thrusters_wrench_internal.h"
#include "../models/auvid_vehicle_internal.h"

/* Length of the lead-in before a row, in longest lags. An initial error decays to e^-3 of its
 * value, and contributes a third of that to the row's mean. */
#define LEAD_LAGS AUVID_C(3.0)

/* The recorder's largest delay behind the newest command; the part of a set's begin that the log
 * may lack. */
enum { BEHIND_US = 3000000, SLACK_US = 1000000 };

/* Period of the velocity samples, unless it is given: a DVL at 5 Hz. */
enum { DVL_US = 200000 };

void auvid_thrusters_defaults(auvid_thrusters_config_t *cfg)
{
    if (cfg != NULL) {
        *cfg = (auvid_thrusters_config_t){.command_max = AUVID_C(1.0),
                                          .gain_max = AUVID_C(1000.0),
                                          .dead_band_max = AUVID_C(0.5),
                                          .lag_max_s = AUVID_C(0.5),
                                          .period_us = 20000};
        for (int g = 0; g < AUVID_THRUSTERS_GROUPS; ++g) {
            cfg->sheet[g] = (auvid_thrusters_sheet_t){.backward = AUVID_C(1.0),
                                                      .lag_s = AUVID_C(0.15),
                                                      .gain_sigma = AUVID_C(0.05),
                                                      .backward_sigma = AUVID_C(0.05),
                                                      .dead_band_sigma = AUVID_C(0.012),
                                                      .lag_sigma_s = AUVID_C(0.06)};
        }
    }
}

/* Check a standard deviation; 0: there is none. */
static void thrusters_check_sigma(auvid_refusal_t *why, const char *field, auvid_real_t sigma)
{
    bool none = auvid_abs(sigma) <= AUVID_C(0.0);
    auvid_check_in(why, field, none ? AUVID_C(1.0) : sigma, AUVID_C(1e-4), AUVID_C(1.0));
}

/* Check what the data sheet says of a group. */
static void thrusters_check_sheet(const auvid_thrusters_config_t *cfg, int group,
                                  auvid_refusal_t *why)
{
    const auvid_thrusters_sheet_t *sheet = &cfg->sheet[group];
    auvid_check_element(why, group);
    auvid_check_in(why, "gain", sheet->gain, AUVID_C(0.0), cfg->gain_max);
    auvid_check_in(why, "backward", sheet->backward, AUVID_C(0.0), AUVID_C(100.0));
    auvid_check_in(why, "dead_band", sheet->dead_band, AUVID_C(0.0), cfg->dead_band_max);
    auvid_check_in(why, "lag_s", sheet->lag_s, AUVID_C(0.0), AUVID_C(2.0));
    thrusters_check_sigma(why, "gain_sigma", sheet->gain_sigma);
    thrusters_check_sigma(why, "backward_sigma", sheet->backward_sigma);
    thrusters_check_sigma(why, "dead_band_sigma", sheet->dead_band_sigma);
    thrusters_check_sigma(why, "lag_sigma_s", sheet->lag_sigma_s);
}

/* Check all but the groups. */
static void thrusters_check(const auvid_thrusters_config_t *cfg, auvid_refusal_t *why)
{
#define SIZE_OF(name)                                                                              \
    REALS_IN(auvid_thrusters_config_t, name, 1, AUVID_C(1e-6), AUVID_RECORDER_LARGEST)
    static const auvid_field_t field[] = {
        REALS_IN(auvid_thrusters_config_t, matrix, AUVID_DOF_COUNT * AUVID_COMMAND_SLOTS,
                 -AUVID_LARGEST, AUVID_LARGEST),
        SIZE_OF(command_max),
        SIZE_OF(gain_max),
        SIZE_OF(dead_band_max),
        REALS_IN(auvid_thrusters_config_t, lag_max_s, 1, AUVID_C(0.01), AUVID_C(2.0)),
        WHOLE_IN(auvid_thrusters_config_t, thrusters, 1, 1, AUVID_MAX_COMMANDS),
        WHOLE_IN(auvid_thrusters_config_t, delay_us, 1, 0, 1000000),
        WHOLE_IN(auvid_thrusters_config_t, period_us, 1, 1000, 100000)};
    auvid_check_that(why, cfg->log != NULL, AUVID_ERR_NULL, "log");
    auvid_check_part(why, "hull");
    auvid_vehicle_check_fields(cfg->hull, why);
    auvid_check_part(why, "");
    AUVID_CHECK_TABLE(why, cfg, field);
    auvid_check_count(why, AUVID_ERR_RANGE, "slots", cfg->slots,
                      UINT32_C(4000000000) / (cfg->period_us > 0 ? cfg->period_us : 1));
    auvid_check_part(why, "sheet");
    for (int g = 0; g < AUVID_THRUSTERS_GROUPS; ++g) {
        thrusters_check_sheet(cfg, g, why);
    }
    auvid_check_part(why, "");
}

/* Returns the number of groups; 0 if their numbers have gaps or are too large. */
static int thrusters_count_groups(const auvid_thrusters_config_t *cfg)
{
    _Static_assert(AUVID_THRUSTERS_GROUPS < 32, "a bit of `used` for each group");
    uint32_t used = 0;
    for (int i = 0; i < cfg->thrusters; ++i) {
        used |= cfg->group[i] < AUVID_THRUSTERS_GROUPS ? 1u << cfg->group[i] : ~UINT32_C(0);
    }
    int groups = 0;
    for (; used & 1u; used >>= 1) {
        ++groups;
    }
    return used == 0 && groups <= AUVID_THRUSTERS_GROUPS ? groups : 0;
}

/* Returns the DoF of the hull on which a group acts: bit j for DoF j. */
static uint32_t thrusters_dofs_of_group(const auvid_thrusters_config_t *cfg, int group)
{
    uint32_t dofs = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        for (int i = 0; i < cfg->thrusters; ++i) {
            bool acts = cfg->group[i] == group && auvid_abs(cfg->matrix[j][i]) > AUVID_C(0.0);
            dofs |= (uint32_t)(acts && cfg->hull->columns[j] != 0) << j;
        }
    }
    return dofs;
}

/* Check the groups of a configuration that is valid otherwise. */
static void thrusters_check_groups(const auvid_thrusters_config_t *cfg, int groups,
                                   auvid_refusal_t *why)
{
    int n = cfg->hull->parameters + groups * AUVID_THRUSTERS_PER_GROUP;
    auvid_check_that(why, groups > 0, AUVID_ERR_RANGE, "group");
    auvid_check_part(why, "hull");
    auvid_check_count(why, AUVID_ERR_PARAMETERS, "parameters", (uint32_t)n, AUVID_MAX_PARAMETERS);
    auvid_check_part(why, "");
    for (int i = 0; why->status == AUVID_OK && i < cfg->thrusters; ++i) {
        auvid_check_element(why, i);
        auvid_check_that(why, thrusters_dofs_of_group(cfg, cfg->group[i]) != 0, AUVID_ERR_MODEL,
                         "group");
    }
    auvid_check_element(why, -1);
}

/* Describes the four parameters of a group. */
static void thrusters_name_group(auvid_parameter_t *parameter, int group, uint32_t dofs)
{
    static const char *const name[AUVID_THRUSTERS_GROUPS][AUVID_THRUSTERS_PER_GROUP] = {
        {"forward", "backward", "dead_band", "lag"},
        {"forward_2", "backward_2", "dead_band_2", "lag_2"},
        {"forward_3", "backward_3", "dead_band_3", "lag_3"},
        {"forward_4", "backward_4", "dead_band_4", "lag_4"}};
    static const char *const unit[AUVID_THRUSTERS_PER_GROUP] = {"N", "N", "1", "s"};
    int dof = 0;
    while ((dofs >> dof & 1u) == 0) {
        ++dof;
    }
    for (int k = 0; k < AUVID_THRUSTERS_PER_GROUP; ++k) {
        parameter[k] = (auvid_parameter_t){.name = name[group][k],
                                           .unit = unit[k],
                                           .dof = (auvid_dof_t)dof,
                                           .kind = AUVID_PARAMETER_UNSCALED};
    }
}

/* The thrusters' wrench. A row that is no longer in the log contributes nothing; its set is dropped
 * when the next set is complete. */
static bool thrusters_thrust(const void *context, const auvid_sample_t *sample,
                             const auvid_real_t *pi, auvid_real_t *tau)
{
    return auvid_thrusters_force(context, sample->t_us, pi, true, tau);
}

/* The hull's residual with it. */
static void thrusters_residual(const void *context, const auvid_sample_t *sample,
                               const auvid_real_t *pi, auvid_real_t *e)
{
    const auvid_thrusters_t *th = context;
    auvid_vehicle_residual(th->cfg.hull, sample, pi, e);
}

/* Its derivatives: the hull's rows, and those of the thrusters. */
static void thrusters_regressor(const void *context, const auvid_sample_t *sample,
                                const auvid_real_t *pi, auvid_regressor_t *y)
{
    const auvid_thrusters_t *th = context;
    const auvid_vehicle_t *hull = th->cfg.hull;
    if (auvid_thrusters_slopes(th, sample->t_us, pi, y)) {
        hull->regressor(hull->context, sample, hull->residual != NULL ? pi : NULL, y);
    }
}

/* Makes the model of a configuration that is valid. */
static void thrusters_make(auvid_thrusters_t *th, const auvid_thrusters_config_t *cfg, int groups)
{
    int hull = cfg->hull->parameters, n = hull + groups * AUVID_THRUSTERS_PER_GROUP;
    th->cfg = *cfg; /* it may be this one */
    memset(&th->vehicle, 0, sizeof *th - offsetof(auvid_thrusters_t, vehicle));
    th->carry = &th->state.carry;
    memcpy(th->parameter, cfg->hull->parameter, (size_t)hull * sizeof th->parameter[0]);
    auvid_vehicle_t *vehicle = &th->vehicle;
    *vehicle = *cfg->hull;
    vehicle->regressor = cfg->hull->regressor != NULL ? thrusters_regressor : NULL;
    vehicle->acceleration = NULL;
    vehicle->affine = auvid_vehicle_affine(cfg->hull);
    vehicle->smooth = cfg->hull->residual == NULL || cfg->hull->smooth;
    vehicle->ignores_inputs = true;
    vehicle->parameters = (uint8_t)n;
    vehicle->parameter = th->parameter;
    vehicle->path = &auvid_path_residual;
    vehicle->residual = thrusters_residual;
    vehicle->thrust = thrusters_thrust;
    vehicle->own_thrust = true;
    vehicle->context = th;
    uint32_t all = (uint32_t)(((uint64_t)1 << n) - 1u);
    vehicle->thrust_parameters = all & ~((1u << hull) - 1u);
    vehicle->free = cfg->hull->free == 0 ? 0 : cfg->hull->free | (all & ~((1u << hull) - 1u));
    for (int g = 0; g < groups; ++g) {
        int first = hull + g * AUVID_THRUSTERS_PER_GROUP;
        uint32_t dofs = thrusters_dofs_of_group(cfg, g);
        thrusters_name_group(th->parameter + first, g, dofs);
        vehicle->affine |= 3u << (first + AUVID_THRUSTERS_FORWARD);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            vehicle->columns[j] |= (dofs >> j & 1u) != 0 ? 15u << first : 0u;
        }
    }
}

auvid_status_t auvid_thrusters_init(auvid_thrusters_t *thrusters,
                                    const auvid_thrusters_config_t *cfg, auvid_refusal_t *refusal)
{
    auvid_refusal_t why;
    bool given = thrusters != NULL && cfg != NULL;
    auvid_check_begin(&why);
    auvid_check_that(&why, given, AUVID_ERR_NULL, "");
    if (given) {
        thrusters_check(cfg, &why);
        auvid_check_that(&why, cfg->hull != &thrusters->vehicle, AUVID_ERR_MODEL, "hull");
    }
    if (given && why.status == AUVID_OK) {
        int groups = thrusters_count_groups(cfg);
        thrusters_check_groups(cfg, groups, &why);
        if (why.status == AUVID_OK) {
            thrusters_make(thrusters, cfg, groups);
        }
    }
    if (refusal != NULL) {
        *refusal = why;
    }
    return why.status;
}

/* Returns the kind of parameter i within its group; AUVID_THRUSTERS_PER_GROUP for the hull's. */
static int thrusters_parameter_kind(const auvid_thrusters_t *th, int i)
{
    int k = i - th->cfg.hull->parameters;
    return k < 0 ? AUVID_THRUSTERS_PER_GROUP : k % AUVID_THRUSTERS_PER_GROUP;
}

/* Returns true if the scale of the force is known in every DoF on which thrusters act. The scale
 * comes from a known parameter, or from a free one shared with a DoF whose scale is known. */
static bool thrusters_scale_is_known(const auvid_thrusters_t *th,
                                     const auvid_metric_config_t *metric)
{
    uint32_t known = 0, sized = 0; /* parameters: known; scaling with the force */
    uint32_t acted = 0;            /* DoF on which thrusters act */
    int n = th->vehicle.parameters;
    for (int i = 0; i < n; ++i) {
        int kind = thrusters_parameter_kind(th, i);
        bool force = kind != AUVID_THRUSTERS_DEAD_BAND && kind != AUVID_THRUSTERS_LAG;
        bool given = metric->free != 0 && (metric->free >> i & 1u) == 0;
        sized |= (uint32_t)(force && (!given || auvid_abs(metric->fixed[i]) > AUVID_C(0.0))) << i;
        known |= (uint32_t)given << i;
    }
    known &= sized;
    for (int g = 0; g * AUVID_THRUSTERS_PER_GROUP < n - th->cfg.hull->parameters; ++g) {
        acted |= thrusters_dofs_of_group(&th->cfg, g);
    }
    for (int round = 0; round < AUVID_DOF_COUNT; ++round) {
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            known |= (th->vehicle.columns[j] & known) != 0 ? th->vehicle.columns[j] & sized : 0u;
        }
    }
    bool all = true;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        all = all && ((acted >> j & 1u) == 0 || (th->vehicle.columns[j] & known) != 0);
    }
    return all;
}

/* Returns the time [us] from the first slot of `sets` sets to the newest command, at the moment
 * when the last of them is complete. */
static uint64_t thrusters_needed_us(const auvid_thrusters_t *th, const auvid_thrusters_grid_t *grid,
                                    const auvid_metric_config_t *metric, uint32_t sets)
{
    return (uint64_t)sets * metric->set_rows * grid->row_us +
           (uint64_t)grid->lead * th->cfg.period_us + grid->spread_us + BEHIND_US;
}

static void thrusters_listen(void *context, uint64_t t_us, const auvid_real_t *command)
{
    auvid_thrusters_command(context, t_us, command);
}

/* Drops the sets that the log lost in a restart, and those that it will lose before the next set is
 * complete, because idle sets or gaps filled it. */
static void thrusters_drop_lost_sets(void *context, auvid_metric_t *metric)
{
    const auvid_thrusters_t *th = context;
    uint64_t end_us = th->state.end_us, period = th->cfg.period_us;
    uint64_t next_us = end_us + thrusters_needed_us(th, &th->grid, &metric->cfg, 1);
    for (int age = 0; age < auvid_metric_sets(metric); ++age) {
        const auvid_set_t *set = auvid_metric_set(metric, age);
        uint64_t first_us = auvid_metric_rows(metric, age)[0].sample.t_us;
        first_us = auvid_thrusters_in_log(th, first_us);
        bool lost = first_us + th->state.filled * period + SLACK_US < end_us ||
                    first_us + th->cfg.slots * period < next_us;
        if (set->rows > 0 && lost) {
            (void)auvid_metric_drop(metric, (uint8_t)age);
        }
    }
}

/* Returns the time [us] from the begin of the lead-in to the middle of a row. */
static uint64_t thrusters_lead_us(void *context)
{
    const auvid_thrusters_t *th = context;
    return (uint64_t)th->grid.lead * th->cfg.period_us + th->grid.row_us + th->grid.spread_us +
           th->cfg.delay_us;
}

static const auvid_listener_t thrusters_listener = {
    .command = thrusters_listen, .set = thrusters_drop_lost_sets, .lead_us = thrusters_lead_us};

auvid_status_t auvid_thrusters_configure(auvid_thrusters_t *thrusters,
                                         auvid_identifier_config_t *cfg)
{
    auvid_thrusters_t *th = thrusters;
    if (th == NULL || cfg == NULL) {
        return AUVID_ERR_NULL;
    }
    if (th->cfg.hull == NULL) {
        return AUVID_ERR_STATE;
    }
    if (cfg->vehicle != &th->vehicle || !thrusters_scale_is_known(th, &cfg->metric)) {
        return AUVID_ERR_MODEL;
    }
    const auvid_thrusters_config_t *th_cfg = &th->cfg;
    uint32_t period = th_cfg->period_us;
    uint32_t lead = (uint32_t)(LEAD_LAGS * AUVID_C(1e6) * th_cfg->lag_max_s) / period + 1u;
    uint64_t row_us = (uint64_t)cfg->recorder.cell_us * cfg->metric.row_cells;
    uint32_t velocity_us = cfg->metric.velocity_us; /* the log's length depends on it */
    velocity_us = velocity_us == AUVID_VELOCITY_OBSERVED ? DVL_US : velocity_us;
    if (row_us > UINT32_MAX || velocity_us > 1000000) {
        return AUVID_ERR_RANGE;
    }
    uint32_t gap_us = cfg->recorder.gap_us;
    gap_us = gap_us == 0 ? auvid_recorder_gap(velocity_us) : gap_us;
    auvid_thrusters_grid_t grid = {.row_us = (uint32_t)row_us,
                                   .spread_us =
                                       (uint32_t)(AUVID_C(1.4142136) * (auvid_real_t)velocity_us),
                                   .lead = lead,
                                   .bridged = gap_us / period + lead};
    if ((uint64_t)th_cfg->slots * period <
        thrusters_needed_us(th, &grid, &cfg->metric, cfg->metric.sets + 1u)) {
        return AUVID_ERR_SIZE;
    }
    /* No overflow: a row is shorter than the log, which is at most 4e9 us long. */
    uint32_t n = th_cfg->thrusters, window = (grid.row_us + grid.spread_us) / period + 2u;
    uint32_t thrust = 4u + (window * (42u + 26u * n) + 80u * n) / 250u; /* measured */
    uint32_t slopes = th_cfg->hull->work + 4u + (window * (42u + 58u * n) + 420u * n) / 250u;
    uint32_t lead_work = lead * (42u + 58u * n) / 250u;
    if (slopes + lead_work > UINT16_MAX) {
        return AUVID_ERR_RANGE;
    }
    th->grid = grid;
    th->state.carry.ready[0] = th->state.carry.ready[1] = false;
    th->vehicle.work = (uint16_t)(th_cfg->hull->work + 3u + thrust); /* 3: a simple hull */
    th->vehicle.thrust_work = (uint16_t)thrust;
    th->vehicle.regressor_work = (uint16_t)slopes;
    th->vehicle.lead_work = (uint16_t)lead_work;
    const auvid_real_t upper[AUVID_THRUSTERS_PER_GROUP] = {
        th_cfg->gain_max, th_cfg->gain_max, th_cfg->dead_band_max, th_cfg->lag_max_s};
    for (int k = 0, i = th_cfg->hull->parameters; i < th->vehicle.parameters; ++i, ++k) {
        cfg->search.lower[i] = AUVID_C(0.0);
        cfg->search.upper[i] = upper[k % AUVID_THRUSTERS_PER_GROUP];
    }
    cfg->metric.velocity_us = velocity_us;
    cfg->metric.estimate_delay = false;
    cfg->listener = &thrusters_listener;
    cfg->listener_context = th;
    return AUVID_OK;
}

/* Stores the complete slot in the log. */
static void thrusters_store_slot(auvid_thrusters_t *th)
{
    auvid_real_t scale = AUVID_C(32767.0) / (th->cfg.command_max * (auvid_real_t)th->cfg.period_us);
    for (int i = 0; i < th->cfg.thrusters; ++i) {
        auvid_real_t steps = th->state.filling[i] * scale;
        steps = auvid_clamp(steps, AUVID_C(-32767.0), AUVID_C(32767.0));
        th->cfg.log[th->state.head * th->cfg.thrusters + (uint32_t)i] =
            (int16_t)auvid_half_further(steps);
        th->state.filling[i] = AUVID_C(0.0);
    }
    th->state.head = th->state.head + 1u < th->cfg.slots ? th->state.head + 1u : 0u;
    th->state.filled += th->state.filled < th->cfg.slots;
    th->state.end_us += th->cfg.period_us;
}

/* Makes the log skip `long_us` from end_us on. If the list of pauses is full, the oldest pause and
 * the slots before it are dropped. */
static void thrusters_skip(auvid_thrusters_t *th, uint64_t long_us)
{
    auvid_thrusters_state_t *state = &th->state;
    const uint8_t max_pauses = sizeof state->pause / sizeof state->pause[0];
    if (state->pauses == max_pauses) {
        uint64_t from_us = auvid_thrusters_in_log(th, state->pause[max_pauses - 1].end_us);
        uint64_t slots = (state->end_us - from_us) / th->cfg.period_us;
        state->filled = slots < state->filled ? (uint32_t)slots : state->filled;
        --state->pauses;
    }
    memmove(state->pause + 1, state->pause, state->pauses * sizeof state->pause[0]);
    ++state->pauses;
    state->end_us += long_us;
    state->pause[0] = (auvid_thrusters_pause_t){.end_us = state->end_us, .long_us = long_us};
}

/* After a gap in the commands, rows begin later than its end. So the log bridges the end of a long
 * gap and skips the rest. */
static void thrusters_bridge_gap(auvid_thrusters_t *th, uint64_t t_us)
{
    auvid_thrusters_state_t *state = &th->state;
    const uint32_t period = th->cfg.period_us;
    uint64_t behind_us = t_us - state->end_us, bridged_us = (uint64_t)th->grid.bridged * period;
    if (!state->started) {
        state->started = true;
        state->end_us = t_us;
    } else if (behind_us > bridged_us + period) {
        thrusters_skip(th, (behind_us - bridged_us) / period * period);
    } else {
        return;
    }
    state->held_us = state->end_us;
    memset(state->filling, 0, sizeof state->filling);
}

/* Adds the held commands up to t_us to the slots. */
static void thrusters_fill_slots(auvid_thrusters_t *th, uint64_t t_us)
{
    auvid_thrusters_state_t *state = &th->state;
    while (state->held_us < t_us) {
        uint64_t slot_ends = state->end_us + th->cfg.period_us;
        uint64_t to = t_us < slot_ends ? t_us : slot_ends;
        auvid_real_t part = (auvid_real_t)(uint32_t)(to - state->held_us);
        for (int i = 0; i < th->cfg.thrusters; ++i) {
            state->filling[i] += part * state->held[i];
        }
        state->held_us = to;
        if (to == slot_ends) {
            thrusters_store_slot(th);
        }
    }
}

void auvid_thrusters_command(auvid_thrusters_t *thrusters, uint64_t t_us,
                             const auvid_real_t *command)
{
    auvid_thrusters_t *th = thrusters;
    if (th == NULL || th->grid.row_us == 0 || (th->state.started && t_us <= th->state.held_us)) {
        return;
    }
    thrusters_bridge_gap(th, t_us);
    thrusters_fill_slots(th, t_us);
    auvid_real_t max_command = th->cfg.command_max;
    for (int i = 0; i < th->cfg.thrusters; ++i) {
        bool usable = command != NULL && auvid_is_finite(command[i]);
        th->state.held[i] =
            usable ? auvid_clamp(command[i], -max_command, max_command) : AUVID_C(0.0);
        th->state.clipped += usable && auvid_abs(command[i]) > max_command;
    }
}
