/**
 * @file field_parts.h
 * The interface between the files of the field simulator. field.c runs a tick, field_hull.c has the
 * body in the water, field_sheet.c the data sheets of the vehicles, field_thrust.c the thrusters,
 * field_sensors.c the sensors and clocks, field_driver.c the drivers, field_mismatch.c the table of
 * mismatches.
 */
#ifndef FIELD_PARTS_H
#define FIELD_PARTS_H

#include "field.h"

#define FIELD_PI 3.14159265358979323846
#define FIELD_DEGREE (FIELD_PI / 180.0)
#define FIELD_GRAVITY 9.81
/** Depth of the start and of the bottom [m]; with a wall, the bottom is 1 m below the start. */
#define FIELD_START_M 20.0
#define FIELD_SEABED_M 50.0
/** Distance from the bottom at which "wall" has its size. */
#define FIELD_NEAR_M 0.5

/** The kinds of mismatch, in the order of the table. */
enum {
    FIELD_IMU_ROLL,
    FIELD_IMU_PITCH,
    FIELD_IMU_YAW,
    FIELD_GYRO_BIAS,
    FIELD_ATTITUDE_DELAY,
    FIELD_DVL_ARM_X,
    FIELD_DVL_ARM_Y,
    FIELD_DVL_ARM_Z,
    FIELD_DVL_YAW,
    FIELD_DVL_ROLL,
    FIELD_DVL_PITCH,
    FIELD_DVL_SCALE,
    FIELD_DVL_LATENCY,
    FIELD_DVL_LOST,
    FIELD_DVL_OUTLIERS,
    FIELD_DVL_PARTIAL,
    FIELD_THRUST_COMMON,
    FIELD_THRUST_EACH,
    FIELD_THRUST_BACKWARD,
    FIELD_THRUST_SAG,
    FIELD_THRUST_EXPONENT,
    FIELD_THRUST_DEAD_BAND,
    FIELD_THRUST_LAG,
    FIELD_THRUST_ADVANCE,
    FIELD_THRUST_LATE,
    FIELD_DRAG_ASYMMETRY,
    FIELD_DRAG_EXPONENT,
    FIELD_CROSS,
    FIELD_CG_X,
    FIELD_CG_Y,
    FIELD_CABLE,
    FIELD_WAVES,
    FIELD_CURRENT,
    FIELD_DISTURBANCE,
    FIELD_HULL,
    FIELD_THRUST_FORCE_LAG,
    FIELD_FILTER_TAU,
    FIELD_FILTER_RESETS,
    FIELD_COMMAND_10HZ,
    FIELD_COMMAND_PWM,
    FIELD_SLEW,
    FIELD_BATTERY,
    FIELD_BATTERY_CORRECTED,
    FIELD_CLOCK_DRIFT,
    FIELD_CLOCK_JUMPS,
    FIELD_BALLAST,
    FIELD_WALL,
    FIELD_FOULING,
    FIELD_THRUST_SHAPES,
    FIELD_THRUST_BILINEAR,
    FIELD_CROSS_FLOW,
    FIELD_KINDS
};

/** Separate random streams, so that no mismatch changes the numbers of another. */
enum {
    FIELD_STREAM_SENSORS = 100, /* two per sensor */
    FIELD_STREAM_GYRO = 110,
    FIELD_STREAM_CLOCK,
    FIELD_STREAM_FILTER,
    FIELD_STREAM_THRUSTERS,
    FIELD_STREAM_HULL,
    FIELD_STREAM_ASYMMETRY,
    FIELD_STREAM_CROSS,
    FIELD_STREAM_CABLE,
    FIELD_STREAM_CURRENT,
    FIELD_STREAM_WAVES,
    FIELD_STREAM_DISTURBANCE,
    FIELD_STREAM_PILOT,
    FIELD_STREAM_ALTERNATE,
    FIELD_STREAM_SHEET,
    FIELD_STREAM_DRAW = 1000 /* plus the index of the kind */
};

/** Checks that all values are in range. */
bool field_config_is_good(const field_config_t *cfg);

/** x = r v, and r' v. */
void field_rotate(double r[3][3], const double v[3], double x[3]);
void field_rotate_back(double r[3][3], const double v[3], double x[3]);
void field_cross(const double a[3], const double b[3], double out[3]);

void field_hull_init(field_t *field);
/** Adds ballast [kg] at the origin. */
void field_hull_ballast(field_hull_t *hull, double kg);
/** Computes the derivatives of [position, euler, nu] under an external wrench. */
void field_hull_derivative(const field_hull_t *hull, const double state[12],
                           const double external[6], double derivative[12]);

void field_thrust_init(field_t *field);
/** Elapsed fraction of the run. */
double field_part_of_run(const field_t *field);
/** Sets the command of the new tick, clipped to the limits of the thrusters. */
void field_thrust_command(field_t *field, double command_N[SIM_THRUSTERS]);
/** Advances the thrusters by a substep of h seconds and writes the mean wrench. */
void field_thrust_advance(field_t *field, double h, double wrench[6]);
/** Writes the true and the reported wrench at the end of a substep. */
void field_thrust_truth(const field_t *field, double delivered[6], double reported[6]);
/** Writes the reports to the operator that are due. */
void field_thrust_report(field_t *field, field_output_t *out);

void field_sensors_init(field_t *field);
/** Takes the samples due in (before, now], which lasts h seconds and ends at field->t_us. */
void field_sensors_sample(field_t *field, const field_truth_t *before, const field_truth_t *now,
                          double h);
void field_sensors_deliver(field_t *field, field_output_t *out);

void field_pilot_init(field_t *field);
/** Computes the command of the new tick. */
void field_pilot_drive(field_t *field, const double *thruster_N, double command_N[SIM_THRUSTERS]);
/** Passes the measurements of a tick to the pilot. */
void field_pilot_observe(field_t *field, const field_output_t *out);

#endif
