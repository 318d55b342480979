/**
 * @file simulator.h
 * An underwater vehicle and its sensors, for the program and the tests (host side: C11, double,
 * libm).
 *
 * Vehicle: the paper's Girona500 (Eq. 12-15, its 13 identified values as defaults), with roll and
 * pitch added as statically stable degrees of freedom, full kinematics (ZYX Euler angles), five
 * thrusters that saturate and may lag, a coloured force disturbance and a constant current.
 * Integrated by RK4 at 5 ms, four steps per tick of 20 ms; forces are constant within a step.
 *
 * Another vehicle: `model` SIM_FOSSEN, six degrees of freedom with the textbook's matrices
 * (fossen.c); sim_bluerov2() makes it a BlueROV2 Heavy. It may stabilise roll and pitch with its
 * thrusters as ArduSub does; the feedback includes this thrust. Euler angles are singular at pitch
 * angles of 90 degrees, where the simulation ends.
 *
 * A user's vehicle: `model` SIM_VEHICLE, any model of the library that has an acceleration. Of the
 * degrees of freedom without an equation, roll and pitch are Girona500's, the others stay at rest.
 *
 * Current: the state is the velocity through the water, on which the forces depend. For a
 * constant irrotational current Eq. 12-15 hold unchanged (Fossen 2011, property 8.1);
 * positions move with the velocity over ground, R nu + current.
 *
 * Eq. 13 is printed with m_w w q; energy and Fossen have m_w w p, the default here.
 *
 * Sensors: IMU, DVL, and those of the library's table (auvid_sensors_internal.h) that measure a
 * position; each with rate, phase, noise, age on arrival and drop-outs, each with separate random
 * streams: switching one off does not change the noise of the others. The same seed gives the same
 * numbers (to the last digits of the C library's sin and log).
 *
 * No globals, no heap: sim_t is a plain struct and may be copied to branch a run.
 */
#ifndef SIMULATOR_H
#define SIMULATOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "auvid/vehicle.h"
#include "navigation/auvid_sensors_internal.h"

#ifdef __cplusplus
extern "C" {
#endif

#define SIM_TICK_US 20000u
#define SIM_SUBSTEPS 4
#define SIM_THRUSTERS 8 /* largest number of thrusters */
/** Capacity for delayed samples of a sensor: age_s * rate_hz must stay below this minus one. */
#define SIM_QUEUE 32

/** The 13 parameters in the order of the paper. */
enum {
    SIM_M_U,
    SIM_M_V,
    SIM_M_W,
    SIM_M_R,
    SIM_WB,
    SIM_X_U,
    SIM_X_UU,
    SIM_Y_V,
    SIM_Y_VV,
    SIM_Z_W,
    SIM_Z_WW,
    SIM_N_R,
    SIM_N_RR,
    SIM_PARAMETERS
};

/** The parameters of the 6-DoF model of the library, in its order (fossen.h). */
#define SIM_FOSSEN_PARAMETERS 32

typedef enum { SIM_GIRONA500, SIM_FOSSEN, SIM_VEHICLE } sim_model_t;

/** Largest number of parameters of SIM_VEHICLE. */
#define SIM_VEHICLE_PARAMETERS 32

/** The textbook's coefficients of a vehicle in six degrees of freedom (Fossen 2011). */
typedef struct {
    double mass_kg;
    double inertia[3];              /**< I_x I_y I_z about the body's origin [kg m2] */
    double weight_N, buoyancy_N;    /**< W and B */
    double r_g[3], r_b[3];          /**< centres of gravity and buoyancy [m] */
    double added[6][6];             /**< added mass, symmetric: -X_udot .. on its diagonal */
    double linear[6], quadratic[6]; /**< drag; positive dissipates */
} sim_fossen_t;

/** SIM_DEPTH, SIM_GPS, ..: the rows of the library's table that measure a position. SIM_IF_<kind>
 * expands to its arguments in such a row. */
#define SIM_IF_VELOCITY(...)
#define SIM_IF_POSITION(...) __VA_ARGS__
#define SIM_ID(name, input, event, kind, ...) SIM_IF_##kind(SIM_##name, )
typedef enum { SIM_IMU, SIM_DVL, AUVID_SENSORS(SIM_ID) SIM_SENSORS } sim_sensor_id_t;

/** Target of the DVL lock. */
typedef enum {
    SIM_LOCK_BOTTOM,  /**< always the bottom */
    SIM_LOCK_WATER,   /**< always the water around the vehicle */
    SIM_LOCK_ALTITUDE /**< the bottom within dvl_range_m, else the water */
} sim_lock_t;

/** Sampling of a sensor. Samples are taken at phase_s + k / rate_hz, after time 0. */
typedef struct {
    double rate_hz; /**< 0..50; 0: switched off */
    double phase_s; /**< 0.. ; time of the first sample; 0: the first after one period */
    double age_s;   /**< from sample to arrival, 0..; age_s * rate_hz < SIM_QUEUE - 1 */
    double dropout; /**< probability that a sample never arrives, 0..1 */
} sim_sensor_config_t;

typedef struct {
    uint64_t seed;                    /**< default 1 */
    sim_model_t model;                /**< default SIM_GIRONA500 */
    sim_fossen_t fossen;              /**< of SIM_FOSSEN; default: none */
    double parameter[SIM_PARAMETERS]; /**< of SIM_GIRONA500; default: the paper's values */
    const auvid_vehicle_t *vehicle;   /**< of SIM_VEHICLE; default NULL */
    double vehicle_parameter[SIM_VEHICLE_PARAMETERS]; /**< its parameters; default 0 */
    bool printed_eq13; /**< m_w w q in Eq. 13, as printed; default false */
    /** Roll and pitch: inertia [kg m2], linear [Nm s] and quadratic [Nm s2] drag (positive
     * dissipates), righting moment at 90 degrees [Nm]. Defaults 80, 60, 40, 150. */
    double tilt_inertia, tilt_linear, tilt_quadratic, tilt_righting;
    double roll_arm_m;  /**< roll moment per newton of Y [m]; default 0.05 */
    double pitch_arm_m; /**< pitch moment per newton of X [m]; default -0.08 */
    /** 1: roll and pitch get the moments (m_v - m_w) v w and (m_w - m_u) u w, so that Coriolis
     * forces do no work; 0 (default): not, because the paper assumes small angles. */
    double munk;
    double position[3]; /**< at time 0: north, east, down [m]; default 0, 0, 50 */
    double euler[3];    /**< at time 0: phi theta psi [rad]; default 0 */
    double nu[6];       /**< at time 0, through the water [m/s, rad/s]; default 0 */
    double current[3];  /**< of the water over ground, NED [m/s]; default 0 */
    /** Body wrench per newton of each thruster; default Girona500's: X = -(t0 + t1), Y = t4,
     * Z = -(t2 + t3), M = 0.35 (t3 - t2), N = 0.4 (t1 - t0). */
    double thruster_matrix[6][SIM_THRUSTERS];
    int thrusters;          /**< number of thrusters, 0..SIM_THRUSTERS; default 5 */
    double thruster_max_N;  /**< largest forward thrust; default 153.8 */
    double thruster_back_N; /**< largest backward thrust; 0 (default): as forward */
    /** The same of each thruster, forward [0] and backward [1]; 0 (default): as all. */
    double thruster_limit_N[SIM_THRUSTERS][2];
    /** Stabilisation of roll and pitch: gains in newton metres per radian and per radian per second
     * of the last IMU sample; default 0: none. With stabilisation the thrusters must be able to
     * actuate all six degrees of freedom. */
    double hold_Nm_rad, hold_Nms_rad;
    double lag_s;          /**< first-order lag of thrusters and wrench [s]; default 0: none */
    bool feedback_true;    /**< out.thruster_N: acting thrust; default false: commanded thrust */
    double disturbance_N;  /**< rms of the unknown force in X, Y, Z; default 0 */
    double disturbance_Nm; /**< rms in N; with SIM_FOSSEN in K and M too; default 0 */
    double disturbance_s;  /**< its correlation time [s], > 0; default 2 */
    /** A known force (calibration), without mass: north, east, down, and in body axes [N]; where
     * both act, from the body's origin [m]. May be changed while it runs. Default 0. */
    double load_N[3], load_body_N[3], load_at_m[3];
    double seabed_m; /**< depth of the bottom [m]; default 80 */

    /** Defaults 50, 5, 10, 1 Hz, the others off; no age, no drop-outs. */
    sim_sensor_config_t sensor[SIM_SENSORS];
    double imu_angle_rad;   /**< rms noise of each angle; default 0.2 degrees */
    double imu_rate_rad_s;  /**< rms noise of each rate; default 0.1 degrees per second */
    double dvl_m_s;         /**< rms noise of each component; default 0.007 */
    double dvl_arm_m[3];    /**< of the DVL from the body's origin [m]; default 0 */
    double dvl_yaw_rad;     /**< of the DVL's x axis from the body's x; default 0 */
    double dvl_euler[3];    /**< instead: phi theta psi of the DVL's frame in the body's [rad] */
    double imu_euler[3];    /**< the same of the IMU; default 0 */
    double dvl_partial;     /**< share of samples with only one or two of the DVL's axes,
                                each of these six cases equally likely; 0..0.9, default 0 */
    double dvl_partial_run; /**< mean number of consecutive such samples with the same
                                 axes; >= 1, default 1 */
    sim_lock_t dvl_lock;    /**< default SIM_LOCK_BOTTOM */
    double dvl_range_m;     /**< for SIM_LOCK_ALTITUDE; default 40 */
    /** depth_m, gps_m, ..: rms noise of each axis of a position sensor; default as in the table.
     * depth_arm_m, gps_arm_m, ..: its place from the body's origin [m]; default 0. */
#define SIM_MEMBERS(name, input, event, kind, axis, axes, config, ...)                             \
    SIM_IF_##kind(double config##_m; double config##_arm_m[3];)
    AUVID_SENSORS(SIM_MEMBERS)
    double surface_m; /**< no sample of a sensor for the surface below this depth; default 0.5 */
} sim_config_t;

/** xoshiro256** and the second of a pair of Gaussians. */
typedef struct {
    uint64_t s[4];
    double spare;
    bool has_spare;
} sim_rng_t;

/** A sensor that measures axes of the position. */
typedef struct {
    int axis, axes; /**< axes 0: not such a sensor */
    bool surface;   /**< at the surface only */
    double noise_m; /**< default of its noise */
    size_t at;      /**< offset in sim_config_t: noise, then arm */
} sim_position_t;

/** By sim_sensor_id_t. */
extern const sim_position_t sim_positions[SIM_SENSORS];

/** Streams of random numbers: two of each sensor, and that of the disturbance, which was numbered
 * behind the first four sensors. */
#define SIM_STREAM_DISTURBANCE 8
#define SIM_STREAM(sensor) (2 * (uint64_t)(sensor) + ((sensor) < 4 ? 0 : 1))

/** One measurement. */
typedef struct {
    bool has;      /**< a sample arrived in this tick; else the rest is zero */
    uint64_t t_us; /**< time of sampling (not of arrival) */
    /** IMU: phi theta psi [rad, psi in -pi..pi], p q r [rad/s]. DVL: velocity of the instrument in
     * its own axes [m/s], then its altitude [m] (with bottom lock; else 0). Position:
     * the axes of the sensor, NED [m]. */
    double value[6];
    bool bottom;  /**< DVL: over ground (else through the water) */
    uint8_t axes; /**< DVL: bit i: axis i was measured, else value[i] is zero */
} sim_measurement_t;

/** Output of a tick. */
typedef struct {
    uint64_t t_us;                         /**< end of the tick */
    sim_measurement_t sensor[SIM_SENSORS]; /**< by sim_sensor_id_t */
    double thruster_N[SIM_THRUSTERS];      /**< feedback, see feedback_true; with stabilisation */
    double wrench[6]; /**< wrench of the feedback thrust and of the wrench commanded [N, Nm] */
} sim_output_t;

/** The truth at the end of the tick. */
typedef struct {
    uint64_t t_us;
    double position[3];    /**< NED [m] */
    double euler[3];       /**< phi theta psi [rad], psi not wrapped */
    double nu[6];          /**< through the water, body axes [m/s, rad/s] */
    double nu_dot[6];      /**< its derivative [m/s2, rad/s2] */
    double ground[3];      /**< velocity over ground, body axes [m/s] */
    double wrench[6];      /**< of the thrusters and the wrench command, after lag [N, Nm] */
    double disturbance[6]; /**< [N, Nm] */
    double thruster_N[SIM_THRUSTERS]; /**< after saturation and lag */
} sim_truth_t;

/** A sensor's state. */
typedef struct {
    sim_rng_t noise, loss;
    uint64_t period_us, next_us, age_us;
    sim_measurement_t queue[SIM_QUEUE];
    unsigned head, count;
    uint8_t axes; /* DVL: those that it measures now; 0: all */
} sim_sensor_t;

typedef struct {
    sim_config_t cfg;
    sim_truth_t truth;
    double direct[6]; /**< lagged wrench command */
    sim_rng_t disturbance;
    sim_sensor_t sensor[SIM_SENSORS];
    sim_measurement_t imu; /* the last one */
} sim_t;

/** Writes the defaults named above. */
void sim_defaults(sim_config_t *cfg);

/** Writes those of a BlueROV2 Heavy: coefficients and thruster positions of von Benzon et al. 2022
 * in fresh water, T200s at 16 V, roll and pitch stabilised; sensors as above. */
void sim_bluerov2(sim_config_t *cfg);

/** Starts at time 0. Returns false and does nothing if a value is out of range or not finite. */
bool sim_init(sim_t *sim, const sim_config_t *cfg);

/**
 * Advances by one tick.
 * @param thruster_N [thrusters] force commanded, clipped to its limits (not finite: 0); NULL:
 *                   none.
 * @param wrench     body wrench commanded directly [N, Nm], without limits; NULL: none. Neutral
 *                   trim needs Z = -(W-B).
 * @param out        written.
 */
void sim_step(sim_t *sim, const double *thruster_N, const double wrench[6], sim_output_t *out);

/* The parts, for tests and other simulations. */

/** Derivatives of [position, euler, nu] under a body wrench (the model's, and kinematics). */
void sim_derivative(const sim_config_t *cfg, const double state[12], const double wrench[6],
                    double derivative[12]);
/** One RK4 step of h seconds under a constant wrench. */
void sim_rk4(const sim_config_t *cfg, double state[12], const double wrench[6], double h);
/** M = M_RB + M_A. */
void sim_fossen_matrix(const sim_fossen_t *vehicle, double m[6][6]);
/** nu' under a body wrench. */
void sim_fossen_acceleration(const sim_fossen_t *vehicle, const double euler[3], const double nu[6],
                             const double wrench[6], double nu_dot[6]);
/** Writes the parameters of the library's model. */
void sim_fossen_parameters(const sim_fossen_t *vehicle, double p[SIM_FOSSEN_PARAMETERS]);
/** Solves a x = b. a is overwritten; x is b on entry. Returns false if a is not positive definite.
 */
bool sim_solve(double a[6][6], double x[6]);
/** Largest force of thruster j in the direction of a force [N], >= 0. */
double sim_thruster_limit(const sim_config_t *cfg, int j, double force);
/** Rotation matrix from body to world. */
void sim_rotation(const double euler[3], double r[3][3]);
/** Seeds stream `stream`; different streams are independent. */
void sim_rng_seed(sim_rng_t *rng, uint64_t seed, uint64_t stream);
/** Uniform in [0, 1). */
double sim_rng_uniform(sim_rng_t *rng);
/** Standard normal. */
double sim_rng_gauss(sim_rng_t *rng);

/* Between simulator.c and sensors.c. */
bool sim_sensors_init(sim_t *sim);
/** Takes the samples due in (before, now] by interpolation of the truth, at whole microseconds. */
void sim_sensors_sample(sim_t *sim, const sim_truth_t *before, const sim_truth_t *now);
/** Writes the samples that have arrived by out->t_us. */
void sim_sensors_deliver(sim_t *sim, sim_output_t *out);

#ifdef __cplusplus
}
#endif

#endif
