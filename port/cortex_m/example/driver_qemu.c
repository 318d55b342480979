/*
 * The driver in QEMU: a recorded log takes the place of the bus. To be replaced.
 *
 * bus.log, as `candump -L` or `auvid node --log` writes it, is read through semihosting by a timer
 * interrupt, which comes at any moment of the control loop and puts a tick's frames into the queue
 * whenever there is room. So nothing is lost however slow the core is, and the loop works through
 * the log as fast as it can. What the loop sends is written to sent.log, in the same format. The
 * clock runs only while the loop sleeps, for what is sent must not depend on the core's speed: a
 * millisecond each time, through the log's pauses and the time before it begins.
 */
#include "auvid/node.h"
#include "driver.h"
#include "machine.h"

#include <string.h>

/* Room for the frames of one tick. */
#define TICK_FRAMES 16u

/* A controller that starts so much later than this board; a pause in the log that is waited for
 * [us]. Shorter ones pass at once. */
#define LATE_US 300000u
#define PAUSE_US 100000

/* Interrupts without a fed watchdog, after which the run has failed: some seconds. */
#define WATCHDOG 20000u

typedef struct {
    int file;
    size_t place, bytes;
    char buffer[64];
} text_t;

static text_t in, out;
static auvid_can_fifo_t *queue;
static volatile bool over; /* the log is */
static volatile uint32_t clock_us;
static auvid_can_frame_t coming; /* the next one of the log, when the clock is at due_us */
static uint32_t due_us;
static volatile uint32_t unfed;

/* ---- bus.log ---- */

static int next(void)
{
    if (in.place == in.bytes) {
        in.place = 0;
        in.bytes = machine_read(in.file, in.buffer, sizeof in.buffer);
    }
    return in.place < in.bytes ? (unsigned char)in.buffer[in.place++] : -1;
}

static int digit(int c)
{
    return c >= '0' && c <= '9' ? c - '0' : (c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1);
}

/* "(1795246679.020000) can0 400#0790FFDBFFEE3F00". The time wraps; only pauses are seen by it. */
static bool read_frame(auvid_can_frame_t *frame)
{
    int c = next(), nibbles = 0;
    uint32_t t_us = 0;
    memset(frame, 0, sizeof *frame);
    for (int blanks = 0; c >= 0 && blanks < 2; c = next()) {
        blanks += c == ' ';
        t_us = blanks == 0 && digit(c) >= 0 ? 10u * t_us + (uint32_t)digit(c) : t_us;
    }
    frame->t_us = t_us;
    for (; digit(c) >= 0; c = next()) {
        frame->id = (uint16_t)(frame->id * 16 + digit(c));
    }
    while (c == '#' || digit(c) >= 0) {
        c = next();
        if (digit(c) >= 0 && nibbles < 2 * AUVID_CAN_BYTES) {
            uint8_t *byte = &frame->data[nibbles++ / 2];
            *byte = (uint8_t)(*byte * 16 + digit(c));
        }
    }
    while (c >= 0 && c != '\n') {
        c = next();
    }
    frame->length = (uint8_t)(nibbles / 2);
    return c >= 0;
}

/* A tick's frames, from the next one of the log on. */
static void interrupt(void)
{
    if (++unfed > WATCHDOG) {
        driver_fault("watchdog");
    }
    if (queue->size - (queue->pushed - queue->popped) < TICK_FRAMES) {
        return;
    }
    while (!over && clock_us >= due_us) {
        auvid_can_kind_t kind = auvid_can_kind(NULL, coming.id);
        if (kind < AUVID_NODE_KINDS) {
            (void)auvid_can_fifo_push(queue, &coming);
        }
        uint32_t before_us = (uint32_t)coming.t_us;
        over = !read_frame(&coming);
        uint32_t pause_us = (uint32_t)coming.t_us - before_us;
        due_us = (int32_t)pause_us > PAUSE_US ? clock_us + pause_us : 0;
        if (kind == AUVID_CAN_TICK) {
            return;
        }
    }
}

/* ---- sent.log ---- */

static void flush(void)
{
    if (out.place > 0 && !machine_write(out.file, out.buffer, out.place)) {
        driver_fault("sent.log cannot be written");
    }
    out.place = 0;
}

static void put(const char *text)
{
    for (; *text != '\0'; ++text) {
        if (out.place == sizeof out.buffer) {
            flush();
        }
        out.buffer[out.place++] = *text;
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

/* ---- the rest ---- */

void driver_start(auvid_can_fifo_t *received)
{
    queue = received;
    in.file = machine_open("bus.log", false);
    out.file = machine_open("sent.log", true);
    if (in.file < 0 || out.file < 0) {
        driver_fault("bus.log or sent.log cannot be opened");
    }
    over = !read_frame(&coming);
    due_us = LATE_US;
    machine_timer(interrupt);
}

uint32_t driver_now_us(void)
{
    return clock_us;
}

/* The loop has nothing to do. The order of the two reads: frames come before the end does. */
void driver_sleep(void)
{
    bool ended = over;
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
    unfed = 0;
}

void driver_fault(const char *what)
{
    machine_print("fault: ");
    machine_print(what);
    machine_print("\n");
    machine_exit(1);
}
