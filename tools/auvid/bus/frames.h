/**
 * @file frames.h
 * Conversion of frames between library and port, and the simulated vehicle on a bus in memory.
 */
#ifndef PROGRAM_FRAMES_H
#define PROGRAM_FRAMES_H

#include "bus_memory.h"
#include "vehicle_sim.h"

/** Converts a frame of the library to one of the port. */
bus_frame_t frames_raw(const auvid_can_frame_t *frame);

/** Converts back. Returns false if it is not a data frame with an 11-bit identifier. */
bool frames_convert(const bus_frame_t *from, auvid_can_frame_t *to);

/** Sends frames at an end of the bus in memory. */
void frames_send(bus_memory_end_t *end, const auvid_can_frame_t *frame, int count);

/** Receives the next frame there. Returns false if there is none. */
bool frames_receive(bus_memory_end_t *end, auvid_can_frame_t *frame);

/** Passes all pending frames at this end to the vehicle. */
void frames_take(bus_memory_end_t *end, vehicle_sim_t *vehicle_sim);

/** The vehicle's part of a tick: receives, advances the clock of the bus, simulates, sends. */
void frames_vehicle(bus_memory_end_t *end, vehicle_sim_t *vehicle_sim);

#endif
