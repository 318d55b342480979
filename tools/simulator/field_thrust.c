/*
 * From the command of a tick to the force. For each thruster, forces relative to f_max:
 *   command c, in effect after its delay
 *   ESC        PWM pulse of 1 us steps, dead zone d: |c| = s^2, s -> (400 s - d) / (400 - d)
 *   propeller  |f|^(1 + e), weaker backward, minus the dead band, times gain, sag and battery
 *   speed      n = sign(f) sqrt|f|: with limited slope, then first-order lag; force n |n|
 *   inflow     times 1 - a v, with v the speed of the water along the force; bilinear: less
 *              a v sqrt(f_max |f|), as of a propeller at speed n that loses b |n| v
 * The reported thrust is c, or the value of the pulse, or this times the voltage squared.
 *
 * Other shapes of the same sizes, which auvid's columns do not have (FIELD_THRUST_SHAPES):
 *   curve      a quadratic one, of the same rms deviation
 *   dead band  soft: f becomes f^2 / (f + d)
 *   backward   every third thruster is weaker forward instead
 *   sag        with the square root of time
 *   inflow     only where it weakens the thrust
 */
#include "field_parts.h"

#include <math.h>
#include <string.h>

/* Change of the pulse width from standstill to full speed. */
#define PULSE_US 400.0
/* Exponent of thrust over voltage at a given pulse, for T200 thrusters between 12 and 20 V. */
#define VOLTAGE_EXPONENT 1.2
/* Share of the voltage loss of a run that full load causes immediately. */
#define LOAD_SHARE 0.5

void field_thrust_init(field_t *field)
{
    const double *size = field->cfg.size;
    field_thrust_t *t = &field->thrust;
    sim_rng_t rng;
    memset(t, 0, sizeof *t);
    sim_rng_seed(&rng, field->cfg.seed, FIELD_STREAM_THRUSTERS);
    for (int j = 0; j < SIM_THRUSTERS; ++j) {
        double each = 1.0 + size[FIELD_THRUST_EACH] * sim_rng_gauss(&rng);
        t->gain[j] = fmax((1.0 + size[FIELD_THRUST_COMMON]) * each, 0.0);
    }
}

double field_part_of_run(const field_t *field)
{
    return fmin(1e-6 * (double)field->t_us / field->cfg.length_s, 1.0);
}

/* Voltage relative to the full battery, at a mean load 0..1. */
static double voltage(const field_t *field, double load)
{
    const double *size = field->cfg.size;
    double lost = fmax(size[FIELD_BATTERY], size[FIELD_BATTERY_CORRECTED]);
    return 1.0 - lost * (field_part_of_run(field) + LOAD_SHARE * load);
}

static double mean_load(const field_sheet_t *sheet, const double command_N[SIM_THRUSTERS])
{
    double sum = 0.0;
    for (int j = 0; j < sheet->thrusters; ++j) {
        sum += fabs(command_N[j]) / sheet->thruster_max_N;
    }
    return sum / sheet->thrusters;
}

/* Pulse width relative to standstill for a fraction of the largest force. */
static double pulse_us(double part)
{
    return copysign(floor(PULSE_US * sqrt(fabs(part)) + 0.5), part);
}

void field_thrust_command(field_t *field, double command_N[SIM_THRUSTERS])
{
    const field_sheet_t *sheet = &field->sheet;
    const double *size = field->cfg.size;
    field_thrust_t *t = &field->thrust;
    field_command_t *c = &t->ring[t->written++ % FIELD_RING];
    double f_max = sheet->thruster_max_N;
    memset(c, 0, sizeof *c);
    c->t_us = field->t_us;
    for (int j = 0; j < sheet->thrusters; ++j) {
        command_N[j] = fmax(-f_max, fmin(f_max, command_N[j]));
        c->command_N[j] = c->reported_N[j] = command_N[j];
        if (size[FIELD_COMMAND_PWM] > 0.0) {
            double s = pulse_us(command_N[j] / f_max) / PULSE_US;
            c->reported_N[j] = f_max * s * fabs(s);
        }
    }
    if (size[FIELD_BATTERY_CORRECTED] > 0.0) {
        double v = voltage(field, mean_load(sheet, command_N));
        for (int j = 0; j < sheet->thrusters; ++j) {
            c->reported_N[j] *= v * v;
        }
    }
}

static bool has_other_shapes(const field_t *field)
{
    return field->cfg.size[FIELD_THRUST_SHAPES] > 0.0;
}

/* Force of a propeller for this part of the largest one, 0..1, with curve and dead band [N]. */
static double propeller(const field_t *field, double part)
{
    const double *size = field->cfg.size;
    double f_max = field->sheet.thruster_max_N;
    double exponent = size[FIELD_THRUST_EXPONENT], dead = size[FIELD_THRUST_DEAD_BAND];
    if (has_other_shapes(field)) { /* p ln p and 1.49 p (p - 1): rms 0.272 */
        double force = f_max * part * fmax(1.0 - 1.49 * exponent * (1.0 - part), 0.0);
        return force > 0.0 ? force * force / (force + dead) : 0.0;
    }
    return fmax(f_max * pow(part, 1.0 + exponent) - dead, 0.0);
}

/* Steady force of thruster j under a command, in still water [N]. */
static double steady(const field_t *field, int j, double command_N, double by_voltage)
{
    const double *size = field->cfg.size;
    double part = command_N / field->sheet.thruster_max_N;
    double time = field_part_of_run(field), dead = size[FIELD_COMMAND_PWM];
    bool weak = part < 0.0;
    if (dead > 0.0) {
        double s = fmax(fabs(pulse_us(part)) - dead, 0.0) / (PULSE_US - dead);
        part = copysign(s * s, part);
    }
    if (has_other_shapes(field)) {
        weak = j % 3 == 2 ? part > 0.0 : weak;
        time = sqrt(time);
    }
    double force = propeller(field, fabs(part));
    force *= weak ? 1.0 - size[FIELD_THRUST_BACKWARD] : 1.0;
    force *= field->thrust.gain[j] * (1.0 - size[FIELD_THRUST_SAG] * time);
    return copysign(force * by_voltage, part);
}

/* A first-order lag. */
static double lagged(double x, double to, double lag_s, double h)
{
    return lag_s > 0.0 ? x - expm1(-h / lag_s) * (to - x) : to;
}

/* Finds the newest command in effect, to the nearest substep. */
static const field_command_t *find_acting(field_t *field, double h)
{
    field_thrust_t *t = &field->thrust;
    double early_s = fmax(-field->cfg.size[FIELD_THRUST_LATE], 0.0);
    double now = 1e-6 * (double)field->t_us + h / 2.0;
    while (t->acting < t->written &&
           1e-6 * (double)t->ring[t->acting % FIELD_RING].t_us + early_s <= now) {
        ++t->acting;
    }
    return t->acting > 0 ? &t->ring[(t->acting - 1) % FIELD_RING] : NULL;
}

/* Factor of the force by the speed of the water along it. */
static double inflow(const field_t *field, int j, double force)
{
    const field_sheet_t *sheet = &field->sheet;
    double along = 0.0;
    for (int i = 0; i < 6; ++i) {
        along += sheet->matrix[i][j] * field->truth.nu[i];
    }
    along = force < 0.0 ? -along : along;
    along = has_other_shapes(field) ? fmax(along, 0.0) : along;
    double loss = field->cfg.size[FIELD_THRUST_ADVANCE] * along;
    if (field->cfg.size[FIELD_THRUST_BILINEAR] > 0.0) {
        return force - copysign(1.0, force) * loss * sqrt(sheet->thruster_max_N * fabs(force));
    }
    return force * fmax(0.0, fmin(2.0, 1.0 - loss));
}

/* Advances a thruster by h seconds towards a steady force. */
static void follow(field_t *field, int j, double force, double h)
{
    const double *size = field->cfg.size;
    field_thrust_t *t = &field->thrust;
    if (size[FIELD_THRUST_LAG] > 0.0 || size[FIELD_SLEW] > 0.0) {
        double to = copysign(sqrt(fabs(force)), force);
        double limit = sqrt(field->sheet.thruster_max_N) * h / fmax(size[FIELD_SLEW], 1e-9);
        t->slewed[j] += fmax(-limit, fmin(limit, to - t->slewed[j]));
        t->speed[j] = lagged(t->speed[j], t->slewed[j], size[FIELD_THRUST_LAG], h);
        force = t->speed[j] * fabs(t->speed[j]);
    }
    t->force[j] = lagged(t->force[j], force, size[FIELD_THRUST_FORCE_LAG], h);
}

void field_thrust_advance(field_t *field, double h, double wrench[6])
{
    const field_sheet_t *sheet = &field->sheet;
    const double *size = field->cfg.size;
    field_thrust_t *t = &field->thrust;
    const field_command_t *c = find_acting(field, h);
    double by_voltage = 1.0;
    memset(wrench, 0, 6 * sizeof wrench[0]);
    if (c != NULL && (size[FIELD_BATTERY] > 0.0 || size[FIELD_BATTERY_CORRECTED] > 0.0)) {
        by_voltage = pow(voltage(field, mean_load(sheet, c->command_N)), VOLTAGE_EXPONENT);
    }
    for (int j = 0; j < sheet->thrusters; ++j) {
        double force = c != NULL ? steady(field, j, c->command_N[j], by_voltage) : 0.0;
        follow(field, j, force, h / 2.0);
        double middle = inflow(field, j, t->force[j]);
        follow(field, j, force, h / 2.0);
        for (int i = 0; i < 6; ++i) {
            wrench[i] += sheet->matrix[i][j] * middle;
        }
    }
}

void field_thrust_truth(const field_t *field, double delivered[6], double reported[6])
{
    const field_sheet_t *sheet = &field->sheet;
    const field_thrust_t *t = &field->thrust;
    memset(delivered, 0, 6 * sizeof delivered[0]);
    memset(reported, 0, 6 * sizeof reported[0]);
    for (int j = 0; j < sheet->thrusters; ++j) {
        double acts = inflow(field, j, t->force[j]);
        double said = t->acting > 0 ? t->ring[(t->acting - 1) % FIELD_RING].reported_N[j] : 0.0;
        for (int i = 0; i < 6; ++i) {
            delivered[i] += sheet->matrix[i][j] * acts;
            reported[i] += sheet->matrix[i][j] * said;
        }
    }
}

void field_thrust_report(field_t *field, field_output_t *out)
{
    const field_sheet_t *sheet = &field->sheet;
    const double *size = field->cfg.size;
    field_thrust_t *t = &field->thrust;
    uint64_t late_us = (uint64_t)(1e6 * fmax(size[FIELD_THRUST_LATE], 0.0) + 0.5);
    if (t->reported == t->written ||
        t->ring[t->reported % FIELD_RING].t_us + late_us >= out->t_us) {
        return;
    }
    const field_command_t *c = &t->ring[t->reported % FIELD_RING];
    out->reported = fabs(size[FIELD_COMMAND_10HZ]) <= 0.0 || t->reported % 5 == 0;
    ++t->reported;
    if (out->reported) {
        out->reported_us = c->t_us + late_us;
        memcpy(out->thruster_N, c->reported_N, sizeof out->thruster_N);
        for (int j = 0; j < sheet->thrusters; ++j) {
            for (int i = 0; i < 6; ++i) {
                out->wrench[i] += sheet->matrix[i][j] * c->reported_N[j];
            }
        }
    }
}
