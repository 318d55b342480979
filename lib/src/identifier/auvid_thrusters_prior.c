/*
 * Thrusters: their data sheet as a prior.
 */
#include "auvid/thrusters.h"

#include "auvid_identifier_internal.h"
#include "auvid_prior_rows_internal.h"
#include "../base/auvid_math_internal.h"
#include "../metric/auvid_metric_internal.h"

/* Write the priors of a group. `gain`: its forward gain if that is known, else 0. */
static void thrusters_read_sheet(const auvid_thrusters_config_t *cfg, int group, auvid_real_t gain,
                                 auvid_real_t *pi, auvid_real_t *sigma)
{
    const auvid_thrusters_sheet_t *sheet = &cfg->sheet[group];
    bool known = gain > AUVID_C(0.0);
    auvid_real_t forward = known ? gain : sheet->gain, backward = forward * sheet->backward;
    auvid_real_t scale_sigma = known ? AUVID_C(0.0) : sheet->gain_sigma;
    pi[AUVID_THRUSTERS_FORWARD] = forward;
    sigma[AUVID_THRUSTERS_FORWARD] = scale_sigma * forward;
    pi[AUVID_THRUSTERS_BACKWARD] = backward;
    sigma[AUVID_THRUSTERS_BACKWARD] = /* together with that of the forward gain, if both are free */
        backward *
        auvid_sqrt(scale_sigma * scale_sigma + sheet->backward_sigma * sheet->backward_sigma);
    pi[AUVID_THRUSTERS_DEAD_BAND] = sheet->dead_band;
    sigma[AUVID_THRUSTERS_DEAD_BAND] = sheet->dead_band_sigma * cfg->command_max;
    pi[AUVID_THRUSTERS_LAG] = sheet->lag_s;
    sigma[AUVID_THRUSTERS_LAG] = sheet->lag_sigma_s;
}

auvid_status_t auvid_thrusters_attach_prior(auvid_thrusters_t *thrusters,
                                            struct auvid_identifier *id,
                                            struct auvid_prior *storage)
{
    auvid_thrusters_t *th = thrusters;
    if (th == NULL || id == NULL || storage == NULL) {
        return AUVID_ERR_NULL;
    }
    if (th->cfg.hull == NULL || !identifier_is_ready(id)) {
        return AUVID_ERR_STATE;
    }
    if (identifier_vehicle(id) != &th->vehicle) {
        return AUVID_ERR_MODEL;
    }
    auvid_status_t status = auvid_identifier_attach_prior(id, storage);
    if (status < 0) {
        return status;
    }
    uint32_t free = auvid_metric_free_of(&id->metric, UINT8_MAX);
    int hull = th->cfg.hull->parameters;
    for (int i = hull; i < th->vehicle.parameters; i += AUVID_THRUSTERS_PER_GROUP) {
        bool known = (free >> i & 1u) == 0;
        thrusters_read_sheet(&th->cfg, (i - hull) / AUVID_THRUSTERS_PER_GROUP,
                             known ? id->metric.cfg.fixed[i] : AUVID_C(0.0), storage->pi + i,
                             storage->sigma + i);
        th->vehicle.own_thrust = th->vehicle.own_thrust && !known;
        for (int k = i; k < i + AUVID_THRUSTERS_PER_GROUP; ++k) {
            bool has = (free >> k & 1u) != 0 && storage->sigma[k] > AUVID_C(0.0);
            storage->known |= (uint32_t)has << k;
            storage->variance_inflation[th->vehicle.parameter[k].dof] = AUVID_PRIOR_INFLATION;
        }
    }
    return AUVID_OK;
}
