/**
 * @file can_fifo.h
 * A queue of frames with one producer and one consumer: from the receive interrupt to the task.
 *
 * This is the only part of auvid that may be called from an interrupt. The interrupt pushes and the
 * task pops, or the other way round; each side calls from one context only. There are no locks and
 * no atomic read-modify-write operations: each index has one writer. Neither side ever waits. A
 * frame that finds the queue full is dropped and counted.
 *
 * An abort (right length and checksum) is never dropped and uses no slot. Push stores it apart from
 * the queue, and the next pop returns it before any queued frame. Pop then discards the arm frames
 * that were queued before the abort: an older order must not outlast it. Several aborts may become
 * one.
 *
 * AUVID_CAN_BARRIER() orders the accesses to a frame and to the index that publishes it. It binds
 * the compiler and, between two cores, the memory. With gcc and clang it is a full fence that needs
 * no library (dmb on ARM). For other compilers the user must define it. A compiler barrier suffices
 * if producer and consumer run on one core. An aligned 32-bit load or store must be one access, as
 * it is on every 32-bit target with a CAN controller.
 *
 * Cost: push and pop each copy 24 bytes and take 20 instructions; an abort adds its checksum.
 * Memory: the caller's storage, one frame per slot.
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

/** Maximum number of frames in a queue. */
#define AUVID_CAN_FIFO_LARGEST 0x8000u

/** The queue. Only the functions write it, except `ids`. All counts wrap. */
typedef struct {
    auvid_can_frame_t *frame;  /* the caller's storage */
    uint32_t size;             /* power of two; 0: not initialised */
    volatile uint32_t pushed;  /* total of frames pushed. Written by the producer */
    volatile uint32_t popped;  /* total of frames popped. Written by the consumer */
    volatile uint32_t dropped; /**< frames that found it full. Written by the producer */
    auvid_can_ids_t ids;      /**< init sets the defaults; change it before the first push or pop */
    auvid_can_frame_t abort;  /* valid while `aborts` and `aborted` differ */
    volatile uint32_t aborts; /* total of aborts stored. Written by the producer */
    volatile uint32_t aborted; /* total of aborts popped. Written by the consumer */
    volatile uint32_t before;  /* `pushed` at the last abort. Written by the producer */
    uint32_t older;            /* queued frames from before the last popped abort. The consumer's */
} auvid_can_fifo_t;

/** Initialises an empty queue. Call it before the first push or pop.
 * @param storage array of `size` frames; it must outlive the queue
 * @param size a power of two, 2..AUVID_CAN_FIFO_LARGEST
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_RANGE (size). */
auvid_status_t auvid_can_fifo_init(auvid_can_fifo_t *fifo, auvid_can_frame_t *storage,
                                   uint32_t size);

/** Copies *frame to the end of the queue. Only the producer calls it.
 * @return AUVID_OK (always for an abort); AUVID_ERR_FULL (queue full: the frame is dropped and
 * counted); AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised). */
auvid_status_t auvid_can_fifo_push(auvid_can_fifo_t *fifo, const auvid_can_frame_t *frame);

/** Removes the stored abort, or else the oldest frame. Only the consumer calls it.
 * @param frame the frame removed. It may be overwritten although the queue is AUVID_EMPTY
 * @return AUVID_OK; AUVID_EMPTY; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised). */
auvid_status_t auvid_can_fifo_pop(auvid_can_fifo_t *fifo, auvid_can_frame_t *frame);

#ifdef __cplusplus
}
#endif

#endif
