/**
 * @file vehicle_sim.h
 * The simulated vehicle as the bus sees it: sensor frames, thruster feedback and the tick frame
 * out, thruster commands in.
 *
 * Hover thrust is the vehicle's own (what an operator's station keeping would give); commanded
 * thrust is added to it, and is zero unless good commands keep arriving (can_receiver.h). The
 * vehicle gives the clock: what one tick sends ends with the tick frame, and ages of samples count
 * back from it. The operator's part: an arm frame once the node has navigated for a second, again
 * every second until the guard has left DISARMED.
 */
#ifndef VEHICLE_SIM_H
#define VEHICLE_SIM_H

#include "auvid/allocation.h"
#include "auvid/can_receiver.h"
#include "simulator.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Most frames of one tick. */
enum { VEHICLE_SIM_FRAMES = 12 };

/** Most parameters that the node may tell. */
enum { VEHICLE_SIM_PARAMETERS = SIM_FOSSEN_PARAMETERS };

typedef struct {
    sim_config_t sim;
    const auvid_allocation_config_t *allocation; /**< default auvid_allocation_girona500 */
    bool no_arm;                                 /**< nobody arms the node */
    bool arm_again; /**< after an abort the operator disarms, and arms a second later */
} vehicle_sim_config_t;

typedef struct {
    sim_t sim;
    sim_output_t seen; /**< of the last tick */
    auvid_can_sender_t sender;
    auvid_can_command_t command; /**< receivers of the commands; public to read */
    double hover_N[SIM_THRUSTERS];
    double force_N[SIM_THRUSTERS]; /**< what acted in the last tick */
    uint32_t sequence;             /**< of the last tick frame */
    uint32_t done;                 /**< sequence of the last tick_done */
    uint32_t ticks_navigated;      /* since the node told its position first */
    uint32_t frames;               /**< frames of the node that were taken */
    uint32_t sets, searches;       /**< which the node has told of */
    uint8_t guard, work;           /**< likewise */
    uint64_t cut_us;               /**< the last time commands ended: from the last good one until
                                          thrust was zero */
    uint32_t cuts;                 /**< times that commands ended */
    double estimate[VEHICLE_SIM_PARAMETERS]; /**< told by the node last */
    double sigma[VEHICLE_SIM_PARAMETERS];    /**< likewise; infinite: not known */
    uint32_t estimated;                /**< bit i: it has told parameter i */
    bool no_arm, arm_again;            /* of the configuration */
    bool navigates, armed;             /* the guard has left DISARMED */
    bool commanded;                    /**< commanded thrust acted in the last tick */
    bool order_arm, order_abort;       /**< written by the operator: goes out with the next tick */
} vehicle_sim_t;

/** The defaults of the simulator. */
void vehicle_sim_defaults(vehicle_sim_config_t *config);

/** Start at time 0. False when the simulator refuses its configuration. */
bool vehicle_sim_init(vehicle_sim_t *vehicle, const vehicle_sim_config_t *config);

/** Take a frame off the bus; its time of arrival is the last tick's. */
void vehicle_sim_take(vehicle_sim_t *vehicle, const auvid_can_frame_t *frame);

/** The true values of the model's parameters as the vehicle is now; beyond the last: 0. */
void vehicle_sim_truth(const vehicle_sim_t *vehicle, double truth[VEHICLE_SIM_PARAMETERS]);

/** Root mean square relative error of the estimates told, but of those whose truth is 0 [%];
 * negative: not all are there. */
double vehicle_sim_rms_percent(const vehicle_sim_t *vehicle);

/** Thrust that the node's commands ask for now. @param force_N [SIM_THRUSTERS] written.
 * @return whether there are good commands */
bool vehicle_sim_commanded(vehicle_sim_t *vehicle, double force_N[SIM_THRUSTERS]);

/** Simulate a tick of 20 ms. @param frame [VEHICLE_SIM_FRAMES] written: to be sent in this order.
 * @return how many */
int vehicle_sim_tick(vehicle_sim_t *vehicle, auvid_can_frame_t *frame);

#ifdef __cplusplus
}
#endif

#endif
