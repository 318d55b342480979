/*
 * The tick of a Linux program: wakes it at absolute times, when frames have come, or to stop.
 *
 * The main loop of a node calls tick_wait() and does what it returns. Ticks are counted on
 * CLOCK_MONOTONIC from the first on, so neither the time the work takes nor a step of the wall
 * clock moves them; those that were slept through are counted, not made up for. SIGINT, SIGTERM,
 * SIGHUP, SIGPIPE and SIGXFSZ arrive here as TICK_STOP and nowhere else: no handler runs, and no
 * call is interrupted by them. Writing to a pipe that nobody reads, or to a file that may not grow,
 * fails with EPIPE or EFBIG. A SIGHUP that was ignored before (nohup) stays so.
 *
 * One tick a program (it owns these signals); no threads.
 */
#ifndef TICK_H
#define TICK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define TICK_TEXT 200
#define TICK_SIGNALS 5

/* What tick_wait() returns: any of these at once, or 0 for none before the time-out. */
enum {
    TICK_DUE = 1,      /* one period or more is over */
    TICK_READABLE = 2, /* a watched descriptor has something to tell: receive until it is empty */
    TICK_STOP = 4,     /* one of the signals above came */
};

typedef struct {
    int epoll_fd, timer_fd, signal_fd;
    int signal;           /* the one that asked to stop; 0 before */
    uint64_t period_us;   /* 0: no timer */
    uint64_t start_us;    /* tick n is due at start_us + n * period_us, n = 1, 2, ... */
    uint64_t ticks;       /* periods over so far, the missed ones included */
    uint64_t missed;      /* of these, slept through: another one was due before they were seen */
    bool blocked[TICK_SIGNALS]; /* were they blocked before open? */
    char text[TICK_TEXT]; /* the last failure, one sentence */
} tick_t;

/* CLOCK_MONOTONIC in microseconds. */
uint64_t tick_now_us(void);

/* Starts ticking now. period_us 0 for a program that follows the bus's tick and only waits for
 * frames. 0, or -1 with the reason in tick->text. */
int tick_open(tick_t *tick, uint64_t period_us);

/* Wakes for `fd` too (bus_t.fd; -1 is ignored). 0 or -1. */
int tick_watch(tick_t *tick, int fd);

/* Sleeps until something happens, `timeout_ms` at most (0: only look; -1: no limit). TICK_* bits;
 * -1 with the reason in tick->text. */
int tick_wait(tick_t *tick, int timeout_ms);

/* Closes everything and gives the signals back. */
void tick_close(tick_t *tick);

/*
 * Asks for real time: SCHED_FIFO at `priority` (1..99) and all memory locked, now and in future.
 * 0 when both were granted; else the number of refusals, and `text` says in one sentence each what
 * was refused and what to do. A program goes on either way, only with less certain timing.
 */
int tick_realtime(int priority, char *text, size_t size);

#endif
