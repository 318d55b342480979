/*
 * Adaptive excitation.
 *
 * The excitation plays a segment of random steps in each DoF (auvid_excitation.c). This module
 * chooses level and length of each hold in their place, before the excitation would draw them. A
 * DoF that does not play has level zero, and is not brought back.
 *
 * Under white noise, drag a u + b u^2 is determined best by two speeds: the highest and 0.41 of it
 * (the extrema of the polynomial that deviates least from zero). The optimum for a has 0.85 of the
 * time at the low speed, that for b 0.71. A step of 0.3 leads to 0.3-0.55 of the highest speed for
 * any fraction of linear drag.
 *
 * The optimum is flat. In simulation, Girona500 with masses and drags halved and doubled,
 * disturbances of 0.3 to 3 N: the standard errors change by less than 5 % for holds of three to six
 * time constants, and for 0.5 to 0.8 of the time at the low speed. Persistent signs
 * (ADAPTIVE_SIGN_CHANGES) reduce the largest ones by 5 %. Sums of sines are never better than
 * steps.
 *
 * Known degrees of freedom continue to play: this costs no time, improves their estimates, and
 * keeps their sets in the ring. At rest their sets leave the ring, and with them the information.
 * At 3 N (100 runs) 40 instead of 58 runs then had all parameters known at the same time.
 */
#include "auvid/adaptive.h"

#include <string.h>

#include "../metric/auvid_confidence_notes_internal.h"
#include "auvid_actuation_internal.h"
#include "auvid_identifier_internal.h"
#include "../base/auvid_refusal_internal.h"
#include "../excitation/auvid_excitation_init_internal.h"
#include "../base/auvid_math_internal.h"

#define MAX_RATIO AUVID_C(2.25)    /* 1.5^2: of the squared half-width over the allowed one */
#define UNKNOWN_RATIO AUVID_C(1e9) /* the same for a parameter without information */

#define LOW_PART_LINEAR AUVID_C(0.67) /* of the time, where linear drag is missing */
#define LOW_PART AUVID_C(0.4)         /* with linear drag known */
#define ADAPTIVE_SIGN_CHANGES AUVID_C(0.3)
#define TIME_CONSTANTS AUVID_C(4.0)
#define SWING_S AUVID_C(1.5)        /* hold in roll and pitch, by their restoring moments */
#define LEAST_LIMIT AUVID_C(0.1)    /* [m]; 0 would be none */
#define DEPTHS (AUVID_GUARD_BIT(AUVID_GUARD_DEPTH_MIN) | AUVID_GUARD_BIT(AUVID_GUARD_DEPTH_MAX))
#define LIMIT_FRACTION AUVID_C(0.3) /* of the guard's distance, for the overshoot */

enum { MIN_SETS = 3, MIN_ROWS = 12 }; /* before abandoning; in a set completed early */

static auvid_adaptive_t *adaptive_state(const auvid_identifier_t *id)
{
    return (auvid_adaptive_t *)id->actuation->shape_context;
}

/* ---- the next hold ---- */

/* Sum the estimates of DoF j's parameters of a kind. */
static auvid_real_t adaptive_parameter_sum(const auvid_identifier_t *id, int j,
                                           auvid_parameter_kind_t kind)
{
    const auvid_vehicle_t *vehicle = identifier_vehicle(id);
    const auvid_real_t *pi = identifier_read_estimate(id)->pi;
    auvid_real_t sum = AUVID_C(0.0);
    for (int i = 0; i < vehicle->parameters; ++i) {
        const auvid_parameter_t *p = &vehicle->parameter[i];
        sum += (int)p->dof == j && p->kind == kind ? pi[i] : AUVID_C(0.0);
    }
    return sum;
}

/* Return the hold time of a step of DoF j to a force F: TIME_CONSTANTS times m / (a + 2 b u), with
 * a u + b u^2 = F, u = 2 F / (a + sqrt(a^2 + 4 b F)). */
static auvid_real_t adaptive_hold_s(const auvid_identifier_t *id, int j, auvid_real_t force)
{
    auvid_real_t m = adaptive_parameter_sum(id, j, AUVID_PARAMETER_MASS) +
                     adaptive_parameter_sum(id, j, AUVID_PARAMETER_INERTIA);
    auvid_real_t a =
        auvid_max(-adaptive_parameter_sum(id, j, AUVID_PARAMETER_LINEAR_DRAG), AUVID_C(0.0));
    auvid_real_t b =
        auvid_max(-adaptive_parameter_sum(id, j, AUVID_PARAMETER_QUADRATIC_DRAG), AUVID_C(0.0));
    auvid_real_t root = auvid_sqrt(a * a + AUVID_C(4.0) * b * force); /* = a + 2 b u */
    auvid_real_t s = TIME_CONSTANTS * m / root;
    bool known = ((id->estimate.excited | id->estimate.coupled) >> j & 1) && m > AUVID_C(0.0) &&
                 auvid_is_finite(s);
    if (j == AUVID_ROLL || j == AUVID_PITCH) {
        return SWING_S;
    }
    return known ? auvid_clamp(s, AUVID_C(1.5), AUVID_C(20.0)) : AUVID_C(6.0);
}

static bool adaptive_lacks_linear_drag(const auvid_identifier_t *id, int j)
{
    const auvid_parameter_t *p = identifier_vehicle(id)->parameter;
    bool lacks = false;
    for (int i = 0; i < identifier_vehicle(id)->parameters; ++i) {
        lacks |= (adaptive_state(id)->missing >> i & 1u) && (int)p[i].dof == j &&
                 p[i].kind == AUVID_PARAMETER_LINEAR_DRAG;
    }
    return lacks;
}

static auvid_real_t adaptive_amplitude(const auvid_identifier_t *id, int j)
{
    auvid_real_t peak[AUVID_DOF_COUNT];
    (void)auvid_excitation_peak(&id->actuation->excitation, peak);
    return peak[j];
}

/* Choose the hold of DoF j that begins now. */
static void adaptive_choose_hold(auvid_identifier_t *id, int j, auvid_excitation_channel_t *c)
{
    auvid_adaptive_t *a = adaptive_state(id);
    auvid_rng_t rng;
    memcpy(rng.s, c->rng, sizeof rng.s);
    auvid_real_t part = adaptive_lacks_linear_drag(id, j) ? LOW_PART_LINEAR : LOW_PART;
    bool low = a->low_owed[j] >= AUVID_C(0.0);
    auvid_real_t level = low ? EXCITATION_LOW_LEVEL : AUVID_C(1.0);
    auvid_real_t excursion = auvid_excitation_excursion(&id->actuation->excitation, j);
    auvid_real_t s = adaptive_hold_s(id, j, level * adaptive_amplitude(id, j)) *
                     (AUVID_C(0.75) + AUVID_C(0.5) * auvid_rng_uniform(&rng));
    bool negative = (c->level < AUVID_C(0.0)) != (auvid_rng_uniform(&rng) < ADAPTIVE_SIGN_CHANGES);
    if (auvid_abs(excursion) > AUVID_C(0.0)) {
        negative = excursion > AUVID_C(0.0);
    }
    memcpy(c->rng, rng.s, sizeof rng.s);
    a->low_owed[j] += s * (low ? part - AUVID_C(1.0) : part);
    c->level = (a->playing >> j & 1) == 0 ? AUVID_C(0.0) : negative ? -level : level;
    c->hold_to_us = c->hold_from_us + (uint32_t)(s * AUVID_C(1e6));
}

/* ---- a new estimate ---- */

/* Return (half-width with thrust and DVL scale as configured / allowed half-width)^2 of parameter
 * i: above 1 more excitation is needed. */
static auvid_real_t adaptive_variance_ratio(const auvid_identifier_t *id, int i)
{
    const auvid_estimate_t *e = identifier_read_estimate(id);
    auvid_real_t variance = auvid_estimate_covariance(e, identifier_vehicle(id), i, i);
    auvid_real_t ratio = AUVID_HALF_WIDTH / auvid_confidence_allowed(&id->metric.cfg, i, e->pi[i]);
    auvid_real_t square = ratio * ratio * variance;
    return square > AUVID_C(0.0) && square < UNKNOWN_RATIO ? square : UNKNOWN_RATIO; /* or NaN */
}

/* Will a parameter that is not known not be known at the end of the run? square: its ratio of
 * variances with `rows`; `most`: rows at the end. The prediction is rough. */
static bool adaptive_is_hopeless(auvid_real_t square, auvid_real_t rows, auvid_real_t most)
{
    return rows >= most || square * rows > MAX_RATIO * most;
}

/* Return the rows at the end of the run: the existing ones plus those to come, within the ring. */
static auvid_real_t adaptive_available_rows(const auvid_identifier_t *id, int j)
{
    const auvid_metric_config_t *m = &id->metric.cfg;
    uint64_t end_us = id->actuation->excitation.start_us + id->actuation->excitation.run_us;
    uint64_t left_us = end_us > id->t_us ? end_us - id->t_us : 0;
    auvid_real_t row_s = AUVID_C(1e-6) * (auvid_real_t)(id->recorder.cell_us * m->row_cells);
    auvid_real_t rows = (auvid_real_t)id->metric.result.dof_rows[j] +
                        AUVID_C(1e-6) * auvid_real_of(left_us) / row_s;
    return auvid_min(rows, (auvid_real_t)(m->sets * m->set_rows));
}

/* Is parameter i identifiable? Without uncertain inputs: if the inputs are as supplied, because
 * more motion does not check them. */
static bool adaptive_is_identifiable(const auvid_identifier_t *id, int i)
{
    const auvid_confidence_t *c = &identifier_read_estimate(id)->confidence;
    bool checks = id->attached.uncertain_functions != NULL;
    return (c->identifiable >> i & 1u) != 0 || c->note[i] == AUVID_NOTE_IMPLAUSIBLE ||
           (c->note[i] == AUVID_NOTE_UNCHECKED && !checks);
}

/* Does no excitation help? */
static bool adaptive_is_settled(auvid_note_t note)
{
    return note == AUVID_NOTE_SMALL || note == AUVID_NOTE_THRUST_SCALE || note == AUVID_NOTE_FIXED;
}

/* Classify parameter i as known, abandoned or missing. need: raised to the variance ratio of its
 * DoF if missing. */
static void adaptive_assess_parameter(auvid_identifier_t *id, int i, auvid_real_t *need)
{
    auvid_adaptive_t *a = adaptive_state(id);
    const auvid_estimate_t *e = identifier_read_estimate(id);
    int j = (int)identifier_vehicle(id)->parameter[i].dof;
    bool excitable = adaptive_amplitude(id, j) > AUVID_C(0.0);
    bool known = (adaptive_is_identifiable(id, i) && !(excitable && (e->coupled >> j & 1))) ||
                 adaptive_is_settled((auvid_note_t)e->confidence.note[i]) ||
                 (id->metric.cfg.closed_loop >> j & 1) != 0;
    auvid_real_t rows = (auvid_real_t)id->metric.result.dof_rows[j];
    a->missing &= ~(1u << i);
    /* in the ring: a change of the vehicle or longer cells drop its sets */
    bool tried = auvid_metric_excited_sets(&id->metric, j, 0) >= MIN_SETS;
    a->abandoned &= ~((uint32_t)(known || (excitable && !tried)) << i);
    if (known || (a->abandoned >> i & 1u)) {
        return;
    }
    auvid_real_t square = e->number == 0 ? UNKNOWN_RATIO : adaptive_variance_ratio(id, i);
    if (!excitable ||
        (tried && adaptive_is_hopeless(square, rows, adaptive_available_rows(id, j)))) {
        a->abandoned |= 1u << i;
        return;
    }
    a->missing |= 1u << i;
    need[j] = auvid_max(need[j], square);
    if (square > AUVID_C(1.0) && e->sets > 0) { /* a prior record has no rows */
        auvid_real_t more = auvid_min(rows * (square - AUVID_C(1.0)), AUVID_C(60000.0));
        uint16_t close = (uint16_t)auvid_max(more, (auvid_real_t)MIN_ROWS);
        a->close_rows = close > a->close_rows ? close : a->close_rows;
    }
}

/* Return whether the thrusters can produce these peaks at the same time. */
static bool adaptive_thrusters_suffice(const auvid_identifier_t *id, const auvid_real_t *peak)
{
    return id->actuation->allocation == NULL ||
           auvid_allocation_check(id->actuation->allocation, peak, NULL, NULL) >= 0;
}

/* Select the degrees of freedom that play: by need, as far as the thrusters suffice. */
static void adaptive_select_dofs(auvid_identifier_t *id, const auvid_real_t *need)
{
    auvid_real_t amplitude[AUVID_DOF_COUNT], peak[AUVID_DOF_COUNT] = {AUVID_C(0.0)};
    uint32_t asked = 0, playing = 0;
    (void)auvid_excitation_peak(&id->actuation->excitation, amplitude);
    for (int k = 0; k < AUVID_DOF_COUNT; ++k) {
        int neediest = -1;
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            bool open = (asked >> j & 1u) == 0 && amplitude[j] > AUVID_C(0.0);
            neediest = open && (neediest < 0 || need[j] > need[neediest]) ? j : neediest;
        }
        if (neediest < 0) {
            break;
        }
        asked |= 1u << neediest;
        peak[neediest] = amplitude[neediest];
        if (adaptive_thrusters_suffice(id, peak)) {
            playing |= 1u << neediest;
        } else {
            peak[neediest] = AUVID_C(0.0);
        }
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if ((playing ^ adaptive_state(id)->playing) >> j & 1u) {
            auvid_excitation_end_hold(&id->actuation->excitation, j);
        }
    }
    adaptive_state(id)->playing = (uint8_t)playing;
}

static void adaptive_evaluate(auvid_identifier_t *id)
{
    auvid_adaptive_t *a = adaptive_state(id);
    auvid_real_t need[AUVID_DOF_COUNT] = {AUVID_C(0.0)};
    const auvid_metric_t *m = &id->metric;
    a->estimate = id->estimate.number;
    a->sets = m->sets.recorded;
    a->close_rows = 0;
    for (int i = 0; i < identifier_vehicle(id)->parameters; ++i) {
        if (m->cfg.free == 0 || (m->cfg.free >> i & 1u)) {
            adaptive_assess_parameter(id, i, need);
        }
    }
    if (a->close_rows >= m->cfg.set_rows || a->sets >= m->cfg.sets) {
        a->close_rows = 0; /* a short set must not replace a full one in the ring */
    }
    adaptive_select_dofs(id, need);
    if (a->missing == 0) {
        (void)auvid_excitation_stop(&id->actuation->excitation, id->t_us);
    }
}

static void adaptive_begin_run(auvid_identifier_t *id)
{
    auvid_adaptive_t *a = adaptive_state(id);
    memset(a, 0, sizeof *a);
    a->run_us = id->actuation->excitation.start_us;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        a->low_owed[j] = AUVID_C(-1e-3);
    }
    adaptive_evaluate(id);
}

/* Return the part of its displacement that counts for a channel at s_us from the start. One that
 * begins from zero fades in first, while another one fades out of the same thrusters. */
static auvid_real_t adaptive_return_part(const auvid_excitation_channel_t *c, uint32_t s_us)
{
    auvid_real_t fades =
        AUVID_C(1e-6) * (auvid_real_t)(s_us - c->hold_from_us) / EXCITATION_STEP_FADE_S;
    bool begins = !(auvid_abs(c->before) > AUVID_C(0.0));
    return begins ? auvid_clamp(fades - AUVID_C(1.0), AUVID_C(0.0), AUVID_C(1.0)) : AUVID_C(1.0);
}

/* Called by the acting half before each step of the excitation. */
static void adaptive_shape(auvid_identifier_t *id)
{
    auvid_adaptive_t *a = adaptive_state(id);
    auvid_excitation_t *e = &id->actuation->excitation;
    if (a->run_us != e->start_us) {
        adaptive_begin_run(id);
    } else if (a->estimate != id->estimate.number) {
        adaptive_evaluate(id);
    }
    if (a->close_rows > 0 && id->metric.rows.set.rows >= a->close_rows) {
        a->close_rows = 0;
        identifier_take_set(id, auvid_metric_close(&id->metric));
    }
    for (uint32_t i = 0; i < e->cfg.segments; ++i) {
        int j = (int)e->cfg.segment[i].dof;
        auvid_excitation_channel_t *c = auvid_excitation_due(e, i, id->t_us);
        if ((a->playing >> j & 1) == 0) {
            auvid_excitation_clear_displacement(e, j);
        }
        if (c != NULL) {
            adaptive_choose_hold(id, j, c);
        }
        auvid_excitation_reduce_displacement(
            e, j, adaptive_return_part(&e->channel[j], (uint32_t)(id->t_us - e->start_us)));
    }
}

/* ---- configuration ---- */

void auvid_adaptive_defaults(auvid_adaptive_config_t *cfg)
{
    if (cfg != NULL) {
        memset(cfg, 0, sizeof *cfg);
        memcpy(cfg->excursion_limit, auvid_excitation_limit, sizeof cfg->excursion_limit);
        cfg->max_s = AUVID_C(480.0);
        cfg->seed = 1;
    }
}

static bool adaptive_is_excitable(const auvid_identifier_t *id, const auvid_adaptive_config_t *cfg,
                                  int j)
{
    return cfg->amplitude[j] > AUVID_C(0.0) &&
           (id->actuation->allocation == NULL || (id->actuation->allocation->actuated >> j & 1));
}

/* Check that some DoF is excitable, and that the thrusters suffice for each of them. */
static void adaptive_check_thrusters(const auvid_identifier_t *id,
                                     const auvid_adaptive_config_t *cfg, auvid_refusal_t *why)
{
    const auvid_allocation_t *allocation = id->actuation->allocation;
    uint32_t count = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t peak[AUVID_DOF_COUNT] = {AUVID_C(0.0)};
        auvid_allocation_fit_t fit = {.factor = AUVID_C(1.0)};
        if (adaptive_is_excitable(id, cfg, j)) {
            peak[j] = cfg->amplitude[j];
            ++count;
            bool suffices = allocation == NULL ||
                            auvid_allocation_check(allocation, peak, NULL, &fit) >= AUVID_OK;
            auvid_check_element(why, j);
            auvid_check_limit(why, suffices, AUVID_ERR_CAPACITY, "amplitude", peak[j],
                              fit.factor * peak[j]);
        }
    }
    auvid_check_element(why, -1);
    auvid_check_count(why, count == 0 ? AUVID_ERR_RANGE : AUVID_ERR_SIZE, "amplitude", count,
                      AUVID_MAX_SEGMENTS);
}

static void adaptive_check(const auvid_identifier_t *id, const auvid_adaptive_config_t *cfg,
                           auvid_refusal_t *why)
{
    static const auvid_field_t fields[] = {
        REALS_IN(auvid_adaptive_config_t, amplitude, AUVID_DOF_COUNT, AUVID_C(0.0),
                 AUVID_EXCITATION_LARGEST),
        REALS_IN(auvid_adaptive_config_t, excursion_limit, AUVID_DOF_COUNT, AUVID_C(0.0),
                 AUVID_LARGEST),
        REALS_IN(auvid_adaptive_config_t, max_s, 1, AUVID_C(30.0), AUVID_EXCITATION_LONGEST_S),
    };
    AUVID_CHECK_TABLE(why, cfg, fields);
    if (why->status == AUVID_OK) {
        adaptive_check_thrusters(id, cfg, why);
    }
}

/* Configure the excitation: steps in each DoF. They are checked, so init cannot fail. */
static void adaptive_plan(auvid_identifier_t *id, const auvid_adaptive_config_t *cfg)
{
    auvid_excitation_config_t *to = &id->actuation->excitation.cfg;
    const auvid_guard_config_t *guard = &id->actuation->guard.cfg;
    auvid_excitation_defaults(to);
    to->seed = cfg->seed;
    memcpy(to->excursion_limit, cfg->excursion_limit, sizeof to->excursion_limit);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t *limit = &to->excursion_limit[j]; /* zero, no limit, stays */
        if (j <= AUVID_SWAY && (guard->off & AUVID_GUARD_BIT(AUVID_GUARD_DISTANCE)) == 0) {
            *limit = auvid_min(*limit, LIMIT_FRACTION * guard->distance_max_m);
        } else if (j == AUVID_HEAVE && (guard->off & DEPTHS) == 0) {
            auvid_real_t half_m = AUVID_C(0.5) * (guard->depth_max_m - guard->depth_min_m);
            *limit = auvid_min(*limit, auvid_max(LIMIT_FRACTION * half_m, LEAST_LIMIT));
        }
        if (adaptive_is_excitable(id, cfg, j)) {
            auvid_segment_t *s = &to->segment[to->segments++];
            s->dof = (auvid_dof_t)j;
            s->kind = AUVID_SEGMENT_STEPS;
            s->duration_s = s->hold_min_s = s->hold_max_s = cfg->max_s; /* holds are not drawn */
            s->fade_s = EXCITATION_STEP_FADE_S;
            s->amplitude = cfg->amplitude[j];
        }
    }
    (void)auvid_excitation_init(&id->actuation->excitation, to);
}

auvid_status_t auvid_adaptive_begin(auvid_identifier_t *id, auvid_adaptive_t *storage,
                                    const auvid_adaptive_config_t *cfg, auvid_refusal_t *refusal)
{
    auvid_refusal_t why;
    auvid_status_t status =
        storage == NULL || cfg == NULL ? AUVID_ERR_NULL : auvid_actuation_check(id);
    if (status == AUVID_OK && id->actuation->guard.state != AUVID_GUARD_DISARMED &&
        id->actuation->guard.state != AUVID_GUARD_DONE) {
        status = AUVID_ERR_STATE;
    }
    auvid_check_begin(&why);
    auvid_check_that(&why, status == AUVID_OK, status, "");
    if (status == AUVID_OK) {
        adaptive_check(id, cfg, &why);
        status = why.status;
    }
    if (status == AUVID_OK) {
        adaptive_plan(id, cfg);
        memset(storage, 0, sizeof *storage);
        storage->run_us = UINT64_MAX;
        id->actuation->shape_context = storage;
        id->actuation->shape = adaptive_shape;
    }
    if (refusal != NULL) {
        *refusal = why;
    }
    return status;
}
