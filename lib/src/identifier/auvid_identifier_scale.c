/*
 * The scale of the wrench from the thrusters. A file of its own: a passive identifier without
 * thrusters does not link it.
 */
#include "auvid_identifier_internal.h"

#include "../base/auvid_math_internal.h"

void auvid_identifier_set_scale(auvid_identifier_t *id, const auvid_allocation_t *allocation)
{
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t negative = AUVID_C(0.0), positive = AUVID_C(0.0);
        (void)auvid_allocation_capacity(allocation, (auvid_dof_t)j, &negative, &positive);
        auvid_real_t capacity = auvid_max(-negative, positive);
        if ((id->default_scale >> j & 1) != 0 && capacity > AUVID_C(0.0) &&
            capacity <= AUVID_RECORDER_LARGEST) {
            id->metric.cfg.tau_max[j] = capacity;
        }
    }
}
