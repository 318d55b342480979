/**
 * @file auvid_metric_feedback_internal.h
 * Private: is the wrench feedback of the motion?
 */
#ifndef AUVID_METRIC_FEEDBACK_INTERNAL_H
#define AUVID_METRIC_FEEDBACK_INTERNAL_H

#include "auvid_metric_internal.h"

/** Add the newest cell to the test for feedback, after auvid_metric_add.
 * @param pi parameters of the last estimate; NULL: the cell is not part of the test
 * @param dofs bit j: they are known in DoF j
 * @param lost part of the supplied wrench that is not delivered, less that of the estimate */
void auvid_metric_watch(auvid_metric_t *m, const auvid_sample_t *cell, const auvid_real_t *pi,
                        uint8_t dofs, auvid_real_t lost);

/** DoF, a bit each. An autopilot often holds these two while the rest is driven in open loop. */
#define AUVID_FEEDBACK_TILT (1u << AUVID_ROLL | 1u << AUVID_PITCH)
#define AUVID_FEEDBACK_ALL ((1u << AUVID_DOF_COUNT) - 1u)

/** Returns in which DoF the wrench is feedback, in some set of the ring or in the newest one, a bit
 * each: in those of which it is known (cfg.closed_loop), also in roll and pitch, or in all. Those
 * of cfg.open_loop are not tested. */
uint32_t auvid_metric_feedback_dofs(const auvid_metric_t *m);

#endif
