/**
 * @file thrust_map.h
 * From the command of a thruster to its force: the map of a group of thrusters in a vehicle file.
 */
#ifndef PROGRAM_THRUST_MAP_H
#define PROGRAM_THRUST_MAP_H

/** How a command becomes a force. In all but `newton` and `table` a command n counts from
 * zero_command, less the dead zone, relative to full_command: n = 1 is full. */
typedef enum {
    THRUST_MAP_NEWTON,        /**< the command is the force [N] */
    THRUST_MAP_LINEAR,        /**< n times the largest force of its direction */
    THRUST_MAP_SIGNED_SQUARE, /**< n |n| times it: a throttle that sets the propeller's speed */
    THRUST_MAP_RPM,           /**< n |n| times it: the measured speed of the propeller */
    THRUST_MAP_TABLE,         /**< interpolated linearly; constant beyond both ends */
    THRUST_MAPS
} thrust_map_kind_t;

/** Largest number of points in a table. */
enum { THRUST_MAP_POINTS = 32 };

typedef struct {
    int kind;                /**< thrust_map_kind_t */
    double zero_command;     /**< command without force; default 0 */
    double full_command;     /**< command of the largest forward force; default 1, rpm: required */
    double dead_zone;        /**< commands this close to zero_command give no force; default 0 */
    double voltage_V;        /**< of the supply to which the map belongs; 0: not known */
    double voltage_exponent; /**< force ~ (voltage / voltage_V)^this; default 0: no influence */
    double delay_s;          /**< known time from command to force; default 0 */
    double uncertainty;      /**< relative standard deviation of the force; 0: not given */
    double command[THRUST_MAP_POINTS]; /**< table: commands, increasing */
    double force_N[THRUST_MAP_POINTS]; /**< table: their forces */
    int commands, forces;              /**< table: points */
} thrust_map_t;

/** The force of a thruster [N]. Commands beyond full_command are extrapolated.
 * @param forward_N, backward_N its largest forces, both > 0
 * @param voltage_V of the supply now; not above 0: as in the map */
double thrust_map_force(const thrust_map_t *map, double forward_N, double backward_N,
                        double command, double voltage_V);

#endif
