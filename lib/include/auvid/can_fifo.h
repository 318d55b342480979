/**
 * @file can_fifo.h
 * A queue of frames from one producer to one consumer: from the receive interrupt to the task.
 *
 * The only part of auvid that may be called from an interrupt: push in the interrupt, pop in the
 * task (or the other way round), each from one place only. No locks, no atomic read-modify-write:
 * each index is written by one side. Neither side ever waits; what does not fit is dropped and
 * counted, the newest first.
 *
 * An abort (length and checksum right) is never dropped and takes no place: push sets it aside, and
 * the next pop gives it before any frame that waits. Arm frames that came before it are then left
 * out: an order to disarm or to arm must not outlast the abort that followed it. Several aborts may
 * become one.
 *
 * AUVID_CAN_BARRIER() keeps the frame's bytes on the right side of the index that publishes them,
 * for the compiler and, between two cores, for the memory. With gcc and clang it is a full fence
 * that needs no library (dmb on ARM). Other compilers must define it: a compiler barrier suffices
 * where producer and consumer run on one core. An aligned 32-bit load or store must be one access,
 * as it is on every target with a CAN controller of 32 bits.
 *
 * Cost: a copy of 24 bytes and 20 instructions each; an abort also its checksum. Memory: the
 * caller's, one frame each place.
 */
#ifndef AUVID_CAN_FIFO_H
#define AUVID_CAN_FIFO_H

#include "auvid/can.h"

#ifdef __cplusplus
extern "C" {
#endif

#ifndef AUVID_CAN_BARRIER
#if defined(__GNUC__)
#define AUVID_CAN_BARRIER() __atomic_thread_fence(__ATOMIC_SEQ_CST)
#else
#error "auvid: define AUVID_CAN_BARRIER() for this compiler (see can_fifo.h)"
#endif
#endif

/** Most frames a queue may hold. */
#define AUVID_CAN_FIFO_LARGEST 0x8000u

/** Written by the functions. */
typedef struct {
    auvid_can_frame_t *frame;  /* the caller's */
    uint32_t size;             /* power of two; 0: not initialised */
    volatile uint32_t pushed;  /* frames ever put in; wraps. Written by the producer */
    volatile uint32_t popped;  /* frames ever taken out; wraps. Written by the consumer */
    volatile uint32_t dropped; /**< frames that found no room; wraps. Written by the producer */
    auvid_can_ids_t ids;       /**< init: defaults. Others are written before either side begins */
    auvid_can_frame_t abort;   /* set aside while the next two differ */
    volatile uint32_t aborts;  /* ever set aside; wraps. Written by the producer */
    volatile uint32_t aborted; /* of these, given; wraps. Written by the consumer */
    volatile uint32_t before;  /* `pushed` at the last abort. Written by the producer */
    uint32_t older; /* frames inside that came before the last abort given. The consumer's */
} auvid_can_fifo_t;

/** Make *fifo empty, before either side uses it.
 * @param storage array of `size` frames, which must outlive the queue
 * @param size a power of two, 2..AUVID_CAN_FIFO_LARGEST
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_RANGE (size). */
auvid_status_t auvid_can_fifo_init(auvid_can_fifo_t *fifo, auvid_can_frame_t *storage,
                                   uint32_t size);

/** The producer's call: copy *frame to the end.
 * @return AUVID_OK (an abort: always); AUVID_ERR_LIMIT (full: dropped and counted); AUVID_ERR_NULL;
 * AUVID_ERR_STATE (not initialised). */
auvid_status_t auvid_can_fifo_push(auvid_can_fifo_t *fifo, const auvid_can_frame_t *frame);

/** The consumer's call: take an abort set aside, or else the oldest.
 * @param frame written when there is one
 * @return AUVID_OK; AUVID_EMPTY; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised). */
auvid_status_t auvid_can_fifo_pop(auvid_can_fifo_t *fifo, auvid_can_frame_t *frame);

#ifdef __cplusplus
}
#endif

#endif
