/**
 * @file field.h
 * A vehicle in the field: between what its operator tells the identifier and what is true stand
 * the ordinary small mismatches, each of a size of its own. Host side: C11, double, libm.
 *
 * Written from the physics, apart from the library and from simulator.c: rigid body and added mass
 * as a 6 x 6 matrix, Coriolis forces from it, thrusters with their electronics, hull, water,
 * sensors and clocks. With every mismatch zero it is a vehicle that the Girona500 model (Eq. 12-15)
 * describes, but for what roll and pitch do.
 *
 * Two vehicles: Girona500, and an ROV of 20 kg with six thrusters, four of them vectored. Four who
 * drive: the identifier's excitation, a joystick pilot, a PID lawnmower, station keeping. Always
 * there is the noise of the sensors: IMU 50 Hz, 0.2 deg and 0.1 deg/s; DVL 5 Hz, 7 mm/s; depth
 * 10 Hz, 15 mm; no GPS.
 *
 * The state is the velocity through the water: a constant current leaves the equations of motion as
 * they are (Fossen 2011, property 8.1). RK4 at 5 ms, four steps a tick; a core simulates more than
 * two thousand times as fast as the clock. What is not there: contact with the bottom, waves as
 * moving water, stall of the propellers.
 *
 * Same configuration, same numbers (to the last digits of libm). No globals, no heap.
 */
#ifndef FIELD_H
#define FIELD_H

#include "simulator.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum { FIELD_GIRONA500, FIELD_ROV20, FIELD_VEHICLES } field_vehicle_t;

typedef enum {
    FIELD_EXCITED,   /**< thrust as field_step is told, on top of hover thrust; a gentle pull of
                          told thrust more than 3 m off the start's depth; with a wall, a firm
                          and damped one from 0.1 m on */
    FIELD_JOYSTICK,  /**< a pilot's sticks: open loop, but for holding depth now and then */
    FIELD_LAWNMOWER, /**< PID of position, heading and depth along parallel legs of 18 m */
    FIELD_STATION,   /**< PID of position, depth and heading at one place */
    FIELD_DRIVERS
} field_driver_t;

/** One kind of mismatch. */
typedef struct {
    const char *name;          /**< on the command line, "thrust_backward" */
    const char *unit;          /**< "m", "deg", "" */
    const char *about;         /**< half a sentence */
    double low, high;          /**< at strength 1; both the same: always of this size */
    double chance;             /**< share of the runs in which it is drawn */
    double min_size, max_size; /**< what field_set and field_init accept */
    enum {
        FIELD_NORMAL,  /**< standard deviation `high` */
        FIELD_UNIFORM, /**< low .. high */
        FIELD_ALONE    /**< never drawn: by field_set only */
    } draw;
    bool force; /**< drawn forces [N]: times 0.3 for the ROV */
} field_mismatch_t;

/** Most kinds of mismatch. */
#define FIELD_MISMATCHES 64

typedef struct {
    field_vehicle_t vehicle;
    field_driver_t driver;
    uint64_t seed;   /**< of noise, disturbance, driver, and of what a size alone does not tell
                          (which thruster, which direction) */
    double length_s; /**< of the run, > 0: sag and battery reach their size at its end, ballast
                          comes at its half; default 240 (excited), 600 */
    double size[FIELD_MISMATCHES]; /**< of each mismatch, in its unit; 0: none */
} field_config_t;

/** What the identifier's side gets in a tick of SIM_TICK_US. */
typedef struct {
    uint64_t t_us;                         /**< of the identifier's clock, at the end of the tick */
    sim_measurement_t sensor[SIM_SENSORS]; /**< by sim_sensor_id_t, with their stamps */
    bool told;                             /**< a wrench was told in this tick */
    uint64_t told_us;                      /**< its stamp: from when it is said to act, until the
                                                next one; the tick's start where stamps are right */
    double wrench[6];                      /**< the wrench as told [N, Nm] */
    double thruster_N[SIM_THRUSTERS];      /**< the thrust of each thruster as told [N] */
} field_output_t;

/** The truth at the end of the tick. */
typedef struct {
    double t_s;
    double position[3], euler[3]; /**< NED [m], ZYX [rad] */
    double nu[6], nu_dot[6];      /**< through the water [m/s, rad/s] and derivative */
    double delivered[6];          /**< what the thrusters do to the vehicle [N, Nm] */
    double told[6];               /**< what was told to act now, without wrong stamps [N, Nm] */
    double disturbance[6];        /**< waves and coloured noise [N, Nm]; not the hull's */
    double hull[6];               /**< left side of the equations of motion, M nu' + all that the
                                       hull does: delivered + disturbance [N, Nm] */
} field_truth_t;

/** The parameters of Eq. 12-15 that the vehicle was built with, as it is at present: masses
 * (rigid body and added, ballast included, away from walls), W-B, and its drag without mismatch, by
 * SIM_M_U .. */
typedef struct {
    double parameter[SIM_PARAMETERS];
    double dry_kg; /**< in air */
} field_built_t;

/* ---- the parts: who writes them stands in field_parts.h ---- */

/** The body in the water. Drag coefficients: positive dissipates. */
typedef struct {
    double dry_kg, weight_N, buoyancy_N;
    double r_g[3], r_b[3]; /* centres of gravity and buoyancy [m] */
    double inertia[3];     /* of the rigid body about its centre of gravity */
    double added[6][6];    /* added mass, away from walls */
    double mass[6][6];     /* rigid body and added mass */
    double inverse[6][6];  /* of mass */
    double linear[6], quadratic[6];
    double asymmetry[6];  /* drag (1 + asymmetry) forwards, (1 - asymmetry) backwards */
    double exponent_loss; /* of the quadratic drag */
    double side_centre_m; /* where the linear side drag acts, ahead of the origin */
    double lift_sway, lift_yaw, lift_heave; /* of |u| v, u v, u^2 */
    double cable_N, cable_arm[3];           /* pull, where it is fixed */
    double cable_to[3];                     /* direction or point */
    bool cable_point;                       /* cable_to is a point in the world, else a direction */
    double current[3];                      /* of the water over ground, NED [m/s] */
    double wall;                            /* share of added mass and drag more at FIELD_NEAR_M */
    double seabed_m;                        /* depth of the bottom */
} field_hull_t;

/** Commands on their way. */
#define FIELD_RING 32
typedef struct {
    uint64_t t_us; /* start of its tick */
    double command_N[SIM_THRUSTERS];
    double told_N[SIM_THRUSTERS]; /* what the operator believes that it gives */
} field_command_t;

typedef struct {
    double gain[SIM_THRUSTERS];   /* true by told, at the start of the run */
    double speed[SIM_THRUSTERS];  /* of the propeller, sqrt(N), signed */
    double slewed[SIM_THRUSTERS]; /* what the electronics ask of it, likewise */
    double force[SIM_THRUSTERS];  /* after the lag of force [N] */
    field_command_t ring[FIELD_RING];
    unsigned written, told; /* how many commands entered, and have been told */
    unsigned acting;        /* one more than the number of the command that acts now */
} field_thrust_t;

typedef struct {
    sim_rng_t noise, loss;
    uint64_t period_us, next_us; /* of the moments at which it measures */
    uint64_t late_us;            /* from there to its stamp, which nobody is told */
    sim_measurement_t queue[SIM_QUEUE];
    uint64_t arrival_us[SIM_QUEUE];
    unsigned head, count;
} field_sensor_t;

typedef struct {
    field_sensor_t sensor[SIM_SENSORS];
    double imu_mount[3][3], dvl_mount[3][3]; /* body from sensor */
    double gyro_bias[3];
    double velocity[3], jump[3]; /* of the autopilot's filter, NED [m/s] */
    int64_t clock_us;            /* the instruments' clock is behind by so much more */
    sim_rng_t clock, filter;
} field_sensing_t;

typedef struct {
    double position[3];                     /* as the operator knows it, NED */
    double euler[3], rates[3], velocity[3]; /* measured last */
    bool has_velocity;
    double sum[4]; /* integrals of the controllers [N, Nm] */
    double reference[2], reference_speed, reference_heading;
    double from[2]; /* where the leg begins */
    int leg;
    double stick[4], stick_to[4], stick_s[4]; /* deflection, where to, until when */
    bool deep;                                /* the pilot corrects the depth */
    sim_rng_t rng;
    double hover_N[SIM_THRUSTERS];
    double mix[SIM_THRUSTERS][4]; /* thrust by X Y Z N: pseudo-inverse */
} field_pilot_t;

/** A vehicle in the field: a plain struct, which may be copied to branch a run. */
typedef struct {
    field_config_t config;
    uint64_t t_us;
    field_truth_t truth;
    field_hull_t hull;
    field_thrust_t thrust;
    field_sensing_t sensing;
    field_pilot_t pilot;
    sim_rng_t disturbance;
    double coloured[6];                     /* noise [N, Nm] */
    double wave[3], wave_rad_s, wave_phase; /* amplitude, NED [N] */
    bool ballasted;
} field_t;

/** The table of kinds. @return how many */
int field_mismatches(const field_mismatch_t **table);

/** No mismatch, the vehicle as in its data sheet, the run's usual length. */
void field_defaults(field_config_t *config, field_vehicle_t vehicle, field_driver_t driver,
                    uint64_t seed);

/** Draw every mismatch of the mixture from config->seed, `strength` times as large; those that are
 * set alone become 0. The hull's own variety ("hull") is no mismatch: it has its full size at every
 * strength, 0 included. */
void field_draw(field_config_t *config, double strength);

/** Set one, in its unit and as it is for this vehicle. False, and nothing done: there is no such
 * name, or its size is out of range. */
bool field_set(field_config_t *config, const char *name, double size);

/** Largest commanded force and moment of the vehicle's excitation [N, Nm], by DoF. */
void field_amplitude(field_vehicle_t vehicle, double amplitude[6]);

/** Body wrench per newton of each thruster, as the operator knows it, and its largest force [N].
 * @return how many thrusters */
int field_thrusters(field_vehicle_t vehicle, double matrix[6][SIM_THRUSTERS], double *max_N);

/** Start at time 0. False, and nothing done: a size or an enumeration is out of range. */
bool field_init(field_t *field, const field_config_t *config);

/** Advance by one tick of SIM_TICK_US.
 * @param thruster_N [thrusters] FIELD_EXCITED: force commanded in addition to hover; null: none.
 *                   Else not read
 * @param out        written */
void field_step(field_t *field, const double *thruster_N, field_output_t *out);

/** The truth at the end of the last tick. */
const field_truth_t *field_truth(const field_t *field);

/** What the vehicle is built of at present. */
void field_built(const field_t *field, field_built_t *built);

#ifdef __cplusplus
}
#endif

#endif
