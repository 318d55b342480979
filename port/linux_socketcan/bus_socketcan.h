/*
 * The bus of bus.h over SocketCAN: a real controller (can0), or vcan, vxcan.
 *
 * - Frames carry the kernel's time of arrival. The kernel stamps with the wall clock. The stamps
 *   are converted to CLOCK_MONOTONIC, the clock of now_us and of the tick, and survive a step of
 *   the wall clock. They never run backwards and are never later than now. Where a step shorter
 *   than a minute leaves two times for a frame that waited, it is the earlier one.
 * - Error frames are enabled, counted and returned (BUS_FRAME_ERROR).
 * - An interface that is down gives BUS_DOWN and is counted. The same bus continues when it is up
 *   again, even after the interface was unplugged and came back under its name.
 * - A full receive buffer counts in `dropped`; the kernel reports it only with the next frame.
 * - Frames of other programs on the same machine are received; the program's own frames are not.
 *
 * Cost: one recvmmsg per 32 frames, one write per frame sent. Memory: about 1 KiB, 5 KiB of stack.
 */
#ifndef BUS_SOCKETCAN_H
#define BUS_SOCKETCAN_H

#include "bus.h"

/* A frame passes a filter if (frame id & mask) == (id & mask) and `extended` matches. Remote
 * requests pass no filter. */
typedef struct {
    uint32_t id;
    uint32_t mask;
    bool extended;
} bus_filter_t;

enum { BUS_FILTERS = 32 };

typedef struct {
    bus_t bus;     /* first: a bus_t * is a bus_socketcan_t * */
    char name[16]; /* of the interface */
    bool bound;    /* bound to an interface that still exists */
    bool broken;   /* a receive failed for good */
    bus_filter_t filters[BUS_FILTERS];
    int filter_count;
    uint32_t overrun;           /* the kernel's counter of drops; wraps */
    int64_t offset_us;          /* wall clock minus monotonic clock, now */
    int64_t previous_offset_us; /* the same when the queue was last empty */
    uint64_t offset_at_us;      /* when offset_us was read */
    uint64_t last_us;           /* stamp of the last frame */
    int receive_buffer;         /* size of the receive buffer in bytes, as the kernel counts them */
} bus_socketcan_t;

/*
 * Opens `interface`, which may be down. `count` is the number of filters, 0..BUS_FILTERS; 0 passes
 * every frame. Returns BUS_OK; BUS_REFUSED (name, number of filters); BUS_BROKEN (no CAN in the
 * kernel, no such interface, not a CAN interface, no permission). self->bus.text has the reason and
 * the remedy.
 */
int bus_socketcan_open(bus_socketcan_t *self, const char *interface, const bus_filter_t *filters,
                       int count);

#endif
