/*
 * Excitation (Karras et al. 2013, III-A): steps for the drags, sines for the inertias.
 *
 * e: time since start, in repetition k of the sequence; s: time since the segment began.
 *   tau_dof(e) = run(e) * fade(s) * shape(s)
 *   run(e)     = w(e) w(run - e) w(stop + fade - e)       w: raised cosine, 0..1
 * A random segment seeds its generator from (seed, k, segment) when it begins, so the wrench does
 * not depend on the earlier ticks.
 *
 * Drift: d the displacement, L the excursion limit, A the peak of the segment,
 *   excursion = clamp((|d| - L) / L, 0, 1) sign(d)
 *   shape     = clamp(shape - A excursion fade, -A, A)
 * Random steps also choose the sign that brings the DoF back. Signs of steps do not suffice against
 * sines and a current.
 */
#include "auvid_excitation_init_internal.h"

#include <string.h>

#define TWO_PI AUVID_C(6.28318530717958647693)
#define SIGN_CHANGES AUVID_C(0.75) /* probability */
#define JITTER AUVID_C(0.12)       /* of the frequencies of a sum of sines */
#define LARGEST_RATIO AUVID_C(1e9) /* of two frequencies */
#define ROOT_STEPS (4 * AUVID_MAX_SINES)
#define POINTS_PER_PERIOD AUVID_C(8.0)

typedef auvid_excitation_channel_t channel_t;

static auvid_real_t excitation_to_s(uint32_t us)
{
    return (auvid_real_t)us * AUVID_C(1e-6);
}

/* Return sin(2 pi cycles + phase), cycles >= 0. */
static auvid_real_t excitation_sine(auvid_real_t cycles, auvid_real_t phase)
{
    return auvid_sin_turned(TWO_PI * (cycles - (auvid_real_t)(uint32_t)cycles) + phase, 0);
}

/* Return w = (1 - cos(pi x / length)) / 2 within the fade, 1 after it. */
static auvid_real_t excitation_raised_cosine(uint64_t x_us, uint32_t length_us)
{
    if (x_us >= length_us) {
        return AUVID_C(1.0);
    }
    auvid_real_t part = (auvid_real_t)(uint32_t)x_us / (auvid_real_t)length_us;
    return AUVID_C(0.5) - AUVID_C(0.5) * auvid_sin_turned(AUVID_PI * part, 1);
}

/* ---- random steps ---- */

static auvid_real_t excitation_steps_value(const channel_t *c, uint32_t s_us, uint32_t fade_us)
{
    auvid_real_t part = excitation_raised_cosine(s_us - c->hold_from_us, fade_us);
    return part < AUVID_C(1.0) ? c->before + (c->level - c->before) * part : c->level;
}

/* Begin a hold at s_us, for ever. Every change of level takes fade_us. */
static void excitation_begin_hold(channel_t *c, uint32_t s_us, uint32_t fade_us)
{
    c->before = excitation_steps_value(c, s_us, fade_us);
    c->hold_from_us = s_us;
    c->hold_to_us = UINT32_MAX;
}

/* Begin the next hold; the last one fades to zero at end_us. The signal is a staircase filtered by
 * one window, so pairs have no net impulse. */
static void excitation_next_hold(channel_t *c, const auvid_segment_t *segment, uint32_t end_us,
                                 uint32_t fade_us, auvid_real_t excursion)
{
    auvid_rng_t rng;
    uint64_t to;
    excitation_begin_hold(c, c->hold_to_us, fade_us);
    if (c->hold_from_us >= end_us) {
        c->level = AUVID_C(0.0);
        return;
    }
    if (c->second) {
        c->level = -c->level;
        c->second = false;
    } else {
        memcpy(rng.s, c->rng, sizeof rng.s);
        bool change = auvid_rng_uniform(&rng) < SIGN_CHANGES;
        auvid_real_t level =
            auvid_rng_uniform(&rng) < AUVID_C(0.5) ? EXCITATION_LOW_LEVEL : AUVID_C(1.0);
        /* Within pairs the sign has already changed: each pair begins with the same sign. */
        c->negative = c->negative != (change && !segment->pairs);
        if (auvid_abs(excursion) > AUVID_C(0.0)) {
            c->negative = (excursion > AUVID_C(0.0)) == (segment->amplitude > AUVID_C(0.0));
        }
        c->level = c->negative ? -level : level;
        c->hold_us = (uint32_t)auvid_excitation_us(segment->hold_min_s +
                                                   (segment->hold_max_s - segment->hold_min_s) *
                                                       auvid_rng_uniform(&rng));
        memcpy(c->rng, rng.s, sizeof rng.s);
        c->second = segment->pairs;
        if (segment->pairs && c->hold_from_us + 2 * (uint64_t)c->hold_us > end_us) {
            c->level = AUVID_C(0.0);
            return;
        }
    }
    to = c->hold_from_us + (uint64_t)c->hold_us;
    c->hold_to_us = to < end_us ? (uint32_t)to : end_us;
}

static auvid_real_t excitation_play_steps(channel_t *c, const auvid_segment_t *segment,
                                          uint32_t s_us, uint32_t duration_us,
                                          auvid_real_t excursion)
{
    uint32_t fade_us = (uint32_t)auvid_excitation_us(segment->fade_s);
    /* duration / shortest hold is at most AUVID_EXCITATION_HOLDS; one more for a rounded hold, one
     * for the remainder at the end. */
    for (int i = 0; i < AUVID_EXCITATION_HOLDS + 2 && s_us >= c->hold_to_us; ++i) {
        excitation_next_hold(c, segment, duration_us - fade_us, fade_us, excursion);
    }
    return excitation_steps_value(c, s_us, fade_us);
}

/* ---- sum of sines ---- */

/* Return r^k. */
static auvid_real_t excitation_power(auvid_real_t r, int k)
{
    auvid_real_t p = AUVID_C(1.0);
    for (; k > 0; --k) {
        p *= r;
    }
    return p;
}

/* Return the positive root of r^k = q, 1 <= q <= LARGEST_RATIO, by Newton's method from above,
 *     r <- r - (r - q / r^(k-1)) / k,
 * which decreases until rounding stops it. */
static auvid_real_t excitation_root(auvid_real_t q, int k)
{
    auvid_real_t r = AUVID_C(1.0);
    for (int i = 0; i < 32 && k > 0 && excitation_power(r, k) < q; ++i) {
        r *= AUVID_C(2.0);
    }
    auvid_real_t part = k > 0 ? AUVID_C(1.0) / (auvid_real_t)k : AUVID_C(0.0);
    for (int i = 0; i < ROOT_STEPS; ++i) {
        auvid_real_t next = r - (r - q / excitation_power(r, k - 1)) * part;
        if (!(next < r)) {
            break;
        }
        r = next;
    }
    return r;
}

/* Return the fraction of a cycle in units of 2^-32. */
static uint32_t excitation_to_phase(auvid_real_t cycles)
{
    return (uint32_t)((cycles - (auvid_real_t)(uint32_t)cycles) * AUVID_C(4294967296.0));
}

/* Return sin(2 pi phase / 2^32) in units of 2^-15. Integer arithmetic is faster on cores without
 * floating point. Over half a cycle it is p (a + b p) with the parabola p = 4 y (1 - y), fitted
 * with all roundings. The error is 8.6e-4, plus 2e-5 for the rounded phase after 256 steps. */
#define PHASE_SINE_ERROR AUVID_C(8.8e-4)
static int32_t excitation_phase_sine(uint32_t phase)
{
    uint32_t y = (phase & 0x7fffffffu) >> 16;
    uint32_t p = y * (32768u - y) >> 13;
    int32_t sine = (int32_t)(p * (25478u + (7267u * p >> 15)) >> 15);
    return (phase >> 31) != 0 ? -sine : sine;
}

/* Return an upper bound of the peak of sum sin(2 pi (f_i s + c_i)) over 0..T, from points h apart,
 * ends included. At an inner extremum the slope is zero and the nearest point at most h / 2 away:
 *   peak <= max over points + n error of a sine + h^2 / 8 * sum (2 pi f_i)^2,   and peak <= n. */
static auvid_real_t excitation_sines_peak(const channel_t *c, uint32_t sines,
                                          auvid_real_t duration_s)
{
    uint32_t phase[AUVID_MAX_SINES] = {0}, turn[AUVID_MAX_SINES] = {0};
    auvid_real_t highest = AUVID_C(0.0);
    auvid_real_t curvature = AUVID_C(0.0);
    auvid_real_t n = (auvid_real_t)sines;
    int32_t peak = 0;
    for (uint32_t i = 0; i < sines; ++i) {
        highest = auvid_max(highest, c->frequency_hz[i]);
        curvature += (TWO_PI * c->frequency_hz[i]) * (TWO_PI * c->frequency_hz[i]);
    }
    auvid_real_t wanted = POINTS_PER_PERIOD * highest * duration_s + AUVID_C(1.0);
    uint32_t steps = (uint32_t)auvid_min(wanted, (auvid_real_t)AUVID_EXCITATION_SCAN);
    auvid_real_t h = duration_s / (auvid_real_t)steps;
    for (uint32_t i = 0; i < sines; ++i) {
        phase[i] = excitation_to_phase(c->cycles[i]);
        turn[i] = excitation_to_phase(c->frequency_hz[i] * h);
    }
    for (uint32_t k = 0; k <= steps; ++k) {
        int32_t sum = 0;
        for (uint32_t i = 0; i < sines; ++i) {
            sum += excitation_phase_sine(phase[i]);
            phase[i] += turn[i];
        }
        sum = sum < 0 ? -sum : sum;
        peak = sum > peak ? sum : peak;
    }
    auvid_real_t found = (auvid_real_t)peak * AUVID_C(3.0517578125e-5) + n * PHASE_SINE_ERROR;
    return auvid_min(found + h * h * AUVID_C(0.125) * curvature, n);
}

static void excitation_begin_sines(channel_t *c, const auvid_segment_t *segment, auvid_rng_t *rng)
{
    auvid_real_t ratio = excitation_root(
        auvid_min(segment->frequency_high_hz / segment->frequency_hz, LARGEST_RATIO),
        (int)segment->sines - 1);
    auvid_real_t f = segment->frequency_hz;
    for (uint32_t i = 0; i < segment->sines; ++i) {
        auvid_real_t u = AUVID_C(2.0) * auvid_rng_uniform(rng) - AUVID_C(1.0);
        c->frequency_hz[i] = f * (AUVID_C(1.0) + JITTER * u);
        c->cycles[i] = auvid_rng_uniform(rng);
        f *= ratio;
    }
    c->scale = AUVID_C(1.0) / excitation_sines_peak(c, segment->sines, segment->duration_s);
}

static auvid_real_t excitation_play_sines(const channel_t *c, uint32_t sines, auvid_real_t s)
{
    auvid_real_t sum = AUVID_C(0.0);
    for (uint32_t i = 0; i < sines; ++i) {
        sum += excitation_sine(c->frequency_hz[i] * s + c->cycles[i], AUVID_C(0.0));
    }
    return sum * c->scale;
}

/* ---- segments ---- */

static void excitation_begin_segment(channel_t *c, const auvid_segment_t *segment, uint32_t index,
                                     uint32_t repetition, uint64_t seed)
{
    auvid_rng_t rng;
    uint64_t id = ((uint64_t)repetition << 8) + index + 1u;
    /* An odd factor distributes the id over all bits: neighbouring seeds share no stream. */
    auvid_rng_seed(&rng, seed + id * 0xD1342543DE82EF95u);
    memset(c, 0, sizeof *c);
    c->segment = (uint8_t)(index + 1u);
    c->repetition = repetition;
    if (segment->kind == AUVID_SEGMENT_STEPS) {
        c->negative = auvid_rng_uniform(&rng) < AUVID_C(0.5);
    } else if (segment->kind == AUVID_SEGMENT_SINES) {
        excitation_begin_sines(c, segment, &rng);
    }
    memcpy(c->rng, rng.s, sizeof rng.s);
}

auvid_excitation_channel_t *auvid_excitation_due(auvid_excitation_t *e, uint32_t index,
                                                 uint64_t t_us)
{
    const auvid_segment_t *segment = &e->cfg.segment[index];
    channel_t *c = &e->channel[segment->dof];
    uint32_t s_us = (uint32_t)(t_us - e->start_us);
    if (c->segment == 0) {
        excitation_begin_segment(c, segment, index, 0, e->cfg.seed);
    }
    if (s_us < c->hold_to_us) {
        return NULL;
    }
    excitation_begin_hold(c, s_us, (uint32_t)auvid_excitation_us(segment->fade_s));
    return c;
}

static auvid_real_t excitation_play_segment(channel_t *c, const auvid_segment_t *segment,
                                            uint32_t s_us, uint32_t duration_us,
                                            auvid_real_t excursion)
{
    auvid_real_t s = excitation_to_s(s_us);
    auvid_real_t a = segment->amplitude;
    auvid_real_t largest = auvid_abs(a);
    auvid_real_t y = AUVID_C(0.0);
    uint32_t fade_us = (uint32_t)auvid_excitation_us(segment->fade_s);
    switch (segment->kind) {
    case AUVID_SEGMENT_STEP:
        y = a;
        break;
    case AUVID_SEGMENT_RAMP:
        y = segment->from + (a - segment->from) * (s / excitation_to_s(duration_us));
        largest = auvid_max(largest, auvid_abs(segment->from));
        break;
    case AUVID_SEGMENT_SINE:
        y = a * excitation_sine(segment->frequency_hz * s, segment->phase);
        break;
    case AUVID_SEGMENT_SINES:
        y = a * excitation_play_sines(c, segment->sines, s);
        break;
    case AUVID_SEGMENT_STEPS:
        y = a * excitation_play_steps(c, segment, s_us, duration_us, excursion);
        break;
    case AUVID_SEGMENT_PAUSE:
    case AUVID_SEGMENT_KIND_COUNT:
    default:
        return AUVID_C(0.0);
    }
    auvid_real_t fade = excitation_raised_cosine(s_us, fade_us) *
                        excitation_raised_cosine(duration_us - s_us, fade_us);
    y *= segment->kind == AUVID_SEGMENT_STEPS ? AUVID_C(1.0) : fade; /* steps contain their fades */
    if (auvid_abs(excursion) > AUVID_C(0.0)) {
        y -= largest * excursion * fade;
    }
    return auvid_clamp_here(y, -largest, largest); /* against rounding */
}

/* ---- the run ---- */

auvid_status_t auvid_excitation_start(auvid_excitation_t *e, uint64_t t_us)
{
    if (e == NULL) {
        return AUVID_ERR_NULL;
    }
    memset(e->channel, 0, sizeof e->channel);
    memset(e->displacement, 0, sizeof e->displacement);
    e->start_us = t_us;
    e->last_us = t_us;
    e->repetition = 0;
    e->repeated_us = 0;
    e->running = true;
    e->stopping = false;
    e->finished = false;
    return AUVID_OK;
}

auvid_status_t auvid_excitation_stop(auvid_excitation_t *e, uint64_t t_us)
{
    if (e == NULL) {
        return AUVID_ERR_NULL;
    }
    if (e->running && !e->stopping) {
        if (t_us < e->last_us) {
            return AUVID_ERR_TIME_BACK;
        }
        e->stopping = true;
        e->stop_us = t_us;
        e->last_us = t_us;
    }
    return AUVID_OK;
}

auvid_real_t auvid_excitation_excursion(const auvid_excitation_t *e, int dof)
{
    auvid_real_t limit = e->cfg.excursion_limit[dof];
    auvid_real_t d = e->displacement[dof];
    auvid_real_t beyond = auvid_abs(d) - limit;
    if (!(limit > AUVID_C(0.0) && beyond > AUVID_C(0.0))) {
        return AUVID_C(0.0);
    }
    auvid_real_t part = beyond < limit ? beyond / limit : AUVID_C(1.0);
    return d < AUVID_C(0.0) ? -part : part;
}

static void excitation_play_all(auvid_excitation_t *e, uint64_t elapsed_us, auvid_real_t weight,
                                auvid_real_t *wrench)
{
    uint64_t begins_us[AUVID_DOF_COUNT] = {0};
    if (elapsed_us - e->repeated_us >= e->sequence_us) {
        e->repetition = (uint32_t)auvid_divide(elapsed_us, e->sequence_us);
        e->repeated_us = e->repetition * e->sequence_us;
    }
    uint64_t in_us = elapsed_us - e->repeated_us;
    for (uint32_t i = 0; i < e->cfg.segments; ++i) {
        const auvid_segment_t *segment = &e->cfg.segment[i];
        uint64_t begin_us = begins_us[segment->dof] + e->pause_us[i];
        begins_us[segment->dof] = begin_us + e->duration_us[i];
        if (in_us >= begin_us && in_us < begins_us[segment->dof]) {
            channel_t *c = &e->channel[segment->dof];
            if (c->segment != i + 1u || c->repetition != e->repetition) {
                excitation_begin_segment(c, segment, i, e->repetition, e->cfg.seed);
            }
            wrench[segment->dof] =
                weight * excitation_play_segment(c, segment, (uint32_t)(in_us - begin_us),
                                                 e->duration_us[i],
                                                 auvid_excitation_excursion(e, (int)segment->dof));
        }
    }
}

auvid_status_t auvid_excitation_step(auvid_excitation_t *e, uint64_t t_us,
                                     auvid_real_t wrench[AUVID_DOF_COUNT])
{
    if (wrench == NULL) {
        return AUVID_ERR_NULL;
    }
    for (int i = 0; i < AUVID_DOF_COUNT; ++i) {
        wrench[i] = AUVID_C(0.0);
    }
    if (e == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!e->running) {
        return AUVID_FINISHED;
    }
    if (t_us < e->last_us) {
        return AUVID_ERR_TIME_BACK;
    }
    e->last_us = t_us;
    uint64_t elapsed_us = t_us - e->start_us;
    uint64_t stopped_us = e->stopping ? t_us - e->stop_us : 0;
    if (elapsed_us >= e->run_us || (e->stopping && stopped_us >= e->fade_us)) {
        e->running = false;
        e->finished = true;
        return AUVID_FINISHED;
    }
    auvid_real_t weight = excitation_raised_cosine(elapsed_us, e->fade_us) *
                          excitation_raised_cosine(e->run_us - elapsed_us, e->fade_us);
    if (e->stopping) {
        weight *= excitation_raised_cosine(e->fade_us - stopped_us, e->fade_us);
    }
    excitation_play_all(e, elapsed_us, weight, wrench);
    return AUVID_OK;
}

auvid_status_t auvid_excitation_set_displacement(auvid_excitation_t *e,
                                                 const auvid_real_t displacement[AUVID_DOF_COUNT])
{
    if (e == NULL || displacement == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!auvid_all_finite(displacement, AUVID_DOF_COUNT)) {
        return AUVID_ERR_NOT_FINITE;
    }
    memcpy(e->displacement, displacement, sizeof e->displacement);
    return AUVID_OK;
}

auvid_real_t auvid_excitation_progress(const auvid_excitation_t *e)
{
    if (e == NULL || !e->running) {
        return e != NULL && e->finished ? AUVID_C(1.0) : AUVID_C(0.0);
    }
    uint64_t elapsed_us = e->last_us - e->start_us; /* a stop may come late */
    return elapsed_us < e->run_us ? auvid_real_of(elapsed_us) / auvid_real_of(e->run_us)
                                  : AUVID_C(1.0);
}
