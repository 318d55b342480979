/**
 * @file auvid_uncertain_table_internal.h
 * Private: the kinds of uncertain inputs, one row each. Columns, priors, causes and sentences read
 * this table. A new input is a row, its enumerator, its member of auvid_uncertain_config_t, and its
 * formula in auvid_uncertain_columns.c.
 */
#ifndef AUVID_UNCERTAIN_TABLE_INTERNAL_H
#define AUVID_UNCERTAIN_TABLE_INTERNAL_H

#include "auvid/uncertain.h"

#include "../base/auvid_math_internal.h"

/** What a column is: below OWN_INPUTS one of auvid_uncertain_input_t. */
enum {
    OWN_INPUTS = AUVID_UNCERTAIN_SHARED,
    INPUT_DELAY = OWN_INPUTS,
    INPUT_ASYMMETRY,
    INPUT_FORCE,
    INPUT_CROSS,
    INPUT_LIFT,
    INPUT_ASTERN, /* centre of gravity astern */
    INPUT_PORT,   /* centre of gravity to port */
    INPUT_CROSS_FLOW, /* drag that follows the whole speed */
    INPUTS
};

/** What a column is formed from. Those of the hull are made orthogonal to the drag; those of the
 * weight if the model has neither roll nor pitch. */
enum {
    INPUT_FROM_THRUST, /* of all thrusters */
    INPUT_FROM_GAIN,   /* of one thruster */
    INPUT_FROM_MOTION, /* from the wrench of another motion than the measured one */
    INPUT_FROM_HULL,
    INPUT_FROM_WEIGHT
};

/** Equations that current and lever arm change, a bit each: PLANAR in the table. */
#define AUVID_UNCERTAIN_PLANAR (1u << AUVID_SURGE | 1u << AUVID_SWAY | 1u << AUVID_YAW)

#define UNCERTAIN_TIMING                                                                           \
    "thrust acts later than stamped, by ", "thrust acts earlier than stamped, by ", "s",           \
        "check time stamps and the propellers' lag"
#define UNCERTAIN_LOSS                                                                             \
    "thrust falls with speed, by ", "thrust rises with speed, by ", "% per m/s",                   \
        "measure it under way, or check the drag's law"
#define UNCERTAIN_WATER "use the DVL's water lock, or look for a cable"
#define UNCERTAIN_ARM "measure its lever arm and the centre of mass, which look alike"
#define UNCERTAIN_ANGLE "measure its mounting angle"
#define UNCERTAIN_MOUNT "check lever arms and mounting of DVL and IMU"
#define UNCERTAIN_TRIM "check the trim and the IMU's mounting"

/**
 * ROW(input, deviation, from, equations, prior, class, above, below, unit, remedy), in the order of
 * the inputs; the gains of all thrusters have one row:
 *   input      what the column is
 *   deviation  member of auvid_uncertain_config_t; 0: there is no column
 *   from       INPUT_FROM_<from>
 *   equations  of which DoF: a sum of names; or of those with thrust
 *              (ACTUATED), drag (DRAGGED), quadratic drag (SQUARE), no constant force as free
 *              parameter (UNFORCED; in roll and pitch it is that of the weight), or in a model of
 *              roll or pitch only (TILTED): where the model has neither, both are small. With an
 *              arm ahead turns of pitch look like heave, and with a DVL at an angle speed does,
 *              which turns a vehicle that moves ahead (Munk moment)
 *   prior      the column's standard deviation: AS_CONFIGURED, or by a function of
 *              auvid_uncertain_table.c; then the cause's value is in the unit of the COLUMN(), or
 *              RELATIVE(), as configured
 *   class      AUVID_CAUSE_<class>; COUNT: never a cause
 * and the sentence of the cause:
 *   above      what a value above zero means
 *   below      and one below
 *   unit       of its size; "%...": a part of one; NULL: no size
 *   remedy
 */
#define AUVID_UNCERTAIN_TABLE(ROW)                                                                 \
    ROW(AUVID_UNCERTAIN_BACKWARD, backward, THRUST, ACTUATED, AS_CONFIGURED, CURVE,                \
        "backward thrust is weaker than supplied, by ",                                            \
        "backward thrust is stronger than supplied, by ", "%", "measure the thrusters astern")     \
    ROW(AUVID_UNCERTAIN_DEAD_BAND, dead_band, THRUST, ACTUATED, COLUMN(table_dead_band), CURVE,    \
        "the dead band is wider than supplied, by ",                                               \
        "the dead band is narrower than supplied, by ", "N",                                       \
        "measure the thrusters at small commands")                                                 \
    ROW(AUVID_UNCERTAIN_CURVE, curve, THRUST, ACTUATED, AS_CONFIGURED, CURVE,                      \
        "the thrust curve's exponent is higher than supplied, by ",                                \
        "the thrust curve's exponent is lower than supplied, by ", "",                             \
        "measure thrust at half command")                                                          \
    ROW(AUVID_UNCERTAIN_INFLOW, inflow, THRUST, ACTUATED, COLUMN(table_half), INFLOW,              \
        UNCERTAIN_LOSS)                                                                            \
    ROW(AUVID_UNCERTAIN_BILINEAR, inflow, THRUST, ACTUATED, COLUMN(table_half), INFLOW,            \
        UNCERTAIN_LOSS)                                                                            \
    ROW(AUVID_UNCERTAIN_SAG, sag, THRUST, ACTUATED, AS_CONFIGURED, SAG,                            \
        "thrust falls with time, by ", "thrust rises with time, by ", "% in 4 minutes",            \
        "watch the battery, look for fouling")                                                     \
    ROW(AUVID_UNCERTAIN_LAG, lag_s, THRUST, ACTUATED, AS_CONFIGURED, TIMING, UNCERTAIN_TIMING)     \
    ROW(AUVID_UNCERTAIN_CURRENT_X, current, MOTION, PLANAR, AS_CONFIGURED, CURRENT,                \
        "a current sets to the north, with ", "a current sets to the south, with ", "m/s",         \
        UNCERTAIN_WATER)                                                                           \
    ROW(AUVID_UNCERTAIN_CURRENT_Y, current, MOTION, PLANAR, AS_CONFIGURED, CURRENT,                \
        "a current sets to the east, with ", "a current sets to the west, with ", "m/s",           \
        UNCERTAIN_WATER)                                                                           \
    ROW(AUVID_UNCERTAIN_ARM_X, arm_m, MOTION, PLANAR + TILTED(HEAVE + PITCH), AS_CONFIGURED,       \
        MOUNTING, "the DVL is further ahead than configured, by ",                                 \
        "the DVL is further astern than configured, by ", "m", UNCERTAIN_ARM)                      \
    ROW(AUVID_UNCERTAIN_ARM_Y, arm_m, MOTION, PLANAR + TILTED(HEAVE), AS_CONFIGURED, MOUNTING,     \
        "the DVL is further to starboard than configured, by ",                                    \
        "the DVL is further to port than configured, by ", "m", UNCERTAIN_ARM)                     \
    ROW(AUVID_UNCERTAIN_ARM_Z, arm_m, MOTION, TILTED(SURGE + SWAY + HEAVE), AS_CONFIGURED,         \
        MOUNTING, "the DVL is further down than configured, by ",                                  \
        "the DVL is further up than configured, by ", "m", UNCERTAIN_ARM)                          \
    ROW(AUVID_UNCERTAIN_DVL_PITCH, mount_rad, MOTION, TILTED(HEAVE + PITCH), AS_CONFIGURED,        \
        MOUNTING, "the DVL is turned further bow up than configured, by ",                         \
        "the DVL is turned further bow down than configured, by ", "rad", UNCERTAIN_ANGLE)         \
    ROW(AUVID_UNCERTAIN_DVL_YAW, mount_rad, MOTION, TILTED(SWAY + YAW), AS_CONFIGURED, MOUNTING,   \
        "the DVL is turned further to starboard than configured, by ",                             \
        "the DVL is turned further to port than configured, by ", "rad", UNCERTAIN_ANGLE)          \
    ROW(AUVID_UNCERTAIN_FILTER, filter_s, MOTION, PLANAR + TILTED(HEAVE), AS_CONFIGURED, TIMING,   \
        "the velocity is filtered in the world's axes, with a time constant of ",                  \
        "the velocity leads in the world's axes, by ", "s", "supply that of the DVL")              \
    ROW(AUVID_UNCERTAIN_DVL_LATE, dvl_late_s, THRUST, PLANAR + HEAVE, AS_CONFIGURED, TIMING,       \
        "the DVL is later than the attitude, by ", "the attitude is later than the DVL, by ", "s", \
        "check their time stamps, and that the velocity is not filtered")                          \
    ROW(AUVID_UNCERTAIN_FORCE_RESPONSE, response_s2, THRUST, SURGE + SWAY + HEAVE, AS_CONFIGURED,  \
        COUNT, NULL, NULL, NULL, NULL)                                                             \
    ROW(AUVID_UNCERTAIN_MOMENT_RESPONSE, response_s2, THRUST, ROLL + PITCH + YAW, AS_CONFIGURED,   \
        COUNT, NULL, NULL, NULL, NULL)                                                             \
    ROW(AUVID_UNCERTAIN_GAIN, gain, GAIN, ACTUATED, AS_CONFIGURED, COUNT, NULL, NULL, NULL, NULL)  \
    ROW(INPUT_DELAY, delay_s, THRUST, ACTUATED, AS_CONFIGURED, TIMING, UNCERTAIN_TIMING)           \
    ROW(INPUT_ASYMMETRY, asymmetry, HULL, DRAGGED, RELATIVE(table_asymmetry), ASYMMETRY,           \
        "drag is larger in the positive direction, by ",                                           \
        "drag is smaller in the positive direction, by ", "%", "the model's is the mean of both")  \
    ROW(INPUT_FORCE, force, HULL, UNFORCED, COLUMN(table_force), MOUNTING,                         \
        "a constant force acts, of ", "a constant force acts, of -", "N", UNCERTAIN_MOUNT)         \
    ROW(INPUT_CROSS, cross, HULL, SWAY + YAW, RELATIVE(table_cross), MOUNTING,                     \
        "sway and yaw are coupled", "sway and yaw are coupled", NULL, UNCERTAIN_MOUNT)             \
    ROW(INPUT_LIFT, cross, HULL, HEAVE + YAW, RELATIVE(table_lift), MOUNTING, "the hull has lift", \
        "the hull has lift", NULL, UNCERTAIN_MOUNT)                                                \
    ROW(INPUT_ASTERN, gravity_m, WEIGHT, PITCH + YAW, RELATIVE(table_weight), MOUNTING,            \
        "the centre of gravity is astern, by ", "the centre of gravity is ahead, by ", "m",        \
        UNCERTAIN_TRIM)                                                                            \
    ROW(INPUT_PORT, gravity_m, WEIGHT, ROLL + YAW, RELATIVE(table_weight), MOUNTING,               \
        "the centre of gravity is to port, by ", "the centre of gravity is to starboard, by ",     \
        "m", UNCERTAIN_TRIM)                                                                       \
    ROW(INPUT_CROSS_FLOW, cross_flow, HULL, SQUARE, RELATIVE(table_cross_flow), INFLOW,            \
        "drag grows with the speed of the other axes",                                             \
        "drag falls with the speed of the other axes", NULL,                                       \
        "the model's drag is that of each axis alone")

/** The numbers of a row. */
typedef struct {
    auvid_real_t (*prior)(const auvid_uncertain_t *u, const auvid_metric_t *m,
                          auvid_real_t deviation, int j);
    bool relative;
    uint8_t deviation_at; /* in auvid_uncertain_config_t [bytes] */
    uint8_t from, class;
    uint16_t equations;
} auvid_uncertain_row_t;

extern const auvid_uncertain_row_t auvid_uncertain_table[];

/** Row of an input. */
#define UNCERTAIN_ROW(input)                                                                       \
    ((int)(input) < (int)AUVID_UNCERTAIN_GAIN ? (int)(input)                                       \
     : (int)(input) < (int)OWN_INPUTS         ? (int)AUVID_UNCERTAIN_GAIN                          \
                                              : (int)(input) - (AUVID_MAX_THRUSTERS - 1))

static inline const auvid_uncertain_row_t *auvid_uncertain_row(int input)
{
    return &auvid_uncertain_table[UNCERTAIN_ROW(input)];
}

/** Returns the configured standard deviation of an input. */
auvid_real_t auvid_uncertain_configured(const auvid_uncertain_t *u, int input);

/** Returns DoF j's drag at 1 m/s or rad/s, of one curve for both directions, by the last solution.
 */
auvid_real_t auvid_uncertain_mean_drag(const auvid_uncertain_t *u, const auvid_metric_t *m, int j);

/** Write linear and quadratic drag of DoF j's hull: those of the last solution, with what the
 * asymmetry has of them. */
void auvid_uncertain_hull_drag(const auvid_uncertain_t *u, const auvid_metric_t *m, int j,
                               auvid_real_t size[2]);

/** Returns the linear part of DoF j's drag at 1 m/s or rad/s, by the last solution. */
auvid_real_t auvid_uncertain_linear_part(const auvid_uncertain_t *u, const auvid_metric_t *m,
                                         int j);

/** Returns half the length of the vehicle [m], roughly, by the last solution: twice the radius of
 * gyration. 0: not known. */
auvid_real_t auvid_uncertain_half_length(const auvid_uncertain_t *u, const auvid_metric_t *m);

/** Returns the standard deviation of the prior of a column of DoF j. */
auvid_real_t auvid_uncertain_sigma(const auvid_uncertain_t *u, const auvid_metric_t *m, int input,
                                   int j);

/** Returns the equations that a current, lever arm or mounting angle changes, a bit each; 0: it has
 * no column. */
uint8_t auvid_uncertain_moved(const auvid_uncertain_t *u, const auvid_metric_t *m, int input);

/** Returns a thruster's largest force in either direction [N]. */
static inline auvid_real_t auvid_uncertain_largest(const auvid_thruster_t *thruster)
{
    return auvid_max(thruster->max_N, -thruster->min_N);
}

/** Is DoF j roll or pitch? */
static inline bool auvid_uncertain_tilts(int j)
{
    return j == AUVID_ROLL || j == AUVID_PITCH;
}

/** Is the column of this input made orthogonal to the drag? */
bool auvid_uncertain_of_hull(const auvid_metric_t *m, int input);

/** Is it formed from the thrust, else from motion? */
static inline bool auvid_uncertain_of_thrust(int input)
{
    return auvid_uncertain_row(input)->from <= INPUT_FROM_GAIN;
}

/** Has DoF j's equation a column of this input? */
bool auvid_uncertain_has(const auvid_uncertain_t *u, const auvid_metric_t *m, int input, int j);

#endif
