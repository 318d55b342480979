/*
 * One evaluation of the cost on 240 rows of the residual path: the Girona500 as a model without
 * regressor, with sines as motion and wrench. For tests/firmware/bench.sh.
 */
#include "auvid/detail/metric.h"
#include "base/auvid_math_internal.h"
#include "machine.h"

enum { SETS = 8, ROWS = 30 };

static auvid_metric_t metric;
static auvid_row_t rows[(SETS + 1) * ROWS];

/* Forces of the Girona500 as a user's model without a regressor would compute them. */
static void residual(const void *context, const auvid_sample_t *s, const auvid_real_t *pi,
                     auvid_real_t out[AUVID_DOF_COUNT])
{
    (void)context;
    const auvid_real_t *nu = s->nu, *dot = s->nu_dot;
    const auvid_real_t u = nu[AUVID_SURGE], v = nu[AUVID_SWAY], w = nu[AUVID_HEAVE];
    const auvid_real_t p = nu[AUVID_ROLL], q = nu[AUVID_PITCH], r = nu[AUVID_YAW];
    const auvid_real_t m_u = pi[AUVID_G500_M_U], m_v = pi[AUVID_G500_M_V];
    const auvid_real_t m_w = pi[AUVID_G500_M_W];
    auvid_real_t st, ct, sf, cf;
    auvid_sincos(s->theta, &st, &ct);
    auvid_sincos(s->phi, &sf, &cf);
    out[AUVID_SURGE] = m_u * dot[AUVID_SURGE] + m_w * w * q - m_v * v * r +
                       pi[AUVID_G500_W_B] * st - pi[AUVID_G500_X_U] * u -
                       pi[AUVID_G500_X_UU] * u * auvid_abs(u) - s->tau[AUVID_SURGE];
    out[AUVID_SWAY] = m_v * dot[AUVID_SWAY] + m_u * u * r - m_w * w * p -
                      pi[AUVID_G500_W_B] * ct * sf - pi[AUVID_G500_Y_V] * v -
                      pi[AUVID_G500_Y_VV] * v * auvid_abs(v) - s->tau[AUVID_SWAY];
    out[AUVID_HEAVE] = m_w * dot[AUVID_HEAVE] - m_u * u * q + m_v * v * p -
                       pi[AUVID_G500_W_B] * ct * cf - pi[AUVID_G500_Z_W] * w -
                       pi[AUVID_G500_Z_WW] * w * auvid_abs(w) - s->tau[AUVID_HEAVE];
    out[AUVID_YAW] = pi[AUVID_G500_M_R] * dot[AUVID_YAW] + (m_v - m_u) * u * v -
                     pi[AUVID_G500_N_R] * r - pi[AUVID_G500_N_RR] * r * auvid_abs(r) -
                     s->tau[AUVID_YAW];
}

/* Slow motion and wrench; each channel has its own period. */
static void make_sample(uint32_t cell, auvid_sample_t *s)
{
    auvid_real_t t = AUVID_C(0.1) * (auvid_real_t)cell, cos_t;
    *s = (auvid_sample_t){.t_us = 100000u * (uint64_t)cell};
    auvid_sincos(t, &s->theta, &cos_t);
    s->theta *= AUVID_C(0.1);
    s->phi = AUVID_C(0.1) * cos_t;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t w = AUVID_C(0.2) + AUVID_C(0.1) * (auvid_real_t)j;
        auvid_sincos(w * t, &s->nu[j], &cos_t);
        s->nu_dot[j] = w * cos_t;
        s->tau[j] = 100 * cos_t;
    }
}

int main(void)
{
    auvid_vehicle_t vehicle = auvid_girona500;
    auvid_metric_config_t cfg;
    auvid_sample_t sample;
    vehicle.path = &auvid_path_residual;
    vehicle.regressor = NULL;
    vehicle.residual = residual;
    auvid_metric_defaults(&cfg, &vehicle);
    cfg.sets = SETS;
    cfg.set_rows = ROWS;
    cfg.rows = rows;
    cfg.row_slots = sizeof rows / sizeof rows[0];
    if (auvid_metric_init(&metric, &cfg) != AUVID_OK) {
        return 1;
    }
    for (uint32_t cell = 0; metric.sets.recorded < SETS; ++cell) {
        make_sample(cell, &sample);
        (void)auvid_metric_add(&metric, &sample);
    }
    uint32_t budget = UINT32_MAX, before;
    auvid_metric_merge_begin(&metric);
    if (auvid_metric_merge(&metric, &budget) != AUVID_OK) {
        return 2;
    }
    before = budget;
    auvid_metric_cost_begin(&metric, auvid_girona500_paper, 0);
    if (auvid_metric_cost(&metric, &budget) != AUVID_OK || before - budget != SETS * ROWS) {
        return 3;
    }
    return 0;
}
