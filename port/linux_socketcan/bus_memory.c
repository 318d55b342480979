/* A hub of queues. See bus_memory.h. */
#include "bus_memory.h"

#include <string.h>

/* xorshift64* of Marsaglia and Vigna. */
static uint32_t draw(bus_memory_t *hub)
{
    hub->random ^= hub->random >> 12;
    hub->random ^= hub->random << 25;
    hub->random ^= hub->random >> 27;
    return (uint32_t)(hub->random * 0x2545F4914F6CDD1DU >> 32);
}

static bool happens(bus_memory_t *hub, uint32_t ppm)
{
    return ppm > 0 && (uint64_t)draw(hub) * 1000000U >> 32 < ppm;
}

static bus_frame_t *slot(bus_memory_end_t *end, int i)
{
    return &end->queue[(end->first + i) % BUS_MEMORY_QUEUE];
}

/* Inserts in order of arrival; of two with the same arrival, the one sent first comes first. */
static void enqueue(bus_memory_end_t *end, const bus_frame_t *frame, uint64_t arrival_us)
{
    int i = end->count;

    if (end->count == BUS_MEMORY_QUEUE) {
        end->bus.statistics.dropped++;
        return;
    }
    for (; i > 0 && slot(end, i - 1)->t_us > arrival_us; i--) {
        *slot(end, i) = *slot(end, i - 1);
    }
    *slot(end, i) = *frame;
    slot(end, i)->t_us = arrival_us;
    end->count++;
}

static uint64_t arrival(bus_memory_t *hub, const bus_memory_faults_t *faults)
{
    uint64_t t_us = hub->now_us + faults->delay_us;

    if (faults->jitter_us > 0) {
        t_us += draw(hub) % (faults->jitter_us + 1);
    }
    return t_us;
}

static void deliver(bus_memory_t *hub, bus_memory_end_t *end, const bus_frame_t *frame)
{
    if (end->down) {
        return;
    }
    if (happens(hub, end->faults.loss_ppm)) {
        end->lost++;
        return;
    }
    enqueue(end, frame, arrival(hub, &end->faults));
    if (happens(hub, end->faults.duplication_ppm)) {
        end->duplicated++;
        enqueue(end, frame, arrival(hub, &end->faults));
    }
}

/* Updates the statistics with `down`, which the test sets. */
static bool is_up(bus_memory_end_t *self)
{
    bus_statistics_t *statistics = &self->bus.statistics;

    if (statistics->link_up && self->down) {
        statistics->link_downs++;
        (void)bus_fail(&self->bus, BUS_DOWN, "the interface in memory is down");
    } else if (!statistics->link_up && !self->down) {
        statistics->link_ups++;
    }
    statistics->link_up = !self->down;
    return !self->down;
}

static int memory_send(bus_t *bus, const bus_frame_t *frame)
{
    bus_memory_end_t *self = (bus_memory_end_t *)bus;
    bus_frame_t clean = *frame;
    int i;

    if (!bus_frame_valid(frame)) {
        bus->statistics.send_failed++;
        return bus_fail(bus, BUS_REFUSED, "frame %X of length %d is not a classic CAN frame",
                        (unsigned)frame->id, frame->length);
    }
    if (!is_up(self)) {
        bus->statistics.send_failed++;
        return BUS_DOWN;
    }
    if (self->fail_sends > 0) {
        self->fail_sends--;
        bus->statistics.send_busy++;
        return bus_fail(bus, BUS_BUSY, "the send queue in memory is full");
    }
    for (i = clean.flags & BUS_FRAME_RTR ? 0 : clean.length; i < 8; i++) {
        clean.data[i] = 0;
    }
    for (i = 0; i < self->hub->ends; i++) {
        if (&self->hub->end[i] != self) {
            deliver(self->hub, &self->hub->end[i], &clean);
        }
    }
    bus->statistics.sent++;
    return BUS_OK;
}

static int memory_receive(bus_t *bus, bus_frame_t *frames, int capacity)
{
    bus_memory_end_t *self = (bus_memory_end_t *)bus;
    int taken = 0;

    while (taken < capacity && self->count > 0 && slot(self, 0)->t_us <= self->hub->now_us) {
        frames[taken] = *slot(self, 0);
        if (frames[taken].flags & BUS_FRAME_ERROR) {
            bus_note_error(&bus->statistics, &frames[taken]);
        }
        self->first = (self->first + 1) % BUS_MEMORY_QUEUE;
        self->count--;
        taken++;
    }
    bus->statistics.received += (uint64_t)taken;
    return is_up(self) || taken > 0 ? taken : BUS_DOWN;
}

static uint64_t memory_now_us(bus_t *bus)
{
    return ((const bus_memory_end_t *)bus)->hub->now_us;
}

static int memory_close(bus_t *bus)
{
    (void)bus;
    return BUS_OK;
}

int bus_memory_init(bus_memory_t *hub, int ends, uint64_t seed)
{
    int i;

    if (ends < 2 || ends > BUS_MEMORY_ENDS) {
        return BUS_REFUSED;
    }
    memset(hub, 0, sizeof *hub);
    hub->ends = ends;
    hub->random = seed * 2 + 1;
    for (i = 0; i < ends; i++) {
        bus_t *bus = &hub->end[i].bus;

        hub->end[i].hub = hub;
        bus->fd = -1;
        bus->send = memory_send;
        bus->receive = memory_receive;
        bus->now_us = memory_now_us;
        bus->close = memory_close;
        bus->statistics.link_up = true;
    }
    return BUS_OK;
}

void bus_memory_advance(bus_memory_t *hub, uint64_t by_us)
{
    hub->now_us += by_us;
}

void bus_memory_inject(bus_memory_t *hub, int end, const bus_frame_t *frame)
{
    enqueue(&hub->end[end], frame, hub->now_us);
}
