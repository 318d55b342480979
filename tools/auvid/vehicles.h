/**
 * @file vehicles.h
 * The vehicles that are ready: each one's model in the library, its thrusters, its simulator, and
 * the settings with which it is identified.
 *
 * Which there are depends on the sizes the library is built with: BlueROV2 Heavy needs room for the
 * parameters of the 6-DoF model.
 */
#ifndef PROGRAM_VEHICLES_H
#define PROGRAM_VEHICLES_H

#include "auvid/identifier.h"
#include "vehicle_sim.h"

typedef struct {
    const char *word;  /**< on the command line */
    const char *title; /**< for people */
    const auvid_vehicle_t *model;
    bool quick; /**< quicker than its DVL, and in roll, pitch and yaw above all */
    const auvid_allocation_config_t *allocation;
    void (*simulate)(sim_config_t *config);  /**< the simulator's settings */
    auvid_real_t amplitude[AUVID_DOF_COUNT]; /**< of the excitation [N, Nm] */
    auvid_real_t tilt_max_rad, yaw_rate_max; /**< the guard's limits [rad, rad/s]; 0: default */
    /** Ticks in which a node tells all that it knows twice: estimates take turns, one in five. */
    uint32_t linger_ticks;
} vehicle_t;

/** The Girona500: what is meant where none is named. */
extern const vehicle_t vehicle_girona500;

/** The vehicle of this word; null: there is none. */
const vehicle_t *vehicle_named(const char *word);

/** Words of all vehicles, "girona500, bluerov2". */
extern const char vehicle_words[];

/** The model that `fit --model WORD` means; null: there is none. */
const auvid_vehicle_t *vehicle_model(const char *word);

/** Words of all models. */
extern const char vehicle_model_words[];

/** Where the model is that of a quick vehicle: identify with averaged rows, for a DVL at 5 Hz, and
 * with shorter filters of the moments. */
void vehicle_use_averaged_model(auvid_identifier_config_t *cfg);

/** Steps and sines of the moments, for a vehicle that swings in seconds. */
void vehicle_use_fast_excitation(auvid_excitation_config_t *excitation);

/** Configure its simulation: vehicle_sim_defaults of this vehicle. */
void vehicle_simulation(const vehicle_t *vehicle, vehicle_sim_config_t *config);

/** Configure its identification: auvid_identifier_defaults of this vehicle.
 * @param sets of excitation, of set_s seconds each
 * @param idle bit j: DoF j is not excited */
void vehicle_identifier(const vehicle_t *vehicle, auvid_real_t set_s, uint32_t sets, uint64_t seed,
                        uint8_t idle, auvid_identifier_config_t *cfg);

#endif
