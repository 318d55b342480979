/* Logs of `candump -L`. The format: sprint_canframe() and log2asc of can-utils. */
#define _GNU_SOURCE
#include "bus_candump.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/can.h>
#include <string.h>
#include <unistd.h>

enum { LINE = 256 }; /* the longest valid line, that of a CAN FD frame, has 190 characters */

static const char hex_digits[] = "0123456789ABCDEF";

/* Reads the value of `count` digits and moves *at past them. Returns false if there are fewer. */
static bool read_hex(const char **at, int count, uint32_t *value)
{
    int i;

    *value = 0;
    for (i = 0; i < count; i++) {
        const char c = (*at)[i];

        if (c >= '0' && c <= '9') {
            *value = *value << 4 | (uint32_t)(c - '0');
        } else if ((c >= 'A' && c <= 'F') || (c >= 'a' && c <= 'f')) {
            *value = *value << 4 | (uint32_t)((c & 15) + 9);
        } else {
            return false;
        }
    }
    *at += count;
    return true;
}

/* Reads up to `max_digits` decimal digits. Returns their number. */
static int read_decimal(const char **at, int max_digits, uint64_t *value)
{
    int i = 0;

    *value = 0;
    while (i < max_digits && (*at)[i] >= '0' && (*at)[i] <= '9') {
        *value = *value * 10 + (uint64_t)((*at)[i] - '0');
        i++;
    }
    *at += i;
    return i;
}

/* Reads "(seconds.micros) name ". Returns NULL, or what is wrong with it. */
static const char *read_head(const char **at, uint64_t *t_us, char name[16])
{
    static const char foreign[] = "is not a line of 'candump -L': (seconds.micros) name id#data";
    uint64_t seconds, micros;
    size_t length;

    if (*(*at)++ != '(' || read_decimal(at, 12, &seconds) == 0 || *(*at)++ != '.' ||
        read_decimal(at, 6, &micros) != 6 || *(*at)++ != ')' || *(*at)++ != ' ') {
        return foreign;
    }
    length = strcspn(*at, " ");
    if (length == 0 || length > 15 || (*at)[length] != ' ') {
        return foreign;
    }
    memcpy(name, *at, length);
    name[length] = '\0';
    *at += length + 1;
    *t_us = seconds * 1000000U + micros;
    return NULL;
}

/* Is this the end of a line, perhaps after " R" or " T"? */
static bool is_end(const char *at)
{
    return at[at[0] == ' ' && (at[1] == 'R' || at[1] == 'T') ? 2 : 0] == '\0';
}

/* Skips flags and data of a CAN FD frame. */
static const char *skip_fd(const char *at)
{
    uint32_t flags, byte;
    int bytes = 0;

    if (!read_hex(&at, 1, &flags)) {
        return "holds a CAN FD frame without flags";
    }
    while (bytes < 64 && read_hex(&at, 2, &byte)) {
        bytes++;
    }
    return is_end(at) ? NULL : "has CAN FD data that is not 0 to 64 bytes of two digits";
}

/* Reads "id#data", perhaps with a trailing " R" or " T". Returns NULL, or what is wrong with it.
 * Sets *fd for "id##flags data", which is not stored. */
static const char *read_frame(const char *at, bus_frame_t *frame, bool *fd)
{
    const size_t digits = strcspn(at, "#");
    uint32_t id, byte;

    if ((digits != 3 && digits != 8) || !read_hex(&at, (int)digits, &id) || *at++ != '#') {
        return "has no id of 3 or 8 digits before a '#'";
    }
    *fd = *at == '#';
    if (id & CAN_RTR_FLAG || (digits == 3 && id > CAN_SFF_MASK) ||
        (id & CAN_EFF_FLAG && digits == 8)) {
        return "has an id that no frame can have";
    }
    if (*fd) {
        return skip_fd(at + 1);
    }
    if (id & CAN_ERR_FLAG) {
        frame->flags = BUS_FRAME_ERROR;
    } else if (digits == 8) {
        frame->flags = BUS_FRAME_EXTENDED;
    }
    frame->id = id & CAN_EFF_MASK;
    if (*at == 'R') {
        frame->flags |= BUS_FRAME_RTR;
        at++;
        if (*at >= '0' && *at <= '8') {
            frame->length = (uint8_t)(*at++ - '0');
        }
    }
    while (!(frame->flags & BUS_FRAME_RTR) && frame->length < 8 && read_hex(&at, 2, &byte)) {
        frame->data[frame->length++] = (uint8_t)byte;
    }
    return is_end(at) ? NULL : "has data that is not 0 to 8 bytes of two digits";
}

/* Reads up to the next frame of the interface. Returns 1, 0 at the end, or a status. */
static int read_next(bus_candump_t *self, bus_frame_t *frame)
{
    char line[LINE], name[16];

    while (fgets(line, sizeof line, self->file) != NULL) {
        const char *at = line, *wrong = "is not a line of 'candump -L'";
        size_t length = strlen(line);
        bool fd = false;

        self->line++;
        memset(frame, 0, sizeof *frame);
        if (length > 0 && line[length - 1] == '\n') {
            length -= length > 1 && line[length - 2] == '\r' ? 2 : 1;
            line[length] = '\0';
            wrong = read_head(&at, &frame->t_us, name);
            if (wrong == NULL) {
                wrong = read_frame(at, frame, &fd);
            }
        } else if (feof(self->file) && !ferror(self->file)) {
            return bus_fail(&self->bus, 0, "%s:%llu: the last line is truncated and is ignored",
                            self->path, (unsigned long long)self->line);
        }
        if (wrong != NULL) {
            self->bus.statistics.malformed++;
            return bus_fail(&self->bus, BUS_BROKEN, "%s:%llu: %s", self->path,
                            (unsigned long long)self->line, wrong);
        }
        self->fd_frames += fd;
        if (!fd && (self->interface[0] == '\0' || strcmp(self->interface, name) == 0)) {
            return 1;
        }
    }
    if (ferror(self->file)) {
        return bus_fail(&self->bus, BUS_BROKEN, "cannot read %s: %s", self->path, strerror(errno));
    }
    if (self->line == 0) {
        return bus_fail(&self->bus, BUS_BROKEN, "%s is empty; record one with 'candump -L'",
                        self->path);
    }
    return 0;
}

static int candump_receive(bus_t *bus, bus_frame_t *frames, int capacity)
{
    bus_candump_t *self = (bus_candump_t *)bus;
    int taken = 0, status = 1;

    if (self->writing) {
        return bus_fail(bus, BUS_REFUSED, "%s is open for writing", self->path);
    }
    /* Nothing is read after a bad line: the rest of the log is not reliable. */
    while (taken < capacity && bus->statistics.malformed == 0) {
        status = read_next(self, &frames[taken]);
        if (status != 1) {
            break;
        }
        if (frames[taken].flags & BUS_FRAME_ERROR) {
            bus_note_error(&bus->statistics, &frames[taken]);
        }
        if (frames[taken].t_us > self->now_us) {
            self->now_us = frames[taken].t_us;
        }
        taken++;
    }
    bus->statistics.received += (uint64_t)taken;
    if (taken > 0) {
        return taken;
    }
    return bus->statistics.malformed > 0 || status < 0 ? BUS_BROKEN : BUS_END;
}

static int candump_send(bus_t *bus, const bus_frame_t *frame)
{
    bus_candump_t *self = (bus_candump_t *)bus;
    const bool wide = frame->flags & (BUS_FRAME_EXTENDED | BUS_FRAME_ERROR);
    const uint32_t id = frame->id | (frame->flags & BUS_FRAME_ERROR ? CAN_ERR_FLAG : 0);
    const uint64_t t_us = frame->t_us + self->offset_us;
    char data[2 * 8 + 1];
    int i, n = 0;

    if (!self->writing || !bus_frame_valid(frame)) {
        bus->statistics.send_failed++;
        return bus_fail(bus, BUS_REFUSED, "%s: %s", self->path,
                        self->writing ? "this is not a classic CAN frame" : "is open for reading");
    }
    if (frame->flags & BUS_FRAME_RTR) {
        data[n++] = 'R';
        if (frame->length > 0) {
            data[n++] = (char)('0' + frame->length);
        }
    } else {
        for (i = 0; i < frame->length; i++) {
            data[n++] = hex_digits[frame->data[i] >> 4];
            data[n++] = hex_digits[frame->data[i] & 15];
        }
    }
    data[n] = '\0';
    if (fprintf(self->file, "(%010llu.%06u) %s %0*X#%s\n", (unsigned long long)(t_us / 1000000U),
                (unsigned)(t_us % 1000000U), self->interface, wide ? 8 : 3, (unsigned)id,
                data) < 0) {
        bus->statistics.send_failed++;
        return bus_fail(bus, BUS_BROKEN, "cannot write %s: %s", self->path, strerror(errno));
    }
    self->line++;
    self->now_us = frame->t_us;
    bus->statistics.sent++;
    return BUS_OK;
}

static uint64_t candump_now_us(bus_t *bus)
{
    return ((const bus_candump_t *)bus)->now_us;
}

static int candump_close(bus_t *bus)
{
    bus_candump_t *self = (bus_candump_t *)bus;
    FILE *file = self->file;

    self->file = NULL;
    if (file != NULL && fclose(file) != 0 && self->writing) {
        return bus_fail(bus, BUS_BROKEN, "cannot write %s: %s", self->path, strerror(errno));
    }
    return BUS_OK;
}

static int open_log(bus_candump_t *self, const char *path, const char *interface, bool writing)
{
    bus_t *bus = &self->bus;
    int fd;

    memset(self, 0, sizeof *self);
    bus->fd = -1;
    bus->send = candump_send;
    bus->receive = candump_receive;
    bus->now_us = candump_now_us;
    bus->close = candump_close;
    bus->statistics.link_up = true;
    self->path = path;
    self->writing = writing;
    if (interface != NULL) {
        if (strlen(interface) >= sizeof self->interface || interface[0] == '\0' ||
            strchr(interface, ' ') != NULL) {
            return bus_fail(bus, BUS_REFUSED,
                            "'%.20s' is not an interface name (1 to 15 characters)", interface);
        }
        memcpy(self->interface, interface, strlen(interface));
    }
    /* A pipe that nobody reads must not stop the program. */
    fd = open(path, O_CLOEXEC | (writing ? O_WRONLY | O_CREAT | O_TRUNC | O_NONBLOCK : O_RDONLY),
              0666);
    self->file = fd < 0 ? NULL : fdopen(fd, writing ? "w" : "r");
    if (self->file == NULL) {
        const int error = errno;

        if (fd >= 0) {
            (void)close(fd);
        }
        errno = error;
        if (writing && errno == ENXIO) {
            return bus_fail(bus, BUS_BROKEN, "cannot write %s: start the reader of the pipe first",
                            path);
        }
        return bus_fail(bus, BUS_BROKEN, "cannot %s %s: %s", writing ? "create" : "open", path,
                        strerror(errno));
    }
    return BUS_OK;
}

int bus_candump_open(bus_candump_t *self, const char *path, const char *interface)
{
    return open_log(self, path, interface, false);
}

int bus_candump_create(bus_candump_t *self, const char *path, const char *interface,
                       uint64_t offset_us)
{
    const int status = open_log(self, path, interface == NULL ? "" : interface, true);

    if (status == BUS_OK) {
        self->offset_us = offset_us;
        (void)setvbuf(self->file, NULL, _IOLBF, BUFSIZ);
    }
    return status;
}

void bus_candump_wait(bus_candump_t *self)
{
    const int fd = fileno(self->file), flags = fcntl(fd, F_GETFL);

    (void)fcntl(fd, F_SETFL, flags & ~O_NONBLOCK);
}
