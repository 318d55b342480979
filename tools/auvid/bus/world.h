/**
 * @file world.h
 * A simulated vehicle and the node aboard it, connected by the bus in memory, one control tick at a
 * time.
 *
 * The vehicle is that of the simulator (vehicle_sim.h), by default the Girona500. Only frames pass
 * between it and the node. The vehicle sends sensors, thruster feedback, orders of the operator and
 * the tick; the node sends thruster commands and estimates. They run in lock step: the next tick
 * follows when the node has done the current one.
 */
#ifndef PROGRAM_WORLD_H
#define PROGRAM_WORLD_H

#include "auvid/adaptive.h"
#include "auvid/node.h"
#include "frames.h"
#include "literal.h"
#include "../options/options.h"
#include "../vehicle/vehicles.h"

/** Length of a set [s]. */
#define WORLD_SET_S 30

typedef struct {
    const vehicle_t *vehicle; /**< NULL: Girona500 */
    const options_t *options; /**< source of the uncertainties, or NULL */
    uint64_t seed;            /**< seed of sensors, disturbance, excitation and search */
    double disturbance_N;     /**< rms on X, Y, Z; 0.4 times this in Nm on N (six DoF: K, M, N) */
    double lag_s;             /**< of the thrusters */
    uint32_t sets;            /**< sets of excitation */
    bool literal;             /**< literal smoothing of the paper */
    bool adaptive;            /**< adaptive excitation (adaptive.h) for at most `sets` sets */
    bool passive;             /**< the node ignores arm frames */
    bool no_arm;              /**< the vehicle sends no arm frame by itself */
    uint8_t idle;             /**< bit j: DoF j is not excited */
    double current[3];        /**< of the water, NED [m/s] */
    /** The DVL alternates between bottom and water, each at 5 Hz. Dynamics use the water velocity,
     * the guard the bottom velocity. Default: bottom only. */
    bool both_locks;
    double dvl_arm_m[3];       /**< of the DVL beyond that of the vehicle, known to the node [m] */
    double age_s[SIM_SENSORS]; /**< time from sample to arrival, by sim_sensor_id_t [s] */
} world_config_t;

/** Nodes aboard: [0] excites the vehicle, unless `passive`; an optional second one only listens. */
enum { WORLD_NODES = 2 };

/** Ends of the bus; the last one is for the second node, or for an observer. */
enum { WORLD_VEHICLE, WORLD_NODE, WORLD_LISTENER, WORLD_ENDS };

typedef struct {
    bus_memory_t hub;
    vehicle_sim_t vehicle_sim;
    auvid_node_t node[WORLD_NODES];
    literal_t literal[WORLD_NODES]; /**< of each node, if chosen */
    auvid_actuation_t actuation;    /**< of node[0]; all zeros if `passive` */
    auvid_adaptive_t adaptive;      /**< of node[0], if `adaptive` */
    auvid_validation_t prediction[WORLD_NODES];
    auvid_change_detector_t change[WORLD_NODES];
    const auvid_allocation_config_t *allocation;
    int nodes;
    bool both_locks, is_literal;        /**< see world_config_t */
    double excitation[AUVID_DOF_COUNT]; /**< last commanded wrench [N, Nm] */
} world_t;

/** Writes the identifier configuration of this world, which may be changed for world_listen. A
 * world with literal smoothing changes it further. */
void world_identifier(auvid_identifier_config_t *cfg, const world_config_t *config);

/** Attaches the excitation (the plan, not adaptive) and the guard of this world to a node.
 * @return the library's status; if it is that of a refused configuration, actuation->refusal names
 * the field */
auvid_status_t world_excite(auvid_node_t *node, auvid_actuation_t *actuation,
                            const world_config_t *config);

/** Attaches the uncertain inputs of a vehicle to a node.
 * @return the library's status */
auvid_status_t world_uncertain(auvid_node_t *node, auvid_uncertain_t *uncertain,
                               const vehicle_t *vehicle);

/** Starts. The operator arms the node one second after it navigates.
 * Returns false if the library, see world_refusal, or the simulator refuses the configuration. */
bool world_begin(world_t *world, const world_config_t *config);

/** What the library refused in a world that did not begin, or a node that cannot listen; NULL if it
 * was not the library that refused. */
const auvid_refusal_t *world_refusal(const world_t *world);

/** Adds a second node that listens. Returns false if there is no room or cfg is refused. */
bool world_listen(world_t *world, const auvid_identifier_config_t *cfg);

/** Runs one tick of 20 ms up to the command: simulates, then steps every node. */
void world_tick(world_t *world);

/** Completes the tick: optimizes with a budget (0: none) and reports. Returns true if work is left.
 */
bool world_work(world_t *world, uint32_t budget);

/** Simulated time [s]. */
double world_time_s(const world_t *world);

#endif
