/**
 * @file world.h
 * A simulated vehicle and the node aboard it, over the bus in memory, one control tick at a time.
 *
 * The vehicle is the simulator's (vehicle_sim.h), by default the Girona500. All that passes
 * between it
 * and the node are frames: sensors, feedback of the thrusters, the operator's orders and the tick
 * one way, thruster commands and estimates the other. In lock step: the node does a tick, then
 * comes the next.
 */
#ifndef PROGRAM_WORLD_H
#define PROGRAM_WORLD_H

#include "auvid/node.h"
#include "frames.h"
#include "options.h"
#include "vehicles.h"

/** Length of a set [s]. */
#define WORLD_SET_S 30

typedef struct {
    const vehicle_t *vehicle; /**< null: Girona500 */
    const options_t *options; /**< its uncertainties are read; null: not given */
    uint64_t seed;        /**< of sensors, disturbance, excitation and search */
    double disturbance_N; /**< rms on X, Y, Z; 0.4 of it in Nm on N (six DoF: on K, M, N) */
    double lag_s;         /**< of the thrusters */
    uint32_t sets;        /**< sets of excitation */
    bool literal;         /**< our reading of the paper's metric */
    bool adaptive;        /**< excites what is missing (adaptive.h), as long as `sets` at most */
    bool passive;         /**< the node obeys no arm frame */
    bool no_arm;          /**< nobody sends one by himself */
    uint8_t idle;         /**< bit j: DoF j is not excited */
    double current[3];    /**< of the water, NED [m/s] */
    /** The DVL pings bottom and water in turn, each at 5 Hz; dynamics are taken from the water's,
     * the guard looks at the bottom's. Default: bottom only. */
    bool both_locks;
    double dvl_arm_m[3];       /**< of the DVL from the body's origin; the node is told of it [m] */
    double age_s[SIM_SENSORS]; /**< from sample to arrival, by sim_sensor_id_t [s] */
} world_config_t;

/** Nodes aboard: [0] excites the vehicle; a second one may listen, and sends nothing. */
enum { WORLD_NODES = 2 };

/** Ends of the bus; the last one is that of the second node, or of whoever watches. */
enum { WORLD_VEHICLE, WORLD_NODE, WORLD_LISTENER, WORLD_ENDS };

typedef struct {
    bus_memory_t hub;
    vehicle_sim_t vehicle_sim;
    auvid_node_t node[WORLD_NODES];
    int nodes;
    bool both_locks;                    /**< see world_config_t */
    double excitation[AUVID_DOF_COUNT]; /**< that the vehicle was last commanded [N, Nm] */
} world_t;

/** What an identifier in this world is configured like; change it and give it to world_listen. */
void world_identifier(auvid_identifier_config_t *cfg, const world_config_t *config);

/** Start; the operator arms the node a second after it navigates.
 * False when the library or the simulator refuses (it does not). */
bool world_begin(world_t *world, const world_config_t *config);

/** Take a second node aboard. */
bool world_listen(world_t *world, const auvid_identifier_config_t *cfg);

/** One tick of 20 ms up to the command: simulate, then step every node. */
void world_tick(world_t *world);

/** The rest of it: optimize with a budget (0: not at all) and report. @return is there work left?
 */
bool world_work(world_t *world, uint32_t budget);

/** Time simulated [s]. */
double world_time_s(const world_t *world);

#endif
