/**
 * @file frames.h
 * Frames of the library on a bus of the port, and the simulated vehicle on a bus in memory.
 */
#ifndef PROGRAM_FRAMES_H
#define PROGRAM_FRAMES_H

#include "bus_memory.h"
#include "vehicle_sim.h"

/** A frame of the library as the bus takes it. */
bus_frame_t frames_raw(const auvid_can_frame_t *frame);

/** And back. False: not a data frame with an 11-bit identifier. */
bool frames_convert(const bus_frame_t *from, auvid_can_frame_t *to);

/** Send frames at an end of the bus in memory. */
void frames_send(bus_memory_end_t *end, const auvid_can_frame_t *frame, int count);

/** Take the next frame there. False: none now. */
bool frames_receive(bus_memory_end_t *end, auvid_can_frame_t *frame);

/** The vehicle at this end takes what has come for it. */
void frames_take(bus_memory_end_t *end, vehicle_sim_t *vehicle_sim);

/** The vehicle's part of a tick: hear, move the bus's clock on, simulate, send. */
void frames_vehicle(bus_memory_end_t *end, vehicle_sim_t *vehicle_sim);

#endif
