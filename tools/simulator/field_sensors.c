/*
 * Sensors and clocks. A sample is measured at its time, between two substeps of the truth. Its
 * timestamp is late by the unreported delay, plus the error of the clock of the instruments. It
 * arrives in the tick in which this timestamp and the sample itself are in the past. Noise is drawn
 * for every sample, including lost ones, so that no mismatch changes the numbers of another.
 */
#include "field_parts.h"

#include <math.h>
#include <string.h>

#define IMU_ANGLE_RAD (0.2 * FIELD_DEGREE)
#define IMU_RATE_RAD_S (0.1 * FIELD_DEGREE)
#define DVL_M_S 0.007
#define DEPTH_M 0.015
#define OUTLIER_M_S 0.5
#define JUMP_M_S 0.1
#define CLOCK_JUMP_US 50000
/* Time constant with which a jump of the autopilot's velocity decays if the filter has no lag. */
#define JUMP_S 0.2

static void mount(double roll_deg, double pitch_deg, double yaw_deg, double r[3][3])
{
    double euler[3] = {roll_deg * FIELD_DEGREE, pitch_deg * FIELD_DEGREE, yaw_deg * FIELD_DEGREE};
    sim_rotation(euler, r);
}

void field_sensors_init(field_t *field)
{
    static const uint64_t period_us[SIM_SENSORS] = {
        [SIM_IMU] = 20000, [SIM_DVL] = 200000, [SIM_DEPTH] = 100000};
    const field_config_t *c = &field->cfg;
    const double *size = c->size;
    field_sensing_t *s = &field->sensing;
    sim_rng_t rng;
    memset(s, 0, sizeof *s);
    mount(size[FIELD_IMU_ROLL], size[FIELD_IMU_PITCH], size[FIELD_IMU_YAW], s->imu_mount);
    mount(size[FIELD_DVL_ROLL], size[FIELD_DVL_PITCH], size[FIELD_DVL_YAW], s->dvl_mount);
    sim_rng_seed(&rng, c->seed, FIELD_STREAM_GYRO);
    for (int i = 0; i < 3; ++i) {
        s->gyro_bias[i] = size[FIELD_GYRO_BIAS] * FIELD_DEGREE * sim_rng_gauss(&rng);
    }
    sim_rng_seed(&s->clock, c->seed, FIELD_STREAM_CLOCK);
    sim_rng_seed(&s->filter, c->seed, FIELD_STREAM_FILTER);
    for (uint64_t i = 0; i < SIM_SENSORS; ++i) {
        field_sensor_t *sensor = &s->sensor[i];
        sim_rng_seed(&sensor->noise, c->seed, FIELD_STREAM_SENSORS + 2 * i);
        sim_rng_seed(&sensor->loss, c->seed, FIELD_STREAM_SENSORS + 2 * i + 1);
        sensor->period_us = period_us[i];
        sensor->next_us = sensor->period_us;
    }
    s->sensor[SIM_DVL].late_us = (uint64_t)(1e6 * size[FIELD_DVL_LATENCY] + 0.5);
    /* The timestamps of the IMU remain those of the ticks. */
    field_sensor_t *imu = &s->sensor[SIM_IMU];
    imu->late_us = (uint64_t)(1e6 * size[FIELD_ATTITUDE_DELAY] + 0.5);
    imu->next_us -= imu->late_us % imu->period_us;
}

/* ---- measurements ---- */

typedef struct {
    double position[3], euler[3], nu[6], ground[3], r[3][3];
} moment_t;

static void between(const field_t *field, const field_truth_t *a, const field_truth_t *b,
                    double part, moment_t *at)
{
    const field_sensing_t *s = &field->sensing;
    double world[3];
    for (int i = 0; i < 3; ++i) {
        at->position[i] = a->position[i] + part * (b->position[i] - a->position[i]);
        at->euler[i] = a->euler[i] + part * (b->euler[i] - a->euler[i]);
        at->nu[i] = a->nu[i] + part * (b->nu[i] - a->nu[i]);
        at->nu[3 + i] = a->nu[3 + i] + part * (b->nu[3 + i] - a->nu[3 + i]);
    }
    sim_rotation(at->euler, at->r);
    if (field->cfg.size[FIELD_FILTER_TAU] > 0.0) {
        memcpy(world, s->velocity, sizeof world);
        field_rotate_back(at->r, world, at->ground);
    } else {
        field_rotate_back(at->r, field->hull.current, world);
        for (int i = 0; i < 3; ++i) {
            at->ground[i] = at->nu[i] + world[i];
        }
    }
    field_rotate_back(at->r, s->jump, world);
    for (int i = 0; i < 3; ++i) {
        at->ground[i] += world[i];
    }
}

static void measure_imu(const field_t *field, moment_t *at, sim_rng_t *noise, sim_measurement_t *m)
{
    double mounted[3][3], r[3][3] = {{0}}, rates[3];
    memcpy(mounted, field->sensing.imu_mount, sizeof mounted);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            for (int k = 0; k < 3; ++k) {
                r[i][j] += at->r[i][k] * mounted[k][j];
            }
        }
    }
    m->value[0] = atan2(r[2][1], r[2][2]);
    m->value[1] = -asin(fmax(-1.0, fmin(1.0, r[2][0])));
    m->value[2] = atan2(r[1][0], r[0][0]);
    field_rotate_back(mounted, at->nu + 3, rates);
    for (int i = 0; i < 3; ++i) {
        m->value[i] += IMU_ANGLE_RAD * sim_rng_gauss(noise);
        m->value[3 + i] = rates[i] + field->sensing.gyro_bias[i];
        m->value[3 + i] += IMU_RATE_RAD_S * sim_rng_gauss(noise);
    }
    m->value[2] = remainder(m->value[2], 2.0 * FIELD_PI);
}

static void measure_dvl(const field_t *field, moment_t *at, sim_rng_t *noise, sim_measurement_t *m)
{
    const double *size = field->cfg.size;
    const double arm[3] = {size[FIELD_DVL_ARM_X], size[FIELD_DVL_ARM_Y], size[FIELD_DVL_ARM_Z]};
    double r[3][3], v[3];
    memcpy(r, field->sensing.dvl_mount, sizeof r);
    field_cross(at->nu + 3, arm, v);
    for (int i = 0; i < 3; ++i) {
        v[i] += at->ground[i];
    }
    field_rotate_back(r, v, m->value);
    for (int i = 0; i < 3; ++i) {
        m->value[i] *= 1.0 + size[FIELD_DVL_SCALE];
        m->value[i] += DVL_M_S * sim_rng_gauss(noise);
    }
    m->value[3] = fmax(field->hull.seabed_m - at->position[2], 0.0);
    m->bottom = true;
}

static void measure_depth(const field_t *field, moment_t *at, sim_rng_t *noise,
                          sim_measurement_t *m)
{
    (void)field;
    m->value[0] = at->position[2] + DEPTH_M * sim_rng_gauss(noise);
}

/* Applies outliers and lost axes. Returns false if the sample is lost. */
static bool dvl_arrives(const field_t *field, sim_rng_t *loss, sim_measurement_t *m)
{
    const double *size = field->cfg.size;
    bool lost = sim_rng_uniform(loss) < size[FIELD_DVL_LOST];
    bool outlier = sim_rng_uniform(loss) < size[FIELD_DVL_OUTLIERS];
    bool partial = sim_rng_uniform(loss) < size[FIELD_DVL_PARTIAL];
    int which = 1 + (int)(6.0 * sim_rng_uniform(loss)); /* one or two of the three axes */
    m->axes = (uint8_t)(partial ? which : 7);
    for (int i = 0; i < 3; ++i) {
        double off = OUTLIER_M_S * sim_rng_gauss(loss);
        m->value[i] += outlier ? off : 0.0;
        m->value[i] = (m->axes >> i & 1) != 0 ? m->value[i] : 0.0;
    }
    return !lost;
}

/* ---- clocks, and the filter of the autopilot ---- */

/* Lag of the clock of the instruments at a time. */
static int64_t behind_us(const field_t *field, uint64_t t_us)
{
    double drift = 1e-6 * field->cfg.size[FIELD_CLOCK_DRIFT] * (double)t_us;
    return field->sensing.clock_us + (int64_t)floor(drift + 0.5);
}

static void move_filter(field_t *field, const field_truth_t *now, double h)
{
    const double *size = field->cfg.size;
    field_sensing_t *s = &field->sensing;
    double tau = size[FIELD_FILTER_TAU], r[3][3], world[3];
    if (sim_rng_uniform(&s->clock) < size[FIELD_CLOCK_JUMPS] * h / 60.0) {
        s->clock_us = s->clock_us == 0 ? CLOCK_JUMP_US : 0;
    }
    bool reset = sim_rng_uniform(&s->filter) < size[FIELD_FILTER_RESETS] * h / 60.0;
    if (tau <= 0.0 && size[FIELD_FILTER_RESETS] <= 0.0) {
        return;
    }
    sim_rotation(now->euler, r);
    field_rotate(r, now->nu, world);
    for (int i = 0; i < 3; ++i) {
        double to = world[i] + field->hull.current[i];
        s->velocity[i] = tau > 0.0 ? s->velocity[i] - expm1(-h / tau) * (to - s->velocity[i]) : to;
        s->jump[i] *= exp(-h / fmax(tau, JUMP_S));
        s->jump[i] += reset ? JUMP_M_S * sim_rng_gauss(&s->filter) : 0.0;
    }
}

/* ---- sampling ---- */

typedef void measure_t(const field_t *field, moment_t *at, sim_rng_t *noise, sim_measurement_t *m);

void field_sensors_sample(field_t *field, const field_truth_t *before, const field_truth_t *now,
                          double h)
{
    static measure_t *const measure[SIM_GPS] = {
        [SIM_IMU] = measure_imu, [SIM_DVL] = measure_dvl, [SIM_DEPTH] = measure_depth};
    uint64_t h_us = (uint64_t)(1e6 * h + 0.5);
    move_filter(field, now, h);
    for (int i = 0; i < SIM_GPS; ++i) { /* no GPS under water */
        field_sensor_t *s = &field->sensing.sensor[i];
        while (s->next_us <= field->t_us) {
            sim_measurement_t m = {.has = true};
            moment_t at;
            double part = 1.0 - (double)(field->t_us - s->next_us) / (double)h_us;
            between(field, before, now, part, &at);
            measure[i](field, &at, &s->noise, &m);
            int64_t behind = i == SIM_IMU ? 0 : behind_us(field, s->next_us);
            int64_t stamp = (int64_t)(s->next_us + s->late_us) - behind;
            m.t_us = stamp > 0 ? (uint64_t)stamp : 0;
            bool arrives = i != SIM_DVL || dvl_arrives(field, &s->loss, &m);
            if (arrives && s->count < SIM_QUEUE) {
                unsigned last = (s->head + s->count++) % SIM_QUEUE;
                uint64_t ready_us = s->next_us + s->late_us;
                s->queue[last] = m;
                s->arrival_us[last] = m.t_us > ready_us ? m.t_us : ready_us;
            }
            s->next_us += s->period_us;
        }
    }
}

void field_sensors_deliver(field_t *field, field_output_t *out)
{
    for (int i = 0; i < SIM_SENSORS; ++i) {
        field_sensor_t *s = &field->sensing.sensor[i];
        if (s->count > 0 && s->arrival_us[s->head] <= out->t_us) {
            out->sensor[i] = s->queue[s->head];
            s->head = (s->head + 1) % SIM_QUEUE;
            --s->count;
        }
    }
}
