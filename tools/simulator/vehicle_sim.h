/**
 * @file vehicle_sim.h
 * The simulated vehicle as seen on the bus: it sends sensor frames, thruster feedback and the tick
 * frame, and receives thruster commands.
 *
 * The vehicle adds its own hover thrust, as the station keeping of an operator would. Commanded
 * thrust is added to it, and is zero unless good commands keep arriving (can.h). The
 * vehicle provides the clock: the tick frame ends the frames of a tick, and ages of samples are
 * relative to it. It also plays the operator: it sends an arm frame one second after the node
 * navigates, and repeats it every second until the guard leaves DISARMED.
 */
#ifndef VEHICLE_SIM_H
#define VEHICLE_SIM_H

#include "auvid/allocation.h"
#include "auvid/node.h"
#include "simulator.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Largest number of frames in a tick: two of IMU, DVL and feedback, one of each other sensor, arm,
 * abort, tick. */
enum { VEHICLE_SIM_FRAMES = SIM_SENSORS + 7 };

/** Largest number of parameters in the reports of a node. */
enum { VEHICLE_SIM_PARAMETERS = SIM_FOSSEN_PARAMETERS };

typedef struct {
    sim_config_t sim;
    const auvid_allocation_config_t *allocation; /**< default auvid_allocation_girona500 */
    bool no_arm;                                 /**< never arm the node */
    bool arm_again; /**< disarm after an abort, and arm a second later */
} vehicle_sim_config_t;

typedef struct {
    sim_t sim;
    sim_output_t seen; /**< sensors and feedback of the last tick */
    auvid_can_sender_t sender;
    auvid_can_command_t command; /**< receiver of the commands, read-only */
    double hover_N[SIM_THRUSTERS];
    double force_N[SIM_THRUSTERS]; /**< thrust in the last tick */
    uint32_t sequence;             /**< sequence number of the last tick frame */
    uint32_t done;                 /**< sequence of the last tick_done */
    uint32_t ticks_navigated;      /* since the node first reported its position */
    uint32_t frames;               /**< accepted frames of the node */
    uint32_t sets, searches;       /**< reported by the node */
    uint8_t guard, work;           /**< likewise */
    uint64_t cut_us;               /**< when commands last ended: time from the last good one until
                                          thrust was zero */
    uint32_t cuts;                 /**< how often commands ended */
    double estimate[VEHICLE_SIM_PARAMETERS]; /**< last reported by the node */
    double sigma[VEHICLE_SIM_PARAMETERS];    /**< likewise; infinite: unknown */
    uint32_t estimated;                      /**< bit i: parameter i was reported */
    auvid_causes_t causes;                   /**< what is wrong with the inputs, likewise */
    bool no_arm, arm_again;                  /* from the configuration */
    bool navigates, armed;                   /* the guard has left DISARMED */
    bool commanded;                          /**< commanded thrust acted in the last tick */
    bool order_arm, order_abort;             /**< set by the operator, sent with the next tick */
} vehicle_sim_t;

/** Writes the defaults of the simulator. */
void vehicle_sim_defaults(vehicle_sim_config_t *cfg);

/** Starts at time 0. Returns false if the simulator refuses its configuration. */
bool vehicle_sim_init(vehicle_sim_t *vehicle, const vehicle_sim_config_t *cfg);

/** Receives a frame from the bus. Its time of arrival is that of the last tick. */
void vehicle_sim_take(vehicle_sim_t *vehicle, const auvid_can_frame_t *frame);

/** Writes the current true values of the parameters of the model; 0 after the last one. */
void vehicle_sim_truth(const vehicle_sim_t *vehicle, double truth[VEHICLE_SIM_PARAMETERS]);

/** Root mean square relative error of the reported estimates whose truth is not 0 [%];
 * negative: not all of them have been reported. */
double vehicle_sim_rms_percent(const vehicle_sim_t *vehicle);

/** Writes the thrust currently commanded by the node. @param force_N [SIM_THRUSTERS] written.
 * @return whether there are good commands */
bool vehicle_sim_commanded(vehicle_sim_t *vehicle, double force_N[SIM_THRUSTERS]);

/** Simulates a tick of 20 ms. @param frame [VEHICLE_SIM_FRAMES] written: to be sent in this order.
 * @return how many */
int vehicle_sim_tick(vehicle_sim_t *vehicle, auvid_can_frame_t *frame);

#ifdef __cplusplus
}
#endif

#endif
