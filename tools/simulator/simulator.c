/*
 * The vehicle: Karras et al. 2013, Eq. 12-15, solved for the accelerations,
 *   m_u u' = X + m_v v r - m_w w q - (W-B) sin theta          + X_u u + X_uu |u| u
 *   m_v v' = Y + m_w w p - m_u u r + (W-B) cos theta sin phi  + Y_v v + Y_vv |v| v
 *   m_w w' = Z + m_u u q - m_v v p + (W-B) cos theta cos phi  + Z_w w + Z_ww |w| w
 *   m_r r' = N + (m_u - m_v) u v                              + N_r r + N_rr |r| r
 * with roll and pitch as stable, damped pendulums, and Fossen's kinematics. Or the six degrees of
 * freedom of fossen.c.
 */
#include "simulator.h"

#include <math.h>
#include <string.h>

enum { POSITION = 0, EULER = 3, NU = 6, STATES = 12 };
enum { U, V, W, P, Q, R };

void sim_rotation(const double euler[3], double r[3][3])
{
    double cf = cos(euler[0]), sf = sin(euler[0]), ct = cos(euler[1]), st = sin(euler[1]);
    double cp = cos(euler[2]), sp = sin(euler[2]);
    double all[3][3] = {{cp * ct, cp * st * sf - sp * cf, cp * st * cf + sp * sf},
                        {sp * ct, sp * st * sf + cp * cf, sp * st * cf - cp * sf},
                        {-st, ct * sf, ct * cf}};
    memcpy(r, all, sizeof all);
}

static double drag(double linear, double quadratic, double x)
{
    return linear * x + quadratic * fabs(x) * x;
}

/* nu' of the paper's vehicle. */
static void girona500(const sim_config_t *cfg, const double euler[3], const double nu[6],
                      const double wrench[6], double d[6])
{
    const double *m = cfg->parameter;
    double sf = sin(euler[0]), cf = cos(euler[0]), st = sin(euler[1]), ct = cos(euler[1]);
    double wq_or_wp = nu[W] * (cfg->printed_eq13 ? nu[Q] : nu[P]);

    d[U] = (wrench[U] + m[SIM_M_V] * nu[V] * nu[R] - m[SIM_M_W] * nu[W] * nu[Q] - m[SIM_WB] * st +
            drag(m[SIM_X_U], m[SIM_X_UU], nu[U])) /
           m[SIM_M_U];
    d[V] = (wrench[V] + m[SIM_M_W] * wq_or_wp - m[SIM_M_U] * nu[U] * nu[R] + m[SIM_WB] * ct * sf +
            drag(m[SIM_Y_V], m[SIM_Y_VV], nu[V])) /
           m[SIM_M_V];
    d[W] = (wrench[W] + m[SIM_M_U] * nu[U] * nu[Q] - m[SIM_M_V] * nu[V] * nu[P] +
            m[SIM_WB] * ct * cf + drag(m[SIM_Z_W], m[SIM_Z_WW], nu[W])) /
           m[SIM_M_W];
    d[R] = (wrench[R] + (m[SIM_M_U] - m[SIM_M_V]) * nu[U] * nu[V] +
            drag(m[SIM_N_R], m[SIM_N_RR], nu[R])) /
           m[SIM_M_R];
    d[P] = (wrench[P] + cfg->roll_arm_m * wrench[V] - cfg->tilt_righting * sf * ct +
            cfg->munk * (m[SIM_M_V] - m[SIM_M_W]) * nu[V] * nu[W] -
            drag(cfg->tilt_linear, cfg->tilt_quadratic, nu[P])) /
           cfg->tilt_inertia;
    d[Q] = (wrench[Q] + cfg->pitch_arm_m * wrench[U] - cfg->tilt_righting * st +
            cfg->munk * (m[SIM_M_W] - m[SIM_M_U]) * nu[U] * nu[W] -
            drag(cfg->tilt_linear, cfg->tilt_quadratic, nu[Q])) /
           cfg->tilt_inertia;
}

/* nu' of a model of the library. What it has no equation for is as above, or at rest. */
static void library_model(const sim_config_t *cfg, const double euler[3], const double nu[6],
                          const double wrench[6], double d[6])
{
    const auvid_vehicle_t *model = cfg->vehicle;
    auvid_sample_t sample = {.phi = (auvid_real_t)euler[0],
                             .theta = (auvid_real_t)euler[1],
                             .psi = (auvid_real_t)euler[2]};
    auvid_real_t pi[SIM_VEHICLE_PARAMETERS], nu_dot[AUVID_DOF_COUNT] = {0};
    girona500(cfg, euler, nu, wrench, d);
    for (int i = 0; i < SIM_VEHICLE_PARAMETERS; ++i) {
        pi[i] = (auvid_real_t)cfg->vehicle_parameter[i];
    }
    for (int i = 0; i < AUVID_DOF_COUNT; ++i) {
        d[i] = i == P || i == Q ? d[i] : 0.0;
        sample.nu[i] = (auvid_real_t)nu[i];
        sample.nu_dot[i] = (auvid_real_t)d[i];
        sample.tau[i] = (auvid_real_t)wrench[i];
    }
    (void)model->acceleration(model->context, &sample, pi, nu_dot);
    for (int i = 0; i < AUVID_DOF_COUNT; ++i) {
        d[i] = model->columns[i] != 0 ? (double)nu_dot[i] : d[i];
    }
}

void sim_derivative(const sim_config_t *cfg, const double state[12], const double wrench[6],
                    double derivative[12])
{
    const double *nu = state + NU;
    double sf = sin(state[EULER]), cf = cos(state[EULER]);
    double st = sin(state[EULER + 1]), ct = cos(state[EULER + 1]), r[3][3];

    sim_rotation(state + EULER, r);
    for (int i = 0; i < 3; ++i) {
        derivative[POSITION + i] =
            r[i][0] * nu[U] + r[i][1] * nu[V] + r[i][2] * nu[W] + cfg->current[i];
    }
    derivative[EULER] = nu[P] + (sf * nu[Q] + cf * nu[R]) * st / ct;
    derivative[EULER + 1] = cf * nu[Q] - sf * nu[R];
    derivative[EULER + 2] = (sf * nu[Q] + cf * nu[R]) / ct;
    if (cfg->model == SIM_FOSSEN) {
        sim_fossen_acceleration(&cfg->fossen, state + EULER, nu, wrench, derivative + NU);
    } else if (cfg->model == SIM_VEHICLE) {
        library_model(cfg, state + EULER, nu, wrench, derivative + NU);
    } else {
        girona500(cfg, state + EULER, nu, wrench, derivative + NU);
    }
}

void sim_rk4(const sim_config_t *cfg, double state[12], const double wrench[6], double h)
{
    static const double at[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
    double k[STATES] = {0}, sum[STATES] = {0}, x[STATES];
    for (int stage = 0; stage < 4; ++stage) {
        for (int i = 0; i < STATES; ++i) {
            x[i] = state[i] + at[stage] * h * k[i];
        }
        sim_derivative(cfg, x, wrench, k);
        for (int i = 0; i < STATES; ++i) {
            sum[i] += weight[stage] * k[i];
        }
    }
    for (int i = 0; i < STATES; ++i) {
        state[i] += h / 6.0 * sum[i];
    }
}

/* ---- the tick ---- */

void sim_defaults(sim_config_t *cfg)
{
    static const double paper[SIM_PARAMETERS] = {
        249.5384, 367.7126,  659.9799, 74.9024,   -37.3058, -42.4181, -125.3578,
        -75.7673, -447.6195, -44.0561, -325.0138, -20.5833, -60.9373};
    static const double thrusters[6][SIM_THRUSTERS] = {[U] = {-1.0, -1.0},
                                                       [V] = {[4] = 1.0},
                                                       [W] = {[2] = -1.0, [3] = -1.0},
                                                       [Q] = {[2] = -0.35, [3] = 0.35},
                                                       [R] = {-0.4, 0.4}};
    const double degree = 3.14159265358979323846 / 180.0;
    sim_config_t c = {.seed = 1,
                      .tilt_inertia = 80.0,
                      .tilt_linear = 60.0,
                      .tilt_quadratic = 40.0,
                      .tilt_righting = 150.0,
                      .roll_arm_m = 0.05,
                      .pitch_arm_m = -0.08,
                      .position = {0.0, 0.0, 50.0},
                      .thrusters = 5,
                      .thruster_max_N = 153.8,
                      .disturbance_s = 2.0,
                      .seabed_m = 80.0,
                      .sensor = {[SIM_IMU] = {.rate_hz = 50.0},
                                 [SIM_DVL] = {.rate_hz = 5.0},
                                 [SIM_DEPTH] = {.rate_hz = 10.0},
                                 [SIM_GPS] = {.rate_hz = 1.0}},
                      .imu_angle_rad = 0.2 * degree,
                      .imu_rate_rad_s = 0.1 * degree,
                      .dvl_m_s = 0.007,
                      .dvl_partial_run = 1.0,
                      .dvl_range_m = 40.0,
                      .surface_m = 0.5};
    for (int i = 0; i < SIM_SENSORS; ++i) {
        if (sim_positions[i].axes > 0) {
            memcpy((char *)&c + sim_positions[i].at, &sim_positions[i].noise_m, sizeof(double));
        }
    }
    memcpy(c.parameter, paper, sizeof paper);
    memcpy(c.thruster_matrix, thrusters, sizeof thrusters);
    *cfg = c;
}

static bool all_finite(const double *x, size_t n)
{
    for (size_t i = 0; i < n; ++i) {
        if (!isfinite(x[i])) {
            return false;
        }
    }
    return true;
}

static bool vehicle_is_good(const sim_config_t *c)
{
    const sim_fossen_t *f = &c->fossen;
    double m[6][6], x[6] = {0};
    if (c->model == SIM_VEHICLE) {
        double zero[12] = {0}, derivative[12];
        if (c->vehicle == NULL || c->vehicle->acceleration == NULL ||
            c->vehicle->parameters > SIM_VEHICLE_PARAMETERS ||
            !all_finite(c->vehicle_parameter, SIM_VEHICLE_PARAMETERS)) {
            return false;
        }
        sim_derivative(c, zero, x, derivative); /* has a solution */
        return all_finite(derivative, 12);
    }
    if (c->model != SIM_FOSSEN) {
        return c->model == SIM_GIRONA500 && all_finite(c->parameter, SIM_PARAMETERS) &&
               c->parameter[SIM_M_U] > 0.0 && c->parameter[SIM_M_V] > 0.0 &&
               c->parameter[SIM_M_W] > 0.0 && c->parameter[SIM_M_R] > 0.0;
    }
    bool symmetric = true;
    for (int i = 0; i < 6; ++i) {
        for (int j = 0; j < i; ++j) {
            symmetric = symmetric && fabs(f->added[i][j] - f->added[j][i]) <= 0.0;
        }
    }
    sim_fossen_matrix(f, m);
    return isfinite(f->weight_N) && isfinite(f->buoyancy_N) && all_finite(f->r_g, 3) &&
           all_finite(f->r_b, 3) && all_finite(f->linear, 6) && all_finite(f->quadratic, 6) &&
           all_finite(&m[0][0], 36) && symmetric && sim_solve(m, x);
}

/* Adds the minimum-norm thrust of a wrench, f = T' (T T')^-1 tau.
 * Returns false if the thrusters cannot produce every wrench. */
static bool add_thrust(const sim_config_t *c, const double wrench[6], double force[SIM_THRUSTERS])
{
    const double(*t)[SIM_THRUSTERS] = c->thruster_matrix;
    double square[6][6] = {{0}}, x[6];
    memcpy(x, wrench, sizeof x);
    for (int i = 0; i < 6; ++i) {
        for (int k = 0; k < 6; ++k) {
            for (int j = 0; j < c->thrusters; ++j) {
                square[i][k] += t[i][j] * t[k][j];
            }
        }
    }
    if (!sim_solve(square, x)) {
        return false;
    }
    for (int j = 0; j < c->thrusters; ++j) {
        for (int i = 0; i < 6; ++i) {
            force[j] += t[i][j] * x[i];
        }
    }
    return true;
}

double sim_thruster_limit(const sim_config_t *cfg, int j, double force)
{
    double back = cfg->thruster_back_N > 0.0 ? cfg->thruster_back_N : cfg->thruster_max_N;
    double own = cfg->thruster_limit_N[j][force < 0.0];
    return own > 0.0 ? own : force < 0.0 ? back : cfg->thruster_max_N;
}

static bool thrusters_are_good(const sim_config_t *c)
{
    double none[6] = {0}, force[SIM_THRUSTERS] = {0};
    bool hold = c->hold_Nm_rad > 0.0 || c->hold_Nms_rad > 0.0;
    for (int j = 0; j < SIM_THRUSTERS; ++j) {
        if (!(c->thruster_limit_N[j][0] >= 0.0) || !(c->thruster_limit_N[j][1] >= 0.0)) {
            return false;
        }
    }
    return all_finite(&c->thruster_limit_N[0][0], 2 * SIM_THRUSTERS) && c->thrusters >= 0 &&
           c->thrusters <= SIM_THRUSTERS &&
           all_finite(&c->thruster_matrix[0][0], 6 * SIM_THRUSTERS) &&
           (!hold || add_thrust(c, none, force));
}

static bool config_is_good(const sim_config_t *c)
{
    const double not_negative[] = {
        c->thruster_max_N, c->thruster_back_N, c->hold_Nm_rad,   c->hold_Nms_rad,   c->lag_s,
        c->disturbance_N,  c->disturbance_Nm,  c->imu_angle_rad, c->imu_rate_rad_s, c->dvl_m_s};
    const double finite[] = {c->tilt_linear, c->tilt_quadratic, c->tilt_righting, c->roll_arm_m,
                             c->pitch_arm_m, c->munk,           c->seabed_m,      c->dvl_yaw_rad,
                             c->dvl_range_m, c->surface_m};
    for (size_t i = 0; i < sizeof not_negative / sizeof not_negative[0]; ++i) {
        if (!isfinite(not_negative[i]) || not_negative[i] < 0.0) {
            return false;
        }
    }
    return all_finite(finite, sizeof finite / sizeof finite[0]) && all_finite(c->position, 3) &&
           all_finite(c->euler, 3) && all_finite(c->nu, 6) && all_finite(c->current, 3) &&
           all_finite(c->load_N, 3) && all_finite(c->load_body_N, 3) &&
           all_finite(c->load_at_m, 3) && all_finite(c->dvl_arm_m, 3) &&
           all_finite(c->dvl_euler, 3) && all_finite(c->imu_euler, 3) && vehicle_is_good(c) &&
           thrusters_are_good(c) && isfinite(c->tilt_inertia) && c->tilt_inertia > 0.0 &&
           isfinite(c->disturbance_s) && c->disturbance_s > 0.0;
}

static double disturbance_rms(const sim_config_t *cfg, int dof)
{
    bool unknown = dof == R || cfg->model != SIM_GIRONA500;
    return dof < 3 ? cfg->disturbance_N : unknown ? cfg->disturbance_Nm : 0.0;
}

/* Adds the wrench of the load at the present attitude. */
static void add_load(const sim_t *sim, double total[6])
{
    const double *at = sim->cfg.load_at_m, *load = sim->cfg.load_N;
    double r[3][3], f[3];
    sim_rotation(sim->truth.euler, r);
    for (int i = 0; i < 3; ++i) {
        f[i] = sim->cfg.load_body_N[i] + r[0][i] * load[0] + r[1][i] * load[1] + r[2][i] * load[2];
        total[i] += f[i];
    }
    for (int i = 0; i < 3; ++i) {
        int p = (i + 1) % 3, q = (i + 2) % 3;
        total[3 + i] += at[p] * f[q] - at[q] * f[p];
    }
}

/* Velocity over ground and acceleration of the truth, from its state and forces. */
static void complete_truth(sim_t *sim)
{
    sim_truth_t *t = &sim->truth;
    double state[STATES], derivative[STATES], total[6], r[3][3];
    memcpy(state + POSITION, t->position, sizeof t->position);
    memcpy(state + EULER, t->euler, sizeof t->euler);
    memcpy(state + NU, t->nu, sizeof t->nu);
    for (int i = 0; i < 6; ++i) {
        total[i] = t->wrench[i] + t->disturbance[i];
    }
    add_load(sim, total);
    sim_derivative(&sim->cfg, state, total, derivative);
    memcpy(t->nu_dot, derivative + NU, sizeof t->nu_dot);
    sim_rotation(t->euler, r);
    for (int i = 0; i < 3; ++i) { /* R' (velocity over ground) */
        t->ground[i] = r[0][i] * derivative[0] + r[1][i] * derivative[1] + r[2][i] * derivative[2];
    }
}

bool sim_init(sim_t *sim, const sim_config_t *cfg)
{
    sim_t fresh;
    if (!config_is_good(cfg)) {
        return false;
    }
    memset(&fresh, 0, sizeof fresh);
    fresh.cfg = *cfg;
    if (!sim_sensors_init(&fresh)) {
        return false;
    }
    memcpy(fresh.truth.position, cfg->position, sizeof cfg->position);
    memcpy(fresh.truth.euler, cfg->euler, sizeof cfg->euler);
    memcpy(fresh.truth.nu, cfg->nu, sizeof cfg->nu);
    sim_rng_seed(&fresh.disturbance, cfg->seed, SIM_STREAM_DISTURBANCE);
    for (int i = 0; i < 6; ++i) { /* in its stationary distribution from the start */
        fresh.truth.disturbance[i] = disturbance_rms(cfg, i) * sim_rng_gauss(&fresh.disturbance);
    }
    complete_truth(&fresh);
    *sim = fresh;
    return true;
}

/* Exact solution of a first-order lag under a constant command over h: *x becomes its end value;
 * returns the mean over h, which is the constant force of the same impulse. */
static double lagged(double *x, double command, double lag_s, double h)
{
    if (lag_s <= 0.0) {
        *x = command;
        return command;
    }
    double gone = -expm1(-h / lag_s), before = *x;
    *x += gone * (command - before);
    return command + (before - command) * gone * lag_s / h;
}

/* One step of h seconds: thrusters, disturbance, motion. */
static void advance(sim_t *sim, const double thruster_N[SIM_THRUSTERS], const double direct[6],
                    double h)
{
    const sim_config_t *c = &sim->cfg;
    sim_truth_t *t = &sim->truth;
    double state[STATES], total[6], mean[SIM_THRUSTERS] = {0};
    double keep = exp(-h / c->disturbance_s), renew = sqrt(-expm1(-2.0 * h / c->disturbance_s));

    for (int j = 0; j < c->thrusters; ++j) {
        mean[j] = lagged(&t->thruster_N[j], thruster_N[j], c->lag_s, h);
    }
    for (int i = 0; i < 6; ++i) {
        total[i] = lagged(&sim->direct[i], direct[i], c->lag_s, h) + t->disturbance[i];
        t->wrench[i] = sim->direct[i];
        for (int j = 0; j < c->thrusters; ++j) {
            total[i] += c->thruster_matrix[i][j] * mean[j];
            t->wrench[i] += c->thruster_matrix[i][j] * t->thruster_N[j];
        }
    }
    memcpy(state + POSITION, t->position, sizeof t->position);
    memcpy(state + EULER, t->euler, sizeof t->euler);
    memcpy(state + NU, t->nu, sizeof t->nu);
    add_load(sim, total);
    sim_rk4(c, state, total, h);
    memcpy(t->position, state + POSITION, sizeof t->position);
    memcpy(t->euler, state + EULER, sizeof t->euler);
    memcpy(t->nu, state + NU, sizeof t->nu);
    /* Ornstein-Uhlenbeck, exact at steps of h. All six are drawn: no level changes the others. */
    for (int i = 0; i < 6; ++i) {
        t->disturbance[i] = keep * t->disturbance[i] +
                            renew * disturbance_rms(c, i) * sim_rng_gauss(&sim->disturbance);
    }
    complete_truth(sim);
}

/* Thruster commands: the given thrust and the stabilisation of roll and pitch, saturated. */
static void command(const sim_t *sim, const double *thruster_N, double commanded[SIM_THRUSTERS])
{
    const sim_config_t *c = &sim->cfg;
    const double *seen = sim->imu.value;
    double hold[6] = {0};
    for (int j = 0; thruster_N != NULL && j < c->thrusters; ++j) {
        commanded[j] = isfinite(thruster_N[j]) ? thruster_N[j] : 0.0;
    }
    if (c->hold_Nm_rad > 0.0 || c->hold_Nms_rad > 0.0) {
        for (int i = 0; i < 2; ++i) {
            hold[P + i] = -c->hold_Nm_rad * seen[i] - c->hold_Nms_rad * seen[3 + i];
        }
        (void)add_thrust(c, hold, commanded);
    }
    for (int j = 0; j < c->thrusters; ++j) {
        commanded[j] = fmax(-sim_thruster_limit(c, j, -1.0),
                            fmin(sim_thruster_limit(c, j, 1.0), commanded[j]));
    }
}

void sim_step(sim_t *sim, const double *thruster_N, const double wrench[6], sim_output_t *out)
{
    const sim_config_t *c = &sim->cfg;
    double commanded[SIM_THRUSTERS] = {0}, direct[6] = {0};
    memset(out, 0, sizeof *out);
    command(sim, thruster_N, commanded);
    if (wrench != NULL) {
        memcpy(direct, wrench, sizeof direct);
    }
    for (int i = 0; i < SIM_SUBSTEPS; ++i) {
        sim_truth_t before = sim->truth;
        advance(sim, commanded, direct, SIM_TICK_US * 1e-6 / SIM_SUBSTEPS);
        sim->truth.t_us = before.t_us + SIM_TICK_US / SIM_SUBSTEPS;
        sim_sensors_sample(sim, &before, &sim->truth);
    }
    out->t_us = sim->truth.t_us;
    for (int j = 0; j < c->thrusters; ++j) {
        out->thruster_N[j] = c->feedback_true ? sim->truth.thruster_N[j] : commanded[j];
    }
    for (int i = 0; i < 6; ++i) {
        out->wrench[i] = c->feedback_true ? sim->direct[i] : direct[i];
        for (int j = 0; j < c->thrusters; ++j) {
            out->wrench[i] += c->thruster_matrix[i][j] * out->thruster_N[j];
        }
    }
    sim_sensors_deliver(sim, out);
    sim->imu = out->sensor[SIM_IMU].has ? out->sensor[SIM_IMU] : sim->imu;
}
