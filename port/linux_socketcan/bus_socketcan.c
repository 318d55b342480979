/*
 * SocketCAN (linux/Documentation/networking/can.rst).
 *
 * Behaviour of the kernel, and the consequences:
 * - The default buffer holds 278 frames on vcan, a quarter of a second of a busy bus. This file
 *   requests more.
 * - An interface that goes down sets ENETDOWN in the socket once, not as long as it is down. So
 *   each receive reads the interface's flags while it is down.
 * - An interface that vanishes sets ENODEV. The socket is then unbound and has no filter, not even
 *   the one that passes all frames. So the filters are set and the socket is bound by name again.
 * - SO_TIMESTAMPNS is the software stamp of SO_TIMESTAMPING, in the wall clock. The stamps of a
 *   controller would be in its own clock.
 */
#define _GNU_SOURCE /* recvmmsg */
#include "bus_socketcan.h"

#include <errno.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "tick.h"

enum {
    BATCH = 32,
    RECEIVE_BUFFER = 4 << 20, /* 10900 frames of vcan: more than a second of 1 Mbit/s */
    /* one timestamp and one counter with each frame */
    CONTROL = CMSG_SPACE(sizeof(struct timespec)) + CMSG_SPACE(sizeof(uint32_t)),
    MIN_STEP_US = 10000,     /* a wall clock that changes by more was set, not adjusted */
    MAX_RATE_INVERSE = 1000, /* the rate is adjusted by at most one part in this */
    MAX_READING_US = 2000,   /* the program was interrupted between two readings further apart */
    MAX_READINGS = 10,       /* maximum number of attempts to read both without interruption */
    MAX_WAIT_US = 60000000,  /* no frame waits longer for its receiver */
};

static uint64_t to_us(const struct timespec *t)
{
    return (uint64_t)t->tv_sec * 1000000U + (uint64_t)t->tv_nsec / 1000U;
}

/* Reads wall clock minus monotonic clock, and counts a step of the wall clock. An interruption
 * between the two readings would look like a step. */
static uint64_t read_clocks(bus_socketcan_t *self)
{
    struct timespec wall;
    uint64_t before_us, now_us;
    int64_t change, bound;
    int readings = 0;

    do {
        before_us = tick_now_us();
        (void)clock_gettime(CLOCK_REALTIME, &wall);
        now_us = tick_now_us();
    } while (now_us - before_us > MAX_READING_US && ++readings < MAX_READINGS);
    change = -self->offset_us;
    self->offset_us = (int64_t)(to_us(&wall) - now_us);
    change += self->offset_us;
    bound = MIN_STEP_US + (int64_t)(now_us - self->offset_at_us) / MAX_RATE_INVERSE;
    if (self->offset_at_us != 0 && (change > bound || change < -bound)) {
        self->bus.statistics.clock_steps++;
    }
    self->offset_at_us = now_us;
    return now_us;
}

/*
 * The kernel does not tell whether a queued frame was stamped before or after a step of the wall
 * clock. With the right offset its time is not later than now. With the wrong one it is off by the
 * step: either earlier than the right time, or in the future. So the right one is the later of the
 * two that is not in the future, if the step is longer than a frame waits. After a shorter one the
 * earlier counts: a frame that seems too old ends the thrust of a receiver, one that seems too new
 * would keep it.
 */
static uint64_t stamp_to_us(bus_socketcan_t *self, const struct timespec *stamp, uint64_t now_us)
{
    const int64_t wall_us = (int64_t)to_us(stamp), now = (int64_t)now_us;
    const int64_t a = wall_us - self->offset_us, b = wall_us - self->previous_offset_us;
    const int64_t earlier = a < b ? a : b, later = a < b ? b : a;
    int64_t t = later > now || later - earlier < MAX_WAIT_US ? earlier : later;

    if (t > now) {
        t = now;
    }
    if (t < (int64_t)self->last_us) {
        t = (int64_t)self->last_us;
    }
    self->last_us = (uint64_t)t;
    return self->last_us;
}

static void record_link_down(bus_socketcan_t *self, const char *what, const char *remedy)
{
    if (self->bus.statistics.link_up) {
        self->bus.statistics.link_up = false;
        self->bus.statistics.link_downs++;
    }
    (void)bus_fail(&self->bus, BUS_DOWN, "interface '%s' %s; %s", self->name, what, remedy);
}

static void record_link_up(bus_socketcan_t *self)
{
    if (!self->bus.statistics.link_up) {
        self->bus.statistics.link_up = true;
        self->bus.statistics.link_ups++;
    }
}

/* Returns BUS_DOWN with the reason, or BUS_BROKEN for any other error. */
static int record_errno(bus_socketcan_t *self, int error, const char *call)
{
    switch (error) {
    case ENETDOWN:
        record_link_down(self, "is down", "bring it up with 'ip link set ... up'");
        return BUS_DOWN;
    case ENODEV:
    case ENXIO:
        self->bound = false;
        record_link_down(self, "is gone",
                         "plug the adapter in again, or create the interface again");
        return BUS_DOWN;
    default:
        return bus_fail(&self->bus, BUS_BROKEN, "%s on '%s' failed: %s", call, self->name,
                        strerror(error));
    }
}

static int set_filters(bus_socketcan_t *self)
{
    struct can_filter out[BUS_FILTERS];
    int i;

    out[0].can_id = out[0].can_mask = 0; /* without filters: one that passes all frames */
    for (i = 0; i < self->filter_count; i++) {
        const bus_filter_t *in = &self->filters[i];

        out[i].can_id = in->id | (in->extended ? CAN_EFF_FLAG : 0);
        out[i].can_mask = (in->mask & CAN_EFF_MASK) | CAN_EFF_FLAG | CAN_RTR_FLAG;
    }
    return setsockopt(self->bus.fd, SOL_CAN_RAW, CAN_RAW_FILTER, out,
                      (socklen_t)((size_t)(i > 0 ? i : 1) * sizeof out[0]));
}

/* Binds to the interface by its name. Returns 0 or errno; *stage names the call that failed. */
static int bind_by_name(bus_socketcan_t *self, const char **stage)
{
    struct sockaddr_can address;
    struct ifreq request;

    memset(&request, 0, sizeof request);
    memcpy(request.ifr_name, self->name, sizeof self->name);
    *stage = "look-up";
    if (ioctl(self->bus.fd, SIOCGIFINDEX, &request) < 0) {
        return errno;
    }
    memset(&address, 0, sizeof address);
    address.can_family = AF_CAN;
    address.can_ifindex = request.ifr_ifindex;
    *stage = "bind";
    if (set_filters(self) < 0 ||
        bind(self->bus.fd, (const struct sockaddr *)&address, sizeof address) < 0) {
        return errno;
    }
    self->bound = true;
    return 0;
}

/* Does the interface exist and is it up? Binds again if it had vanished. This does not change the
 * statistics, so a short interruption counts once. */
static bool link_is_up(bus_socketcan_t *self)
{
    struct ifreq request;
    const char *stage;

    if (!self->bound && bind_by_name(self, &stage) != 0) {
        return false;
    }
    memset(&request, 0, sizeof request);
    memcpy(request.ifr_name, self->name, sizeof self->name);
    return ioctl(self->bus.fd, SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP);
}

static int socketcan_send(bus_t *bus, const bus_frame_t *frame)
{
    bus_socketcan_t *self = (bus_socketcan_t *)bus;
    struct can_frame out;
    ssize_t written;

    if (!bus_frame_valid(frame)) {
        bus->statistics.send_failed++;
        return bus_fail(bus, BUS_REFUSED, "frame %X of length %d is not a classic CAN frame",
                        (unsigned)frame->id, frame->length);
    }
    memset(&out, 0, sizeof out);
    out.can_id = frame->id | (frame->flags & BUS_FRAME_EXTENDED ? CAN_EFF_FLAG : 0) |
                 (frame->flags & BUS_FRAME_RTR ? CAN_RTR_FLAG : 0) |
                 (frame->flags & BUS_FRAME_ERROR ? CAN_ERR_FLAG : 0);
    out.len = frame->length;
    if (!(frame->flags & BUS_FRAME_RTR)) {
        memcpy(out.data, frame->data, frame->length);
    }
    do {
        written = write(bus->fd, &out, sizeof out);
    } while (written < 0 && errno == EINTR);
    if (written == (ssize_t)sizeof out) {
        bus->statistics.sent++;
        record_link_up(self);
        return BUS_OK;
    }
    if (written < 0 && (errno == ENOBUFS || errno == EAGAIN)) {
        bus->statistics.send_busy++;
        return bus_fail(bus, BUS_BUSY,
                        "the send queue of '%s' is full: is another node on the bus, with the same "
                        "bit rate? ('ip -details link show %s')",
                        self->name, self->name);
    }
    bus->statistics.send_failed++;
    if (written >= 0) {
        return bus_fail(bus, BUS_BROKEN, "'%s' took %zd bytes of a frame", self->name, written);
    }
    return record_errno(self, errno, "sending");
}

/* Reads the time of arrival and the number of lost frames, which come with the frame. */
static uint64_t read_control(bus_socketcan_t *self, struct msghdr *message, uint64_t now_us)
{
    uint64_t t_us = now_us;
    struct timespec stamp;
    uint32_t overrun;
    struct cmsghdr *control;

    for (control = CMSG_FIRSTHDR(message); control != NULL;
         control = CMSG_NXTHDR(message, control)) {
        if (control->cmsg_level != SOL_SOCKET) {
            continue;
        }
        if (control->cmsg_type == SCM_TIMESTAMPNS) {
            memcpy(&stamp, CMSG_DATA(control), sizeof stamp);
            t_us = stamp_to_us(self, &stamp, now_us);
        } else if (control->cmsg_type == SO_RXQ_OVFL) {
            memcpy(&overrun, CMSG_DATA(control), sizeof overrun);
            self->bus.statistics.dropped += (uint32_t)(overrun - self->overrun);
            self->overrun = overrun;
        }
    }
    return t_us;
}

static void store_frame(bus_socketcan_t *self, const struct can_frame *in, uint64_t t_us,
                        bus_frame_t *frame)
{
    const bool wide = in->can_id & (CAN_EFF_FLAG | CAN_ERR_FLAG);

    memset(frame, 0, sizeof *frame);
    frame->t_us = t_us;
    frame->id = in->can_id & (wide ? CAN_EFF_MASK : CAN_SFF_MASK);
    frame->length = in->len;
    frame->flags = (uint8_t)((in->can_id & CAN_EFF_FLAG ? BUS_FRAME_EXTENDED : 0) |
                             (in->can_id & CAN_RTR_FLAG ? BUS_FRAME_RTR : 0) |
                             (in->can_id & CAN_ERR_FLAG ? BUS_FRAME_ERROR : 0));
    if (!(frame->flags & BUS_FRAME_RTR)) {
        memcpy(frame->data, in->data, in->len);
    }
    self->bus.statistics.received++;
    if (frame->flags & BUS_FRAME_ERROR) {
        bus_note_error(&self->bus.statistics, frame);
    }
}

/* One recvmmsg for 1..BATCH frames. *read is its result; returns the number of good frames. */
static int receive_batch(bus_socketcan_t *self, bus_frame_t *frames, int asked, int *read)
{
    struct can_frame in[BATCH];
    _Alignas(struct cmsghdr) char control[BATCH][CONTROL];
    struct mmsghdr messages[BATCH];
    struct iovec vectors[BATCH];
    uint64_t now_us, t_us;
    int i, taken = 0;

    memset(in, 0, sizeof in);
    memset(messages, 0, sizeof messages);
    for (i = 0; i < asked; i++) {
        vectors[i].iov_base = &in[i];
        vectors[i].iov_len = sizeof in[i];
        messages[i].msg_hdr.msg_iov = &vectors[i];
        messages[i].msg_hdr.msg_iovlen = 1;
        messages[i].msg_hdr.msg_control = control[i];
        messages[i].msg_hdr.msg_controllen = sizeof control[i];
    }
    *read = recvmmsg(self->bus.fd, messages, (unsigned)asked, MSG_DONTWAIT, NULL);
    if (*read <= 0) {
        return 0;
    }
    now_us = read_clocks(self);
    for (i = 0; i < *read; i++) {
        t_us = read_control(self, &messages[i].msg_hdr, now_us);
        if (messages[i].msg_len != sizeof in[i] || in[i].len > CAN_MAX_DLEN) {
            self->bus.statistics.malformed++;
            continue;
        }
        store_frame(self, &in[i], t_us, &frames[taken]);
        taken++;
    }
    return taken;
}

static int socketcan_receive(bus_t *bus, bus_frame_t *frames, int capacity)
{
    bus_socketcan_t *self = (bus_socketcan_t *)bus;
    int taken = 0, read = 0, asked = 0, status = BUS_OK;

    if (self->broken) { /* found after the frames of the last call */
        return BUS_BROKEN;
    }
    do {
        asked = capacity - taken < BATCH ? capacity - taken : BATCH;
        taken += receive_batch(self, &frames[taken], asked, &read);
    } while (taken < capacity && (read == asked || (read < 0 && errno == EINTR)));
    if (read < 0 && errno != EAGAIN && errno != EINTR) {
        status = record_errno(self, errno, "receiving");
        self->broken = status == BUS_BROKEN;
    } else if (read < asked) {
        /* The queue is empty: later frames are stamped with this offset or a later one. */
        self->previous_offset_us = self->offset_us;
    }
    /* A frame does not prove that the interface is up: it may have been queued before. */
    if (status == BUS_OK && !bus->statistics.link_up) {
        if (link_is_up(self)) {
            record_link_up(self);
        } else {
            status = BUS_DOWN;
        }
    }
    return taken > 0 ? taken : status;
}

static uint64_t socketcan_now_us(bus_t *bus)
{
    (void)bus;
    return tick_now_us();
}

static int socketcan_close(bus_t *bus)
{
    if (bus->fd >= 0) {
        (void)close(bus->fd);
    }
    bus->fd = -1;
    return BUS_OK;
}

static int explain_socket(bus_t *bus, int error)
{
    switch (error) {
    case EAFNOSUPPORT:
    case EPROTONOSUPPORT:
        return bus_fail(bus, BUS_BROKEN,
                        "this kernel has no CAN: load it with 'modprobe can-raw', or use a kernel "
                        "built with CONFIG_CAN_RAW");
    case EPERM:
    case EACCES:
        return bus_fail(bus, BUS_BROKEN,
                        "no permission to open a CAN socket: run as root, or give the program "
                        "CAP_NET_RAW (setcap cap_net_raw=ep)");
    default:
        return bus_fail(bus, BUS_BROKEN, "cannot open a CAN socket: %s", strerror(error));
    }
}

static int explain_bind(bus_socketcan_t *self, int error, const char *stage)
{
    const char *name = self->name;

    if (error == ENODEV && stage[0] == 'l') {
        return bus_fail(&self->bus, BUS_BROKEN,
                        "there is no interface '%s': 'ip link' lists them; 'ip link add %s type "
                        "vcan' makes a virtual one",
                        name, name);
    }
    if (error == ENODEV) {
        return bus_fail(&self->bus, BUS_BROKEN,
                        "'%s' is not a CAN interface: 'ip link show type can' and '... type vcan' "
                        "list those",
                        name);
    }
    if (error == EPERM || error == EACCES) {
        return bus_fail(&self->bus, BUS_BROKEN,
                        "no permission to use '%s': run as root, or give the program CAP_NET_RAW",
                        name);
    }
    return bus_fail(&self->bus, BUS_BROKEN, "%s of '%s' failed: %s", stage, name, strerror(error));
}

/* Every kernel with CAN has the required options. */
static int set_options(bus_socketcan_t *self)
{
    const can_err_mask_t errors = CAN_ERR_MASK;
    const int on = 1, fd = self->bus.fd;
    int size = RECEIVE_BUFFER;
    socklen_t length = sizeof size;

    /* The first may exceed the system's limit and needs CAP_NET_ADMIN; the second is limited. */
    if (setsockopt(fd, SOL_SOCKET, SO_RCVBUFFORCE, &size, sizeof size) < 0) {
        (void)setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &size, sizeof size);
    }
    if (getsockopt(fd, SOL_SOCKET, SO_RCVBUF, &size, &length) == 0) {
        self->receive_buffer = size;
    }
    if (setsockopt(fd, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors) < 0 ||
        setsockopt(fd, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on) < 0 ||
        setsockopt(fd, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on) < 0) {
        return bus_fail(&self->bus, BUS_BROKEN, "cannot set up the CAN socket: %s",
                        strerror(errno));
    }
    return BUS_OK;
}

int bus_socketcan_open(bus_socketcan_t *self, const char *interface, const bus_filter_t *filters,
                       int count)
{
    bus_t *bus = &self->bus;
    const char *stage = "";
    size_t length = strlen(interface);
    int status;

    memset(self, 0, sizeof *self);
    bus->fd = -1;
    bus->send = socketcan_send;
    bus->receive = socketcan_receive;
    bus->now_us = socketcan_now_us;
    bus->close = socketcan_close;
    if (length == 0 || length >= sizeof self->name) {
        return bus_fail(bus, BUS_REFUSED, "'%.20s' is not an interface name (1 to 15 characters)",
                        interface);
    }
    if (count < 0 || count > BUS_FILTERS) {
        return bus_fail(bus, BUS_REFUSED, "%d filters; 0 to %d are possible", count, BUS_FILTERS);
    }
    memcpy(self->name, interface, length);
    self->filter_count = count;
    if (count > 0) {
        memcpy(self->filters, filters, (size_t)count * sizeof filters[0]);
    }
    bus->fd = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
    if (bus->fd < 0) {
        return explain_socket(bus, errno);
    }
    status = set_options(self);
    if (status == BUS_OK) {
        const int error = bind_by_name(self, &stage);

        status = error == 0 ? BUS_OK : explain_bind(self, error, stage);
    }
    if (status != BUS_OK) {
        (void)socketcan_close(bus);
        return status;
    }
    (void)read_clocks(self);
    self->previous_offset_us = self->offset_us;
    bus->statistics.link_up = link_is_up(self);
    return BUS_OK;
}
