/*
 * The search of a user's model with kinks, a dead band on the mean commands of a row: how near the
 * optimum it ends, and what it takes. The model is not declared smooth, so both algorithms run.
 * Long form (AUVID_TEST_LONG): 100 seeds; or COUNT and FIRST as arguments.
 */
#include "dead_band.h"
#include "search_campaign.h"

static campaign_t first, later;
static uint32_t early; /* set after which the first search runs; 0: after the last */

void setUp(void)
{
}

void tearDown(void)
{
}

static void search_early(const auvid_identifier_t *unused, const auvid_output_t *out)
{
    (void)unused;
    (void)out;
    if (early > 0 && id.metric.sets.recorded == early && id.estimate.number == 0) {
        finish_work(&id, UINT32_MAX);
    }
}

/* Half of the seeds with a disturbance of 1 N and a delay. */
static void run(uint64_t seed, uint32_t after, campaign_t *campaign)
{
    double disturbance_N = seed % 2 == 0 ? 1.0 : 0.0, delay_s = 0.14 * disturbance_N;
    early = after;
    identify(seed, SETS, 0, disturbance_N, delay_s);
    TEST_ASSERT_EQUAL_UINT32(SETS, id.estimate.sets);
    TEST_ASSERT_FALSE(id.estimate.not_converged);
    campaign_take(campaign, &id, truth, (1u << PARAMETERS) - 1u, delay_s, id.work.last_units);
}

static void test_first_and_later_searches_end_at_the_optimum(void)
{
    each_step = search_early;
    for (uint64_t k = 0; k < campaign_seeds.count; ++k) {
        run(campaign_seeds.first + k, 0, &first);
        run(campaign_seeds.first + k, SETS - 1, &later);
    }
    TEST_ASSERT_EQUAL_INT(0, campaign_report(&first, "dead band, first search"));
    TEST_ASSERT_EQUAL_INT(0, campaign_report(&later, "dead band, later search"));
}

int main(int argc, char **argv)
{
    campaign_options(argc, argv, 4);
    UNITY_BEGIN();
    RUN_TEST(test_first_and_later_searches_end_at_the_optimum);
    return UNITY_END();
}
