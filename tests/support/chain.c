#include "chain.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TICKS_PER_S (1000000 / SIM_TICK_US)

/* Cells, smoother and DVL lag behind the clock; the excitation's fades are part of its run. */
#define TAIL_S 6.0

void chain_defaults(chain_config_t *cfg, uint64_t seed, uint32_t sets, double disturbance_N)
{
    static const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 100, 100, 0, 0, 40};
    static const auvid_real_t tau_max[AUVID_DOF_COUNT] = {100, 100, 100, 40, 40, 40};
    memset(cfg, 0, sizeof *cfg);
    sim_defaults(&cfg->sim);
    cfg->sim.seed = seed;
    cfg->sim.disturbance_N = disturbance_N;
    cfg->sim.disturbance_Nm = 0.4 * disturbance_N;
    auvid_identifier_defaults(&cfg->id, &auvid_girona500);
    cfg->id.exact_inputs = true;
    auvid_actuation_defaults(&cfg->acting);
    cfg->thrusters = auvid_allocation_girona500;
    memcpy(cfg->id.metric.tau_max, tau_max, sizeof tau_max);
    cfg->id.search.seed = seed;
    memset(&cfg->id.uncertainty, 0, sizeof cfg->id.uncertainty); /* all is exact here */
    (void)auvid_excitation_plan(&cfg->acting.excitation, amplitude, CHAIN_SET_S, sets, seed);
    cfg->budget = AUVID_DEFAULT_BUDGET;
}

void chain_set_driver(chain_config_t *cfg)
{
    cfg->passive = true;
    cfg->driver = cfg->acting.excitation;
}

auvid_status_t chain_init(chain_t *chain, const chain_config_t *cfg)
{
    bool limited = cfg->thrusters.thrusters > 0;
    auvid_status_t status = auvid_identifier_init(&chain->id, &cfg->id);
    if (status >= 0) {
        status = auvid_identifier_attach_prediction(&chain->id, &chain->prediction);
    }
    if (status >= 0) {
        status = auvid_identifier_attach_change_test(&chain->id, &chain->change);
    }
    if (status >= 0) {
        status = auvid_identifier_attach_prior(&chain->id, &chain->prior);
    }
    if (status >= 0 && !cfg->passive && limited) {
        status = auvid_allocation_init(&chain->allocation, &cfg->thrusters);
    }
    return status < 0 || cfg->passive
               ? status
               : auvid_identifier_attach_actuation(&chain->id, &chain->actuation, &cfg->acting,
                                                   limited ? &chain->allocation : NULL);
}

auvid_status_t chain_begin(chain_t *chain, const chain_config_t *cfg)
{
    memset(chain, 0, sizeof *chain);
    chain->cfg = *cfg;
    chain->wrench[AUVID_HEAVE] = (auvid_real_t)-cfg->sim.parameter[SIM_WB];
    if (!sim_init(&chain->sim, &cfg->sim)) {
        return AUVID_ERR_RANGE;
    }
    auvid_status_t status = AUVID_OK;
    if (cfg->literal != NULL) {
        status = literal_identifier(cfg->literal, &chain->cfg.id);
        literal_attach(cfg->literal, &chain->id.metric);
    }
    status = status < 0 ? status : chain_init(chain, &chain->cfg);
    if (status >= 0 && cfg->passive) {
        status = auvid_excitation_init(&chain->driver, &cfg->driver);
        if (status >= 0) {
            status = auvid_excitation_start(&chain->driver, cfg->epoch_us + SIM_TICK_US);
        }
    } else if (status >= 0 && cfg->acting.excitation.segments > 0) {
        chain->waiting = true;
    }
    return status;
}

void chain_copy(chain_t *to, const chain_t *from)
{
    *to = *from;
    to->id.attached.prediction = &to->prediction;
    to->id.attached.change = &to->change;
    to->id.metric.prior_context = &to->prior;
    if (from->id.actuation != NULL) {
        to->id.actuation = &to->actuation;
        to->actuation.shape_context = from->actuation.shape != NULL ? &to->adaptive : NULL;
        to->actuation.allocation = from->actuation.allocation != NULL ? &to->allocation : NULL;
    }
}

bool chain_is_same(const chain_t *a, const chain_t *b)
{
    static auvid_identifier_t id;
    static auvid_actuation_t actuation;
    id = a->id;
    actuation = a->actuation;
    id.actuation = b->id.actuation;
    id.attached.prediction = b->id.attached.prediction;
    id.attached.change = b->id.attached.change;
    id.metric.prior_context = b->id.metric.prior_context;
    actuation.allocation = b->actuation.allocation;
    return memcmp(&id, &b->id, sizeof id) == 0 &&
           memcmp(&actuation, &b->actuation, sizeof actuation) == 0 &&
           memcmp(&a->prior, &b->prior, sizeof a->prior) == 0 &&
           memcmp(&a->change, &b->change, sizeof a->change) == 0 &&
           memcmp(&a->prediction, &b->prediction, sizeof a->prediction) == 0;
}

static void copy(auvid_real_t *to, const double *from, int n)
{
    for (int i = 0; i < n; ++i) {
        to[i] = (auvid_real_t)from[i];
    }
}

void chain_sense(const sim_output_t *seen, uint64_t epoch_us, auvid_input_t *in)
{
    const sim_measurement_t *imu = &seen->sensor[SIM_IMU], *dvl = &seen->sensor[SIM_DVL];
    const sim_measurement_t *depth = &seen->sensor[SIM_DEPTH], *gps = &seen->sensor[SIM_GPS];
    memset(in, 0, sizeof *in);
    in->t_us = epoch_us + seen->t_us;
    in->imu.present = imu->has;
    in->imu.t_us = epoch_us + imu->t_us;
    copy(in->imu.attitude, imu->value, 3);
    copy(in->imu.rates, imu->value + 3, 3);
    in->dvl.present = dvl->has;
    in->dvl.sample.t_us = epoch_us + dvl->t_us;
    in->dvl.sample.lock = dvl->bottom ? AUVID_DVL_BOTTOM : AUVID_DVL_WATER;
    in->dvl.sample.valid = dvl->axes;
    copy(in->dvl.sample.velocity, dvl->value, 3);
    in->depth.present = depth->has;
    in->depth.t_us = epoch_us + depth->t_us;
    in->depth.depth_m = (auvid_real_t)depth->value[0];
    in->altitude.present = dvl->has && dvl->bottom;
    in->altitude.t_us = in->dvl.sample.t_us;
    in->altitude.altitude_m = (auvid_real_t)dvl->value[3];
    in->gps.present = gps->has;
    in->gps.t_us = epoch_us + gps->t_us;
    in->gps.x_m = (auvid_real_t)gps->value[0];
    in->gps.y_m = (auvid_real_t)gps->value[1];
}

/* Set the wrench from now on. */
/* Record the wrench in force; for uncertain inputs also the thrusters' forces. */
static void apply(chain_t *chain)
{
    auvid_allocation_result_t forces;
    bool asked = chain->id.attached.uncertain_functions != NULL &&
                 auvid_allocation_solve(&chain->allocation, chain->wrench, &forces) >= 0;
    (void)auvid_identifier_applied(&chain->id, chain->t_us, chain->wrench,
                                   asked ? forces.force_N : NULL);
}

static void drive(chain_t *chain, const auvid_real_t *excitation)
{
    memcpy(chain->wrench, excitation, sizeof chain->wrench);
    chain->wrench[AUVID_HEAVE] += (auvid_real_t)-chain->cfg.sim.parameter[SIM_WB];
}

static void work(chain_t *chain, uint32_t budget)
{
    chain->work = chain->cfg.literal != NULL ? literal_work(&chain->id, budget)
                                             : auvid_identifier_work(&chain->id, budget);
    chain->over_budget = chain->over_budget || chain->id.work.last_units > budget;
    chain->max_units =
        chain->id.work.last_units > chain->max_units ? chain->id.work.last_units : chain->max_units;
}

auvid_status_t chain_step_with_velocity(auvid_identifier_t *id, const sim_output_t *seen,
                                        bool *excited, auvid_input_t *in, auvid_output_t *out)
{
    chain_sense(seen, 0, in);
    in->depth.present = in->altitude.present = in->gps.present = false;
    if (!*excited && auvid_identifier_arm(id) == AUVID_OK) {
        *excited = auvid_identifier_excite(id) == AUVID_OK;
    }
    return auvid_identifier_step(id, in, out);
}

void chain_tick(chain_t *chain)
{
    sim_output_t seen;
    auvid_input_t in;
    double wrench[AUVID_DOF_COUNT];
    if (chain->tick >= CHAIN_MAX_TICKS) {
        puts("chain:FAIL: timeout, the awaited state does not come");
        exit(1);
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        wrench[j] = (double)chain->wrench[j];
    }
    sim_step(&chain->sim, NULL, wrench, &seen);
    chain_sense(&seen, chain->cfg.epoch_us, &in);
    ++chain->tick;
    chain->t_us = in.t_us;
    if (chain->cfg.passive) {
        auvid_real_t excitation[AUVID_DOF_COUNT];
        (void)auvid_excitation_step(&chain->driver, in.t_us, excitation);
        drive(chain, excitation);
        in.applied.present = true;
        memcpy(in.applied.wrench, chain->wrench, sizeof chain->wrench);
    }
    if (chain->cfg.before != NULL) {
        chain->cfg.before(chain, &in);
    }
    if (chain->waiting && auvid_identifier_arm(&chain->id) == AUVID_OK) {
        chain->waiting = false;
        (void)auvid_identifier_excite(&chain->id);
    }
    memset(&chain->out, 0xFF, sizeof chain->out);
    chain->status = auvid_identifier_step(&chain->id, &in, &chain->out);
    chain->events |= chain->out.events;
    chain->estimates += (chain->out.events & AUVID_EVENT_ESTIMATE) != 0;
    if (!chain->cfg.passive) {
        drive(chain, chain->out.excitation);
        apply(chain);
    }
    if (chain->cfg.literal != NULL) {
        literal_tick(chain->cfg.literal, &chain->id);
    }
    if (chain->cfg.after != NULL) {
        chain->cfg.after(chain, chain->status, &chain->out);
    }
    work(chain, chain->cfg.budget);
}

void chain_run(chain_t *chain, double seconds)
{
    for (int k = (int)(seconds * TICKS_PER_S + 0.5); k > 0; --k) {
        chain_tick(chain);
    }
}

auvid_status_t chain_run_sets(chain_t *chain, const chain_config_t *cfg, uint32_t sets)
{
    auvid_status_t status = chain_begin(chain, cfg);
    if (status >= 0) {
        chain_run(chain, (double)sets * CHAIN_SET_S + TAIL_S);
    }
    return status;
}

uint32_t chain_finish(chain_t *chain, uint32_t budget, uint32_t max_calls)
{
    for (uint32_t calls = 1; calls <= max_calls; ++calls) {
        work(chain, budget);
        if (chain->work != AUVID_PENDING) {
            return calls;
        }
    }
    return max_calls + 1;
}

double chain_error(const chain_t *chain, int i)
{
    return (double)chain->id.estimate.pi[i] / chain->sim.cfg.parameter[i] - 1.0;
}

double chain_mean_square(const chain_t *chain)
{
    double sum = 0.0;
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        sum += chain_error(chain, i) * chain_error(chain, i);
    }
    return sum / SIM_PARAMETERS;
}
