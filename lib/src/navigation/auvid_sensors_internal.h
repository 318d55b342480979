/**
 * @file auvid_sensors_internal.h
 * Private: the sensors of navigation, one row each. The filter, the identifier's input, the node
 * and the simulator read this table.
 */
#ifndef AUVID_SENSORS_INTERNAL_H
#define AUVID_SENSORS_INTERNAL_H

/**
 * ROW(name, input, event, kind, axis, axes, config, noise_mm, surface, start), in the order of
 * auvid_nav_sensor_t:
 *   name      AUVID_NAV_<name> is the sensor, AUVID_CAN_<name> its message: `axes` real values, age
 *   input     member of auvid_input_t: present, t_us, `axes` real values
 *   event     AUVID_EVENT_<event>_DROPPED: a sample is rejected
 *   kind      VELOCITY of a DVL, in its frame; POSITION, NED
 *   axis      first axis that it measures, 0..2
 *   axes      number of axes, 1..3
 *   config    members sigma_<config> and <config>_max_age_us of auvid_nav_config_t
 *   noise_mm  default of sigma_<config> [mm/s, mm]; also that of the simulator
 *   surface   1: used at the surface only
 *   start     UPDATE: the first sample corrects the filter like any other; FIRST: it sets the axes
 *             that are not known yet; MEDIAN: that of gps_start samples does (one sensor at most)
 */
#define AUVID_SENSORS(ROW)                                                                         \
    ROW(DVL_BOTTOM, dvl, DVL, VELOCITY, 0, 3, dvl, 7, 0, UPDATE)                                   \
    ROW(DVL_WATER, dvl_water, DVL, VELOCITY, 0, 3, dvl, 7, 0, UPDATE)                              \
    ROW(DEPTH, depth, DEPTH, POSITION, 2, 1, depth, 15, 0, FIRST)                                  \
    ROW(GPS, gps, GPS, POSITION, 0, 2, gps, 1500, 1, MEDIAN)

#endif
