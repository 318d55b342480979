/* The bus in memory: delivery, faults and repeatability. */
#include "fake_system.h"

#include <linux/can/error.h>
#include <string.h>

#include "bus_memory.h"

enum { MANY = 100000 };

static bus_memory_t hub;
static bus_t *const a = &hub.end[0].bus, *const b = &hub.end[1].bus, *const c = &hub.end[2].bus;
static bus_frame_t frames[BUS_MEMORY_QUEUE];

static int fresh(void **state)
{
    (void)state;
    return bus_memory_init(&hub, 3, 1);
}

static int send_number(bus_t *bus, uint32_t number)
{
    bus_frame_t frame = {.id = 0x100, .length = 4};

    memcpy(frame.data, &number, sizeof number);
    return bus->send(bus, &frame);
}

static uint32_t number_of(const bus_frame_t *frame)
{
    uint32_t number;

    memcpy(&number, frame->data, sizeof number);
    return number;
}

static int receive(bus_t *bus)
{
    return bus->receive(bus, frames, BUS_MEMORY_QUEUE);
}

static void test_all_other_ends_receive_the_frames_of_one_in_order(void **state)
{
    uint32_t i;

    (void)state;
    for (i = 0; i < 10; i++) {
        assert_int_equal(send_number(a, i), BUS_OK);
    }
    assert_int_equal(receive(a), 0);
    assert_int_equal(receive(c), 10);
    assert_int_equal(b->receive(b, frames, 3), 3);
    assert_int_equal(receive(b), 7);
    for (i = 0; i < 7; i++) {
        assert_int_equal(number_of(&frames[i]), i + 3);
    }
    assert_int_equal(b->statistics.received, 10);
    assert_int_equal(a->statistics.sent, 10);
}

static void test_a_delayed_frame_is_received_at_its_time_of_arrival(void **state)
{
    (void)state;
    hub.end[1].faults.delay_us = 20000;
    bus_memory_advance(&hub, 1000);
    assert_int_equal(send_number(a, 1), BUS_OK);
    bus_memory_advance(&hub, 19999);
    assert_int_equal(receive(b), 0);
    assert_int_equal(receive(c), 1);
    assert_int_equal(frames[0].t_us, 1000);
    bus_memory_advance(&hub, 1);
    assert_int_equal(receive(b), 1);
    assert_int_equal(frames[0].t_us, 21000);
    assert_int_equal(b->now_us(b), 21000);
}

static void test_frames_overtake_each_other_and_none_is_lost(void **state)
{
    bool seen[500] = {false};
    int i, late = 0;

    (void)state;
    hub.end[1].faults.jitter_us = 10000;
    for (i = 0; i < 500; i++) {
        assert_int_equal(send_number(a, (uint32_t)i), BUS_OK);
        bus_memory_advance(&hub, 1000);
    }
    bus_memory_advance(&hub, 10000);
    assert_int_equal(receive(b), 500);
    for (i = 0; i < 500; i++) {
        const uint32_t number = number_of(&frames[i]);

        assert_false(seen[number]);
        seen[number] = true;
        assert_in_range(frames[i].t_us - number * 1000, 0, 10000);
        if (i > 0) {
            assert_true(frames[i].t_us >= frames[i - 1].t_us);
            late += number < number_of(&frames[i - 1]);
        }
    }
    assert_in_range(late, 50, 450);
}

/* 100000 frames; the rates within five standard deviations (473, 340 frames). */
static void test_losses_and_duplicates_have_their_rates_and_add_up(void **state)
{
    const bus_memory_end_t *end = &hub.end[1];
    int i, got = 0;

    (void)state;
    hub.end[1].faults.loss_ppm = 100000;
    hub.end[1].faults.duplication_ppm = 50000;
    for (i = 0; i < MANY; i++) {
        (void)send_number(a, (uint32_t)i);
        got += receive(b);
        (void)receive(c);
    }
    assert_int_equal(got, MANY - (int)end->lost + (int)end->duplicated);
    assert_in_range(end->lost, 10000 - 473, 10000 + 473);
    assert_in_range(end->duplicated, 4500 - 340, 4500 + 340);
    assert_int_equal(c->statistics.received, MANY);
}

static void test_the_same_seed_gives_the_same_losses(void **state)
{
    static bus_frame_t first[BUS_MEMORY_QUEUE];
    int run, i, got[3];

    (void)state;
    for (run = 0; run < 3; run++) {
        assert_int_equal(bus_memory_init(&hub, 2, run < 2 ? 7 : 8), BUS_OK);
        hub.end[1].faults = (bus_memory_faults_t){300000, 200000, 500, 4000};
        for (i = 0; i < 500; i++) {
            (void)send_number(a, (uint32_t)i);
            bus_memory_advance(&hub, 1000);
        }
        got[run] = receive(b);
        if (run == 0) {
            memcpy(first, frames, sizeof first);
        } else {
            assert_int_equal(got[run] == got[0] && memcmp(first, frames, sizeof first) == 0,
                             run == 1);
        }
    }
}

static void test_a_frame_that_finds_the_queue_full_is_dropped_and_counted(void **state)
{
    int i;

    (void)state;
    for (i = 0; i < BUS_MEMORY_QUEUE + 5; i++) {
        assert_int_equal(send_number(a, (uint32_t)i), BUS_OK);
    }
    assert_int_equal(b->statistics.dropped, 5);
    assert_int_equal(receive(b), BUS_MEMORY_QUEUE);
    assert_int_equal(number_of(&frames[0]), 0);
}

static void test_a_busy_end_loses_the_reported_frames(void **state)
{
    (void)state;
    hub.end[0].fail_sends = 2;
    assert_int_equal(send_number(a, 1), BUS_BUSY);
    assert_int_equal(send_number(a, 2), BUS_BUSY);
    assert_int_equal(send_number(a, 3), BUS_OK);
    assert_int_equal(a->statistics.send_busy, 2);
    assert_int_equal(receive(b), 1);
    assert_int_equal(number_of(&frames[0]), 3);
}

static void test_an_end_that_is_down_neither_sends_nor_receives(void **state)
{
    (void)state;
    hub.end[0].down = true;
    assert_int_equal(send_number(a, 1), BUS_DOWN);
    assert_int_equal(send_number(b, 2), BUS_OK);
    assert_int_equal(receive(a), BUS_DOWN);
    hub.end[0].down = false;
    assert_int_equal(receive(a), 0);
    assert_int_equal(send_number(a, 3), BUS_OK);
    assert_int_equal(a->statistics.link_downs, 1);
    assert_int_equal(a->statistics.link_ups, 1);
    assert_int_equal(receive(b), 1);
}

static void test_an_injected_bus_off_changes_the_controller_state(void **state)
{
    const bus_frame_t off = {.id = CAN_ERR_BUSOFF, .length = 8, .flags = BUS_FRAME_ERROR};

    (void)state;
    bus_memory_inject(&hub, 1, &off);
    assert_int_equal(receive(b), 1);
    assert_int_equal(frames[0].flags, BUS_FRAME_ERROR);
    assert_int_equal(b->statistics.state, BUS_OFF);
    assert_int_equal(b->statistics.bus_offs, 1);
    assert_int_equal(receive(c), 0);
}

static void test_an_invalid_frame_is_refused(void **state)
{
    bus_frame_t frame = {.id = 0x100, .length = 9};

    (void)state;
    assert_int_equal(a->send(a, &frame), BUS_REFUSED);
    frame.length = 2;
    memset(frame.data, 0xFF, 8);
    assert_int_equal(a->send(a, &frame), BUS_OK);
    assert_int_equal(receive(b), 1);
    assert_memory_equal(frames[0].data, "\xFF\xFF\0\0\0\0\0\0", 8);
    assert_int_equal(bus_memory_init(&hub, 1, 1), BUS_REFUSED);
    assert_int_equal(bus_memory_init(&hub, BUS_MEMORY_ENDS + 1, 1), BUS_REFUSED);
}

#define TEST(name) cmocka_unit_test_setup(name, fresh)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(test_all_other_ends_receive_the_frames_of_one_in_order),
        TEST(test_a_delayed_frame_is_received_at_its_time_of_arrival),
        TEST(test_frames_overtake_each_other_and_none_is_lost),
        TEST(test_losses_and_duplicates_have_their_rates_and_add_up),
        TEST(test_the_same_seed_gives_the_same_losses),
        TEST(test_a_frame_that_finds_the_queue_full_is_dropped_and_counted),
        TEST(test_a_busy_end_loses_the_reported_frames),
        TEST(test_an_end_that_is_down_neither_sends_nor_receives),
        TEST(test_an_injected_bus_off_changes_the_controller_state),
        TEST(test_an_invalid_frame_is_refused),
    };

    cmocka_set_message_output(CM_OUTPUT_TAP);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
