/**
 * @file doctor.h
 * The log doctor: finds slips in a log before a vehicle is identified from it.
 *
 * It takes one row at a time, at constant memory. It averages all columns over cells of 0.1 s and
 * tests identities that hold for every vehicle, over the whole log and over parts of it:
 *
 *   the rate of the attitude, turned into body axes, is p, q, r         (Fossen 2011, Eq. 2.26)
 *   the rate of depth and position is the velocity, turned into NED     (Fossen 2011, Eq. 2.17)
 *   the specific force of an accelerometer is acceleration less gravity (Farrell 2008, 11.1)
 *   the acceleration follows its own input, with its sign, a little later
 *   a vehicle weighs no less than its dry mass, if that is known.
 *
 * The acceleration is explained by a regression with drag and coupling terms. Which of several
 * explanations holds is decided by the ratio of their likelihoods. A sentence names a cause only if
 * these tests determine it; otherwise it names all columns that the contradiction involves.
 *
 * Memory: sizeof(doctor_t), about 0.9 MB, for a log of any length. Cost: some 5 us a row at 50 Hz.
 */
#ifndef PROGRAM_DOCTOR_H
#define PROGRAM_DOCTOR_H

#include <stdint.h>

#include "../log/csv.h"
#include "../log/log_samples.h"
#include "../log/units.h"

/** How bad it is. */
typedef enum {
    DOCTOR_NOTE,    /**< worth knowing */
    DOCTOR_WARNING, /**< an identification is less accurate, or the cause is uncertain */
    DOCTOR_ERROR    /**< an identification would be wrong, or is not possible */
} doctor_severity_t;

/** What was found. */
typedef enum {
    DOCTOR_ANGLE_DEGREES,      /**< an angle (column) is in degrees */
    DOCTOR_RATE_DEGREES,       /**< a rate is in degrees per second */
    DOCTOR_ANGLE_SIGN,         /**< an angle, or its rate (other), has the wrong sign */
    DOCTOR_RATE_SIGN,          /**< a rate has the wrong sign */
    DOCTOR_RATE_EXCHANGED,     /**< two rates, or their angles, are exchanged */
    DOCTOR_FRAME,              /**< signs as between FRD and FLU axes (NED and ENU) */
    DOCTOR_WORLD_FRAME,        /**< velocities to the north and east, not of body axes */
    DOCTOR_MOUNTING,           /**< the velocity sensor is turned about the vertical */
    DOCTOR_QUATERNION,         /**< the quaternion is x, y, z, w, or turns from world to body */
    DOCTOR_ATTITUDE_SHIFT,     /**< the attitude is late (value > 0) against the rates [s] */
    DOCTOR_ATTITUDE,           /**< attitude and rate contradict each other, unexplained */
    DOCTOR_INPUT_SIGN,         /**< an input has the wrong sign */
    DOCTOR_VELOCITY_SIGN,      /**< a velocity has the wrong sign */
    DOCTOR_EITHER_SIGN,        /**< an input (column) or its velocity (other) has the wrong sign */
    DOCTOR_INPUT_EXCHANGED,    /**< two inputs are exchanged */
    DOCTOR_VELOCITY_EXCHANGED, /**< two velocities are exchanged */
    DOCTOR_EITHER_EXCHANGED,   /**< two inputs, or their velocities, are exchanged */
    DOCTOR_INPUT_SHIFT,        /**< motion is late (value > 0) against an input [s] */
    DOCTOR_VELOCITY_SHIFT,     /**< u, v, w are late (value > 0) against r [s] */
    DOCTOR_INPUT_WITHOUT_EFFECT,
    DOCTOR_DEPTH_SIGN,      /**< depth and heave velocity have opposite signs */
    DOCTOR_DEPTH,           /**< depth and velocity contradict each other, unexplained */
    DOCTOR_POSITION,        /**< position and velocity contradict each other */
    DOCTOR_FORCE_UNIT,      /**< specific force in multiples of g */
    DOCTOR_FORCE_SIGN,      /**< an axis of the accelerometer has the wrong sign */
    DOCTOR_FORCE_EXCHANGED, /**< two axes of the accelerometer are exchanged */
    DOCTOR_NO_GRAVITY,      /**< specific force without gravity */
    DOCTOR_THRUSTER_SIGN,   /**< a thruster has the wrong sign */
    DOCTOR_THRUSTER_SWAP,   /**< two thrusters are exchanged */
    DOCTOR_THRUSTER_HIDDEN, /**< a reversed or exchanged thruster would not be seen */
    DOCTOR_SCALE,           /**< another unit: pulse widths, velocities, forces, depth */
    DOCTOR_OFFSET,          /**< a velocity has a constant offset (value) */
    DOCTOR_HELD,            /**< velocities repeat their value */
    DOCTOR_OUTAGE,          /**< velocities stand still: no samples */
    DOCTOR_OUTLIER,         /**< velocities that no vehicle has: marks, jumps, zeros */
    DOCTOR_STUCK,           /**< a column never changes */
    DOCTOR_MISSING,         /**< a column is missing, and counts as zero */
    DOCTOR_QUANTISED,       /**< a column has few different values */
    DOCTOR_SATURATED,       /**< an input stays at its largest value */
    DOCTOR_VOLTAGE,         /**< the supply voltage sags */
    DOCTOR_TIME,            /**< time goes back or stands still */
    DOCTOR_GAPS,            /**< rows are missing */
    DOCTOR_VELOCITY_GAPS,   /**< velocities are missing between rows (value: part lost) */
    DOCTOR_SLOW,            /**< rows are too far apart for this vehicle */
    DOCTOR_SHORT,           /**< too little data */
    DOCTOR_MOTION,          /**< seconds of usable motion of each DoF */
    DOCTOR_CODES
} doctor_code_t;

/** One finding. */
typedef struct {
    doctor_severity_t severity;
    doctor_code_t code;
    int column, other;   /**< columns (csv.h), or -1 */
    double value;        /**< as the code says; else 0 */
    double from_s, to_s; /**< the part of the log, in its time */
    char text[360];      /**< the sentence: what is wrong, where, what to do */
} doctor_finding_t;

enum { DOCTOR_FINDINGS = 48 };

#include "doctor_internal.h"

/** Starts. has: which columns the log has. */
void doctor_init(doctor_t *doctor, const bool has[CSV_COLUMNS]);

/** Takes the thrusters of the log as its inputs, before the first row. use: log_use_thrusters; it
 * must outlive the doctor. */
void doctor_use(doctor_t *doctor, const log_use_t *use);

/** Tells the dry mass of the vehicle, before doctor_finish. 0: not known. Masses that follow from
 * forces and velocities in SI are not below it. known_force: a known force shows the scale of the
 * thrust, so a mass that is too small need not be an error. */
void doctor_dry_mass(doctor_t *doctor, double dry_mass_kg, bool known_force);

/** Takes a row. A value that is not a number is absent: no new sample. A time that is not after the
 * one before is reported, and the row skipped. */
void doctor_feed(doctor_t *doctor, const csv_row_t *row);

/** Ends, and writes findings (most severe first), verdict and usable. */
void doctor_finish(doctor_t *doctor);

#endif
