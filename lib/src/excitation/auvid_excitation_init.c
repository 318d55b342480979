/*
 * Initialisation of the excitation: checks the configuration and copies it.
 */
#include "auvid_excitation_init_internal.h"

#include <string.h>

bool auvid_excitation_in(auvid_real_t x, auvid_real_t low, auvid_real_t high)
{
    return x >= low && x <= high;
}

/* Whole seconds and fraction are separate: in float 3600 s has a resolution of 0.2 ms. */
uint64_t auvid_excitation_us(auvid_real_t s)
{
    uint32_t whole = (uint32_t)s;
    auvid_real_t fraction = s - (auvid_real_t)whole;
    return (uint64_t)whole * 1000000u + (uint32_t)(fraction * AUVID_C(1000000.0) + AUVID_C(0.5));
}

static auvid_status_t excitation_check_segment(const auvid_segment_t *s)
{
    const auvid_real_t values[] = {
        s->duration_s,        s->amplitude, s->from,       s->fade_s,     s->frequency_hz,
        s->frequency_high_hz, s->phase,     s->hold_min_s, s->hold_max_s, s->pause_s};
    if (!auvid_all_finite(values, sizeof values / sizeof values[0])) {
        return AUVID_ERR_NOT_FINITE;
    }
    if ((unsigned)s->dof >= AUVID_DOF_COUNT || (unsigned)s->kind >= AUVID_SEGMENT_KIND_COUNT ||
        !auvid_excitation_in(s->duration_s, AUVID_C(0.0), AUVID_EXCITATION_LONGEST_S) ||
        !auvid_excitation_in(s->pause_s, AUVID_C(0.0), AUVID_EXCITATION_LONGEST_S) ||
        !auvid_excitation_in(s->amplitude, -AUVID_EXCITATION_LARGEST, AUVID_EXCITATION_LARGEST) ||
        !auvid_excitation_in(s->from, -AUVID_EXCITATION_LARGEST, AUVID_EXCITATION_LARGEST) ||
        !auvid_excitation_in(s->fade_s, AUVID_C(0.0), s->duration_s * AUVID_C(0.5))) {
        return AUVID_ERR_RANGE;
    }
    switch (s->kind) {
    case AUVID_SEGMENT_SINES:
        if (s->sines < 1 || s->sines > AUVID_MAX_SINES) {
            return AUVID_ERR_SIZE;
        }
        if (!auvid_excitation_in(s->frequency_high_hz, s->frequency_hz,
                                 AUVID_EXCITATION_HIGHEST_HZ)) {
            return AUVID_ERR_RANGE;
        }
        return s->frequency_hz > AUVID_C(0.0) ? AUVID_OK : AUVID_ERR_RANGE;
    case AUVID_SEGMENT_SINE:
        return s->frequency_hz > AUVID_C(0.0) && s->frequency_hz <= AUVID_EXCITATION_HIGHEST_HZ &&
                       auvid_excitation_in(s->phase, AUVID_C(-100.0), AUVID_C(100.0))
                   ? AUVID_OK
                   : AUVID_ERR_RANGE;
    case AUVID_SEGMENT_STEPS:
        return s->hold_min_s > AUVID_C(0.0) && s->hold_min_s >= s->fade_s &&
                       s->hold_min_s * (auvid_real_t)AUVID_EXCITATION_HOLDS >= s->duration_s &&
                       auvid_excitation_in(s->hold_max_s, s->hold_min_s, AUVID_EXCITATION_LONGEST_S)
                   ? AUVID_OK
                   : AUVID_ERR_RANGE;
    case AUVID_SEGMENT_PAUSE:
    case AUVID_SEGMENT_STEP:
    case AUVID_SEGMENT_RAMP:
    case AUVID_SEGMENT_KIND_COUNT:
    default:
        return AUVID_OK;
    }
}

auvid_status_t auvid_excitation_peak(const auvid_excitation_t *e,
                                     auvid_real_t peak[AUVID_DOF_COUNT])
{
    if (e == NULL || peak == NULL) {
        return AUVID_ERR_NULL;
    }
    for (int i = 0; i < AUVID_DOF_COUNT; ++i) {
        peak[i] = AUVID_C(0.0);
    }
    for (uint32_t i = 0; i < e->cfg.segments; ++i) {
        const auvid_segment_t *s = &e->cfg.segment[i];
        auvid_real_t a = s->kind == AUVID_SEGMENT_PAUSE ? AUVID_C(0.0) : auvid_abs(s->amplitude);
        if (s->kind == AUVID_SEGMENT_RAMP) {
            a = auvid_max(a, auvid_abs(s->from));
        }
        peak[s->dof] = auvid_max(peak[s->dof], a);
    }
    return AUVID_OK;
}

auvid_status_t auvid_excitation_init(auvid_excitation_t *e, const auvid_excitation_config_t *cfg)
{
    uint64_t length_us[AUVID_DOF_COUNT] = {0};
    uint64_t sequence_us = 0;
    if (e == NULL || cfg == NULL) {
        return AUVID_ERR_NULL;
    }
    if (cfg->segments < 1 || cfg->segments > AUVID_MAX_SEGMENTS) {
        return AUVID_ERR_SIZE;
    }
    if (!auvid_is_finite(cfg->duration_s) || !auvid_is_finite(cfg->fade_s) ||
        !auvid_all_finite(cfg->excursion_limit, AUVID_DOF_COUNT)) {
        return AUVID_ERR_NOT_FINITE;
    }
    for (int i = 0; i < AUVID_DOF_COUNT; ++i) {
        if (cfg->excursion_limit[i] < AUVID_C(0.0)) {
            return AUVID_ERR_RANGE;
        }
    }
    for (uint32_t i = 0; i < cfg->segments; ++i) {
        const auvid_segment_t *s = &cfg->segment[i];
        auvid_status_t status = excitation_check_segment(s);
        if (status != AUVID_OK) {
            return status;
        }
        length_us[s->dof] += auvid_excitation_us(s->pause_s) + auvid_excitation_us(s->duration_s);
        sequence_us = length_us[s->dof] > sequence_us ? length_us[s->dof] : sequence_us;
    }
    if (sequence_us == 0 ||
        !auvid_excitation_in(cfg->duration_s, AUVID_C(0.0), AUVID_EXCITATION_LONGEST_RUN_S) ||
        !auvid_excitation_in(cfg->fade_s, AUVID_C(0.0), AUVID_EXCITATION_LONGEST_S)) {
        return AUVID_ERR_RANGE;
    }
    uint64_t run_us =
        cfg->duration_s > AUVID_C(0.0) ? auvid_excitation_us(cfg->duration_s) : sequence_us;
    if (2 * auvid_excitation_us(cfg->fade_s) > run_us) {
        return AUVID_ERR_RANGE;
    }
    e->cfg = *cfg;
    memset(e->channel, 0, sizeof *e - offsetof(auvid_excitation_t, channel));
    e->sequence_us = sequence_us;
    e->run_us = run_us;
    e->fade_us = (uint32_t)auvid_excitation_us(cfg->fade_s);
    auvid_real_t peak[AUVID_DOF_COUNT];
    (void)auvid_excitation_peak(e, peak);
    e->heaves = peak[AUVID_HEAVE] > AUVID_C(0.0);
    for (uint32_t i = 0; i < cfg->segments; ++i) {
        e->duration_us[i] = (uint32_t)auvid_excitation_us(cfg->segment[i].duration_s);
        e->pause_us[i] = (uint32_t)auvid_excitation_us(cfg->segment[i].pause_s);
    }
    return AUVID_OK;
}
