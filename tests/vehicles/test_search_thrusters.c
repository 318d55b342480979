/*
 * The search of a Girona500 with its thrusters, 16 parameters: how near the optimum it ends, and
 * what it takes (search_campaign.h).
 */
#include "own_thrusters.h"
#include "search_campaign.h"

void setUp(void)
{
    own_thrusters_defaults();
}

void tearDown(void)
{
}

static void step(const auvid_identifier_t *unused, const auvid_output_t *out)
{
    (void)unused;
    (void)out;
    campaign_step(&id);
}

static void identify_seed(uint64_t seed)
{
    identify(seed);
    campaign_take(&id, truth, FREE, 0.0);
}

static void test_first_and_later_searches_end_at_the_optimum(void)
{
    each_step = step;
    campaign_run(identify_seed, SETS, "thrusters");
}

int main(int argc, char **argv)
{
    campaign_options(argc, argv, 1);
    UNITY_BEGIN();
    RUN_TEST(test_first_and_later_searches_end_at_the_optimum);
    return UNITY_END();
}
