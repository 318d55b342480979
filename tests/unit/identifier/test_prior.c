/*
 * The prior record, from one dive to the next: what it holds, and records that are refused, damaged
 * and forged ones among them.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "auvid/prior.h"
#include "auvid/uncertain.h"
#include "base/auvid_checksum_internal.h"
#include "base/auvid_math_internal.h"
#include "binomial.h"
#include "by_residual.h"
#include "prior_dives.h"
#include "unity.h"

static uint8_t record[AUVID_PRIOR_BYTES];

void setUp(void)
{
    prior_dives_defaults();
}

void tearDown(void)
{
}

/* A dive of two sets leaves a record. */
static void dive(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, 2));
    memset(record, 0xFF, sizeof record);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_save(&chain.id, record));
    TEST_ASSERT_EQUAL_MEMORY("avw1", record, 4); /* the same on any machine, in any build */
    TEST_ASSERT_EQUAL_HEX32(0, auvid_get_word(record + 228));
}

static void check_refused(auvid_status_t status, const uint8_t *bytes, uint32_t size)
{
    static auvid_identifier_t before;
    before = chain.id;
    TEST_ASSERT_EQUAL(status, auvid_prior_load(&chain.id, bytes, size));
    TEST_ASSERT_EQUAL_MEMORY(&before, &chain.id, sizeof before);
}

static void test_a_record_brings_the_estimate_into_the_next_dive(void)
{
    dive();
    static auvid_estimate_t known;
    known = chain.id.estimate;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_load(&chain.id, record, sizeof record));
    TEST_ASSERT_EQUAL_UINT32(1, chain.id.estimate.number);
    TEST_ASSERT_EQUAL_HEX32(known.identified, chain.id.estimate.identified);
    TEST_ASSERT_EQUAL_HEX32(0, chain.id.estimate.confidence.identifiable);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        const auvid_confidence_t *c = &known.confidence;
        double ratio =
            c->residual_rms[j] > 0 ? (double)(c->effective_noise[j] / c->residual_rms[j]) : 0;
        double colour = (double)chain.prior.variance_inflation[j];
        TEST_ASSERT_DOUBLE_WITHIN(1e-5 * ratio * ratio, ratio * ratio, colour);
    }
    for (int i = 0; i < N; ++i) { /* the previous error, aged, with 8 binary digits, not rounded
                                     down */
        float single = (float)known.pi[i];
        auvid_real_t sigma = known.confidence.sigma[i] * (auvid_real_t)1.4142136;
        TEST_ASSERT_EQUAL_FLOAT(single, (float)chain.id.estimate.pi[i]);
        TEST_ASSERT_EQUAL(AUVID_NOTE_UNCERTAIN, chain.id.estimate.confidence.note[i]);
        TEST_ASSERT_TRUE(chain.id.estimate.confidence.sigma[i] >= (auvid_real_t)0.999999 * sigma);
        TEST_ASSERT_TRUE(chain.id.estimate.confidence.sigma[i] <= (auvid_real_t)1.008 * sigma);
    }
    chain_tick(&chain);
    TEST_ASSERT_EQUAL_HEX32(AUVID_EVENT_ESTIMATE, chain.out.events & AUVID_EVENT_ESTIMATE);
}

/* The next dive has the same thrusters and DVL: their scales do not weaken the record. Parameters
 * from other sources do not depend on them. */
static void test_a_record_holds_errors_for_an_exact_thrust_scale(void)
{
    static auvid_real_t plain[N], dvl[N];
    dive();
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_load(&chain.id, record, sizeof record));
    memcpy(plain, chain.prior.sigma, sizeof plain);
    cfg.id.uncertainty.thrust_scale = (auvid_real_t)0.05;
    cfg.id.uncertainty.dvl_scale = (auvid_real_t)0.03;
    dive();
    memcpy(dvl, chain.id.estimate.confidence.dvl_error, sizeof dvl);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_load(&chain.id, record, sizeof record));
    const auvid_confidence_t *c = &chain.id.estimate.confidence;
    TEST_ASSERT_EQUAL_MEMORY(&cfg.id.uncertainty, &c->uncertainty, sizeof c->uncertainty);
    for (int i = 0; i < N; ++i) {
        double scale = 0.05 * fabs((double)chain.id.estimate.pi[i]);
        double prior = (double)chain.prior.sigma[i];
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * (double)plain[i], (double)plain[i], prior);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4 * scale, scale, fabs((double)c->thrust_error[i]));
        TEST_ASSERT_DOUBLE_WITHIN(1e-4 * scale, (double)dvl[i], (double)c->dvl_error[i]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4 * scale, hypot(hypot(prior, scale), (double)dvl[i]),
                                  (double)c->sigma[i]);
    }
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_set(&chain.id, auvid_girona500_paper, plain));
    for (int i = 0; i < N; ++i) {
        TEST_ASSERT_TRUE(c->sigma[i] == plain[i] && c->thrust_error[i] == 0);
    }
}

/* Save the dive and start the next one with the record. */
static void next_dive(const auvid_identifier_t *dived)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_save(dived, record));
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_load(&chain.id, record, sizeof record));
}

/* A parameter that was not identified, or has no error or noise, stays unknown. */
static void test_a_record_brings_only_what_was_identified_with_an_error(void)
{
    enum { LEFT = AUVID_G500_M_U, WAYS = 7 };
    static auvid_identifier_t dived, spoilt;
    dive();
    dived = chain.id;
    uint32_t surge = 0;
    for (int i = 0; i < N; ++i) {
        surge |= (uint32_t)(auvid_girona500.parameter[i].dof == AUVID_SURGE) << i;
    }
    const uint32_t left[WAYS] = {1u << LEFT, 1u << LEFT, 1u << LEFT, surge, surge, 0, 1u << LEFT};
    for (int way = 0; way < WAYS; ++way) {
        spoilt = dived;
        auvid_estimate_t *e = &spoilt.estimate;
        auvid_confidence_t *c = &e->confidence;
        e->identified &= way == 0 ? ~left[0] : UINT32_MAX;
        c->sigma[LEFT] = way == 1 ? 0 : way == 2 ? AUVID_LARGEST : c->sigma[LEFT];
        c->effective_noise[AUVID_SURGE] = way == 3 ? 0 : c->effective_noise[AUVID_SURGE];
        c->residual_rms[AUVID_SURGE] = way == 4 ? 0 : c->residual_rms[AUVID_SURGE];
        c->residual_rms[AUVID_SURGE] *= way == 5 ? 10 : 1; /* more than the effective noise */
        e->covariance[LEFT] *= way == 6 ? 0 : 1;           /* the variance of the first parameter */
        next_dive(&spoilt);
        TEST_ASSERT_EQUAL_HEX32(dived.estimate.identified & ~left[way],
                                chain.id.estimate.identified);
        for (int i = 0; i < N; ++i) {
            bool unknown = (left[way] >> i & 1u) != 0;
            TEST_ASSERT_EQUAL(unknown, chain.id.estimate.confidence.sigma[i] == AUVID_LARGEST);
            TEST_ASSERT_EQUAL(unknown, chain.prior.sigma[i] == 0);
        }
    }
}

/* Prior standard error of the first parameter after a dive that ends with this sigma. */
static double sigma_after_reload(const auvid_identifier_t *dived, double sigma)
{
    static auvid_identifier_t ended;
    ended = *dived;
    ended.estimate.covariance[0] = (auvid_real_t)(sigma * sigma);
    next_dive(&ended);
    return (double)chain.prior.sigma[0];
}

/* The record has upper halves of single precision: 1 and 1 + 1/128 are exact, values between them
 * are rounded up. */
static void test_a_record_never_makes_an_error_smaller(void)
{
    static auvid_identifier_t dived;
    const double next = 1 + ldexp(1, -7), above = 1 + ldexp(1, -23);
    dive();
    dived = chain.id;
    double one = sigma_after_reload(&dived, 1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * one, next * one, sigma_after_reload(&dived, next));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * one, next * one, sigma_after_reload(&dived, above));
}

/* A degree of freedom without parameters in the record counts as not excited. */
static void test_a_record_counts_the_dof_that_it_holds_as_excited(void)
{
    static auvid_identifier_t dived;
    dive();
    dived = chain.id;
    dived.estimate.confidence.effective_noise[AUVID_HEAVE] = 0;
    next_dive(&dived);
    TEST_ASSERT_EQUAL_HEX8(dived.estimate.excited & ~(1u << AUVID_HEAVE),
                           chain.id.estimate.excited);
}

/* The velocity is simulated with the record's parameters through the first set. */
static void test_the_first_set_tells_how_well_the_record_predicts_velocity(void)
{
    static auvid_identifier_t dived;
    dive();
    dived = chain.id;
    next_dive(&dived);
    while (chain.id.change_test.set == 0) {
        chain_tick(&chain);
    }
    TEST_ASSERT_EQUAL_UINT32(1, chain.id.change_test.set);
    TEST_ASSERT_EQUAL_HEX8(dived.estimate.excited, chain.id.change_test.simulated);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        TEST_ASSERT_TRUE((dived.estimate.excited >> j & 1) == 0 ||
                         chain.id.change_test.r2_velocity[j] > AUVID_C(0.5));
    }
}

/* What is left of the record after two sets of a vehicle that is harder to turn. */
static uint32_t left_after_another_yaw(uint8_t closed_loop)
{
    prior_dives_defaults();
    dive();
    cfg.id.metric.closed_loop = closed_loop;
    cfg.sim.parameter[SIM_M_R] *= 2.0;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_load(&chain.id, record, sizeof record));
    while (chain.id.metric.sets.recorded < 2 || chain.work == AUVID_PENDING) {
        chain_tick(&chain);
    }
    return chain.prior.known;
}

static void test_rows_in_closed_loop_do_not_contradict_a_record(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, left_after_another_yaw(0));
    TEST_ASSERT_NOT_EQUAL(0, left_after_another_yaw(1u << AUVID_YAW));
}

static void test_a_record_saved_again_is_the_same(void)
{
    uint8_t again[AUVID_PRIOR_BYTES];
    dive();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_save(&chain.id, again));
    TEST_ASSERT_EQUAL_MEMORY(record, again, sizeof again);
}

/* A dive without a set has nothing better than its initial record. */
/* With uncertain inputs the user reads another estimate than id.estimate. */
static void test_a_record_is_of_the_estimate_that_the_user_reads(void)
{
    static auvid_uncertain_t uncertain;
    auvid_uncertain_config_t inputs;
    auvid_uncertain_defaults(&inputs);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_uncertain(&chain.id, &uncertain, &inputs,
                                                                  &chain.allocation));
    while (chain.estimates < 2) {
        chain_tick(&chain);
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_save(&chain.id, record));
    TEST_ASSERT_TRUE(auvid_identifier_estimate(&chain.id) == &uncertain.estimate);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_load(&chain.id, record, sizeof record));
    for (int i = 0; i < N; ++i) {
        TEST_ASSERT_EQUAL_FLOAT((float)uncertain.estimate.pi[i], (float)chain.id.estimate.pi[i]);
    }
}

static void test_a_prior_by_itself_is_not_saved_again(void)
{
    uint8_t again[AUVID_PRIOR_BYTES] = {0}, zeros[AUVID_PRIOR_BYTES] = {0};
    dive();
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_load(&chain.id, record, sizeof record));
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_prior_save(&chain.id, again));
    TEST_ASSERT_EQUAL_MEMORY(zeros, again, sizeof again);
}

static void test_every_damaged_byte_is_detected(void)
{
    dive();
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    for (int k = 0; k < AUVID_PRIOR_BYTES; ++k) {
        for (int change = 1; change < 256; ++change) {
            record[k] = (uint8_t)(record[k] ^ change);
            TEST_ASSERT_EQUAL(AUVID_ERR_CHECKSUM,
                              auvid_prior_load(&chain.id, record, sizeof record));
            record[k] = (uint8_t)(record[k] ^ change);
        }
    }
    TEST_ASSERT_EQUAL_UINT32(0, chain.id.estimate.number);
    memset(record, 0, sizeof record); /* erased flash */
    check_refused(AUVID_ERR_CHECKSUM, record, sizeof record);
    memset(record, 0xFF, sizeof record);
    check_refused(AUVID_ERR_CHECKSUM, record, sizeof record);
}

static void test_a_record_of_another_model_is_refused(void)
{
    dive();
    cfg.id.metric.free = AUVID_G500_FREE & ~(1u << AUVID_G500_M_R);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    check_refused(AUVID_ERR_MODEL, record, sizeof record);
    cfg.id.metric.fixed[AUVID_G500_M_R] = 80;
    dive(); /* a record with a fixed inertia of yaw */
    cfg.id.metric.fixed[AUVID_G500_M_R] = 81;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    check_refused(AUVID_ERR_MODEL, record, sizeof record);
}

static void test_a_model_without_a_name_is_another_model(void)
{
    static auvid_vehicle_t nameless;
    dive();
    nameless = auvid_girona500;
    nameless.name = NULL;
    cfg.id.vehicle = &nameless;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    check_refused(AUVID_ERR_MODEL, record, sizeof record);
}

static void test_calls_out_of_order_are_refused(void)
{
    memset(&chain.id, 0, sizeof chain.id);
    check_refused(AUVID_ERR_STATE, record, sizeof record);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_prior_save(&chain.id, record));
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_prior_save(&chain.id, record));
    dive();
    check_refused(AUVID_ERR_STATE, record, sizeof record); /* it has an estimate of its own */
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    check_refused(AUVID_ERR_SIZE, record, sizeof record - 1);
    check_refused(AUVID_ERR_NULL, NULL, sizeof record);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_prior_load(NULL, record, sizeof record));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_prior_save(NULL, record));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_prior_save(&chain.id, NULL));
    cfg.budget = 0;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, 1));
    TEST_ASSERT_EQUAL_UINT32(0, chain.id.estimate.number);
    check_refused(AUVID_ERR_STATE, record, sizeof record); /* a set has been completed */
}

static void test_memory_is_attached_once_before_the_first_step(void)
{
    static auvid_prior_t memory;
    const auvid_input_t in = {.t_us = 1};
    auvid_output_t out;
    memset(&chain.id, 0, sizeof chain.id);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_attach_prior(&chain.id, &memory));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_attach_prior(NULL, &memory));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_attach_prior(&chain.id, NULL));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    check_refused(AUVID_ERR_STATE, record, sizeof record); /* no memory */
    memory.known = 1;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_prior(&chain.id, &memory));
    TEST_ASSERT_EQUAL_HEX32(0, memory.known);
    TEST_ASSERT_EQUAL(AUVID_ERR_ATTACHED, auvid_identifier_attach_prior(&chain.id, &memory));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&chain.id, &in, &out));
    TEST_ASSERT_EQUAL(AUVID_ERR_STARTED, auvid_identifier_attach_prior(&chain.id, &memory));
}

/* ---- a record with wrong content and a correct checksum ---- */

enum { KNOWN = 8, COLOUR = 12, VALUE = 36, SIGMA = 164, CHECK = 232 };

/* The same model with its regressor, or without. */
static void choose_path(bool residual)
{
    static auvid_row_t rows[(AUVID_MAX_SETS + 1) * 60];
    static auvid_vehicle_t vehicle;
    vehicle = residual ? by_residual_girona500() : auvid_girona500;
    cfg.id.vehicle = &vehicle;
    cfg.id.metric.rows = residual ? rows : NULL;
    cfg.id.metric.row_slots = sizeof rows / sizeof rows[0];
}

static void correct_checksum(void)
{
    auvid_put_word(record + CHECK, ~auvid_checksum(UINT32_MAX, record, CHECK));
}

static void check_forged(auvid_status_t status, int at, uint32_t word)
{
    uint32_t before = auvid_get_word(record + at);
    auvid_put_word(record + at, word);
    correct_checksum();
    check_refused(status, record, sizeof record);
    auvid_put_word(record + at, before);
    correct_checksum();
}

static void test_a_record_of_impossible_numbers_is_refused_with_and_without_regressor(void)
{
    const uint32_t nan = 0x7fc00000u, infinite = 0x7f800000u, huge = 0x7f000000u;
    dive();
    for (int residual = 0; residual < 2; ++residual) {
        choose_path(residual != 0);
        TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
        check_forged(AUVID_ERR_CHECKSUM, 0, 0x32777661u); /* "avw2": of another version */
        check_forged(AUVID_ERR_NOT_FINITE, VALUE + 4 * AUVID_G500_X_U, nan);
        check_forged(AUVID_ERR_NOT_FINITE, VALUE + 4 * AUVID_G500_X_U, infinite);
        check_forged(AUVID_ERR_RANGE, VALUE + 4 * AUVID_G500_X_U, huge);
        check_forged(AUVID_ERR_NOT_FINITE, SIGMA, nan);
        check_forged(AUVID_ERR_RANGE, SIGMA, 0); /* of two parameters */
        check_forged(AUVID_ERR_RANGE, SIGMA, 0xbf80bf80u);
        check_forged(AUVID_ERR_NOT_FINITE, COLOUR, nan);
        check_forged(AUVID_ERR_RANGE, COLOUR, 0);
        check_forged(AUVID_ERR_RANGE, COLOUR, 0xbf800000u);
        check_forged(AUVID_ERR_RANGE, KNOWN, 0x80001fffu);          /* no such parameter */
        check_forged(AUVID_ERR_RANGE, KNOWN, 1u << AUVID_G500_X_0); /* a fixed one */
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_load(&chain.id, record, sizeof record));
    }
}

static bool publishes_finite_numbers(const auvid_identifier_t *id)
{
    const auvid_estimate_t *e = &id->estimate;
    const auvid_change_test_t *to = &id->change_test;
    return auvid_all_finite(e->pi, N) && auvid_is_finite(e->cost) &&
           auvid_all_finite(e->delay_s, AUVID_DOF_COUNT) &&
           auvid_all_finite(e->r2_force, AUVID_DOF_COUNT) &&
           auvid_all_finite(e->confidence.sigma, N) &&
           auvid_all_finite(e->confidence.effective_noise, AUVID_DOF_COUNT) &&
           auvid_all_finite(e->confidence.residual_rms, AUVID_DOF_COUNT) &&
           auvid_all_finite(to->variance_ratio, AUVID_DOF_COUNT) &&
           auvid_all_finite(to->change, AUVID_DOF_COUNT) &&
           auvid_all_finite(to->r2_velocity, AUVID_DOF_COUNT);
}

/* Change one to four bytes, also so that a number is NaN, infinite or huge. */
static void forge(auvid_rng_t *rng)
{
    static const uint8_t telling[] = {0x00, 0xff, 0x7f, 0x80, 0xfe, 0x01};
    for (uint32_t k = 0; k <= auvid_rng_below(rng, 4); ++k) {
        uint32_t at = KNOWN + auvid_rng_below(rng, CHECK - KNOWN);
        bool any = auvid_rng_below(rng, 2) == 0;
        record[at] = any ? (uint8_t)auvid_rng_below(rng, 256)
                         : telling[auvid_rng_below(rng, sizeof telling)];
    }
    correct_checksum();
}

/* One in so many accepted records runs through a set, which is tested against it. */
static void test_a_forged_record_is_refused_or_harmless(void)
{
    const uint32_t forgeries = campaign_is_long() ? 100000 : 4000, stride = forgeries / 13;
    static uint8_t genuine[AUVID_PRIOR_BYTES];
    uint32_t taken = 0, run_through = 0;
    auvid_rng_t rng;
    auvid_rng_seed(&rng, 1);
    dive();
    memcpy(genuine, record, sizeof genuine);
    for (uint32_t n = 0; n < forgeries; ++n) {
        if (n % 1000 == 0) {
            choose_path(n / 1000 % 2 == 1);
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_prior(&chain.id, &chain.prior));
        }
        memcpy(record, genuine, sizeof record);
        forge(&rng);
        if (auvid_prior_load(&chain.id, record, sizeof record) != AUVID_OK) {
            TEST_ASSERT_EQUAL_UINT32(0, chain.id.estimate.number);
            continue;
        }
        TEST_ASSERT_TRUE(publishes_finite_numbers(&chain.id));
        if (++taken % stride == 1 && chain.id.metric.cfg.vehicle->path == &auvid_path_regressor) {
            ++run_through;
            TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_load(&chain.id, record, sizeof record));
            while (chain.id.metric.sets.recorded < 1 || chain.work == AUVID_PENDING) {
                chain_tick(&chain);
                TEST_ASSERT_TRUE(chain.id.work.last_units <= AUVID_DEFAULT_BUDGET);
            }
            TEST_ASSERT_TRUE(publishes_finite_numbers(&chain.id));
        }
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_prior(&chain.id, &chain.prior));
    }
    printf("%u forged records: %u taken, %u of these through a set\n", (unsigned)forgeries,
           (unsigned)taken, (unsigned)run_through);
    TEST_ASSERT_TRUE(taken > forgeries / 20 && run_through > 0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_record_brings_the_estimate_into_the_next_dive);
    RUN_TEST(test_a_record_holds_errors_for_an_exact_thrust_scale);
    RUN_TEST(test_a_record_brings_only_what_was_identified_with_an_error);
    RUN_TEST(test_a_record_never_makes_an_error_smaller);
    RUN_TEST(test_a_record_counts_the_dof_that_it_holds_as_excited);
    RUN_TEST(test_the_first_set_tells_how_well_the_record_predicts_velocity);
    RUN_TEST(test_rows_in_closed_loop_do_not_contradict_a_record);
    RUN_TEST(test_a_record_saved_again_is_the_same);
    RUN_TEST(test_a_record_is_of_the_estimate_that_the_user_reads);
    RUN_TEST(test_a_prior_by_itself_is_not_saved_again);
    RUN_TEST(test_every_damaged_byte_is_detected);
    RUN_TEST(test_a_record_of_another_model_is_refused);
    RUN_TEST(test_a_model_without_a_name_is_another_model);
    RUN_TEST(test_calls_out_of_order_are_refused);
    RUN_TEST(test_memory_is_attached_once_before_the_first_step);
    RUN_TEST(test_a_record_of_impossible_numbers_is_refused_with_and_without_regressor);
    RUN_TEST(test_a_forged_record_is_refused_or_harmless);
    return UNITY_END();
}
