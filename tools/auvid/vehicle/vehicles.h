/**
 * @file vehicles.h
 * The vehicles of the program: those that are ready (vehicles/X.ini, in the program as text), and
 * those of files; and the configurations of their identification.
 *
 * The choice depends on the sizes that the library is built with: BlueROV2 Heavy needs room for the
 * parameters of the 6-DoF model.
 */
#ifndef PROGRAM_VEHICLES_H
#define PROGRAM_VEHICLES_H

#include "vehicle_file.h"
#include "vehicle_sim.h"

/** The Girona500, which is the default. */
const vehicle_t *vehicle_default(void);

/** The ready vehicle of this name, or NULL. */
const vehicle_t *vehicle_named(const char *word);

/** The vehicle of a file, if the word has a '/' or ends in ".ini", or else the ready one.
 * @param who the option, in messages @return NULL after a message */
const vehicle_t *vehicle_chosen(const char *who, const char *word);

/** Names of all ready vehicles, "girona500, bluerov2, ..". */
const char *vehicle_words(void);

/** The model of `fit --model WORD`, "fossen" or of a vehicle. @return NULL after a message */
const auvid_vehicle_t *vehicle_model(const char *who, const char *word);

/** For the model of a fast vehicle: selects averaged rows, for a DVL at 5 Hz, and
 * shorter filters of the moments.
 * @param residual the model will be wrapped by one that is not linear (current.h): then rows are
 * means over two cells */
void vehicle_use_averaged_model(auvid_identifier_config_t *cfg, bool residual);

/** Selects faster steps and sines of the moments, for a vehicle that oscillates within seconds. */
void vehicle_use_fast_excitation(auvid_excitation_config_t *excitation);

/** Writes the configuration of its simulation. */
void vehicle_simulation(const vehicle_t *vehicle, vehicle_sim_config_t *cfg);

/** The upper bound of every parameter for this dry mass, in kg (0: not known): 1000, the library's,
 * up to 250 kg. A heavier vehicle is also larger: masses are in proportion to its mass, inertia and
 * drag of turns to the power 5/3 of it for hulls of one shape. The bound has its square. */
double vehicle_bound(double dry_mass_kg);

/** Sets the bounds of all parameters to +- vehicle_bound. */
void vehicle_bounds(double dry_mass_kg, auvid_identifier_config_t *cfg);

/** Writes the configuration of its identification, based on auvid_identifier_defaults. */
void vehicle_identifier(const vehicle_t *vehicle, uint64_t seed, auvid_identifier_config_t *cfg);

/** Writes the excitation and the limits of the guard, based on auvid_actuation_defaults.
 * @param sets number of sets of excitation, of set_s seconds each
 * @param idle bit j: DoF j is not excited */
void vehicle_actuation(const vehicle_t *vehicle, auvid_real_t set_s, uint32_t sets, uint64_t seed,
                       uint8_t idle, auvid_actuation_config_t *cfg);

#endif
