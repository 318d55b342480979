/*
 * A SocketCAN bus on fake system calls.
 */
#ifndef SOCKETCAN_H
#define SOCKETCAN_H

#include "fake_system.h"

#include <net/if.h>
#include <string.h>

#include "bus_socketcan.h"

static bus_socketcan_t can;
static bus_t *const bus = &can.bus;
static bus_frame_t frames[FAKE_INCOMING];

static inline int fresh(void **state)
{
    (void)state;
    memset(&fake, 0, sizeof fake);
    fake.interface_flags = IFF_UP;
    return 0;
}

/* An open bus at 50 s of the monotonic clock, 1000 s of the wall clock. */
static inline int opened(void **state)
{
    (void)fresh(state);
    fake.clocks = true;
    fake.monotonic_us = 50000000;
    fake.wall_us = 1000000000;
    return bus_socketcan_open(&can, "can0", NULL, 0);
}

static inline int closed(void **state)
{
    (void)state;
    return bus->close(bus);
}

/* Advances both clocks. */
static inline void pass(uint64_t us)
{
    fake.monotonic_us += us;
    fake.wall_us += us;
}

static inline int receive(void)
{
    return bus->receive(bus, frames, FAKE_INCOMING);
}

#define OPENED(test) cmocka_unit_test_setup_teardown(test, opened, closed)

#endif
