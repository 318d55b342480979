/**
 * @file auvid_metric.h
 * Private: what the files of the metric share.
 */
#ifndef AUVID_METRIC_PRIVATE_H
#define AUVID_METRIC_PRIVATE_H

#include "auvid/metric.h"

/* Channels of the path that smooths motion. */
enum {
    MOTION_NU = 3,
    MOTION_NU_DOT = MOTION_NU + AUVID_DOF_COUNT,
    MOTION_TAU = MOTION_NU_DOT + AUVID_DOF_COUNT,
    MOTION_COMMAND = MOTION_TAU + AUVID_DOF_COUNT,
    MOTION_LATE = MOTION_COMMAND + AUVID_MAX_THRUSTERS, /* wrench and commands again, delayed */
    AUVID_METRIC_MOTION_CHANNELS =
        MOTION_LATE + (AUVID_METRIC_DELAYS - 1) * (AUVID_DOF_COUNT + AUVID_MAX_THRUSTERS)
};

/** Does the smoother work on the motion (residual path, literal reading) or on the rows? */
static inline bool auvid_metric_smooths_motion(const auvid_metric_t *m)
{
    return m->cfg.vehicle->regressor == NULL || m->cfg.smoothing == AUVID_SMOOTH_STATES;
}

/** Where the set completed `age` sets ago stands, age < cfg.sets. */
static inline int auvid_metric_slot(const auvid_metric_t *m, int age)
{
    int slots = m->cfg.sets + 1;
    return (m->current + 2 * slots - 1 - age) % slots;
}

static inline bool auvid_metric_has_regressor(const auvid_metric_t *m)
{
    return m->cfg.vehicle->regressor != NULL;
}

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

/** Weights of the wrench at those delays for a delay, or a first-order lag, of s distances. */
void auvid_metric_delay_weights(auvid_real_t s, bool lag, auvid_real_t l[AUVID_METRIC_DELAYS]);

/** What a walk through the rows of all sets is for. */
enum { PASS_FIRST, PASS_RESIDUAL, PASS_LAST, PASS_COST, PASS_MEASURE };

/** Begin a walk. */
void auvid_metric_rewind(auvid_metric_t *m, uint8_t pass);

/** Go on with it, one unit of the budget a row. @return it is at its end */
bool auvid_metric_visit_rows(auvid_metric_t *m, uint32_t *budget);

#endif
