/*
 * The residual path linearised at an estimate, as the change test and the confidence read it. The
 * models here are linear in their parameters, so the correct result is known.
 */
#include <math.h>
#include <string.h>

#include "auvid/detail/confidence.h"
#include "metric_cells.h"
#include "sines.h"
#include "unity.h"

static auvid_confidence_job_t job;
static const auvid_confidence_t *const result = &job.result;
static auvid_metric_change_t change;
static auvid_metric_windows_t windows;
static uint64_t state;

void setUp(void)
{
    cells_defaults();
    state = 7;
}

void tearDown(void)
{
}

/* Add white noise to the wrench. */
static void add_noise(auvid_sample_t *s, double force_N)
{
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        s->tau[j] += (auvid_real_t)(force_N * sines_gauss(&state));
    }
}

/* Feed cells from time t on until the set is complete; white noise on the wrench. @return time
 * after the set */
static double feed_set(const world_t *w, double t, double force_N)
{
    for (uint32_t sets = metric.sets.recorded; metric.sets.recorded == sets; t += w->cell_s) {
        auvid_sample_t s = cell_at(w, t);
        add_noise(&s, force_N);
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
    }
    return t;
}

/* Sum of squared residuals in surge; of the other DoF in m->sse. */
static double squares_of(auvid_metric_t *m, const auvid_real_t *pi, double delay_s)
{
    uint32_t budget = UINT32_MAX;
    auvid_metric_measure_begin(m, pi, (auvid_real_t)delay_s);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_measure(m, &budget));
    return (double)m->result.sse[AUVID_SURGE];
}

/* The same with `more` added to parameter i. */
static double squares_beside(auvid_metric_t *m, const auvid_real_t *pi, int i, double more,
                             double delay_s)
{
    auvid_real_t moved[AUVID_MAX_PARAMETERS];
    memcpy(moved, pi, sizeof moved);
    moved[i] += (auvid_real_t)more;
    return squares_of(m, moved, delay_s);
}

/* Linearise in pieces of the budget. @return units used */
static uint32_t linearise(const auvid_real_t *pi, double delay_s, uint8_t sets, uint32_t piece)
{
    uint32_t used = 0;
    auvid_status_t status;
    auvid_metric_linearise_begin(&metric, pi, (auvid_real_t)delay_s, sets);
    do {
        uint32_t budget = piece;
        status = auvid_metric_linearise(&metric, &windows, &budget);
        used += piece - budget;
        TEST_ASSERT_TRUE(status == AUVID_OK || (status == AUVID_PENDING && budget == 0));
    } while (status == AUVID_PENDING);
    return used;
}

static void assess(const auvid_real_t *pi)
{
    uint32_t budget = UINT32_MAX;
    auvid_confidence_begin(&job, &metric, pi, 0, NULL);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_confidence_work(&job, &metric, &budget));
}

static void change_test(void)
{
    uint32_t budget = UINT32_MAX;
    auvid_metric_change_begin(&metric, &change, 0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_change(&metric, &change, &budget));
}

/* Rows of Girona500 in which the confidence finds no acceleration, hence no noise of one. */
static void rows_without_noise(const void *context, const auvid_sample_t *s, const auvid_real_t *pi,
                               auvid_regressor_t *y)
{
    if (s->t_us != 0) {
        auvid_girona500.regressor(context, s, pi, y);
    }
}

/* Merge with equal weights of the bands. */
static void merge_unweighted(auvid_metric_t *m)
{
    auvid_metric_merge_begin(m);
    for (auvid_status_t status = AUVID_PENDING; status == AUVID_PENDING;) {
        uint32_t unit = 1;
        status = auvid_metric_merge(m, &unit);
        if (m->evaluator.at.pass == PASS_RESIDUAL) {
            auvid_metric_restart_pass(m, PASS_ADDED);
        }
    }
}

/* Both paths have the same rows: with two equal cells a row, their mean is one of them, which is
 * what a filter of three cells of order 2 passes. The regressor path takes rows in pairs, so the
 * first and the last row count half. */
static void test_a_linear_model_has_the_standard_errors_that_its_regressor_gives(void)
{
    double sigma[2][13];
    for (int path = 0; path < 2; ++path) {
        setUp();
        auvid_vehicle_t linear = auvid_girona500;
        linear.regressor = rows_without_noise;
        cfg.vehicle = &linear;
        cfg.half_width[0] = cfg.half_width[1] = 1;
        cfg.passes = 1;
        cfg.estimate_delay = false;
        cfg.cell_us = 1000000;
        cfg.row_cells = 2;
        cfg.sets = 1;
        cfg.set_rows = 480;
        if (path == 1) {
            use_residual_path(cfg.row_cells, cfg.set_rows);
        }
        start();
        world_t w = world_of(&cfg);
        auvid_sample_t s;
        for (uint64_t k = 0; metric.sets.recorded == 0; ++k) {
            if (k % 2 == 0) {
                s = cell_at(&w, 0.25 * (double)k);
                add_noise(&s, 5);
            }
            s.t_us = 1000000u * (k + 1u);
            TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
        }
        merge_unweighted(&metric);
        TEST_ASSERT_EQUAL(1, metric.layout.window_length);
        (void)squares_of(&metric, truth, 0);
        (void)linearise(truth, 0, cfg.sets, UINT32_MAX);
        assess(truth);
        for (int i = 0; i < 13; ++i) {
            sigma[path][i] = (double)result->sigma[i];
        }
    }
    for (int i = 0; i < 13; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(0.02 * sigma[0][i], sigma[0][i], sigma[1][i]);
    }
}

static void test_the_models_own_derivatives_take_the_place_of_differences(void)
{
    double sigma[2][13];
    uint32_t units[2];
    for (int own = 0; own < 2; ++own) {
        setUp();
        cfg.sets = 2;
        use_residual_path(5, 40);
        by_residual.regressor = own ? auvid_girona500.regressor : NULL;
        start();
        world_t w = world_of(&cfg);
        (void)feed_set(&w, feed_set(&w, 0, 5), 5);
        merge_all(&metric);
        (void)squares_of(&metric, truth, 0.03);
        units[own] = linearise(truth, 0.03, cfg.sets, 7);
        assess(truth);
        for (int i = 0; i < 13; ++i) {
            sigma[own][i] = (double)result->sigma[i];
        }
    }
    for (int i = 0; i < 13; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-2 * sigma[0][i], sigma[0][i], sigma[1][i]);
    }
    TEST_ASSERT_TRUE(3 * units[1] < units[0]);
}

/* With rows of half a second every window is linearised. Windows reach across the borders of sets.
 * They do not reach across a gap nor, in an equation that reads yaw, across a missing yaw rate. */
static void test_the_rms_residual_is_that_of_the_measurement(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS];
    double windows[AUVID_DOF_COUNT];
    cfg.sets = 3;
    cfg.free = 0;
    use_residual_path(5, 40);
    start();
    world_t w = world_of(&cfg);
    double t = feed_set(&w, 0, 0);
    feed(&metric, &w, t, cells_of(&cfg, 20));
    auvid_metric_gap(&metric);
    t = feed_set(&w, t + 100, 0);
    auvid_sample_t guess = cell_at(&w, t);
    guess.nu[AUVID_YAW] = AUVID_C(1e10);
    guess.missing = 1u << AUVID_YAW;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_add(&metric, &guess));
    (void)feed_set(&w, t + w.cell_s, 0);
    merge_all(&metric);
    memcpy(pi, truth, sizeof pi);
    for (int i = AUVID_G500_X_0; i <= AUVID_G500_N_0; ++i) {
        pi[i] = 1000; /* a residual of -1000 everywhere, and little else */
    }
    (void)squares_of(&metric, pi, 0);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        windows[j] = round((double)metric.result.sse[j] / 1e6);
        TEST_ASSERT_DOUBLE_WITHIN(0.01, windows[j], (double)metric.result.sse[j] / 1e6);
    }
    TEST_ASSERT_TRUE(windows[AUVID_YAW] < windows[AUVID_HEAVE]);
    for (int i = 0; i < N; ++i) {
        pi[i] = AUVID_C(0.8) * truth[i];
    }
    (void)squares_of(&metric, pi, 0.13);
    (void)linearise(truth, 0, cfg.sets, UINT32_MAX);
    (void)linearise(pi, 0.13, cfg.sets, UINT32_MAX);
    TEST_ASSERT_EQUAL_DOUBLE(0, (double)metric.result.constant);
    assess(pi);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        double rms = windows[j] > 0 ? sqrt((double)metric.result.sse[j] / windows[j]) : 0;
        TEST_ASSERT_EQUAL(auvid_girona500.columns[j] != 0, rms > 0.1);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3 * rms, rms, (double)result->residual_rms[j]);
    }
}

/* 31 rows of 0.2 s are smoothed at once, with a standard deviation of 2.7 rows. The model is called
 * at each row, and at those before the newest set that its windows contain. */
static void test_linearising_takes_the_units_that_the_header_says(void)
{
    enum { WORK = 3, WINDOW = 31, ROWS = 120, EACH = WORK * (2 * N + 3) };
    cfg.sets = 2;
    cfg.free = 0;
    use_residual_path(2, ROWS);
    by_residual.work = WORK;
    start();
    world_t w = world_of(&cfg);
    (void)feed_set(&w, feed_set(&w, 0, 0), 0);
    merge_all(&metric);
    uint32_t used = linearise(truth, 0, 1, UINT32_MAX);
    TEST_ASSERT_EQUAL_UINT32(EACH * (ROWS + WINDOW - 1), used);
    TEST_ASSERT_DOUBLE_WITHIN(1.0, sqrt(WINDOW - 1) / 2,
                              (double)ROWS / auvid_metric_newest(&metric)->windows[AUVID_SURGE]);
    used = linearise(truth, 0, 2, UINT32_MAX); /* and the merge: by rows, and by DoF */
    uint32_t merge = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        int n = auvid_metric_order(&metric, j);
        merge += n > 0 ? 4u * 2u * 2u * (uint32_t)n + 20u : 0u;
    }
    TEST_ASSERT_EQUAL_UINT32(merge + EACH * 2 * ROWS, used);
    TEST_ASSERT_EQUAL_UINT32(used, linearise(truth, 0, UINT8_MAX, UINT32_MAX));
    by_residual.regressor = auvid_girona500.regressor; /* the residual, its own cost, two delays */
    by_residual.regressor_work = 7;
    TEST_ASSERT_EQUAL_UINT32(merge + (3 * WORK + 7) * 2 * ROWS, linearise(truth, 0, 2, UINT32_MAX));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_drop(&metric, 0));
    by_residual.regressor = NULL;
    TEST_ASSERT_EQUAL_UINT32(EACH * (WINDOW - 1), linearise(truth, 0, 1, UINT32_MAX));
}

static void test_any_split_of_the_budget_linearises_to_the_same_bits(void)
{
    static const uint32_t piece[] = {UINT32_MAX, 1, 7, 1000};
    static auvid_confidence_t all;
    uint32_t used = 0;
    cfg.sets = 2;
    use_residual_path(5, 30);
    by_residual.work = 2;
    start();
    world_t w = world_of(&cfg);
    (void)feed_set(&w, feed_set(&w, 0, 5), 5);
    merge_all(&metric);
    (void)squares_of(&metric, truth, 0.1);
    before = metric;
    for (size_t k = 0; k < sizeof piece / sizeof piece[0]; ++k) {
        metric = before;
        if (k > 0) { /* begun at another point, and then begun again */
            uint32_t few = 99;
            auvid_metric_linearise_begin(&metric, truth, 0, 1);
            TEST_ASSERT_EQUAL(AUVID_PENDING, auvid_metric_linearise(&metric, &windows, &few));
        }
        uint32_t units = linearise(truth, 0.1, cfg.sets, piece[k]);
        used = k == 0 ? units : used;
        TEST_ASSERT_EQUAL_UINT32(used, units);
        assess(truth);
        all = k == 0 ? *result : all;
        TEST_ASSERT_EQUAL_MEMORY(all.sigma, result->sigma, sizeof all.sigma);
        TEST_ASSERT_EQUAL_MEMORY(all.residual_rms, result->residual_rms, sizeof all.residual_rms);
    }
}

/* Rows from outside that are discarded the first time. */
static auvid_status_t discard_once(auvid_metric_t *m, uint32_t *budget)
{
    int *left = m->prior_context;
    (void)budget;
    if (*left == 0) {
        return AUVID_OK;
    }
    --*left;
    auvid_metric_restart_pass(m, PASS_LAST);
    return AUVID_EMPTY;
}

static void test_it_tells_that_a_prior_was_discarded(void)
{
    static const auvid_metric_prior_t prior = {.add_rows = discard_once};
    uint32_t budget = UINT32_MAX;
    int left = 1;
    use_residual_path(5, 30);
    start();
    world_t w = world_of(&cfg);
    (void)feed_set(&w, 0, 5);
    merge_all(&metric);
    (void)squares_of(&metric, truth, 0.1);
    metric.prior = &prior;
    metric.prior_context = &left;
    auvid_metric_linearise_begin(&metric, truth, 0, cfg.sets);
    TEST_ASSERT_EQUAL(AUVID_EMPTY, auvid_metric_linearise(&metric, &windows, &budget));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_linearise(&metric, &windows, &budget));
    TEST_ASSERT_EQUAL(0, left);
}

/* ---- the points at which the model is called ---- */

enum { POINTS = 5, NEWTONS_PER_S = 100 };

/* Smallest and largest value of each parameter, and of the delay of the wrench [s]. */
static double seen[POINTS + 1][2];

static void note(int i, double value)
{
    seen[i][0] = fmin(seen[i][0], value);
    seen[i][1] = fmax(seen[i][1], value);
}

static void observing_residual(const void *context, const auvid_sample_t *s, const auvid_real_t *pi,
                               auvid_real_t *e)
{
    (void)context;
    for (int i = 0; i < POINTS; ++i) {
        note(i, (double)pi[i]);
    }
    note(POINTS, (double)s->t_us * 1e-6 - (double)s->tau[AUVID_SURGE] / NEWTONS_PER_S);
    e[AUVID_SURGE] = pi[0] - s->tau[AUVID_SURGE];
}

/* The wrench rises steadily, so its value gives its time. */
static void test_derivatives_are_central_differences_over_the_steps_that_the_header_says(void)
{
    static const auvid_real_t point[AUVID_MAX_PARAMETERS] = {200, -0.5, AUVID_C(1e-3), 0, 7};
    static const double step[POINTS] = {2, 5e-3, 1e-4, 1e-3, 0}; /* the last one is fixed */
    static const auvid_parameter_t parameter[POINTS] = {{"a", "?", AUVID_SURGE, 0},
                                                        {"b", "?", AUVID_SURGE, 0},
                                                        {"c", "?", AUVID_SURGE, 0},
                                                        {"d", "?", AUVID_SURGE, 0},
                                                        {"e", "?", AUVID_SURGE, 0}};
    static auvid_vehicle_t vehicle;
    vehicle = (auvid_vehicle_t){.built_for = AUVID_BUILD,
                                .path = &auvid_path_residual,
                                .name = "spy",
                                .parameters = POINTS,
                                .parameter = parameter,
                                .columns = {31u},
                                .residual = observing_residual};
    auvid_metric_defaults(&cfg, &vehicle);
    cfg.sets = 1;
    cfg.set_rows = 20;
    cfg.rows = store;
    cfg.row_slots = sizeof store / sizeof store[0];
    cfg.free = 15u;
    cfg.fixed[4] = 7;
    start();
    for (uint64_t k = 1; metric.sets.recorded == 0; ++k) {
        auvid_sample_t s;
        memset(&s, 0, sizeof s);
        s.t_us = k * cfg.cell_us;
        s.tau[AUVID_SURGE] = (auvid_real_t)(NEWTONS_PER_S * 1e-6 * (double)s.t_us);
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
    }
    merge_all(&metric);
    for (int i = 0; i <= POINTS; ++i) {
        seen[i][0] = INFINITY;
        seen[i][1] = -INFINITY;
    }
    (void)linearise(point, 0.2, cfg.sets, UINT32_MAX);
    for (int i = 0; i < POINTS; ++i) {
        double middle = (double)point[i], off = 1e-6 * fabs(middle) + 0.01 * step[i];
        TEST_ASSERT_DOUBLE_WITHIN(off, middle - step[i] / 2, seen[i][0]);
        TEST_ASSERT_DOUBLE_WITHIN(off, middle + step[i] / 2, seen[i][1]);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.2 - 0.01 / 2, seen[POINTS][0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.2 + 0.01 / 2, seen[POINTS][1]);
}

/* ---- use of the linear model ---- */

/* The part of surge that no X_u explains, in the sets whose age has its bit set. */
static double unexplained(uint32_t ages, double delay_s)
{
    before = metric;
    for (uint8_t age = 0; age < 3; ++age) {
        if ((ages >> age & 1u) == 0) {
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_drop(&before, age));
        }
    }
    merge_all(&before);
    double h = 0.5 * (double)truth[AUVID_G500_X_U];
    double here = squares_of(&before, truth, delay_s);
    double up = squares_beside(&before, truth, AUVID_G500_X_U, h, delay_s);
    double down = squares_beside(&before, truth, AUVID_G500_X_U, -h, delay_s);
    double slope = (up - down) / 2, bend = (up + down) / 2 - here;
    return here - slope * slope / (4 * bend);
}

/* Gaps between the sets prevent residuals that span two of them. The newest set is linearised
 * separately, as in the identifier, at other values than the rest. */
static void test_change_is_the_pooled_minus_the_separate_sum_of_squares(void)
{
    const double delay_s = 0.13;
    auvid_real_t changed[AUVID_MAX_PARAMETERS], pi[AUVID_MAX_PARAMETERS];
    memcpy(changed, truth, sizeof changed);
    changed[AUVID_G500_X_U] *= AUVID_C(1.5);
    cfg.sets = 3;
    cfg.free = 1u << AUVID_G500_X_U;
    memcpy(cfg.fixed, truth, sizeof cfg.fixed);
    use_residual_path(5, 60);
    start();
    world_t w = world_of(&cfg);
    double t = 0;
    for (int set = 0; set < 3; ++set) {
        w.pi = set == 2 ? changed : truth;
        t = feed_set(&w, t, 2) + 50;
        auvid_metric_gap(&metric);
    }
    merge_all(&metric);
    memcpy(pi, truth, sizeof pi);
    (void)linearise(pi, delay_s, 3, UINT32_MAX);
    pi[AUVID_G500_X_U] *= AUVID_C(0.5);
    (void)linearise(pi, delay_s, 1, UINT32_MAX);
    change_test();
    double all = unexplained(7, delay_s);
    double one = all - unexplained(6, delay_s) - unexplained(1, delay_s);
    double two = all - unexplained(4, delay_s) - unexplained(3, delay_s);
    TEST_ASSERT_TRUE(one > 0.1 * all && two > 0.02 * all);
    TEST_ASSERT_DOUBLE_WITHIN(2e-3 * all, one, (double)change.change[0][AUVID_SURGE]);
    TEST_ASSERT_DOUBLE_WITHIN(2e-3 * all, two, (double)change.change[1][AUVID_SURGE]);
    TEST_ASSERT_EQUAL_UINT8(1, change.rank[AUVID_SURGE]);
    TEST_ASSERT_EQUAL_UINT8(0, change.rank[AUVID_SWAY]);
}

/* With the sum of squares S of parameter p and delay d: the variance of p rises by
 * 1 / (1 - S_pd^2 / (S_pp S_dd)) when d is estimated, too. */
static void test_an_estimated_delay_widens_the_standard_error_as_the_costs_curvature_says(void)
{
    enum { P = AUVID_G500_X_U };
    const double delay_s = 0.15, h = 0.2 * (double)truth[P], k = 0.03;
    double sigma[2], bend[3] = {0};
    for (int estimated = 0; estimated < 2; ++estimated) {
        setUp();
        cfg.sets = 1;
        cfg.free = 1u << P;
        memcpy(cfg.fixed, truth, sizeof cfg.fixed);
        cfg.estimate_delay = estimated == 1;
        use_residual_path(5, 240);
        start();
        world_t w = world_of(&cfg);
        w.shift_s = delay_s;
        (void)feed_set(&w, 0, 0.5);
        merge_all(&metric);
        (void)squares_of(&metric, truth, delay_s);
        (void)linearise(truth, delay_s, cfg.sets, UINT32_MAX);
        assess(truth);
        sigma[estimated] = (double)result->sigma[P];
    }
    double here = squares_of(&metric, truth, delay_s);
    for (int sign = -1; sign <= 1; sign += 2) {
        bend[0] += (squares_beside(&metric, truth, P, sign * h, delay_s) - here) / (h * h);
        bend[1] += (squares_of(&metric, truth, delay_s + sign * k) - here) / (k * k);
        bend[2] += sign *
                   (squares_beside(&metric, truth, P, h, delay_s + sign * k) -
                    squares_beside(&metric, truth, P, -h, delay_s + sign * k)) /
                   (4 * h * k);
    }
    double widening = sqrt(1 / (1 - bend[2] * bend[2] / (bend[0] * bend[1])));
    TEST_ASSERT_TRUE(widening > 1.1);
    TEST_ASSERT_DOUBLE_WITHIN(2e-3 * widening, widening, sigma[1] / sigma[0]);
}

/* ---- windows that are left out ---- */

/* The derivative of the model's residual, and the time from which and to which it fails. */
static auvid_real_t steepness;
static uint64_t fails_us[2];

static void steep(const void *context, const auvid_sample_t *s, const auvid_real_t *pi,
                  auvid_real_t *e)
{
    (void)context;
    bool fails = s->t_us >= fails_us[0] && s->t_us < fails_us[1];
    e[AUVID_SURGE] = fails ? (auvid_real_t)NAN : steepness * pi[0] - s->tau[AUVID_SURGE];
}

/* Three sets of the steep model, linearised and tested for a change. @return time after them [s] */
static double change_test_steep(void)
{
    static const auvid_parameter_t parameter = {"k", "?", AUVID_SURGE, AUVID_PARAMETER_OTHER};
    static auvid_vehicle_t vehicle;
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0};
    vehicle = (auvid_vehicle_t){.built_for = AUVID_BUILD,
                                .path = &auvid_path_residual,
                                .name = "steep",
                                .parameters = 1,
                                .parameter = &parameter,
                                .columns = {1u},
                                .residual = steep};
    auvid_metric_defaults(&cfg, &vehicle);
    cfg.sets = 3;
    cfg.set_rows = 40;
    cfg.rows = store;
    cfg.row_slots = sizeof store / sizeof store[0];
    start();
    world_t w = world_of(&cfg);
    double t = feed_set(&w, feed_set(&w, feed_set(&w, 0, 0), 0), 0);
    merge_all(&metric);
    (void)squares_of(&metric, pi, 0);
    (void)linearise(pi, 0, cfg.sets, UINT32_MAX);
    change_test();
    TEST_ASSERT_TRUE(isfinite((double)change.change[0][AUVID_SURGE]));
    assess(pi);
    TEST_ASSERT_TRUE(isfinite((double)result->residual_rms[AUVID_SURGE]));
    return t;
}

static void test_windows_with_derivatives_beyond_1e15_are_left_out(void)
{
    static const auvid_real_t steeper[] = {AUVID_C(1.1e15), AUVID_C(-1.1e15), AUVID_C(1e17)};
    memset(fails_us, 0, sizeof fails_us);
    for (size_t k = 0; k < sizeof steeper / sizeof steeper[0]; ++k) {
        steepness = steeper[k];
        (void)change_test_steep();
        TEST_ASSERT_EQUAL_UINT8(0, change.rank[AUVID_SURGE]);
        TEST_ASSERT_EQUAL_DOUBLE(0, (double)result->residual_rms[AUVID_SURGE]);
    }
    steepness = AUVID_C(0.9e15);
    (void)change_test_steep();
    TEST_ASSERT_EQUAL_UINT8(1, change.rank[AUVID_SURGE]);
}

static void test_windows_in_which_the_model_fails_are_left_out(void)
{
    steepness = 1;
    memset(fails_us, 0, sizeof fails_us);
    double t = change_test_steep(), whole = (double)result->residual_rms[AUVID_SURGE];
    TEST_ASSERT_TRUE(whole > 1);
    fails_us[0] = (uint64_t)(1e6 * (t - 3)) + 1000000000u;
    fails_us[1] = UINT64_MAX;
    (void)change_test_steep();
    TEST_ASSERT_EQUAL_UINT8(1, change.rank[AUVID_SURGE]);
    TEST_ASSERT_DOUBLE_WITHIN(0.2 * whole, whole, (double)result->residual_rms[AUVID_SURGE]);
    fails_us[0] = 0;
    (void)change_test_steep();
    TEST_ASSERT_EQUAL_UINT8(0, change.rank[AUVID_SURGE]);
}

/* ---- refusals ---- */

static void test_nothing_is_done_for_a_model_with_regressor_or_without_an_argument(void)
{
    uint32_t budget = 1000;
    start();
    world_t w = world_of(&cfg);
    (void)feed_set(&w, 0, 0);
    merge_all(&metric);
    before = metric;
    auvid_metric_linearise_begin(&metric, truth, 0, 1);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_linearise(&metric, &windows, &budget));
    TEST_ASSERT_EQUAL_UINT32(1000, budget);
    TEST_ASSERT_EQUAL_MEMORY(&before, &metric, sizeof before);
    use_residual_path(5, 40);
    start();
    before = metric;
    auvid_metric_linearise_begin(NULL, truth, 0, 1);
    auvid_metric_linearise_begin(&metric, NULL, 0, 1);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_linearise(NULL, &windows, &budget));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_linearise(&metric, NULL, &budget));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_linearise(&metric, &windows, NULL));
    TEST_ASSERT_EQUAL_MEMORY(&before, &metric, sizeof before);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_models_own_derivatives_take_the_place_of_differences);
    RUN_TEST(test_a_linear_model_has_the_standard_errors_that_its_regressor_gives);
    RUN_TEST(test_the_rms_residual_is_that_of_the_measurement);
    RUN_TEST(test_linearising_takes_the_units_that_the_header_says);
    RUN_TEST(test_any_split_of_the_budget_linearises_to_the_same_bits);
    RUN_TEST(test_it_tells_that_a_prior_was_discarded);
    RUN_TEST(test_derivatives_are_central_differences_over_the_steps_that_the_header_says);
    RUN_TEST(test_change_is_the_pooled_minus_the_separate_sum_of_squares);
    RUN_TEST(test_an_estimated_delay_widens_the_standard_error_as_the_costs_curvature_says);
    RUN_TEST(test_windows_with_derivatives_beyond_1e15_are_left_out);
    RUN_TEST(test_windows_in_which_the_model_fails_are_left_out);
    RUN_TEST(test_nothing_is_done_for_a_model_with_regressor_or_without_an_argument);
    return UNITY_END();
}
