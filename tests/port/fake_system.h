/*
 * Fake system calls. Everything in port/ is linked with -Wl,--wrap for each function that
 * fake_system.c defines. With `fake` all zero they call the real ones. Sockets are always fake, so
 * no test here needs a kernel with CAN.
 */
#ifndef FAKE_SYSTEM_H
#define FAKE_SYSTEM_H

#define _GNU_SOURCE
/* Required by cmocka.h. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <stdbool.h>

enum { FAKE_INCOMING = 400 };

/* One result of recvmmsg: a message, or an error if `error` is not 0. */
typedef struct {
    struct can_frame frame;
    unsigned length;  /* bytes read */
    uint64_t wall_us; /* the kernel's timestamp; 0: none */
    uint32_t overrun; /* SO_RXQ_OVFL; 0: none */
    int error;
} fake_incoming_t;

typedef struct {
    /* Calls that fail: an errno, or 0. */
    int socket_error, bind_error, index_error, write_error, force_error, option_error;
    int epoll_error, timer_error, scheduler_error, lock_error;
    int write_errors;      /* number of writes to fail with write_error; -1: all */
    int write_short;       /* a write accepts only this number of bytes; 0: all */
    short interface_flags; /* of SIOCGIFFLAGS */
    bool clocks;           /* use these two instead of the real ones */
    uint64_t wall_us, monotonic_us;
    uint64_t pause_us;    /* passes before the next reading of the wall clock */
    uint64_t expirations; /* result of the next read of a timer; 0: the real one */
    fake_incoming_t incoming[FAKE_INCOMING];
    int arrived, read; /* entries filled, entries returned */
    /* Recorded calls. */
    int writes, binds, closes, receives, clock_id, timer_flags, receive_buffer;
    struct can_frame written;
    struct can_filter filters[64];
    int filter_count;
    can_err_mask_t error_mask;
    bool stamps, overruns;
} fake_t;

extern fake_t fake;

/* The next message or error of a receive. */
fake_incoming_t *fake_arrives(uint32_t can_id, uint8_t first_byte);
void fake_arrives_error(int error);

#endif
