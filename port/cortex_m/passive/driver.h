/**
 * @file driver.h
 * The functions that the passive examples need from your board: its sensors, the thrust, a clock.
 * Write them for your board. driver_qemu.c has them for QEMU.
 */
#ifndef DRIVER_H
#define DRIVER_H

#include "auvid/identifier.h"

/** Starts clock and sensors. */
void driver_start(void);

/** Sleeps until the next control tick. Returns its time [us]. */
uint64_t driver_wait(void);

/** with_filter.c: writes what the sensors measured since the last tick: in->imu, in->dvl and
 * in->depth, each with its own time, only what is new. */
void driver_sensors(auvid_input_t *in);

/** own_navigation.c: writes the attitude and the velocities of this tick, from your own filter.
 * @param attitude [3] phi theta psi [rad], psi unwrapped
 * @param nu [6] u v w p q r through the water [m/s, rad/s] */
void driver_motion(auvid_real_t *attitude, auvid_real_t *nu);

/** Writes the wrench from this tick on, the sum of all sources.
 * @param wrench [6] X Y Z K M N [N, Nm] */
void driver_thrust(auvid_real_t *wrench);

/** Takes a new estimate: sends it, or stores it. */
void driver_estimate(const auvid_estimate_t *estimate);

/** Handles a programming error: reports `what`, stops. */
void driver_fault(const char *what) __attribute__((noreturn));

#endif
