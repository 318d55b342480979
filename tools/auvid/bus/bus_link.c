#include "bus_link.h"

#include <string.h>
#include <time.h>

#include "../base/report_error.h"
#include "frames.h"

/* SCHED_FIFO priority with --realtime. */
#define PRIORITY 50

void link_take(link_t *link, const char *command, bus_t *bus)
{
    memset(link, 0, sizeof *link);
    link->command = command;
    link->bus = bus;
}

int link_tick(link_t *link, const options_t *options)
{
    char text[2 * TICK_TEXT];
    if (options->realtime && tick_realtime(PRIORITY, text, sizeof text) != 0) {
        report_error_line("%s: %s", link->command, text);
    }
    link->ticking = tick_open(&link->tick, LINK_TICK_US / options->speed) == 0;
    if (!link->ticking || tick_watch(&link->tick, link->bus->fd) != 0) {
        report_error_line("%s: %s", link->command, link->tick.text);
        (void)link_close(link);
        return EXIT_REFUSED;
    }
    return 0;
}

int link_open(link_t *link, const char *command, const options_t *options)
{
    link_take(link, command, &link->socket.bus);
    if (bus_socketcan_open(&link->socket, options->bus, NULL, 0) != BUS_OK) {
        return report_error("%s: %s", command, link->socket.bus.text);
    }
    return link_tick(link, options);
}

int link_log(link_t *link, const char *path, const char *interface)
{
    uint64_t now = link->bus->now_us(link->bus), day = 1000000u * (uint64_t)time(NULL);
    if (bus_candump_create(&link->log, path, interface, day - now) != BUS_OK) {
        return report_error("%s: %s", link->command, link->log.bus.text);
    }
    if (!link->ticking) {
        bus_candump_wait(&link->log);
    }
    link->logging = true;
    return 0;
}

/* Logs a frame. Returns -1 on the first failure; after it nothing more is logged. */
static int log_frame(link_t *link, const bus_frame_t *frame)
{
    if (!link->logging || link->log_failed || link->log.bus.send(&link->log.bus, frame) == BUS_OK) {
        return 0;
    }
    link->log_failed = true;
    return -1;
}

static int report_log_error(const link_t *link)
{
    return report_error("%s: %s", link->command, link->log.bus.text);
}

/* Prints a line when the bus goes down or up. Returns EXIT_REFUSED if it is broken. */
static int check_status(link_t *link, int status)
{
    bool down = status == BUS_DOWN;
    if (down && !link->down) {
        report_error_line("%s: %s", link->command, link->bus->text);
    }
    if (!down && link->down) {
        report_error_line("%s: the interface is up again", link->command);
    }
    link->down = down;
    return status == BUS_BROKEN ? report_error("%s: %s", link->command, link->bus->text) : 0;
}

int link_send(link_t *link, const auvid_can_frame_t *frame, int count)
{
    uint64_t now_us = link->bus->now_us(link->bus);
    bool broken = false, unlogged = false;
    link->unsent = 0;
    for (int i = 0; i < count; ++i) { /* all of them despite failures: a command has two halves */
        bus_frame_t raw = frames_raw(&frame[i]);
        int status = link->bus->send(link->bus, &raw);
        link->unsent |= (uint32_t)(status != BUS_OK) << i;
        broken = status == BUS_BROKEN || broken;
    }
    for (int i = 0; i < count; ++i) { /* then the log, which takes time */
        bus_frame_t raw = frames_raw(&frame[i]);
        raw.t_us = now_us;
        bool sent = (link->unsent >> i & 1u) == 0;
        unlogged = (sent && log_frame(link, &raw) != 0) || unlogged;
    }
    if (broken) {
        return check_status(link, BUS_BROKEN);
    }
    return unlogged ? report_log_error(link) : 0;
}

int link_receive(link_t *link, auvid_can_frame_t *frame)
{
    bus_frame_t raw;
    int count = 0;
    while ((count = link->bus->receive(link->bus, &raw, 1)) > 0) {
        /* it may have been queued before the interface went down */
        (void)check_status(link, link->bus->statistics.link_up ? BUS_OK : BUS_DOWN);
        if (log_frame(link, &raw) != 0) {
            (void)report_log_error(link);
            return -1;
        }
        if (frames_convert(&raw, frame)) {
            return 1;
        }
    }
    return check_status(link, count) != 0 ? -1 : 0;
}

int link_close(link_t *link)
{
    int status = 0;
    (void)link->bus->close(link->bus);
    if (link->logging && link->log.bus.close(&link->log.bus) != BUS_OK && !link->log_failed) {
        status = report_log_error(link);
    }
    if (link->ticking) {
        tick_close(&link->tick); /* last: it unblocks the pending signals */
    }
    return status;
}
