/**
 * @file driver.h
 * The functions that the control loop (main.c) needs from your board: CAN, a clock, a watchdog.
 * Write them for your board; nothing else in this folder has to change. driver_qemu.c has them for
 * QEMU.
 */
#ifndef DRIVER_H
#define DRIVER_H

#include "auvid/can.h"

/** Starts the clock, CAN at 500 kbit/s and the watchdog. From then on the receive interrupt pushes
 * every frame that a node receives into *received. The acceptance filter of the
 * controller rejects all others. can.h lists what the interrupt may
 * call. */
void driver_start(auvid_can_fifo_t *received);

/** Puts a frame into a transmit mailbox, or into a queue before it. A frame that does not fit may
 * be lost: every message is repeated, and its counter shows the receiver that one is missing. */
void driver_send(const auvid_can_frame_t *frame);

/** Returns a clock that never stops [us]; wraps. */
uint32_t driver_now_us(void);

/** Sleeps until the next interrupt. */
void driver_sleep(void);

/** Feeds the watchdog. main.c calls it once per tick; otherwise the watchdog resets the board. */
void driver_feed_watchdog(void);

/** Handles a programming error: thrusters off, report `what`, stop. */
void driver_fault(const char *what) __attribute__((noreturn));

#endif
