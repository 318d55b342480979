/*
 * The bus of bus.h within one process: a hub with two ends or more, for the demo and for tests.
 *
 * What one end sends, all others receive, each as the faults of its own say. The hub's clock stands
 * still until bus_memory_advance(); a frame is received as soon as the clock has reached its
 * arrival. Nothing here asks a real clock or a real random number: the same calls give the same
 * frames. Memory: sizeof(bus_memory_t), about 100 KiB. Sending costs a search of the queue from its
 * end.
 */
#ifndef BUS_MEMORY_H
#define BUS_MEMORY_H

#include "bus.h"

enum { BUS_MEMORY_ENDS = 4, BUS_MEMORY_QUEUE = 1024 };

/* What happens to frames on their way to one end. All zero: nothing does. */
typedef struct {
    uint32_t loss_ppm;        /* of a million frames, lost */
    uint32_t duplication_ppm; /* of those not lost, arriving twice */
    uint64_t delay_us;        /* from sending to arrival */
    uint64_t jitter_us;       /* added to it, uniform in 0..jitter: frames overtake each other */
} bus_memory_faults_t;

typedef struct {
    bus_t bus; /* first */
    struct bus_memory *hub;
    bus_memory_faults_t faults;          /* of what arrives here; may be changed at any time */
    uint64_t lost, duplicated;           /* what they did so far */
    uint32_t fail_sends;                 /* so many sends from here give BUS_BUSY, counted down */
    bool down;                           /* this end's interface is down */
    int first, count;                    /* of the queue, a ring in order of arrival */
    bus_frame_t queue[BUS_MEMORY_QUEUE]; /* t_us is the arrival */
} bus_memory_end_t;

typedef struct bus_memory {
    uint64_t now_us;
    uint64_t random; /* state of xorshift64*; never zero */
    int ends;
    bus_memory_end_t end[BUS_MEMORY_ENDS]; /* &hub.end[i].bus is what a program takes */
} bus_memory_t;

/* An idle hub with `ends` ends (2..BUS_MEMORY_ENDS) at time 0; faults are drawn from `seed`. BUS_OK
 * or BUS_REFUSED. Nothing to free. */
int bus_memory_init(bus_memory_t *hub, int ends, uint64_t seed);

/* Moves the clock on. */
void bus_memory_advance(bus_memory_t *hub, uint64_t by_us);

/* Puts a frame, an error frame of a controller for instance, before one end now. */
void bus_memory_inject(bus_memory_t *hub, int end, const bus_frame_t *frame);

#endif
