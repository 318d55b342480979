/*
 * auvid vehicle: a simulated vehicle on a CAN bus.
 */
#include <stdio.h>
#include <stdlib.h>

#include "bus_link.h"
#include "../commands.h"
#include "../base/report_error.h"
#include "../report/report.h"
#include "../vehicle/vehicle_calibration.h"
#include "../vehicle/vehicles.h"

/* Largest number of frames per turn of the loop: more than a full bus transmits in a tick. */
#define MAX_FRAMES 512

/* In lock step, ticks of 20 ms until a node that has never answered gets another tick. The first
 * answer may take longer than one tick, and a repeated run must be the same. */
#define FIRST_TICKS 50

typedef struct {
    const options_t *options;
    vehicle_sim_t vehicle_sim;
    link_t link;
    vehicle_calibration_t calibration[VEHICLE_CALIBRATIONS]; /* known forces */
    int calibrations;
    uint64_t last_frame_us; /* time of the node's last frame */
    bool stop;
} run_t;

static int receive(run_t *run)
{
    auvid_can_frame_t frame;
    int got = 0;
    for (int k = 0; k < MAX_FRAMES && (got = link_receive(&run->link, &frame)) > 0; ++k) {
        uint32_t before = run->vehicle_sim.frames;
        vehicle_sim_take(&run->vehicle_sim, &frame);
        run->last_frame_us = run->vehicle_sim.frames != before ? tick_now_us() : run->last_frame_us;
    }
    return got < 0 ? EXIT_REFUSED : 0;
}

/* Waits until the next tick is due: 20 ms, or in lock step until the node has done its tick. A node
 * that has never answered may be absent, so the wait for it is limited. */
static int pace(run_t *run)
{
    const vehicle_sim_t *vehicle_sim = &run->vehicle_sim;
    bool lock_step = run->options->lock_step;
    int status = 0, ticks = lock_step ? FIRST_TICKS : 1;
    while (status == 0 && !run->stop && ticks > 0) {
        int events = tick_wait(&run->link.tick, -1);
        status = events < 0 ? report_error("vehicle: %s", run->link.tick.text) : receive(run);
        run->stop = events > 0 && (events & TICK_STOP) != 0;
        bool silent =
            run->last_frame_us > 0 && tick_now_us() - run->last_frame_us > LINK_SILENCE_US;
        run->stop = run->stop || silent;
        if (lock_step && vehicle_sim->done == vehicle_sim->sequence) {
            break;
        }
        bool counts = !lock_step || vehicle_sim->done == 0;
        ticks -= events > 0 && (events & TICK_DUE) != 0 && counts;
    }
    return status;
}

static int loop(run_t *run)
{
    auvid_can_frame_t frame[VEHICLE_SIM_FRAMES];
    int status = 0;
    while (status == 0 && !run->stop) {
        status = receive(run);
        (void)vehicle_load(run->calibration, run->calibrations, &run->vehicle_sim);
        int count = vehicle_sim_tick(&run->vehicle_sim, frame);
        status = status == 0 ? link_send(&run->link, frame, count) : status;
        status = status == 0 ? pace(run) : status;
    }
    return status;
}

static void print(const run_t *run)
{
    const vehicle_sim_t *c = &run->vehicle_sim;
    double rms = vehicle_sim_rms_percent(c);
    char text[200];
    printf("auvid %s vehicle on %s: %.0f s simulated, %u frames of a node\n", AUVID_VERSION_STRING,
           run->options->bus, 1e-6 * (double)c->seen.t_us, (unsigned)c->frames);
    printf("  commands  %u good, %u lost, %u repeated, %u out of sequence, %u bad\n",
           (unsigned)c->command.half[0].good, (unsigned)c->command.half[0].lost,
           (unsigned)c->command.half[0].repeated, (unsigned)c->command.half[0].counter_jumps,
           (unsigned)(c->command.half[0].checksum + c->command.half[0].invalid));
    if (c->cut_us > 0) {
        printf("  thrust    zero %.0f ms after the last command, cut %u times\n",
               1e-3 * (double)c->cut_us, (unsigned)c->cuts);
    }
    if (rms >= 0.0) {
        printf("  estimate  %u sets, rms error %.2f %%\n", (unsigned)c->sets, rms);
    }
    for (unsigned k = 0; auvid_causes_sentence(&c->causes, run->options->vehicle->model, k, text,
                                               sizeof text) == AUVID_OK;
         ++k) {
        printf("%s    %s\n", k == 0 ? "  wrong inputs\n" : "", text);
    }
}

int bus_vehicle(const options_t *options)
{
    run_t *run = calloc(1, sizeof *run);
    if (run == NULL) {
        return report_error("vehicle: not enough memory");
    }
    vehicle_sim_config_t cfg;
    vehicle_simulation(options->vehicle, &cfg);
    cfg.sim.seed = options->seed;
    cfg.sim.lag_s = options->lag_s;
    cfg.sim.disturbance_N = options->disturbance_N;
    cfg.sim.disturbance_Nm = 0.4 * options->disturbance_N;
    cfg.no_arm = options->no_arm;
    cfg.arm_again = options->arm_again;
    run->options = options;
    run->calibrations = vehicle_calibrations_of(options->vehicle, NULL, true, run->calibration);
    int status = vehicle_sim_init(&run->vehicle_sim, &cfg)
                     ? link_open(&run->link, "vehicle", options)
                     : report_error("vehicle: the simulator refused its configuration");
    if (status == 0) {
        status = loop(run);
        if (status == 0) {
            print(run);
        }
        (void)link_close(&run->link);
    }
    free(run);
    return status;
}
