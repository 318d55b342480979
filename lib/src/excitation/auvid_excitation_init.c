/*
 * Initialisation of the excitation: checks the configuration and copies it.
 */
#include "auvid_excitation_init_internal.h"

#include <string.h>

#include "../base/auvid_refusal_internal.h"

#define SHORTEST_US 1000u /* of the sequence, and of the run: repetitions are counted in 32 bits */

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

static const auvid_field_t excitation_sine_fields[] = {
    REALS_ABOVE(auvid_segment_t, frequency_hz, 1, AUVID_C(0.0), AUVID_EXCITATION_HIGHEST_HZ),
    SEGMENT(phase, AUVID_C(-100.0), AUVID_C(100.0)),
};

static void excitation_check_segment(const auvid_segment_t *s, auvid_refusal_t *why)
{
    auvid_real_t hz = s->frequency_hz, hold_s = s->hold_min_s;
    AUVID_CHECK_TABLE(why, s, excitation_segment);
    auvid_check_in(why, "fade_s", s->fade_s, AUVID_C(0.0), s->duration_s * AUVID_C(0.5));
    if (s->kind == AUVID_SEGMENT_SINE) {
        AUVID_CHECK_TABLE(why, s, excitation_sine_fields);
    } else if (s->kind == AUVID_SEGMENT_SINES) {
        auvid_check_count(why, AUVID_ERR_SIZE, "sines", s->sines, AUVID_MAX_SINES);
        auvid_check_fields(why, s, excitation_sine_fields, 1);
        auvid_check_in(why, "frequency_high_hz", s->frequency_high_hz, hz,
                       AUVID_EXCITATION_HIGHEST_HZ);
    } else if (s->kind == AUVID_SEGMENT_STEPS) {
        auvid_real_t holds = (auvid_real_t)AUVID_EXCITATION_HOLDS;
        bool enough = hold_s >= s->fade_s && hold_s * holds >= s->duration_s;
        auvid_check_limit(why, hold_s > AUVID_C(0.0) && enough, AUVID_ERR_RANGE, "hold_min_s",
                          hold_s, auvid_max(s->fade_s, s->duration_s / holds));
        auvid_check_in(why, "hold_max_s", s->hold_max_s, hold_s, AUVID_EXCITATION_LONGEST_S);
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
static void excitation_check_segments(const auvid_excitation_config_t *cfg, uint64_t *sequence_us,
                                      auvid_refusal_t *why)
{
    uint64_t length_us[AUVID_DOF_COUNT] = {0};
    for (int i = 0; i < cfg->segments; ++i) {
        const auvid_segment_t *s = &cfg->segment[i];
        auvid_check_part(why, "excitation.segment");
        auvid_check_element(why, i);
        excitation_check_segment(s, why);
        if (why->status < 0) {
            return;
        }
        length_us[s->dof] += auvid_excitation_us(s->pause_s) + auvid_excitation_us(s->duration_s);
        *sequence_us = length_us[s->dof] > *sequence_us ? length_us[s->dof] : *sequence_us;
    }
}

static uint64_t excitation_run_us(const auvid_excitation_config_t *cfg, uint64_t sequence_us)
{
    return cfg->duration_s > AUVID_C(0.0) ? auvid_excitation_us(cfg->duration_s) : sequence_us;
}

static uint64_t excitation_check(const auvid_excitation_config_t *cfg, auvid_refusal_t *why)
{
    static const auvid_field_t fields[] = {
        REALS_IN(auvid_excitation_config_t, excursion_limit, AUVID_DOF_COUNT, AUVID_C(0.0),
                 AUVID_LARGEST),
        REALS_IN(auvid_excitation_config_t, duration_s, 1, AUVID_C(0.0),
                 AUVID_EXCITATION_LONGEST_RUN_S),
        REALS_IN(auvid_excitation_config_t, fade_s, 1, AUVID_C(0.0), AUVID_EXCITATION_LONGEST_S),
    };
    uint64_t sequence_us = 0;
    auvid_check_count(why, AUVID_ERR_SIZE, "segments", cfg->segments, AUVID_MAX_SEGMENTS);
    AUVID_CHECK_TABLE(why, cfg, fields);
    if (why->status == AUVID_OK) {
        excitation_check_segments(cfg, &sequence_us, why);
    }
    if (why->status == AUVID_OK) {
        uint64_t run_us = excitation_run_us(cfg, sequence_us);
        auvid_check_part(why, "excitation");
        auvid_check_that(why, sequence_us >= SHORTEST_US, AUVID_ERR_RANGE, "segments");
        auvid_check_that(why, run_us >= SHORTEST_US, AUVID_ERR_RANGE, "duration_s");
        auvid_check_limit(why, 2 * auvid_excitation_us(cfg->fade_s) <= run_us, AUVID_ERR_RANGE,
                          "fade_s", cfg->fade_s, auvid_seconds(0, run_us) * AUVID_C(0.5));
    }
    return sequence_us;
}

void auvid_excitation_set_up(auvid_excitation_t *e, const auvid_excitation_config_t *cfg,
                             auvid_refusal_t *why)
{
    uint64_t sequence_us = excitation_check(cfg, why);
    if (why->status != AUVID_OK) {
        return;
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
}

auvid_status_t auvid_excitation_init(auvid_excitation_t *e, const auvid_excitation_config_t *cfg)
{
    auvid_refusal_t why;
    if (e == NULL || cfg == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_check_begin(&why);
    auvid_excitation_set_up(e, cfg, &why);
    return why.status;
}
