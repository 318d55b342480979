/**
 * @file field.h
 * A vehicle with the usual small mismatches between the information given to the identifier and the
 * truth. Each mismatch has its own size. Host side: C11, double, libm.
 *
 * Written from the physics, independently of the library and of simulator.c: rigid body and added
 * mass as a 6 x 6 matrix, Coriolis forces from it, thrusters with their electronics, hull, water,
 * sensors and clocks. With all mismatches zero the Girona500 model (Eq. 12-15) describes the
 * vehicle, except for the effects of roll and pitch.
 *
 * Two vehicles: Girona500, and an ROV of 20 kg with six thrusters, four of them vectored; and any
 * number of others, drawn at random, with the thrusters of one of these. All of them hover, and
 * thrusters act in surge, sway, heave and yaw. Five drivers: the identifier's excitation, a
 * joystick pilot, the same with depth and heading held, a PID lawnmower, station keeping. The
 * sensors are always noisy: IMU 50 Hz, 0.2 deg and 0.1 deg/s; DVL 5 Hz, 7 mm/s; depth 10 Hz, 15 mm;
 * no GPS.
 *
 * The state is the velocity through the water: a constant current leaves the equations of motion
 * unchanged (Fossen 2011, property 8.1). RK4 at 5 ms, four steps per tick; one core simulates more
 * than two thousand times faster than real time. Not modelled: contact with the bottom, waves as
 * moving water, stall of the propellers.
 *
 * The same configuration gives the same numbers (to the last digits of libm). No globals, no heap.
 */
#ifndef FIELD_H
#define FIELD_H

#include "simulator.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum {
    FIELD_GIRONA500,
    FIELD_ROV20,
    FIELD_ANY, /**< another one for each seed: 8 .. 450 kg, 0.25 .. 1.5 m/s2 and 0.4 .. 1.5 m/s in
                    surge, 5 .. 60 % of the drag at the top speed linear; see field_sheet.c */
    FIELD_VEHICLES
} field_vehicle_t;

/** A vehicle's data sheet. */
typedef struct {
    double parameter[SIM_PARAMETERS]; /**< Eq. 12-15 */
    double dry_kg;
    double tilt_inertia; /**< of roll and of pitch, with added mass; equal, so that yaw has no term
                              p q */
    double rigid_share;  /**< share of the moments of inertia that is not added mass */
    double tilt_linear, tilt_quadratic; /**< drag of roll and of pitch, positive */
    double cb_above_m;                  /**< centre of buoyancy above the centre of gravity */
    double length_m;
    double noise_arm_m;       /**< moments of the disturbance in Nm relative to its forces in N */
    double amplitude[6];      /**< largest commanded force and moment of the excitation [N, Nm] */
    double max_acceleration;  /**< as the user configures the filter [m/s2]; 0: its default */
    double largest_parameter; /**< bounds that the user gives; 0: those of the paper */
    bool fast;                /**< needs averaged rows with a DVL at 5 Hz; the user knows that */
    double speed_m_s;         /**< of the lawnmower */
    double bandwidth;         /**< of the position controllers [rad/s] */
    int thrusters;
    double thruster_max_N;
    double matrix[6][SIM_THRUSTERS]; /**< body wrench per newton of each, as the operator knows */
} field_sheet_t;

typedef enum {
    FIELD_EXCITED,   /**< thrust given to field_step, added to hover thrust; a weak restoring force
                          more than 3 m from the initial depth; with a wall, a strong damped one
                          more than 0.1 m from it */
    FIELD_JOYSTICK,  /**< sticks of a pilot: open loop, except for occasional depth corrections */
    FIELD_ASSISTED,  /**< the same in surge and sway; the other sticks move the references of a
                          PID of depth and one of heading */
    FIELD_LAWNMOWER, /**< PID of position, heading and depth along parallel legs of 18 m */
    FIELD_STATION,   /**< PID of position, depth and heading at one place */
    FIELD_DRIVERS
} field_driver_t;

/** One kind of mismatch. */
typedef struct {
    const char *name;          /**< on the command line, "thrust_backward" */
    const char *unit;          /**< "m", "deg", "" */
    const char *about;         /**< short description */
    double low, high;          /**< range at strength 1; equal: always this size */
    double chance;             /**< share of the runs in which it is drawn */
    double min_size, max_size; /**< what field_set and field_init accept */
    enum {
        FIELD_NORMAL,  /**< standard deviation `high` */
        FIELD_UNIFORM, /**< low .. high */
        FIELD_ALONE    /**< never drawn, only set by field_set */
    } draw;
    bool force; /**< drawn forces [N] of a vehicle with 100 N in surge; else in proportion */
} field_mismatch_t;

/** Largest number of kinds of mismatch. */
#define FIELD_MISMATCHES 64

typedef struct {
    field_vehicle_t vehicle;
    field_driver_t driver;
    uint64_t seed;   /**< of noise, disturbance, driver, of the details of a mismatch (which
                          thruster, which direction), and of the vehicle FIELD_ANY */
    double length_s; /**< of the run [s], > 0: sag, battery and fouling reach their size at its end,
                          ballast is added halfway; default 240 (excited), 600 */
    double size[FIELD_MISMATCHES]; /**< of each mismatch, in its unit; 0: none */
    double
        alternate_m; /**< lawnmower, station: the reference alternates by this much to each side of
                          its path [m], and half as much in heading [rad]; 0: not */
} field_config_t;

/** Output to the identifier in a tick of SIM_TICK_US. */
typedef struct {
    uint64_t t_us;                         /**< clock of the identifier at the end of the tick */
    sim_measurement_t sensor[SIM_SENSORS]; /**< by sim_sensor_id_t, with timestamps */
    bool reported;                         /**< a wrench was reported in this tick */
    uint64_t reported_us;                  /**< its timestamp: reported start of its action, until
                                                the next one; correct: the start of the tick */
    double wrench[6];                      /**< the reported wrench [N, Nm] */
    double thruster_N[SIM_THRUSTERS];      /**< the reported thrust of each thruster [N] */
    double reference[6];                   /**< velocity of the controllers' reference in its own
                                                axes [m/s, rad/s]; other drivers: 0 */
} field_output_t;

/** The truth at the end of the tick. */
typedef struct {
    double t_s;
    double position[3], euler[3]; /**< NED [m], ZYX [rad] */
    double nu[6], nu_dot[6];      /**< through the water [m/s, rad/s], and its derivative */
    double delivered[6];          /**< true wrench of the thrusters [N, Nm] */
    double reported[6];           /**< reported wrench, without timestamp errors [N, Nm] */
    double disturbance[6];        /**< waves and coloured noise, not of the hull [N, Nm] */
    double hull[6];               /**< left side of the equations of motion, M nu' + forces of the
                                       hull: equal to delivered + disturbance [N, Nm] */
} field_truth_t;

/** The current true parameters of Eq. 12-15 by SIM_M_U ..: masses
 * (rigid body and added, ballast included, away from walls), W-B, and drag without mismatches. */
typedef struct {
    double parameter[SIM_PARAMETERS];
    double dry_kg; /**< mass in air */
} field_built_t;

/* ---- the parts; field_parts.h says which file writes each of them ---- */

/** The body in the water. Drag coefficients: positive dissipates. */
typedef struct {
    double dry_kg, weight_N, buoyancy_N;
    double r_g[3], r_b[3]; /* centres of gravity and buoyancy [m] */
    double inertia[3];     /* of the rigid body about its centre of gravity */
    double added[6][6];    /* added mass, away from walls */
    double mass[6][6];     /* rigid body and added mass */
    double inverse[6][6];  /* of mass */
    double linear[6], quadratic[6];
    double asymmetry[6];  /* drag times (1 + asymmetry) forward, (1 - asymmetry) backward */
    double exponent_loss; /* reduction of the exponent of quadratic drag */
    double cross_flow;    /* part of the quadratic drag that follows the whole speed .. */
    double half_m;        /* .. at half the length */
    double fouling;       /* present relative increase of drag */
    double side_centre_m; /* point of action of linear side drag, ahead of the origin */
    double lift_sway, lift_yaw, lift_heave; /* coefficients of |u| v, u v, u^2 */
    double cable_N, cable_arm[3];           /* force; point of attachment */
    double cable_to[3];                     /* direction or point */
    bool cable_point;                       /* cable_to is a point in the world; else a direction */
    double current[3];                      /* of the water over ground, NED [m/s] */
    double wall;                            /* relative rise of mass and drag at FIELD_NEAR_M */
    double seabed_m;                        /* depth of the bottom */
} field_hull_t;

/** Commands that have not yet taken effect. */
#define FIELD_RING 32
typedef struct {
    uint64_t t_us; /* start of its tick */
    double command_N[SIM_THRUSTERS];
    double reported_N[SIM_THRUSTERS]; /* reported thrust */
} field_command_t;

typedef struct {
    double gain[SIM_THRUSTERS];   /* ratio of true to reported thrust at the start of the run */
    double speed[SIM_THRUSTERS];  /* propeller speed, sqrt(N), signed */
    double slewed[SIM_THRUSTERS]; /* speed commanded by the electronics, likewise */
    double force[SIM_THRUSTERS];  /* after the lag of force [N] */
    field_command_t ring[FIELD_RING];
    unsigned written, reported; /* numbers of entered and of reported commands */
    unsigned acting;            /* number of the acting command, plus one */
} field_thrust_t;

typedef struct {
    sim_rng_t noise, loss;
    uint64_t period_us, next_us; /* period and next time of its measurements */
    uint64_t late_us;            /* unreported delay from measurement to timestamp */
    sim_measurement_t queue[SIM_QUEUE];
    uint64_t arrival_us[SIM_QUEUE];
    unsigned head, count;
} field_sensor_t;

typedef struct {
    field_sensor_t sensor[SIM_SENSORS];
    double imu_mount[3][3], dvl_mount[3][3]; /* body from sensor */
    double gyro_bias[3];
    double velocity[3], jump[3]; /* filter of the autopilot, NED [m/s] */
    int64_t clock_us;            /* additional lag of the clock of the instruments */
    sim_rng_t clock, filter;
} field_sensing_t;

typedef struct {
    double position[3];                     /* as known to the operator, NED */
    double euler[3], rates[3], velocity[3]; /* last measured */
    bool has_velocity;
    double sum[4]; /* integrals of the controllers [N, Nm] */
    double reference[3], reference_speed, reference_heading;
    double from[2];                 /* start of the leg */
    double aside[4], aside_rate[4]; /* of the reference: ahead, to starboard, down, heading */
    double aside_to[4], aside_s[4]; /* its target; end of its validity */
    double reference_nu[6];         /* velocity of the reference, in its axes */
    sim_rng_t aside_rng;
    int leg;
    double stick[4], stick_to[4], stick_s[4]; /* deflection; its target; end of its validity */
    bool deep;                                /* the pilot is correcting the depth */
    sim_rng_t rng;
    double hover_N[SIM_THRUSTERS];
    double mix[SIM_THRUSTERS][4]; /* thrust by X Y Z N: pseudo-inverse */
} field_pilot_t;

/** A field vehicle: a plain struct that may be copied to branch a run. */
typedef struct {
    field_config_t cfg;
    field_sheet_t sheet;
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

/** Returns the number of kinds of mismatch; *table is their table. */
int field_mismatches(const field_mismatch_t **table);

/** Writes the defaults: no mismatch, the vehicle as in its data sheet, the default length. */
void field_defaults(field_config_t *cfg, field_vehicle_t vehicle, field_driver_t driver,
                    uint64_t seed);

/** Draws every mismatch of the mixture from cfg->seed, scaled by `strength`, and forces by the
 * vehicle (field_mismatch_t.force). Mismatches that are never drawn become 0. The variation of the
 * hull ("hull") is not a mismatch: it has its full size at every strength, including 0.
 * @param cfg its vehicle is less than FIELD_VEHICLES */
void field_draw(field_config_t *cfg, double strength);

/** Sets one mismatch, in its unit, without scaling by the vehicle. Returns false and does nothing
 * if there is no such name, or if its size is out of range. */
bool field_set(field_config_t *cfg, const char *name, double size);

/** Writes the data sheet of a vehicle.
 * @param vehicle less than FIELD_VEHICLES
 * @param seed    FIELD_ANY: the same vehicle for the same seed; not read otherwise */
void field_sheet(field_vehicle_t vehicle, uint64_t seed, field_sheet_t *sheet);

/** Starts at time 0. Returns false and does nothing if a size or enumeration is out of range. */
bool field_init(field_t *field, const field_config_t *cfg);

/** Advances by one tick of SIM_TICK_US.
 * @param thruster_N [thrusters] FIELD_EXCITED: force commanded in addition to hover; NULL: none.
 *                   Not read with other drivers
 * @param out        written */
void field_step(field_t *field, const double *thruster_N, field_output_t *out);

/** The truth at the end of the last tick. */
const field_truth_t *field_truth(const field_t *field);

/** Writes the current true parameters of the vehicle. */
void field_built(const field_t *field, field_built_t *built);

#ifdef __cplusplus
}
#endif

#endif
