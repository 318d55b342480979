/*
 * The bus: one small interface to classic CAN, and what stands behind it.
 *
 * A program opens one of three back ends (bus_socketcan.h, bus_candump.h, bus_memory.h) and from
 * then on uses only the members of bus_t, so that a live vehicle, a log and a simulation in one
 * process run through the same code. Nothing here blocks: wait on `fd` (tick.h does), then receive
 * until fewer frames come than were asked for; receive in each tick as well, for that is what finds
 * an interface up again. No threads; one bus belongs to one thread.
 *
 * Every failure has a status for the program and one sentence for its user in `text`.
 */
#ifndef BUS_H
#define BUS_H

#include <stdbool.h>
#include <stdint.h>

#define BUS_TEXT 200

enum {
    BUS_OK = 0,       /* done */
    BUS_BUSY = -1,    /* not sent, the queue is full: that frame is lost, the next may pass */
    BUS_DOWN = -2,    /* the interface is down or unplugged: goes on by itself when it is back */
    BUS_REFUSED = -3, /* the frame or the call makes no sense; nothing was done */
    BUS_END = -4,     /* a log is over */
    BUS_BROKEN = -5,  /* anything else, it will not get better: see text, then close */
};

/* bus_frame_t.flags */
enum {
    BUS_FRAME_EXTENDED = 1, /* the id has 29 bits */
    BUS_FRAME_RTR = 2,      /* remote request: it has a length and no data */
    BUS_FRAME_ERROR = 4,    /* news of the controller: id holds the classes of linux/can/error.h */
};

typedef struct {
    uint64_t
        t_us; /* receive: when it arrived, in the bus's clock (now_us). send: only a log uses it */
    uint32_t id;     /* 11 bits, or 29 with BUS_FRAME_EXTENDED */
    uint8_t length;  /* 0..8 */
    uint8_t flags;   /* BUS_FRAME_* */
    uint8_t data[8]; /* bytes from `length` on are zero when received */
} bus_frame_t;

/* What the controller last said of itself. */
typedef enum { BUS_ACTIVE, BUS_WARNING, BUS_PASSIVE, BUS_OFF } bus_state_t;

/* Written by the back end, read by anyone; counts since open. */
typedef struct {
    uint64_t sent;         /* frames the kernel, log or hub took */
    uint64_t send_busy;    /* frames lost to BUS_BUSY */
    uint64_t send_failed;  /* frames lost to any other failure */
    uint64_t received;     /* frames handed to the caller, error frames included */
    uint64_t dropped;      /* frames that arrived and found the receive buffer full */
    uint64_t malformed;    /* reads that were no classic CAN frame */
    uint64_t error_frames; /* of these: */
    uint64_t bus_offs;     /*   the controller left the bus */
    uint64_t passives;     /*   error passive, either direction */
    uint64_t restarts;     /*   the controller came back (ip link ... restart-ms) */
    uint64_t link_downs;   /* the interface went down or vanished */
    uint64_t link_ups;     /* and came back */
    uint64_t clock_steps;  /* the wall clock, which stamps the frames, was set */
    bus_state_t state;     /* of the controller */
    bool link_up;          /* of the interface */
} bus_statistics_t;

typedef struct bus bus_t;

struct bus {
    /* Sends one frame. BUS_OK, BUS_BUSY, BUS_DOWN, BUS_REFUSED (length > 8, id too large; a log
     * open for reading), BUS_BROKEN. */
    int (*send)(bus_t *bus, const bus_frame_t *frame);
    /* Takes up to `capacity` (1..) frames in their order of arrival. Their number, 0 when there are
     * none now; BUS_DOWN, BUS_END, BUS_REFUSED (a log open for writing), BUS_BROKEN. */
    int (*receive)(bus_t *bus, bus_frame_t *frames, int capacity);
    /* The bus's clock in microseconds; it never runs backwards. */
    uint64_t (*now_us)(bus_t *bus);
    /* Frees what open took. BUS_OK, or BUS_BROKEN when a log could not be written to its end. */
    int (*close)(bus_t *bus);
    int fd; /* readable when there are frames; -1 where there is nothing to wait for */
    bus_statistics_t statistics;
    char text[BUS_TEXT]; /* the last failure: one sentence, with what to do; "" if there was none */
};

/* Is this a frame that classic CAN can carry? Error frames pass: they are injected in tests. */
bool bus_frame_valid(const bus_frame_t *frame);

/* Counts an error frame by what it says and follows the controller's state with it. */
void bus_note_error(bus_statistics_t *statistics, const bus_frame_t *frame);

/* For back ends: writes bus->text like printf and returns `status`. */
int bus_fail(bus_t *bus, int status, const char *format, ...) __attribute__((format(printf, 3, 4)));

#endif
