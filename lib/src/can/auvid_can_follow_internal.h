/**
 * @file auvid_can_follow_internal.h
 * Private: the verdict on an authentic frame by its counter.
 */
#ifndef AUVID_CAN_FOLLOW_INTERNAL_H
#define AUVID_CAN_FOLLOW_INTERNAL_H

#include "auvid/can.h"

/** Counters of a message: it has four bits. */
#define COUNTERS 16u

/** Compares the counter of a frame with that of the frame before, and stores it.
 * @param last counter of the frame before; written
 * @param started there was one; written
 * @param lost increased by the frames that are missing between the two, if the result is AUVID_OK
 * @return AUVID_OK (also the first frame); AUVID_ERR_REPEATED; AUVID_ERR_COUNTER_JUMP */
static inline auvid_status_t auvid_can_follow(uint8_t *last, bool *started, uint8_t counter,
                                              uint32_t *lost)
{
    uint32_t step = (uint32_t)(counter - *last) % COUNTERS;
    bool first = !*started;
    *last = counter;
    *started = true;
    if (first) {
        return AUVID_OK;
    }
    if (step > AUVID_CAN_LARGEST_STEP) {
        return AUVID_ERR_COUNTER_JUMP;
    }
    *lost += step > 0 ? step - 1u : 0u;
    return step == 0 ? AUVID_ERR_REPEATED : AUVID_OK;
}

#endif
