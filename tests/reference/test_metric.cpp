// The metric against the pipeline of metric_reference.h.
#include <cmath>
#include <cstdint>
#include <vector>

#include "metric_reference.h"
extern "C" {
#include "literal.h"
}

void setUp()
{
}

void tearDown()
{
}

// ---- comparison ----

static auvid_metric_t metric;

static double cost_of(const Vector &x)
{
    auvid_real_t p[AUVID_MAX_PARAMETERS];
    for (int i = 0; i < AUVID_G500_COUNT; ++i) {
        p[i] = auvid_real_t(x(i));
    }
    uint32_t budget = UINT32_MAX;
    auvid_metric_cost_begin(&metric, p, 0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_cost(&metric, &budget));
    return double(metric.result.cost);
}

static Reference run(const auvid_metric_config_t &cfg, std::vector<Cell> cells)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_init(&metric, &cfg));
    uint64_t t_us = 0;
    for (Cell &c : cells) {
        auvid_sample_t s;
        round_cell(c, &s);
        s.t_us = t_us += cfg.cell_us;
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
    }
    uint32_t budget = UINT32_MAX;
    auvid_metric_merge_begin(&metric);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_merge(&metric, &budget));
    Reference reference(cfg);
    reference.take(cells);
    reference.merge();
    return reference;
}

// All parameters anywhere within +-500; the values of those that are not free must not matter.
static Vector anywhere(Noise *noise)
{
    Vector x(AUVID_G500_COUNT);
    for (int i = 0; i < AUVID_G500_COUNT; ++i) {
        x(i) = double(auvid_real_t(1000 * noise->uniform()));
    }
    return x;
}

static void compare_evaluation(const Reference &of)
{
    Reference reference = of;
    TEST_ASSERT_EQUAL_HEX(reference.excited, metric.result.excited);
    double node = reference.cell_s() * AUVID_METRIC_DELAY_CELLS;
    for (int j : dofs) {
        TEST_ASSERT_EQUAL_UINT(reference.dof_rows[j], metric.result.dof_rows[j]);
        if (!(reference.excited >> j & 1)) {
            continue;
        }
        // a parabola through three points 0.1 nodes apart replaces the true minimum
        TEST_ASSERT_EQUAL(reference.lag[j], metric.result.first_order_lag >> j & 1);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * node, reference.delay[j] * node,
                                  double(metric.result.delay_s[j]));
        TEST_ASSERT_DOUBLE_WITHIN(2e-3 * reference.band_weight[0][j], reference.band_weight[0][j],
                                  double(metric.evaluator.band_weight[0][j]));
        // from here on with the metric's choice, so that all differences are rounding
        reference.delay[j] = double(metric.result.delay_s[j]) / node;
        reference.band_weight[0][j] = double(metric.evaluator.band_weight[0][j]);
        reference.band_weight[1][j] = double(metric.evaluator.band_weight[1][j]);
    }
    double constant = 0;
    for (int j : dofs) {
        if (reference.excited >> j & 1) {
            Vector l = delay_weights(reference.delay[j], reference.lag[j]);
            constant += reference.weight[j] * reference.left(reference.stack(j), l);
        }
    }
    TEST_ASSERT_DOUBLE_WITHIN(reference.tolerance(paper(), constant), constant,
                              double(metric.result.constant));
    Noise noise{77};
    for (int k = 0; k < 20; ++k) {
        Vector x = k == 0 ? paper() : anywhere(&noise);
        double whole = reference.whole_cost(x);
        TEST_ASSERT_DOUBLE_WITHIN(reference.tolerance(x, whole), whole - constant, cost_of(x));

        auvid_real_t p[AUVID_MAX_PARAMETERS], r2[6];
        for (int i = 0; i < AUVID_G500_COUNT; ++i) {
            p[i] = auvid_real_t(x(i));
        }
        uint32_t budget = UINT32_MAX;
        auvid_metric_measure_begin(&metric, p, 0);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_measure(&metric, &budget));
        auvid_metric_r2(&metric, r2);
        int sets = int(reference.set_excited.size());
        for (int j : dofs) {
            if (!(reference.excited >> j & 1)) {
                TEST_ASSERT_EQUAL_DOUBLE(0, double(r2[j]));
                continue;
            }
            double total = 0, sse = reference.sse(j, x);
            for (int s = std::max(0, sets - reference.cfg.sets); s < sets; ++s) {
                total += reference.set_excited[s] >> j & 1 ? reference.set_m2[j][s] : 0;
            }
            double allowed =
                reference.tolerance(x, reference.weight[j] * sse) / reference.weight[j];
            TEST_ASSERT_DOUBLE_WITHIN(allowed, sse, double(metric.result.sse[j]));
            double r2_ref = 1 - sse / total;
            allowed = allowed / total + (1e3 * eps + stored) * (1 + sse / total);
            TEST_ASSERT_DOUBLE_WITHIN(allowed, r2_ref, double(r2[j]));
        }
    }
}

static void compare_least_squares(const Reference &of, double relative)
{
    Reference reference = of;
    double node = reference.cell_s() * AUVID_METRIC_DELAY_CELLS;
    std::vector<int> active;
    uint32_t mask = auvid_metric_active(&metric);
    auvid_real_t p[AUVID_MAX_PARAMETERS] = {0};
    for (int i = 0; i < AUVID_G500_COUNT; ++i) {
        if (mask >> i & 1) {
            active.push_back(i);
        }
    }
    for (int j : dofs) {
        reference.delay[j] = double(metric.result.delay_s[j]) / node;
        reference.band_weight[0][j] = double(metric.evaluator.band_weight[0][j]);
        reference.band_weight[1][j] = double(metric.evaluator.band_weight[1][j]);
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&metric, mask, p));
    Vector x = reference.least_squares(active, Vector::Zero(AUVID_G500_COUNT));
    for (int i : active) {
        TEST_ASSERT_DOUBLE_WITHIN(relative * std::fabs(x(i)) + relative, x(i), double(p[i]));
    }
}

static auvid_metric_config_t defaults()
{
    auvid_metric_config_t cfg;
    auvid_metric_defaults(&cfg, &auvid_girona500);
    return cfg;
}

static int cells_for(const auvid_metric_config_t &cfg, int sets)
{
    return 2 * AUVID_METRIC_DELAY_CELLS + taps_of(cfg) + cfg.row_cells * (sets * cfg.set_rows - 1);
}

static void test_noisy_record_of_three_sets_is_evaluated_as_the_header_says()
{
    auvid_metric_config_t cfg = defaults();
    World world;
    world.noise = 1;
    world.shift = 0.14;
    Reference reference = run(cfg, record(cells_for(cfg, 3), 0.1, world));
    TEST_ASSERT_EQUAL_UINT(3, metric.sets.recorded);
    compare_evaluation(reference);
    compare_least_squares(reference, 2e3 * eps + 10 * stored);
}

static void test_full_ring_is_evaluated_without_its_oldest_sets()
{
    auvid_metric_config_t cfg = defaults();
    cfg.sets = 3;
    World world;
    world.noise = 1;
    Reference reference = run(cfg, record(cells_for(cfg, 5), 0.1, world));
    TEST_ASSERT_EQUAL_UINT(5, metric.sets.recorded);
    compare_evaluation(reference);
    compare_least_squares(reference, 2e3 * eps + 10 * stored);
}

static void test_first_order_lag_and_fixed_parameters_are_evaluated_as_the_header_says()
{
    auvid_metric_config_t cfg = defaults();
    cfg.free = AUVID_G500_FREE & ~(1u << AUVID_G500_M_U) & ~(1u << AUVID_G500_W_B);
    cfg.fixed[AUVID_G500_M_U] = AUVID_C(240.0);
    cfg.fixed[AUVID_G500_W_B] = AUVID_C(-35.0);
    cfg.fixed[AUVID_G500_X_0] = AUVID_C(3.0);
    cfg.lag[0] = 1;
    World world;
    world.noise = 1;
    world.lag = 0.2;
    Reference reference = run(cfg, record(cells_for(cfg, 2), 0.1, world));
    TEST_ASSERT_EQUAL_HEX(0x27, metric.result.first_order_lag);
    compare_evaluation(reference);
    compare_least_squares(reference, 2e3 * eps + 10 * stored);
}

static void test_given_delay_other_widths_cells_and_one_pass_are_evaluated_alike()
{
    auvid_metric_config_t cfg = defaults();
    cfg.estimate_delay = false;
    cfg.delay_s[AUVID_SURGE] = AUVID_C(0.11);
    cfg.delay_s[AUVID_YAW] = AUVID_C(0.05);
    cfg.cell_us = 80000;
    cfg.row_cells = 7;
    cfg.set_rows = 45;
    cfg.half_width[0] = 9;
    cfg.half_width[1] = 12;
    cfg.passes = 1;
    World world;
    world.noise = 1;
    Reference reference = run(cfg, record(cells_for(cfg, 3), 0.08, world));
    compare_evaluation(reference);
    compare_least_squares(reference, 2e3 * eps + 10 * stored);
}

// The metric has rows of smoothed states, unlike its configuration, and bands of equal weight.
static Reference run_literal(auvid_metric_config_t cfg, std::vector<Cell> cells)
{
    static literal_t literal;
    auvid_metric_config_t paper = cfg;
    paper.half_width[0] = paper.half_width[1] = 5;
    paper.passes = 1;
    paper.velocity_us = 0;
    paper.estimate_delay = false;
    TEST_ASSERT_EQUAL(AUVID_OK, literal_metric(&literal, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_init(&metric, &cfg));
    literal_attach(&literal, &metric);
    for (Cell &c : cells) {
        auvid_sample_t s;
        round_cell(c, &s);
        TEST_ASSERT_TRUE(literal_add(&literal, &s) >= 0);
    }
    uint32_t budget = UINT32_MAX;
    auvid_metric_merge_begin(&metric);
    TEST_ASSERT_EQUAL(AUVID_OK, literal_merge(&metric, &budget));
    Reference reference(paper);
    reference.literal = true;
    reference.take(cells);
    reference.merge();
    return reference;
}

static void test_literal_smoothing_is_of_the_states_and_leaves_the_wrench_raw()
{
    auvid_metric_config_t cfg = defaults();
    World world;
    world.noise = 1;
    Reference reference =
        run_literal(cfg, record(2 * AUVID_METRIC_DELAY_CELLS + 11 + 5 * 119, 0.1, world));
    TEST_ASSERT_EQUAL_DOUBLE(1, double(metric.evaluator.band_weight[0][0]));
    compare_evaluation(reference);
    compare_least_squares(reference, 2e3 * eps + 10 * stored);
}

static void test_literal_smoothing_may_have_a_delay()
{
    auvid_metric_config_t cfg = defaults();
    cfg.delay_s[AUVID_SURGE] = AUVID_C(0.2);
    World world;
    world.noise = 1;
    Reference reference =
        run_literal(cfg, record(2 * AUVID_METRIC_DELAY_CELLS + 11 + 5 * 119, 0.1, world));
    compare_evaluation(reference);
    compare_least_squares(reference, 2e3 * eps + 10 * stored);
}

static void test_scale_is_the_inverse_of_the_weighted_norm_of_a_parameters_column()
{
    auvid_metric_config_t cfg = defaults();
    World world;
    world.noise = 1;
    Reference reference = run(cfg, record(cells_for(cfg, 2), 0.1, world));
    auvid_real_t scale[AUVID_MAX_PARAMETERS];
    auvid_metric_scale(&metric, scale);
    Vector square = Vector::Zero(AUVID_G500_COUNT);
    for (int j : dofs) {
        reference.band_weight[0][j] = double(metric.evaluator.band_weight[0][j]);
        reference.band_weight[1][j] = double(metric.evaluator.band_weight[1][j]);
        Matrix a = reference.stack(j);
        for (size_t k = 0; k < reference.column[j].size(); ++k) {
            square(reference.column[j][k]) += reference.weight[j] * a.col(k).squaredNorm();
        }
    }
    for (int i = 0; i < AUVID_G500_COUNT; ++i) {
        double expected = square(i) > 0 ? 1 / std::sqrt(square(i)) : 0;
        TEST_ASSERT_DOUBLE_WITHIN((100 * eps + stored) * expected, expected, double(scale[i]));
    }
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_noisy_record_of_three_sets_is_evaluated_as_the_header_says);
    RUN_TEST(test_full_ring_is_evaluated_without_its_oldest_sets);
    RUN_TEST(test_first_order_lag_and_fixed_parameters_are_evaluated_as_the_header_says);
    RUN_TEST(test_given_delay_other_widths_cells_and_one_pass_are_evaluated_alike);
    RUN_TEST(test_literal_smoothing_is_of_the_states_and_leaves_the_wrench_raw);
    RUN_TEST(test_literal_smoothing_may_have_a_delay);
    RUN_TEST(test_scale_is_the_inverse_of_the_weighted_norm_of_a_parameters_column);
    return UNITY_END();
}
