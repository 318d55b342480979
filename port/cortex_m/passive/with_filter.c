/*
 * auvid in firmware, with its own filter: mass, drag and buoyancy from IMU, DVL and depth while
 * somebody else drives. Copy this file.
 */
#include <string.h>

#include "driver.h"

/* Units of search work in each tick: auvid/identifier.h. */
#ifndef BUDGET
#define BUDGET AUVID_DEFAULT_BUDGET
#endif

static auvid_identifier_t id; /* all the memory that auvid uses */

/* Your vehicle. */
static bool configure(void)
{
    static const auvid_real_t largest[AUVID_DOF_COUNT] = {100, 100, 100, 0, 0, 40}; /* [N, Nm] */
    auvid_identifier_config_t *cfg = &id.cfg; /* undefined after auvid_identifier_init */
    auvid_identifier_defaults(cfg, &auvid_girona500);
    memcpy(cfg->metric.tau_max, largest, sizeof largest);
    cfg->exact_inputs = true; /* of a simulated vehicle; of yours: auvid/uncertain.h */
    return auvid_identifier_init(&id, cfg) >= 0;
}

static void control_tick(uint64_t now_us)
{
    auvid_input_t in = {.t_us = now_us};
    auvid_output_t out;
    driver_sensors(&in);
    driver_thrust(in.applied.wrench);
    in.applied.present = true;
    (void)auvid_identifier_step(&id, &in, &out);
    (void)auvid_identifier_work(&id, BUDGET);
    if ((out.events & AUVID_EVENT_ESTIMATE) != 0) {
        driver_estimate(auvid_identifier_estimate(&id));
    }
}

int main(void)
{
    if (!configure()) {
        const char *field = id.refusal.field; /* e.g. "sigma_dvl"; value and limit beside it */
        driver_fault(field != NULL ? field : "auvid refused its configuration");
    }
    driver_start();
    for (;;) {
        control_tick(driver_wait());
    }
}
