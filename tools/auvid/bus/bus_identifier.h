/**
 * @file bus_identifier.h
 * The identifier of a node on a bus, as the options set it up: that of `auvid node` and of
 * `auvid replay`.
 */
#ifndef PROGRAM_BUS_IDENTIFIER_H
#define PROGRAM_BUS_IDENTIFIER_H

#include "world.h"
#include "../report/report.h"

/** A node and what is attached to it. It must not move. */
typedef struct {
    auvid_node_t node;
    auvid_actuation_t actuation;
    auvid_validation_t prediction;
    auvid_change_detector_t change;
    auvid_uncertain_t uncertain;   /* not with --plain */
    auvid_calibrated_t calibrated; /* the model, if the vehicle file has known forces */
    vehicle_calibration_t calibration[VEHICLE_CALIBRATIONS]; /* those that act */
    int calibrations;
    uint64_t start_us; /* time of the first tick */
    bool started;      /* it has passed */
    uint32_t received; /* kinds of frames that came, a bit each */
} bus_identifier_t;

/** Starts.
 * @param replayed the log, in which known forces may act; NULL: none
 * @param answer the node answers each tick frame, in lock step
 * @param excites the excitation is attached
 * @return 0, or EXIT_REFUSED after one line on stderr */
int bus_identifier_begin(bus_identifier_t *to, const options_t *options, const char *replayed,
                         bool answer, bool excites);

/** auvid_node_take, which also notes what came. */
auvid_status_t bus_identifier_take(bus_identifier_t *to, const auvid_can_frame_t *frame);

/** Prints what never came of that without which nothing is identified; nothing if all did. */
void bus_identifier_print_missing(const bus_identifier_t *from);

/** Processes one tick: auvid_node_step, with the known force of this time. The times of a vehicle
 * file count from the first tick. */
void bus_identifier_step(bus_identifier_t *to, const uint64_t *clock_us, auvid_can_frame_t *frame,
                         int *count);

/** Takes the result, in SI if a force is known. Follows report_gather. */
void bus_identifier_calibrate(const bus_identifier_t *from, result_t *result);

#endif
