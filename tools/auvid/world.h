/**
 * @file world.h
 * A simulated vehicle with the identifier aboard, one control tick at a time.
 *
 * The vehicle is the simulator's Girona500. Each tick its sensors and the feedback of its thrusters
 * go to the identifier; the identifier's excitation and a constant hover thrust (what an operator's
 * station keeping would give) go through the allocation to its thrusters.
 */
#ifndef PROGRAM_WORLD_H
#define PROGRAM_WORLD_H

#include "auvid/identifier.h"
#include "simulator.h"

/** Length of a set [s]. */
#define WORLD_SET_S 30

/** Amplitudes of the excitation [N, Nm]. */
#define WORLD_FORCE_N 100
#define WORLD_MOMENT_NM 40

typedef struct {
    uint64_t seed;        /**< of sensors, disturbance, excitation and search */
    double disturbance_N; /**< rms on X, Y, Z; 0.4 of it in Nm on N */
    double lag_s;         /**< of the thrusters */
    uint32_t sets;        /**< sets of excitation */
    bool literal;         /**< our reading of the paper's metric */
    uint8_t idle;         /**< bit j: DoF j is not excited */
    double current[3];    /**< of the water, NED [m/s] */
    /** The DVL pings bottom and water in turn, each at 5 Hz; dynamics are taken from the water's,
     * the guard looks at the bottom's. Default: bottom only. */
    bool both_locks;
} world_config_t;

/** Identifiers aboard: [0] excites the vehicle; a second one may listen. */
enum { WORLD_IDENTIFIERS = 2 };

typedef struct {
    sim_t sim;
    sim_output_t seen; /**< sensors and thrust of the last tick */
    auvid_identifier_t id[WORLD_IDENTIFIERS];
    int identifiers;
    bool excited;                             /**< the excitation was begun: navigation was fresh */
    bool both_locks;                          /**< see world_config_t */
    uint32_t events;                          /**< of id[0] in the last tick */
    auvid_real_t excitation[AUVID_DOF_COUNT]; /**< likewise [N, Nm] */
    double force_N[SIM_THRUSTERS];            /**< commanded from the last tick on */
    double wrench[AUVID_DOF_COUNT];           /**< which they make [N, Nm] */
    double hover_N;                           /**< in Z */
} world_t;

/** What an identifier in this world is configured like; change it and give it to world_listen. */
void world_identifier(auvid_identifier_config_t *cfg, const world_config_t *config);

/** Start; the excitation begins when navigation is fresh, in 0.2 s.
 * False when the library or the simulator refuses (it does not). */
bool world_begin(world_t *world, const world_config_t *config);

/** Take a second identifier aboard. */
bool world_listen(world_t *world, const auvid_identifier_config_t *cfg);

/** One tick of 20 ms: simulate, then step every identifier. */
void world_tick(world_t *world);

/** Time simulated [s]. */
double world_time_s(const world_t *world);

#endif
