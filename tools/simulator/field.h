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
 * drive: the identifier's excitation, a joystick pilot, a PID lawnmower, station keeping.
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
    FIELD_EXCITED,   /**< thrust as field_step is told, on top of hover thrust */
    FIELD_JOYSTICK,  /**< a pilot's sticks: open loop, but for holding depth now and then */
    FIELD_LAWNMOWER, /**< PID of heading, depth and surge along parallel legs */
    FIELD_STATION,   /**< PID of position, depth and heading at one place */
    FIELD_DRIVERS
} field_driver_t;

/** One kind of mismatch. */
typedef struct {
    const char *name;  /**< on the command line, "thrust_backward" */
    const char *unit;  /**< "m", "deg", "" */
    const char *about; /**< half a sentence */
    enum {
        FIELD_NORMAL,  /**< standard deviation `high` */
        FIELD_UNIFORM, /**< low .. high */
        FIELD_ALONE    /**< never drawn: by field_mismatch only */
    } draw;
    double low, high;  /**< at strength 1 */
    double chance;     /**< share of the runs in which it is drawn */
    bool force;        /**< forces [N, Nm]: times 0.3 for the ROV */
} field_mismatch_t;

/** Most kinds of mismatch. */
#define FIELD_MISMATCHES 64

typedef struct {
    field_vehicle_t vehicle;
    field_driver_t driver;
    uint64_t seed;                 /**< of noise, disturbance, driver, and of what a size alone does
                                        not tell (which thruster, which direction) */
    double size[FIELD_MISMATCHES]; /**< of each mismatch, in its unit; 0: none */
} field_config_t;

/** What the identifier's side gets in a tick of SIM_TICK_US. */
typedef struct {
    uint64_t t_us;                         /**< of the identifier's clock, at the end of the tick */
    sim_measurement_t sensor[SIM_SENSORS]; /**< by sim_sensor_id_t, with their stamps */
    bool told;                             /**< a wrench was told in this tick */
    uint64_t told_us;                      /**< its stamp: from when it is said to act */
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
    double hull[6];               /**< left side of the equations of motion, M nu' + all that the hull
                                       does: delivered + disturbance [N, Nm] */
} field_truth_t;

/** The parameters of Eq. 12-15 that the vehicle was built with, as it is at present: masses
 * (rigid body and added), W-B, and its drag without mismatch, by SIM_M_U .. */
typedef struct {
    double parameter[SIM_PARAMETERS];
} field_built_t;

typedef struct field_s field_t; /* to be completed here as a plain struct */

/** The table of kinds. @return how many */
int field_mismatches(const field_mismatch_t **table);

/** No mismatch, the vehicle as in its data sheet. */
void field_defaults(field_config_t *config, field_vehicle_t vehicle, field_driver_t driver,
                    uint64_t seed);

/** Draw every mismatch of the mixture anew, `strength` times as large, from config->seed. */
void field_draw(field_config_t *config, double strength);

/** Set one. False: there is no such name, or its size is out of range. */
bool field_set(field_config_t *config, const char *name, double size);

/** Largest commanded force and moment of the vehicle's excitation [N, Nm], by DoF. */
void field_amplitude(field_vehicle_t vehicle, double amplitude[6]);

/** Body wrench per newton of each thruster, as the operator knows it, and its largest force [N].
 * @return how many thrusters */
int field_thrusters(field_vehicle_t vehicle, double matrix[6][SIM_THRUSTERS], double *most_N);

/** Start at time 0. False, and nothing done: a size or an enumeration is out of range. */
bool field_init(field_t *field, const field_config_t *config);

/** Advance by one tick of SIM_TICK_US.
 * @param thruster_N [thrusters] FIELD_EXCITED: force commanded in addition to hover; null: none. Else
 *                   not read
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
