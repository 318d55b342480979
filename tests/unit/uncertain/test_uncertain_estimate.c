/* The estimate with uncertain inputs stays while new rows do not contradict it. */
#include <math.h>

#include "uncertain_worlds.h"
#include "unity.h"

void setUp(void)
{
}

void tearDown(void)
{
}

/* A set has fewer rows than a solution needs: those of the first sets are too few once they count
 * less. */
static void test_the_estimate_stays_while_early_rows_count_less(void)
{
    bool waited = false, estimated = false;
    begin(EXCITED);
    cfg.id.metric.set_rows = 14;
    begin_world();
    for (uint32_t k = 0; k < 2500; ++k) {
        tick();
        (void)auvid_identifier_work(id, 100000);
        waited = waited || (estimated && uncertain.estimate.number < id->estimate.number);
        TEST_ASSERT_TRUE(!estimated || uncertain.estimate.number > 0);
        estimated = uncertain.estimate.number > 0;
    }
    TEST_ASSERT_TRUE(waited && estimated);
}

/* A pilot drives surge alone when the excitation is over: the ring forgets the other axes, but the
 * rows of the excitation are all there. */
static void test_driving_after_an_excitation_does_not_erase_its_result(void)
{
    begin(EXCITED);
    cfg.id.metric.sets = 4;
    begin_world();
    for (uint32_t k = 0; k < 20000; ++k) {
        pilot_N = k > 9000 ? 60.0 * sin(0.02 * k) : 0.0;
        tick();
        (void)auvid_identifier_work(id, 100000);
        if (k == 9000) {
            before = uncertain;
        }
    }
    pilot_N = 0.0;
    TEST_ASSERT_TRUE(id->estimate.number > before.estimate.number);
    TEST_ASSERT_FALSE(id->estimate.excited >> AUVID_HEAVE & 1);
    TEST_ASSERT_TRUE(uncertain.estimate.excited >> AUVID_HEAVE & 1);
    TEST_ASSERT_EQUAL_MEMORY(before.estimate.pi, uncertain.estimate.pi, sizeof before.estimate.pi);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_estimate_stays_while_early_rows_count_less);
    RUN_TEST(test_driving_after_an_excitation_does_not_erase_its_result);
    return UNITY_END();
}
