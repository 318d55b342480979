/*
 * The metric through its header: synthetic cells without noise, made of known parameters, so that
 * every smoother must give the parameters back. Numbers against an independent pipeline:
 * tests/reference/test_metric.cpp.
 */
#include <math.h>
#include <string.h>

#include "auvid/metric.h"
#include "auvid_metric.h"
#include "unity.h"

#define PI 3.14159265358979323846
enum { N = AUVID_G500_COUNT, SETS = 8 };

static auvid_metric_t metric, before;
static auvid_metric_config_t cfg;
static auvid_real_t truth[AUVID_MAX_PARAMETERS];

void setUp(void)
{
    memset(truth, 0, sizeof truth);
    memcpy(truth, auvid_girona500_paper, sizeof auvid_girona500_paper);
    auvid_metric_defaults(&cfg, &auvid_girona500);
    cfg.velocity_us = 0; /* these cells are exact */
}

void tearDown(void)
{
}

/* ---- the world ---- */

typedef struct {
    double cell_s;
    double shift_s, lag_s; /* of the response after the command */
    double still[6];       /* 1: this velocity is zero */
    const auvid_real_t *pi;
} world_t;

static world_t world_of(const auvid_metric_config_t *c)
{
    return (world_t){.cell_s = c->cell_us * 1e-6, .pi = truth};
}

static double wave(int j, double t, double *rate)
{
    static const double a[6] = {0.4, 0.2, 0.15, 0.02, 0.03, 0.25};
    static const double f[6] = {0.050, 0.043, 0.061, 0.30, 0.25, 0.057};
    double w = 2 * PI * f[j];
    *rate = a[j] * w * (cos(w * t + j) + 1.38 * cos(2.3 * w * t + 1) - 0.164 * sin(0.41 * w * t));
    return a[j] * (sin(w * t + j) + 0.6 * sin(2.3 * w * t + 1) + 0.4 * cos(0.41 * w * t));
}

static void motion(const world_t *w, double t, auvid_sample_t *s)
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

static void model_wrench(const world_t *w, double t, double *tau)
{
    auvid_sample_t s;
    auvid_regressor_t y;
    memset(&y, 0, sizeof y);
    motion(w, t, &s);
    auvid_girona500.regressor(auvid_girona500.context, &s, &y);
    for (int j = 0; j < 6; ++j) {
        tau[j] = 0;
        for (int i = 0; i < N; ++i) {
            tau[j] += (double)y.row[j][i] * (double)w->pi[i];
        }
    }
}

static auvid_sample_t cell_at(const world_t *w, double t)
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

/* Feed `cells` cells from t on; returns how many sets became complete. */
static int feed(auvid_metric_t *m, const world_t *w, double t, int cells)
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

/* Cells until the first row is complete, and from row to row. */
static int first_row(const auvid_metric_config_t *c)
{
    int wide = c->half_width[0] > c->half_width[1] ? c->half_width[0] : c->half_width[1];
    int taps = c->vehicle->regressor == NULL ? c->row_cells : 2 * wide * c->passes + 1;
    return AUVID_METRIC_DELAY_CELLS * (AUVID_METRIC_DELAYS - 1) + taps;
}

static int cells_of(const auvid_metric_config_t *c, int rows)
{
    return first_row(c) + c->row_cells * (rows - 1);
}

static void start(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_init(&metric, &cfg));
}

static void merge_all(auvid_metric_t *m)
{
    uint32_t budget = UINT32_MAX;
    auvid_metric_merge_begin(m);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_merge(m, &budget));
}

static double cost_of(auvid_metric_t *m, const auvid_real_t *pi)
{
    uint32_t budget = UINT32_MAX;
    auvid_metric_cost_begin(m, pi, 0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_cost(m, &budget));
    return (double)m->cost;
}

/* float32: condition of the rows some 300, so 300 x 30 eps = 1e-3 of a parameter. */
static void assert_truth(const auvid_real_t *pi, uint32_t which)
{
    for (int i = 0; i < N; ++i) {
        if (which >> i & 1u) {
            double p = (double)truth[i];
            TEST_ASSERT_DOUBLE_WITHIN(1e-3 * fabs(p) + 0.02, p, (double)pi[i]);
        }
    }
}

static void assert_least_squares_find_truth(uint32_t which)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0};
    merge_all(&metric);
    TEST_ASSERT_EQUAL_HEX32(which, auvid_metric_active(&metric));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&metric, which, pi));
    assert_truth(pi, which);
}

/* ---- parameters come back ---- */

static void test_least_squares_give_the_parameters_of_noise_free_cells_back(void)
{
    start();
    world_t w = world_of(&cfg);
    TEST_ASSERT_EQUAL(2, feed(&metric, &w, 0, cells_of(&cfg, 120)));
    assert_least_squares_find_truth(AUVID_G500_FREE);
    TEST_ASSERT_EQUAL_HEX8(
        1u << AUVID_SURGE | 1u << AUVID_SWAY | 1u << AUVID_HEAVE | 1u << AUVID_YAW, metric.driven);
    for (int j = 0; j < 6; ++j) {
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, 0, (double)metric.delay_s[j]);
    }
}

/* J is quadratic: where its derivative along each parameter vanishes, there is its minimum. The
 * vertex of the parabola through three points is exact but for rounding. */
static void assert_minimum_at_truth(auvid_metric_t *m, uint32_t which)
{
    double least = cost_of(m, truth);
    for (int i = 0; i < N; ++i) {
        if (which >> i & 1u) {
            auvid_real_t pi[AUVID_MAX_PARAMETERS];
            memcpy(pi, truth, sizeof pi);
            double h = 0.1 * fabs((double)truth[i]);
            pi[i] = truth[i] + (auvid_real_t)h;
            double up = cost_of(m, pi);
            pi[i] = truth[i] - (auvid_real_t)h;
            double down = cost_of(m, pi);
            TEST_ASSERT_TRUE(up > 50 * least && down > 50 * least);
            double vertex = 0.5 * h * (down - up) / (up + down - 2 * least);
            TEST_ASSERT_DOUBLE_WITHIN(2e-3 * fabs((double)truth[i]), 0, vertex);
        }
    }
}

static void test_cost_is_least_at_the_parameters(void)
{
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 120));
    merge_all(&metric);
    assert_minimum_at_truth(&metric, AUVID_G500_FREE);
}

static void test_measurement_of_the_true_parameters_has_r2_of_one(void)
{
    auvid_real_t r2[6];
    uint32_t budget = UINT32_MAX;
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 60));
    merge_all(&metric);
    auvid_metric_measure_begin(&metric, truth, 0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_measure(&metric, &budget));
    auvid_metric_r2(&metric, r2);
    for (int j = 0; j < 6; ++j) {
        bool modelled = auvid_girona500.columns[j] != 0;
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, modelled ? 1 : 0, (double)r2[j]);
    }
}

static void test_literal_reading_comes_within_ten_percent(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0};
    auvid_metric_literal(&cfg);
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 120));
    merge_all(&metric);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&metric, AUVID_G500_FREE, pi));
    for (int i = 0; i < 13; ++i) { /* it is biased: that is why it is not the default */
        TEST_ASSERT_DOUBLE_WITHIN(0.1 * fabs((double)truth[i]), (double)truth[i], (double)pi[i]);
    }
}

static void test_literal_sets_what_the_header_says(void)
{
    cfg.cell_us = 50000;
    auvid_metric_literal(&cfg);
    TEST_ASSERT_EQUAL(AUVID_SMOOTH_STATES, cfg.smoothing);
    TEST_ASSERT_EQUAL(10, cfg.half_width[0]);
    TEST_ASSERT_EQUAL(3, cfg.order);
    TEST_ASSERT_EQUAL(1, cfg.passes);
    TEST_ASSERT_FALSE(cfg.estimate_delay);
    cfg.cell_us = 0;
    auvid_metric_literal(&cfg);
    auvid_metric_literal(NULL);
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_metric_init(&metric, &cfg));
}

/* ---- budgets ---- */

static auvid_real_t sum_of_bits[64];

/* Everything an evaluation gives, by pieces of `piece` units. Returns the units used. */
static uint32_t evaluate_by(auvid_metric_t *m, uint32_t piece, auvid_real_t *out)
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
    out[0] = m->cost;
    auvid_metric_measure_begin(m, pi, AUVID_C(0.13));
    ALL(auvid_metric_measure(m, &budget));
    memcpy(out + 1, m->sse, sizeof m->sse);
    memcpy(out + 7, m->delay_s, sizeof m->delay_s);
    out[13] = m->constant;
    auvid_metric_cost_begin(m, truth, 0);
    ALL(auvid_metric_cost(m, &budget));
    out[14] = m->cost;
    auvid_metric_scale(m, out + 15);
#undef ALL
    return used;
}

static void assert_budgets_do_not_matter(void)
{
    static const uint32_t piece[] = {1, 2, 3, 7, 64, 1000};
    before = metric; /* band weights carry over from merge to merge: start each from the same */
    uint32_t used = evaluate_by(&metric, UINT32_MAX, sum_of_bits);
    for (size_t k = 0; k < sizeof piece / sizeof piece[0]; ++k) {
        auvid_real_t again[64] = {0};
        metric = before;
        TEST_ASSERT_EQUAL_UINT32(used, evaluate_by(&metric, piece[k], again));
        TEST_ASSERT_EQUAL_MEMORY(sum_of_bits, again, sizeof(auvid_real_t) * (15 + N));
    }
}

static void test_any_split_of_the_budget_gives_the_same_bits(void)
{
    cfg.set_rows = 20;
    start();
    world_t w = world_of(&cfg);
    w.shift_s = 0.1;
    feed(&metric, &w, 0, cells_of(&cfg, 100));
    assert_budgets_do_not_matter();
}

static void test_a_cost_takes_one_unit_for_each_row_of_r(void)
{
    uint32_t budget = 1000;
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 60));
    merge_all(&metric);
    auvid_metric_cost_begin(&metric, truth, 0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_cost(&metric, &budget));
    TEST_ASSERT_EQUAL_UINT32(1000 - (6 + 6 + 6 + 5), budget);
    budget = 0;
    auvid_metric_cost_begin(&metric, truth, 0);
    TEST_ASSERT_EQUAL(AUVID_PENDING, auvid_metric_cost(&metric, &budget));
    TEST_ASSERT_EQUAL_UINT32(0, budget);
}

static void test_a_merge_takes_three_passes_and_eight_units_for_each_dof(void)
{
    uint32_t budget = 1000000;
    cfg.set_rows = 20;
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 100));
    auvid_metric_merge_begin(&metric);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_merge(&metric, &budget));
    uint32_t rows = 5 * 2 * (9 + 9 + 9 + 8);
    /* a row that is rotated costs four, one of which the residual is measured one */
    TEST_ASSERT_EQUAL_UINT32(1000000 - (2 * 4 * rows + rows + 3 * 8 * 4), budget);
}

/* ---- the ring ---- */

static void feed_wrong_set(int rows)
{
    static auvid_real_t wrong[AUVID_MAX_PARAMETERS];
    for (int i = 0; i < N; ++i) {
        wrong[i] = truth[i] * AUVID_C(1.5);
    }
    world_t w = world_of(&cfg);
    w.pi = wrong;
    auvid_metric_gap(&metric);
    feed(&metric, &w, 1000, cells_of(&cfg, rows));
    auvid_metric_gap(&metric);
}

static void test_ninth_set_drops_the_first(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0};
    world_t w = world_of(&cfg);
    start();
    feed_wrong_set(60);
    TEST_ASSERT_EQUAL(7, feed(&metric, &w, 0, cells_of(&cfg, 7 * 60)));
    merge_all(&metric);
    TEST_ASSERT_EQUAL_UINT16(8 * 60, metric.dof_rows[AUVID_SURGE]);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&metric, AUVID_G500_FREE, pi));
    TEST_ASSERT_TRUE(fabs((double)pi[0] - (double)truth[0]) > 0.01 * (double)truth[0]);

    TEST_ASSERT_EQUAL(1, feed(&metric, &w, cells_of(&cfg, 7 * 60) * w.cell_s, 60 * 5));
    TEST_ASSERT_EQUAL_UINT32(9, metric.sets_recorded);
    assert_least_squares_find_truth(AUVID_G500_FREE);
    TEST_ASSERT_EQUAL_UINT16(8 * 60, metric.dof_rows[AUVID_SURGE]);
}

static void test_ring_of_one_set_keeps_the_last(void)
{
    cfg.sets = 1;
    start();
    feed_wrong_set(60);
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 60));
    assert_least_squares_find_truth(AUVID_G500_FREE);
    TEST_ASSERT_EQUAL_UINT16(60, metric.dof_rows[AUVID_SURGE]);
}

static void test_set_dropped_is_forgotten_and_cannot_be_dropped_again(void)
{
    world_t w = world_of(&cfg);
    start();
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_metric_drop(&metric, 0));
    feed(&metric, &w, 0, cells_of(&cfg, 60));
    feed_wrong_set(60);
    auvid_metric_gap(&metric);
    feed(&metric, &w, 100, cells_of(&cfg, 60));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_metric_drop(&metric, 3));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_metric_drop(&metric, 8));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_drop(&metric, 1));
    assert_least_squares_find_truth(AUVID_G500_FREE);
    TEST_ASSERT_EQUAL_UINT16(2 * 60, metric.dof_rows[AUVID_SURGE]);
    before = metric;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_metric_drop(&metric, 1));
    TEST_ASSERT_EQUAL_MEMORY(&before, &metric, sizeof metric);
}

static void test_close_of_an_empty_set_is_refused(void)
{
    start();
    before = metric;
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_metric_close(&metric));
    TEST_ASSERT_EQUAL_MEMORY(&before, &metric, sizeof metric);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_close(NULL));
}

static void test_set_closed_early_counts_its_rows(void)
{
    start();
    world_t w = world_of(&cfg);
    TEST_ASSERT_EQUAL(0, feed(&metric, &w, 0, cells_of(&cfg, 59)));
    TEST_ASSERT_EQUAL(AUVID_SET_COMPLETE, auvid_metric_close(&metric));
    TEST_ASSERT_EQUAL_UINT32(1, metric.sets_recorded);
    assert_least_squares_find_truth(AUVID_G500_FREE);
    TEST_ASSERT_EQUAL_UINT16(59, metric.dof_rows[AUVID_YAW]);
}

static void test_a_set_completes_with_its_last_row_and_not_before(void)
{
    start();
    world_t w = world_of(&cfg);
    TEST_ASSERT_EQUAL(0, feed(&metric, &w, 0, cells_of(&cfg, 60) - 1));
    TEST_ASSERT_EQUAL(1, feed(&metric, &w, (cells_of(&cfg, 60) - 1) * w.cell_s, 1));
}

/* Pairs of rows reach over the border of two sets: many small sets know as much as a large one. */
static void test_sets_of_one_row_know_what_pairs_across_their_borders_tell(void)
{
    cfg.set_rows = 1;
    cfg.sets = AUVID_MAX_SETS;
    cfg.driven = 0;
    cfg.free = 1u << AUVID_G500_M_R | 1u << AUVID_G500_N_R;
    memcpy(cfg.fixed, truth, sizeof cfg.fixed);
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 12));
    for (int s = 0; s < AUVID_MAX_SETS; ++s) { /* a single row has no variance: not driven */
        TEST_ASSERT_EQUAL_HEX8(0, metric.set[s].driven);
    }
    uint32_t budget = UINT32_MAX;
    auvid_metric_merge_begin(&metric);
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_metric_merge(&metric, &budget));

    cfg.set_rows = 2;
    start();
    feed(&metric, &w, 0, cells_of(&cfg, 2 * AUVID_MAX_SETS + 2));
    assert_least_squares_find_truth(cfg.free);
}

/* ---- driven or not ---- */

/* Two minutes in which sway moves, but is not driven. */
static void drift_sideways(void)
{
    start();
    world_t w = world_of(&cfg);
    for (int k = 0; k < cells_of(&cfg, 120); ++k) {
        auvid_sample_t s = cell_at(&w, k * w.cell_s);
        s.tau[AUVID_SWAY] = 0;
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
    }
    merge_all(&metric);
}

/* m_v v r acts on surge, and (m_u - m_v) u v on yaw. */
static void test_motion_of_a_dof_that_is_not_driven_does_not_bias_the_others(void)
{
    const uint32_t drag = 1u << AUVID_G500_Y_V | 1u << AUVID_G500_Y_VV;
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0};
    drift_sideways();
    uint32_t searched = auvid_metric_searched(&metric);
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE & ~drag, searched);
    TEST_ASSERT_EQUAL_HEX32(searched & ~(1u << AUVID_G500_M_V), auvid_metric_active(&metric));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&metric, searched, pi));
    assert_truth(pi, searched);
}

static void test_what_is_known_of_a_dof_that_is_not_driven_is_not_searched(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS];
    memcpy(cfg.fixed, truth, sizeof cfg.fixed);
    drift_sideways();
    uint32_t active = auvid_metric_active(&metric);
    TEST_ASSERT_EQUAL_HEX32(active, auvid_metric_searched(&metric));
    memcpy(pi, cfg.fixed, sizeof pi);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&metric, active, pi));
    assert_truth(pi, active);
}

static void test_columns_that_are_zero_are_not_searched(void)
{
    cfg.vehicle = &auvid_girona500_decoupled;
    drift_sideways();
    uint32_t active = auvid_metric_active(&metric);
    TEST_ASSERT_EQUAL_HEX32(0, active & 1u << AUVID_G500_M_V);
    TEST_ASSERT_EQUAL_HEX32(active, auvid_metric_searched(&metric));
    TEST_ASSERT_EQUAL_HEX32(0, auvid_metric_searched(NULL));
}

static void test_dof_that_is_not_driven_is_left_out(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS];
    start();
    for (int k = 0; k < cells_of(&cfg, 120); ++k) {
        world_t w = world_of(&cfg);
        auvid_sample_t s = cell_at(&w, k * w.cell_s);
        s.tau[AUVID_SWAY] = AUVID_C(1.0) + AUVID_C(0.5) * (auvid_real_t)(k % 2);
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
    }
    uint32_t sway = 1u << AUVID_G500_M_V | 1u << AUVID_G500_Y_V | 1u << AUVID_G500_Y_VV;
    merge_all(&metric);
    TEST_ASSERT_EQUAL_HEX8(1u << AUVID_SURGE | 1u << AUVID_HEAVE | 1u << AUVID_YAW, metric.driven);
    TEST_ASSERT_EQUAL_UINT16(0, metric.dof_rows[AUVID_SWAY]);
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE & ~sway, auvid_metric_active(&metric));
    memcpy(pi, truth, sizeof pi);
    double at_truth = cost_of(&metric, pi);
    pi[AUVID_G500_Y_V] = 900;
    pi[AUVID_G500_Y_VV] = -900;
    TEST_ASSERT_EQUAL_DOUBLE(at_truth, cost_of(&metric, pi));
}

/* Three periods of a sine slow enough to pass the smoother, its rms 5 % beside the threshold. */
static void test_dof_is_driven_from_the_stated_part_of_its_scale_on(void)
{
    for (int above = 0; above < 2; ++above) {
        setUp();
        cfg.driven = AUVID_C(0.1);
        cfg.tau_max[AUVID_YAW] = 30;
        start();
        for (int k = 0; k < cells_of(&cfg, 60); ++k) {
            world_t w = world_of(&cfg);
            auvid_sample_t s = cell_at(&w, k * w.cell_s);
            double rms = 0.1 * 30 * (above ? 1.05 : 0.95);
            s.tau[AUVID_YAW] = (auvid_real_t)(7 + rms * sqrt(2) * sin(2 * PI * 0.1 * k * 0.1));
            TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
        }
        merge_all(&metric);
        TEST_ASSERT_EQUAL(above, metric.driven >> AUVID_YAW & 1);
    }
}

static void test_set_in_which_a_dof_is_not_driven_does_not_count_in_its_r2(void)
{
    auvid_real_t r2[2][6], pi[AUVID_MAX_PARAMETERS];
    memcpy(pi, truth, sizeof pi);
    pi[AUVID_G500_M_R] *= AUVID_C(1.3);
    for (int more = 0; more < 2; ++more) {
        uint32_t budget = UINT32_MAX;
        setUp();
        start();
        world_t w = world_of(&cfg);
        feed(&metric, &w, 0, cells_of(&cfg, 60));
        auvid_metric_gap(&metric);
        for (int k = 0; more && k < cells_of(&cfg, 60); ++k) {
            auvid_sample_t s = cell_at(&w, 200 + k * w.cell_s);
            s.tau[AUVID_YAW] = AUVID_C(1.4) * (auvid_real_t)(k / 100 % 2);
            TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
        }
        merge_all(&metric);
        TEST_ASSERT_EQUAL_UINT16(60, metric.dof_rows[AUVID_YAW]);
        TEST_ASSERT_EQUAL_UINT16(more ? 120 : 60, metric.dof_rows[AUVID_SURGE]);
        auvid_metric_measure_begin(&metric, pi, 0);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_measure(&metric, &budget));
        auvid_metric_r2(&metric, r2[more]);
    }
    TEST_ASSERT_TRUE(r2[0][AUVID_YAW] < AUVID_C(0.999));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, (double)r2[0][AUVID_YAW], (double)r2[1][AUVID_YAW]);
}

static void test_no_dof_driven_is_no_data(void)
{
    uint32_t budget = 100;
    start();
    auvid_metric_merge_begin(&metric);
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_metric_merge(&metric, &budget));
    auvid_sample_t s;
    world_t w = world_of(&cfg);
    for (int k = 0; k < cells_of(&cfg, 60); ++k) {
        motion(&w, k * w.cell_s, &s);
        s.tau[AUVID_HEAVE] = 40; /* constant */
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
    }
    auvid_metric_merge_begin(&metric);
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_metric_merge(&metric, &budget));
    TEST_ASSERT_EQUAL_HEX32(0, auvid_metric_active(&metric));
    TEST_ASSERT_EQUAL_UINT32(100, budget);
}

/* A fixed mass times an acceleration is not a wrench. */
static void test_what_fixed_parameters_explain_does_not_drive_a_dof(void)
{
    cfg.free = AUVID_G500_FREE & ~(1u << AUVID_G500_M_V);
    cfg.fixed[AUVID_G500_M_V] = truth[AUVID_G500_M_V];
    start();
    for (int k = 0; k < cells_of(&cfg, 60); ++k) {
        world_t w = world_of(&cfg);
        auvid_sample_t s = cell_at(&w, k * w.cell_s);
        s.tau[AUVID_SWAY] = 0;
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
    }
    merge_all(&metric);
    TEST_ASSERT_EQUAL_HEX8(0, metric.driven & 1u << AUVID_SWAY);
}

static void test_the_share_of_fixed_parameters_is_taken_from_the_wrench(void)
{
    uint32_t fixed = 1u << AUVID_G500_M_U | 1u << AUVID_G500_W_B | 1u << AUVID_G500_N_RR;
    truth[AUVID_G500_X_0] = 4;
    cfg.free = AUVID_G500_FREE & ~fixed;
    memcpy(cfg.fixed, truth, sizeof cfg.fixed);
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 120));
    assert_least_squares_find_truth(AUVID_G500_FREE & ~fixed);

    auvid_real_t pi[AUVID_MAX_PARAMETERS]; /* what is said of them is ignored */
    memcpy(pi, truth, sizeof pi);
    pi[AUVID_G500_X_UU] *= AUVID_C(1.1);
    double cost = cost_of(&metric, pi);
    pi[AUVID_G500_M_U] = -1000;
    pi[AUVID_G500_X_0] = 1000;
    TEST_ASSERT_EQUAL_DOUBLE(cost, cost_of(&metric, pi));

    uint32_t all = AUVID_G500_FREE; /* and they are not solved for */
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&metric, all, pi));
    TEST_ASSERT_EQUAL_DOUBLE(-1000, (double)pi[AUVID_G500_M_U]);
}

/* ---- stored sets ---- */

/* Pseudo-random in +-1. */
static auvid_real_t noise(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return (auvid_real_t)((double)*state / 2147483648.0 - 1.0);
}

static void test_stored_entries_are_off_by_a_share_of_their_column_whatever_its_size(void)
{
    static const double size[] = {1e17, 3e-30, 1, 0, 1e-20, 7e3, 250, 1e-38, 1.0 / 3};
    auvid_real_t row[AUVID_MAX_PARAMETERS + AUVID_METRIC_DELAYS], most[AUVID_MAX_COLUMNS] = {0};
    uint32_t state = 1;
    start();
    int n = auvid_metric_order(&metric, 0), entries = n * (n + 1) / 2;
    for (int band = 0; band < AUVID_METRIC_BANDS; ++band) {
        for (int i = 0, at = 0; i < n; ++i) {
            for (int k = i; k < n; ++k, ++at) {
                auvid_real_t value = noise(&state) * (auvid_real_t)size[k % 9];
                metric.factor[band][at] = value;
                most[k] = (auvid_real_t)fmax((double)most[k], fabs((double)value));
            }
        }
    }
    auvid_metric_pack(&metric, &metric.set[0]);
    for (int band = 0, at = 0; band < AUVID_METRIC_BANDS; ++band, at -= entries) {
        for (int i = 0; i < n; ++i) {
            auvid_metric_unpack_row(&metric, &metric.set[0], band, 0, i, row);
            for (int k = i; k < n; ++k, ++at) {
                double off = fabs((double)row[k] - (double)metric.factor[band][at]);
                double unit = fmax(ldexp(1.001 * (double)most[k], -15), ldexp(1, -127));
                TEST_ASSERT_TRUE(off <= unit);
            }
        }
    }
}

/* In yaw m_u and m_v stand as -u v and u v: one pivot has to be none, or rounding would count as
 * knowledge. */
static void test_a_column_that_depends_on_others_is_none_after_rounding(void)
{
    for (int begin = 0; begin < 60; ++begin) {
        start();
        world_t w = world_of(&cfg);
        feed(&metric, &w, 17.3 * begin, cells_of(&cfg, 2 * cfg.set_rows));
        merge_all(&metric);
        int n = auvid_metric_order(&metric, AUVID_YAW), pivots = 0;
        for (int i = 0; i < metric.count[AUVID_YAW]; ++i) {
            int at = metric.factor_at[AUVID_YAW] + i * n - i * (i - 1) / 2;
            pivots += metric.merged[at] != AUVID_C(0.0);
        }
        TEST_ASSERT_EQUAL(metric.count[AUVID_YAW] - 1, pivots);
    }
}

static void test_every_parameter_is_free_where_the_mask_is_zero(void)
{
    cfg.free = 0;
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 60));
    merge_all(&metric);
    TEST_ASSERT_EQUAL_HEX32((1u << N) - 1, auvid_metric_active(&metric));
}

static void test_least_squares_name_what_the_data_do_not_determine(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0};
    start();
    world_t w = world_of(&cfg);
    w.still[AUVID_YAW] = 1; /* N = (m_v - m_u) u v moves nothing about yaw */
    feed(&metric, &w, 0, cells_of(&cfg, 60));
    merge_all(&metric);
    pi[AUVID_G500_N_R] = 7;
    TEST_ASSERT_EQUAL(AUVID_ERR_SINGULAR, auvid_metric_least_squares(&metric, AUVID_G500_FREE, pi));
    TEST_ASSERT_EQUAL_DOUBLE(0, (double)pi[AUVID_G500_N_R]);
    uint32_t seen =
        AUVID_G500_FREE & ~(1u << AUVID_G500_M_R | 1u << AUVID_G500_N_R | 1u << AUVID_G500_N_RR);
    pi[AUVID_G500_N_R] = 7;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&metric, seen, pi));
    assert_truth(pi, seen);
    TEST_ASSERT_EQUAL_DOUBLE(7, (double)pi[AUVID_G500_N_R]);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_least_squares(NULL, 1, pi));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_least_squares(&metric, 1, NULL));
}

/* ---- delays ---- */

static void find_delay(double shift_s, double lag_s)
{
    start();
    world_t w = world_of(&cfg);
    w.shift_s = shift_s;
    w.lag_s = lag_s;
    feed(&metric, &w, 0, cells_of(&cfg, 120));
    merge_all(&metric);
    for (int j = 0; j < 6; ++j) {
        if (auvid_girona500.columns[j] != 0) {
            TEST_ASSERT_DOUBLE_WITHIN(5e-3, shift_s + lag_s, (double)metric.delay_s[j]);
            TEST_ASSERT_EQUAL(lag_s > 0, metric.lagged >> j & 1);
        } else {
            TEST_ASSERT_EQUAL_DOUBLE(0, (double)metric.delay_s[j]);
        }
    }
}

static void test_delay_of_the_wrench_is_found_within_5_ms(void)
{
    find_delay(0.06, 0);
    find_delay(0.10, 0);
    find_delay(0.25, 0);
    find_delay(0.45, 0);
}

static void test_lag_of_the_wrench_is_found_within_5_ms_and_flagged(void)
{
    find_delay(0, 0.1);
    find_delay(0, 0.2);
}

static void test_parameters_come_back_from_a_delayed_wrench(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0};
    find_delay(0.2, 0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&metric, AUVID_G500_FREE, pi));
    for (int i = 0; i < 13; ++i) { /* three nodes 0.3 s apart do not interpolate 0.14 Hz exactly */
        TEST_ASSERT_DOUBLE_WITHIN(0.02 * fabs((double)truth[i]), (double)truth[i], (double)pi[i]);
    }
}

static void test_response_before_its_command_is_taken_as_no_delay(void)
{
    start();
    world_t w = world_of(&cfg);
    w.shift_s = -0.1;
    feed(&metric, &w, 0, cells_of(&cfg, 120));
    merge_all(&metric);
    for (int j = 0; j < 6; ++j) {
        TEST_ASSERT_EQUAL_DOUBLE(0, (double)metric.delay_s[j]);
    }
}

static void test_given_delay_is_used_as_it_is(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0};
    cfg.estimate_delay = false;
    for (int j = 0; j < 6; ++j) {
        cfg.delay_s[j] = AUVID_C(0.3);
    }
    start();
    world_t w = world_of(&cfg);
    w.shift_s = 0.3; /* a node: no interpolation */
    feed(&metric, &w, 0, cells_of(&cfg, 120));
    merge_all(&metric);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&metric, AUVID_G500_FREE, pi));
    assert_truth(pi, AUVID_G500_FREE);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.3, (double)metric.delay_s[AUVID_YAW]);
}

/* ---- gaps and bad cells ---- */

/* A smoothed equation holds across a jump as well; a delayed wrench does not. */
static void test_gap_inside_a_set_does_not_mix_what_is_on_its_two_sides(void)
{
    double whole[2];
    for (int told = 0; told < 2; ++told) {
        setUp();
        cfg.estimate_delay = false;
        for (int j = 0; j < 6; ++j) {
            cfg.delay_s[j] = AUVID_C(0.3);
        }
        start();
        world_t w = world_of(&cfg);
        w.shift_s = 0.3;
        feed(&metric, &w, 0, cells_of(&cfg, 40) + 3);
        if (told) {
            auvid_metric_gap(&metric);
        }
        TEST_ASSERT_EQUAL(1, feed(&metric, &w, 333, cells_of(&cfg, 20)));
        merge_all(&metric);
        whole[told] = cost_of(&metric, truth) + (double)metric.constant;
    }
    TEST_ASSERT_TRUE(whole[1] < 1e-8);
    TEST_ASSERT_TRUE(whole[0] > 1e-4);
    auvid_metric_gap(NULL);
}

static void test_cell_that_is_not_finite_is_ignored(void)
{
    world_t w = world_of(&cfg);
    start();
    feed(&metric, &w, 0, 70);
    before = metric;
    auvid_sample_t good = cell_at(&w, 7.0);
    auvid_real_t *field[] = {&good.phi,
                             &good.theta,
                             &good.psi,
                             &good.nu[5],
                             &good.nu_dot[0],
                             &good.tau[2],
                             &good.command[AUVID_MAX_COMMANDS - 1]};
    for (size_t i = 0; i < sizeof field / sizeof field[0]; ++i) {
        auvid_real_t keep = *field[i];
        *field[i] = (auvid_real_t)(i % 2 ? NAN : INFINITY);
        TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_metric_add(&metric, &good));
        TEST_ASSERT_EQUAL_MEMORY(&before, &metric, sizeof metric);
        *field[i] = keep;
    }
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_add(&metric, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_add(NULL, &good));
}

/* Girona500's trigonometry ends at 1e4 rad; 1e30 squared overflows. */
static void test_rows_the_model_cannot_make_are_left_out(void)
{
    world_t w = world_of(&cfg);
    for (int literal = 0; literal < 2; ++literal) {
        setUp();
        if (literal) {
            auvid_metric_literal(&cfg);
        }
        start();
        feed(&metric, &w, 0, cells_of(&cfg, 20));
        auvid_sample_t bad = cell_at(&w, cells_of(&cfg, 20) * w.cell_s);
        bad.phi = AUVID_C(1e7);
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &bad) >= 0);
        feed(&metric, &w, (cells_of(&cfg, 20) + 1) * w.cell_s, cells_of(&cfg, 40));
        merge_all(&metric);
        TEST_ASSERT_TRUE(isfinite(cost_of(&metric, truth)));
        TEST_ASSERT_TRUE(isfinite((double)metric.constant));
        if (!literal) {
            assert_least_squares_find_truth(AUVID_G500_FREE);
        }
    }
}

/* What the broken regressor gives for m_u. */
static auvid_real_t broken_entry;

static void broken_regressor(const void *context, const auvid_sample_t *s, auvid_regressor_t *y)
{
    auvid_girona500.regressor(context, s, y);
    y->row[AUVID_SURGE][AUVID_G500_M_U] = broken_entry;
}

static void test_rows_the_model_never_can_make_do_not_count_as_explained(void)
{
    const auvid_real_t entries[] = {(auvid_real_t)NAN, -(auvid_real_t)INFINITY, AUVID_C(1e16)};
    auvid_vehicle_t broken = auvid_girona500;
    uint32_t budget = UINT32_MAX;
    broken.regressor = broken_regressor;
    for (int k = 0; k < 6; ++k) {
        setUp();
        if (k >= 3) {
            auvid_metric_literal(&cfg);
        }
        cfg.vehicle = &broken;
        broken_entry = entries[k % 3];
        world_t w = world_of(&cfg);
        start();
        feed(&metric, &w, 0, cells_of(&cfg, 2 * cfg.set_rows));
        TEST_ASSERT_EQUAL_UINT32(0, metric.sets_recorded);
        TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_metric_close(&metric));
        auvid_metric_merge_begin(&metric);
        TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_metric_merge(&metric, &budget));
    }
}

/* ---- residual path ---- */

static void g500_residual(const void *context, const auvid_sample_t *s, const auvid_real_t *pi,
                          auvid_real_t *e)
{
    (void)context;
    auvid_vehicle_residual(&auvid_girona500, s, pi, e);
}

enum { ROWS = (SETS + 1) * 120, CANARY = 4 };
static auvid_row_t store[ROWS + 2 * CANARY];
static auvid_vehicle_t by_residual;

static void use_residual_path(int row_cells, int set_rows)
{
    by_residual = auvid_girona500;
    by_residual.regressor = NULL;
    by_residual.residual = g500_residual;
    cfg.vehicle = &by_residual;
    cfg.row_cells = (uint16_t)row_cells;
    cfg.set_rows = (uint16_t)set_rows;
    cfg.rows = store + CANARY;
    memset(store, 0xA5, sizeof store);
}

static void assert_canaries(void)
{
    const unsigned char *low = (const unsigned char *)store;
    const unsigned char *high =
        (const unsigned char *)(store + CANARY + (cfg.sets + 1) * cfg.set_rows);
    for (size_t i = 0; i < CANARY * sizeof store[0]; ++i) {
        TEST_ASSERT_EQUAL_HEX8(0xA5, low[i]);
        TEST_ASSERT_EQUAL_HEX8(0xA5, high[i]);
    }
}

/* Rows of one cell: no averaging, so both paths see the same equations and both costs are least at
 * the truth, exactly but for rounding. */
static void test_residual_path_has_its_minimum_where_the_regressor_path_has(void)
{
    cfg.sets = 4;
    use_residual_path(1, 120);
    start();
    world_t w = world_of(&cfg);
    TEST_ASSERT_EQUAL(4, feed(&metric, &w, 0, cells_of(&cfg, 480)));
    merge_all(&metric);
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE, auvid_metric_active(&metric));
    assert_minimum_at_truth(&metric, AUVID_G500_FREE);
}

/* Means over 0.2 s: |u| u of the mean is not the mean of |u| u, by (u' T)^2 / 12 = 1e-4 of 0.2. */
static void test_residual_path_with_rows_of_two_cells_is_within_half_a_percent(void)
{
    cfg.sets = 4;
    use_residual_path(2, 120);
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 480));
    merge_all(&metric);
    for (int i = 0; i < 13; ++i) {
        auvid_real_t pi[AUVID_MAX_PARAMETERS];
        double h = 0.1 * fabs((double)truth[i]), least = cost_of(&metric, truth);
        memcpy(pi, truth, sizeof pi);
        pi[i] = truth[i] + (auvid_real_t)h;
        double up = cost_of(&metric, pi);
        pi[i] = truth[i] - (auvid_real_t)h;
        double down = cost_of(&metric, pi);
        double vertex = 0.5 * h * (down - up) / (up + down - 2 * least);
        TEST_ASSERT_DOUBLE_WITHIN(0.05 * h, 0, vertex);
    }
}

static void test_residual_path_gives_the_same_bits_for_any_split_of_the_budget(void)
{
    use_residual_path(2, 20);
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 70));
    assert_budgets_do_not_matter();
}

static void test_residual_path_takes_one_unit_for_each_row(void)
{
    uint32_t budget = 1000;
    use_residual_path(2, 20);
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 70));
    merge_all(&metric);
    auvid_metric_cost_begin(&metric, truth, 0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_cost(&metric, &budget));
    TEST_ASSERT_EQUAL_UINT32(1000 - 60, budget);
}

/* Residuals are smoothed across the borders of sets: where sets end does not matter. */
static void test_residual_path_gives_the_same_bits_for_any_division_into_sets(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS], cost[2];
    memcpy(pi, truth, sizeof pi);
    pi[AUVID_G500_M_V] += 30;
    for (int k = 0; k < 2; ++k) {
        setUp();
        use_residual_path(2, k == 0 ? 120 : 30);
        start();
        world_t w = world_of(&cfg);
        feed(&metric, &w, 0, cells_of(&cfg, 120));
        merge_all(&metric);
        cost_of(&metric, pi);
        cost[k] = metric.cost;
    }
    TEST_ASSERT_EQUAL_MEMORY(&cost[0], &cost[1], sizeof cost[0]);
}

static void test_residual_path_has_its_minimum_in_the_delay_too(void)
{
    cfg.sets = 4;
    use_residual_path(2, 120);
    start();
    world_t w = world_of(&cfg);
    w.shift_s = 0.2;
    feed(&metric, &w, 0, cells_of(&cfg, 480));
    merge_all(&metric);
    double cost[3];
    for (int k = 0; k < 3; ++k) {
        uint32_t budget = UINT32_MAX;
        auvid_metric_cost_begin(&metric, truth, AUVID_C(0.1) * (auvid_real_t)(k + 1));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_cost(&metric, &budget));
        cost[k] = (double)metric.cost;
    }
    TEST_ASSERT_TRUE(cost[1] < 0.01 * cost[0] && cost[1] < 0.01 * cost[2]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.6, (double)auvid_metric_longest_delay(&metric));
}

static void test_a_record_whose_times_are_rounded_is_still_one_record(void)
{
    use_residual_path(2, 60);
    start();
    world_t w = world_of(&cfg);
    for (int k = 0; k < cells_of(&cfg, 60); ++k) {
        auvid_sample_t s = cell_at(&w, k * w.cell_s);
        s.t_us += (uint64_t)(k % 3);
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
    }
    merge_all(&metric);
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0};
    TEST_ASSERT_TRUE(cost_of(&metric, pi) > 1e-3);
}

/* 31 rows are smoothed at once: thirty fewer results than rows, on each side of a gap. */
static void test_residuals_are_not_smoothed_over_a_gap(void)
{
    double sse[2];
    for (int k = 0; k < 2; ++k) {
        setUp();
        use_residual_path(2, 80);
        cfg.free = 0;
        start();
        world_t w = world_of(&cfg);
        feed(&metric, &w, 0, cells_of(&cfg, 40));
        if (k == 1) {
            auvid_metric_gap(&metric);
            feed(&metric, &w, 500, cells_of(&cfg, 40));
        } else {
            feed(&metric, &w, cells_of(&cfg, 40) * w.cell_s, 40 * cfg.row_cells);
        }
        merge_all(&metric);
        uint32_t budget = UINT32_MAX;
        auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0};
        memcpy(pi, truth, sizeof pi);
        pi[AUVID_G500_X_0] = 10; /* a residual of -10 N everywhere */
        auvid_metric_measure_begin(&metric, pi, 0);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_measure(&metric, &budget));
        sse[k] = (double)metric.sse[AUVID_SURGE];
    }
    TEST_ASSERT_DOUBLE_WITHIN(100, 50 * 100, sse[0]);
    TEST_ASSERT_DOUBLE_WITHIN(100, 20 * 100, sse[1]);
}

static void test_rows_are_stored_inside_the_storage_alone(void)
{
    cfg.sets = 3;
    use_residual_path(1, 7);
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 7 * 15));
    TEST_ASSERT_EQUAL_UINT32(15, metric.sets_recorded);
    TEST_ASSERT_EQUAL(AUVID_SET_COMPLETE, (feed(&metric, &w, 0, 3), auvid_metric_close(&metric)));
    feed(&metric, &w, 0, 7 * 5);
    merge_all(&metric);
    (void)cost_of(&metric, truth);
    assert_canaries();
}

static void test_residual_path_has_neither_least_squares_nor_scale(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {1}, scale[AUVID_MAX_PARAMETERS];
    use_residual_path(2, 20);
    start();
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_metric_least_squares(&metric, 1, pi));
    auvid_metric_scale(&metric, scale);
    for (int i = 0; i < N; ++i) {
        TEST_ASSERT_EQUAL_DOUBLE(0, (double)scale[i]);
    }
}

static void test_cost_that_is_not_finite_is_returned_as_such(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS];
    uint32_t budget = UINT32_MAX;
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 60));
    merge_all(&metric);
    memcpy(pi, truth, sizeof pi);
    pi[0] = AUVID_LARGEST;
    auvid_metric_cost_begin(&metric, pi, 0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_cost(&metric, &budget));
    TEST_ASSERT_FALSE(auvid_is_finite(metric.cost));
    TEST_ASSERT_TRUE(cost_of(&metric, truth) < 1e-3); /* and the next one is as ever */
}

/* ---- refusals ---- */

static void assert_refused(auvid_status_t expected)
{
    memset(&metric, 0x5A, sizeof metric);
    before = metric;
    TEST_ASSERT_EQUAL(expected, auvid_metric_init(&metric, &cfg));
    TEST_ASSERT_EQUAL_MEMORY(&before, &metric, sizeof metric);
    setUp();
}

#define REFUSED(status, assignment)                                                                \
    do {                                                                                           \
        assignment;                                                                                \
        assert_refused(status);                                                                    \
    } while (0)

static void test_init_refuses_a_field_out_of_its_range_and_changes_nothing(void)
{
    REFUSED(AUVID_ERR_RANGE, cfg.tau_max[4] = 0);
    REFUSED(AUVID_ERR_RANGE, cfg.tau_max[0] = -1);
    REFUSED(AUVID_ERR_RANGE, cfg.driven = AUVID_C(-0.01));
    REFUSED(AUVID_ERR_RANGE, cfg.driven = AUVID_C(1.01));
    REFUSED(AUVID_ERR_RANGE, cfg.cell_us = 999);
    REFUSED(AUVID_ERR_RANGE, cfg.cell_us = 1000001);
    REFUSED(AUVID_ERR_RANGE, cfg.row_cells = 0);
    REFUSED(AUVID_ERR_RANGE, cfg.set_rows = 0);
    REFUSED(AUVID_ERR_RANGE, cfg.set_rows = 60000 / AUVID_MAX_SETS + 1);
    REFUSED(AUVID_ERR_RANGE, cfg.sets = 0);
    REFUSED(AUVID_ERR_RANGE, cfg.sets = AUVID_MAX_SETS + 1);
    REFUSED(AUVID_ERR_RANGE, cfg.lag[0] = 0);
    REFUSED(AUVID_ERR_RANGE, cfg.lag[1] = AUVID_METRIC_LAGS + 1);
    REFUSED(AUVID_ERR_RANGE, cfg.passes = 0);
    REFUSED(AUVID_ERR_RANGE, cfg.passes = 3);
    REFUSED(AUVID_ERR_RANGE, cfg.half_width[0] = 0);
    REFUSED(AUVID_ERR_RANGE, cfg.half_width[1] = 0);
    REFUSED(AUVID_ERR_RANGE, cfg.order = 6);
    REFUSED(AUVID_ERR_RANGE, cfg.smoothing = (auvid_smoothing_t)2);
    REFUSED(AUVID_ERR_RANGE, cfg.smoothing = AUVID_SMOOTH_STATES); /* with estimate_delay */
    REFUSED(AUVID_ERR_RANGE, cfg.delay_s[2] = AUVID_C(-0.01));
    REFUSED(AUVID_ERR_RANGE, cfg.delay_s[2] = AUVID_C(0.61));
    REFUSED(AUVID_ERR_RANGE, (auvid_metric_literal(&cfg), cfg.order = 0)); /* no derivative */
}

static void test_init_refuses_numbers_that_are_not_finite_and_changes_nothing(void)
{
    REFUSED(AUVID_ERR_NOT_FINITE, cfg.fixed[3] = (auvid_real_t)NAN);
    REFUSED(AUVID_ERR_NOT_FINITE, cfg.tau_max[3] = (auvid_real_t)INFINITY);
    REFUSED(AUVID_ERR_NOT_FINITE, cfg.driven = (auvid_real_t)NAN);
    REFUSED(AUVID_ERR_NOT_FINITE, cfg.delay_s[5] = (auvid_real_t)NAN);
}

static void test_init_refuses_what_exceeds_the_sizes_and_changes_nothing(void)
{
    static auvid_vehicle_t wide;
    REFUSED(AUVID_ERR_SIZE, cfg.half_width[0] = (AUVID_MAX_TAPS - 1) / 4 + 1);
    REFUSED(AUVID_ERR_SIZE, cfg.row_cells = 4); /* 41 taps over 4 cells are 11 rows at once */
    REFUSED(AUVID_ERR_SIZE, (cfg.half_width[0] = AUVID_MAX_HALF_WIDTH + 1, cfg.passes = 1));
    wide = auvid_girona500;
    wide.columns[AUVID_SURGE] |= 1u << AUVID_G500_Y_V; /* one column more: factor full */
    REFUSED(AUVID_ERR_SIZE, (cfg.vehicle = &wide, cfg.free = 0));
    for (int j = 0; j < 6; ++j) {
        wide.columns[j] = (1u << N) - 1;
    }
    REFUSED(AUVID_ERR_SIZE, (cfg.vehicle = &wide, cfg.free = 0));
    REFUSED(AUVID_ERR_SIZE, use_residual_path(AUVID_MAX_TAPS + 1, 10));
}

static void test_init_refuses_what_cannot_work_and_changes_nothing(void)
{
    static auvid_vehicle_t broken;
    REFUSED(AUVID_ERR_SINGULAR, (cfg.half_width[1] = 1, cfg.order = 3));
    REFUSED(AUVID_ERR_NULL, cfg.vehicle = NULL);
    REFUSED(AUVID_ERR_PARAMETERS, cfg.free = 1u << 20); /* none of the model's */
    broken = auvid_girona500;
    broken.parameters = 0;
    REFUSED(AUVID_ERR_PARAMETERS, cfg.vehicle = &broken);
    broken = auvid_girona500;
    broken.regressor = NULL;
    REFUSED(AUVID_ERR_MODEL, cfg.vehicle = &broken);
    REFUSED(AUVID_ERR_MODEL, (use_residual_path(2, 10), cfg.rows = NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_init(NULL, &cfg));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_init(&metric, NULL));
}

static void test_largest_filter_that_fits_is_accepted(void)
{
    cfg.half_width[0] = (AUVID_MAX_TAPS - 1) / 4;
    cfg.row_cells = 6;
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 120));
    assert_least_squares_find_truth(AUVID_G500_FREE);
}

static void test_rows_further_apart_than_the_filter_is_long_are_made_too(void)
{
    cfg.half_width[0] = cfg.half_width[1] = 2;
    cfg.passes = 1;
    cfg.row_cells = 9;
    start();
    world_t w = world_of(&cfg);
    TEST_ASSERT_EQUAL(1, feed(&metric, &w, 0, cells_of(&cfg, 60)));
    assert_least_squares_find_truth(AUVID_G500_FREE);
}

static void test_null_pointers_are_refused_or_ignored(void)
{
    uint32_t budget = 1;
    auvid_real_t x[AUVID_MAX_PARAMETERS];
    start();
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_merge(NULL, &budget));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_merge(&metric, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_cost(NULL, &budget));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_cost(&metric, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_measure(NULL, &budget));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_measure(&metric, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_drop(NULL, 0));
    TEST_ASSERT_EQUAL_HEX32(0, auvid_metric_active(NULL));
    auvid_metric_defaults(NULL, NULL);
    auvid_metric_merge_begin(NULL);
    auvid_metric_cost_begin(&metric, NULL, 0);
    auvid_metric_measure_begin(NULL, truth, 0);
    auvid_metric_scale(NULL, x);
    auvid_metric_scale(&metric, NULL);
    auvid_metric_r2(NULL, x);
    auvid_metric_r2(&metric, NULL);
    TEST_ASSERT_EQUAL_DOUBLE(0, (double)auvid_metric_longest_delay(NULL));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_least_squares_give_the_parameters_of_noise_free_cells_back);
    RUN_TEST(test_cost_is_least_at_the_parameters);
    RUN_TEST(test_measurement_of_the_true_parameters_has_r2_of_one);
    RUN_TEST(test_literal_reading_comes_within_ten_percent);
    RUN_TEST(test_literal_sets_what_the_header_says);
    RUN_TEST(test_any_split_of_the_budget_gives_the_same_bits);
    RUN_TEST(test_a_cost_takes_one_unit_for_each_row_of_r);
    RUN_TEST(test_a_merge_takes_three_passes_and_eight_units_for_each_dof);
    RUN_TEST(test_ninth_set_drops_the_first);
    RUN_TEST(test_ring_of_one_set_keeps_the_last);
    RUN_TEST(test_set_dropped_is_forgotten_and_cannot_be_dropped_again);
    RUN_TEST(test_close_of_an_empty_set_is_refused);
    RUN_TEST(test_set_closed_early_counts_its_rows);
    RUN_TEST(test_a_set_completes_with_its_last_row_and_not_before);
    RUN_TEST(test_sets_of_one_row_know_what_pairs_across_their_borders_tell);
    RUN_TEST(test_motion_of_a_dof_that_is_not_driven_does_not_bias_the_others);
    RUN_TEST(test_what_is_known_of_a_dof_that_is_not_driven_is_not_searched);
    RUN_TEST(test_columns_that_are_zero_are_not_searched);
    RUN_TEST(test_dof_that_is_not_driven_is_left_out);
    RUN_TEST(test_dof_is_driven_from_the_stated_part_of_its_scale_on);
    RUN_TEST(test_set_in_which_a_dof_is_not_driven_does_not_count_in_its_r2);
    RUN_TEST(test_no_dof_driven_is_no_data);
    RUN_TEST(test_what_fixed_parameters_explain_does_not_drive_a_dof);
    RUN_TEST(test_the_share_of_fixed_parameters_is_taken_from_the_wrench);
    RUN_TEST(test_stored_entries_are_off_by_a_share_of_their_column_whatever_its_size);
    RUN_TEST(test_a_column_that_depends_on_others_is_none_after_rounding);
    RUN_TEST(test_every_parameter_is_free_where_the_mask_is_zero);
    RUN_TEST(test_least_squares_name_what_the_data_do_not_determine);
    RUN_TEST(test_delay_of_the_wrench_is_found_within_5_ms);
    RUN_TEST(test_lag_of_the_wrench_is_found_within_5_ms_and_flagged);
    RUN_TEST(test_parameters_come_back_from_a_delayed_wrench);
    RUN_TEST(test_response_before_its_command_is_taken_as_no_delay);
    RUN_TEST(test_given_delay_is_used_as_it_is);
    RUN_TEST(test_gap_inside_a_set_does_not_mix_what_is_on_its_two_sides);
    RUN_TEST(test_cell_that_is_not_finite_is_ignored);
    RUN_TEST(test_rows_the_model_cannot_make_are_left_out);
    RUN_TEST(test_rows_the_model_never_can_make_do_not_count_as_explained);
    RUN_TEST(test_residual_path_has_its_minimum_where_the_regressor_path_has);
    RUN_TEST(test_residual_path_with_rows_of_two_cells_is_within_half_a_percent);
    RUN_TEST(test_residual_path_gives_the_same_bits_for_any_split_of_the_budget);
    RUN_TEST(test_residual_path_takes_one_unit_for_each_row);
    RUN_TEST(test_residual_path_gives_the_same_bits_for_any_division_into_sets);
    RUN_TEST(test_residual_path_has_its_minimum_in_the_delay_too);
    RUN_TEST(test_a_record_whose_times_are_rounded_is_still_one_record);
    RUN_TEST(test_residuals_are_not_smoothed_over_a_gap);
    RUN_TEST(test_rows_are_stored_inside_the_storage_alone);
    RUN_TEST(test_residual_path_has_neither_least_squares_nor_scale);
    RUN_TEST(test_cost_that_is_not_finite_is_returned_as_such);
    RUN_TEST(test_init_refuses_a_field_out_of_its_range_and_changes_nothing);
    RUN_TEST(test_init_refuses_numbers_that_are_not_finite_and_changes_nothing);
    RUN_TEST(test_init_refuses_what_exceeds_the_sizes_and_changes_nothing);
    RUN_TEST(test_init_refuses_what_cannot_work_and_changes_nothing);
    RUN_TEST(test_largest_filter_that_fits_is_accepted);
    RUN_TEST(test_rows_further_apart_than_the_filter_is_long_are_made_too);
    RUN_TEST(test_null_pointers_are_refused_or_ignored);
    return UNITY_END();
}
