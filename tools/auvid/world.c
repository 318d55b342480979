#include "world.h"

#include <string.h>

/* Moment of the disturbance for its force [m]. */
#define DISTURBANCE_ARM 0.4

void world_identifier(auvid_identifier_config_t *cfg, const world_config_t *config)
{
    auvid_real_t amplitude[AUVID_DOF_COUNT] = {WORLD_FORCE_N,  WORLD_FORCE_N, WORLD_FORCE_N, 0, 0,
                                               WORLD_MOMENT_NM};
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        amplitude[j] = (config->idle >> j & 1u) ? AUVID_C(0.0) : amplitude[j];
    }
    auvid_identifier_defaults(cfg, &auvid_girona500);
    cfg->seed = config->seed;
    cfg->allocation = auvid_allocation_girona500;
    cfg->velocity = config->both_locks ? AUVID_VELOCITY_WATER : AUVID_VELOCITY_GROUND;
    (void)auvid_excitation_plan(&cfg->excitation, amplitude, WORLD_SET_S, config->sets,
                                config->seed);
    if (config->literal) {
        cfg->recorder.cell_us = SIM_TICK_US;
        auvid_identifier_literal(cfg);
        /* a row every half second, as in the default reading */
        cfg->metric.row_cells = (uint16_t)(500000 / SIM_TICK_US);
    }
}

bool world_begin(world_t *world, const world_config_t *config)
{
    sim_config_t sim;
    auvid_identifier_config_t cfg;
    memset(world, 0, sizeof *world);
    sim_defaults(&sim);
    sim.seed = config->seed;
    sim.disturbance_N = config->disturbance_N;
    sim.disturbance_Nm = DISTURBANCE_ARM * config->disturbance_N;
    sim.lag_s = config->lag_s;
    memcpy(sim.current, config->current, sizeof sim.current);
    world->both_locks = config->both_locks;
    sim.sensor[SIM_DVL].rate_hz *= config->both_locks ? 2.0 : 1.0;
    world_identifier(&cfg, config);
    world->hover_N = -sim.parameter[SIM_WB];
    world->identifiers = 1;
    return sim_init(&world->sim, &sim) && auvid_identifier_init(&world->id[0], &cfg) >= 0;
}

bool world_listen(world_t *world, const auvid_identifier_config_t *cfg)
{
    if (world->identifiers == WORLD_IDENTIFIERS) {
        return false;
    }
    return auvid_identifier_init(&world->id[world->identifiers++], cfg) >= 0;
}

static void copy(auvid_real_t *to, const double *from, int n)
{
    for (int i = 0; i < n; ++i) {
        to[i] = (auvid_real_t)from[i];
    }
}

/* What the simulator's sensors gave, as the identifier takes it. */
static void sense(const sim_output_t *seen, auvid_input_t *in)
{
    const sim_measurement_t *imu = &seen->sensor[SIM_IMU], *dvl = &seen->sensor[SIM_DVL];
    const sim_measurement_t *depth = &seen->sensor[SIM_DEPTH], *gps = &seen->sensor[SIM_GPS];
    memset(in, 0, sizeof *in);
    in->t_us = seen->t_us;
    in->imu.present = imu->has;
    in->imu.t_us = imu->t_us;
    copy(in->imu.attitude, imu->value, 3);
    copy(in->imu.rates, imu->value + 3, 3);
    in->dvl.present = dvl->has;
    in->dvl.sample.t_us = dvl->t_us;
    in->dvl.sample.lock = dvl->bottom ? AUVID_DVL_BOTTOM : AUVID_DVL_WATER;
    in->dvl.sample.valid = AUVID_DVL_ALL;
    copy(in->dvl.sample.velocity, dvl->value, 3);
    in->depth.present = depth->has;
    in->depth.t_us = depth->t_us;
    in->depth.depth_m = (auvid_real_t)depth->value[0];
    in->gps.present = gps->has;
    in->gps.t_us = gps->t_us;
    in->gps.x_m = (auvid_real_t)gps->value[0];
    in->gps.y_m = (auvid_real_t)gps->value[1];
}

/* Excitation and hover thrust to the thrusters. */
static void drive(world_t *world, const auvid_output_t *out)
{
    auvid_real_t wrench[AUVID_DOF_COUNT];
    auvid_allocation_result_t result;
    memcpy(wrench, out->excitation, sizeof wrench);
    wrench[AUVID_HEAVE] += (auvid_real_t)world->hover_N;
    (void)auvid_allocation_solve(&world->id[0].allocation, wrench, &result);
    for (int i = 0; i < SIM_THRUSTERS; ++i) {
        world->force_N[i] = (double)result.force_N[i];
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        world->wrench[j] = (double)result.wrench[j];
    }
}

void world_tick(world_t *world)
{
    auvid_input_t in;
    auvid_output_t out = {0};
    auvid_real_t feedback[AUVID_DOF_COUNT];
    uint64_t began_us = world->seen.t_us;
    if (world->both_locks && world->seen.sensor[SIM_DVL].has) {
        bool bottom = world->seen.sensor[SIM_DVL].bottom;
        world->sim.config.dvl_lock = bottom ? SIM_LOCK_WATER : SIM_LOCK_BOTTOM;
    }
    sim_step(&world->sim, world->force_N, NULL, &world->seen);
    sense(&world->seen, &in);
    copy(feedback, world->seen.wrench, AUVID_DOF_COUNT);
    if (!world->excited && auvid_identifier_arm(&world->id[0]) == AUVID_OK) {
        world->excited = auvid_identifier_excite(&world->id[0]) == AUVID_OK;
    }
    for (int i = world->identifiers - 1; i >= 0; --i) {
        /* the feedback tells of the tick that has just gone by, so it bears that one's time */
        (void)auvid_identifier_applied(&world->id[i], began_us, feedback, NULL);
        (void)auvid_identifier_step(&world->id[i], &in, &out);
    }
    world->events = out.events;
    memcpy(world->excitation, out.excitation, sizeof world->excitation);
    drive(world, &out);
}

double world_time_s(const world_t *world)
{
    return 1e-6 * (double)world->seen.t_us;
}
