/*
 * Who commands the thrusters, and when: every frame of whole runs, seen by a separate end of the
 * bus in memory.
 *
 * There is no command before an arm frame. After an abort or the end of the excitation there is one
 * command of zero (both frames) if the previous tick commanded thrust. Then there is none, even
 * after further arm frames.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"
#include "bus/world.h"

enum { SETS = 2, TICKS = 4000, FRAMES = 60000, NEVER = TICKS + 1 };

/* The tick of the operator's arm frame: the node has navigated for a second. */
enum { ARM_TICK = 51 };

typedef struct {
    uint32_t tick;
    auvid_can_kind_t kind;
    double largest; /* maximum thrust commanded */
} seen_t;

static world_t world;
static world_config_t cfg;
static seen_t seen[FRAMES];
static int frames;

void setUp(void)
{
    memset(&cfg, 0, sizeof cfg);
    cfg.seed = 1;
    cfg.sets = SETS;
}

void tearDown(void)
{
}

static double largest(const auvid_can_message_t *m)
{
    double max_thrust = 0.0;
    for (int i = 0; i < 4; ++i) { /* b has the same layout */
        max_thrust = fmax(max_thrust, fabs((double)m->as.thruster_command_a.thrust[i]));
    }
    return max_thrust;
}

static bool commands(auvid_can_kind_t kind)
{
    return kind == AUVID_CAN_THRUSTER_COMMAND_A || kind == AUVID_CAN_THRUSTER_COMMAND_B;
}

static void watch(uint32_t tick)
{
    auvid_can_frame_t frame;
    auvid_can_message_t m;
    while (frames_receive(&world.hub.end[WORLD_LISTENER], &frame)) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_unpack(NULL, &frame, &m));
        TEST_ASSERT_TRUE(frames < FRAMES);
        const seen_t one = {tick, m.kind, commands(m.kind) ? largest(&m) : 0.0};
        seen[frames++] = one;
    }
}

/* A whole run with an abort in tick `abort`, and an arm frame every second from tick `arm_from` on.
 * @return was thrust commanded in the tick before the abort? */
static bool run(uint32_t abort, uint32_t arm_from)
{
    bool commanding = false;
    frames = 0;
    TEST_ASSERT_TRUE(world_begin(&world, &cfg));
    for (uint32_t tick = 1; tick <= TICKS; ++tick) {
        if (tick == abort) {
            commanding = world.node[0].commanding;
            world.vehicle_sim.order_abort = true;
        }
        world.vehicle_sim.order_arm = tick >= arm_from && tick % 50 == 0;
        world_tick(&world);
        (void)world_work(&world, AUVID_DEFAULT_BUDGET);
        watch(tick);
    }
    TEST_ASSERT_EQUAL(0, (int)world.hub.end[WORLD_LISTENER].bus.statistics.dropped);
    return commanding;
}

/* Number of frames of a kind, from frame `from` on. */
static int count(auvid_can_kind_t kind, int from)
{
    int n = 0;
    for (int i = from; i < frames; ++i) {
        n += seen[i].kind == kind;
    }
    return n;
}

static int count_commands(int from)
{
    return count(AUVID_CAN_THRUSTER_COMMAND_A, from) + count(AUVID_CAN_THRUSTER_COMMAND_B, from);
}

/* Index of the first frame of a kind; `frames` if there is none. */
static int first(auvid_can_kind_t kind)
{
    int i = 0;
    while (i < frames && seen[i].kind != kind) {
        ++i;
    }
    return i;
}

static void test_a_passive_node_sends_no_command_in_a_whole_run(void)
{
    cfg.passive = true;
    for (cfg.seed = 1; cfg.seed <= 4; ++cfg.seed) {
        (void)run(NEVER, NEVER);
        TEST_ASSERT_TRUE(count(AUVID_CAN_ARM, 0) > 60); /* every second, because it is not obeyed */
        TEST_ASSERT_TRUE(count(AUVID_CAN_HEARTBEAT, 0) > 100);
        TEST_ASSERT_EQUAL(0, count_commands(0));
    }
}

static void test_without_an_arm_frame_a_whole_run_has_no_command(void)
{
    cfg.no_arm = true;
    for (cfg.seed = 1; cfg.seed <= 4; ++cfg.seed) {
        (void)run(NEVER, NEVER);
        TEST_ASSERT_EQUAL(0, count(AUVID_CAN_ARM, 0));
        TEST_ASSERT_TRUE(count(AUVID_CAN_HEARTBEAT, 0) > 100);
        TEST_ASSERT_EQUAL(0, count_commands(0));
    }
}

static void test_commands_begin_after_the_arm_frame_and_end_with_one_of_zero(void)
{
    for (cfg.seed = 1; cfg.seed <= 4; ++cfg.seed) {
        (void)run(NEVER, NEVER);
        int arm = first(AUVID_CAN_ARM);
        TEST_ASSERT_EQUAL_UINT32(ARM_TICK, seen[arm].tick);
        TEST_ASSERT_TRUE(first(AUVID_CAN_THRUSTER_COMMAND_A) > arm);
        TEST_ASSERT_TRUE(first(AUVID_CAN_THRUSTER_COMMAND_B) > arm);
        int last = frames - 1; /* the last command, its second half */
        while (last > 0 && !commands(seen[last].kind)) {
            --last;
        }
        TEST_ASSERT_TRUE(seen[last].tick > 3000 && seen[last].tick < TICKS - 100);
        TEST_ASSERT_TRUE(seen[last].largest == 0.0);
        TEST_ASSERT_TRUE(world.node[0].id.estimate.number == SETS);
    }
}

static void test_after_an_abort_there_is_at_most_one_command_and_it_is_zero(void)
{
    static const uint32_t ticks[] = {/* before navigation, before arming, with the arm frame */
                                     1, 30, ARM_TICK,
                                     /* in the fade-in, and in the sets */
                                     ARM_TICK + 1, ARM_TICK + 2, ARM_TICK + 20, 700, 1551, 1552,
                                     2222, 3000,
                                     /* in the fade-out, near its end, and after it */
                                     3045, 3050, 3051, 3052, 3053, 3054, 3300};
    int zeros = 0;
    for (cfg.seed = 1; cfg.seed <= 3; ++cfg.seed) {
        for (size_t k = 0; k < sizeof ticks / sizeof ticks[0]; ++k) {
            bool commanding = run(ticks[k], ticks[k]);
            int abort = first(AUVID_CAN_ABORT);
            TEST_ASSERT_EQUAL_UINT32(ticks[k], seen[abort].tick);
            TEST_ASSERT_TRUE(count(AUVID_CAN_ARM, abort) >= (TICKS - (int)ticks[k]) / 50);
            TEST_ASSERT_EQUAL(ticks[k] > ARM_TICK, count_commands(0) > 0);
            TEST_ASSERT_EQUAL(commanding, count(AUVID_CAN_THRUSTER_COMMAND_A, abort));
            TEST_ASSERT_EQUAL(commanding, count(AUVID_CAN_THRUSTER_COMMAND_B, abort));
            for (int i = abort; i < frames; ++i) {
                bool zero = seen[i].tick == ticks[k] && !(seen[i].largest > 0.0);
                TEST_ASSERT_TRUE(zero || !commands(seen[i].kind));
            }
            zeros += commanding;
        }
    }
    TEST_ASSERT_TRUE(zeros >= 3 * 8);
    printf("%d aborts while commanding\n", zeros);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_passive_node_sends_no_command_in_a_whole_run);
    RUN_TEST(test_without_an_arm_frame_a_whole_run_has_no_command);
    RUN_TEST(test_commands_begin_after_the_arm_frame_and_end_with_one_of_zero);
    RUN_TEST(test_after_an_abort_there_is_at_most_one_command_and_it_is_zero);
    return UNITY_END();
}
