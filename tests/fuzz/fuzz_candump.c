/*
 * libFuzzer: random bytes as a candump log. Every frame read can be written, and is read back
 * unchanged.
 */
#define _POSIX_C_SOURCE 200809L
#include "bus_candump.h"

#include "fuzz_frames.h"

enum { TEXT = 128, MOST = 64 };

/* Opens a log in memory. */
static void open_memory(bus_candump_t *log, void *bytes, size_t size, const char *mode)
{
    int status = mode[0] == 'w' ? bus_candump_create(log, "/dev/null", "can0", 0)
                                : bus_candump_open(log, "/dev/null", NULL);
    REQUIRE(status == BUS_OK);
    fclose(log->file);
    log->file = fmemopen(bytes, size, mode);
    REQUIRE(log->file != NULL);
}

static void check_round_trip(const bus_frame_t *frame)
{
    bus_candump_t log;
    bus_frame_t again;
    char line[TEXT];
    open_memory(&log, line, sizeof line, "w");
    REQUIRE(bus_frame_valid(frame) && log.bus.send(&log.bus, frame) == BUS_OK);
    REQUIRE(log.bus.close(&log.bus) == BUS_OK);
    open_memory(&log, line, strlen(line), "r");
    REQUIRE(log.bus.receive(&log.bus, &again, 1) == 1);
    REQUIRE(again.t_us == frame->t_us && again.id == frame->id && again.flags == frame->flags);
    REQUIRE(again.length == frame->length && memcmp(again.data, frame->data, 8) == 0);
    log.bus.close(&log.bus);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char copy[4096];
    bus_candump_t log;
    bus_frame_t frame[MOST];
    if (size == 0 || size > sizeof copy) {
        return 0;
    }
    memcpy(copy, data, size);
    open_memory(&log, copy, size, "r");
    int count = log.bus.receive(&log.bus, frame, MOST);
    for (int i = 0; i < count; ++i) {
        check_round_trip(&frame[i]);
    }
    if (count == BUS_BROKEN) {
        REQUIRE(log.bus.text[0] != '\0' && strchr(log.bus.text, '\n') == NULL);
    }
    log.bus.close(&log.bus);
    return 0;
}
