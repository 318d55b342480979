/* The warm record: from one dive to the next. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "auvid/warm.h"
#include "binomial.h"
#include "chain.h"
#include "unity.h"

enum { N = 13, SETS = 8, LATER = 4 };

static chain_config_t config;
static chain_t chain;
static uint8_t record[AUVID_WARM_BYTES];

void setUp(void)
{
    chain_defaults(&config, 1, 2, 1.0);
}

void tearDown(void)
{
}

/* A dive of two sets leaves a record. */
static void dive(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &config, 2));
    memset(record, 0xFF, sizeof record);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_warm_save(&chain.id, record));
}

static void check_refused(auvid_status_t status, const uint8_t *bytes, uint32_t size)
{
    static auvid_identifier_t before;
    before = chain.id;
    TEST_ASSERT_EQUAL(status, auvid_warm_start(&chain.id, bytes, size));
    TEST_ASSERT_EQUAL_MEMORY(&before, &chain.id, sizeof before);
}

static void test_a_record_brings_the_estimate_into_the_next_dive(void)
{
    dive();
    static auvid_estimate_t known;
    known = chain.id.estimate;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_warm_start(&chain.id, record, sizeof record));
    TEST_ASSERT_EQUAL_UINT32(1, chain.id.estimate.number);
    TEST_ASSERT_EQUAL_HEX32(known.identified, chain.id.estimate.identified);
    TEST_ASSERT_EQUAL_HEX32(0, chain.id.estimate.confidence.identifiable);
    for (int i = 0; i < N; ++i) { /* the error is that of before, aged, and kept in 8 binary digits
                                     that are not rounded down */
        float single = (float)known.pi[i];
        auvid_real_t sigma = known.confidence.sigma[i] * (auvid_real_t)1.4142136;
        TEST_ASSERT_EQUAL_FLOAT(single, (float)chain.id.estimate.pi[i]);
        TEST_ASSERT_TRUE(chain.id.estimate.confidence.sigma[i] >= (auvid_real_t)0.999999 * sigma);
        TEST_ASSERT_TRUE(chain.id.estimate.confidence.sigma[i] <= (auvid_real_t)1.008 * sigma);
    }
    chain_tick(&chain);
    TEST_ASSERT_EQUAL_HEX32(AUVID_EVENT_ESTIMATE, chain.out.events & AUVID_EVENT_ESTIMATE);
}

static void test_saved_again_it_says_the_same(void)
{
    uint8_t again[AUVID_WARM_BYTES];
    dive();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_warm_save(&chain.id, again));
    TEST_ASSERT_EQUAL_MEMORY(record, again, sizeof again);
}

/* A dive without a set leaves nothing better than the record that it began with. */
static void test_what_was_only_remembered_is_not_saved_again(void)
{
    uint8_t again[AUVID_WARM_BYTES] = {0}, zeros[AUVID_WARM_BYTES] = {0};
    dive();
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_warm_start(&chain.id, record, sizeof record));
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_warm_save(&chain.id, again));
    TEST_ASSERT_EQUAL_MEMORY(zeros, again, sizeof again);
}

static void test_every_damaged_byte_is_noticed(void)
{
    dive();
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    for (int k = 0; k < AUVID_WARM_BYTES; ++k) {
        for (int change = 1; change < 256; ++change) {
            record[k] = (uint8_t)(record[k] ^ change);
            TEST_ASSERT_EQUAL(AUVID_ERR_CHECKSUM,
                              auvid_warm_start(&chain.id, record, sizeof record));
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
    config.id.metric.free = AUVID_G500_FREE & ~(1u << AUVID_G500_M_R);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    check_refused(AUVID_ERR_MODEL, record, sizeof record);
    config.id.metric.fixed[AUVID_G500_M_R] = 80;
    dive(); /* a record with yaw's inertia given */
    config.id.metric.fixed[AUVID_G500_M_R] = 81;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    check_refused(AUVID_ERR_MODEL, record, sizeof record);
}

static void test_a_model_without_a_name_is_another_model(void)
{
    static auvid_vehicle_t nameless;
    dive();
    nameless = auvid_girona500;
    nameless.name = NULL;
    config.id.vehicle = &nameless;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    check_refused(AUVID_ERR_MODEL, record, sizeof record);
}

static void test_calls_out_of_order_are_refused(void)
{
    memset(&chain.id, 0, sizeof chain.id);
    check_refused(AUVID_ERR_STATE, record, sizeof record);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_warm_save(&chain.id, record));
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_warm_save(&chain.id, record));
    dive();
    check_refused(AUVID_ERR_STATE, record, sizeof record); /* it knows better by now */
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    check_refused(AUVID_ERR_SIZE, record, sizeof record - 1);
    check_refused(AUVID_ERR_NULL, NULL, sizeof record);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_warm_start(NULL, record, sizeof record));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_warm_save(NULL, record));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_warm_save(&chain.id, NULL));
}

static void test_memory_that_makes_no_sense_is_refused(void)
{
    auvid_memory_t memory = {.known = 1};
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    auvid_metric_t *metric = &chain.id.metric;
    memory.sigma[0] = memory.colour[AUVID_SURGE] = 1;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_remember(metric, &memory));
    memory.sigma[0] = 0;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_metric_remember(metric, &memory));
    memory.sigma[0] = 1;
    memory.colour[AUVID_SURGE] = 0;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_metric_remember(metric, &memory));
    memory.colour[AUVID_SURGE] = (auvid_real_t)NAN;
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_metric_remember(metric, &memory));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_remember(NULL, &memory));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_remember(metric, NULL));
    TEST_ASSERT_EQUAL_HEX32(1, metric->memory.known);
}

/* ---- what it is worth ---- */

typedef struct {
    double square;  /* of the error after the first set, summed over parameters and dives */
    double seconds; /* until all parameters are identifiable, at most the dive's */
    uint32_t kept;  /* dives in which the record was kept */
} worth_t;

/* A dive of four sets, warm or cold, in which the vehicle is `heavier` times the one before. */
static void dive_again(uint32_t seed, bool warm, double heavier, worth_t *worth)
{
    uint32_t seen = warm ? 1 : 0;
    bool all = false;
    chain_defaults(&config, 1000 + seed, LATER, 1.0);
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        config.sim.parameter[i] *= i == SIM_WB ? 1.0 : heavier;
    }
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    if (warm) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_warm_start(&chain.id, record, sizeof record));
    }
    const auvid_estimate_t *e = &chain.id.estimate;
    while (chain.id.metric.sets_recorded < LATER || chain.work == AUVID_PENDING) {
        chain_tick(&chain);
        for (int i = 0; i < N && e->sets == 1 && e->number == seen + 1; ++i) {
            worth->square += pow((double)e->pi[i] / config.sim.parameter[i] - 1.0, 2);
        }
        seen = e->number;
        all = all || e->confidence.identifiable == (1u << N) - 1u;
        worth->seconds += all ? 0.0 : 0.02;
    }
    worth->kept += chain.id.metric.memory.known != 0;
}

/* @return how many dives */
static uint32_t compare(double heavier, worth_t *cold, worth_t *warm)
{
    uint32_t dives = campaign_is_long() ? 100 : 8;
    memset(cold, 0, sizeof *cold);
    memset(warm, 0, sizeof *warm);
    for (uint32_t seed = 1; seed <= dives; ++seed) {
        chain_defaults(&config, seed, SETS, 1.0);
        TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &config, SETS));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_warm_save(&chain.id, record));
        dive_again(seed, false, heavier, cold);
        dive_again(seed, true, heavier, warm);
    }
    printf("%u dives, the vehicle %g times as heavy as before: first set cold %.2f %%, warm %.2f "
           "%%; all identifiable after %.1f s, %.1f s; record kept in %u\n",
           (unsigned)dives, heavier, 100 * sqrt(cold->square / N / dives),
           100 * sqrt(warm->square / N / dives), cold->seconds / dives, warm->seconds / dives,
           (unsigned)warm->kept);
    return dives;
}

static void test_the_same_vehicle_is_known_in_half_the_time(void)
{
    worth_t cold, warm;
    uint32_t dives = compare(1.0, &cold, &warm);
    TEST_ASSERT_TRUE(warm.seconds < 0.5 * cold.seconds);
    TEST_ASSERT_TRUE(warm.square < 0.25 * cold.square);
    TEST_ASSERT_TRUE(warm.kept >= dives - dives / 8);
}

static void test_a_record_of_another_vehicle_does_no_harm(void)
{
    worth_t cold, warm;
    (void)compare(1.1, &cold, &warm);
    TEST_ASSERT_TRUE(warm.square <= 1.1 * 1.1 * cold.square);
    TEST_ASSERT_TRUE(warm.seconds <= 1.1 * cold.seconds);
    TEST_ASSERT_EQUAL_UINT32(0, warm.kept);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_record_brings_the_estimate_into_the_next_dive);
    RUN_TEST(test_saved_again_it_says_the_same);
    RUN_TEST(test_what_was_only_remembered_is_not_saved_again);
    RUN_TEST(test_every_damaged_byte_is_noticed);
    RUN_TEST(test_a_record_of_another_model_is_refused);
    RUN_TEST(test_a_model_without_a_name_is_another_model);
    RUN_TEST(test_calls_out_of_order_are_refused);
    RUN_TEST(test_memory_that_makes_no_sense_is_refused);
    RUN_TEST(test_the_same_vehicle_is_known_in_half_the_time);
    RUN_TEST(test_a_record_of_another_vehicle_does_no_harm);
    return UNITY_END();
}
