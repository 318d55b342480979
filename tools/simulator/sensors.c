/*
 * The sensors. Each sample is taken at its own time, between two steps of the truth, and waits in a
 * queue until its arrival. Noise is drawn for every sample, even if lost or blind, so that no
 * setting changes the numbers of another.
 */
#include <math.h>
#include <string.h>

#include "simulator.h"

#define PI 3.14159265358979323846

#define POSITION(name, input, event, kind, axis, axes, config, noise_mm, surface, start)           \
    SIM_IF_##kind([SIM_##name] = {axis, axes, surface, noise_mm / 1000.0,                          \
                                  offsetof(sim_config_t, config##_m)}, )
const sim_position_t sim_positions[SIM_SENSORS] = {AUVID_SENSORS(POSITION)};
enum { NOISE_AND_ARM = 4 };

static bool position_is_good(const sim_config_t *c, const sim_position_t *p)
{
    double own[NOISE_AND_ARM];
    memcpy(own, (const char *)c + p->at, sizeof own);
    return own[0] >= 0.0 && isfinite(own[0] + own[1] + own[2] + own[3]);
}

bool sim_sensors_init(sim_t *sim)
{
    const sim_config_t *cfg = &sim->cfg;
    if (!(cfg->dvl_partial >= 0.0 && cfg->dvl_partial <= 0.9) ||
        !(cfg->dvl_partial_run >= 1.0 && cfg->dvl_partial_run < 1e6)) {
        return false;
    }
    for (int i = 0; i < SIM_SENSORS; ++i) {
        const sim_sensor_config_t *c = &sim->cfg.sensor[i];
        sim_sensor_t *s = &sim->sensor[i];
        if (!(c->rate_hz >= 0.0 && c->rate_hz <= 50.0) ||
            !(c->phase_s >= 0.0 && c->phase_s < 1e6) ||
            !(c->age_s >= 0.0 && c->age_s * c->rate_hz < SIM_QUEUE - 1) ||
            !(c->dropout >= 0.0 && c->dropout <= 1.0) || c->age_s > 1e6 ||
            (sim_positions[i].axes > 0 && !position_is_good(cfg, &sim_positions[i])) ||
            (c->rate_hz > 0.0 && c->rate_hz < 1e-3)) {
            return false;
        }
        sim_rng_seed(&s->noise, sim->cfg.seed, SIM_STREAM(i));
        sim_rng_seed(&s->loss, sim->cfg.seed, SIM_STREAM(i) + 1);
        s->period_us = c->rate_hz > 0.0 ? (uint64_t)(1e6 / c->rate_hz + 0.5) : 0;
        s->age_us = (uint64_t)(c->age_s * 1e6 + 0.5);
        s->next_us = c->phase_s > 0.0 ? (uint64_t)(c->phase_s * 1e6 + 0.5) : s->period_us;
    }
    return true;
}

/* The truth for a sensor, at a time between two steps. */
typedef struct {
    double position[3], euler[3], nu[6], ground[3];
} moment_t;

static void between(double *x, const double *a, const double *b, double part, int n)
{
    for (int i = 0; i < n; ++i) {
        x[i] = a[i] + part * (b[i] - a[i]);
    }
}

static bool is_aligned(const double euler[3])
{
    return fabs(euler[0]) + fabs(euler[1]) + fabs(euler[2]) <= 0.0;
}

/* From the body's axes to those of an instrument, v = R(euler)' v. */
static void to_instrument(const double euler[3], double v[3])
{
    double r[3][3], in[3];
    if (is_aligned(euler)) {
        return;
    }
    memcpy(in, v, sizeof in);
    sim_rotation(euler, r);
    for (int i = 0; i < 3; ++i) {
        v[i] = r[0][i] * in[0] + r[1][i] * in[1] + r[2][i] * in[2];
    }
}

/* Attitude and rates of the IMU's frame: its rotation is R(body) R(mount). */
static void of_imu(const double mount[3], moment_t *at)
{
    double body[3][3], own[3][3], r[3][3] = {{0}};
    if (is_aligned(mount)) {
        return;
    }
    sim_rotation(at->euler, body);
    sim_rotation(mount, own);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            r[i][j] = body[i][0] * own[0][j] + body[i][1] * own[1][j] + body[i][2] * own[2][j];
        }
    }
    at->euler[0] = atan2(r[2][1], r[2][2]);
    at->euler[1] = -asin(fmax(-1.0, fmin(1.0, r[2][0])));
    at->euler[2] = atan2(r[1][0], r[0][0]);
    to_instrument(mount, at->nu + 3);
}

static void imu(const sim_config_t *c, const moment_t *body, sim_rng_t *noise, sim_measurement_t *m)
{
    moment_t own = *body, *at = &own;
    of_imu(c->imu_euler, &own);
    for (int i = 0; i < 3; ++i) {
        m->value[i] = at->euler[i] + c->imu_angle_rad * sim_rng_gauss(noise);
        m->value[3 + i] = at->nu[3 + i] + c->imu_rate_rad_s * sim_rng_gauss(noise);
    }
    m->value[2] = remainder(m->value[2], 2.0 * PI);
}

/* v = Rz(yaw)' (velocity of the origin + omega x arm), over ground or through the water. */
static void dvl(const sim_config_t *c, const moment_t *at, sim_rng_t *noise, sim_measurement_t *m)
{
    const double *a = c->dvl_arm_m, *w = at->nu + 3;
    double altitude = c->seabed_m - at->position[2];
    double cy = cos(c->dvl_yaw_rad), sy = sin(c->dvl_yaw_rad), v[3];
    m->bottom = c->dvl_lock == SIM_LOCK_BOTTOM ||
                (c->dvl_lock == SIM_LOCK_ALTITUDE && altitude <= c->dvl_range_m);
    memcpy(v, m->bottom ? at->ground : at->nu, sizeof v);
    v[0] += w[1] * a[2] - w[2] * a[1];
    v[1] += w[2] * a[0] - w[0] * a[2];
    v[2] += w[0] * a[1] - w[1] * a[0];
    to_instrument(c->dvl_euler, v);
    m->value[0] = cy * v[0] + sy * v[1];
    m->value[1] = cy * v[1] - sy * v[0];
    m->value[2] = v[2];
    m->value[3] = m->bottom ? altitude : 0.0;
    for (int i = 0; i < 3; ++i) {
        m->value[i] += c->dvl_m_s * sim_rng_gauss(noise);
    }
}

/* A run of partial samples starts after a complete sample, with the probability of the right
 * share. It ends after each of its samples with probability one over its mean length. */
static void lose_axes(const sim_config_t *c, sim_sensor_t *s, sim_measurement_t *m)
{
    double begins = c->dvl_partial / (1.0 - c->dvl_partial) / c->dvl_partial_run;
    if (c->dvl_partial > 0.0) {
        if (s->axes != 0 && sim_rng_uniform(&s->loss) * c->dvl_partial_run < 1.0) {
            s->axes = 0;
        } else if (s->axes == 0 && sim_rng_uniform(&s->loss) < begins) {
            s->axes = (uint8_t)(1 + (int)(6.0 * sim_rng_uniform(&s->loss)));
        }
    }
    m->axes = s->axes == 0 ? 7 : s->axes;
    for (int i = 0; i < 3; ++i) {
        m->value[i] = (m->axes >> i & 1) != 0 ? m->value[i] : 0.0;
    }
}

static void position(const sim_config_t *c, const sim_position_t *p, const moment_t *at,
                     sim_rng_t *noise, sim_measurement_t *m)
{
    double r[3][3], own[NOISE_AND_ARM];
    memcpy(own, (const char *)c + p->at, sizeof own);
    sim_rotation(at->euler, r);
    for (int i = 0; i < p->axes; ++i) {
        const double *row = r[p->axis + i];
        m->value[i] = at->position[p->axis + i] + row[0] * own[1] + row[1] * own[2] +
                      row[2] * own[3] + own[0] * sim_rng_gauss(noise);
    }
    m->has = !p->surface || at->position[2] <= c->surface_m;
}

static void measure(const sim_config_t *c, int sensor, const moment_t *at, sim_rng_t *noise,
                    sim_measurement_t *m)
{
    if (sensor == SIM_IMU) {
        imu(c, at, noise, m);
    } else if (sensor == SIM_DVL) {
        dvl(c, at, noise, m);
    } else {
        position(c, &sim_positions[sensor], at, noise, m);
    }
}

void sim_sensors_sample(sim_t *sim, const sim_truth_t *before, const sim_truth_t *now)
{
    for (int i = 0; i < SIM_SENSORS; ++i) {
        sim_sensor_t *s = &sim->sensor[i];
        while (s->period_us > 0 && s->next_us <= now->t_us) {
            sim_measurement_t m = {.has = true, .t_us = s->next_us};
            moment_t at = {.position = {0}};
            double part = (double)(s->next_us - before->t_us) / (double)(now->t_us - before->t_us);
            between(at.position, before->position, now->position, part, 3);
            between(at.euler, before->euler, now->euler, part, 3);
            between(at.nu, before->nu, now->nu, part, 6);
            between(at.ground, before->ground, now->ground, part, 3);
            measure(&sim->cfg, i, &at, &s->noise, &m);
            bool lost = sim_rng_uniform(&s->loss) < sim->cfg.sensor[i].dropout;
            if (i == SIM_DVL) {
                lose_axes(&sim->cfg, s, &m);
            }
            if (m.has && !lost && s->count < SIM_QUEUE) {
                s->queue[(s->head + s->count++) % SIM_QUEUE] = m;
            }
            s->next_us += s->period_us;
        }
    }
}

/* At most one sample per sensor is due in a tick: no sensor is faster than the tick. */
void sim_sensors_deliver(sim_t *sim, sim_output_t *out)
{
    for (int i = 0; i < SIM_SENSORS; ++i) {
        sim_sensor_t *s = &sim->sensor[i];
        if (s->count > 0 && s->queue[s->head].t_us + s->age_us <= out->t_us) {
            out->sensor[i] = s->queue[s->head];
            s->head = (s->head + 1) % SIM_QUEUE;
            --s->count;
        }
    }
}
