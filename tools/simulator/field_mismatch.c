/*
 * The kinds of mismatch: meaning of their sizes, and their distribution in a mixture.
 */
#include "field_parts.h"

#include <math.h>
#include <string.h>

/* low, high, chance, min_size, max_size, draw, force */
#define NORMAL(sigma, min, max) 0.0, sigma, 1.0, min, max, FIELD_NORMAL, false
#define UNIFORM(low, high, min, max) low, high, 1.0, min, max, FIELD_UNIFORM, false
#define ALWAYS(size, min, max) size, size, 1.0, min, max, FIELD_UNIFORM, false
#define FORCE(low, high, chance, min, max) low, high, chance, min, max, FIELD_UNIFORM, true
#define ALONE(min, max) 0.0, 0.0, 0.0, min, max, FIELD_ALONE, false

/* Amplitude in surge of the vehicle for which the forces of the table are [N]. */
#define FORCES_OF_N 100.0

static const field_mismatch_t kinds[FIELD_KINDS] = {
    [FIELD_IMU_ROLL] = {"imu_roll", "deg", "IMU mounted with this roll", NORMAL(1.0, -30, 30)},
    [FIELD_IMU_PITCH] = {"imu_pitch", "deg", "IMU mounted with this pitch", NORMAL(1.0, -30, 30)},
    [FIELD_IMU_YAW] = {"imu_yaw", "deg", "IMU mounted with this yaw", NORMAL(1.0, -30, 30)},
    [FIELD_GYRO_BIAS] = {"gyro_bias", "deg/s", "rms bias of the gyros; each axis by the seed",
                         ALWAYS(0.1, 0, 5)},
    [FIELD_ATTITUDE_DELAY] = {"attitude_delay", "s", "age of angles and rates at their timestamp",
                              UNIFORM(0.0, 0.03, 0, 0.3)},
    [FIELD_DVL_ARM_X] = {"dvl_arm_x", "m", "DVL ahead of its reported position",
                         NORMAL(0.05, -2, 2)},
    [FIELD_DVL_ARM_Y] = {"dvl_arm_y", "m", "DVL to starboard of its reported position",
                         NORMAL(0.03, -2, 2)},
    [FIELD_DVL_ARM_Z] = {"dvl_arm_z", "m", "DVL below its reported position", NORMAL(0.05, -2, 2)},
    [FIELD_DVL_YAW] = {"dvl_yaw", "deg", "DVL mounted with this yaw", NORMAL(1.0, -30, 30)},
    [FIELD_DVL_ROLL] = {"dvl_roll", "deg", "DVL mounted with this roll", NORMAL(0.7, -30, 30)},
    [FIELD_DVL_PITCH] = {"dvl_pitch", "deg", "DVL mounted with this pitch", NORMAL(0.7, -30, 30)},
    [FIELD_DVL_SCALE] = {"dvl_scale", "", "relative error of DVL velocity",
                         NORMAL(0.005, -0.3, 0.3)},
    [FIELD_DVL_LATENCY] = {"dvl_latency", "s", "DVL timestamps are late by this, on arrival",
                           UNIFORM(0.0, 0.1, 0, 1)},
    [FIELD_DVL_LOST] = {"dvl_lost", "", "share of DVL samples that are lost",
                        UNIFORM(0.0, 0.1, 0, 0.9)},
    [FIELD_DVL_OUTLIERS] = {"dvl_outliers", "", "share of DVL outliers of 0.5 m/s (1 sigma)",
                            UNIFORM(0.0, 0.01, 0, 0.5)},
    [FIELD_DVL_PARTIAL] = {"dvl_partial", "", "share of DVL samples with only one or two axes",
                           UNIFORM(0.0, 0.05, 0, 0.9)},
    [FIELD_THRUST_COMMON] = {"thrust_common", "", "relative excess of the thrust of all thrusters",
                             NORMAL(0.05, -0.9, 2)},
    [FIELD_THRUST_EACH] = {"thrust_each", "",
                           "rms relative excess of each thruster's thrust; by seed",
                           ALWAYS(0.05, 0, 0.3)},
    [FIELD_THRUST_BACKWARD] = {"thrust_backward", "", "relative loss of negative thrust",
                               NORMAL(0.05, -0.9, 0.9)},
    [FIELD_THRUST_SAG] = {"thrust_sag", "", "relative loss of thrust from start to end of the run",
                          UNIFORM(0.0, 0.1, -0.5, 0.9)},
    [FIELD_THRUST_EXPONENT] = {"thrust_exponent", "", "force is f_max |f / f_max|^(1 + this)",
                               NORMAL(0.05, -0.5, 1)},
    [FIELD_THRUST_DEAD_BAND] = {"thrust_dead_band", "N", "force is reduced by this, zero below it",
                                FORCE(0.0, 3.0, 1.0, 0, 50)},
    [FIELD_THRUST_LAG] = {"thrust_lag", "s", "first-order lag of the propellers' speed",
                          UNIFORM(0.05, 0.25, 0, 2)},
    [FIELD_THRUST_ADVANCE] = {"thrust_advance", "s/m", "relative loss of thrust per m/s of inflow",
                              UNIFORM(0.0, 0.3, 0, 2)},
    [FIELD_THRUST_LATE] = {"thrust_late", "s",
                           "wrench timestamps are late by this; negative: early",
                           UNIFORM(0.0, 0.05, -0.3, 0.3)},
    [FIELD_DRAG_ASYMMETRY] = {"drag_asymmetry", "",
                              "relative drag excess one way, loss the other; signs by seed",
                              NORMAL(0.1, -0.9, 0.9)},
    [FIELD_DRAG_EXPONENT] = {"drag_exponent", "", "exponent of quadratic drag is 2 minus this",
                             UNIFORM(0.0, 0.15, -0.5, 0.9)},
    [FIELD_CROSS] = {"cross", "", "rms of Y_r, N_v and lift, relative to drag and length",
                     ALWAYS(0.15, 0, 1)},
    [FIELD_CG_X] = {"cg_x", "m", "centre of gravity ahead of the origin", NORMAL(0.01, -0.1, 0.1)},
    [FIELD_CG_Y] = {"cg_y", "m", "centre of gravity to starboard of the origin",
                    NORMAL(0.01, -0.1, 0.1)},
    [FIELD_CABLE] = {"cable", "N", "pull of a cable at the stern; direction by seed", 0.0, 4.0, 0.3,
                     -100, 100, FIELD_NORMAL, true},
    [FIELD_WAVES] = {"waves", "N", "amplitude of an orbital force, period 4 to 8 s",
                     FORCE(1.0, 5.0, 0.3, 0, 100)},
    [FIELD_CURRENT] = {"current", "m/s", "current, with DVL bottom lock", 0.0, 0.1, 0.5, 0, 2,
                       FIELD_UNIFORM, false},
    [FIELD_DISTURBANCE] = {"disturbance", "N",
                           "rms force, correlation time 2 s; its lever is 0.4 m (any: 0.4 lengths)",
                           FORCE(0.5, 2.0, 1.0, 0, 100)},
    [FIELD_HULL] = {"hull", "", "largest relative deviation of masses and drag",
                    ALWAYS(0.15, 0, 0.2)},
    [FIELD_THRUST_FORCE_LAG] = {"thrust_force_lag", "s", "first-order lag of the force",
                                ALONE(0, 2)},
    [FIELD_FILTER_TAU] = {"filter_tau", "s",
                          "velocity from an autopilot, lag of this time constant", ALONE(0, 2)},
    [FIELD_FILTER_RESETS] = {"filter_resets", "1/min",
                             "jumps of the autopilot's velocity, 0.1 m/s (1 sigma)", ALONE(0, 60)},
    [FIELD_COMMAND_10HZ] = {"command_10hz", "", "1: wrenches are reported only every 0.1 s",
                            ALONE(0, 1)},
    [FIELD_COMMAND_PWM] = {"command_pwm", "us",
                           "thrust reported by 1 us PWM, without this dead zone", ALONE(0, 100)},
    [FIELD_SLEW] = {"slew", "s", "time of the ESC from standstill to full speed", ALONE(0, 5)},
    [FIELD_BATTERY] = {"battery", "", "relative loss of voltage at the end, not reported",
                       ALONE(0, 0.4)},
    [FIELD_BATTERY_CORRECTED] = {"battery_corrected", "",
                                 "the same, reported thrust follows voltage squared",
                                 ALONE(0, 0.4)},
    [FIELD_CLOCK_DRIFT] = {"clock_drift", "ppm", "clock of DVL and depth is slow by this",
                           ALONE(-1000, 1000)},
    [FIELD_CLOCK_JUMPS] = {"clock_jumps", "1/min", "jumps of 50 ms of the clock of DVL and depth",
                           ALONE(0, 60)},
    [FIELD_BALLAST] = {"ballast", "kg", "lead added halfway through the run", ALONE(-10, 100)},
    [FIELD_WALL] = {"wall", "",
                    "relative rise of added mass and drag 0.5 m above a bottom 1 m below the start",
                    ALONE(0, 2)},
    [FIELD_FOULING] = {"fouling", "", "relative increase of drag at the end of the run",
                       ALONE(-0.9, 5)},
    [FIELD_THRUST_SHAPES] = {"thrust_shapes", "",
                             "1: the mismatches of thrust have other shapes, see field_thrust.c",
                             ALONE(0, 1)},
    [FIELD_THRUST_BILINEAR] = {"thrust_bilinear", "",
                               "1: thrust is lost with inflow times the propeller's speed",
                               ALONE(0, 1)},
    [FIELD_CROSS_FLOW] = {"cross_flow", "",
                          "part of quadratic drag that follows the whole speed, not its axis's",
                          ALONE(0, 1)},
};

int field_mismatches(const field_mismatch_t **table)
{
    *table = kinds;
    return FIELD_KINDS;
}

void field_defaults(field_config_t *cfg, field_vehicle_t vehicle, field_driver_t driver,
                    uint64_t seed)
{
    memset(cfg, 0, sizeof *cfg);
    cfg->vehicle = vehicle;
    cfg->driver = driver;
    cfg->seed = seed;
    cfg->length_s = driver == FIELD_EXCITED ? 240.0 : 600.0;
}

void field_draw(field_config_t *cfg, double strength)
{
    field_sheet_t sheet;
    field_sheet(cfg->vehicle, cfg->seed, &sheet);
    memset(cfg->size, 0, sizeof cfg->size);
    for (int k = 0; k < FIELD_KINDS; ++k) {
        const field_mismatch_t *kind = &kinds[k];
        double scale = (k == FIELD_HULL ? 1.0 : strength) *
                       (kind->force ? sheet.amplitude[0] / FORCES_OF_N : 1.0);
        sim_rng_t rng;
        sim_rng_seed(&rng, cfg->seed, FIELD_STREAM_DRAW + (uint64_t)k);
        bool drawn = sim_rng_uniform(&rng) < kind->chance;
        double part = kind->draw == FIELD_NORMAL ? sim_rng_gauss(&rng) : sim_rng_uniform(&rng);
        double size = scale * (kind->low + part * (kind->high - kind->low));
        size = size < kind->min_size ? kind->min_size : size;
        size = size > kind->max_size ? kind->max_size : size;
        cfg->size[k] = drawn && kind->draw != FIELD_ALONE ? size : 0.0;
    }
}

bool field_set(field_config_t *cfg, const char *name, double size)
{
    for (int k = 0; k < FIELD_KINDS; ++k) {
        if (strcmp(kinds[k].name, name) == 0) {
            bool good = size >= kinds[k].min_size && size <= kinds[k].max_size;
            cfg->size[k] = good ? size : cfg->size[k];
            return good;
        }
    }
    return false;
}

bool field_config_is_good(const field_config_t *cfg)
{
    bool good = (unsigned)cfg->vehicle < FIELD_VEHICLES && (unsigned)cfg->driver < FIELD_DRIVERS &&
                cfg->length_s > 0.0 && isfinite(cfg->length_s);
    for (int k = 0; k < FIELD_KINDS; ++k) {
        double size = cfg->size[k];
        good = good && size >= kinds[k].min_size && size <= kinds[k].max_size;
    }
    return good;
}
