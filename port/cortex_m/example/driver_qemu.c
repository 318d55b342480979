/*
 * The driver for QEMU: a recorded log replaces the bus. Replace this file on a board.
 *
 * A timer interrupt reads bus.log through semihosting, in the format of `candump -L` or `auvid node
 * --log`. It may interrupt the control loop at any instruction. It pushes the frames of a tick when
 * the queue has room, so no frame is lost on a slow core, and the loop runs at full speed. The
 * frames that the loop sends are written to sent.log in the same format. They must not depend on
 * the core's speed. So the clock advances only while the loop sleeps, by a millisecond each time:
 * in pauses of the log and before it starts.
 */
#include "auvid/node.h"
#include "driver.h"
#include "machine.h"

#include <string.h>

/* Maximum number of frames of one tick. */
#define TICK_FRAMES 16u

/* Delay of the controller's start after that of this board [us]. Minimum pause in the log to wait
 * for [us]; the interrupt skips shorter ones. */
#define START_US 300000u
#define PAUSE_US 100000

/* The run fails after this number of interrupts without a fed watchdog: some seconds. */
#define WATCHDOG 20000u

typedef struct {
    int file;
    size_t position, bytes;
    char buffer[32];
} text_t;

static text_t log_in, log_out;
static auvid_can_fifo_t *queue;
static volatile bool at_end; /* at the end of the log */
static volatile uint32_t clock_us;
static auvid_can_frame_t next_frame; /* the next frame of the log, due at due_us */
static uint32_t due_us;
static volatile uint32_t since_fed;

/* ---- bus.log ---- */

static int read_char(void)
{
    if (log_in.position == log_in.bytes) {
        log_in.position = 0;
        log_in.bytes = machine_read(log_in.file, log_in.buffer, sizeof log_in.buffer);
    }
    return log_in.position < log_in.bytes ? (unsigned char)log_in.buffer[log_in.position++] : -1;
}

static int digit(int c)
{
    return c >= '0' && c <= '9' ? c - '0' : (c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1);
}

/* "(1795246679.020000) can0 400#0790FFDBFFEE3F00". The time wraps; only pauses use it. */
static bool read_frame(auvid_can_frame_t *frame)
{
    int c = read_char(), nibbles = 0;
    uint32_t t_us = 0;
    memset(frame, 0, sizeof *frame);
    for (int blanks = 0; c >= 0 && blanks < 2; c = read_char()) {
        blanks += c == ' ';
        t_us = blanks == 0 && digit(c) >= 0 ? 10u * t_us + (uint32_t)digit(c) : t_us;
    }
    frame->t_us = t_us;
    for (; digit(c) >= 0; c = read_char()) {
        frame->id = (uint16_t)(frame->id * 16 + digit(c));
    }
    while (c == '#' || digit(c) >= 0) {
        c = read_char();
        if (digit(c) >= 0 && nibbles < 2 * AUVID_CAN_BYTES) {
            uint8_t *byte = &frame->data[nibbles++ / 2];
            *byte = (uint8_t)(*byte * 16 + digit(c));
        }
    }
    while (c >= 0 && c != '\n') {
        c = read_char();
    }
    frame->length = (uint8_t)(nibbles / 2);
    return c >= 0;
}

/* Pushes the frames of the next tick. */
static void interrupt(void)
{
    if (++since_fed > WATCHDOG) {
        driver_fault("watchdog");
    }
    if (queue->size - (queue->pushed - queue->popped) < TICK_FRAMES) {
        return;
    }
    while (!at_end && clock_us >= due_us) {
        auvid_can_kind_t kind = auvid_can_kind(NULL, next_frame.id);
        if (auvid_can_node_kind(kind) != AUVID_CAN_NODE_KINDS) {
            (void)auvid_can_fifo_push(queue, &next_frame);
        }
        uint32_t before_us = (uint32_t)next_frame.t_us;
        at_end = !read_frame(&next_frame);
        uint32_t pause_us = (uint32_t)next_frame.t_us - before_us;
        due_us = (int32_t)pause_us > PAUSE_US ? clock_us + pause_us : 0;
        if (kind == AUVID_CAN_TICK) {
            return;
        }
    }
}

/* ---- sent.log ---- */

static void flush(void)
{
    if (log_out.position > 0 && !machine_write(log_out.file, log_out.buffer, log_out.position)) {
        driver_fault("sent.log cannot be written");
    }
    log_out.position = 0;
}

static void put(const char *text)
{
    for (; *text != '\0'; ++text) {
        if (log_out.position == sizeof log_out.buffer) {
            flush();
        }
        log_out.buffer[log_out.position++] = *text;
    }
}

static void put_hex(uint32_t value, int digits)
{
    char text[2] = {0};
    while (--digits >= 0) {
        text[0] = "0123456789ABCDEF"[value >> 4 * digits & 15u];
        put(text);
    }
}

void driver_send(const auvid_can_frame_t *frame)
{
    put("(0000000000.000000) can0 ");
    put_hex(frame->id, 3);
    put("#");
    for (int i = 0; i < frame->length; ++i) {
        put_hex(frame->data[i], 2);
    }
    put("\n");
}

/* ---- driver.h ---- */

void driver_start(auvid_can_fifo_t *received)
{
    queue = received;
    log_in.file = machine_open("bus.log", false);
    log_out.file = machine_open("sent.log", true);
    if (log_in.file < 0 || log_out.file < 0) {
        driver_fault("bus.log or sent.log cannot be opened");
    }
    at_end = !read_frame(&next_frame);
    due_us = START_US;
    machine_timer(interrupt);
}

uint32_t driver_now_us(void)
{
    return clock_us;
}

/* The loop is idle. `at_end` is read first: the last frames are pushed before it is set. */
void driver_sleep(void)
{
    bool ended = at_end;
    if (ended && queue->pushed == queue->popped) {
        flush();
        machine_print("frames lost: ");
        machine_print_number(queue->dropped);
        machine_print("; stack: ");
        machine_print_number(machine_stack_used());
        machine_print(" bytes\n");
        machine_exit(queue->dropped == 0 ? 0 : 1);
    }
    clock_us = clock_us + 1000u;
    machine_sleep();
}

void driver_feed_watchdog(void)
{
    since_fed = 0;
}

void driver_fault(const char *what)
{
    machine_print("fault: ");
    machine_print(what);
    machine_print("\n");
    machine_exit(1);
}
