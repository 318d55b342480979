/*
 * auvid in firmware: the identifier as a node on the vehicle's CAN bus. Copy this file.
 *
 * The receive interrupt fills a queue; this loop empties it. The vehicle's controller sends a tick
 * frame every 20 ms, after its sensor frames. It starts one control tick: step, send the commands,
 * search in the time that is left, report, feed the watchdog. lib/can/README.md documents the
 * frames. Write the functions of driver.h for your board.
 */
#include <string.h>

#include "auvid/can.h"
#include "auvid/node.h"
#include "driver.h"

/* Units of search work in each tick. In the worst case the whole tick must fit into 20 ms; the
 * health frame reports the load. The number is fixed and does not depend on the clock, so a log of
 * the bus replays on a desk bit for bit (auvid replay). */
#ifndef BUDGET
#define BUDGET AUVID_DEFAULT_BUDGET
#endif

#define TICK_US 20000u
#define SILENCE_US 150000u /* without a tick for this long, the bus is disconnected */

static auvid_node_t node; /* with what follows, all the memory that auvid uses */
static auvid_validation_t prediction;
static auvid_change_detector_t change;
static auvid_actuation_t actuation;
static auvid_can_fifo_t received;
static auvid_can_frame_t received_storage[16]; /* more than the frames of a tick; a power of two */

/* Of the excitation [N, Nm]. */
static const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 100, 100, 0, 0, 40};

/* Your vehicle: model and thrusters. Each set is compared with a simulation, and tested for a
 * change of the vehicle. */
static bool configure(void)
{
    auvid_identifier_config_t *cfg = &node.id.cfg; /* undefined after auvid_node_init */
    auvid_node_config_t bus;
    auvid_node_defaults(&bus);
    auvid_identifier_defaults(cfg, &auvid_girona500);
    memcpy(cfg->metric.tau_max, amplitude, sizeof amplitude); /* 0: what the thrusters give */
    cfg->exact_inputs = true; /* of a simulated vehicle; of yours: auvid_node_attach_uncertain */
    /* rows as close as there is memory for; 240 s fill the sets */
    cfg->metric.row_cells = (AUVID_MAX_TAPS + AUVID_MAX_OVERLAP - 1) / AUVID_MAX_OVERLAP;
    cfg->metric.set_rows = (uint16_t)(2400 / (cfg->metric.row_cells * AUVID_MAX_SETS));
    return auvid_node_init(&node, &bus, &auvid_allocation_girona500, cfg) >= 0 &&
           auvid_identifier_attach_prediction(&node.id, &prediction) >= 0 &&
           auvid_identifier_attach_change_test(&node.id, &change) >= 0;
}

/* Excitation and limits of the guard. Without this the node listens and identifies, and never
 * commands a thruster. */
static bool configure_excitation(void)
{
    auvid_actuation_config_t cfg;
    auvid_actuation_defaults(&cfg);
    return auvid_excitation_plan(&cfg.excitation, amplitude, 30, 8, 1) >= 0 &&
           auvid_node_attach_actuation(&node, &actuation, &cfg) >= 0;
}

static void send(const auvid_can_frame_t *frame, int count)
{
    for (int i = 0; i < count; ++i) {
        driver_send(&frame[i]);
    }
}

static void step(void)
{
    auvid_can_frame_t frame[AUVID_NODE_COMMANDS];
    int count;
    (void)auvid_node_step(&node, NULL, frame, &count);
    send(frame, count); /* the excitation: thruster commands */
}

static void report(uint32_t load_percent)
{
    auvid_can_frame_t frame[AUVID_NODE_FRAMES];
    int count;
    (void)auvid_node_report(&node, load_percent, frame, &count);
    send(frame, count); /* navigation, estimates, health */
}

static void control_tick(void)
{
    uint32_t start_us = driver_now_us();
    step();                               /* navigate, record, excite */
    (void)auvid_node_work(&node, BUDGET); /* search */
    report(100u * (driver_now_us() - start_us) / TICK_US);
    driver_feed_watchdog();
}

/* Without ticks there are no samples, so the thrusters must stop. Before the first tick this is no
 * fault: the vehicle's controller may start later than this board. */
static void control_silence(void)
{
    auvid_can_frame_t frame[AUVID_NODE_COMMANDS];
    int count;
    if (node.started) {
        (void)auvid_node_halt(&node, AUVID_GUARD_TICK, frame, &count);
        send(frame, count);
    }
    driver_feed_watchdog();
}

int main(void)
{
    auvid_can_frame_t frame;
    if (!configure() || auvid_can_fifo_init(&received, received_storage, 16) < 0) {
        const char *field = node.id.refusal.field; /* e.g. "sigma_dvl"; value and limit beside it */
        driver_fault(field != NULL ? field : "auvid refused its configuration");
    }
    if (!configure_excitation()) {
        const char *field = actuation.refusal.field;
        driver_fault(field != NULL ? field : "auvid refused its excitation");
    }
    driver_start(&received);
    for (uint32_t tick_us = driver_now_us();;) {
        while (auvid_can_fifo_pop(&received, &frame) == AUVID_OK) {
            if (auvid_node_take(&node, &frame) == AUVID_TICK) {
                tick_us = driver_now_us();
                control_tick();
            }
        }
        if (driver_now_us() - tick_us > SILENCE_US) {
            tick_us = driver_now_us();
            control_silence();
        }
        driver_sleep();
    }
}
