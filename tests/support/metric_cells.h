/**
 * @file metric_cells.h
 * Shared by the tests of the metric: its configuration, and noise-free cells of a smooth motion,
 * with the wrench of known parameters. A test program includes it once.
 */
#ifndef METRIC_CELLS_H
#define METRIC_CELLS_H

#include <math.h>
#include <string.h>

#include "auvid/detail/metric.h"
#include "metric/auvid_metric_evaluator_internal.h"
#include "by_residual.h"
#include "unity.h"

#define PI 3.14159265358979323846
enum { N = AUVID_G500_COUNT, SETS = 8 };

static auvid_metric_t metric, before;
static auvid_metric_config_t cfg;
static auvid_real_t truth[AUVID_MAX_PARAMETERS];

/** For setUp. */
static inline void cells_defaults(void)
{
    memset(truth, 0, sizeof truth);
    memcpy(truth, auvid_girona500_paper, sizeof auvid_girona500_paper);
    auvid_metric_defaults(&cfg, &auvid_girona500);
    cfg.velocity_us = 0; /* these cells are exact */
}

typedef struct {
    double cell_s;
    double shift_s, lag_s; /* of the response after the command */
    double still[6];       /* 1: this velocity is zero */
    const auvid_real_t *pi;
} world_t;

static inline world_t world_of(const auvid_metric_config_t *c)
{
    return (world_t){.cell_s = c->cell_us * 1e-6, .pi = truth};
}

static inline double wave(int j, double t, double *rate)
{
    static const double a[6] = {0.4, 0.2, 0.15, 0.02, 0.03, 0.25};
    static const double f[6] = {0.050, 0.043, 0.061, 0.30, 0.25, 0.057};
    double w = 2 * PI * f[j];
    *rate = a[j] * w * (cos(w * t + j) + 1.38 * cos(2.3 * w * t + 1) - 0.164 * sin(0.41 * w * t));
    return a[j] * (sin(w * t + j) + 0.6 * sin(2.3 * w * t + 1) + 0.4 * cos(0.41 * w * t));
}

static inline void motion(const world_t *w, double t, auvid_sample_t *s)
{
    memset(s, 0, sizeof *s);
    s->phi = (auvid_real_t)(0.05 * sin(0.9 * t));
    s->theta = (auvid_real_t)(0.04 * cos(0.7 * t));
    for (int j = 0; j < 6; ++j) {
        double rate, value = wave(j, t, &rate);
        s->nu[j] = (auvid_real_t)(w->still[j] > 0 ? 0.0 : value);
        s->nu_dot[j] = (auvid_real_t)(w->still[j] > 0 ? 0.0 : rate);
    }
}

static inline void model_wrench(const world_t *w, double t, double *tau)
{
    auvid_sample_t s;
    auvid_regressor_t y;
    memset(&y, 0, sizeof y);
    motion(w, t, &s);
    auvid_girona500.regressor(auvid_girona500.context, &s, NULL, &y);
    for (int j = 0; j < 6; ++j) {
        tau[j] = 0;
        for (int i = 0; i < N; ++i) {
            tau[j] += (double)y.row[j][i] * (double)w->pi[i];
        }
    }
}

static inline auvid_sample_t cell_at(const world_t *w, double t)
{
    auvid_sample_t s;
    double now[6], later[6], earlier[6], h = 0.05;
    motion(w, t, &s);
    s.t_us = (uint64_t)llround(t * 1e6) + 1000000000u;
    model_wrench(w, t + w->shift_s, now);
    model_wrench(w, t + w->shift_s + h, later);
    model_wrench(w, t + w->shift_s - h, earlier);
    for (int j = 0; j < 6; ++j) {
        s.tau[j] = (auvid_real_t)(now[j] + w->lag_s * (later[j] - earlier[j]) / (2 * h));
    }
    return s;
}

/* Feed `cells` cells from t on. Returns the number of sets completed. */
static inline int feed(auvid_metric_t *m, const world_t *w, double t, int cells)
{
    int complete = 0;
    for (int k = 0; k < cells; ++k) {
        auvid_sample_t s = cell_at(w, t + k * w->cell_s);
        auvid_status_t status = auvid_metric_add(m, &s);
        TEST_ASSERT_TRUE(status == AUVID_OK || status == AUVID_SET_COMPLETE ||
                         status == AUVID_SET_IDLE);
        complete += status == AUVID_SET_COMPLETE;
    }
    return complete;
}

/* Number of cells until the first row is complete, and from row to row. */
static inline int first_row(const auvid_metric_config_t *c)
{
    int wide = c->half_width[0] > c->half_width[1] ? c->half_width[0] : c->half_width[1];
    int taps = c->vehicle->path == &auvid_path_residual ? c->row_cells : 2 * wide * c->passes + 1;
    return AUVID_METRIC_DELAY_CELLS * (AUVID_METRIC_DELAYS - 1) + taps;
}

static inline int cells_of(const auvid_metric_config_t *c, int rows)
{
    return first_row(c) + c->row_cells * (rows - 1);
}

static inline void start(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_init(&metric, &cfg));
}

static inline void merge_all(auvid_metric_t *m)
{
    uint32_t budget = UINT32_MAX;
    auvid_metric_merge_begin(m);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_merge(m, &budget));
}

static inline double cost_of(auvid_metric_t *m, const auvid_real_t *pi)
{
    uint32_t budget = UINT32_MAX;
    auvid_metric_cost_begin(m, pi, 0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_cost(m, &budget));
    return (double)m->result.cost;
}

/* float32: the condition of the rows is about 300, so 300 x 30 eps = 1e-3 of a parameter. */
static inline void assert_truth(const auvid_real_t *pi, uint32_t which)
{
    for (int i = 0; i < N; ++i) {
        if (which >> i & 1u) {
            double p = (double)truth[i];
            TEST_ASSERT_DOUBLE_WITHIN(1e-3 * fabs(p) + 0.02, p, (double)pi[i]);
        }
    }
}

static inline void assert_least_squares_find_truth(uint32_t which)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0};
    merge_all(&metric);
    TEST_ASSERT_EQUAL_HEX32(which, auvid_metric_active(&metric));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&metric, which, pi));
    assert_truth(pi, which);
}

static inline void assert_minimum_at_truth(auvid_metric_t *m, uint32_t which)
{
    double at_truth = cost_of(m, truth);
    for (int i = 0; i < N; ++i) {
        if (which >> i & 1u) {
            auvid_real_t pi[AUVID_MAX_PARAMETERS];
            memcpy(pi, truth, sizeof pi);
            double h = 0.1 * fabs((double)truth[i]);
            pi[i] = truth[i] + (auvid_real_t)h;
            double up = cost_of(m, pi);
            pi[i] = truth[i] - (auvid_real_t)h;
            double down = cost_of(m, pi);
            TEST_ASSERT_TRUE(up > 50 * at_truth && down > 50 * at_truth);
            double vertex = 0.5 * h * (down - up) / (up + down - 2 * at_truth);
            TEST_ASSERT_DOUBLE_WITHIN(2e-3 * fabs((double)truth[i]), 0, vertex);
        }
    }
}

static auvid_real_t sum_of_bits[64];

/* Compute all results of an evaluation in pieces of `piece` units. Returns the units used. */
static inline uint32_t evaluate_by(auvid_metric_t *m, uint32_t piece, auvid_real_t *out)
{
    uint32_t used = 0, budget, calls = 0;
    auvid_status_t status;
    auvid_real_t pi[AUVID_MAX_PARAMETERS];
    for (int i = 0; i < N; ++i) {
        pi[i] = truth[i] * AUVID_C(1.1);
    }
#define ALL(call)                                                                                  \
    do {                                                                                           \
        budget = piece;                                                                            \
        status = call;                                                                             \
        TEST_ASSERT_TRUE(budget <= piece);                                                         \
        TEST_ASSERT_TRUE(status == AUVID_OK || (status == AUVID_PENDING && budget == 0));          \
        used += piece - budget;                                                                    \
        TEST_ASSERT_TRUE(++calls < 200000);                                                        \
    } while (status == AUVID_PENDING)
    auvid_metric_merge_begin(m);
    ALL(auvid_metric_merge(m, &budget));
    auvid_metric_cost_begin(m, pi, AUVID_C(0.13));
    ALL(auvid_metric_cost(m, &budget));
    out[0] = m->result.cost;
    auvid_metric_measure_begin(m, pi, AUVID_C(0.13));
    ALL(auvid_metric_measure(m, &budget));
    memcpy(out + 1, m->result.sse, sizeof m->result.sse);
    memcpy(out + 7, m->result.delay_s, sizeof m->result.delay_s);
    out[13] = m->result.constant;
    auvid_metric_cost_begin(m, truth, 0);
    ALL(auvid_metric_cost(m, &budget));
    out[14] = m->result.cost;
    auvid_metric_scale(m, out + 15);
#undef ALL
    return used;
}

static inline void assert_budgets_do_not_matter(void)
{
    static const uint32_t piece[] = {1, 2, 3, 7, 64, 1000};
    before = metric; /* a merge starts with the band weights of the last one: make them the same */
    uint32_t used = evaluate_by(&metric, UINT32_MAX, sum_of_bits);
    for (size_t k = 0; k < sizeof piece / sizeof piece[0]; ++k) {
        auvid_real_t again[64] = {0};
        metric = before;
        TEST_ASSERT_EQUAL_UINT32(used, evaluate_by(&metric, piece[k], again));
        TEST_ASSERT_EQUAL_MEMORY(sum_of_bits, again, sizeof(auvid_real_t) * (15 + N));
    }
}

enum { ROWS = (SETS + 1) * 120, CANARY = 4 };
static auvid_row_t store[ROWS + 2 * CANARY];
static auvid_vehicle_t by_residual;

static inline void use_residual_path(int row_cells, int set_rows)
{
    by_residual = by_residual_girona500();
    cfg.vehicle = &by_residual;
    cfg.row_cells = (uint16_t)row_cells;
    cfg.set_rows = (uint16_t)set_rows;
    cfg.rows = store + CANARY;
    cfg.row_slots = ROWS;
    memset(store, 0xA5, sizeof store);
}

#endif
