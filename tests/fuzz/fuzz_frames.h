/*
 * Random bytes as frames, 11 bytes per frame. One selects the identifier, one the time since the
 * last frame, one whether the checksum is corrected (a fuzzer cannot guess it); eight are data.
 */
#ifndef FUZZ_FRAMES_H
#define FUZZ_FRAMES_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "auvid/can.h"
#include "can/auvid_can_table_internal.h"

enum { RECORD = 11, FRAMES = 32 };

#define REQUIRE(condition) ((condition) ? (void)0 : fail(__FILE__, __LINE__, #condition))

static inline void fail(const char *file, int line, const char *what)
{
    fprintf(stderr, "%s:%d: not %s\n", file, line, what);
    abort();
}

/* Makes a frame from a record and advances *now_us. Identifiers are in or near both blocks. */
static inline void read_record(const uint8_t *record, auvid_can_frame_t *frame, uint64_t *now_us)
{
    memset(frame, 0, sizeof *frame);
    frame->id = (uint16_t)(record[0] < 8 ? 0x3E + record[0] : 0x3FD + record[0] % 24);
    *now_us += record[1] * 1000u;
    frame->t_us = *now_us;
    frame->length = (record[2] & 0x80u) != 0 ? record[2] & 0x1Fu : AUVID_CAN_BYTES;
    memcpy(frame->data, record + 3, sizeof frame->data);
    auvid_can_kind_t kind = auvid_can_kind(NULL, frame->id);
    if ((record[2] & 1u) != 0 && kind != AUVID_CAN_KINDS) {
        frame->data[0] = auvid_can_crc(frame->data, AUVID_CAN_DATA_ID(kind));
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#endif
