/*
 * The usual excitation for identification: sets of steps and of sums of sines in turn.
 *
 * The paper gives no amplitudes or frequencies. These suit vehicles of 0.1-1 t: a step is held for
 * a few time constants m / |X_u + 2 X_uu u|, and the sines lie around their inverse.
 */
#include "auvid/excitation.h"

#include <string.h>

#include "auvid_math.h"

void auvid_excitation_defaults(auvid_excitation_config_t *config)
{
    if (config != NULL) {
        memset(config, 0, sizeof *config);
        config->fade_s = AUVID_C(2.0);
        config->seed = 1;
    }
}

auvid_status_t auvid_excitation_plan(auvid_excitation_config_t *config,
                                     const auvid_real_t amplitude[AUVID_DOF_COUNT],
                                     auvid_real_t set_s, uint32_t sets, uint64_t seed)
{
    uint8_t n = 0;
    if (config == NULL || amplitude == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!auvid_is_finite(set_s) || !auvid_all_finite(amplitude, AUVID_DOF_COUNT)) {
        return AUVID_ERR_NOT_FINITE;
    }
    if (!(set_s >= AUVID_C(5.0) && set_s <= AUVID_C(600.0)) || sets < 1 || sets > 1000 ||
        (auvid_real_t)sets * set_s > AUVID_EXCITATION_LONGEST_RUN_S) {
        return AUVID_ERR_RANGE;
    }
    for (int dof = 0; dof < AUVID_DOF_COUNT; ++dof) {
        if (!(amplitude[dof] >= AUVID_C(0.0) && amplitude[dof] <= AUVID_EXCITATION_LARGEST)) {
            return AUVID_ERR_RANGE;
        }
        n = (uint8_t)(n + (amplitude[dof] > AUVID_C(0.0) ? 2 : 0));
    }
    if (n == 0 || n > AUVID_MAX_SEGMENTS) {
        return n == 0 ? AUVID_ERR_RANGE : AUVID_ERR_SIZE;
    }
    memset(config->segment, 0, sizeof config->segment);
    config->segments = 0;
    for (int dof = 0; dof < AUVID_DOF_COUNT; ++dof) {
        auvid_segment_t s = {.dof = (auvid_dof_t)dof,
                             .kind = AUVID_SEGMENT_STEPS,
                             .duration_s = set_s,
                             .amplitude = amplitude[dof],
                             .fade_s = AUVID_C(0.2),
                             .frequency_hz = auvid_max(AUVID_C(0.03), AUVID_C(1.0) / set_s),
                             .frequency_high_hz = AUVID_C(0.25),
                             .hold_min_s = auvid_min(AUVID_C(4.0), set_s * AUVID_C(0.25)),
                             .hold_max_s = auvid_min(AUVID_C(8.0), set_s * AUVID_C(0.5)),
                             .sines = AUVID_MAX_SINES < 5 ? AUVID_MAX_SINES : 5};
        if (amplitude[dof] > AUVID_C(0.0)) {
            config->segment[config->segments++] = s;
            s.kind = AUVID_SEGMENT_SINES;
            config->segment[config->segments++] = s;
        }
    }
    config->duration_s = (auvid_real_t)sets * set_s;
    config->seed = seed;
    return AUVID_OK;
}
