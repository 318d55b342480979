/*
 * One end of a real bus, for tests/vcan. It sends numbered frames, or receives them and prints
 * statistics as key=value words.
 *
 *   peer send INTERFACE COUNT GAP_US      COUNT frames with id 321 and numbers 0..COUNT-1
 *   peer busoff INTERFACE                 a bus-off and a restarted error frame
 *   peer flood INTERFACE COUNT GAP_US     COUNT random frames with the ids of a node's frames
 *   peer floodall INTERFACE COUNT GAP_US  the same with all ids of auvid
 *   peer receive INTERFACE [LOG]          receives until SIGTERM; prints "ready" when open
 *   peer read LOG                         the same of a log
 */
#define _GNU_SOURCE
#include <errno.h>
#include <linux/can/error.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "bus_candump.h"
#include "bus_socketcan.h"
#include "tick.h"

enum { BATCH = 64, NUMBERS = 1 << 20, NUMBERED = 0x321 };

static uint8_t seen[NUMBERS];
static struct {
    unsigned numbered, different, again, late; /* numbered frames; numbers; repeated; overtaken */
    uint32_t last;
    uint64_t last_us, oldest_us; /* maximum age at reception */
    bool ordered;                /* timestamps never ran backwards, nor into the future */
    uint64_t checksum;           /* over ids and data of all frames, in order */
} sum = {.ordered = true};

static void wait_us(uint64_t us)
{
    const struct timespec t = {(time_t)(us / 1000000), (long)(us % 1000000) * 1000};

    (void)nanosleep(&t, NULL);
}

static void add(const bus_frame_t *frame, uint64_t now_us)
{
    uint32_t number;
    int i;

    sum.checksum = (sum.checksum ^ frame->id) * 1099511628211U;
    for (i = 0; i < frame->length; i++) {
        sum.checksum = (sum.checksum ^ frame->data[i]) * 1099511628211U;
    }
    sum.ordered = sum.ordered && frame->t_us >= sum.last_us && frame->t_us <= now_us;
    sum.last_us = frame->t_us;
    if (now_us - frame->t_us > sum.oldest_us) {
        sum.oldest_us = now_us - frame->t_us;
    }
    if (frame->id != NUMBERED || frame->flags != 0 || frame->length != 8) {
        return;
    }
    memcpy(&number, frame->data, sizeof number);
    sum.numbered++;
    sum.late += number < sum.last;
    sum.last = number;
    if (number < NUMBERS) {
        sum.again += seen[number];
        sum.different += !seen[number];
        seen[number] = 1;
    }
}

static void print_statistics(const bus_t *bus)
{
    const bus_statistics_t *s = &bus->statistics;

    printf("received=%llu numbered=%u different=%u again=%u late=%u dropped=%llu malformed=%llu "
           "ordered=%d oldest_us=%llu link_downs=%llu link_ups=%llu bus_offs=%llu restarts=%llu "
           "clock_steps=%llu checksum=%llx\n",
           (unsigned long long)s->received, sum.numbered, sum.different, sum.again, sum.late,
           (unsigned long long)s->dropped, (unsigned long long)s->malformed, sum.ordered,
           (unsigned long long)sum.oldest_us, (unsigned long long)s->link_downs,
           (unsigned long long)s->link_ups, (unsigned long long)s->bus_offs,
           (unsigned long long)s->restarts, (unsigned long long)s->clock_steps,
           (unsigned long long)sum.checksum);
}

static int report_error(const bus_t *bus)
{
    fprintf(stderr, "peer: %s\n", bus->text);
    return 2;
}

/* Receives all queued frames. Returns 0, or the status at the end. */
static int drain(bus_t *bus, bus_t *log)
{
    bus_frame_t frames[BATCH];
    int i, count;

    do {
        count = bus->receive(bus, frames, BATCH);
        for (i = 0; i < count; i++) {
            add(&frames[i], bus->now_us(bus));
            if (log != NULL && log->send(log, &frames[i]) != BUS_OK) {
                return report_error(log);
            }
        }
    } while (count == BATCH);
    return count == BUS_END || count == BUS_BROKEN ? count : 0;
}

static int receive(const char *interface, const char *path)
{
    static bus_socketcan_t can;
    static bus_candump_t log;
    tick_t tick;
    int happened;

    if (bus_socketcan_open(&can, interface, NULL, 0) != BUS_OK) {
        return report_error(&can.bus);
    }
    if (path != NULL && bus_candump_create(&log, path, interface, 0) != BUS_OK) {
        return report_error(&log.bus);
    }
    if (tick_open(&tick, 10000) != 0 || tick_watch(&tick, can.bus.fd) != 0) {
        return 2;
    }
    puts("ready");
    (void)fflush(stdout);
    do {
        happened = tick_wait(&tick, -1);
        if (drain(&can.bus, path != NULL ? &log.bus : NULL) != 0) {
            return report_error(&can.bus);
        }
    } while (!(happened & TICK_STOP));
    printf("buffer=%d ", can.receive_buffer);
    print_statistics(&can.bus);
    tick_close(&tick);
    return path == NULL || log.bus.close(&log.bus) == BUS_OK ? 0 : report_error(&log.bus);
}

static int read_log(const char *path)
{
    static bus_candump_t log;
    int status;

    if (bus_candump_open(&log, path, NULL) != BUS_OK) {
        return report_error(&log.bus);
    }
    do {
        status = drain(&log.bus, NULL);
    } while (status == 0);
    print_statistics(&log.bus);
    return status == BUS_END ? 0 : report_error(&log.bus);
}

static int send_numbers(const char *interface, uint32_t count, unsigned gap_us)
{
    static bus_socketcan_t can;
    bus_frame_t frame = {.id = NUMBERED, .length = 8};
    uint32_t i;
    int status;

    if (bus_socketcan_open(&can, interface, NULL, 0) != BUS_OK) {
        return report_error(&can.bus);
    }
    for (i = 0; i < count; i++) {
        memcpy(frame.data, &i, sizeof i);
        while ((status = can.bus.send(&can.bus, &frame)) == BUS_BUSY) {
            wait_us(1000);
        }
        if (status != BUS_OK) {
            return report_error(&can.bus);
        }
        if (gap_us > 0) {
            wait_us(gap_us);
        }
    }
    printf("sent=%llu busy=%llu\n", (unsigned long long)can.bus.statistics.sent,
           (unsigned long long)can.bus.statistics.send_busy);
    return 0;
}

static int send_errors(const char *interface)
{
    static bus_socketcan_t can;
    bus_frame_t off = {.id = CAN_ERR_BUSOFF, .length = 8, .flags = BUS_FRAME_ERROR};
    bus_frame_t back = {.id = CAN_ERR_RESTARTED, .length = 8, .flags = BUS_FRAME_ERROR};

    if (bus_socketcan_open(&can, interface, NULL, 0) != BUS_OK ||
        can.bus.send(&can.bus, &off) != BUS_OK || can.bus.send(&can.bus, &back) != BUS_OK) {
        return report_error(&can.bus);
    }
    return 0;
}

/* xorshift64* (Vigna 2016), seeded by a constant: the same frames each time. */
static uint64_t next(uint64_t *x)
{
    *x ^= *x << 13;
    *x ^= *x >> 7;
    *x ^= *x << 17;
    return *x * 2685821657736338717U;
}

static int flood(const char *interface, uint32_t count, unsigned gap_us, bool all)
{
    static bus_socketcan_t can;
    static unsigned sent[0x800];
    uint64_t x = 88172645463325252U;

    if (bus_socketcan_open(&can, interface, NULL, 0) != BUS_OK) {
        return report_error(&can.bus);
    }
    while (count > 0) {
        const uint32_t r = (uint32_t)(next(&x) >> 32) % 23;
        const uint64_t data = next(&x);
        bus_frame_t frame = {.id = r < 6 ? 0x040 + r : 0x400 + r - 6, .length = 8};

        memcpy(frame.data, &data, sizeof data);
        if (!all && (frame.id == 0x040 || frame.id == 0x041 || frame.id == 0x044 ||
                     (frame.id >= 0x400 && frame.id < 0x409))) {
            continue;
        }
        if (can.bus.send(&can.bus, &frame) == BUS_BROKEN) {
            return report_error(&can.bus);
        }
        sent[frame.id]++;
        count--;
        wait_us(gap_us);
    }
    printf("sent=%llu busy=%llu commands=%u\n", (unsigned long long)can.bus.statistics.sent,
           (unsigned long long)can.bus.statistics.send_busy, sent[0x042]);
    return 0;
}

int main(int count, char **words)
{
    const char *command = count > 2 ? words[1] : "";

    if (strcmp(command, "send") == 0 && count == 5) {
        return send_numbers(words[2], (uint32_t)atoi(words[3]), (unsigned)atoi(words[4]));
    }
    if ((strcmp(command, "flood") == 0 || strcmp(command, "floodall") == 0) && count == 5) {
        return flood(words[2], (uint32_t)atoi(words[3]), (unsigned)atoi(words[4]),
                     command[5] != '\0');
    }
    if (strcmp(command, "busoff") == 0) {
        return send_errors(words[2]);
    }
    if (strcmp(command, "receive") == 0) {
        return receive(words[2], count > 3 ? words[3] : NULL);
    }
    if (strcmp(command, "read") == 0) {
        return read_log(words[2]);
    }
    fputs("usage: peer send|flood|floodall|busoff|receive|read ...\n", stderr);
    return 2;
}
