/*
 * The search of a Girona500 in a current, 15 parameters and the delay: how near the optimum it
 * ends, and what it takes (search_campaign.h).
 */
#include "search_campaign.h"
#include "current_world.h"

enum { SETS = 8, SET_ROWS = 60, WANTED = AUVID_G500_FREE | 3u << AUVID_G500_COUNT };

static auvid_row_t store[(SETS + 1) * SET_ROWS];
static auvid_current_t current;
static world_t world;
static double truth[AUVID_G500_COUNT + 2];

void setUp(void)
{
}

void tearDown(void)
{
}

static void begin(uint64_t seed)
{
    double angle = 2.4 * (double)seed;
    const world_config_t config = {.seed = seed,
                                   .disturbance_N = 1.0,
                                   .sets = SETS,
                                   .current = {0.3 * cos(angle), 0.3 * sin(angle)}};
    begin_current_world(&world, &config, &current, store);
    memcpy(truth, world.vehicle_sim.sim.cfg.parameter, sizeof world.vehicle_sim.sim.cfg.parameter);
    truth[AUVID_G500_COUNT] = config.current[0];
    truth[AUVID_G500_COUNT + 1] = config.current[1];
}

static void identify_seed(uint64_t seed)
{
    auvid_identifier_t *id = &world.node[1].id;
    begin(seed);
    while (id->metric.sets.recorded < SETS && world_time_s(&world) < 600.0) {
        world_tick(&world);
        (void)world_work(&world, 0);
        campaign_step(id);
    }
    finish_work(id, AUVID_DEFAULT_BUDGET);
    TEST_ASSERT_EQUAL_UINT32(SETS, id->estimate.sets);
    campaign_take(id, truth, WANTED, 0.0);
}

static void test_first_and_later_searches_end_at_the_optimum(void)
{
    campaign_run(identify_seed, SETS, "current");
}

int main(int argc, char **argv)
{
    campaign_options(argc, argv, 1);
    UNITY_BEGIN();
    RUN_TEST(test_first_and_later_searches_end_at_the_optimum);
    return UNITY_END();
}
