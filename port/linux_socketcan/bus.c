/* Functions shared by all back ends. This file and bus_memory.c are plain C, for any system. */
#include "bus.h"

#include <stdarg.h>
#include <stdio.h>

#ifdef __linux__
#include <linux/can.h>
#include <linux/can/error.h>
#else /* the same numbers */
enum { CAN_SFF_MASK = 0x7FF, CAN_EFF_MASK = 0x1FFFFFFF, CAN_MAX_DLEN = 8 };
enum { CAN_ERR_CRTL = 0x4, CAN_ERR_BUSOFF = 0x40, CAN_ERR_RESTARTED = 0x100 };
enum {
    CAN_ERR_CRTL_RX_WARNING = 0x04,
    CAN_ERR_CRTL_TX_WARNING = 0x08,
    CAN_ERR_CRTL_RX_PASSIVE = 0x10,
    CAN_ERR_CRTL_TX_PASSIVE = 0x20,
    CAN_ERR_CRTL_ACTIVE = 0x40,
};
#endif

bool bus_frame_valid(const bus_frame_t *frame)
{
    uint32_t highest = CAN_SFF_MASK;

    if (frame->flags & (BUS_FRAME_EXTENDED | BUS_FRAME_ERROR)) {
        highest = CAN_EFF_MASK;
    }
    return frame->length <= CAN_MAX_DLEN && frame->id <= highest;
}

void bus_note_error(bus_statistics_t *statistics, const bus_frame_t *frame)
{
    const uint8_t controller = frame->id & CAN_ERR_CRTL ? frame->data[1] : 0;

    statistics->error_frames++;
    if (controller & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) {
        statistics->passives++;
        statistics->state = BUS_PASSIVE;
    } else if (controller & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) {
        statistics->state = BUS_WARNING;
    } else if (controller & CAN_ERR_CRTL_ACTIVE) {
        statistics->state = BUS_ACTIVE;
    }
    if (frame->id & CAN_ERR_RESTARTED) {
        statistics->restarts++;
        statistics->state = BUS_ACTIVE;
    }
    if (frame->id & CAN_ERR_BUSOFF) {
        statistics->bus_offs++;
        statistics->state = BUS_OFF;
    }
}

int bus_fail(bus_t *bus, int status, const char *format, ...)
{
    va_list arguments;

    va_start(arguments, format);
    (void)vsnprintf(bus->text, sizeof bus->text, format, arguments);
    va_end(arguments);
    return status;
}
