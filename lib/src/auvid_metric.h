/**
 * @file auvid_metric.h
 * Private: what the two files of the metric share.
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

#endif
