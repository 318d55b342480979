/* Checkpoints with forged content and a correct checksum: refused, or harmless. The genuine ones
 * are of five worlds: one with regressor, guarded and excited, started with a prior record; one
 * with adaptive excitation; one without regressor. The first and the last of these are repeated
 * with budgets so small that sets wait, and an IMU so late that samples are held. */
#define _POSIX_C_SOURCE 200809L /* alarm() */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "auvid/adaptive.h"
#include "auvid/checkpoint.h"
#include "auvid/prior.h"
#include "checkpoint/auvid_checkpoint_layout_internal.h"
#include "identifier/auvid_identifier_internal.h"
#include "base/auvid_checksum_internal.h"
#include "base/auvid_math_internal.h"
#include "binomial.h"
#include "by_residual.h"
#include "chain.h"
#include "save_checkpoint.h"
#include "unity.h"

enum {
    SETS = 9,
    SET_ROWS = 20,
    STORE = (SETS + 1) * SET_ROWS,
    MOST = AUVID_CHECKPOINT_MAX(STORE),
    PHASES = AUVID_WORK_CONFIDENCE + 1,
    KINDS =
        8 * PHASES, /* of moments: phases of work, with a waiting set, a held sample, the optimum */
    TAKEN = 2 * KINDS, /* checkpoints of a world: two of each */
    LATE_US = 50000,   /* the IMU in the slow worlds */
    HANG_S = 60
};

typedef enum { SEQUENCE, ADAPTIVE, RESIDUAL, SLOW, SLOW_RESIDUAL, WORLDS } world_t;

/* A moment of a run, and its checkpoint. */
typedef struct {
    chain_t chain;
    uint32_t bytes;
    uint8_t saved[MOST];
} moment_t;

static moment_t moment[WORLDS][TAKEN];
static uint32_t moments[WORLDS];
static struct {
    auvid_identifier_t id;
    auvid_actuation_t actuation;
    auvid_adaptive_t adaptive;
    auvid_validation_t prediction;
    auvid_change_detector_t change;
    auvid_prior_t prior;
} fresh[WORLDS]; /* as in a program that restores */
static chain_config_t cfg;
static chain_t chain;
static auvid_row_t store[STORE];
static auvid_vehicle_t vehicle;
static auvid_rng_t rng;
static uint8_t forged[MOST];
static char what[200]; /* was forged, for a message */

void setUp(void)
{
    auvid_rng_seed(&rng, 1);
}

void tearDown(void)
{
}

static bool is_slow(world_t world)
{
    return world == SLOW || world == SLOW_RESIDUAL;
}

static void delay_imu(chain_t *c, auvid_input_t *in)
{
    (void)c;
    in->imu.t_us -= LATE_US;
}

static void configure(world_t world)
{
    chain_defaults(&cfg, 1, 3, 1.0);
    cfg.id.metric.set_rows = SET_ROWS;
    if (is_slow(world)) {
        cfg.epoch_us = 1000000;
        cfg.before = delay_imu;
    }
    if (world == RESIDUAL || world == SLOW_RESIDUAL) {
        by_residual_surge(&cfg.id, &vehicle, store, SETS - 1);
    }
}

/* chain.id, with the acting half of `chain` */
static void begin(world_t world)
{
    auvid_identifier_t *id = &chain.id;
    configure(world);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_init(&chain, &cfg));
    if (world == ADAPTIVE) {
        auvid_adaptive_config_t adaptive;
        auvid_adaptive_defaults(&adaptive);
        adaptive.amplitude[AUVID_SURGE] = adaptive.amplitude[AUVID_SWAY] = AUVID_C(100.0);
        adaptive.amplitude[AUVID_HEAVE] = AUVID_C(100.0);
        adaptive.amplitude[AUVID_YAW] = AUVID_C(40.0);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_adaptive_begin(id, &chain.adaptive, &adaptive, NULL));
    }
}

static uint32_t kind_of(const auvid_identifier_t *id)
{
    const auvid_metric_t *m = &id->metric;
    bool waits = m->sets.held && (m->sets.full || m->sets.waiting > 0 || id->work.untested > 1);
    bool optimum = id->work.phase == AUVID_WORK_MERGE && id->work.spent == WORK_OPTIMUM;
    return id->work.phase +
           PHASES * ((uint32_t)waits + 2u * (id->nav.held.sensors != 0) + 4u * (uint32_t)optimum);
}

/* Save two moments of each kind that occurs in `seconds` of the world, which is excited. */
static void run(world_t world, double seconds)
{
    static const auvid_real_t guess[AUVID_MAX_PARAMETERS] = {[AUVID_G500_M_U] = 500};
    static auvid_real_t sigma[AUVID_MAX_PARAMETERS];
    uint32_t count[KINDS] = {0}, usual = world == SLOW ? 30 : 120;
    configure(world);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    begin(world);
    fresh[world].id = chain.id;
    fresh[world].actuation = chain.actuation;
    fresh[world].adaptive = chain.adaptive;
    fresh[world].prediction = chain.prediction;
    fresh[world].change = chain.change;
    fresh[world].prior = chain.prior;
    for (int i = 0; world == SEQUENCE && i < AUVID_MAX_PARAMETERS; ++i) {
        sigma[i] = AUVID_C(1e6);
    }
    if (world == SEQUENCE) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_set(&chain.id, guess, sigma));
    }
    for (int tick = 1; tick < (int)(50 * seconds); ++tick) {
        chain.cfg.budget = 1 + auvid_rng_below(&rng, auvid_rng_below(&rng, 6) == 0 ? 9 : usual);
        chain_tick(&chain);
        uint32_t kind = kind_of(&chain.id);
        bool first = count[kind] == 0, later = count[kind] == 1 && chain.id.estimate.number > 2;
        if (tick > 100 && (first || later)) {
            moment_t *m = &moment[world][moments[world]++];
            ++count[kind];
            m->chain = chain;
            m->bytes = save_checkpoint(&chain.id, m->saved, MOST);
        }
    }
    TEST_ASSERT_EQUAL_HEX32(0, chain.events & AUVID_EVENT_ABORTED);
}

static void record_all(void)
{
    uint32_t phases = 0, exciting = 0, waiting = 0, holding = 0, optima = 0;
    if (moments[0] > 0) {
        return;
    }
    run(SEQUENCE, 92);
    run(ADAPTIVE, 92);
    run(RESIDUAL, 92);
    run(SLOW, 122);
    run(SLOW_RESIDUAL, 92);
    for (int w = 0; w < WORLDS; ++w) {
        for (uint32_t k = 0; k < moments[w]; ++k) {
            const auvid_identifier_t *id = &moment[w][k].chain.id;
            uint32_t kind = kind_of(id);
            phases |= 1u << id->work.phase;
            exciting += moment[w][k].chain.actuation.guard.state == AUVID_GUARD_EXCITING;
            waiting += kind / PHASES % 2;
            holding += kind / PHASES / 2 % 2;
            optima += (auvid_get_word(moment[w][k].saved + 16) & PART_OPTIMUM) != 0;
        }
    }
    printf("%u exciting, %u with sets that wait, %u with samples held, %u while the least cost is "
           "sought\n",
           (unsigned)exciting, (unsigned)waiting, (unsigned)holding, (unsigned)optima);
    TEST_ASSERT_EQUAL_HEX32((1u << PHASES) - 1, phases);
    TEST_ASSERT_TRUE(exciting > 10 && waiting > 10 && holding > 10 && optima > 3);
}

/* ---- forging ---- */

static void correct_checksum(uint32_t bytes)
{
    auvid_put_word(forged + bytes - 4, ~auvid_checksum(UINT32_MAX, forged, bytes - 4));
}

/* Another value for a scalar: any, or a critical one. */
static void change_scalar(uint8_t *at, uint32_t width)
{
    static const float critical[] = {0,         -1,    1,      NAN,    INFINITY,
                                     -INFINITY, 3e38f, -3e38f, 1e-40f, 1e20f};
    static const uint8_t bytes[] = {0x00, 0xff, 0x7f, 0x80, 0x01};
    float single = critical[auvid_rng_below(&rng, sizeof critical / sizeof critical[0])];
    double wide = (double)single;
    switch (auvid_rng_below(&rng, 4)) {
    case 0: /* one byte, any */
        at[auvid_rng_below(&rng, width)] = (uint8_t)auvid_rng_below(&rng, 256);
        break;
    case 1: /* one critical byte */
        at[auvid_rng_below(&rng, width)] = bytes[auvid_rng_below(&rng, sizeof bytes)];
        break;
    case 2: /* a little more or less */
        *at = (uint8_t)(*at + (auvid_rng_below(&rng, 2) == 0 ? 1 : 255));
        break;
    default:
        if (width == sizeof single) {
            memcpy(at, &single, sizeof single);
        } else if (width == sizeof wide) {
            memcpy(at, &wide, sizeof wide);
        } else {
            memset(at, bytes[auvid_rng_below(&rng, sizeof bytes)], width);
        }
        break;
    }
}

/* Where a scalar with a limit is in the body: any of any struct; -1: of a part that is absent. */
static int32_t find_limited(const auvid_checkpoint_view_t *v, uint32_t *width)
{
    const auvid_checkpoint_struct_t *of =
        &auvid_checkpoint_struct[auvid_rng_below(&rng, (uint32_t)auvid_checkpoint_structs)];
    const auvid_checkpoint_limit_t *limit =
        &auvid_checkpoint_limit[auvid_rng_below(&rng, (uint32_t)auvid_checkpoint_limits)];
    if (limit->table != of->table || (of->parts != 0 && (of->parts & v->parts) == 0)) {
        return -1;
    }
    uint32_t offset =
        of->offset + limit->first +
        auvid_rng_below(&rng, of->root == ROOT_ROWS ? v->rows : of->count) * of->size +
        auvid_rng_below(&rng, limit->count) * limit->width;
    *width = limit->width;
    for (uint32_t k = 0, at = 0; k < CHECKPOINT_BLOCKS; ++k) {
        const auvid_checkpoint_block_t *block = &auvid_checkpoint_block[k];
        uint32_t bytes = auvid_checkpoint_bytes(v, block);
        if (block->root == of->root && offset >= block->offset && offset - block->offset < bytes) {
            return (int32_t)(at + offset - block->offset);
        }
        at += bytes;
    }
    return -1;
}

/* Any place near the beginning or the end of a block, where counts, times and flags are. */
static int32_t find_at_edge(const auvid_checkpoint_view_t *v, uint32_t width)
{
    uint32_t k = auvid_rng_below(&rng, CHECKPOINT_BLOCKS), at = 0;
    for (uint32_t i = 0; i < k; ++i) {
        at += auvid_checkpoint_bytes(v, &auvid_checkpoint_block[i]);
    }
    uint32_t bytes = auvid_checkpoint_bytes(v, &auvid_checkpoint_block[k]);
    if (bytes < width) {
        return -1;
    }
    uint32_t edge = auvid_rng_below(&rng, bytes < 64 ? bytes : 64) / width * width;
    return (int32_t)(at + (auvid_rng_below(&rng, 2) == 0 ? edge : bytes - width - edge));
}

/* One to three changes: of any bytes, of a scalar with a limit, at the edge of a block. */
static void forge(const moment_t *m)
{
    const auvid_checkpoint_view_t view = {.parts = auvid_get_word(m->saved + 16),
                                          .rows = auvid_get_word(m->saved + 20)};
    uint32_t body = m->bytes - AUVID_CHECKPOINT_HEAD - AUVID_CHECKPOINT_TAIL;
    memcpy(forged, m->saved, m->bytes);
    for (uint32_t k = 0; k <= auvid_rng_below(&rng, 3);) {
        uint32_t width = 1u << auvid_rng_below(&rng, 4), way = auvid_rng_below(&rng, 300);
        int32_t at = way > 5   ? find_limited(&view, &width) /* most of them are absent */
                     : way > 1 ? find_at_edge(&view, width)
                               : (int32_t)(auvid_rng_below(&rng, body / 8) * 8);
        if (at < 0 || (uint32_t)at + width > body) {
            continue;
        }
        ++k;
        change_scalar(forged + AUVID_CHECKPOINT_HEAD + at, width);
        size_t said = strlen(what);
        (void)snprintf(what + said, sizeof what - said, "; byte %d of %u: %02x", (int)at,
                       (unsigned)width, forged[AUVID_CHECKPOINT_HEAD + at]);
    }
    if (auvid_rng_below(&rng, 50) == 0) {
        forged[4 + auvid_rng_below(&rng, 24)] ^= (uint8_t)(1u << auvid_rng_below(&rng, 8));
    }
    correct_checksum(m->bytes);
}

/* ---- what must not happen ---- */

#define FINITE(array) auvid_all_finite(array, sizeof(array) / sizeof(auvid_real_t))

static void check_published(const chain_t *c)
{
    const auvid_estimate_t *e = &c->id.estimate;
    const auvid_change_test_t *to = &c->id.change_test;
    auvid_nav_state_t state;
    memset(&state, 0, sizeof state);
    (void)auvid_nav_state(&c->id.nav, &state);
    bool finite = FINITE(e->pi) && auvid_is_finite(e->cost) && FINITE(e->delay_s) &&
                  FINITE(e->r2_force) && FINITE(e->confidence.sigma) &&
                  FINITE(e->confidence.effective_noise) && FINITE(e->confidence.residual_rms);
    TEST_ASSERT_TRUE_MESSAGE(finite, what);
    finite = FINITE(to->variance_ratio) && FINITE(to->change) && FINITE(to->r2_velocity) &&
             auvid_is_finite(c->actuation.guard.trip.value) &&
             auvid_is_finite(c->actuation.guard.trip.limit);
    TEST_ASSERT_TRUE_MESSAGE(finite, what);
    finite = FINITE(state.position) && FINITE(state.attitude) && FINITE(state.velocity) &&
             FINITE(state.rates) && FINITE(c->out.excitation) && FINITE(c->out.thruster_N);
    TEST_ASSERT_TRUE_MESSAGE(finite, what);
}

/* Ticks with work; the wrench is zero, or within the plan. */
static void check_ticks(chain_t *c, world_t world, uint32_t ticks, bool may_act)
{
    auvid_real_t peak[AUVID_DOF_COUNT];
    (void)auvid_excitation_peak(&fresh[world].actuation.excitation, peak);
    for (uint32_t k = 0; k < ticks; ++k) {
        c->cfg.budget = 1 + auvid_rng_below(&rng, 400);
        c->over_budget = false;
        chain_tick(c);
        TEST_ASSERT_FALSE_MESSAGE(c->over_budget, what);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            auvid_real_t max_N = may_act ? peak[j] * AUVID_C(1.000001) : AUVID_C(0.0);
            TEST_ASSERT_TRUE_MESSAGE(auvid_abs(c->out.excitation[j]) <= max_N, what);
        }
        check_published(c);
    }
}

/* One in so many accepted forgeries also runs for a set and a search. */
static void test_a_forged_checkpoint_is_refused_or_harmless(void)
{
    const uint32_t forgeries = campaign_is_long() ? 100000 : campaign_runs(3000), stride = 64;
    uint32_t taken = 0, refused = 0, checkpoints = 0;
    record_all();
    for (int w = 0; w < WORLDS; ++w) {
        checkpoints += moments[w];
    }
    for (uint32_t n = 0; n < forgeries; ++n) {
        world_t world = (world_t)(n / 16 % WORLDS);
        const moment_t *m = &moment[world][n / 16 / WORLDS % moments[world]];
        bool resumes = n % 4 == 0;
        (void)snprintf(what, sizeof what, "forgery %u of world %d", (unsigned)n, (int)world);
        forge(m);
        chain.id = fresh[world].id;
        chain.actuation = fresh[world].actuation;
        chain.adaptive = fresh[world].adaptive;
        chain.prediction = fresh[world].prediction;
        chain.change = fresh[world].change;
        chain.prior = fresh[world].prior;
        (void)alarm(HANG_S);
        auvid_status_t status = resumes ? auvid_checkpoint_resume(&chain.id, forged, m->bytes)
                                        : auvid_checkpoint_restore(&chain.id, forged, m->bytes);
        if (status != AUVID_OK) {
            TEST_ASSERT_EQUAL_INT(0, memcmp(&chain.id, &fresh[world].id, sizeof chain.id));
            TEST_ASSERT_EQUAL_INT(
                0, memcmp(&chain.actuation, &fresh[world].actuation, sizeof chain.actuation));
            ++refused;
            continue;
        }
        static auvid_identifier_t restored;
        static auvid_actuation_t actuation;
        static auvid_adaptive_t adaptive;
        static auvid_validation_t prediction;
        static auvid_change_detector_t change;
        static auvid_prior_t prior;
        restored = chain.id;
        actuation = chain.actuation;
        adaptive = chain.adaptive;
        prediction = chain.prediction;
        change = chain.change;
        prior = chain.prior;
        chain = m->chain;
        chain.id = restored;
        chain.actuation = actuation;
        chain.adaptive = adaptive;
        chain.prediction = prediction;
        chain.change = change;
        chain.prior = prior;
        chain.waiting = false;
        check_published(&chain);
        bool longer = ++taken % stride == 0;
        check_ticks(&chain, world, 8, resumes);
        chain.waiting = true; /* now it may excite */
        check_ticks(&chain, world, longer ? 800 : 8, true);
    }
    (void)alarm(0);
    printf("%u forgeries of %u checkpoints: %u refused, %u taken, %u of them for a set\n",
           (unsigned)forgeries, (unsigned)checkpoints, (unsigned)refused, (unsigned)taken,
           (unsigned)(taken / stride));
    TEST_ASSERT_TRUE(refused > forgeries / 10 && taken > forgeries / 10);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_forged_checkpoint_is_refused_or_harmless);
    return UNITY_END();
}
