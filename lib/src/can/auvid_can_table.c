/*
 * Generated from lib/can/auvid.dbc by `make can`: do not edit.
 */
#include "auvid_can_table_internal.h"

#include "../base/auvid_math_internal.h"

/* clang-format off */
#define CAN_WORD(message, member) (offsetof(auvid_can_##message##_t, member) / sizeof(uint32_t))

const auvid_can_type_t auvid_can_types[] = {
    {42330, 16, AUVID_CAN_TYPE_CONSTANT},
    {1, 0, AUVID_CAN_TYPE_FLOAT},
    {1, 0, AUVID_CAN_TYPE_FLOAT_POSITIVE},
    {1000, 18, AUVID_CAN_TYPE_REAL},
    {2000, 18, AUVID_CAN_TYPE_REAL},
    {2500, 18, AUVID_CAN_TYPE_REAL},
    {100, 11, AUVID_CAN_TYPE_REAL},
    {500, 9, AUVID_CAN_TYPE_REAL},
    {100, 12, AUVID_CAN_TYPE_REAL_POSITIVE},
    {4000, 19, AUVID_CAN_TYPE_REAL_UNIT},
    {2, 30, AUVID_CAN_TYPE_UINT},
    {0, 28, AUVID_CAN_TYPE_UINT},
    {2, 28, AUVID_CAN_TYPE_UINT},
    {5, 28, AUVID_CAN_TYPE_UINT},
    {10, 28, AUVID_CAN_TYPE_UINT},
    {0, 27, AUVID_CAN_TYPE_UINT},
    {0, 26, AUVID_CAN_TYPE_UINT},
    {0, 25, AUVID_CAN_TYPE_UINT},
    {100, 25, AUVID_CAN_TYPE_UINT},
    {0, 24, AUVID_CAN_TYPE_UINT},
    {0, 22, AUVID_CAN_TYPE_UINT},
    {0, 20, AUVID_CAN_TYPE_UINT},
    {0, 12, AUVID_CAN_TYPE_UINT},
    {0, 8, AUVID_CAN_TYPE_UINT},
    {0, 0, AUVID_CAN_TYPE_UINT},
};

const auvid_can_signal_t auvid_can_signals[] = {
    {12, 15, CAN_WORD(abort, cause), 1},
    {12, 22, CAN_WORD(tick, sequence), 0},
    {32, 24, CAN_WORD(tick, time), 1},
    {12, 9, CAN_WORD(thruster_command_a, thrust[0]), 0},
    {25, 9, CAN_WORD(thruster_command_a, thrust[1]), 0},
    {38, 9, CAN_WORD(thruster_command_a, thrust[2]), 0},
    {51, 9, CAN_WORD(thruster_command_a, thrust[3]), 1},
    {12, 10, CAN_WORD(arm, action), 0},
    {16, 0, CAN_WORD(arm, key), 1},
    {12, 22, CAN_WORD(tick_done, sequence), 0},
    {32, 19, CAN_WORD(tick_done, load), 1},
    {12, 5, CAN_WORD(imu_attitude, phi), 0},
    {26, 5, CAN_WORD(imu_attitude, theta), 0},
    {40, 5, CAN_WORD(imu_attitude, psi), 0},
    {54, 20, CAN_WORD(imu_attitude, age), 1},
    {12, 4, CAN_WORD(imu_rates, p), 0},
    {26, 4, CAN_WORD(imu_rates, q), 0},
    {40, 4, CAN_WORD(imu_rates, r), 0},
    {54, 20, CAN_WORD(imu_rates, age), 1},
    {12, 3, CAN_WORD(dvl_bottom, u), 0},
    {26, 3, CAN_WORD(dvl_bottom, v), 0},
    {40, 3, CAN_WORD(dvl_bottom, w), 0},
    {54, 20, CAN_WORD(dvl_bottom, age), 1},
    {12, 8, CAN_WORD(dvl_altitude, altitude), 0},
    {54, 20, CAN_WORD(dvl_altitude, age), 1},
    {12, 7, CAN_WORD(depth, depth), 0},
    {54, 20, CAN_WORD(depth, age), 1},
    {12, 6, CAN_WORD(gps, x), 0},
    {33, 6, CAN_WORD(gps, y), 0},
    {54, 20, CAN_WORD(gps, age), 1},
    {12, 3, CAN_WORD(nav_velocity, u), 0},
    {26, 3, CAN_WORD(nav_velocity, v), 0},
    {40, 3, CAN_WORD(nav_velocity, w), 1},
    {12, 7, CAN_WORD(nav_depth, z), 1},
    {12, 15, CAN_WORD(estimate, index), 0},
    {17, 17, CAN_WORD(estimate, number), 0},
    {24, 19, CAN_WORD(estimate, flags), 0},
    {32, 1, CAN_WORD(estimate, value), 1},
    {12, 15, CAN_WORD(estimate_sigma, index), 0},
    {17, 17, CAN_WORD(estimate_sigma, number), 0},
    {24, 11, CAN_WORD(estimate_sigma, note), 0},
    {32, 2, CAN_WORD(estimate_sigma, sigma), 1},
    {12, 13, CAN_WORD(progress, guard), 0},
    {16, 14, CAN_WORD(progress, work), 0},
    {20, 15, CAN_WORD(progress, cause), 0},
    {25, 18, CAN_WORD(progress, percent), 0},
    {32, 19, CAN_WORD(progress, sets), 0},
    {40, 19, CAN_WORD(progress, searches), 0},
    {48, 16, CAN_WORD(progress, excited), 0},
    {54, 16, CAN_WORD(progress, changed), 1},
    {12, 21, CAN_WORD(health, ticks_missed), 0},
    {24, 21, CAN_WORD(health, frames_refused), 0},
    {36, 21, CAN_WORD(health, samples_dropped), 0},
    {48, 19, CAN_WORD(health, saturated), 0},
    {56, 19, CAN_WORD(health, load), 1},
    {12, 19, CAN_WORD(heartbeat, protocol), 0},
    {20, 12, CAN_WORD(heartbeat, role), 0},
    {24, 23, CAN_WORD(heartbeat, uptime), 0},
    {48, 19, CAN_WORD(heartbeat, major), 0},
    {56, 19, CAN_WORD(heartbeat, minor), 1},
    {12, 3, CAN_WORD(drag_half_width, speed), 0},
    {26, 16, CAN_WORD(drag_half_width, point), 0},
    {32, 2, CAN_WORD(drag_half_width, half_width), 1},
};

const uint8_t auvid_can_first[AUVID_CAN_KINDS] = {
    0, 1, 3, 3, 7, 9, 11, 15, 3, 3, 19, 19, 23, 25, 27, 27, 30, 33, 34, 38, 42, 50, 55, 34, 60,
};

const uint8_t auvid_can_node_kinds[AUVID_CAN_KINDS] = {
    0, 1, 2, 3, 4, 14, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 14, 14, 14, 14, 14, 14, 14, 14, 14,
};

const uint16_t auvid_can_cycles_ms[AUVID_CAN_KINDS] = {
    0, 20, 20, 20, 0, 0, 20, 20, 20, 20, 200, 200, 200, 100, 1000, 100, 100, 100, 100, 100, 200,
    1000, 500, 200, 200,
};
