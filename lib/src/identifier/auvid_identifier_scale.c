/*
 * The scale of the wrench from the thrusters. A file of its own: a passive identifier without
 * thrusters does not link it.
 */
#include "auvid_identifier_internal.h"

#include "../base/auvid_math_internal.h"

static bool scale_is_usable(auvid_real_t capacity)
{
    return capacity > AUVID_C(0.0) && capacity <= AUVID_RECORDER_LARGEST;
}

void auvid_identifier_set_scale(auvid_identifier_t *id, const auvid_allocation_t *allocation)
{
    auvid_real_t capacity[AUVID_DOF_COUNT], largest[2] = {AUVID_C(0.0), AUVID_C(0.0)};
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t negative = AUVID_C(0.0), positive = AUVID_C(0.0);
        (void)auvid_allocation_capacity(allocation, (auvid_dof_t)j, &negative, &positive);
        capacity[j] = auvid_max(-negative, positive);
        if (scale_is_usable(capacity[j])) {
            largest[j / 3] = auvid_max(largest[j / 3], capacity[j]);
        }
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t *scale = &id->metric.cfg.tau_max[j];
        if ((id->default_scale >> j & 1) != 0 && largest[j / 3] > AUVID_C(0.0)) {
            *scale = scale_is_usable(capacity[j]) ? capacity[j] : auvid_min(*scale, largest[j / 3]);
        }
    }
}
