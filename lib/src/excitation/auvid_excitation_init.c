/*
 * Initialisation of the excitation: checks the configuration and copies it.
 */
#include "auvid_excitation_init_internal.h"

#include <string.h>

#include "../base/auvid_refusal_internal.h"

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

/* What all kinds of segments share. */
#define SEGMENT(name, low, high) REALS_IN(auvid_segment_t, name, 1, low, high)
static const auvid_field_t excitation_segment[] = {
    WHOLE_IN(auvid_segment_t, dof, 1, 0, AUVID_DOF_COUNT - 1),
    WHOLE_IN(auvid_segment_t, kind, 1, 0, AUVID_SEGMENT_KIND_COUNT - 1),
    SEGMENT(duration_s, AUVID_C(0.0), AUVID_EXCITATION_LONGEST_S),
    SEGMENT(pause_s, AUVID_C(0.0), AUVID_EXCITATION_LONGEST_S),
    SEGMENT(amplitude, -AUVID_EXCITATION_LARGEST, AUVID_EXCITATION_LARGEST),
    SEGMENT(from, -AUVID_EXCITATION_LARGEST, AUVID_EXCITATION_LARGEST),
    SEGMENT(fade_s, AUVID_C(0.0), AUVID_LARGEST),
    SEGMENT(frequency_hz, -AUVID_LARGEST, AUVID_LARGEST),
    SEGMENT(frequency_high_hz, -AUVID_LARGEST, AUVID_LARGEST),
    SEGMENT(phase, -AUVID_LARGEST, AUVID_LARGEST),
    SEGMENT(hold_min_s, -AUVID_LARGEST, AUVID_LARGEST),
    SEGMENT(hold_max_s, -AUVID_LARGEST, AUVID_LARGEST),
};

/* Refuse a field that is not in low..high. */
static auvid_status_t excitation_in(auvid_refusal_t *why, const char *field, auvid_real_t x,
                                    auvid_real_t low, auvid_real_t high)
{
    return auvid_excitation_in(x, low, high)
               ? AUVID_OK
               : auvid_refuse(why, AUVID_ERR_RANGE, field, x, x < low ? low : high);
}

static auvid_status_t excitation_check_frequencies(const auvid_segment_t *s, auvid_refusal_t *why)
{
    auvid_status_t status = AUVID_OK;
    if (!(s->frequency_hz > AUVID_C(0.0))) {
        return auvid_refuse(why, AUVID_ERR_RANGE, "frequency_hz", s->frequency_hz, AUVID_C(0.0));
    }
    if (s->kind == AUVID_SEGMENT_SINES) {
        return excitation_in(why, "frequency_high_hz", s->frequency_high_hz, s->frequency_hz,
                             AUVID_EXCITATION_HIGHEST_HZ);
    }
    status = excitation_in(why, "frequency_hz", s->frequency_hz, AUVID_C(0.0),
                           AUVID_EXCITATION_HIGHEST_HZ);
    return status < 0 ? status
                      : excitation_in(why, "phase", s->phase, AUVID_C(-100.0), AUVID_C(100.0));
}

static auvid_status_t excitation_check_steps(const auvid_segment_t *s, auvid_refusal_t *why)
{
    auvid_real_t shortest =
        auvid_max(s->fade_s, s->duration_s / (auvid_real_t)AUVID_EXCITATION_HOLDS);
    bool enough = s->hold_min_s * (auvid_real_t)AUVID_EXCITATION_HOLDS >= s->duration_s;
    if (!(s->hold_min_s > AUVID_C(0.0) && s->hold_min_s >= s->fade_s && enough)) {
        return auvid_refuse(why, AUVID_ERR_RANGE, "hold_min_s", s->hold_min_s, shortest);
    }
    return excitation_in(why, "hold_max_s", s->hold_max_s, s->hold_min_s,
                         AUVID_EXCITATION_LONGEST_S);
}

static auvid_status_t excitation_check_segment(const auvid_segment_t *s, auvid_refusal_t *why)
{
    auvid_status_t status = auvid_check_fields(
        s, excitation_segment, sizeof excitation_segment / sizeof excitation_segment[0], why);
    if (status >= 0) {
        status =
            excitation_in(why, "fade_s", s->fade_s, AUVID_C(0.0), s->duration_s * AUVID_C(0.5));
    }
    if (status < 0) {
        return status;
    }
    switch (s->kind) {
    case AUVID_SEGMENT_SINES:
        if (s->sines < 1 || s->sines > AUVID_MAX_SINES) {
            return auvid_refuse(why, AUVID_ERR_SIZE, "sines", (auvid_real_t)s->sines,
                                (auvid_real_t)(s->sines < 1 ? 1 : AUVID_MAX_SINES));
        }
        return excitation_check_frequencies(s, why);
    case AUVID_SEGMENT_SINE:
        return excitation_check_frequencies(s, why);
    case AUVID_SEGMENT_STEPS:
        return excitation_check_steps(s, why);
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

/* Check the segments, and compute the length of the sequence. */
static auvid_status_t excitation_check_segments(const auvid_excitation_config_t *cfg,
                                                uint64_t *sequence_us, auvid_refusal_t *why)
{
    uint64_t length_us[AUVID_DOF_COUNT] = {0};
    *sequence_us = 0;
    for (int i = 0; i < cfg->segments; ++i) {
        const auvid_segment_t *s = &cfg->segment[i];
        auvid_status_t status = excitation_check_segment(s, why);
        if (status < 0) {
            (void)auvid_refuse_element(why, status, i);
            return auvid_refuse_part(why, status, "excitation.segment");
        }
        length_us[s->dof] += auvid_excitation_us(s->pause_s) + auvid_excitation_us(s->duration_s);
        *sequence_us = length_us[s->dof] > *sequence_us ? length_us[s->dof] : *sequence_us;
    }
    return AUVID_OK;
}

static uint64_t excitation_run_us(const auvid_excitation_config_t *cfg, uint64_t sequence_us)
{
    return cfg->duration_s > AUVID_C(0.0) ? auvid_excitation_us(cfg->duration_s) : sequence_us;
}

auvid_status_t auvid_excitation_check(const auvid_excitation_config_t *cfg, uint64_t *sequence_us,
                                      auvid_refusal_t *why)
{
    static const auvid_field_t fields[] = {
        REALS_IN(auvid_excitation_config_t, excursion_limit, AUVID_DOF_COUNT, AUVID_C(0.0),
                 AUVID_LARGEST),
        REALS_IN(auvid_excitation_config_t, duration_s, 1, AUVID_C(0.0),
                 AUVID_EXCITATION_LONGEST_RUN_S),
        REALS_IN(auvid_excitation_config_t, fade_s, 1, AUVID_C(0.0), AUVID_EXCITATION_LONGEST_S),
    };
    if (cfg->segments < 1 || cfg->segments > AUVID_MAX_SEGMENTS) {
        return auvid_refuse(why, AUVID_ERR_SIZE, "segments", (auvid_real_t)cfg->segments,
                            (auvid_real_t)(cfg->segments < 1 ? 1 : AUVID_MAX_SEGMENTS));
    }
    auvid_status_t status = auvid_check_fields(cfg, fields, sizeof fields / sizeof fields[0], why);
    if (status >= 0) {
        status = excitation_check_segments(cfg, sequence_us, why);
    }
    if (status < 0) {
        return status;
    }
    if (*sequence_us == 0) {
        return auvid_refuse(why, AUVID_ERR_RANGE, "segments", AUVID_C(0.0), AUVID_C(0.0));
    }
    auvid_real_t half_s = auvid_seconds(0, excitation_run_us(cfg, *sequence_us)) * AUVID_C(0.5);
    return 2 * auvid_excitation_us(cfg->fade_s) > excitation_run_us(cfg, *sequence_us)
               ? auvid_refuse(why, AUVID_ERR_RANGE, "fade_s", cfg->fade_s, half_s)
               : AUVID_OK;
}

auvid_status_t auvid_excitation_init(auvid_excitation_t *e, const auvid_excitation_config_t *cfg)
{
    uint64_t sequence_us = 0;
    if (e == NULL || cfg == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_status_t status = auvid_excitation_check(cfg, &sequence_us, NULL);
    if (status < 0) {
        return status;
    }
    e->cfg = *cfg;
    memset(&e->sequence_us, 0, sizeof *e - offsetof(auvid_excitation_t, sequence_us));
    e->sequence_us = sequence_us;
    e->run_us = excitation_run_us(&e->cfg, sequence_us);
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
