/**
 * @file ship_and_rov.h
 * Simulated logs for the width of the smoother: a slow ship in noise and waves, a quick ROV. The
 * truth has the equations of the Girona500 model. Velocity is sampled with white noise; an unknown
 * slow force and a wave force act besides the thrust.
 */
#ifndef SHIP_AND_ROV_H
#define SHIP_AND_ROV_H

#include <math.h>
#include <string.h>

#include "auvid/auvid.h"
#include "simulator.h"

/** A vehicle, what drives and disturbs it, and its sensors. */
typedef struct {
    const char *name;
    double pi[13];      /**< the truth, in the order of auvid_girona500 */
    double tau[6];      /**< largest thrust [N, Nm]; 0: the DoF rests */
    double hold_s[2];   /**< shortest and longest step of the thrust */
    double noise_mps;   /**< white noise of u and v */
    double noise_radps; /**< white noise of r */
    double period_s;    /**< of the velocity samples */
    double slow_N;      /**< unknown force, 10 s */
    double wave_N;      /**< wave force at 0.2 Hz */
    double seconds;     /**< length of the log */
} sea_log_t;

/** A craft of 3 m and 0.8 t with a time constant of 10 s, and GPS velocity at 5 Hz. */
static const sea_log_t sea_ship = {
    .name = "ship",
    .pi = {800, 1200, 1000, 900, 0, -20, -40, -60, -150, -100, -100, -150, -300},
    .tau = {150, 100, 0, 0, 0, 150},
    .hold_s = {15, 45},
    .noise_mps = 0.03,
    .noise_radps = 0.004,
    .period_s = 0.2,
    .slow_N = 4,
    .seconds = 1200};

/** An ROV of 12 kg with time constants of 0.4 to 1 s, and a DVL at 10 Hz. */
static const sea_log_t sea_rov = {
    .name = "ROV",
    .pi = {18, 24, 24, 0.6, 0, -12, -35, -18, -50, -25, -50, -0.4, -0.6},
    .tau = {40, 40, 0, 0, 0, 2},
    .hold_s = {2, 6},
    .noise_mps = 0.01,
    .noise_radps = 0.004,
    .period_s = 0.1,
    .slow_N = 0.5,
    .seconds = 240};

/** The motion of one log. */
typedef struct {
    sim_rng_t rng;
    double nu[6], psi, tau[6], until_s[6], slow[6], wave[6], wave_rate[6];
} sea_state_t;

/** Length of an integration step [s]. */
#define SEA_STEP_S 0.01

/** Advance thrust, forces and motion by one step from t_s on. */
static inline void sea_advance(const sea_log_t *log, sea_state_t *sea, double t_s)
{
    static const double level[5] = {-1.0, -0.5, 0.0, 0.5, 1.0};
    const double dt = SEA_STEP_S, slow_s = 10.0, w = 6.283185307 * 0.2, damping = 0.1;
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0}, nu_dot[6] = {0};
    auvid_sample_t s;
    memset(&s, 0, sizeof s);
    for (int i = 0; i < 13; ++i) {
        pi[i] = (auvid_real_t)log->pi[i];
    }
    for (int j = 0; j < 6; ++j) {
        double part = log->tau[j] / log->tau[0];
        if (part > 0.0 && t_s >= sea->until_s[j]) {
            sea->tau[j] = log->tau[j] * level[(int)(5.0 * sim_rng_uniform(&sea->rng)) % 5];
            sea->until_s[j] = t_s + log->hold_s[0] +
                              (log->hold_s[1] - log->hold_s[0]) * sim_rng_uniform(&sea->rng);
        }
        sea->slow[j] += part * log->slow_N * sqrt(2.0 * dt / slow_s) * sim_rng_gauss(&sea->rng) -
                        sea->slow[j] * dt / slow_s;
        sea->wave_rate[j] +=
            (-2.0 * damping * w * sea->wave_rate[j] - w * w * sea->wave[j]) * dt +
            part * log->wave_N * sqrt(4.0 * damping * w * w * w * dt) * sim_rng_gauss(&sea->rng);
        sea->wave[j] += sea->wave_rate[j] * dt;
        s.nu[j] = (auvid_real_t)sea->nu[j];
        s.tau[j] = (auvid_real_t)(sea->tau[j] + sea->slow[j] + sea->wave[j]);
    }
    s.psi = (auvid_real_t)sea->psi;
    (void)auvid_girona500.acceleration(auvid_girona500.context, &s, pi, nu_dot);
    for (int j = 0; j < 6; ++j) {
        sea->nu[j] += log->tau[j] > 0.0 ? (double)nu_dot[j] * dt : 0.0;
    }
    sea->psi += sea->nu[5] * dt;
}

/** Give the identifier what is measured at t_s: the thrust at 50 Hz, velocity when it is due. */
static inline void sea_measure(const sea_log_t *log, sea_state_t *sea, int step,
                               auvid_identifier_t *id)
{
    uint64_t t_us = 1000000u + (uint64_t)step * 10000u;
    if (step % (int)(log->period_s / SEA_STEP_S + 0.5) == 0) {
        auvid_real_t attitude[3] = {0, 0, (auvid_real_t)sea->psi}, nu[6];
        for (int j = 0; j < 6; ++j) {
            double noise = j < 3 ? log->noise_mps : log->noise_radps;
            nu[j] = (auvid_real_t)(sea->nu[j] +
                                   (log->tau[j] > 0.0 ? noise : 0.0) * sim_rng_gauss(&sea->rng));
        }
        (void)auvid_identifier_motion(id, t_us, attitude, nu);
    }
    if (step % 2 == 0) {
        auvid_real_t tau[6];
        for (int j = 0; j < 6; ++j) {
            tau[j] = (auvid_real_t)sea->tau[j];
        }
        (void)auvid_identifier_applied(id, t_us, tau, NULL);
    }
}

/** The configuration: thrust and DVL scales exact, bounds four times the truth. */
static inline void sea_configure(const sea_log_t *log, uint64_t seed,
                                 auvid_identifier_config_t *cfg)
{
    auvid_identifier_defaults(cfg, &auvid_girona500);
    cfg->exact_inputs = true;
    cfg->uncertainty.thrust_scale = cfg->uncertainty.dvl_scale = AUVID_C(0.0);
    cfg->search.seed = seed;
    cfg->metric.velocity_us = (uint32_t)(1e6 * log->period_s + 0.5);
    for (int i = 0; i < 13; ++i) {
        double bound = fmax(4.0 * fabs(log->pi[i]), 20.0);
        cfg->search.lower[i] = (auvid_real_t)-bound;
        cfg->search.upper[i] = (auvid_real_t)bound;
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        cfg->metric.tau_max[j] = (auvid_real_t)fmax(log->tau[j], 1.0);
    }
}

/** Play the log to an initialised identifier, which works with `budget` units a step; 0: only at
 * the end. @return events of all steps, as far as they are left in id->events */
static inline uint32_t sea_play(const sea_log_t *log, uint64_t seed, uint32_t budget,
                                auvid_identifier_t *id)
{
    static sea_state_t sea;
    uint32_t events = 0;
    memset(&sea, 0, sizeof sea);
    sim_rng_seed(&sea.rng, seed, 7);
    for (int step = 0; step * SEA_STEP_S < log->seconds; ++step) {
        sea_measure(log, &sea, step, id);
        sea_advance(log, &sea, step * SEA_STEP_S);
        (void)auvid_identifier_work(id, budget);
        events |= id->events;
    }
    if (budget == 0) {
        (void)auvid_identifier_close(id);
    }
    while (auvid_identifier_work(id, 100000) == AUVID_PENDING) {
    }
    return events | id->events;
}

/** Identify the whole log in eight sets, as `auvid fit` does: cells are doubled until the metric
 * asks for no more. max_cell_us 0: the cells stay 0.1 s. @return length of the cells [us];
 * 0: init refused, or no end of longer cells */
static inline uint32_t sea_fit(const sea_log_t *log, uint64_t seed, uint32_t max_cell_us,
                               auvid_identifier_t *id)
{
    static auvid_identifier_config_t cfg;
    uint32_t cell_us = 100000;
    for (int runs = 0; runs < 5; ++runs) {
        sea_configure(log, seed, &cfg);
        cfg.recorder.cell_us = cell_us;
        cfg.recorder.gap_us = 1000000;
        cfg.metric.max_cell_us = max_cell_us;
        cfg.metric.set_rows = (uint16_t)ceil(log->seconds / (5e-6 * cell_us * cfg.metric.sets));
        if (auvid_identifier_init(id, &cfg) < 0) {
            return 0;
        }
        (void)sea_play(log, seed, 0, id);
        if (id->metric.result.doublings == 0) {
            return cell_us;
        }
        cell_us = id->recorder.cell_us;
    }
    return 0;
}

#endif
