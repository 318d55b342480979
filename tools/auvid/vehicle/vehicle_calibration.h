/**
 * @file vehicle_calibration.h
 * The sections [calibration.N] of a vehicle file: forces on the vehicle that are known exactly,
 * each for a time. They calibrate the thrust (auvid_calibrated_t in estimate.h).
 */
#ifndef PROGRAM_VEHICLE_CALIBRATION_H
#define PROGRAM_VEHICLE_CALIBRATION_H

#include "../base/ini.h"
#include "vehicle_file.h"
#include "vehicle_sim.h"

/** Reads the known forces. @return false after a message */
bool vehicle_calibrations_read(ini_t *ini, vehicle_t *v);

/** Selects the known forces that act in a log: those that name it, and in the first log those that
 * name none.
 * @param path of the log; NULL: it has none
 * @return their number */
int vehicle_calibrations_of(const vehicle_t *v, const char *path, bool first,
                            vehicle_calibration_t to[VEHICLE_CALIBRATIONS]);

/** Is one of them outside its log, which is from first_s to last_s? Then writes the sentence. */
bool vehicle_calibrations_miss(const vehicle_calibration_t *calibration, int count, double first_s,
                               double last_s, char *text, size_t size);

/** The known force at a time; all zeros: none. */
auvid_known_force_t vehicle_known_force(const vehicle_calibration_t *calibration, int count,
                                        double t_s);

/** Lets the known force of its time act on a simulated vehicle, without its mass. @return it */
auvid_known_force_t vehicle_load(const vehicle_calibration_t *calibration, int count,
                                 vehicle_sim_t *vehicle_sim);

/** Selects the model with a known force for an identifier. k_tau is 1 until the force shows it.
 * @param force the axis in which it acts most must be excited
 * @param calibrated written; must outlive the identifier
 * @return the library's status */
auvid_status_t vehicle_use_known_force(auvid_identifier_config_t *cfg,
                                       const auvid_known_force_t *force,
                                       auvid_calibrated_t *calibrated);

#endif
