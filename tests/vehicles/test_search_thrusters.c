/*
 * The search of a Girona500 with its thrusters, 16 parameters: how near the optimum it ends, and
 * what it takes. Long form (AUVID_TEST_LONG): 100 seeds; or COUNT and FIRST as arguments.
 */
#include "own_thrusters.h"
#include "search_campaign.h"

static campaign_t first, later;
static uint32_t early; /* set after which the first search runs; 0: after the last */

void setUp(void)
{
    own_thrusters_defaults();
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

static void run(uint64_t seed, uint32_t after, campaign_t *campaign)
{
    early = after;
    identify(seed);
    TEST_ASSERT_EQUAL_UINT32(after > 0 ? 2 : 1, id.estimate.number);
    TEST_ASSERT_FALSE(id.estimate.not_converged);
    campaign_take(campaign, &id, truth, FREE, 0.0, id.work.last_units);
}

static void test_first_and_later_searches_end_at_the_optimum(void)
{
    each_step = search_early;
    for (uint64_t k = 0; k < campaign_seeds.count; ++k) {
        run(campaign_seeds.first + k, 0, &first);
        run(campaign_seeds.first + k, SETS - 1, &later);
    }
    TEST_ASSERT_EQUAL(0, campaign_report(&first, "thrusters, first search"));
    TEST_ASSERT_EQUAL(0, campaign_report(&later, "thrusters, later search"));
}

int main(int argc, char **argv)
{
    campaign_options(argc, argv, 1);
    UNITY_BEGIN();
    RUN_TEST(test_first_and_later_searches_end_at_the_optimum);
    return UNITY_END();
}
