/*
 * The driver for QEMU: a recorded dive replaces the sensors. Replace this file on a board.
 *
 * dive.log holds a record for each tick of 20 ms, in the layout of record_t, as single-precision
 * numbers. Each estimate is written to estimates.log: its parameters and their standard errors.
 */
#include "driver.h"
#include "machine.h"

#include <string.h>

#define TICK_US 20000u

typedef struct {
    float attitude[3], nu[AUVID_DOF_COUNT], wrench[AUVID_DOF_COUNT];
    float depth_m;
    float sensors; /* bit 0: a DVL sample; bit 1: a depth sample */
} record_t;

static int log_in, log_out;
static record_t record;
static uint64_t now_us;

void driver_start(void)
{
    log_in = machine_open("dive.log", false);
    log_out = machine_open("estimates.log", true);
    if (log_in < 0 || log_out < 0) {
        driver_fault("dive.log or estimates.log cannot be opened");
    }
}

uint64_t driver_wait(void)
{
    if (machine_read(log_in, &record, sizeof record) != sizeof record) {
        machine_print("stack: ");
        machine_print_number(machine_stack_used());
        machine_print(" bytes\n");
        machine_exit(0);
    }
    now_us += TICK_US;
    return now_us;
}

void driver_sensors(auvid_input_t *in)
{
    unsigned sensors = (unsigned)record.sensors;
    in->imu.present = true;
    in->imu.t_us = now_us;
    for (int i = 0; i < 3; ++i) {
        in->imu.attitude[i] = record.attitude[i];
        in->imu.rates[i] = record.nu[3 + i];
        in->dvl.sample.velocity[i] = record.nu[i];
    }
    in->dvl.present = (sensors & 1u) != 0;
    in->dvl.sample.t_us = now_us;
    in->dvl.sample.valid = 7;
    in->depth.present = (sensors & 2u) != 0;
    in->depth.t_us = now_us;
    in->depth.depth_m = record.depth_m;
}

void driver_motion(auvid_real_t *attitude, auvid_real_t *nu)
{
    for (int i = 0; i < 3; ++i) {
        attitude[i] = record.attitude[i];
    }
    for (int i = 0; i < AUVID_DOF_COUNT; ++i) {
        nu[i] = record.nu[i];
    }
}

void driver_thrust(auvid_real_t *wrench)
{
    for (int i = 0; i < AUVID_DOF_COUNT; ++i) {
        wrench[i] = record.wrench[i];
    }
}

void driver_estimate(const auvid_estimate_t *estimate)
{
    if (!machine_write(log_out, estimate->pi, sizeof estimate->pi) ||
        !machine_write(log_out, estimate->confidence.sigma, sizeof estimate->confidence.sigma)) {
        driver_fault("estimates.log cannot be written");
    }
}

void driver_fault(const char *what)
{
    machine_print("fault: ");
    machine_print(what);
    machine_print("\n");
    machine_exit(1);
}
