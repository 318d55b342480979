#include "world.h"

#include <string.h>

/* Moment of the disturbance relative to its force [m]. */
#define DISTURBANCE_ARM 0.4

static const vehicle_t *vehicle_of(const world_config_t *config)
{
    return config->vehicle == NULL ? vehicle_default() : config->vehicle;
}

/* Replaces the plan by adaptive excitation, with the same amplitudes and excursion limits. */
static auvid_status_t adapt(world_t *world, const world_config_t *config)
{
    auvid_adaptive_config_t cfg;
    const auvid_excitation_t *plan = &world->actuation.excitation;
    auvid_adaptive_defaults(&cfg);
    (void)auvid_excitation_peak(plan, cfg.amplitude);
    memcpy(cfg.excursion_limit, plan->cfg.excursion_limit, sizeof cfg.excursion_limit);
    cfg.max_s = (auvid_real_t)(config->sets * WORLD_SET_S);
    cfg.seed = config->seed;
    return auvid_adaptive_begin(&world->node[0].id, &world->adaptive, &cfg, NULL);
}

void world_identifier(auvid_identifier_config_t *cfg, const world_config_t *config)
{
    vehicle_identifier(vehicle_of(config), config->seed, cfg);
    cfg->velocity = config->both_locks ? AUVID_VELOCITY_WATER : AUVID_VELOCITY_GROUND;
    if (config->options != NULL) {
        options_uncertainty(config->options, &cfg->uncertainty);
    }
    for (int i = 0; i < 3; ++i) {
        cfg->nav.mount.dvl_lever[i] += (auvid_real_t)config->dvl_arm_m[i];
    }
    if (config->literal) {
        cfg->vehicle = cfg->metric.vehicle = vehicle_of(config)->model; /* no averaged rows */
        cfg->recorder.cell_us = SIM_TICK_US;
        /* a row every half second, as by default */
        cfg->metric.row_cells = (uint16_t)(500000 / SIM_TICK_US);
    }
}

auvid_status_t world_excite(auvid_node_t *node, auvid_actuation_t *actuation,
                            const world_config_t *config)
{
    auvid_actuation_config_t cfg;
    vehicle_actuation(vehicle_of(config), WORLD_SET_S, config->sets, config->seed, config->idle,
                      &cfg);
    return auvid_node_attach_actuation(node, actuation, &cfg);
}

auvid_status_t world_uncertain(auvid_node_t *node, auvid_uncertain_t *uncertain,
                               const vehicle_t *vehicle)
{
    return auvid_node_attach_uncertain(node, uncertain, &vehicle->uncertain);
}

/* Starts the next node. */
static bool begin_node(world_t *world, const auvid_node_config_t *node,
                       const auvid_identifier_config_t *config)
{
    auvid_identifier_config_t cfg = *config;
    int i = world->nodes++;
    bool good = !world->is_literal || literal_identifier(&world->literal[i], &cfg) == AUVID_OK;
    literal_attach(&world->literal[i], &world->node[i].id.metric);
    return good && auvid_node_init(&world->node[i], node, world->allocation, &cfg) >= 0 &&
           auvid_identifier_attach_prediction(&world->node[i].id, &world->prediction[i]) >= 0 &&
           auvid_identifier_attach_change_test(&world->node[i].id, &world->change[i]) >= 0;
}

bool world_begin(world_t *world, const world_config_t *config)
{
    vehicle_sim_config_t vehicle_sim;
    auvid_node_config_t node;
    auvid_identifier_config_t cfg;
    memset(world, 0, sizeof *world);
    vehicle_simulation(vehicle_of(config), &vehicle_sim);
    vehicle_sim.no_arm = config->no_arm;
    vehicle_sim.sim.seed = config->seed;
    vehicle_sim.sim.disturbance_N = config->disturbance_N;
    vehicle_sim.sim.disturbance_Nm = DISTURBANCE_ARM * config->disturbance_N;
    vehicle_sim.sim.lag_s = config->lag_s;
    memcpy(vehicle_sim.sim.current, config->current, sizeof vehicle_sim.sim.current);
    vehicle_sim.sim.sensor[SIM_DVL].rate_hz *= config->both_locks ? 2.0 : 1.0;
    for (int i = 0; i < 3; ++i) {
        vehicle_sim.sim.dvl_arm_m[i] += config->dvl_arm_m[i];
    }
    for (int i = 0; i < SIM_SENSORS; ++i) {
        vehicle_sim.sim.sensor[i].age_s = config->age_s[i];
    }
    auvid_node_defaults(&node);
    world_identifier(&cfg, config);
    world->both_locks = config->both_locks;
    world->is_literal = config->literal;
    world->allocation = vehicle_of(config)->allocation;
    world->calibration = config->calibration;
    world->calibrations = config->calibrations;
    if (config->calibrations > 0 &&
        vehicle_use_known_force(&cfg, &config->calibration->force, &world->calibrated) < 0) {
        return false;
    }
    return bus_memory_init(&world->hub, WORLD_ENDS, config->seed) == BUS_OK &&
           vehicle_sim_init(&world->vehicle_sim, &vehicle_sim) && begin_node(world, &node, &cfg) &&
           (config->passive ||
            world_excite(&world->node[0], &world->actuation, config) == AUVID_OK) &&
           (!config->adaptive || adapt(world, config) == AUVID_OK);
}

bool world_listen(world_t *world, const auvid_identifier_config_t *cfg)
{
    auvid_node_config_t node;
    auvid_node_defaults(&node);
    return world->nodes < WORLD_NODES && begin_node(world, &node, cfg);
}

const auvid_refusal_t *world_refusal(const world_t *world)
{
    for (int i = 0; i < world->nodes; ++i) {
        if (!world->node[i].ready && world->node[i].id.refusal.status < 0) {
            return &world->node[i].id.refusal;
        }
    }
    bool attached = world->nodes == 0 || world->node[0].id.actuation != NULL;
    return !attached && world->actuation.refusal.status < 0 ? &world->actuation.refusal : NULL;
}

/* Passes frames to a node up to the tick frame, and sends its answer. */
static void step(world_t *world, int i)
{
    bus_memory_end_t *end = &world->hub.end[WORLD_NODE + i];
    auvid_can_frame_t frame, answer[AUVID_NODE_FRAMES];
    int count = 0;
    while (frames_receive(end, &frame)) {
        if (auvid_node_take(&world->node[i], &frame) == AUVID_TICK) {
            (void)auvid_node_step(&world->node[i], NULL, answer, &count);
            if (world->is_literal) {
                literal_tick(&world->literal[i], &world->node[i].id);
            }
            frames_send(end, answer, i == 0 ? count : 0);
        }
    }
}

/* Records the wrench of the thrust commanded to the vehicle. */
static void record_excitation(world_t *world)
{
    vehicle_sim_t *vehicle_sim = &world->vehicle_sim;
    const sim_config_t *c = &vehicle_sim->sim.cfg;
    double force_N[SIM_THRUSTERS];
    vehicle_sim_commanded(vehicle_sim, force_N);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        world->excitation[j] = 0.0;
        for (int i = 0; i < c->thrusters; ++i) {
            world->excitation[j] += c->thruster_matrix[j][i] * force_N[i];
        }
    }
}

/* Lets the known force of this time act, in the simulation and in the model. */
static void set_known_force(world_t *world)
{
    const auvid_known_force_t force =
        vehicle_load(world->calibration, world->calibrations, &world->vehicle_sim);
    (void)auvid_calibrated_force(&world->calibrated, world->vehicle_sim.seen.t_us, &force);
}

void world_tick(world_t *world)
{
    if (world->calibrations > 0) {
        set_known_force(world);
    }
    vehicle_sim_t *vehicle_sim = &world->vehicle_sim;
    if (world->both_locks && vehicle_sim->seen.sensor[SIM_DVL].has) {
        bool bottom = vehicle_sim->seen.sensor[SIM_DVL].bottom;
        vehicle_sim->sim.cfg.dvl_lock = bottom ? SIM_LOCK_WATER : SIM_LOCK_BOTTOM;
    }
    frames_vehicle(&world->hub.end[WORLD_VEHICLE], vehicle_sim);
    for (int i = 0; i < world->nodes; ++i) {
        step(world, i);
    }
    frames_take(&world->hub.end[WORLD_VEHICLE], vehicle_sim);
    record_excitation(world);
}

bool world_work(world_t *world, uint32_t budget)
{
    auvid_can_frame_t frame[AUVID_NODE_FRAMES];
    int count = 0;
    bool busy = false;
    for (int i = 0; i < world->nodes; ++i) {
        auvid_status_t status = world->is_literal ? literal_work(&world->node[i].id, budget)
                                                  : auvid_node_work(&world->node[i], budget);
        busy = status == AUVID_PENDING || busy;
        (void)auvid_node_report(&world->node[i], 0, frame, &count);
        frames_send(&world->hub.end[WORLD_NODE + i], frame, i == 0 ? count : 0);
    }
    return busy;
}

double world_time_s(const world_t *world)
{
    return 1e-6 * (double)world->vehicle_sim.seen.t_us;
}
