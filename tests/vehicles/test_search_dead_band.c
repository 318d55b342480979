/*
 * The search of a user's model with kinks, a dead band on the mean commands of a row: how near the
 * optimum it ends, and what it takes (search_campaign.h). The model is not declared smooth, so both
 * algorithms run.
 */
#include "dead_band.h"
#include "search_campaign.h"

void setUp(void)
{
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

/* Half of the seeds with a disturbance of 1 N and a delay. */
static void identify_seed(uint64_t seed)
{
    double disturbance_N = seed % 2 == 0 ? 1.0 : 0.0, delay_s = 0.14 * disturbance_N;
    identify(seed, SETS, 0, disturbance_N, delay_s);
    campaign_take(&id, truth, (1u << PARAMETERS) - 1u, delay_s);
}

static void test_first_and_later_searches_end_at_the_optimum(void)
{
    each_step = step;
    campaign_run(identify_seed, SETS, "dead band");
}

int main(int argc, char **argv)
{
    campaign_options(argc, argv, 4);
    UNITY_BEGIN();
    RUN_TEST(test_first_and_later_searches_end_at_the_optimum);
    return UNITY_END();
}
