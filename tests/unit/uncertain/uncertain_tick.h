/* One tick of a simulated vehicle whose thrusters' commands are the wrench itself. */
#ifndef UNCERTAIN_TICK_H
#define UNCERTAIN_TICK_H

#include <string.h>

#include "chain.h"
#include "unity.h"

/* steer adds the pilot's wrench to that of the excitation. */
static inline void uncertain_tick(chain_t *c, const chain_config_t *cfg, void (*steer)(void))
{
    sim_output_t out;
    auvid_input_t in;
    double wrench[AUVID_DOF_COUNT];
    auvid_real_t command[AUVID_MAX_COMMANDS] = {0};
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        wrench[j] = (double)c->wrench[j];
    }
    sim_step(&c->sim, NULL, wrench, &out);
    chain_sense(&out, 0, &in);
    if (c->waiting && auvid_identifier_arm(&c->id) == AUVID_OK) {
        c->waiting = false;
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_excite(&c->id));
    }
    (void)auvid_identifier_step(&c->id, &in, &c->out);
    memcpy(c->wrench, c->out.excitation, sizeof c->wrench);
    c->wrench[AUVID_HEAVE] -= (auvid_real_t)cfg->sim.parameter[SIM_WB];
    steer();
    memcpy(command, c->wrench, 3 * sizeof command[0]);
    command[3] = c->wrench[AUVID_YAW];
    (void)auvid_identifier_applied(&c->id, in.t_us, c->wrench, command);
}

#endif
