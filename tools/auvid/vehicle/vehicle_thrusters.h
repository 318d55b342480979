/**
 * @file vehicle_thrusters.h
 * The sections [thruster.N], [group.NAME] and [excitation] of a vehicle file.
 */
#ifndef PROGRAM_VEHICLE_THRUSTERS_H
#define PROGRAM_VEHICLE_THRUSTERS_H

#include "../base/ini.h"
#include "vehicle_file.h"

/** Largest number of thrusters in a file. */
enum {
    VEHICLE_THRUSTERS = AUVID_MAX_THRUSTERS < SIM_THRUSTERS ? AUVID_MAX_THRUSTERS : SIM_THRUSTERS
};

/** Reads thrusters and the maps of their groups, for allocation and simulator.
 * @return false after a message */
bool vehicle_thrusters_read(ini_t *ini, vehicle_t *v);

/** Checks that the thrusters act in the degrees of freedom of [allocation].
 * @return false after a message */
bool vehicle_allocation_check(ini_t *ini, const vehicle_t *v);

/** Checks that model and thrusters have the wrenches of [excitation], one by one and together. If
 * not, the message goes to v->excitation_refusal, for the commands that excite. */
void vehicle_excitation_check(ini_t *ini, vehicle_t *v);

/** Finds the thruster that is farthest from the origin, if that is too far for a vehicle of this
 * mass (0: not known): its position may be in another unit. Returns false if there is none; else
 * writes a sentence. */
bool vehicle_far_thruster(const vehicle_t *v, double dry_mass_kg, char *text, size_t size);

#endif
