/**
 * @file vehicles.h
 * The built-in vehicles: model in the library, thrusters, simulator, and settings of the
 * identification.
 *
 * The choice depends on the sizes that the library is built with: BlueROV2 Heavy needs room for the
 * parameters of the 6-DoF model.
 */
#ifndef PROGRAM_VEHICLES_H
#define PROGRAM_VEHICLES_H

#include "auvid/actuation.h"
#include "vehicle_sim.h"

typedef struct {
    const char *word;  /**< name on the command line */
    const char *title; /**< name in reports */
    const auvid_vehicle_t *model;
    bool quick; /**< faster than its DVL, mainly in roll, pitch and yaw */
    const auvid_allocation_config_t *allocation;
    void (*simulate)(sim_config_t *cfg);     /**< sets the configuration of the simulator */
    auvid_real_t amplitude[AUVID_DOF_COUNT]; /**< of the excitation [N, Nm] */
    auvid_real_t tilt_max_rad, yaw_rate_max; /**< limits of the guard [rad, rad/s]; 0: default */
    /** Ticks in which a node reports every estimate twice: one estimate in five ticks. */
    uint32_t linger_ticks;
} vehicle_t;

/** The Girona500, which is the default. */
extern const vehicle_t vehicle_girona500;

/** The vehicle of this name, or NULL. */
const vehicle_t *vehicle_named(const char *word);

/** Names of all vehicles, "girona500, bluerov2". */
extern const char vehicle_words[];

/** The model of `fit --model WORD`, or NULL. */
const auvid_vehicle_t *vehicle_model(const char *word);

/** Names of all models. */
extern const char vehicle_model_words[];

/** For the model of a fast vehicle: selects averaged rows, for a DVL at 5 Hz, and
 * shorter filters of the moments. */
void vehicle_use_averaged_model(auvid_identifier_config_t *cfg);

/** Selects faster steps and sines of the moments, for a vehicle that oscillates within seconds. */
void vehicle_use_fast_excitation(auvid_excitation_config_t *excitation);

/** Writes the configuration of its simulation. */
void vehicle_simulation(const vehicle_t *vehicle, vehicle_sim_config_t *cfg);

/** Writes the configuration of its identification, based on auvid_identifier_defaults. */
void vehicle_identifier(const vehicle_t *vehicle, uint64_t seed, auvid_identifier_config_t *cfg);

/** Writes the excitation and the limits of the guard, based on auvid_actuation_defaults.
 * @param sets number of sets of excitation, of set_s seconds each
 * @param idle bit j: DoF j is not excited */
void vehicle_actuation(const vehicle_t *vehicle, auvid_real_t set_s, uint32_t sets, uint64_t seed,
                       uint8_t idle, auvid_actuation_config_t *cfg);

#endif
