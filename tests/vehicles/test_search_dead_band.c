/*
 * The search of a user's model with kinks, a dead band on the mean commands of a row: how near the
 * optimum it ends, and what it takes (search_campaign.h). The model is not declared smooth, so both
 * algorithms run.
 *
 * A cost with kinks has neighbouring minima: of delay and dead band, whose costs differ by about
 * the noise of an estimate. A search may end in one of them: measured 2 and 1 of 100, by at
 * most 0.5 % above the lowest, with the same errors of the parameters. A population twice as large,
 * one drawn around the minimum, a second restart and another first delay end there, too.
 */
#include "dead_band.h"
#include "search_campaign.h"

#define IN_ANOTHER_MINIMUM 0.03 /* of the searches; see above */

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
    campaign_run(identify_seed, SETS, "dead band", IN_ANOTHER_MINIMUM);
}

int main(int argc, char **argv)
{
    campaign_options(argc, argv, 4);
    UNITY_BEGIN();
    RUN_TEST(test_first_and_later_searches_end_at_the_optimum);
    return UNITY_END();
}
