/*
 * The benefit of a prior: how much sooner a dive with a record or with known parameters identifies
 * the vehicle, and that a prior of another vehicle does no harm.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "auvid/prior.h"
#include "binomial.h"
#include "prior_dives.h"
#include "unity.h"

enum { SETS = 8, LATER = 4 };

static uint8_t record[AUVID_PRIOR_BYTES];

void setUp(void)
{
    prior_dives_defaults();
}

void tearDown(void)
{
}

typedef struct {
    double square;  /* of the error after the first set, summed over parameters and dives */
    double seconds; /* until all parameters are identifiable, at most the dive's */
    uint32_t kept;  /* dives in which the record was kept */
} worth_t;

/* The prior of a dive. */
typedef enum { COLD, RECORD, TANK } start_t;

/* A dive of four sets; the vehicle is `heavier` times as heavy as the known one. */
static void dive_again(uint32_t seed, start_t start, double heavier, worth_t *worth)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS], sigma[AUVID_MAX_PARAMETERS];
    uint32_t seen = start == COLD ? 0 : 1;
    bool all = false;
    chain_defaults(&cfg, 1000 + seed, LATER, 1.0);
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        cfg.sim.parameter[i] *= i == SIM_WB ? 1.0 : heavier;
    }
    tank(pi, sigma);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    if (start == RECORD) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_load(&chain.id, record, sizeof record));
    } else if (start == TANK) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_set(&chain.id, pi, sigma));
    }
    const auvid_estimate_t *e = &chain.id.estimate;
    while (chain.id.metric.sets.recorded < LATER || chain.work == AUVID_PENDING) {
        chain_tick(&chain);
        for (int i = 0; i < N && e->sets == 1 && e->number == seen + 1; ++i) {
            worth->square += pow((double)e->pi[i] / cfg.sim.parameter[i] - 1.0, 2);
        }
        seen = e->number;
        all = all || e->confidence.identifiable == (1u << N) - 1u;
        worth->seconds += all ? 0.0 : 0.02;
    }
    worth->kept += chain.prior.known != 0;
}

/* @return number of dives */
static uint32_t compare(start_t start, double heavier, worth_t *cold, worth_t *warm)
{
    uint32_t dives = campaign_is_long() ? 100 : campaign_runs(8);
    memset(cold, 0, sizeof *cold);
    memset(warm, 0, sizeof *warm);
    for (uint32_t seed = 1; seed <= dives; ++seed) {
        if (start == RECORD) {
            chain_defaults(&cfg, seed, SETS, 1.0);
            TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, SETS));
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_save(&chain.id, record));
        }
        dive_again(seed, COLD, heavier, cold);
        dive_again(seed, start, heavier, warm);
    }
    printf("%u dives, %s, the vehicle %g times as heavy as known: first set cold %.2f %%, warm "
           "%.2f %%; all identifiable after %.1f s, %.1f s; kept in %u\n",
           (unsigned)dives, start == RECORD ? "a record" : "known parameters", heavier,
           100 * sqrt(cold->square / N / dives), 100 * sqrt(warm->square / N / dives),
           cold->seconds / dives, warm->seconds / dives, (unsigned)warm->kept);
    return dives;
}

static void test_the_same_vehicle_is_identified_in_half_the_time(void)
{
    worth_t cold, warm;
    uint32_t dives = compare(RECORD, 1.0, &cold, &warm);
    TEST_ASSERT_TRUE(warm.seconds < 0.5 * cold.seconds);
    TEST_ASSERT_TRUE(warm.square < 0.25 * cold.square);
    TEST_ASSERT_TRUE(warm.kept >= dives - dives / 8);
}

/* Parameters known to the tank's 5 % also help. */
static void test_known_parameters_help(void)
{
    worth_t cold, warm;
    uint32_t dives = compare(TANK, 1.0, &cold, &warm);
    TEST_ASSERT_TRUE(warm.seconds < 0.5 * cold.seconds);
    TEST_ASSERT_TRUE(warm.square < 0.25 * cold.square);
    TEST_ASSERT_TRUE(warm.kept >= dives - dives / 8);
}

static void test_a_record_of_another_vehicle_does_no_harm(void)
{
    static const double heavier[] = {1.03, 1.1}; /* one close enough to be confounded, one not */
    for (size_t k = 0; k < sizeof heavier / sizeof heavier[0]; ++k) {
        worth_t cold, warm;
        uint32_t dives = compare(RECORD, heavier[k], &cold, &warm);
        TEST_ASSERT_TRUE(warm.square <= 1.1 * 1.1 * cold.square);
        TEST_ASSERT_TRUE(warm.seconds <= 1.1 * cold.seconds);
        TEST_ASSERT_TRUE(warm.kept <= dives / 4);
    }
}

static void test_wrong_known_parameters_do_no_harm(void)
{
    worth_t cold, warm;
    (void)compare(TANK, 1.3, &cold, &warm);
    TEST_ASSERT_TRUE(warm.square <= 1.1 * 1.1 * cold.square);
    TEST_ASSERT_TRUE(warm.seconds <= 1.1 * cold.seconds);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_same_vehicle_is_identified_in_half_the_time);
    RUN_TEST(test_known_parameters_help);
    RUN_TEST(test_a_record_of_another_vehicle_does_no_harm);
    RUN_TEST(test_wrong_known_parameters_do_no_harm);
    return UNITY_END();
}
