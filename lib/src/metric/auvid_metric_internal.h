/**
 * @file auvid_metric_internal.h
 * Private: what the files of the metric share.
 */
#ifndef AUVID_METRIC_INTERNAL_H
#define AUVID_METRIC_INTERNAL_H

#include "auvid/metric.h"

/* Channels of the path that smooths motion. */
enum {
    MOTION_NU = 3,
    MOTION_NU_DOT = MOTION_NU + AUVID_DOF_COUNT,
    MOTION_TAU = MOTION_NU_DOT + AUVID_DOF_COUNT,
    MOTION_COMMAND = MOTION_TAU + AUVID_DOF_COUNT,
    MOTION_LATE = MOTION_COMMAND + AUVID_MAX_COMMANDS /* wrench and commands again, delayed */
};

/** Larger entries of a row are taken for a fault: the squares of 60000 such rows are still finite
 * in single precision. */
#define METRIC_LARGEST_ENTRY AUVID_C(1e15)

/** Regressor path? Else the residual path. */
static inline bool auvid_metric_is_linear(const auvid_metric_config_t *cfg)
{
    return AUVID_REGRESSOR_ONLY || cfg->vehicle->regressor != NULL;
}

/** Our literal reading of the paper? */
static inline bool auvid_metric_is_literal(const auvid_metric_config_t *cfg)
{
    return !AUVID_REGRESSOR_ONLY && cfg->smoothing == AUVID_SMOOTH_STATES;
}

static inline bool auvid_metric_has_regressor(const auvid_metric_t *m)
{
    return auvid_metric_is_linear(&m->cfg);
}

/** Does the smoother work on the motion (residual path, literal reading) or on the rows? */
static inline bool auvid_metric_smooths_motion(const auvid_metric_t *m)
{
    return !auvid_metric_is_linear(&m->cfg) || auvid_metric_is_literal(&m->cfg);
}

/** Sets of the ring that count; ages below are from the newest of them on. */
static inline int auvid_metric_sets(const auvid_metric_t *m)
{
    return m->from < m->cfg.sets ? m->cfg.sets - m->from : 0;
}

/** Place of the set that entered a ring of `sets` `back` turns before the last one. */
static inline uint32_t auvid_metric_ring_index(uint32_t turns, uint32_t sets, uint32_t back)
{
    return (turns + 2u * sets - 1u - back) % sets;
}

/** Where the set of that age stands, age < auvid_metric_sets. */
int auvid_metric_slot(const auvid_metric_t *m, int age);

/** Residual path: its rows; age -1: those of the set being recorded. */
static inline auvid_row_t *auvid_metric_rows(const auvid_metric_t *m, int age)
{
    uint32_t blocks = m->cfg.sets + 1u;
    uint32_t back = age < 0 ? 0u : (uint32_t)age + m->from + 1u;
    uint32_t block = (m->sets_stored + 2u * blocks - back) % blocks;
    return m->cfg.rows + block * m->cfg.set_rows;
}

/** Binary digits of a stored triangle's entries, sign apart; in double as many as it has itself. */
enum { AUVID_METRIC_DIGITS = sizeof(auvid_packed_t) == sizeof(int16_t) ? 15 : 52 };

/** Keep m->factor in *set. */
void auvid_metric_pack(const auvid_metric_t *m, auvid_set_t *set);

/** The set being recorded is complete: into the ring, in the place of the oldest. */
void auvid_metric_store_set(auvid_metric_t *m, uint8_t driven);

/** row[i..n-1]: row i of DoF j's triangle, of order n. */
void auvid_metric_unpack_row(const auvid_metric_t *m, const auvid_set_t *set, int band, int j,
                             int i, auvid_real_t *row);

/** Order of DoF j's triangle: its parameters and the wrench at each delay; 0: not modelled. */
static inline int auvid_metric_order(const auvid_metric_t *m, int j)
{
    return m->channel_at[j + 1] - m->channel_at[j];
}

/** Distance of the delays at which the wrench is kept [s]. */
static inline auvid_real_t auvid_metric_node_s(const auvid_metric_t *m)
{
    return (auvid_real_t)m->cfg.cell_us * AUVID_C(1e-6) * (auvid_real_t)AUVID_METRIC_DELAY_CELLS;
}

/** Free parameters of these DoF: bit i. */
uint32_t auvid_metric_free_of(const auvid_metric_t *m, uint8_t driven);

/** Weights of the wrench at those delays for a delay, or a first-order lag, of s distances. */
void auvid_metric_delay_weights(auvid_real_t s, bool lag, auvid_real_t l[AUVID_METRIC_DELAYS]);

/** Rows between windows of residuals that are linearised: the window's standard deviation, which is
 * sqrt(window_length - 1) / 2 rows. */
static inline int auvid_metric_stride(const auvid_metric_t *m)
{
    int stride = 1;
    while (4 * (stride + 1) * (stride + 1) <= m->window_length - 1) {
        ++stride;
    }
    return stride;
}

/** Derivatives of those weights by s. */
void auvid_metric_delay_slopes(auvid_real_t s, bool lag, auvid_real_t l[AUVID_METRIC_DELAYS]);

/** ||T l||^2, T the last 3 x 3 block of DoF j's merged triangle: what no pi explains at delay, or
 * first-order lag, s [distances of the nodes]. */
auvid_real_t auvid_metric_unexplained(const auvid_metric_t *m, int j, auvid_real_t s, bool lag);

/** Put rows whose pivot is rounding only back to where they can be explained, or not. */
void auvid_metric_clear_dependent(auvid_metric_t *m, int j);

/** The stored sample with wrench and commands at the candidate's delay. */
auvid_sample_t auvid_metric_delayed_sample(const auvid_metric_t *m, const auvid_row_t *row);

/** Take pi and the common delay for what follows. */
void auvid_metric_take_candidate(auvid_metric_t *m, const auvid_real_t *pi, auvid_real_t delay_s);

/** Was a row taken at `later_us` the next after one at `earlier_us`? To half a cell. */
static inline bool auvid_metric_succeeds(const auvid_metric_t *m, uint64_t earlier_us,
                                         uint64_t later_us)
{
    uint64_t row_us = (uint64_t)m->cfg.cell_us * m->cfg.row_cells;
    return later_us - earlier_us + m->cfg.cell_us / 2 - row_us <= m->cfg.cell_us;
}

/** Units that it costs to rotate a row into a triangle. */
enum { AUVID_METRIC_ROTATION = 4 };

/** What a walk through the rows of all sets is for. */
enum { PASS_FIRST, PASS_RESIDUAL, PASS_LAST, PASS_PRIOR, PASS_COST, PASS_MEASURE, PASS_LINEAR };

/** Pay one of the units of a step that costs so many. @return it is paid in full: take it */
static inline bool auvid_metric_spend(auvid_metric_t *m, uint32_t *budget, uint16_t price)
{
    --*budget;
    m->spent = (uint16_t)(m->spent + 1u < price ? m->spent + 1u : 0u);
    return m->spent == 0;
}

/** Pay for a call of the model's residual. @return it is paid in full: call it */
static inline bool auvid_metric_spend_model(auvid_metric_t *m, uint32_t *budget)
{
    uint16_t work = m->cfg.vehicle->work;
    bool paid = false;
    while (!paid && *budget > 0) {
        paid = auvid_metric_spend(m, budget, work);
    }
    return paid;
}

/** Row i < count[j] of DoF j in the regressor path's cost, which is ||R pi - z||^2 over all rows
 * of driven DoF: columns of the n parameters of `active`, then z, less what pi holds for the
 * others. row[] has n + 1 places, and as many as the model has parameters. */
void auvid_metric_joint_row(const auvid_metric_t *m, int j, int i, uint32_t active,
                            const auvid_real_t *pi, auvid_real_t *row);

/** Could this be known of the metric's model? Statuses of auvid_metric_set_prior. */
auvid_status_t auvid_metric_check_prior(const auvid_metric_t *metric, const auvid_prior_t *memory);

/** Begin a walk. */
void auvid_metric_restart_pass(auvid_metric_t *m, uint8_t pass);

/** Rotate row i of one band of a set's triangle, weighted, into DoF j's merged one. */
void auvid_metric_rotate(auvid_metric_t *m, const auvid_set_t *set, int band, int j, int i);

/** After a pass: delay, z and candidate of DoF j's own least squares; adds to `constant`. */
void auvid_metric_solve_dof(auvid_metric_t *m, int j);

/** Rotate all sets' rows together, passes on from the present one, one unit a row. @return done */
bool auvid_metric_merge_sets(auvid_metric_t *m, uint32_t *budget);

/** Go on with it, one unit of the budget a row. @return it is at its end */
bool auvid_metric_for_each_row(auvid_metric_t *m, uint32_t *budget);

/** Checksum of what must be the same for the parameters to mean the same: names, units, and what is
 * free or fixed at what. */
uint32_t auvid_checksum_of_model(const auvid_metric_config_t *cfg);

#endif
