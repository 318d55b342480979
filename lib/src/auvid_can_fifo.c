/*
 * The queue between interrupt and task. `pushed` and `popped` run freely; their difference is the
 * number of frames inside, because size divides 2^32.
 */
#include "auvid/can_fifo.h"

#include "auvid_math.h"

auvid_status_t auvid_can_fifo_init(auvid_can_fifo_t *fifo, auvid_can_frame_t *storage,
                                   uint32_t size)
{
    if (fifo == NULL || storage == NULL) {
        return AUVID_ERR_NULL;
    }
    if (size < 2 || size > AUVID_CAN_FIFO_LARGEST || (size & (size - 1u)) != 0) {
        return AUVID_ERR_RANGE;
    }
    fifo->frame = storage;
    fifo->size = size;
    fifo->pushed = 0;
    fifo->popped = 0;
    fifo->dropped = 0;
    return AUVID_OK;
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
    if (at - fifo->popped >= fifo->size) {
        fifo->dropped = fifo->dropped + 1u;
        return AUVID_ERR_LIMIT;
    }
    AUVID_CAN_BARRIER(); /* the place was read before it is written again */
    fifo->frame[at & (fifo->size - 1u)] = *frame;
    AUVID_CAN_BARRIER(); /* the frame is there before it is announced */
    fifo->pushed = at + 1u;
    return AUVID_OK;
}

auvid_status_t auvid_can_fifo_pop(auvid_can_fifo_t *fifo, auvid_can_frame_t *frame)
{
    if (fifo == NULL || frame == NULL) {
        return AUVID_ERR_NULL;
    }
    if (fifo->size == 0) {
        return AUVID_ERR_STATE;
    }
    uint32_t at = fifo->popped;
    if (at == fifo->pushed) {
        return AUVID_EMPTY;
    }
    AUVID_CAN_BARRIER(); /* announced before it is read */
    *frame = fifo->frame[at & (fifo->size - 1u)];
    AUVID_CAN_BARRIER(); /* read before the place is free */
    fifo->popped = at + 1u;
    return AUVID_OK;
}
