/*
 * Standard excitation for identification: alternating sets of steps and of sums of sines.
 *
 * The paper gives no amplitudes or frequencies. These suit vehicles of 0.1-1 t: a step is held for
 * a few time constants m / |X_u + 2 X_uu u|, and the frequencies are around their inverse. Roll and
 * pitch have restoring moments and periods of 2-3 s at any vehicle size: their signals are faster.
 */
#include "auvid_excitation_init_internal.h"

#include <string.h>

#include "../base/auvid_refusal_internal.h"

const auvid_real_t auvid_excitation_limit[AUVID_DOF_COUNT] = {
    AUVID_C(5.0), AUVID_C(5.0), AUVID_C(3.0), AUVID_C(0.0), AUVID_C(0.0), AUVID_C(2.0) * AUVID_PI};

void auvid_excitation_defaults(auvid_excitation_config_t *cfg)
{
    if (cfg != NULL) {
        memset(cfg, 0, sizeof *cfg);
        cfg->fade_s = AUVID_C(2.0);
        cfg->seed = 1;
    }
}

/* Add a segment of steps and one of sines for one degree of freedom. The segments must be zero. */
static void excitation_add_sets(auvid_excitation_config_t *cfg, auvid_dof_t dof,
                                auvid_real_t amplitude, auvid_real_t set_s, auvid_real_t before_s,
                                auvid_real_t between_s)
{
    auvid_segment_t *s = &cfg->segment[cfg->segments];
    bool righted = dof == AUVID_ROLL || dof == AUVID_PITCH;
    auvid_real_t hold_s = righted ? AUVID_C(1.0) : AUVID_C(4.0);
    s->dof = dof;
    s->kind = AUVID_SEGMENT_STEPS;
    s->pause_s = before_s;
    s->duration_s = set_s;
    s->amplitude = amplitude;
    s->fade_s = EXCITATION_STEP_FADE_S;
    s->frequency_hz = auvid_max(righted ? AUVID_C(0.1) : AUVID_C(0.03), AUVID_C(1.0) / set_s);
    s->frequency_high_hz = righted ? AUVID_C(0.8) : AUVID_C(0.25);
    /* at most AUVID_EXCITATION_HOLDS steps, as init demands */
    s->hold_min_s = auvid_max(auvid_min(hold_s, set_s * AUVID_C(0.25)),
                              set_s / (auvid_real_t)AUVID_EXCITATION_HOLDS);
    s->hold_max_s = auvid_min(righted ? AUVID_C(2.0) : AUVID_C(8.0), set_s * AUVID_C(0.5));
    s->hold_max_s = auvid_max(s->hold_max_s, s->hold_min_s);
    s->sines = AUVID_MAX_SINES < 5 ? AUVID_MAX_SINES : 5;
    s[1] = s[0];
    s[1].kind = AUVID_SEGMENT_SINES;
    s[1].pause_s = between_s;
    cfg->segments = (uint8_t)(cfg->segments + 2);
}

auvid_status_t auvid_excitation_plan(auvid_excitation_config_t *cfg,
                                     const auvid_real_t amplitude[AUVID_DOF_COUNT],
                                     auvid_real_t set_s, uint32_t sets, uint64_t seed)
{
    return auvid_excitation_schedule(cfg, amplitude, set_s, sets, seed, AUVID_C(0.0), false);
}

auvid_status_t auvid_excitation_schedule(auvid_excitation_config_t *cfg,
                                         const auvid_real_t amplitude[AUVID_DOF_COUNT],
                                         auvid_real_t set_s, uint32_t sets, uint64_t seed,
                                         auvid_real_t pause_s, bool one_by_one)
{
    auvid_refusal_t why;
    uint32_t n = 0;
    if (cfg == NULL || amplitude == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_check_begin(&why);
    auvid_check_in(&why, "set_s", set_s, AUVID_C(5.0), AUVID_C(600.0));
    auvid_check_in(&why, "pause_s", pause_s, AUVID_C(0.0), AUVID_C(600.0));
    auvid_check_count(&why, AUVID_ERR_RANGE, "sets", sets, 1000);
    for (int dof = 0; dof < AUVID_DOF_COUNT; ++dof) {
        auvid_check_in(&why, "amplitude", amplitude[dof], AUVID_C(0.0), AUVID_EXCITATION_LARGEST);
        n += amplitude[dof] > AUVID_C(0.0) ? 2u : 0u;
    }
    auvid_check_count(&why, n == 0 ? AUVID_ERR_RANGE : AUVID_ERR_SIZE, "amplitude", n,
                      AUVID_MAX_SEGMENTS);
    if (why.status < 0) {
        return why.status;
    }
    uint32_t turns = one_by_one ? n / 2u : 1u; /* DoFs one after the other */
    auvid_real_t turn_s = set_s + pause_s;
    auvid_real_t duration_s = (auvid_real_t)(sets * turns) * turn_s;
    if (duration_s > AUVID_EXCITATION_LONGEST_RUN_S ||
        (auvid_real_t)turns * turn_s > AUVID_EXCITATION_LONGEST_S) {
        return AUVID_ERR_RANGE;
    }
    memset(cfg->segment, 0, sizeof cfg->segment);
    cfg->segments = 0;
    for (int dof = 0; dof < AUVID_DOF_COUNT; ++dof) {
        if (amplitude[dof] > AUVID_C(0.0)) {
            uint32_t turn = one_by_one ? cfg->segments / 2u : 0u;
            excitation_add_sets(cfg, (auvid_dof_t)dof, amplitude[dof], set_s,
                                pause_s + (auvid_real_t)turn * turn_s,
                                pause_s + (auvid_real_t)(turns - 1u) * turn_s);
        }
    }
    memcpy(cfg->excursion_limit, auvid_excitation_limit, sizeof cfg->excursion_limit);
    cfg->duration_s = duration_s;
    cfg->seed = seed;
    return AUVID_OK;
}
