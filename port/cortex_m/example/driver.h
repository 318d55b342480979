/**
 * @file driver.h
 * What the control loop (main.c) needs of your board: CAN, a clock, a watchdog. Write these
 * functions for it; nothing else in this folder has to change. driver_qemu.c has them for QEMU.
 */
#ifndef DRIVER_H
#define DRIVER_H

#include "auvid/can_fifo.h"

/** Clock, CAN at 500 kbit/s, watchdog. From now on the receive interrupt puts every frame that a
 * node listens to (AUVID_NODE_KINDS of node.h; the controller's acceptance filter keeps others out)
 * into *received, with auvid_can_fifo_push and auvid_can_kind: the only functions of auvid that an
 * interrupt may call. */
void driver_start(auvid_can_fifo_t *received);

/** Put a frame into a transmit mailbox, or a queue in front of it. A frame that does not fit may be
 * lost: every message is repeated, and its receiver sees by the counter that one is missing. */
void driver_send(const auvid_can_frame_t *frame);

/** A clock that never stops; wraps. */
uint32_t driver_now_us(void);

/** Until the next interrupt. */
void driver_sleep(void);

/** To be called once a tick; else the watchdog resets the board. */
void driver_feed_watchdog(void);

/** Something that only a change of the program can mend: thrusters off, tell, stop. */
void driver_fault(const char *what) __attribute__((noreturn));

#endif
