#include "vehicles.h"

#include <string.h>

#include "auvid/vehicle.h"
#include "auvid/fossen.h"

#if AUVID_MAX_PARAMETERS >= 22 && AUVID_MAX_THRUSTERS >= 8
#define HAS_BLUEROV2
#endif

/* Interval of the DVL samples. */
#define DVL_US 200000u

const vehicle_t vehicle_girona500 = {.word = "girona500",
                                     .title = "Girona500",
                                     .model = &auvid_girona500,
                                     .allocation = &auvid_allocation_girona500,
                                     .simulate = sim_defaults,
                                     .amplitude = {100, 100, 100, 0, 0, 40},
                                     .linger_ticks = 130};

#ifdef HAS_BLUEROV2
const char vehicle_words[] = "girona500, bluerov2";
const char vehicle_model_words[] = "girona500, fossen, bluerov2";

/* Roll and pitch are stabilised, because the moments of the excitation would turn it over. */
static const vehicle_t bluerov2 = {.word = "bluerov2",
                                   .title = "BlueROV2 Heavy",
                                   .model = &auvid_bluerov2_heavy,
                                   .quick = true,
                                   .allocation = &auvid_allocation_bluerov2_heavy,
                                   .simulate = sim_bluerov2,
                                   .amplitude = {40, 40, 40, 5, 6, 6},
                                   .tilt_max_rad = AUVID_C(1.2),
                                   .yaw_rate_max = 3,
                                   .linger_ticks = 320};
#else
const char vehicle_words[] = "girona500";
const char vehicle_model_words[] = "girona500";
#endif

const vehicle_t *vehicle_named(const char *word)
{
#ifdef HAS_BLUEROV2
    if (strcmp(word, bluerov2.word) == 0) {
        return &bluerov2;
    }
#endif
    return strcmp(word, vehicle_girona500.word) == 0 ? &vehicle_girona500 : NULL;
}

const auvid_vehicle_t *vehicle_model(const char *word)
{
    const vehicle_t *vehicle = vehicle_named(word);
#ifdef HAS_BLUEROV2
    if (strcmp(word, "fossen") == 0) {
        return &auvid_fossen;
    }
#endif
    return vehicle != NULL ? vehicle->model : NULL;
}

void vehicle_simulation(const vehicle_t *vehicle, vehicle_sim_config_t *cfg)
{
    vehicle_sim_defaults(cfg);
    vehicle->simulate(&cfg->sim);
    cfg->allocation = vehicle->allocation;
}

void vehicle_use_averaged_model(auvid_identifier_config_t *cfg)
{
#ifdef HAS_BLUEROV2
    static auvid_averaged_t averaged; /* always written with the same content */
    if (cfg->vehicle == bluerov2.model &&
        auvid_averaged_init(&averaged, bluerov2.model, cfg->recorder.cell_us, DVL_US) == AUVID_OK) {
        cfg->vehicle = cfg->metric.vehicle = &averaged.vehicle;
        cfg->metric.half_width[1] = 4;
        cfg->metric.max_cell_us = 0; /* the average is over cells of this length */
    }
#else
    (void)cfg;
#endif
}

void vehicle_use_fast_excitation(auvid_excitation_config_t *excitation)
{
    for (int i = 0; i < excitation->segments; ++i) {
        auvid_segment_t *segment = &excitation->segment[i];
        if (segment->dof >= AUVID_ROLL) {
            segment->frequency_hz = AUVID_C(0.1);
            segment->frequency_high_hz = AUVID_C(0.8);
            segment->hold_min_s = 1;
            segment->hold_max_s = 3;
        }
    }
}

void vehicle_identifier(const vehicle_t *vehicle, uint64_t seed, auvid_identifier_config_t *cfg)
{
    auvid_identifier_defaults(cfg, vehicle->model);
    cfg->search.seed = seed;
    cfg->exact_inputs = true; /* those of the simulated vehicles are */
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (vehicle->amplitude[j] > 0) {
            cfg->metric.tau_max[j] = vehicle->amplitude[j];
        }
    }
    if (vehicle->quick) {
        vehicle_use_averaged_model(cfg);
    }
}

void vehicle_actuation(const vehicle_t *vehicle, auvid_real_t set_s, uint32_t sets, uint64_t seed,
                       uint8_t idle, auvid_actuation_config_t *cfg)
{
    auvid_real_t amplitude[AUVID_DOF_COUNT];
    auvid_actuation_defaults(cfg);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        amplitude[j] = (idle >> j & 1u) ? AUVID_C(0.0) : vehicle->amplitude[j];
    }
    (void)auvid_excitation_plan(&cfg->excitation, amplitude, set_s, sets, seed);
    if (vehicle->quick) {
        vehicle_use_fast_excitation(&cfg->excitation);
    }
    if (vehicle->tilt_max_rad > 0) {
        cfg->guard.roll_max_rad = cfg->guard.pitch_max_rad = vehicle->tilt_max_rad;
    }
    if (vehicle->yaw_rate_max > 0) {
        cfg->guard.yaw_rate_max = vehicle->yaw_rate_max;
    }
}
