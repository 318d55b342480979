/* Every path of the SocketCAN back end but its times, with fake system calls. */
#include "socketcan.h"

#include <errno.h>
#include <linux/can/error.h>

static const bus_frame_t hello = {.id = 0x123, .length = 2, .data = {1, 2}};

static void check_open_fails(int status, const char *words)
{
    assert_int_equal(bus_socketcan_open(&can, "can0", NULL, 0), status);
    assert_non_null(strstr(bus->text, words));
    assert_null(strchr(bus->text, '\n'));
    assert_int_equal(bus->fd, -1);
    assert_int_equal(bus->close(bus), BUS_OK);
}

static void test_open_reports_a_kernel_without_can(void **state)
{
    (void)state;
    fake.socket_error = EAFNOSUPPORT;
    check_open_fails(BUS_BROKEN, "modprobe can-raw");
    fake.socket_error = EPROTONOSUPPORT;
    check_open_fails(BUS_BROKEN, "modprobe can-raw");
}

static void test_open_reports_a_missing_permission(void **state)
{
    (void)state;
    fake.socket_error = EPERM;
    check_open_fails(BUS_BROKEN, "CAP_NET_RAW");
    fake.socket_error = 0;
    fake.bind_error = EACCES;
    check_open_fails(BUS_BROKEN, "CAP_NET_RAW");
}

static void test_open_reports_a_missing_interface(void **state)
{
    (void)state;
    fake.index_error = ENODEV;
    check_open_fails(BUS_BROKEN, "there is no interface 'can0'");
    assert_int_equal(fake.closes, 1);
}

static void test_open_reports_an_interface_that_is_not_can(void **state)
{
    (void)state;
    fake.bind_error = ENODEV;
    check_open_fails(BUS_BROKEN, "'can0' is not a CAN interface");
    assert_int_equal(fake.closes, 1);
}

static void test_open_reports_an_unexpected_error(void **state)
{
    (void)state;
    fake.socket_error = EMFILE;
    check_open_fails(BUS_BROKEN, "Too many open files");
    fake.socket_error = 0;
    fake.bind_error = EINVAL;
    check_open_fails(BUS_BROKEN, "Invalid argument");
    fake.bind_error = 0;
    fake.option_error = ENOPROTOOPT;
    check_open_fails(BUS_BROKEN, "Protocol not available");
}

static void test_open_refuses_invalid_names_and_filters(void **state)
{
    (void)state;
    assert_int_equal(bus_socketcan_open(&can, "", NULL, 0), BUS_REFUSED);
    assert_int_equal(bus_socketcan_open(&can, "sixteen_letters_", NULL, 0), BUS_REFUSED);
    assert_int_equal(bus_socketcan_open(&can, "can0", NULL, BUS_FILTERS + 1), BUS_REFUSED);
    assert_int_equal(fake.binds, 0);
}

static void test_open_requests_timestamps_drops_errors_and_a_large_buffer(void **state)
{
    (void)state;
    assert_true(fake.stamps);
    assert_true(fake.overruns);
    assert_int_equal(fake.error_mask, CAN_ERR_MASK);
    assert_true(can.receive_buffer >= 4 << 20);
    assert_int_equal(fake.filter_count, 1);
    assert_int_equal(fake.filters[0].can_mask, 0);
}

static void test_open_accepts_a_smaller_buffer_without_privilege(void **state)
{
    (void)state;
    fake.force_error = EPERM;
    assert_int_equal(bus_socketcan_open(&can, "can0", NULL, 0), BUS_OK);
    assert_int_equal(can.receive_buffer, 400000);
    (void)bus->close(bus);
}

static void test_a_filter_distinguishes_short_ids_long_ids_and_remote_requests(void **state)
{
    const bus_filter_t filters[] = {{0x400, 0x7C0, false}, {0x12345, 0x1FFFFFFF, true}};
    uint32_t id, mask;

    (void)state;
    assert_int_equal(bus_socketcan_open(&can, "can0", filters, 2), BUS_OK);
    assert_int_equal(fake.filter_count, 2);
    id = fake.filters[0].can_id;
    mask = fake.filters[0].can_mask;
    assert_int_equal(0x43F & mask, id & mask);
    assert_int_not_equal(0x440 & mask, id & mask);
    assert_int_not_equal((0x400 | CAN_EFF_FLAG) & mask, id & mask);
    assert_int_not_equal((0x400 | CAN_RTR_FLAG) & mask, id & mask);
    id = fake.filters[1].can_id;
    mask = fake.filters[1].can_mask;
    assert_int_equal((0x12345 | CAN_EFF_FLAG) & mask, id & mask);
    assert_int_not_equal((0x12345) & mask, id & mask);
    (void)bus->close(bus);
}

static void test_an_interface_that_is_down_can_be_opened(void **state)
{
    (void)state;
    fake.interface_flags = 0;
    assert_int_equal(bus_socketcan_open(&can, "can0", NULL, 0), BUS_OK);
    assert_false(bus->statistics.link_up);
    fake_arrives_error(ENETDOWN);
    assert_int_equal(receive(), BUS_DOWN);
    assert_int_equal(bus->statistics.link_downs, 0);
    fake.interface_flags = IFF_UP;
    assert_int_equal(receive(), 0);
    assert_true(bus->statistics.link_up);
    (void)bus->close(bus);
}

static void test_send_writes_the_format_of_the_kernel(void **state)
{
    bus_frame_t frame = {.id = 0x1ABCDEF, .length = 3, .flags = BUS_FRAME_EXTENDED};

    (void)state;
    memcpy(frame.data, "abcdefgh", 8);
    assert_int_equal(bus->send(bus, &frame), BUS_OK);
    assert_int_equal(fake.written.can_id, 0x1ABCDEF | CAN_EFF_FLAG);
    assert_int_equal(fake.written.len, 3);
    assert_memory_equal(fake.written.data, "abc\0\0\0\0\0", 8);
    frame.id = 0x7FF;
    frame.flags = BUS_FRAME_RTR;
    assert_int_equal(bus->send(bus, &frame), BUS_OK);
    assert_int_equal(fake.written.can_id, 0x7FF | CAN_RTR_FLAG);
    assert_int_equal(bus->statistics.sent, 2);
}

static void test_send_refuses_an_invalid_frame_without_a_system_call(void **state)
{
    bus_frame_t frame = {.id = 0x100, .length = 9};

    (void)state;
    assert_int_equal(bus->send(bus, &frame), BUS_REFUSED);
    frame.length = 8;
    frame.id = 0x800;
    assert_int_equal(bus->send(bus, &frame), BUS_REFUSED);
    frame.id = 0x20000000;
    frame.flags = BUS_FRAME_EXTENDED;
    assert_int_equal(bus->send(bus, &frame), BUS_REFUSED);
    assert_int_equal(bus->statistics.send_failed, 3);
    assert_int_equal(fake.writes, 0);
}

static void test_a_full_send_queue_is_counted_and_is_temporary(void **state)
{
    (void)state;
    fake.write_error = ENOBUFS;
    fake.write_errors = 2;
    assert_int_equal(bus->send(bus, &hello), BUS_BUSY);
    assert_int_equal(bus->send(bus, &hello), BUS_BUSY);
    assert_non_null(strstr(bus->text, "queue"));
    assert_int_equal(bus->send(bus, &hello), BUS_OK);
    fake.write_error = EAGAIN;
    fake.write_errors = 1;
    assert_int_equal(bus->send(bus, &hello), BUS_BUSY);
    assert_int_equal(bus->statistics.send_busy, 3);
    assert_int_equal(bus->statistics.sent, 1);
    assert_int_equal(bus->statistics.send_failed, 0);
}

static void test_an_interrupted_send_is_repeated(void **state)
{
    (void)state;
    fake.write_error = EINTR;
    fake.write_errors = 3;
    assert_int_equal(bus->send(bus, &hello), BUS_OK);
    assert_int_equal(fake.writes, 4);
    assert_int_equal(bus->statistics.sent, 1);
}

static void test_a_frame_that_the_kernel_truncates_is_an_error(void **state)
{
    (void)state;
    fake.write_short = 5;
    assert_int_equal(bus->send(bus, &hello), BUS_BROKEN);
    assert_int_equal(bus->statistics.send_failed, 1);
    assert_int_equal(bus->statistics.sent, 0);
}

static void test_sending_while_the_link_is_down_is_reported_and_counted_once(void **state)
{
    (void)state;
    fake.write_error = ENETDOWN;
    fake.write_errors = 2;
    assert_int_equal(bus->send(bus, &hello), BUS_DOWN);
    assert_int_equal(bus->send(bus, &hello), BUS_DOWN);
    assert_non_null(strstr(bus->text, "'can0' is down"));
    assert_int_equal(bus->statistics.link_downs, 1);
    assert_int_equal(bus->statistics.send_failed, 2);
    assert_int_equal(bus->send(bus, &hello), BUS_OK);
    assert_int_equal(bus->statistics.link_ups, 1);
}

static void test_the_same_socket_works_after_link_down(void **state)
{
    (void)state;
    fake_arrives_error(ENETDOWN);
    fake.interface_flags = 0;
    assert_int_equal(receive(), BUS_DOWN);
    assert_int_equal(receive(), BUS_DOWN);
    assert_int_equal(bus->statistics.link_downs, 1);
    assert_false(bus->statistics.link_up);
    fake.interface_flags = IFF_UP;
    fake_arrives(0x123, 5);
    assert_int_equal(receive(), 1);
    assert_int_equal(frames[0].data[0], 5);
    assert_int_equal(bus->statistics.link_ups, 1);
    assert_true(bus->statistics.link_up);
    assert_int_equal(fake.binds, 1);
}

static void test_queued_frames_do_not_count_as_link_up(void **state)
{
    (void)state;
    fake_arrives_error(ENETDOWN);
    fake_arrives(0x123, 5);
    fake.interface_flags = 0;
    assert_int_equal(receive(), BUS_DOWN);
    assert_int_equal(receive(), 1);
    assert_false(bus->statistics.link_up);
    assert_int_equal(receive(), BUS_DOWN);
}

static void test_an_interface_that_was_unplugged_is_bound_again(void **state)
{
    (void)state;
    fake_arrives_error(ENETDOWN);
    fake_arrives_error(ENODEV);
    fake.index_error = ENODEV;
    assert_int_equal(receive(), BUS_DOWN);
    assert_int_equal(receive(), BUS_DOWN);
    assert_non_null(strstr(bus->text, "is gone"));
    assert_int_equal(receive(), BUS_DOWN);
    assert_int_equal(fake.binds, 1);
    fake.index_error = 0;
    fake.filter_count = 0; /* the kernel removes them with the interface */
    assert_int_equal(receive(), 0);
    assert_int_equal(fake.binds, 2);
    assert_int_equal(fake.filter_count, 1);
    assert_int_equal(bus->statistics.link_downs, 1);
    assert_int_equal(bus->statistics.link_ups, 1);
}

static void test_receive_reports_an_unexpected_error(void **state)
{
    (void)state;
    fake_arrives_error(EIO);
    assert_int_equal(receive(), BUS_BROKEN);
    assert_non_null(strstr(bus->text, "Input/output error"));
}

static void test_an_error_behind_frames_is_reported_by_the_next_call(void **state)
{
    uint32_t i;

    (void)state;
    for (i = 0; i < 32; i++) { /* a whole batch */
        fake_arrives(0x123, (uint8_t)i);
    }
    fake_arrives_error(EIO);
    assert_int_equal(receive(), 32);
    assert_int_equal(receive(), BUS_BROKEN);
    assert_non_null(strstr(bus->text, "Input/output error"));
}

static void test_an_interrupted_receive_is_repeated(void **state)
{
    (void)state;
    fake_arrives_error(EINTR);
    fake_arrives(0x123, 5);
    assert_int_equal(receive(), 1);
}

static void test_receive_returns_many_frames_in_batches_and_in_order(void **state)
{
    int i;

    (void)state;
    for (i = 0; i < 300; i++) {
        fake_arrives(0x100 + (unsigned)i, (uint8_t)i);
    }
    assert_int_equal(receive(), 300);
    assert_in_range(fake.receives, 1, 10);
    for (i = 0; i < 300; i++) {
        assert_int_equal(frames[i].id, 0x100 + i);
        assert_int_equal(frames[i].data[0], (uint8_t)i);
    }
    assert_int_equal(bus->statistics.received, 300);
}

static void test_receive_never_returns_more_than_requested(void **state)
{
    int i;

    (void)state;
    for (i = 0; i < 100; i++) {
        fake_arrives(0x123, (uint8_t)i);
    }
    assert_int_equal(bus->receive(bus, frames, 33), 33);
    assert_int_equal(bus->receive(bus, frames, 1), 1);
    assert_int_equal(frames[0].data[0], 33);
    assert_int_equal(receive(), 66);
    assert_int_equal(receive(), 0);
}

static void test_a_short_read_is_counted_and_discarded(void **state)
{
    (void)state;
    fake_arrives(0x123, 1);
    fake_arrives(0x123, 2)->length = 7;
    fake_arrives(0x123, 3)->frame.len = 9;
    fake_arrives(0x123, 4);
    assert_int_equal(receive(), 2);
    assert_int_equal(frames[0].data[0], 1);
    assert_int_equal(frames[1].data[0], 4);
    assert_int_equal(bus->statistics.malformed, 2);
}

static void test_ids_flags_and_unused_bytes_are_converted(void **state)
{
    (void)state;
    fake_arrives(0x1ABCDEF | CAN_EFF_FLAG, 1);
    memset(fake_arrives(0x7FF | CAN_RTR_FLAG, 1)->frame.data, 0xFF, 8);
    memset(fake_arrives(0x001, 1)->frame.data, 0xFF, 8);
    fake.incoming[2].frame.len = 2;
    assert_int_equal(receive(), 3);
    assert_int_equal(frames[0].id, 0x1ABCDEF);
    assert_int_equal(frames[0].flags, BUS_FRAME_EXTENDED);
    assert_int_equal(frames[1].id, 0x7FF);
    assert_int_equal(frames[1].flags, BUS_FRAME_RTR);
    assert_memory_equal(frames[1].data, "\0\0\0\0\0\0\0\0", 8);
    assert_memory_equal(frames[2].data, "\xFF\xFF\0\0\0\0\0\0", 8);
}

static void test_error_frames_report_passive_off_and_restarted(void **state)
{
    (void)state;
    fake_arrives(CAN_ERR_FLAG | CAN_ERR_CRTL, 0)->frame.data[1] = CAN_ERR_CRTL_RX_WARNING;
    assert_int_equal(receive(), 1);
    assert_int_equal(bus->statistics.state, BUS_WARNING);
    fake_arrives(CAN_ERR_FLAG | CAN_ERR_CRTL, 0)->frame.data[1] = CAN_ERR_CRTL_TX_PASSIVE;
    assert_int_equal(receive(), 1);
    assert_int_equal(bus->statistics.state, BUS_PASSIVE);
    fake_arrives(CAN_ERR_FLAG | CAN_ERR_BUSOFF, 0);
    assert_int_equal(receive(), 1);
    assert_int_equal(bus->statistics.state, BUS_OFF);
    assert_int_equal(frames[0].flags, BUS_FRAME_ERROR);
    fake_arrives(CAN_ERR_FLAG | CAN_ERR_RESTARTED, 0);
    assert_int_equal(receive(), 1);
    assert_int_equal(bus->statistics.state, BUS_ACTIVE);
    fake_arrives(CAN_ERR_FLAG | CAN_ERR_CRTL, 0)->frame.data[1] = CAN_ERR_CRTL_RX_PASSIVE;
    fake_arrives(CAN_ERR_FLAG | CAN_ERR_CRTL, 0)->frame.data[1] = CAN_ERR_CRTL_ACTIVE;
    assert_int_equal(receive(), 2);
    assert_int_equal(bus->statistics.state, BUS_ACTIVE);
    assert_int_equal(bus->statistics.bus_offs, 1);
    assert_int_equal(bus->statistics.passives, 2);
    assert_int_equal(bus->statistics.restarts, 1);
    assert_int_equal(bus->statistics.error_frames, 6);
    assert_int_equal(bus->statistics.received, 6);
}

static void test_drops_are_counted_across_a_wrap_of_the_kernel_counter(void **state)
{
    (void)state;
    fake_arrives(0x123, 1);
    fake_arrives(0x123, 2)->overrun = 10;
    fake_arrives(0x123, 3)->overrun = 10;
    fake_arrives(0x123, 4)->overrun = 0xFFFFFFFE;
    assert_int_equal(receive(), 4);
    assert_int_equal(bus->statistics.dropped, 0xFFFFFFFE);
    fake_arrives(0x123, 5)->overrun = 3;
    assert_int_equal(receive(), 1);
    assert_true(bus->statistics.dropped == 0xFFFFFFFEU + UINT64_C(5));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_open_reports_a_kernel_without_can, fresh),
        cmocka_unit_test_setup(test_open_reports_a_missing_permission, fresh),
        cmocka_unit_test_setup(test_open_reports_a_missing_interface, fresh),
        cmocka_unit_test_setup(test_open_reports_an_interface_that_is_not_can, fresh),
        cmocka_unit_test_setup(test_open_reports_an_unexpected_error, fresh),
        cmocka_unit_test_setup(test_open_refuses_invalid_names_and_filters, fresh),
        OPENED(test_open_requests_timestamps_drops_errors_and_a_large_buffer),
        cmocka_unit_test_setup(test_open_accepts_a_smaller_buffer_without_privilege, fresh),
        cmocka_unit_test_setup(test_a_filter_distinguishes_short_ids_long_ids_and_remote_requests,
                               fresh),
        cmocka_unit_test_setup(test_an_interface_that_is_down_can_be_opened, fresh),
        OPENED(test_send_writes_the_format_of_the_kernel),
        OPENED(test_send_refuses_an_invalid_frame_without_a_system_call),
        OPENED(test_a_full_send_queue_is_counted_and_is_temporary),
        OPENED(test_an_interrupted_send_is_repeated),
        OPENED(test_a_frame_that_the_kernel_truncates_is_an_error),
        OPENED(test_sending_while_the_link_is_down_is_reported_and_counted_once),
        OPENED(test_the_same_socket_works_after_link_down),
        OPENED(test_queued_frames_do_not_count_as_link_up),
        OPENED(test_an_interface_that_was_unplugged_is_bound_again),
        OPENED(test_receive_reports_an_unexpected_error),
        OPENED(test_an_error_behind_frames_is_reported_by_the_next_call),
        OPENED(test_an_interrupted_receive_is_repeated),
        OPENED(test_receive_returns_many_frames_in_batches_and_in_order),
        OPENED(test_receive_never_returns_more_than_requested),
        OPENED(test_a_short_read_is_counted_and_discarded),
        OPENED(test_ids_flags_and_unused_bytes_are_converted),
        OPENED(test_error_frames_report_passive_off_and_restarted),
        OPENED(test_drops_are_counted_across_a_wrap_of_the_kernel_counter),
    };

    cmocka_set_message_output(CM_OUTPUT_TAP);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
