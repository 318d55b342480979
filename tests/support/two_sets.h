/**
 * @file two_sets.h
 * Shared by the tests of the identifier: two simulated vehicles, each with an identifier, and runs
 * of two sets at 1 N. A test program includes it once.
 */
#ifndef TWO_SETS_H
#define TWO_SETS_H

#include "chain.h"
#include "unity.h"

enum { SETS = 2 };

static chain_t chain, other;
static chain_config_t cfg;

/** For setUp. Work is done only on request. */
static inline void two_sets_defaults(void)
{
    chain_defaults(&cfg, 11, SETS, 1.0);
    cfg.budget = 0;
}

static inline void finish(chain_t *c)
{
    TEST_ASSERT_TRUE(chain_finish(c, 1000, 1000) <= 1000);
}

static inline void run(chain_t *c)
{
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(c, &cfg, SETS));
    finish(c);
    TEST_ASSERT_EQUAL_UINT32(SETS, c->id.estimate.sets);
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE, c->id.estimate.identified);
}

static inline void check_same_estimate(void)
{
    TEST_ASSERT_EQUAL_MEMORY(&other.id.estimate, &chain.id.estimate, sizeof chain.id.estimate);
}

static inline bool is_zero(const auvid_output_t *out)
{
    auvid_real_t sum = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        sum += out->excitation[j] < 0 ? -out->excitation[j] : out->excitation[j];
    }
    for (int i = 0; i < AUVID_MAX_THRUSTERS; ++i) {
        sum += out->thruster_N[i] < 0 ? -out->thruster_N[i] : out->thruster_N[i];
    }
    return sum == 0;
}

#endif
