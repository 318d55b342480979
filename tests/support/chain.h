/**
 * @file chain.h
 * The whole chain for tests: the simulated vehicle with an identifier aboard, tick by tick.
 *
 * One tick of 20 ms: the simulator moves under the last wrench, and its sensors become the
 * identifier's input. `before` may change the input, the identifier steps, `after` may check the
 * output, then the identifier works with the budget. The wrench of the next tick is one of two:
 * - the identifier excites (the default): its excitation plus the hover thrust, recorded after the
 *   step by auvid_identifier_applied;
 * - the identifier is passive (chain_set_driver): the driver's excitation plus the hover thrust,
 *   part of the step's input.
 */
#ifndef CHAIN_H
#define CHAIN_H

#include "auvid/adaptive.h"
#include "auvid/prior.h"
#include "literal.h"
#include "simulator.h"

/** Length of a set [s], the default. */
#define CHAIN_SET_S 30

struct chain;
typedef void (*chain_before_t)(struct chain *chain, auvid_input_t *in);
typedef void (*chain_after_t)(struct chain *chain, auvid_status_t status,
                              const auvid_output_t *out);

typedef struct {
    sim_config_t sim;
    auvid_identifier_config_t id;
    literal_t *literal; /**< literal smoothing of the paper, with this memory; NULL: none */
    auvid_actuation_config_t acting;
    auvid_allocation_config_t thrusters; /**< none: no limits */
    uint32_t budget;                     /**< of work, a tick; 0: none until chain_finish */
    uint64_t epoch_us;                   /**< added to all times: a clock need not begin at zero */
    bool passive;                        /**< the driver excites, not the identifier */
    auvid_excitation_config_t driver;
    chain_before_t before; /**< may be NULL */
    chain_after_t after;   /**< may be NULL */
    void *context;         /**< for these two */
} chain_config_t;

typedef struct chain {
    chain_config_t cfg;
    sim_t sim;
    auvid_identifier_t id;
    auvid_allocation_t allocation;
    auvid_actuation_t actuation; /**< attached unless passive */
    auvid_adaptive_t adaptive;   /**< for auvid_adaptive_begin */
    auvid_validation_t prediction;
    auvid_change_detector_t change;
    auvid_prior_t prior;
    auvid_excitation_t driver;
    uint32_t tick;                        /**< ticks so far */
    uint64_t t_us;                        /**< of the last one */
    uint32_t events;                      /**< all so far */
    uint32_t estimates;                   /**< AUVID_EVENT_ESTIMATE so far */
    uint32_t max_units;                   /**< largest number in a call of work */
    bool waiting;                         /**< arms and excites as soon as navigation is fresh */
    bool over_budget;                     /**< a call of work used more than its budget */
    auvid_status_t status;                /**< of the last step */
    auvid_status_t work;                  /**< of the last work */
    auvid_output_t out;                   /**< of the last step */
    auvid_real_t wrench[AUVID_DOF_COUNT]; /**< in force [N, Nm] */
} chain_t;

/** Standard world: the paper's Girona500, all DoF at 100 N / 40 Nm, `sets` sets of 30 s, bounds
 * +-1000. The disturbance is in N rms, and 0.4 of it in Nm. `seed` seeds everything. */
void chain_defaults(chain_config_t *cfg, uint64_t seed, uint32_t sets, double disturbance_N);

/** Make the identifier passive: move the excitation of cfg->acting to cfg->driver. */
void chain_set_driver(chain_config_t *cfg);

/** Start; the excitation begins when navigation is fresh, in 0.2 s.
 * @return the status of chain_init; AUVID_ERR_RANGE if the simulator refuses. */
auvid_status_t chain_begin(chain_t *chain, const chain_config_t *cfg);

/** Initialise chain->id with cfg->id and attach the prediction and, unless passive, excitation and
 * guard, as chain_begin does. @return the status of the library. */
auvid_status_t chain_init(chain_t *chain, const chain_config_t *cfg);

/** Copy a chain with all that is attached. */
void chain_copy(chain_t *to, const chain_t *from);

/** Are the identifiers and what is attached to them equal, byte for byte? */
bool chain_is_same(const chain_t *a, const chain_t *b);

/** Convert the simulator's samples to the identifier's input. */
void chain_sense(const sim_output_t *seen, uint64_t epoch_us, auvid_input_t *in);

/** Arm and excite as soon as possible, and step with what IMU and DVL have seen, and nothing else.
 * @param excited false before the first step; set when the excitation begins
 * @param in, out written: input and output of the step
 * @return the status of the step */
auvid_status_t chain_step_with_velocity(auvid_identifier_t *id, const sim_output_t *seen,
                                        bool *excited, auvid_input_t *in, auvid_output_t *out);

/** Run one tick. After CHAIN_MAX_TICKS, a day, the program ends, so that no loop waits forever. */
#define CHAIN_MAX_TICKS 4320000u
void chain_tick(chain_t *chain);

/** Run the ticks of so many seconds. */
void chain_run(chain_t *chain, double seconds);

/** Begin and run long enough for `sets` sets to be complete. */
auvid_status_t chain_run_sets(chain_t *chain, const chain_config_t *cfg, uint32_t sets);

/** Work until nothing is left, `budget` units a call.
 * @return number of calls; max_calls + 1 if max_calls calls did not suffice. */
uint32_t chain_finish(chain_t *chain, uint32_t budget, uint32_t max_calls);

/** Error of parameter i of the estimate, relative to the simulator's truth. */
double chain_error(const chain_t *chain, int i);

/** Mean square of the 13 errors. */
double chain_mean_square(const chain_t *chain);

#endif
