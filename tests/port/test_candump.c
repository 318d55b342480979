/* Writing and reading logs of candump -L. */
#include "fake_system.h"

#include <fcntl.h>
#include <linux/can/error.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "bus_candump.h"

enum { MANY = 5000 };

static char path[] = "/tmp/test_candump.XXXXXX";
static bus_candump_t candump;
static bus_t *const bus = &candump.bus;
static bus_frame_t frames[8];

static int make_file(void **state)
{
    int fd;

    (void)state;
    memset(&fake, 0, sizeof fake);
    fd = mkstemp(path);
    return fd < 0 ? -1 : close(fd);
}

static int remove_file(void **state)
{
    (void)state;
    (void)unlink(path);
    memcpy(path + strlen(path) - 6, "XXXXXX", 6);
    return 0;
}

static void put(const char *text)
{
    FILE *file = fopen(path, "w");

    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

/* Reads a log with `text`: expects this number of frames, and then `status`. */
static void check_reading(const char *text, int count, int status)
{
    put(text);
    assert_int_equal(bus_candump_open(&candump, path, NULL), BUS_OK);
    if (count > 0) {
        assert_int_equal(bus->receive(bus, frames, 8), count);
    }
    assert_int_equal(bus->receive(bus, frames + count, 1), status);
    assert_int_equal(bus->receive(bus, frames + count, 1), status);
    assert_int_equal(bus->close(bus), BUS_OK);
}

static bus_frame_t random_frame(uint64_t *t_us)
{
    bus_frame_t frame;
    int i;

    memset(&frame, 0, sizeof frame);
    *t_us += (uint64_t)(rand() % 3000000);
    frame.t_us = *t_us;
    frame.flags = (uint8_t)(rand() % 3 == 0 ? BUS_FRAME_EXTENDED : 0);
    if (rand() % 10 == 0) {
        frame.flags = BUS_FRAME_ERROR;
    } else if (rand() % 5 == 0) {
        frame.flags |= BUS_FRAME_RTR;
    }
    frame.id = (uint32_t)rand() &
               (frame.flags & (BUS_FRAME_EXTENDED | BUS_FRAME_ERROR) ? CAN_EFF_MASK : CAN_SFF_MASK);
    frame.length = (uint8_t)(rand() % 9);
    for (i = 0; i < frame.length && !(frame.flags & BUS_FRAME_RTR); i++) {
        frame.data[i] = (uint8_t)rand();
    }
    return frame;
}

static void test_written_frames_are_read_back(void **state)
{
    static bus_frame_t written[MANY], read[MANY + 1];
    uint64_t t_us = 0;
    int i;

    (void)state;
    srand(4);
    assert_int_equal(bus_candump_create(&candump, path, "vcan0", 1700000000000000), BUS_OK);
    for (i = 0; i < MANY; i++) {
        written[i] = random_frame(&t_us);
        assert_int_equal(bus->send(bus, &written[i]), BUS_OK);
    }
    assert_int_equal(bus->now_us(bus), t_us);
    assert_int_equal(bus->close(bus), BUS_OK);
    assert_int_equal(bus_candump_open(&candump, path, "vcan0"), BUS_OK);
    assert_int_equal(bus->receive(bus, read, MANY + 1), MANY);
    for (i = 0; i < MANY; i++) {
        read[i].t_us -= 1700000000000000;
    }
    assert_memory_equal(written, read, sizeof written);
    assert_int_equal(bus->receive(bus, read, 1), BUS_END);
    assert_int_equal(bus->statistics.received, MANY);
    assert_int_equal(bus->close(bus), BUS_OK);
}

static void test_a_line_has_the_format_of_candump(void **state)
{
    const bus_frame_t frame = {
        .t_us = 1249713, .id = 0x44, .length = 3, .data = {0x2A, 0x36, 0x0C}};
    const bus_frame_t wide = {.t_us = 2000000, .id = 0x1ABC, .flags = BUS_FRAME_EXTENDED};
    char text[200] = "";
    FILE *file;

    (void)state;
    assert_int_equal(bus_candump_create(&candump, path, "can0", 1436509052000000), BUS_OK);
    assert_int_equal(bus->send(bus, &frame), BUS_OK);
    assert_int_equal(bus->send(bus, &wide), BUS_OK);
    file = fopen(path, "r"); /* before close: each line is written at once */
    assert_non_null(file);
    assert_true(fread(text, 1, sizeof text - 1, file) > 0);
    assert_string_equal(text, "(1436509053.249713) can0 044#2A360C\n"
                              "(1436509054.000000) can0 00001ABC#\n");
    (void)fclose(file);
    assert_int_equal(bus->close(bus), BUS_OK);
    assert_int_equal(bus_candump_create(&candump, path, "can0", 0), BUS_OK);
    assert_int_equal(bus->send(bus, &wide), BUS_OK);
    assert_int_equal(bus->close(bus), BUS_OK);
    file = fopen(path, "r");
    assert_non_null(file);
    assert_non_null(fgets(text, sizeof text, file));
    assert_string_equal(text, "(0000000002.000000) can0 00001ABC#\n");
    (void)fclose(file);
}

/* A program that waited for the reader could not stop its thrusters. */
static void test_a_log_into_a_pipe_never_waits_for_its_reader(void **state)
{
    const bus_frame_t frame = {.id = 0x123, .length = 8};
    int reader, i, status = BUS_OK;

    (void)state;
    assert_int_equal(remove(path), 0);
    assert_int_equal(mkfifo(path, 0600), 0);
    assert_int_equal(bus_candump_create(&candump, path, "can0", 0), BUS_BROKEN); /* there is none */
    reader = open(path, O_RDONLY | O_NONBLOCK);
    assert_true(reader >= 0);
    assert_int_equal(bus_candump_create(&candump, path, "can0", 0), BUS_OK);
    for (i = 0; i < 100000 && status == BUS_OK; i++) {
        status = bus->send(bus, &frame);
    }
    assert_int_equal(status, BUS_BROKEN); /* full */
    (void)bus->close(bus);
    (void)close(reader);
}

static void test_lines_of_other_versions_are_read(void **state)
{
    (void)state;
    check_reading("(0000000001.000002) can0 123#0011223344556677\r\n"
                  "(1.000003) vcan12 1ABCDEF0#ab R\n"
                  "(2.000000) can0 123#R\n"
                  "(2.000000) can0 123#R8 T\n"
                  "(3.000000) can0 20000040#0004000000000000\n",
                  5, BUS_END);
    assert_int_equal(frames[0].t_us, 1000002);
    assert_int_equal(frames[0].data[7], 0x77);
    assert_int_equal(frames[1].id, 0x1ABCDEF0);
    assert_int_equal(frames[1].data[0], 0xAB);
    assert_int_equal(frames[2].flags, BUS_FRAME_RTR);
    assert_int_equal(frames[3].length, 8);
    assert_int_equal(frames[4].flags, BUS_FRAME_ERROR);
    assert_int_equal(frames[4].id, CAN_ERR_BUSOFF);
    assert_int_equal(bus->statistics.bus_offs, 1);
    assert_int_equal(bus->now_us(bus), 3000000);
}

static void test_invalid_lines_are_refused_with_their_number(void **state)
{
    static const char *const bad[] = {
        "",                                       /* nothing */
        "time,id,data",                           /* a CSV header */
        "  can0  123   [2]  11 22",               /* candump without -L */
        " (1.000000)  can0  123   [2]  11 22",    /* candump -ta */
        "(1.000000) can0 123##",                  /* CAN FD without its flags */
        "(1.000000) can0 123##1112",              /* CAN FD, half a byte */
        "(1.000000) can0 8FF##1",                 /* CAN FD, 12 bits */
        "(1.000000) can0 123##1R",                /* CAN FD has no remote request */
        "(1.000000) can0 123#112",                /* half a byte */
        "(1.000000) can0 123#001122334455667788", /* nine bytes */
        "(1.000000) can0 123#1122_9",             /* length code 9 */
        "(1.000000) can0 123#R9",                 /* invalid length */
        "(1.000000) can0 123#11 X",               /* neither R nor T */
        "(1.000000) can0 123#GG",                 /* no digits */
        "(1.000000) can0 8FF#11",                 /* 12 bits */
        "(1.000000) can0 FFFFFFFF#11",            /* more than 29 bits */
        "(1.000000) can0 1234#11",                /* four digits */
        "(1.000000) can0 12345678",               /* no data */
        "(1.00000) can0 123#11",                  /* five decimals */
        "(1.000000)can0 123#11",                  /* no space */
        "(1.000000) ",                            /* nothing after the time */
        "(1.000000) a_name_of_16_____ 123#11",    /* a name Linux cannot have */
        "(-1.000000) can0 123#11",                /* a negative time */
        "\x7F\x45LF\x01\x02",                     /* not text */
    };
    char text[400];
    size_t i;

    (void)state;
    for (i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        (void)snprintf(text, sizeof text, "(1.000000) can0 123#11\n%s\n(2.000000) can0 123#11\n",
                       bad[i]);
        check_reading(text, 1, BUS_BROKEN);
        (void)snprintf(text, sizeof text, "%s:2: ", path);
        assert_memory_equal(bus->text, text, strlen(text));
        assert_null(strchr(bus->text, '\n'));
    }
}

/* A log truncated at any byte gives its complete lines and then reports the truncation. */
static void test_a_truncated_log_is_read_up_to_its_last_complete_line(void **state)
{
    static const char whole[] = "(1.000000) can0 123#1122334455667788\n";
    char text[2 * sizeof whole] = "";
    size_t length;

    (void)state;
    for (length = sizeof whole; length < 2 * (sizeof whole - 1); length++) {
        (void)snprintf(text, sizeof text, "%s%s", whole, whole);
        text[length] = '\0';
        check_reading(text, 1, BUS_END);
        assert_non_null(strstr(bus->text, ":2: the last line is truncated"));
        assert_int_equal(bus->statistics.received, 1);
    }
    (void)snprintf(text, sizeof text, "%s%s", whole, whole);
    check_reading(text, 2, BUS_END);
    assert_string_equal(bus->text, "");
}

/* Other nodes may send CAN FD, extended and remote frames. */
static void test_can_fd_frames_are_skipped_and_counted(void **state)
{
    char text[400], longest[129];

    (void)state;
    memset(longest, 'A', sizeof longest - 1);
    longest[sizeof longest - 1] = '\0';
    (void)snprintf(text, sizeof text,
                   "(1.000000) can0 123#11\n(1.000000) can0 123##1\n"
                   "(1.000000) can0 1ABCDEF0##5112233 R\n(0000000001.000000) can0 123##1%s\r\n"
                   "(2.000000) can0 123#22\n",
                   longest);
    check_reading(text, 2, BUS_END);
    assert_int_equal(frames[1].t_us, 2000000);
    assert_int_equal(bus->statistics.received, 2);
    assert_int_equal(bus->statistics.malformed, 0);
    assert_int_equal(candump.fd_frames, 3);
    (void)snprintf(text, sizeof text, "(1.000000) can0 123##1%sAA\n", longest);
    check_reading(text, 0, BUS_BROKEN); /* 65 bytes */
}

static void test_a_long_line_is_refused(void **state)
{
    char text[1000];

    (void)state;
    memset(text, '1', sizeof text);
    text[sizeof text - 1] = '\0';
    check_reading(text, 0, BUS_BROKEN);
}

static void test_an_empty_log_is_refused(void **state)
{
    (void)state;
    check_reading("", 0, BUS_BROKEN);
    assert_non_null(strstr(bus->text, "is empty"));
}

static void test_a_missing_log_is_refused(void **state)
{
    (void)state;
    assert_int_equal(bus_candump_open(&candump, "/nonexistent.log", NULL), BUS_BROKEN);
    assert_non_null(strstr(bus->text, "/nonexistent.log: No such file"));
    assert_int_equal(bus->close(bus), BUS_OK);
    assert_int_equal(bus_candump_create(&candump, "/nonexistent/x.log", "can0", 0), BUS_BROKEN);
    assert_int_equal(bus_candump_open(&candump, "/tmp", NULL), BUS_OK);
    assert_int_equal(bus->receive(bus, frames, 1), BUS_BROKEN);
    assert_non_null(strstr(bus->text, "Is a directory"));
    assert_int_equal(bus->close(bus), BUS_OK);
}

static void test_only_the_requested_interface_is_read(void **state)
{
    (void)state;
    put("(1.000000) can0 001#\n(1.000000) can1 002#\n(1.000000) can0 003#\n(1.000000) can 004#\n");
    assert_int_equal(bus_candump_open(&candump, path, "can0"), BUS_OK);
    assert_int_equal(bus->receive(bus, frames, 8), 2);
    assert_int_equal(frames[0].id, 1);
    assert_int_equal(frames[1].id, 3);
    assert_int_equal(bus->close(bus), BUS_OK);
}

static void test_invalid_interface_names_are_refused(void **state)
{
    (void)state;
    assert_int_equal(bus_candump_create(&candump, path, "a b", 0), BUS_REFUSED);
    assert_int_equal(bus_candump_create(&candump, path, "", 0), BUS_REFUSED);
    assert_int_equal(bus_candump_create(&candump, path, NULL, 0), BUS_REFUSED);
    assert_int_equal(bus_candump_create(&candump, path, "sixteen_letters_", 0), BUS_REFUSED);
}

static void test_a_full_disk_is_reported(void **state)
{
    const bus_frame_t frame = {.id = 1};

    (void)state;
    assert_int_equal(bus_candump_create(&candump, "/dev/full", "can0", 0), BUS_OK);
    assert_int_equal(bus->send(bus, &frame), BUS_BROKEN);
    assert_non_null(strstr(bus->text, "No space left"));
    assert_int_equal(bus->statistics.send_failed, 1);
    (void)bus->close(bus);
}

static void test_a_log_is_either_read_or_written_and_holds_only_frames(void **state)
{
    bus_frame_t frame = {.id = 1, .length = 9};

    (void)state;
    assert_int_equal(bus_candump_create(&candump, path, "can0", 0), BUS_OK);
    assert_int_equal(bus->receive(bus, frames, 1), BUS_REFUSED);
    assert_int_equal(bus->send(bus, &frame), BUS_REFUSED);
    assert_int_equal(bus->close(bus), BUS_OK);
    assert_int_equal(bus_candump_open(&candump, path, NULL), BUS_OK);
    frame.length = 8;
    assert_int_equal(bus->send(bus, &frame), BUS_REFUSED);
    assert_int_equal(bus->close(bus), BUS_OK);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, make_file, remove_file)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(test_written_frames_are_read_back),
        TEST(test_a_line_has_the_format_of_candump),
        TEST(test_a_log_into_a_pipe_never_waits_for_its_reader),
        TEST(test_lines_of_other_versions_are_read),
        TEST(test_invalid_lines_are_refused_with_their_number),
        TEST(test_a_truncated_log_is_read_up_to_its_last_complete_line),
        TEST(test_can_fd_frames_are_skipped_and_counted),
        TEST(test_a_long_line_is_refused),
        TEST(test_an_empty_log_is_refused),
        TEST(test_a_missing_log_is_refused),
        TEST(test_only_the_requested_interface_is_read),
        TEST(test_invalid_interface_names_are_refused),
        TEST(test_a_full_disk_is_reported),
        TEST(test_a_log_is_either_read_or_written_and_holds_only_frames),
    };

    cmocka_set_message_output(CM_OUTPUT_TAP);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
