/*
 * The bus: one small interface to classic CAN with three back ends.
 *
 * A program opens one of bus_socketcan.h, bus_candump.h and bus_memory.h. From then on it uses only
 * the members of bus_t. So a live vehicle, a log and a simulation in one process share the same
 * code. No call blocks: wait on `fd` (tick.h does), then receive until fewer frames arrive than
 * requested. Receive in each tick as well, because only that detects that an interface is up again.
 * There are no threads; one bus belongs to one thread.
 *
 * Every failure gives a status to the program and one sentence for its user in `text`.
 */
#ifndef BUS_H
#define BUS_H

#include <stdbool.h>
#include <stdint.h>

#define BUS_TEXT 200

enum {
    BUS_OK = 0,       /* done */
    BUS_BUSY = -1,    /* the queue is full: this frame is lost, later ones may be sent */
    BUS_DOWN = -2,    /* the interface is down or unplugged: the bus recovers by itself */
    BUS_REFUSED = -3, /* the frame or the call is invalid; no-op */
    BUS_END = -4,     /* the end of a log */
    BUS_BROKEN = -5,  /* any other failure, permanent: read `text`, then close */
};

/* bus_frame_t.flags */
enum {
    BUS_FRAME_EXTENDED = 1, /* the id has 29 bits */
    BUS_FRAME_RTR = 2,      /* remote request: a length, but no data */
    BUS_FRAME_ERROR = 4,    /* controller error: id holds the classes of linux/can/error.h */
};

typedef struct {
    uint64_t t_us;  /* received: time of arrival in the bus's clock (now_us). Sent: a log uses it */
    uint32_t id;    /* 11 bits, or 29 with BUS_FRAME_EXTENDED */
    uint8_t length; /* 0..8 */
    uint8_t flags;  /* BUS_FRAME_* */
    uint8_t data[8]; /* received: zero from `length` on */
} bus_frame_t;

/* State that the controller last reported. */
typedef enum { BUS_ACTIVE, BUS_WARNING, BUS_PASSIVE, BUS_OFF } bus_state_t;

/* Counts since open. Only the back end writes them. */
typedef struct {
    uint64_t sent;         /* frames that the kernel, log or hub accepted */
    uint64_t send_busy;    /* frames lost to BUS_BUSY */
    uint64_t send_failed;  /* frames lost to any other failure */
    uint64_t received;     /* frames returned to the caller, including error frames */
    uint64_t dropped;      /* frames that found the receive buffer full: the newest are lost */
    uint64_t malformed;    /* reads that returned no classic CAN frame */
    uint64_t error_frames; /* error frames; of these: */
    uint64_t bus_offs;     /*   the controller left the bus */
    uint64_t passives;     /*   error passive, either direction */
    uint64_t restarts;     /*   the controller restarted (ip link ... restart-ms) */
    uint64_t link_downs;   /* times the interface went down or vanished */
    uint64_t link_ups;     /* times it came back */
    uint64_t clock_steps;  /* times the wall clock, which stamps the frames, was set */
    bus_state_t state;     /* of the controller */
    bool link_up;          /* of the interface */
} bus_statistics_t;

typedef struct bus bus_t;

struct bus {
    /* Sends one frame. Returns BUS_OK, BUS_BUSY, BUS_DOWN, BUS_REFUSED (length > 8, id too large, a
     * log open for reading) or BUS_BROKEN. */
    int (*send)(bus_t *bus, const bus_frame_t *frame);
    /* Receives up to `capacity` (1..) frames in order of arrival. Returns their number (0 if there
     * are none now), BUS_DOWN, BUS_END, BUS_REFUSED (a log open for writing) or BUS_BROKEN. */
    int (*receive)(bus_t *bus, bus_frame_t *frames, int capacity);
    /* Returns the bus's clock [us]. It never runs backwards. */
    uint64_t (*now_us)(bus_t *bus);
    /* Releases all resources. Returns BUS_OK, or BUS_BROKEN if a log could not be written
     * completely. */
    int (*close)(bus_t *bus);
    int fd; /* readable when there are frames; -1 if the back end never waits */
    bus_statistics_t statistics;
    char text[BUS_TEXT]; /* the last failure and its remedy in one sentence; "" if none */
};

/* Returns true if classic CAN can carry this frame. Error frames are valid: tests inject them. */
bool bus_frame_valid(const bus_frame_t *frame);

/* Counts an error frame by its classes and updates the controller's state. */
void bus_note_error(bus_statistics_t *statistics, const bus_frame_t *frame);

/* For back ends: writes bus->text like printf and returns `status`. */
int bus_fail(bus_t *bus, int status, const char *format, ...) __attribute__((format(printf, 3, 4)));

#endif
