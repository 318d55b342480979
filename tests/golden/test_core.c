/*
 * Golden vectors of runs that are short enough for a microcontroller, at the default sizes.
 */
#include "auvid/prior.h"
#include "chain.h"
#include "dead_band.h"
#include "unity.h"
#include "vector.h"

static chain_t chain;
static chain_config_t cfg;
static bool dvl_lost;

void setUp(void)
{
    dvl_lost = false;
}

void tearDown(void)
{
}

static void look(chain_t *c, auvid_status_t status, const auvid_output_t *out)
{
    (void)status;
    vector_step(&c->id, out);
}

static void lose_dvl(chain_t *c, auvid_input_t *in)
{
    (void)c;
    in->dvl.present = in->dvl.present && !dvl_lost;
}

static void finish(void)
{
    TEST_ASSERT_TRUE(chain_finish(&chain, 1000, 1000) <= 1000);
    vector_whole(&chain.id);
}

/* A Girona500 at 1 N: two sets, and a dive that begins with what they have shown. */
static void test_a_girona500_and_its_prior_record(void)
{
    uint8_t record[AUVID_PRIOR_BYTES];
    vector_begin(1);
    chain_defaults(&cfg, 1, 2, 1.0);
    cfg.after = look;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, 2));
    finish();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_save(&chain.id, record));
    golden_put("with the prior\n");
    vector_restart();
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_load(&chain.id, record, sizeof record));
    vector_whole(&chain.id);
    chain_run(&chain, CHAIN_SET_S + 6.0);
    finish();
    golden_end("prior");
}

/* The DVL is lost under way; when it is back, the excitation begins again, and ends. */
static void test_an_abort_of_the_guard_and_a_restart(void)
{
    vector_begin(3);
    chain_defaults(&cfg, 3, 1, 1.0);
    cfg.before = lose_dvl;
    cfg.after = look;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, 8.0);
    dvl_lost = true;
    chain_run(&chain, 2.0);
    TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED, chain.out.guard);
    dvl_lost = false;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_disarm(&chain.id));
    chain.waiting = true; /* to arm and excite */
    chain_run(&chain, CHAIN_SET_S + 12.0);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
    finish();
    golden_end("guard");
}

static void test_a_users_model_on_the_residual_path(void)
{
    vector_begin(1);
    each_step = vector_step;
    identify(1, 2, 2000, 1.0, 0.0);
    vector_whole(&id);
    golden_end("residual");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_girona500_and_its_prior_record);
    RUN_TEST(test_an_abort_of_the_guard_and_a_restart);
    RUN_TEST(test_a_users_model_on_the_residual_path);
    return UNITY_END();
}
