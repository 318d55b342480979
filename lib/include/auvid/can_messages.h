/**
 * @file can_messages.h
 * Generated from lib/can/auvid.dbc by `make can`: do not edit.
 *
 * The messages of the bus as structs of physical values. can.h packs and unpacks them;
 * lib/can/README.md documents them. Packing rounds real numbers to the step of their signal;
 * integers are sent unchanged.
 */
#ifndef AUVID_CAN_MESSAGES_H
#define AUVID_CAN_MESSAGES_H

#include "auvid/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Version of the frames. Every heartbeat carries it. */
#define AUVID_CAN_PROTOCOL 10u
/** Default first identifiers of the two blocks (auvid_can_ids_t). */
#define AUVID_CAN_FAST_BASE 0x040u
#define AUVID_CAN_SLOW_BASE 0x400u
/** Number of messages in each block. */
#define AUVID_CAN_FAST_KINDS 6u
#define AUVID_CAN_SLOW_KINDS 21u

/** The messages, in the order of their identifiers. A smaller one has priority on the bus. */
typedef enum {
    AUVID_CAN_ABORT = 0,
    AUVID_CAN_TICK = 1,
    AUVID_CAN_THRUSTER_COMMAND_A = 2,
    AUVID_CAN_THRUSTER_COMMAND_B = 3,
    AUVID_CAN_ARM = 4,
    AUVID_CAN_TICK_DONE = 5,
    AUVID_CAN_IMU_ATTITUDE = 6,
    AUVID_CAN_IMU_RATES = 7,
    AUVID_CAN_THRUSTER_FEEDBACK_A = 8,
    AUVID_CAN_THRUSTER_FEEDBACK_B = 9,
    AUVID_CAN_DVL_BOTTOM = 10,
    AUVID_CAN_DVL_WATER = 11,
    AUVID_CAN_DVL_ALTITUDE = 12,
    AUVID_CAN_DEPTH = 13,
    AUVID_CAN_GPS = 14,
    AUVID_CAN_NAV_POSITION = 15,
    AUVID_CAN_NAV_VELOCITY = 16,
    AUVID_CAN_NAV_DEPTH = 17,
    AUVID_CAN_ESTIMATE = 18,
    AUVID_CAN_ESTIMATE_SIGMA = 19,
    AUVID_CAN_PROGRESS = 20,
    AUVID_CAN_HEALTH = 21,
    AUVID_CAN_HEARTBEAT = 22,
    AUVID_CAN_DRAG = 23,
    AUVID_CAN_DRAG_HALF_WIDTH = 24,
    AUVID_CAN_WRONG_INPUTS = 25,
    AUVID_CAN_WRONG_INPUT = 26,
    AUVID_CAN_KINDS = 27
} auvid_can_kind_t;

/** The messages that a node receives, in the order of their identifiers. */
typedef enum {
    AUVID_CAN_NODE_ABORT = 0,
    AUVID_CAN_NODE_TICK = 1,
    AUVID_CAN_NODE_THRUSTER_COMMAND_A = 2,
    AUVID_CAN_NODE_THRUSTER_COMMAND_B = 3,
    AUVID_CAN_NODE_ARM = 4,
    AUVID_CAN_NODE_IMU_ATTITUDE = 5,
    AUVID_CAN_NODE_IMU_RATES = 6,
    AUVID_CAN_NODE_THRUSTER_FEEDBACK_A = 7,
    AUVID_CAN_NODE_THRUSTER_FEEDBACK_B = 8,
    AUVID_CAN_NODE_DVL_BOTTOM = 9,
    AUVID_CAN_NODE_DVL_WATER = 10,
    AUVID_CAN_NODE_DVL_ALTITUDE = 11,
    AUVID_CAN_NODE_DEPTH = 12,
    AUVID_CAN_NODE_GPS = 13,
    AUVID_CAN_NODE_KINDS = 14 /**< no message that a node receives */
} auvid_can_node_kind_t;

/** Samples of sensors: number of real values before `age`. */
enum {
    AUVID_CAN_IMU_ATTITUDE_VALUES = 3,
    AUVID_CAN_IMU_RATES_VALUES = 3,
    AUVID_CAN_DVL_BOTTOM_VALUES = 3,
    AUVID_CAN_DVL_WATER_VALUES = 3,
    AUVID_CAN_DVL_ALTITUDE_VALUES = 1,
    AUVID_CAN_DEPTH_VALUES = 1,
    AUVID_CAN_GPS_VALUES = 2
};

#define AUVID_CAN_AGE_UNKNOWN 1023u
#define AUVID_CAN_ARM_KEY 0xA55Au

/** Values of `cause`. */
enum {
    AUVID_CAN_CAUSE_NONE = 0,
    AUVID_CAN_CAUSE_OPERATOR = 1,
    AUVID_CAN_CAUSE_NO_INPUT = 2,
    AUVID_CAN_CAUSE_TIME = 3,
    AUVID_CAN_CAUSE_TICK = 4,
    AUVID_CAN_CAUSE_LINK = 5,
    AUVID_CAN_CAUSE_IMU_STALE = 6,
    AUVID_CAN_CAUSE_VELOCITY_STALE = 7,
    AUVID_CAN_CAUSE_DEPTH_STALE = 8,
    AUVID_CAN_CAUSE_ALTITUDE_STALE = 9,
    AUVID_CAN_CAUSE_APPLIED_STALE = 10,
    AUVID_CAN_CAUSE_DEPTH_MIN = 11,
    AUVID_CAN_CAUSE_DEPTH_MAX = 12,
    AUVID_CAN_CAUSE_ALTITUDE = 13,
    AUVID_CAN_CAUSE_ROLL = 14,
    AUVID_CAN_CAUSE_PITCH = 15,
    AUVID_CAN_CAUSE_SPEED = 16,
    AUVID_CAN_CAUSE_YAW_RATE = 17,
    AUVID_CAN_CAUSE_DISTANCE = 18,
    AUVID_CAN_CAUSE_RUN_TIME = 19,
    AUVID_CAN_CAUSE_SATURATION = 20,
    AUVID_CAN_CAUSE_FOREIGN_COMMAND = 21
};

/** Values of `action`. */
enum { AUVID_CAN_ACTION_DISARM = 0, AUVID_CAN_ACTION_ARM = 1, AUVID_CAN_ACTION_STOP = 2 };

/** Values of `note`. */
enum {
    AUVID_CAN_NOTE_NONE = 0,
    AUVID_CAN_NOTE_FIXED = 1,
    AUVID_CAN_NOTE_NOT_EXCITED = 2,
    AUVID_CAN_NOTE_COMBINATION = 3,
    AUVID_CAN_NOTE_SMALL = 4,
    AUVID_CAN_NOTE_NOISE = 5,
    AUVID_CAN_NOTE_UNCERTAIN = 6,
    AUVID_CAN_NOTE_IMPLAUSIBLE = 7,
    AUVID_CAN_NOTE_AT_BOUND = 8,
    AUVID_CAN_NOTE_BESIDE_BOUND = 9,
    AUVID_CAN_NOTE_NOT_CONVERGED = 10,
    AUVID_CAN_NOTE_DISCREDITED = 11,
    AUVID_CAN_NOTE_THRUST_SCALE = 12,
    AUVID_CAN_NOTE_FEEDBACK = 13,
    AUVID_CAN_NOTE_UNCHECKED = 14,
    AUVID_CAN_NOTE_INPUTS = 15
};

/** Values of `guard`. */
enum {
    AUVID_CAN_GUARD_DISARMED = 0,
    AUVID_CAN_GUARD_ARMED = 1,
    AUVID_CAN_GUARD_EXCITING = 2,
    AUVID_CAN_GUARD_SETTLING = 3,
    AUVID_CAN_GUARD_DONE = 4,
    AUVID_CAN_GUARD_ABORTED = 5
};

/** Values of `work`. */
enum {
    AUVID_CAN_WORK_IDLE = 0,
    AUVID_CAN_WORK_PREPARE = 1,
    AUVID_CAN_WORK_PREDICT = 2,
    AUVID_CAN_WORK_COMPARE = 3,
    AUVID_CAN_WORK_CHANGE_TEST = 4,
    AUVID_CAN_WORK_MERGE = 5,
    AUVID_CAN_WORK_ASK = 6,
    AUVID_CAN_WORK_COST = 7,
    AUVID_CAN_WORK_MEASURE = 8,
    AUVID_CAN_WORK_LINEARISE = 9,
    AUVID_CAN_WORK_CONFIDENCE = 10
};

/** Values of `role`. */
enum { AUVID_CAN_ROLE_NODE = 0, AUVID_CAN_ROLE_VEHICLE = 1, AUVID_CAN_ROLE_MONITOR = 2 };

/** Values of `point`. */
enum {
    AUVID_CAN_POINT_SURGE_FORWARD_0_3 = 0,
    AUVID_CAN_POINT_SURGE_FORWARD_0_6 = 1,
    AUVID_CAN_POINT_SURGE_FORWARD_1_0 = 2,
    AUVID_CAN_POINT_SURGE_BACKWARD_0_3 = 3,
    AUVID_CAN_POINT_SURGE_BACKWARD_0_6 = 4,
    AUVID_CAN_POINT_SURGE_BACKWARD_1_0 = 5,
    AUVID_CAN_POINT_SWAY_FORWARD_0_3 = 6,
    AUVID_CAN_POINT_SWAY_FORWARD_0_6 = 7,
    AUVID_CAN_POINT_SWAY_FORWARD_1_0 = 8,
    AUVID_CAN_POINT_SWAY_BACKWARD_0_3 = 9,
    AUVID_CAN_POINT_SWAY_BACKWARD_0_6 = 10,
    AUVID_CAN_POINT_SWAY_BACKWARD_1_0 = 11,
    AUVID_CAN_POINT_HEAVE_FORWARD_0_3 = 12,
    AUVID_CAN_POINT_HEAVE_FORWARD_0_6 = 13,
    AUVID_CAN_POINT_HEAVE_FORWARD_1_0 = 14,
    AUVID_CAN_POINT_HEAVE_BACKWARD_0_3 = 15,
    AUVID_CAN_POINT_HEAVE_BACKWARD_0_6 = 16,
    AUVID_CAN_POINT_HEAVE_BACKWARD_1_0 = 17,
    AUVID_CAN_POINT_ROLL_FORWARD_0_3 = 18,
    AUVID_CAN_POINT_ROLL_FORWARD_0_6 = 19,
    AUVID_CAN_POINT_ROLL_FORWARD_1_0 = 20,
    AUVID_CAN_POINT_ROLL_BACKWARD_0_3 = 21,
    AUVID_CAN_POINT_ROLL_BACKWARD_0_6 = 22,
    AUVID_CAN_POINT_ROLL_BACKWARD_1_0 = 23,
    AUVID_CAN_POINT_PITCH_FORWARD_0_3 = 24,
    AUVID_CAN_POINT_PITCH_FORWARD_0_6 = 25,
    AUVID_CAN_POINT_PITCH_FORWARD_1_0 = 26,
    AUVID_CAN_POINT_PITCH_BACKWARD_0_3 = 27,
    AUVID_CAN_POINT_PITCH_BACKWARD_0_6 = 28,
    AUVID_CAN_POINT_PITCH_BACKWARD_1_0 = 29,
    AUVID_CAN_POINT_YAW_FORWARD_0_3 = 30,
    AUVID_CAN_POINT_YAW_FORWARD_0_6 = 31,
    AUVID_CAN_POINT_YAW_FORWARD_1_0 = 32,
    AUVID_CAN_POINT_YAW_BACKWARD_0_3 = 33,
    AUVID_CAN_POINT_YAW_BACKWARD_0_6 = 34,
    AUVID_CAN_POINT_YAW_BACKWARD_1_0 = 35
};

/** Values of `input`. */
enum {
    AUVID_CAN_INPUT_CURVE_BACKWARD = 0,
    AUVID_CAN_INPUT_CURVE_DEAD_BAND = 1,
    AUVID_CAN_INPUT_CURVE_EXPONENT = 2,
    AUVID_CAN_INPUT_INFLOW = 3,
    AUVID_CAN_INPUT_INFLOW_BILINEAR = 4,
    AUVID_CAN_INPUT_SAG = 5,
    AUVID_CAN_INPUT_TIMING_LAG = 6,
    AUVID_CAN_INPUT_CURRENT_NORTH = 7,
    AUVID_CAN_INPUT_CURRENT_EAST = 8,
    AUVID_CAN_INPUT_MOUNTING_ARM_AHEAD = 9,
    AUVID_CAN_INPUT_MOUNTING_ARM_STARBOARD = 10,
    AUVID_CAN_INPUT_MOUNTING_ARM_DOWN = 11,
    AUVID_CAN_INPUT_MOUNTING_DVL_PITCH = 12,
    AUVID_CAN_INPUT_MOUNTING_DVL_YAW = 13,
    AUVID_CAN_INPUT_TIMING_DVL = 14,
    AUVID_CAN_INPUT_TIMING_DELAY = 15,
    AUVID_CAN_INPUT_ASYMMETRY = 16,
    AUVID_CAN_INPUT_MOUNTING_FORCE = 17,
    AUVID_CAN_INPUT_MOUNTING_CROSS = 18,
    AUVID_CAN_INPUT_MOUNTING_LIFT = 19,
    AUVID_CAN_INPUT_MOUNTING_GRAVITY_ASTERN = 20,
    AUVID_CAN_INPUT_MOUNTING_GRAVITY_PORT = 21,
    AUVID_CAN_INPUT_INFLOW_CROSS_FLOW = 22,
    AUVID_CAN_INPUT_TIMING_FILTER = 23
};

/** Values of `dof`. */
enum {
    AUVID_CAN_DOF_SURGE = 0,
    AUVID_CAN_DOF_SWAY = 1,
    AUVID_CAN_DOF_HEAVE = 2,
    AUVID_CAN_DOF_ROLL = 3,
    AUVID_CAN_DOF_PITCH = 4,
    AUVID_CAN_DOF_YAW = 5
};

/** 0x040, on event. Stop exciting and disarm. The sender repeats it until the vehicle is
 * disarmed. A receiver obeys every authentic abort, even if the counter repeats or jumps. */
typedef struct {
    /** Cause of the abort: auvid_guard_cause_t of guard.h; 0..31 */
    uint32_t cause;
} auvid_can_abort_t;

/** 0x041, every 20 ms. Opens a control tick. The node that owns the clock sends it. The ages of
 * samples refer to its time. */
typedef struct {
    /** Number of the tick; 0..1048575 */
    uint32_t sequence;
    /** Time of the tick; wraps after 71.6 minutes; 0..4294967295 us */
    uint32_t time;
} auvid_can_tick_t;

/** 0x042, every 20 ms. Command of thrusters 1 to 4. A thruster whose value is not available is
 * not commanded: its thrust is zero. */
typedef struct {
    /** Thruster 1: commanded force divided by the maximum force in that direction; the other
     * elements likewise; -1..1, step 1/4000 */
    auvid_real_t thrust[4];
} auvid_can_thruster_command_a_t;

enum {
    AUVID_CAN_THRUSTER_COMMAND_A_NO_THRUST_1 = 1 << 0,
    AUVID_CAN_THRUSTER_COMMAND_A_NO_THRUST_2 = 1 << 1,
    AUVID_CAN_THRUSTER_COMMAND_A_NO_THRUST_3 = 1 << 2,
    AUVID_CAN_THRUSTER_COMMAND_A_NO_THRUST_4 = 1 << 3
};

/** 0x043, every 20 ms. Command of thrusters 5 to 8. Not sent for a vehicle with up to four
 * thrusters. */
typedef struct {
    /** Thruster 5: commanded force divided by the maximum force in that direction; the other
     * elements likewise; -1..1, step 1/4000 */
    auvid_real_t thrust[4];
} auvid_can_thruster_command_b_t;

enum {
    AUVID_CAN_THRUSTER_COMMAND_B_NO_THRUST_5 = 1 << 0,
    AUVID_CAN_THRUSTER_COMMAND_B_NO_THRUST_6 = 1 << 1,
    AUVID_CAN_THRUSTER_COMMAND_B_NO_THRUST_7 = 1 << 2,
    AUVID_CAN_THRUSTER_COMMAND_B_NO_THRUST_8 = 1 << 3
};

/** 0x044, on event. Command to the node. Arm: excite as soon as the guard permits. Disarm: end
 * the excitation at once. Stop: fade it out. Arm needs a good counter. Disarm and stop take
 * thrust away with any counter, but only a disarm with a good counter clears an abort. The
 * node refuses a frame without the key. */
typedef struct {
    /** Arm, disarm or stop; 0..2 */
    uint32_t action;
    /** Constant, so that a random frame is no command; 0xA55A */
    uint32_t key;
} auvid_can_arm_t;

/** 0x045, on event. The node has finished the work of a tick. Sent only to a simulated vehicle
 * that waits for it. */
typedef struct {
    /** Number of the tick; 0..1048575 */
    uint32_t sequence;
    /** Time spent on the tick, in percent of its length; 0..255 % */
    uint32_t load;
} auvid_can_tick_done_t;

/** 0x400, every 20 ms. Attitude, ZYX Euler angles, NED to body. */
typedef struct {
    /** Roll; -3.2764..3.2764 rad, step 1/2500 */
    auvid_real_t phi;
    /** Pitch; -3.2764..3.2764 rad, step 1/2500 */
    auvid_real_t theta;
    /** Yaw, wrapped into -pi..pi; -3.2764..3.2764 rad, step 1/2500 */
    auvid_real_t psi;
    /** Age of the sample when the frame was sent; 1023: unknown; 0..1022 ms */
    uint32_t age;
} auvid_can_imu_attitude_t;

enum {
    AUVID_CAN_IMU_ATTITUDE_NO_PHI = 1 << 0,
    AUVID_CAN_IMU_ATTITUDE_NO_THETA = 1 << 1,
    AUVID_CAN_IMU_ATTITUDE_NO_PSI = 1 << 2
};

/** 0x401, every 20 ms. Angular velocity, body frame. */
typedef struct {
    /** Roll rate; -4.0955..4.0955 rad/s, step 1/2000 */
    auvid_real_t p;
    /** Pitch rate; -4.0955..4.0955 rad/s, step 1/2000 */
    auvid_real_t q;
    /** Yaw rate; -4.0955..4.0955 rad/s, step 1/2000 */
    auvid_real_t r;
    /** Age of the sample when the frame was sent; 1023: unknown; 0..1022 ms */
    uint32_t age;
} auvid_can_imu_rates_t;

enum {
    AUVID_CAN_IMU_RATES_NO_P = 1 << 0,
    AUVID_CAN_IMU_RATES_NO_Q = 1 << 1,
    AUVID_CAN_IMU_RATES_NO_R = 1 << 2
};

/** 0x402, every 20 ms. Acting thrust of thrusters 1 to 4, from all sources of commands. */
typedef struct {
    /** Thruster 1: acting force divided by the maximum force in that direction; mean since the
     * previous frame; the other elements likewise; -1..1, step 1/4000 */
    auvid_real_t thrust[4];
} auvid_can_thruster_feedback_a_t;

enum {
    AUVID_CAN_THRUSTER_FEEDBACK_A_NO_THRUST_1 = 1 << 0,
    AUVID_CAN_THRUSTER_FEEDBACK_A_NO_THRUST_2 = 1 << 1,
    AUVID_CAN_THRUSTER_FEEDBACK_A_NO_THRUST_3 = 1 << 2,
    AUVID_CAN_THRUSTER_FEEDBACK_A_NO_THRUST_4 = 1 << 3
};

/** 0x403, every 20 ms. Acting thrust of thrusters 5 to 8. Not sent for a vehicle with up to
 * four thrusters. */
typedef struct {
    /** Thruster 5: acting force divided by the maximum force in that direction; mean since the
     * previous frame; the other elements likewise; -1..1, step 1/4000 */
    auvid_real_t thrust[4];
} auvid_can_thruster_feedback_b_t;

enum {
    AUVID_CAN_THRUSTER_FEEDBACK_B_NO_THRUST_5 = 1 << 0,
    AUVID_CAN_THRUSTER_FEEDBACK_B_NO_THRUST_6 = 1 << 1,
    AUVID_CAN_THRUSTER_FEEDBACK_B_NO_THRUST_7 = 1 << 2,
    AUVID_CAN_THRUSTER_FEEDBACK_B_NO_THRUST_8 = 1 << 3
};

/** 0x404, every 200 ms. DVL with bottom lock: velocity over ground, instrument frame. */
typedef struct {
    /** Forward; -8.191..8.191 m/s, step 1/1000 */
    auvid_real_t u;
    /** Starboard; -8.191..8.191 m/s, step 1/1000 */
    auvid_real_t v;
    /** Down; -8.191..8.191 m/s, step 1/1000 */
    auvid_real_t w;
    /** Age of the sample when the frame was sent; 1023: unknown; 0..1022 ms */
    uint32_t age;
} auvid_can_dvl_bottom_t;

enum {
    AUVID_CAN_DVL_BOTTOM_NO_U = 1 << 0,
    AUVID_CAN_DVL_BOTTOM_NO_V = 1 << 1,
    AUVID_CAN_DVL_BOTTOM_NO_W = 1 << 2
};

/** 0x405, every 200 ms. DVL with water lock: velocity through the water, instrument frame. */
typedef struct {
    /** Forward; -8.191..8.191 m/s, step 1/1000 */
    auvid_real_t u;
    /** Starboard; -8.191..8.191 m/s, step 1/1000 */
    auvid_real_t v;
    /** Down; -8.191..8.191 m/s, step 1/1000 */
    auvid_real_t w;
    /** Age of the sample when the frame was sent; 1023: unknown; 0..1022 ms */
    uint32_t age;
} auvid_can_dvl_water_t;

enum {
    AUVID_CAN_DVL_WATER_NO_U = 1 << 0,
    AUVID_CAN_DVL_WATER_NO_V = 1 << 1,
    AUVID_CAN_DVL_WATER_NO_W = 1 << 2
};

/** 0x406, every 200 ms. Height above the bottom. */
typedef struct {
    /** Height of the DVL above the bottom; 0..5242.87 m, step 1/100 */
    auvid_real_t altitude;
    /** Age of the sample when the frame was sent; 1023: unknown; 0..1022 ms */
    uint32_t age;
} auvid_can_dvl_altitude_t;

enum { AUVID_CAN_DVL_ALTITUDE_NO_ALTITUDE = 1 << 0 };

/** 0x407, every 100 ms. Depth from the pressure sensor. */
typedef struct {
    /** Positive down; -8388.606..8388.606 m, step 1/500 */
    auvid_real_t depth;
    /** Age of the sample when the frame was sent; 1023: unknown; 0..1022 ms */
    uint32_t age;
} auvid_can_depth_t;

enum { AUVID_CAN_DEPTH_NO_DEPTH = 1 << 0 };

/** 0x408, every 1000 ms. Position fix at the surface, in metres from the origin of the mission. */
typedef struct {
    /** North; -10485.75..10485.75 m, step 1/100 */
    auvid_real_t x;
    /** East; -10485.75..10485.75 m, step 1/100 */
    auvid_real_t y;
    /** Age of the sample when the frame was sent; 1023: unknown; 0..1022 ms */
    uint32_t age;
} auvid_can_gps_t;

enum { AUVID_CAN_GPS_NO_X = 1 << 0, AUVID_CAN_GPS_NO_Y = 1 << 1 };

/** 0x409, every 100 ms. Position estimate of the navigation filter, at the last tick. */
typedef struct {
    /** North; -10485.75..10485.75 m, step 1/100 */
    auvid_real_t x;
    /** East; -10485.75..10485.75 m, step 1/100 */
    auvid_real_t y;
    /** Bit mask of AUVID_NAV_... of nav.h; 0..1023 */
    uint32_t flags;
} auvid_can_nav_position_t;

enum { AUVID_CAN_NAV_POSITION_NO_X = 1 << 0, AUVID_CAN_NAV_POSITION_NO_Y = 1 << 1 };

/** 0x40A, every 100 ms. Velocity estimate, body frame, at the last tick. */
typedef struct {
    /** Surge; -8.191..8.191 m/s, step 1/1000 */
    auvid_real_t u;
    /** Sway; -8.191..8.191 m/s, step 1/1000 */
    auvid_real_t v;
    /** Heave; -8.191..8.191 m/s, step 1/1000 */
    auvid_real_t w;
} auvid_can_nav_velocity_t;

enum {
    AUVID_CAN_NAV_VELOCITY_NO_U = 1 << 0,
    AUVID_CAN_NAV_VELOCITY_NO_V = 1 << 1,
    AUVID_CAN_NAV_VELOCITY_NO_W = 1 << 2
};

/** 0x40B, every 100 ms. Depth estimate, at the last tick. */
typedef struct {
    /** Positive down; -8388.606..8388.606 m, step 1/500 */
    auvid_real_t z;
} auvid_can_nav_depth_t;

enum { AUVID_CAN_NAV_DEPTH_NO_Z = 1 << 0 };

/** 0x40C, every 100 ms. One parameter of the last estimate. The frames cycle through the
 * indices. */
typedef struct {
    /** Parameter, in the order of the model; 0..31 */
    uint32_t index;
    /** Number of the estimate; after 127 follows 1; 0: none yet; 0..127 */
    uint32_t number;
    /** Bit 0: identified; 1: its degree of freedom was excited; 2: the search did not converge;
     * 3: identifiable; 4: implausible; 5: accepted, because the estimate predicted a set that
     * was not used for it; 0..255 */
    uint32_t flags;
    /** Value in the parameter's unit; NaN: not available; float32 */
    auvid_real_t value;
} auvid_can_estimate_t;

enum { AUVID_CAN_ESTIMATE_NO_VALUE = 1 << 3 };

/** 0x40D, every 100 ms. Standard error of the parameter in the preceding estimate frame. */
typedef struct {
    /** Parameter, in the order of the model; 0..31 */
    uint32_t index;
    /** Number of the estimate, as in frame estimate; 0..127 */
    uint32_t number;
    /** Finding on the parameter: auvid_note_t of estimate.h; 0..15 */
    uint32_t note;
    /** Standard error, bias included, in the parameter's unit; NaN: not available. It includes
     * the uncertainty of the thrust scale, a relative error e (default 0.05). For the thrust
     * as supplied it is sqrt(sigma^2 - (e value)^2), if no parameter is fixed; float32 */
    auvid_real_t sigma;
} auvid_can_estimate_sigma_t;

enum { AUVID_CAN_ESTIMATE_SIGMA_NO_SIGMA = 1 << 3 };

/** 0x40E, every 200 ms. Progress of the identification. */
typedef struct {
    /** State of the guard: auvid_guard_state_t of guard.h; 0..5 */
    uint32_t guard;
    /** Phase of the search: auvid_work_phase_t of identifier.h; 0..10 */
    uint32_t work;
    /** Why the excitation ended, or why arming was refused: auvid_guard_cause_t of guard.h;
     * 0..31 */
    uint32_t cause;
    /** Elapsed part of the excitation; 0..100 % */
    uint32_t percent;
    /** Data sets completed, modulo 256; 0..255 */
    uint32_t sets;
    /** Searches started, modulo 256; 0..255 */
    uint32_t searches;
    /** Degrees of freedom that were excited in the data of the last estimate: bit 0 surge ..
     * bit 5 yaw; 0..63 */
    uint32_t excited;
    /** Degrees of freedom in which most clearly the newest set shows a change of the vehicle,
     * or the estimate a drift since the first accepted one: bit 0 surge .. bit 5 yaw; 0:
     * neither; 0..63 */
    uint32_t changed;
} auvid_can_progress_t;

/** 0x40F, every 1000 ms. Counters since the start. They saturate. */
typedef struct {
    /** Ticks that the node missed; 0..4095 */
    uint32_t ticks_missed;
    /** Received frames that were refused: checksum, length, range, counter; 0..4095 */
    uint32_t frames_refused;
    /** Sensor samples that were refused; 0..4095 */
    uint32_t samples_dropped;
    /** Values limited to the range of their signal; 0..255 */
    uint32_t saturated;
    /** Longest tick since the previous frame, in percent of the tick's length; 0..255 % */
    uint32_t load;
} auvid_can_health_t;

/** 0x410, every 500 ms. Shows that the sender is running. */
typedef struct {
    /** Version of this file: AuvidProtocol; 0..255 */
    uint32_t protocol;
    /** Role of the sender; 0..2 */
    uint32_t role;
    /** Time since the start; 0..16777215 s */
    uint32_t uptime;
    /** Major version of the library; 0..255 */
    uint32_t major;
    /** Minor version of the library; 0..255 */
    uint32_t minor;
} auvid_can_heartbeat_t;

/** 0x411, every 200 ms. Drag force of the last estimate at a fraction of the maximum speed of
 * its data in one direction. The frames cycle through the points. None before the first
 * estimate. */
typedef struct {
    /** Bit 0: identifiable, see auvid_drag_t of estimate.h; 0..31 */
    uint32_t flags;
    /** Number of the estimate, as in frame estimate; 0..127 */
    uint32_t number;
    /** Degree of freedom, direction, and fraction of the maximum speed: 6 dof + 3 (backward) +
     * 0, 1, 2; 0..255 */
    uint32_t point;
    /** Force of the water on the hull, N or Nm; NaN: not available, the data have no motion in
     * this direction; float32 */
    auvid_real_t force;
} auvid_can_drag_t;

enum { AUVID_CAN_DRAG_NO_FORCE = 1 << 3 };

/** 0x412, every 200 ms. Speed and half-width of the force in the preceding drag frame. */
typedef struct {
    /** Speed, m/s or rad/s; backward is negative; -8.191..8.191, step 1/1000 */
    auvid_real_t speed;
    /** Same as in the drag frame; 0..63 */
    uint32_t point;
    /** Half-width (95 %) of the force, N or Nm; NaN: not available; float32 */
    auvid_real_t half_width;
} auvid_can_drag_half_width_t;

enum {
    AUVID_CAN_DRAG_HALF_WIDTH_NO_SPEED = 1 << 0,
    AUVID_CAN_DRAG_HALF_WIDTH_NO_HALF_WIDTH = 1 << 2
};

/** 0x413, every 200 ms. What is wrong with the inputs, according to the data of the last
 * estimate: auvid_causes_t of uncertain.h. Only a node with uncertain inputs sends it. All
 * zeros: nothing, or no estimate with uncertain inputs yet. */
typedef struct {
    /** Bit 0: the inputs are contradicted: far less exact than configured; 1: the thrusters'
     * forces do not make the wrench; 0..31 */
    uint32_t flags;
    /** Number of the estimate; after 127 follows 1; 0: none yet; 0..127 */
    uint32_t number;
    /** Number of classes that are certainly wrong and matter. Each has a wrong_input frame;
     * 0..7 */
    uint32_t named;
    /** Bit i: the estimates of parameter i with and without uncertain inputs differ by more
     * than both half-widths; 0..4294967295 */
    uint32_t differs;
} auvid_can_wrong_inputs_t;

/** 0x414, every 200 ms. One class of wrong inputs. The frames cycle through the classes; each
 * follows a wrong_inputs frame. */
typedef struct {
    /** Number of the estimate in wrong_inputs, modulo 4; 0..3 */
    uint32_t number;
    /** Place of the class among those named; the first moves masses and drag most; 0..6 */
    uint32_t rank;
    /** The class, and its most important input; 0..18 */
    uint32_t input;
    /** Degree of freedom in which its share is largest; 0..5 */
    uint32_t dof;
    /** Rms of its force, relative to the thrust of this degree of freedom; 0..127 % */
    uint32_t share;
    /** Size, only rough. Curve_backward: thrust is weaker by this part; curve_dead_band: N;
     * curve_exponent: above 1; inflow and inflow_bilinear: part per m/s, of both laws
     * together; sag: part in 240 s; timing: s later, of timing_filter its time constant in s;
     * current: m/s; asymmetry: part forward; mounting_force: N or Nm; mounting_cross,
     * mounting_lift and inflow_cross_flow: part of drag; mounting_arm and mounting_gravity: m;
     * mounting_dvl: rad. NaN: not available; float32 */
    auvid_real_t value;
} auvid_can_wrong_input_t;

enum { AUVID_CAN_WRONG_INPUT_NO_VALUE = 1 << 5 };

/** Any message. */
typedef struct {
    auvid_can_kind_t kind; /**< selects the struct below */
    uint8_t counter;       /**< 0..15; written by unpack, not read by pack */
    uint32_t absent;       /**< AUVID_CAN_<message>_NO_<signal>: this real is not available. Pack
                                does not read it; it is NaN after unpack. Other bits are ignored */
    union {
        auvid_can_abort_t abort;
        auvid_can_tick_t tick;
        auvid_can_thruster_command_a_t thruster_command_a;
        auvid_can_thruster_command_b_t thruster_command_b;
        auvid_can_arm_t arm;
        auvid_can_tick_done_t tick_done;
        auvid_can_imu_attitude_t imu_attitude;
        auvid_can_imu_rates_t imu_rates;
        auvid_can_thruster_feedback_a_t thruster_feedback_a;
        auvid_can_thruster_feedback_b_t thruster_feedback_b;
        auvid_can_dvl_bottom_t dvl_bottom;
        auvid_can_dvl_water_t dvl_water;
        auvid_can_dvl_altitude_t dvl_altitude;
        auvid_can_depth_t depth;
        auvid_can_gps_t gps;
        auvid_can_nav_position_t nav_position;
        auvid_can_nav_velocity_t nav_velocity;
        auvid_can_nav_depth_t nav_depth;
        auvid_can_estimate_t estimate;
        auvid_can_estimate_sigma_t estimate_sigma;
        auvid_can_progress_t progress;
        auvid_can_health_t health;
        auvid_can_heartbeat_t heartbeat;
        auvid_can_drag_t drag;
        auvid_can_drag_half_width_t drag_half_width;
        auvid_can_wrong_inputs_t wrong_inputs;
        auvid_can_wrong_input_t wrong_input;
    } as;
} auvid_can_message_t;

#ifdef __cplusplus
}
#endif

#endif
