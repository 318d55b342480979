/*
 * The queue between interrupt and task. `pushed` and `popped` wrap; their difference is the number
 * of queued frames, because size divides 2^32.
 */
#include "auvid/can.h"

#include <string.h>

#include "auvid_can_table_internal.h"
#include "../base/auvid_math_internal.h"

#ifndef AUVID_CAN_BARRIER
#if defined(__GNUC__)
#define AUVID_CAN_BARRIER() __atomic_thread_fence(__ATOMIC_SEQ_CST)
#else
#error "auvid: define AUVID_CAN_BARRIER() for this compiler (see can.h)"
#endif
#endif

auvid_status_t auvid_can_fifo_init(auvid_can_fifo_t *fifo, auvid_can_frame_t *storage,
                                   uint32_t size)
{
    if (fifo == NULL || storage == NULL) {
        return AUVID_ERR_NULL;
    }
    if (size < 2 || size > AUVID_CAN_FIFO_LARGEST || (size & (size - 1u)) != 0) {
        return AUVID_ERR_RANGE;
    }
    memset(fifo, 0, sizeof *fifo);
    fifo->frame = storage;
    fifo->size = size;
    auvid_can_ids_defaults(&fifo->ids);
    return AUVID_OK;
}

static bool can_fifo_is_abort(const auvid_can_fifo_t *fifo, const auvid_can_frame_t *frame)
{
    return frame->id == fifo->ids.fast + AUVID_CAN_ABORT && frame->length == AUVID_CAN_BYTES &&
           frame->data[0] == auvid_can_crc(frame->data, AUVID_CAN_DATA_ID(AUVID_CAN_ABORT));
}

auvid_status_t auvid_can_fifo_push(auvid_can_fifo_t *fifo, const auvid_can_frame_t *frame)
{
    if (fifo == NULL || frame == NULL) {
        return AUVID_ERR_NULL;
    }
    if (fifo->size == 0) {
        return AUVID_ERR_STATE;
    }
    uint32_t at = fifo->pushed;
    auvid_can_frame_t *slot = &fifo->frame[at & (fifo->size - 1u)];
    bool abort = can_fifo_is_abort(fifo, frame);
    if (abort) {
        fifo->before = at;
        slot = &fifo->abort;
        AUVID_CAN_BARRIER(); /* the consumer of a pending abort sees this `before` */
        if (fifo->aborts != fifo->aborted) {
            return AUVID_OK; /* the pending abort stands for both */
        }
    } else if (at - fifo->popped >= fifo->size) {
        fifo->dropped = fifo->dropped + 1u;
        return AUVID_ERR_FULL;
    }
    AUVID_CAN_BARRIER(); /* the slot was read before it is overwritten */
    *slot = *frame;
    AUVID_CAN_BARRIER(); /* the frame is written before it is published */
    if (abort) {
        fifo->aborts = fifo->aborts + 1u;
    } else {
        fifo->pushed = at + 1u;
    }
    return AUVID_OK;
}

static void can_fifo_pop_abort(auvid_can_fifo_t *fifo, auvid_can_frame_t *frame)
{
    AUVID_CAN_BARRIER();
    *frame = fifo->abort;
    AUVID_CAN_BARRIER(); /* read before another one may be stored */
    fifo->aborted = fifo->aborted + 1u;
    AUVID_CAN_BARRIER(); /* `aborted` is written before `before` is read: see push */
    fifo->older = fifo->before - fifo->popped;
}

auvid_status_t auvid_can_fifo_pop(auvid_can_fifo_t *fifo, auvid_can_frame_t *frame)
{
    if (fifo == NULL || frame == NULL) {
        return AUVID_ERR_NULL;
    }
    if (fifo->size == 0) {
        return AUVID_ERR_STATE;
    }
    uint32_t older;
    do { /* at most size times */
        uint32_t at = fifo->popped, pushed = fifo->pushed;
        AUVID_CAN_BARRIER(); /* no frame before `pushed` is younger than an abort not seen below */
        if (fifo->aborted != fifo->aborts) {
            can_fifo_pop_abort(fifo, frame);
            return AUVID_OK;
        }
        if (at == pushed) {
            return AUVID_EMPTY;
        }
        AUVID_CAN_BARRIER(); /* published before it is read */
        *frame = fifo->frame[at & (fifo->size - 1u)];
        AUVID_CAN_BARRIER(); /* read before the slot is free */
        fifo->popped = at + 1u;
        older = fifo->older;
        fifo->older = older - (older > 0);
    } while (older > 0 && frame->id == fifo->ids.fast + AUVID_CAN_ARM);
    return AUVID_OK;
}
