/* Times of frames of the SocketCAN back end, with fake system calls and clocks. */
#include "socketcan.h"

static void test_kernel_stamps_become_times_of_the_bus_clock(void **state)
{
    (void)state;
    fake_arrives(0x123, 1)->wall_us = fake.wall_us + 1000;
    fake_arrives(0x123, 2)->wall_us = fake.wall_us + 4000;
    pass(5000);
    assert_int_equal(receive(), 2);
    assert_int_equal(frames[0].t_us, 50001000);
    assert_int_equal(frames[1].t_us, 50004000);
    assert_int_equal(bus->now_us(bus), 50005000);
    assert_int_equal(bus->statistics.clock_steps, 0);
}

static void test_a_frame_without_a_timestamp_arrived_now(void **state)
{
    (void)state;
    fake_arrives(0x123, 1);
    pass(5000);
    assert_int_equal(receive(), 1);
    assert_int_equal(frames[0].t_us, 50005000);
}

/* Two frames are queued, one before and one after a step of the wall clock by `step_us`. */
static void check_step(int64_t step_us)
{
    pass(100000);
    fake_arrives(0x123, 1)->wall_us = fake.wall_us;
    pass(2000);
    fake.wall_us += (uint64_t)step_us;
    fake_arrives(0x123, 2)->wall_us = fake.wall_us;
    pass(3000);
    assert_int_equal(receive(), 2);
    assert_int_equal(frames[0].t_us, 50100000);
    assert_int_equal(frames[1].t_us, 50102000);
    assert_int_equal(bus->statistics.clock_steps, 1);
    fake_arrives(0x123, 3)->wall_us = fake.wall_us;
    pass(1000);
    assert_int_equal(receive(), 1);
    assert_int_equal(frames[0].t_us, 50105000);
    assert_int_equal(bus->statistics.clock_steps, 1);
}

static void test_stamps_survive_a_wall_clock_set_forward(void **state)
{
    (void)state;
    check_step(3600000000);
}

static void test_stamps_survive_a_wall_clock_set_back(void **state)
{
    (void)state;
    check_step(-900000000);
}

/* It seems older than it is, by the step at most, as long as another one waits. */
static void test_after_a_small_step_of_the_wall_clock_no_frame_seems_newer_than_it_is(void **state)
{
    static const int64_t step_us[] = {50000, -50000, -200000};
    int i;

    (void)state;
    for (i = 0; i < 3; i++) {
        const uint64_t before_us = fake.monotonic_us + 100000;

        pass(100000);
        fake_arrives(0x123, 1)->wall_us = fake.wall_us;
        pass(250000); /* longer than the step: both offsets give a time in the past */
        fake.wall_us += (uint64_t)step_us[i];
        fake_arrives(0x123, 2)->wall_us = fake.wall_us;
        pass(3000);
        assert_int_equal(receive(), 2);
        assert_in_range(frames[0].t_us, before_us - 50000, before_us);
        assert_in_range(frames[1].t_us, before_us + 50000, before_us + 250000);
        fake_arrives(0x123, 3)->wall_us = fake.wall_us;
        pass(1000);
        assert_int_equal(receive(), 1);
        assert_int_equal(frames[0].t_us, fake.monotonic_us - 1000);
    }
}

static void test_a_gradual_adjustment_of_the_wall_clock_is_no_step(void **state)
{
    int i;

    (void)state;
    for (i = 0; i < 100; i++) {
        pass(1000000);
        fake.wall_us += 500;
        fake_arrives(0x123, 1)->wall_us = fake.wall_us - 1000;
        assert_int_equal(receive(), 1);
        assert_in_range(fake.monotonic_us - frames[0].t_us, 0, 1500);
    }
    pass(60000000); /* a minute of silence */
    fake.wall_us += 30000;
    fake_arrives(0x123, 1)->wall_us = fake.wall_us;
    assert_int_equal(receive(), 1);
    assert_int_equal(bus->statistics.clock_steps, 0);
}

static void test_an_interruption_between_the_clock_readings_is_no_step(void **state)
{
    (void)state;
    fake.pause_us = 50000;
    fake_arrives(0x123, 1)->wall_us = fake.wall_us + 1000;
    pass(5000);
    assert_int_equal(receive(), 1);
    assert_int_equal(frames[0].t_us, 50001000);
    assert_int_equal(bus->statistics.clock_steps, 0);
}

static void test_stamps_never_run_backwards_nor_into_the_future(void **state)
{
    (void)state;
    pass(1000);
    fake_arrives(0x123, 1)->wall_us = fake.wall_us - 100;
    fake_arrives(0x123, 2)->wall_us = fake.wall_us - 500;
    fake_arrives(0x123, 3)->wall_us = fake.wall_us + 700;
    assert_int_equal(receive(), 3);
    assert_int_equal(frames[0].t_us, 50000900);
    assert_int_equal(frames[1].t_us, 50000900);
    assert_int_equal(frames[2].t_us, 50001000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        OPENED(test_kernel_stamps_become_times_of_the_bus_clock),
        OPENED(test_a_frame_without_a_timestamp_arrived_now),
        OPENED(test_stamps_survive_a_wall_clock_set_forward),
        OPENED(test_stamps_survive_a_wall_clock_set_back),
        OPENED(test_after_a_small_step_of_the_wall_clock_no_frame_seems_newer_than_it_is),
        OPENED(test_a_gradual_adjustment_of_the_wall_clock_is_no_step),
        OPENED(test_an_interruption_between_the_clock_readings_is_no_step),
        OPENED(test_stamps_never_run_backwards_nor_into_the_future),
    };

    cmocka_set_message_output(CM_OUTPUT_TAP);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
