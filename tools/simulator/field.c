/*
 * A tick: driver, thrusters, body by RK4 in four substeps of 5 ms, sensors. Forces of thrusters,
 * waves and noise are constant within a substep, with their values at its middle.
 */
#include "field_parts.h"

#include <math.h>
#include <string.h>

#define SUBSTEP_US (SIM_TICK_US / SIM_SUBSTEPS)
#define SUBSTEP_S (SIM_TICK_US * 1e-6 / SIM_SUBSTEPS)
#define COLOUR_S 2.0 /* correlation time of the noise */
#define SWELL 0.7    /* ratio of vertical to horizontal amplitude of the waves */

static double noise_rms(const field_t *field, int dof)
{
    return field->cfg.size[FIELD_DISTURBANCE] * (dof < 3 ? 1.0 : field->sheet.noise_arm_m);
}

static void init_disturbance(field_t *field)
{
    const field_config_t *c = &field->cfg;
    sim_rng_t rng;
    sim_rng_seed(&rng, c->seed, FIELD_STREAM_WAVES);
    double to = 2.0 * FIELD_PI * sim_rng_uniform(&rng), amplitude = c->size[FIELD_WAVES];
    field->wave[0] = amplitude * cos(to);
    field->wave[1] = amplitude * sin(to);
    field->wave[2] = amplitude * SWELL;
    field->wave_rad_s = 2.0 * FIELD_PI / (4.0 + 4.0 * sim_rng_uniform(&rng));
    field->wave_phase = 2.0 * FIELD_PI * sim_rng_uniform(&rng);
    sim_rng_seed(&field->disturbance, c->seed, FIELD_STREAM_DISTURBANCE);
    for (int i = 0; i < 6; ++i) { /* in its stationary distribution from the start */
        field->coloured[i] = noise_rms(field, i) * sim_rng_gauss(&field->disturbance);
    }
}

/* Waves and noise: orbits of the water, with horizontal and vertical a quarter period apart. */
static void disturb(const field_t *field, const double euler[3], double t_s, double force[6])
{
    double r[3][3], body[3] = {0};
    memcpy(force, field->coloured, sizeof field->coloured);
    if (field->cfg.size[FIELD_WAVES] > 0.0) {
        double at = field->wave_rad_s * t_s + field->wave_phase;
        double world[3] = {field->wave[0] * sin(at), field->wave[1] * sin(at),
                           field->wave[2] * cos(at)};
        sim_rotation(euler, r);
        field_rotate_back(r, world, body);
    }
    for (int i = 0; i < 3; ++i) {
        force[i] += body[i];
    }
}

static void rk4(const field_hull_t *hull, double state[12], const double external[6], double h)
{
    static const double at[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
    double k[12] = {0}, sum[12] = {0}, x[12];
    for (int stage = 0; stage < 4; ++stage) {
        for (int i = 0; i < 12; ++i) {
            x[i] = state[i] + at[stage] * h * k[i];
        }
        field_hull_derivative(hull, x, external, k);
        for (int i = 0; i < 12; ++i) {
            sum[i] += weight[stage] * k[i];
        }
    }
    for (int i = 0; i < 12; ++i) {
        state[i] += h / 6.0 * sum[i];
    }
}

static void load(const field_truth_t *t, double state[12])
{
    memcpy(state, t->position, sizeof t->position);
    memcpy(state + 3, t->euler, sizeof t->euler);
    memcpy(state + 6, t->nu, sizeof t->nu);
}

/* Computes forces and accelerations at the end of a tick. */
static void complete_truth(field_t *field)
{
    field_truth_t *t = &field->truth;
    double state[12], derivative[12];
    t->t_s = 1e-6 * (double)field->t_us;
    field_thrust_truth(field, t->delivered, t->reported);
    disturb(field, t->euler, t->t_s, t->disturbance);
    for (int i = 0; i < 6; ++i) {
        t->hull[i] = t->delivered[i] + t->disturbance[i];
    }
    load(t, state);
    field_hull_derivative(&field->hull, state, t->hull, derivative);
    memcpy(t->nu_dot, derivative + 6, sizeof t->nu_dot);
}

bool field_init(field_t *field, const field_config_t *cfg)
{
    if (!field_config_is_good(cfg)) {
        return false;
    }
    memset(field, 0, sizeof *field);
    field->cfg = *cfg;
    field_sheet(cfg->vehicle, cfg->seed, &field->sheet);
    field->truth.position[2] = FIELD_START_M;
    field_hull_init(field);
    field_thrust_init(field);
    field_sensors_init(field);
    field_pilot_init(field);
    init_disturbance(field);
    complete_truth(field);
    return true;
}

/* Advances by one substep. */
static void advance(field_t *field)
{
    const double h = SUBSTEP_S;
    const double keep = exp(-h / COLOUR_S), renew = sqrt(-expm1(-2.0 * h / COLOUR_S));
    field_truth_t *t = &field->truth;
    double state[12], external[6], disturbance[6];
    field_thrust_advance(field, h, external);
    disturb(field, t->euler, 1e-6 * (double)field->t_us + h / 2.0, disturbance);
    for (int i = 0; i < 6; ++i) {
        external[i] += disturbance[i];
    }
    load(t, state);
    rk4(&field->hull, state, external, h);
    memcpy(t->position, state, sizeof t->position);
    memcpy(t->euler, state + 3, sizeof t->euler);
    memcpy(t->nu, state + 6, sizeof t->nu);
    for (int i = 0; i < 6 && field->cfg.size[FIELD_DISTURBANCE] > 0.0; ++i) {
        field->coloured[i] = keep * field->coloured[i] +
                             renew * noise_rms(field, i) * sim_rng_gauss(&field->disturbance);
    }
    field->t_us += SUBSTEP_US;
}

void field_step(field_t *field, const double *thruster_N, field_output_t *out)
{
    const field_config_t *c = &field->cfg;
    double command_N[SIM_THRUSTERS] = {0};
    memset(out, 0, sizeof *out);
    field_pilot_drive(field, thruster_N, command_N);
    memcpy(out->reference, field->pilot.reference_nu, sizeof out->reference);
    field_thrust_command(field, command_N);
    if (!field->ballasted && 1e-6 * (double)field->t_us >= c->length_s / 2.0) {
        field->ballasted = true;
        field_hull_ballast(&field->hull, c->size[FIELD_BALLAST]);
    }
    field->hull.fouling = c->size[FIELD_FOULING] * field_part_of_run(field);
    for (int i = 0; i < SIM_SUBSTEPS; ++i) {
        field_truth_t before = field->truth;
        advance(field);
        field_sensors_sample(field, &before, &field->truth, SUBSTEP_S);
    }
    out->t_us = field->t_us;
    complete_truth(field);
    field_thrust_report(field, out);
    field_sensors_deliver(field, out);
    field_pilot_observe(field, out);
}

const field_truth_t *field_truth(const field_t *field)
{
    return &field->truth;
}
