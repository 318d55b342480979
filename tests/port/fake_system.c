/* See fake_system.h. The Makefile finds the functions to wrap by their names in this file. */
#include "fake_system.h"

#include <errno.h>
#include <fcntl.h>
#include <net/if.h>
#include <sched.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/timerfd.h>
#include <time.h>
#include <unistd.h>

fake_t fake;

static int fails(int error)
{
    if (error != 0) {
        errno = error;
        return -1;
    }
    return 0;
}

fake_incoming_t *fake_arrives(uint32_t can_id, uint8_t first_byte)
{
    fake_incoming_t *in = &fake.incoming[fake.arrived++];

    memset(in, 0, sizeof *in);
    in->frame.can_id = can_id;
    in->frame.len = 8;
    in->frame.data[0] = first_byte;
    in->length = sizeof in->frame;
    return in;
}

void fake_arrives_error(int error)
{
    fake_arrives(0, 0)->error = error;
}

int __wrap_socket(int domain, int type, int protocol)
{
    (void)domain;
    (void)type;
    (void)protocol;
    return fake.socket_error != 0 ? fails(fake.socket_error) : open("/dev/null", O_RDWR);
}

int __real_close(int fd);
int __wrap_close(int fd)
{
    fake.closes++;
    return __real_close(fd);
}

int __wrap_bind(int fd, const struct sockaddr *address, socklen_t length)
{
    (void)fd;
    assert_int_equal(address->sa_family, AF_CAN);
    assert_int_equal(((const struct sockaddr_can *)address)->can_ifindex, 7);
    assert_int_equal(length, sizeof(struct sockaddr_can));
    fake.binds++;
    return fails(fake.bind_error);
}

int __wrap_ioctl(int fd, unsigned long request, ...)
{
    va_list arguments;
    struct ifreq *interface;

    (void)fd;
    va_start(arguments, request);
    interface = va_arg(arguments, struct ifreq *);
    va_end(arguments);
    assert_string_equal(interface->ifr_name, "can0");
    if (fake.index_error != 0) {
        return fails(fake.index_error);
    }
    if (request == SIOCGIFINDEX) {
        interface->ifr_ifindex = 7;
    } else {
        assert_int_equal(request, SIOCGIFFLAGS);
        interface->ifr_flags = fake.interface_flags;
    }
    return 0;
}

int __wrap_setsockopt(int fd, int level, int option, const void *value, socklen_t length)
{
    (void)fd;
    if (level == SOL_SOCKET && option == SO_RCVBUFFORCE && fake.force_error != 0) {
        return fails(fake.force_error);
    }
    if (level == SOL_SOCKET && (option == SO_RCVBUFFORCE || option == SO_RCVBUF)) {
        memcpy(&fake.receive_buffer, value, sizeof fake.receive_buffer);
        if (option == SO_RCVBUF && fake.receive_buffer > 200000) {
            fake.receive_buffer = 200000; /* the system's limit */
        }
        return 0;
    }
    if (level == SOL_CAN_RAW && option == CAN_RAW_FILTER) {
        assert_in_range(length, 1, sizeof fake.filters);
        memcpy(fake.filters, value, length);
        fake.filter_count = (int)(length / sizeof fake.filters[0]);
    } else if (level == SOL_CAN_RAW && option == CAN_RAW_ERR_FILTER) {
        memcpy(&fake.error_mask, value, sizeof fake.error_mask);
    } else if (level == SOL_SOCKET && option == SO_TIMESTAMPNS) {
        fake.stamps = true;
    } else if (level == SOL_SOCKET && option == SO_RXQ_OVFL) {
        fake.overruns = true;
    }
    return fails(fake.option_error);
}

int __wrap_getsockopt(int fd, int level, int option, void *value, socklen_t *length)
{
    (void)fd;
    (void)level;
    assert_int_equal(option, SO_RCVBUF);
    assert_int_equal(*length, sizeof(int));
    memcpy(value, &(int){2 * fake.receive_buffer}, sizeof(int)); /* the kernel doubles it */
    return 0;
}

ssize_t __real_write(int fd, const void *bytes, size_t size);
ssize_t __wrap_write(int fd, const void *bytes, size_t size)
{
    if (size != sizeof fake.written) {
        return __real_write(fd, bytes, size);
    }
    fake.writes++;
    if (fake.write_errors != 0) {
        fake.write_errors -= fake.write_errors > 0;
        return fails(fake.write_error);
    }
    memcpy(&fake.written, bytes, size);
    return fake.write_short != 0 ? fake.write_short : (ssize_t)size;
}

static void add_control(struct msghdr *message, struct cmsghdr **at, int type, const void *value,
                        size_t size)
{
    (*at)->cmsg_level = SOL_SOCKET;
    (*at)->cmsg_type = type;
    (*at)->cmsg_len = CMSG_LEN(size);
    memcpy(CMSG_DATA(*at), value, size);
    message->msg_controllen += CMSG_SPACE(size);
    *at = (struct cmsghdr *)((char *)*at + CMSG_SPACE(size));
}

static void fill(struct mmsghdr *message, const fake_incoming_t *in)
{
    struct cmsghdr *at = message->msg_hdr.msg_control;
    const struct timespec stamp = {(time_t)(in->wall_us / 1000000),
                                   (long)(in->wall_us % 1000000) * 1000};
    const size_t room = message->msg_hdr.msg_controllen;

    assert_int_equal(message->msg_hdr.msg_iov->iov_len, sizeof in->frame);
    memcpy(message->msg_hdr.msg_iov->iov_base, &in->frame, in->length);
    message->msg_len = in->length;
    message->msg_hdr.msg_controllen = 0;
    if (in->overrun != 0) {
        add_control(&message->msg_hdr, &at, SO_RXQ_OVFL, &in->overrun, sizeof in->overrun);
    }
    if (in->wall_us != 0) {
        add_control(&message->msg_hdr, &at, SCM_TIMESTAMPNS, &stamp, sizeof stamp);
    }
    assert_in_range(message->msg_hdr.msg_controllen, 0, room);
}

/* Like the kernel: the next call returns an error that follows messages. */
int __wrap_recvmmsg(int fd, struct mmsghdr *messages, unsigned count, int flags,
                    struct timespec *timeout)
{
    unsigned i;

    (void)fd;
    (void)timeout;
    assert_true(flags & MSG_DONTWAIT);
    fake.receives++;
    for (i = 0; i < count && fake.read < fake.arrived; i++) {
        const fake_incoming_t *in = &fake.incoming[fake.read];

        if (in->error != 0) {
            if (i > 0) {
                return (int)i;
            }
            fake.read++;
            return fails(in->error);
        }
        fill(&messages[i], in);
        fake.read++;
    }
    return i > 0 ? (int)i : fails(EAGAIN);
}

int __real_clock_gettime(clockid_t clock, struct timespec *t);
int __wrap_clock_gettime(clockid_t clock, struct timespec *t)
{
    uint64_t us;

    if (!fake.clocks) {
        return __real_clock_gettime(clock, t);
    }
    if (clock == CLOCK_REALTIME) {
        fake.wall_us += fake.pause_us;
        fake.monotonic_us += fake.pause_us;
        fake.pause_us = 0;
    }
    us = clock == CLOCK_REALTIME ? fake.wall_us : fake.monotonic_us;
    t->tv_sec = (time_t)(us / 1000000);
    t->tv_nsec = (long)(us % 1000000) * 1000;
    return 0;
}

int __real_timerfd_create(int clock, int flags);
int __wrap_timerfd_create(int clock, int flags)
{
    fake.clock_id = clock;
    return fake.timer_error != 0 ? fails(fake.timer_error) : __real_timerfd_create(clock, flags);
}

int __real_timerfd_settime(int fd, int flags, const struct itimerspec *value,
                           struct itimerspec *old);
int __wrap_timerfd_settime(int fd, int flags, const struct itimerspec *value,
                           struct itimerspec *old)
{
    fake.timer_flags = flags;
    return __real_timerfd_settime(fd, flags, value, old);
}

ssize_t __real_read(int fd, void *bytes, size_t size);
ssize_t __wrap_read(int fd, void *bytes, size_t size)
{
    if (fake.expirations != 0 && size == sizeof fake.expirations) {
        memcpy(bytes, &fake.expirations, size);
        fake.expirations = 0;
        return (ssize_t)size;
    }
    return __real_read(fd, bytes, size);
}

int __real_epoll_wait(int fd, struct epoll_event *events, int most, int timeout);
int __wrap_epoll_wait(int fd, struct epoll_event *events, int most, int timeout)
{
    return fake.epoll_error != 0 ? fails(fake.epoll_error)
                                 : __real_epoll_wait(fd, events, most, timeout);
}

int __wrap_sched_setscheduler(pid_t pid, int policy, const struct sched_param *parameters)
{
    (void)pid;
    assert_int_equal(policy, SCHED_FIFO);
    assert_int_equal(parameters->sched_priority, 40);
    return fails(fake.scheduler_error);
}

int __wrap_mlockall(int flags)
{
    assert_int_equal(flags, MCL_CURRENT | MCL_FUTURE);
    return fails(fake.lock_error);
}
