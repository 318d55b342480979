/* The tick with the real timer, signals and pipes; fakes provoke the rest. */
#include "fake_system.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/timerfd.h>
#include <time.h>
#include <unistd.h>

#include "tick.h"

static tick_t tick;

static int fresh(void **state)
{
    (void)state;
    memset(&fake, 0, sizeof fake);
    (void)signal(SIGHUP, SIG_DFL); /* the caller may ignore it */
    return 0;
}

static int closed(void **state)
{
    (void)state;
    tick_close(&tick);
    return 0;
}

static void sleep_us(uint64_t us)
{
    const struct timespec t = {(time_t)(us / 1000000), (long)(us % 1000000) * 1000};

    (void)nanosleep(&t, NULL);
}

static void test_ticks_occur_at_absolute_times(void **state)
{
    int i;

    (void)state;
    assert_int_equal(tick_open(&tick, 5000), 0);
    for (i = 0; i < 20; i++) {
        assert_int_equal(tick_wait(&tick, -1), TICK_DUE);
        assert_true(tick_now_us() >= tick.start_us + tick.ticks * 5000);
        sleep_us(1000); /* the duration of the work must not accumulate */
    }
    assert_true(tick_now_us() < tick.start_us + (tick.ticks + 1) * 5000 + 1000000);
    assert_int_equal(tick.ticks - tick.missed, 20);
    assert_int_equal(fake.clock_id, CLOCK_MONOTONIC);
    assert_int_equal(fake.timer_flags, TFD_TIMER_ABSTIME);
}

static void test_missed_ticks_are_counted(void **state)
{
    (void)state;
    assert_int_equal(tick_open(&tick, 2000), 0);
    sleep_us(11000);
    assert_int_equal(tick_wait(&tick, -1), TICK_DUE);
    assert_true(tick.ticks >= 5);
    assert_int_equal(tick.missed, tick.ticks - 1);
}

static void test_seven_elapsed_periods_are_six_missed_ticks(void **state)
{
    (void)state;
    assert_int_equal(tick_open(&tick, 1000), 0);
    sleep_us(1500);
    fake.expirations = 7;
    assert_int_equal(tick_wait(&tick, -1), TICK_DUE);
    assert_int_equal(tick.ticks, 7);
    assert_int_equal(tick.missed, 6);
}

static void test_a_step_of_the_wall_clock_shifts_no_tick(void **state)
{
    (void)state;
    assert_int_equal(tick_open(&tick, 2000), 0);
    fake.clocks = true;
    fake.monotonic_us = tick.start_us;
    fake.wall_us = 1; /* 1970 */
    assert_int_equal(tick_wait(&tick, 1000), TICK_DUE);
    fake.wall_us = UINT64_C(4000000000000000);
    assert_int_equal(tick_wait(&tick, 1000), TICK_DUE);
    assert_int_equal(tick_now_us(), fake.monotonic_us);
}

static void test_frames_wake_a_program_without_a_timer(void **state)
{
    int ends[2];

    (void)state;
    assert_int_equal(pipe(ends), 0);
    assert_int_equal(tick_open(&tick, 0), 0);
    assert_int_equal(tick_watch(&tick, ends[0]), 0);
    assert_int_equal(tick_watch(&tick, -1), 0);
    assert_int_equal(tick_wait(&tick, 0), 0);
    assert_int_equal(write(ends[1], "x", 1), 1);
    assert_int_equal(tick_wait(&tick, -1), TICK_READABLE);
    assert_int_equal(tick.ticks, 0);
    (void)close(ends[0]);
    (void)close(ends[1]);
}

static const int stops[TICK_SIGNALS] = {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGXFSZ};

static void test_five_signals_request_a_stop(void **state)
{
    int i;

    (void)state;
    assert_int_equal(tick_open(&tick, 0), 0);
    for (i = 0; i < TICK_SIGNALS; i++) {
        assert_int_equal(raise(stops[i]), 0);
        assert_int_equal(tick_wait(&tick, -1), TICK_STOP);
        assert_int_equal(tick.signal, stops[i]);
    }
    assert_int_equal(tick_wait(&tick, 0), 0);
}

/* Unblocked by close, the second one would end the program. */
static void test_a_second_signal_does_not_end_the_program(void **state)
{
    (void)state;
    assert_int_equal(tick_open(&tick, 0), 0);
    assert_int_equal(raise(SIGTERM), 0);
    assert_int_equal(raise(SIGINT), 0);
    assert_int_equal(tick_wait(&tick, -1), TICK_STOP);
    tick_close(&tick);
}

static void test_writing_to_a_pipe_without_a_reader_fails_and_requests_a_stop(void **state)
{
    int ends[2];

    (void)state;
    assert_int_equal(pipe(ends), 0);
    assert_int_equal(tick_open(&tick, 0), 0);
    (void)close(ends[0]);
    fake.closes = 0;
    assert_int_equal(write(ends[1], "x", 1), -1);
    assert_int_equal(errno, EPIPE);
    assert_int_equal(tick_wait(&tick, 0), TICK_STOP);
    assert_int_equal(tick.signal, SIGPIPE);
    (void)close(ends[1]);
}

static void test_an_ignored_hang_up_remains_ignored(void **state)
{
    (void)state;
    assert_true(signal(SIGHUP, SIG_IGN) != SIG_ERR); /* as nohup does */
    assert_int_equal(tick_open(&tick, 0), 0);
    assert_int_equal(raise(SIGHUP), 0);
    assert_int_equal(tick_wait(&tick, 0), 0);
    assert_true(signal(SIGHUP, SIG_DFL) != SIG_ERR);
}

static void test_close_restores_the_signals(void **state)
{
    sigset_t mask;
    int i;

    (void)state;
    assert_int_equal(tick_open(&tick, 1000), 0);
    (void)sigprocmask(SIG_BLOCK, NULL, &mask);
    for (i = 0; i < TICK_SIGNALS; i++) {
        assert_true(sigismember(&mask, stops[i]));
    }
    tick_close(&tick);
    (void)sigprocmask(SIG_BLOCK, NULL, &mask);
    for (i = 0; i < TICK_SIGNALS; i++) {
        assert_false(sigismember(&mask, stops[i]));
    }
    assert_int_equal(fake.closes, 3);
}

static void test_failures_are_reported_and_leave_nothing_open(void **state)
{
    (void)state;
    fake.timer_error = EMFILE;
    assert_int_equal(tick_open(&tick, 1000), -1);
    assert_non_null(strstr(tick.text, "Too many open files"));
    assert_int_equal(fake.closes, 2);
    fake.timer_error = 0;
    assert_int_equal(tick_open(&tick, 1000), 0);
    fake.epoll_error = EINTR;
    assert_int_equal(tick_wait(&tick, -1), 0);
    fake.epoll_error = EBADF;
    assert_int_equal(tick_wait(&tick, -1), -1);
    assert_int_equal(tick_watch(&tick, 12345), -1);
    assert_non_null(strstr(tick.text, "Bad file descriptor"));
}

static void test_granted_real_time_gives_no_text(void **state)
{
    char text[TICK_TEXT] = "x";

    (void)state;
    assert_int_equal(tick_realtime(40, text, sizeof text), 0);
    assert_string_equal(text, "");
}

static void test_refused_real_time_gives_a_warning(void **state)
{
    char text[TICK_TEXT];

    (void)state;
    fake.scheduler_error = EPERM;
    assert_int_equal(tick_realtime(40, text, sizeof text), 1);
    assert_non_null(strstr(text, "no real-time priority 40 (Operation not permitted)"));
    assert_null(strstr(text, "memory"));
    fake.lock_error = ENOMEM;
    assert_int_equal(tick_realtime(40, text, sizeof text), 2);
    assert_non_null(strstr(text, "ulimit -r"));
    assert_non_null(strstr(text, "ulimit -l"));
    assert_int_equal(tick_realtime(40, text, 10), 2);
    assert_int_equal(strlen(text), 9);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, fresh, closed)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(test_ticks_occur_at_absolute_times),
        TEST(test_missed_ticks_are_counted),
        TEST(test_seven_elapsed_periods_are_six_missed_ticks),
        TEST(test_a_step_of_the_wall_clock_shifts_no_tick),
        TEST(test_frames_wake_a_program_without_a_timer),
        TEST(test_five_signals_request_a_stop),
        TEST(test_a_second_signal_does_not_end_the_program),
        TEST(test_writing_to_a_pipe_without_a_reader_fails_and_requests_a_stop),
        TEST(test_an_ignored_hang_up_remains_ignored),
        TEST(test_close_restores_the_signals),
        TEST(test_failures_are_reported_and_leave_nothing_open),
        cmocka_unit_test_setup(test_granted_real_time_gives_no_text, fresh),
        cmocka_unit_test_setup(test_refused_real_time_gives_a_warning, fresh),
    };

    cmocka_set_message_output(CM_OUTPUT_TAP);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
