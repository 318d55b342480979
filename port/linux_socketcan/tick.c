/* epoll over one timerfd, one signalfd and the watched descriptors. */
#define _GNU_SOURCE
#include "tick.h"

#include <errno.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/mman.h>
#include <sys/signalfd.h>
#include <sys/timerfd.h>
#include <time.h>
#include <unistd.h>

enum { EVENTS = 8 };

static const int stop_signals[TICK_SIGNALS] = {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGXFSZ};

static struct timespec from_us(uint64_t us)
{
    struct timespec t;

    t.tv_sec = (time_t)(us / 1000000U);
    t.tv_nsec = (long)(us % 1000000U) * 1000L;
    return t;
}

uint64_t tick_now_us(void)
{
    struct timespec t;

    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint64_t)t.tv_sec * 1000000U + (uint64_t)t.tv_nsec / 1000U;
}

static int fail(tick_t *tick, const char *what)
{
    (void)snprintf(tick->text, sizeof tick->text, "%s: %s", what, strerror(errno));
    return -1;
}

static int watch(tick_t *tick, int fd)
{
    struct epoll_event event;

    memset(&event, 0, sizeof event);
    event.events = EPOLLIN;
    event.data.fd = fd;
    return epoll_ctl(tick->epoll_fd, EPOLL_CTL_ADD, fd, &event);
}

int tick_watch(tick_t *tick, int fd)
{
    if (fd >= 0 && watch(tick, fd) < 0) {
        return fail(tick, "cannot wait for the bus");
    }
    return 0;
}

/* nohup ignores a signal, but a signalfd would deliver it nevertheless. */
static bool is_ignored(int signal)
{
    struct sigaction action;

    return sigaction(signal, NULL, &action) == 0 && action.sa_handler == SIG_IGN;
}

static int open_signals(tick_t *tick)
{
    sigset_t stops, before;
    int i;

    (void)sigemptyset(&stops);
    for (i = 0; i < TICK_SIGNALS; i++) {
        if (stop_signals[i] != SIGHUP || !is_ignored(SIGHUP)) {
            (void)sigaddset(&stops, stop_signals[i]);
        }
    }
    if (sigprocmask(SIG_BLOCK, &stops, &before) < 0) {
        return -1;
    }
    for (i = 0; i < TICK_SIGNALS; i++) {
        tick->blocked[i] = sigismember(&before, stop_signals[i]) == 1;
    }
    tick->signal_fd = signalfd(-1, &stops, SFD_NONBLOCK | SFD_CLOEXEC);
    return tick->signal_fd < 0 ? -1 : watch(tick, tick->signal_fd);
}

static int open_timer(tick_t *tick)
{
    struct itimerspec when;

    if (tick->period_us == 0) {
        return 0;
    }
    tick->timer_fd = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
    if (tick->timer_fd < 0) {
        return -1;
    }
    when.it_value = from_us(tick->start_us + tick->period_us);
    when.it_interval = from_us(tick->period_us);
    if (timerfd_settime(tick->timer_fd, TFD_TIMER_ABSTIME, &when, NULL) < 0) {
        return -1;
    }
    return watch(tick, tick->timer_fd);
}

int tick_open(tick_t *tick, uint64_t period_us)
{
    memset(tick, 0, sizeof *tick);
    tick->timer_fd = tick->signal_fd = -1;
    tick->period_us = period_us;
    memset(tick->blocked, true, sizeof tick->blocked); /* nothing to restore yet */
    tick->epoll_fd = epoll_create1(EPOLL_CLOEXEC);
    tick->start_us = tick_now_us();
    if (tick->epoll_fd < 0 || open_signals(tick) < 0 || open_timer(tick) < 0) {
        (void)fail(tick, "cannot set up the tick");
        tick_close(tick);
        return -1;
    }
    return 0;
}

static int read_timer(tick_t *tick)
{
    uint64_t expirations;
    const ssize_t got = read(tick->timer_fd, &expirations, sizeof expirations);

    if (got != (ssize_t)sizeof expirations || expirations == 0) {
        return 0; /* No other reader exists: a wake-up without an elapsed period. */
    }
    tick->ticks += expirations;
    tick->missed += expirations - 1;
    return TICK_DUE;
}

static int read_signal(tick_t *tick)
{
    struct signalfd_siginfo info;

    if (read(tick->signal_fd, &info, sizeof info) != (ssize_t)sizeof info) {
        return 0;
    }
    tick->signal = (int)info.ssi_signo;
    return TICK_STOP;
}

int tick_wait(tick_t *tick, int timeout_ms)
{
    struct epoll_event events[EVENTS];
    int i, happened = 0;
    const int count = epoll_wait(tick->epoll_fd, events, EVENTS, timeout_ms);

    if (count < 0) {
        return errno == EINTR ? 0 : fail(tick, "cannot wait");
    }
    for (i = 0; i < count; i++) {
        if (events[i].data.fd == tick->timer_fd) {
            happened |= read_timer(tick);
        } else if (events[i].data.fd == tick->signal_fd) {
            happened |= read_signal(tick);
        } else {
            happened |= TICK_READABLE;
        }
    }
    return happened;
}

void tick_close(tick_t *tick)
{
    const int fds[3] = {tick->timer_fd, tick->signal_fd, tick->epoll_fd};
    struct signalfd_siginfo info;
    sigset_t unblocked;
    int i;

    /* Further stop signals: unblocked, they would end the program before its report is written. */
    while (tick->signal_fd >= 0 &&
           read(tick->signal_fd, &info, sizeof info) == (ssize_t)sizeof info) {
    }
    for (i = 0; i < 3; i++) {
        if (fds[i] >= 0) {
            (void)close(fds[i]);
        }
    }
    tick->timer_fd = tick->signal_fd = tick->epoll_fd = -1;
    (void)sigemptyset(&unblocked);
    for (i = 0; i < TICK_SIGNALS; i++) {
        if (!tick->blocked[i]) {
            (void)sigaddset(&unblocked, stop_signals[i]);
        }
        tick->blocked[i] = true;
    }
    (void)sigprocmask(SIG_UNBLOCK, &unblocked, NULL);
}

int tick_realtime(int priority, char *text, size_t size)
{
    struct sched_param parameters;
    int refused = 0, used = 0;

    memset(&parameters, 0, sizeof parameters);
    parameters.sched_priority = priority;
    text[0] = '\0';
    if (sched_setscheduler(0, SCHED_FIFO, &parameters) < 0) {
        used = snprintf(text, size,
                        "no real-time priority %d (%s): run as root, or allow it with 'ulimit -r'.",
                        priority, strerror(errno));
        refused++;
    }
    if (mlockall(MCL_CURRENT | MCL_FUTURE) < 0) {
        if ((size_t)used < size) {
            (void)snprintf(text + used, size - (size_t)used,
                           "%smemory not locked (%s): run as root, or allow it with 'ulimit -l'.",
                           used > 0 ? " " : "", strerror(errno));
        }
        refused++;
    }
    return refused;
}
