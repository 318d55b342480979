/*
 * Vehicle models: compares the functions and masks of a model with each other, at random samples.
 */
#include <string.h>

#include "auvid/vehicle.h"
#include "../base/auvid_math_internal.h"

enum { SAMPLES = 100, SEED = 1 };

/* A sample, parameters, and what the model predicts for them. */
typedef struct {
    const auvid_vehicle_t *vehicle;
    auvid_vehicle_fault_t *fault;
    auvid_real_t tolerance;
    auvid_real_t scale[AUVID_DOF_COUNT]; /* largest predicted wrench */
    auvid_rng_t rng;
    auvid_sample_t sample;
    auvid_real_t pi[AUVID_MAX_PARAMETERS];
    auvid_real_t residual[AUVID_DOF_COUNT];
} model_test_t;

static auvid_real_t selftest_draw(model_test_t *t, auvid_real_t largest)
{
    return largest * (AUVID_C(2.0) * auvid_rng_uniform(&t->rng) - AUVID_C(1.0));
}

/* Draw a sample with a wrench of the predicted size, and parameters of half to one and a half times
 * pi (0..0.1 for those that are zero). */
static void selftest_draw_sample(model_test_t *t, const auvid_real_t *pi, uint64_t t_us)
{
    auvid_sample_t *s = &t->sample;
    memset(s, 0, sizeof *s);
    s->t_us = t_us;
    s->phi = selftest_draw(t, AUVID_C(0.5));
    s->theta = selftest_draw(t, AUVID_C(0.5));
    s->psi = selftest_draw(t, AUVID_C(3.0));
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        s->nu[j] = selftest_draw(t, AUVID_C(1.0));
        s->nu_dot[j] = t->vehicle->columns[j] != 0 ? selftest_draw(t, AUVID_C(0.5)) : AUVID_C(0.0);
        s->tau[j] = selftest_draw(t, t->scale[j]);
    }
    for (int i = 0; i < AUVID_MAX_COMMANDS; ++i) {
        s->command[i] = selftest_draw(t, AUVID_C(1.0));
    }
    for (int i = 0; i < t->vehicle->parameters; ++i) {
        auvid_real_t u = auvid_rng_uniform(&t->rng);
        t->pi[i] = auvid_is_zero(pi[i]) ? AUVID_C(0.1) * u : pi[i] * (AUVID_C(0.5) + u);
    }
    auvid_vehicle_residual(t->vehicle, s, t->pi, t->residual);
}

static bool selftest_agrees(const model_test_t *t, int j, auvid_real_t value, auvid_real_t expected)
{
    return auvid_abs(value - expected) <= t->tolerance * t->scale[j];
}

/* Report a fault. @return false */
static bool selftest_report(const model_test_t *t, const char *what, int dof, int parameter,
                            auvid_real_t value, auvid_real_t expected)
{
    if (t->fault != NULL) {
        *t->fault = (auvid_vehicle_fault_t){.what = what,
                                            .dof = (int8_t)dof,
                                            .parameter = (int8_t)parameter,
                                            .value = value,
                                            .expected = expected};
    }
    return false;
}

static bool selftest_is_linear(const auvid_vehicle_t *vehicle)
{
    return vehicle->path == &auvid_path_regressor;
}

/* The rows are zero outside `columns`, and do not depend on the wrench. */
static bool selftest_check_regressor(model_test_t *t)
{
    const auvid_vehicle_t *v = t->vehicle;
    auvid_regressor_t y, other;
    auvid_sample_t idle = t->sample;
    memset(&y, 0, sizeof y);
    memset(&other, 0, sizeof other);
    memset(idle.tau, 0, sizeof idle.tau);
    const auvid_real_t *pi = selftest_is_linear(v) ? NULL : t->pi;
    v->regressor(v->context, &t->sample, pi, &y);
    v->regressor(v->context, &idle, pi, &other);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        for (int i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
            auvid_real_t x = y.row[j][i];
            if (!(v->columns[j] >> i & 1u) && !auvid_is_zero(x)) {
                return selftest_report(t, "columns", j, i, x, AUVID_C(0.0));
            }
            if (!auvid_is_zero(x - other.row[j][i])) {
                return selftest_report(t, "regressor", j, i, x, other.row[j][i]);
            }
        }
    }
    return true;
}

/* The residual by the rows, whether or not the model has a residual beside them. */
static void selftest_residual_of_rows(const model_test_t *t, const auvid_real_t *pi,
                                      auvid_real_t *residual)
{
    auvid_vehicle_t rows = *t->vehicle;
    rows.residual = NULL;
    auvid_vehicle_residual(&rows, &t->sample, pi, residual);
}

/* Find the parameter by whose change residual and row of DoF j differ most; -1: none does. */
static int selftest_find_parameter(const model_test_t *t, int j)
{
    auvid_real_t e[AUVID_DOF_COUNT], r[2][AUVID_DOF_COUNT], pi[AUVID_MAX_PARAMETERS];
    auvid_real_t largest = t->tolerance * t->scale[j];
    int found = -1;
    memcpy(pi, t->pi, sizeof pi);
    selftest_residual_of_rows(t, pi, r[0]);
    for (int i = 0; i < t->vehicle->parameters; ++i) {
        pi[i] *= AUVID_C(2.0);
        auvid_vehicle_residual(t->vehicle, &t->sample, pi, e);
        selftest_residual_of_rows(t, pi, r[1]);
        auvid_real_t difference = auvid_abs((e[j] - t->residual[j]) - (r[1][j] - r[0][j]));
        found = difference > largest ? i : found;
        largest = auvid_max(largest, difference);
        pi[i] = t->pi[i];
    }
    return found;
}

/* A residual beside the rows of the regressor path agrees with them. */
static bool selftest_check_residual(model_test_t *t)
{
    auvid_real_t r[AUVID_DOF_COUNT];
    selftest_residual_of_rows(t, t->pi, r);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (!selftest_agrees(t, j, t->residual[j], r[j])) {
            return selftest_report(t, "residual", j, selftest_find_parameter(t, j), t->residual[j],
                                   r[j]);
        }
    }
    return true;
}

/* A parameter changes only the equations in whose columns it is. */
static bool selftest_check_columns(model_test_t *t)
{
    auvid_real_t e[AUVID_DOF_COUNT];
    for (int i = 0; i < t->vehicle->parameters; ++i) {
        auvid_real_t pi = t->pi[i];
        t->pi[i] = AUVID_C(1.1) * pi;
        auvid_vehicle_residual(t->vehicle, &t->sample, t->pi, e);
        t->pi[i] = pi;
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            bool may = (t->vehicle->columns[j] >> i & 1u) != 0;
            if (!may && !auvid_is_zero(e[j] - t->residual[j])) {
                return selftest_report(t, "columns", j, i, e[j], t->residual[j]);
            }
        }
    }
    return true;
}

/* The residual is the predicted wrench minus the applied one, except with the model's own thrust.
 */
static bool selftest_check_wrench(model_test_t *t)
{
    auvid_sample_t idle = t->sample;
    auvid_real_t e[AUVID_DOF_COUNT];
    memset(idle.tau, 0, sizeof idle.tau);
    auvid_vehicle_residual(t->vehicle, &idle, t->pi, e);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        bool takes = t->vehicle->columns[j] != 0 && !t->vehicle->own_thrust;
        auvid_real_t expected = e[j] - (takes ? t->sample.tau[j] : AUVID_C(0.0));
        if (!selftest_agrees(t, j, t->residual[j], expected)) {
            return selftest_report(t, "wrench", j, -1, t->residual[j], expected);
        }
    }
    return true;
}

/* The equation of DoF j does not depend on velocities that `reads` leaves out. */
static bool selftest_check_reads(model_test_t *t)
{
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_sample_t moved = t->sample;
        auvid_real_t e[AUVID_DOF_COUNT];
        for (int k = 0; k < AUVID_DOF_COUNT; ++k) {
            bool read = t->vehicle->reads[j] == 0 || (t->vehicle->reads[j] >> k & 1u) != 0;
            moved.nu[k] += read ? AUVID_C(0.0) : AUVID_C(0.3);
            moved.nu_dot[k] += read ? AUVID_C(0.0) : AUVID_C(0.3);
        }
        auvid_vehicle_residual(t->vehicle, &moved, t->pi, e);
        if (!selftest_agrees(t, j, e[j], t->residual[j])) {
            return selftest_report(t, "reads", j, -1, e[j], t->residual[j]);
        }
    }
    return true;
}

/* With the acceleration of the model the residual is zero. The wrench is that of the drawn
 * acceleration, so that it stays moderate. */
static bool selftest_check_acceleration(model_test_t *t)
{
    const auvid_vehicle_t *v = t->vehicle;
    auvid_sample_t moving = t->sample;
    auvid_real_t e[AUVID_DOF_COUNT];
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        moving.tau[j] += t->residual[j];
    }
    auvid_sample_t given = moving;
    memset(moving.nu_dot, 0, sizeof moving.nu_dot);
    if (!v->acceleration(v->context, &given, t->pi, moving.nu_dot)) {
        return selftest_report(t, "acceleration", -1, -1, AUVID_C(0.0), AUVID_C(0.0));
    }
    auvid_vehicle_residual(v, &moving, t->pi, e);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (v->columns[j] != 0 && !selftest_agrees(t, j, e[j], AUVID_C(0.0))) {
            return selftest_report(t, "acceleration", j, -1, e[j], AUVID_C(0.0));
        }
    }
    return true;
}

/* Check everything that the model has at one sample. */
static bool selftest_check_sample(model_test_t *t)
{
    const auvid_vehicle_t *v = t->vehicle;
    return (v->regressor == NULL || selftest_check_regressor(t)) &&
           (!selftest_is_linear(v) || v->regressor == NULL || v->residual == NULL ||
            selftest_check_residual(t)) &&
           selftest_check_columns(t) && selftest_check_wrench(t) && selftest_check_reads(t) &&
           (v->acceleration == NULL || selftest_check_acceleration(t));
}

auvid_status_t auvid_vehicle_selftest(const auvid_vehicle_t *vehicle, const auvid_real_t *pi,
                                      uint64_t t_us, auvid_real_t tolerance,
                                      auvid_vehicle_fault_t *fault)
{
    model_test_t t;
    auvid_real_t scale[AUVID_DOF_COUNT] = {0};
    memset(&t, 0, sizeof t);
    t.vehicle = vehicle;
    t.fault = fault;
    t.tolerance = tolerance > AUVID_C(0.0) ? tolerance : AUVID_C(1e-4);
    if (fault != NULL) {
        memset(fault, 0, sizeof *fault);
    }
    auvid_status_t status = pi == NULL ? AUVID_ERR_NULL : auvid_vehicle_check(vehicle);
    if (status < 0) {
        return status;
    }
    if (!auvid_all_finite(pi, vehicle->parameters) || !auvid_is_finite(tolerance)) {
        return AUVID_ERR_NOT_FINITE;
    }
    auvid_rng_seed(&t.rng, SEED);
    for (int k = 0; k < SAMPLES; ++k) { /* t.scale is zero, so no wrench is applied */
        selftest_draw_sample(&t, pi, t_us);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            if (!auvid_is_finite(t.residual[j])) {
                (void)selftest_report(&t, "not finite", j, -1, t.residual[j], AUVID_C(0.0));
                return AUVID_ERR_MODEL;
            }
            scale[j] = auvid_max(scale[j], auvid_abs(t.residual[j]));
        }
    }
    memcpy(t.scale, scale, sizeof scale);
    for (int k = 0; k < SAMPLES; ++k) {
        selftest_draw_sample(&t, pi, t_us);
        if (!selftest_check_sample(&t)) {
            return AUVID_ERR_MODEL;
        }
    }
    return AUVID_OK;
}
