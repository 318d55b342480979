/*
 * The bus of bus.h within one process: a hub with two or more ends, for the demo and for tests.
 *
 * All other ends receive what one end sends, each subject to its own faults. Only
 * bus_memory_advance() moves the hub's clock. A frame is received when the clock reaches its time
 * of arrival. The hub uses no real clock and no real random numbers: the same calls give the same
 * frames. Memory: sizeof(bus_memory_t), about 100 KiB. Each send searches the queue from its end.
 */
#ifndef BUS_MEMORY_H
#define BUS_MEMORY_H

#include "bus.h"

enum { BUS_MEMORY_ENDS = 4, BUS_MEMORY_QUEUE = 1024 };

/* Faults of the frames on their way to one end. All zero: none. */
typedef struct {
    uint32_t loss_ppm;        /* lost frames per million */
    uint32_t duplication_ppm; /* duplicated frames per million of those not lost */
    uint64_t delay_us;        /* from sending to arrival */
    uint64_t jitter_us;       /* added to the delay, uniform in 0..jitter: frames may overtake */
} bus_memory_faults_t;

typedef struct {
    bus_t bus; /* first */
    struct bus_memory *hub;
    bus_memory_faults_t faults;          /* of frames to this end; may be changed at any time */
    uint64_t lost, duplicated;           /* frames so far */
    uint32_t fail_sends;                 /* number of sends to fail with BUS_BUSY; counts down */
    bool down;                           /* this end's interface is down */
    int first, count;                    /* of the queue: a ring buffer in order of arrival */
    bus_frame_t queue[BUS_MEMORY_QUEUE]; /* t_us is the arrival */
} bus_memory_end_t;

typedef struct bus_memory {
    uint64_t now_us;
    uint64_t random; /* state of xorshift64*; never zero */
    int ends;
    bus_memory_end_t end[BUS_MEMORY_ENDS]; /* a program uses &hub.end[i].bus */
} bus_memory_t;

/* Initialises an idle hub with `ends` ends (2..BUS_MEMORY_ENDS) at time 0. `seed` determines the
 * faults. Returns BUS_OK or BUS_REFUSED. There is nothing to free. */
int bus_memory_init(bus_memory_t *hub, int ends, uint64_t seed);

/* Advances the clock. */
void bus_memory_advance(bus_memory_t *hub, uint64_t by_us);

/* Delivers a frame to one end now, for instance an error frame of a controller. */
void bus_memory_inject(bus_memory_t *hub, int end, const bus_frame_t *frame);

#endif
