/*
 * A sensor's spikes are recorded if they are in range. What they leave in the state is in range,
 * too: the identifier's own checkpoint is accepted.
 */
#include "auvid/uncertain.h"
#include "checkpoint_case.h"
#include "save_checkpoint.h"

/* Components of attitude, velocity and wrench, one after the other. */
enum { PITCH_ANGLE = 1, SURGE_VELOCITY = 3, YAW_RATE = 8, SURGE_FORCE = 9, YAW_MOMENT = 14 };
enum { FIRST_SPIKE = 30, SPIKES_EVERY = 17, SPIKE_CELLS = 5, LAST = 600, PLENTY = 20000 };

static const int driven[] = {AUVID_SURGE, AUVID_SWAY, AUVID_HEAVE, AUVID_YAW};
static auvid_allocation_t thrusters;
static auvid_uncertain_t uncertain, uncertain_other;

static void begin(auvid_identifier_t *of, auvid_uncertain_t *with)
{
    auvid_uncertain_config_t inputs;
    auvid_uncertain_defaults(&inputs);
    init(of);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_uncertain(of, with, &inputs, &thrusters));
}

/* One thruster for each DoF that is driven. */
static void begin_both(void)
{
    auvid_allocation_config_t allocation;
    auvid_allocation_defaults(&allocation);
    allocation.thrusters = 4;
    for (int i = 0; i < 4; ++i) {
        allocation.thruster[i].wrench[driven[i]] = 1;
        allocation.thruster[i].max_N = 300;
        allocation.thruster[i].min_N = -300;
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&thrusters, &allocation));
    begin(&id, &uncertain);
    begin(&other, &uncertain_other);
}

/* A cell of motion by these wrenches, with `size` instead of one component of the attitude, the
 * velocity or the wrench; then work. */
static void move_with_spike(int cell, int component, auvid_real_t size)
{
    auvid_real_t value[15], command[AUVID_MAX_COMMANDS] = {0};
    for (int k = 0; k < 15; ++k) {
        auvid_real_t cosine, phase = AUVID_C(0.05) * (auvid_real_t)(cell * (k + 3));
        auvid_sincos(phase, &value[k], &cosine);
        value[k] *= k < 3 ? AUVID_C(0.1) : k < 9 ? AUVID_C(0.3) : AUVID_C(200.0);
    }
    if (component >= 0) {
        value[component] = size;
    }
    for (int i = 0; i < 4; ++i) {
        command[i] = value[9 + driven[i]];
    }
    uint64_t t_us = (uint64_t)cell * CELL_US;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&id, t_us, value + 9, command));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_motion(&id, t_us, value, value + 3));
    (void)auvid_identifier_work(&id, PLENTY);
}

static void restore_own(void)
{
    bytes = save_checkpoint(&id, saved, sizeof saved);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&other, saved, bytes));
}

static void test_a_checkpoint_after_spikes_is_accepted(void)
{
    static const auvid_real_t size[] = {AUVID_C(1e4), AUVID_C(-1e9)};
    static const int spiked[] = {PITCH_ANGLE, SURGE_VELOCITY, YAW_RATE, SURGE_FORCE, YAW_MOMENT};
    int informed = 0;
    for (unsigned k = 0; k < 10; ++k) {
        begin_both();
        for (int cell = 0; cell < LAST; ++cell) {
            bool spike = cell >= FIRST_SPIKE && cell % SPIKES_EVERY < SPIKE_CELLS;
            move_with_spike(cell, spike ? spiked[k % 5] : -1, size[k / 5]);
            if (cell >= FIRST_SPIKE && cell % 2 == 0) {
                restore_own();
            }
        }
        informed += uncertain.informed > 0;
    }
    TEST_ASSERT_TRUE(informed >= 5); /* solutions were saved, too */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_checkpoint_after_spikes_is_accepted);
    return UNITY_END();
}
