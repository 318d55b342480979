/*
 * The bus of bus.h over SocketCAN: a real controller (can0), or vcan, vxcan.
 *
 * - Frames carry the kernel's time of arrival. The kernel stamps with the wall clock; the stamps
 *   are carried over to CLOCK_MONOTONIC, the clock of now_us and of the tick, and survive a step of
 *   the wall clock. They never run backwards and are never later than now.
 * - Error frames are asked for, counted and handed on (BUS_FRAME_ERROR).
 * - Interface down: BUS_DOWN and counted; the same bus goes on when it is up again, also when the
 *   interface was unplugged and comes back under its name.
 * - Receive buffer full: counted in `dropped`, which the kernel tells only with the next frame.
 * - Frames that other programs of this machine send are received too; one's own are not.
 *
 * Cost: one recvmmsg for 32 frames, one send a frame. Memory: about 1 KiB, 5 KiB of stack.
 */
#ifndef BUS_SOCKETCAN_H
#define BUS_SOCKETCAN_H

#include "bus.h"

/* A frame passes a filter when (frame id & mask) == (id & mask) and it is extended or not as told;
 * remote requests pass no filter. */
typedef struct {
    uint32_t id;
    uint32_t mask;
    bool extended;
} bus_filter_t;

enum { BUS_FILTERS = 32 };

typedef struct {
    bus_t bus;     /* first: a bus_t * is a bus_socketcan_t * */
    char name[16]; /* of the interface */
    bool bound;    /* to an interface that still exists */
    bus_filter_t filters[BUS_FILTERS];
    int filter_count;
    uint32_t overrun;           /* the kernel's counter of drops, which wraps */
    int64_t offset_us;          /* wall clock minus monotonic clock now */
    int64_t previous_offset_us; /* and when the queue was last empty */
    uint64_t offset_at_us;      /* when it was read */
    uint64_t last_us;           /* stamp of the last frame */
    int receive_buffer;         /* bytes of receive buffer obtained, as the kernel counts them */
} bus_socketcan_t;

/*
 * Opens `interface`; it may be down. `count` filters (0..BUS_FILTERS), none for everything.
 * BUS_OK; BUS_REFUSED (name, number of filters); BUS_BROKEN: no CAN in the kernel, no such
 * interface, not a CAN interface, no permission: which of them, and what to do, is in
 * self->bus.text.
 */
int bus_socketcan_open(bus_socketcan_t *self, const char *interface, const bus_filter_t *filters,
                       int count);

#endif
