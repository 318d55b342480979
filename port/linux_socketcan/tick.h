/*
 * The tick of a Linux program. It wakes the program at absolute times, when frames arrive, or to
 * stop.
 *
 * The main loop of a node calls tick_wait() and acts on the result. Ticks are counted on
 * CLOCK_MONOTONIC from the first tick. So neither the duration of the work nor a step of the wall
 * clock shifts them. Missed ticks are counted, but not repeated. SIGINT, SIGTERM, SIGHUP, SIGPIPE
 * and SIGXFSZ arrive only as TICK_STOP: no handler runs, and they interrupt no call. So no call may
 * block. Writing to a pipe without a reader, or to a file that may not grow, fails with EPIPE or
 * EFBIG. A SIGHUP that was ignored before (nohup) remains ignored. Signals that come after the
 * first one are dropped.
 *
 * Use one tick per program, because it owns these signals. There are no threads.
 */
#ifndef TICK_H
#define TICK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define TICK_TEXT 200
#define TICK_SIGNALS 5

/* Results of tick_wait(), combined by OR; 0: time-out. */
enum {
    TICK_DUE = 1,      /* one period or more has elapsed */
    TICK_READABLE = 2, /* a watched descriptor is readable: receive until it is empty */
    TICK_STOP = 4,     /* one of the signals above arrived */
};

typedef struct {
    int epoll_fd, timer_fd, signal_fd;
    int signal;                 /* the signal that requested the stop; 0: none yet */
    uint64_t period_us;         /* 0: no timer */
    uint64_t start_us;          /* tick n is due at start_us + n * period_us, n = 1, 2, ... */
    uint64_t ticks;             /* elapsed periods, including missed ones */
    uint64_t missed;            /* missed: the next one was due before the program saw them */
    bool blocked[TICK_SIGNALS]; /* the signals that were blocked before open */
    char text[TICK_TEXT];       /* the last failure, one sentence */
} tick_t;

/* Returns CLOCK_MONOTONIC [us]. */
uint64_t tick_now_us(void);

/* Starts the ticks now. period_us 0: no ticks, for a program that follows the bus's tick and only
 * waits for frames. Returns 0, or -1 with the reason in tick->text. */
int tick_open(tick_t *tick, uint64_t period_us);

/* Makes tick_wait() also wait for `fd` (bus_t.fd; -1 is ignored). Returns 0 or -1. */
int tick_watch(tick_t *tick, int fd);

/* Sleeps until an event, for at most `timeout_ms` (0: returns at once; -1: no limit). Returns
 * TICK_* bits, or -1 with the reason in tick->text. */
int tick_wait(tick_t *tick, int timeout_ms);

/* Closes all descriptors and restores the signals. */
void tick_close(tick_t *tick);

/*
 * Requests real time: SCHED_FIFO at `priority` (1..99), and all present and future memory locked.
 * Returns 0 if both were granted, else the number of refusals. `text` then has one sentence per
 * refusal, with the remedy. The program may continue either way, but with less certain timing.
 */
int tick_realtime(int priority, char *text, size_t size);

#endif
