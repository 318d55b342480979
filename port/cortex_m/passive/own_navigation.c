/*
 * auvid in firmware that has its own navigation: mass, drag and buoyancy while somebody else
 * drives. Copy this file.
 *
 * It passes attitude and velocities of every tick, and the thrust; auvid's filter is not linked.
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
    auvid_identifier_config_t *cfg = &id.cfg; /* undefined after the initialisation */
    auvid_identifier_defaults(cfg, &auvid_girona500);
    memcpy(cfg->metric.tau_max, largest, sizeof largest);
    cfg->exact_inputs = true; /* of a simulated vehicle; of yours: auvid/uncertain.h */
    return auvid_identifier_init_motion(&id, cfg) >= 0;
}

static void control_tick(uint64_t now_us)
{
    auvid_real_t attitude[3], nu[AUVID_DOF_COUNT], wrench[AUVID_DOF_COUNT];
    uint32_t estimates = id.estimate.number;
    driver_motion(attitude, nu);
    driver_thrust(wrench);
    (void)auvid_identifier_motion(&id, now_us, attitude, nu);
    (void)auvid_identifier_applied(&id, now_us, wrench, NULL);
    (void)auvid_identifier_work(&id, BUDGET);
    if (id.estimate.number != estimates) {
        driver_estimate(auvid_identifier_estimate(&id));
    }
}

int main(void)
{
    if (!configure()) {
        const char *field = id.refusal.field; /* e.g. "tau_max"; value and limit beside it */
        driver_fault(field != NULL ? field : "auvid refused its configuration");
    }
    driver_start();
    for (;;) {
        control_tick(driver_wait());
    }
}
