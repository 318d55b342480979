/* Coordinate line search, without the global phase. */
#include <math.h>
#include <string.h>

#include "auvid/detail/optimizer.h"
#include "finish.h"
#include "unity.h"

typedef auvid_real_t (*cost_t)(const auvid_real_t *);

static auvid_optimizer_t optimizer;
static auvid_line_search_t *const ls = &optimizer.line_search;
static auvid_search_config_t cfg;
static auvid_real_t scale[AUVID_MAX_PARAMETERS];
static auvid_real_t theta[AUVID_MAX_PARAMETERS];

static void box(uint8_t n, auvid_real_t half)
{
    auvid_search_defaults(&cfg, n);
    cfg.phases = AUVID_SEARCH_LOCAL;
    cfg.has_good = true;
    memset(scale, 0, sizeof scale);
    for (int i = 0; i < n; ++i) {
        cfg.lower[i] = -half;
        cfg.upper[i] = half;
    }
}

void setUp(void)
{
    memset(&optimizer, 0, sizeof optimizer);
    box(4, AUVID_C(8.0));
}

void tearDown(void)
{
}

/* J = |A x - b|^2 with A = I + lower diagonal k; a larger k couples the parameters more */
static auvid_real_t chain(const auvid_real_t *x, auvid_real_t k)
{
    auvid_real_t sum = 0;
    for (int i = 0; i < cfg.n; ++i) {
        auvid_real_t e = x[i] - 1 + (i > 0 ? k * x[i - 1] : 0);
        sum += e * e;
    }
    return sum;
}

static auvid_real_t coupled(const auvid_real_t *x)
{
    return chain(x, AUVID_C(0.5));
}

static auvid_real_t strongly_coupled(const auvid_real_t *x)
{
    return chain(x, AUVID_C(1.25));
}

static auvid_real_t absolute(const auvid_real_t *x)
{
    auvid_real_t sum = 0;
    for (int i = 0; i < cfg.n; ++i) {
        auvid_real_t e = x[i] - AUVID_C(0.3) * (auvid_real_t)(i + 1);
        sum += e < 0 ? -e : e;
    }
    return sum;
}

/* flat within +-0.5 of the optimum with a kink at the edge, like a dead band */
static auvid_real_t dead_band(const auvid_real_t *x)
{
    auvid_real_t sum = 0;
    for (int i = 0; i < cfg.n; ++i) {
        auvid_real_t e = (x[i] < 0 ? -x[i] : x[i]) - AUVID_C(0.5);
        sum += e > 0 ? e * e + e : 0;
    }
    return sum;
}

static auvid_real_t rosenbrock(const auvid_real_t *x)
{
    auvid_real_t a = x[1] - x[0] * x[0], b = 1 - x[0];
    return 100 * a * a + b * b;
}

static auvid_real_t corner(const auvid_real_t *x)
{
    auvid_real_t sum = 0;
    for (int i = 0; i < cfg.n; ++i) {
        sum += (auvid_real_t)(i + 1) * (cfg.upper[i] - x[i]);
    }
    return sum;
}

/* the free minimum lies outside the box in x0 and the parameters are coupled */
static auvid_real_t edge(const auvid_real_t *x)
{
    auvid_real_t a = x[0] - 12, b = x[1] - AUVID_C(0.25) * x[0];
    return a * a + b * b + x[2] * x[2] + x[3] * x[3];
}

static auvid_real_t plateau(const auvid_real_t *x)
{
    (void)x;
    return 3;
}

static auvid_real_t fails(const auvid_real_t *x)
{
    (void)x;
    return (auvid_real_t)NAN;
}

static auvid_real_t fails_beyond(const auvid_real_t *x)
{
    return x[0] > AUVID_C(1.5) ? (auvid_real_t)NAN
                               : (x[1] > AUVID_C(1.5) ? (auvid_real_t)-INFINITY : coupled(x));
}

static void init(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_optimizer_init(&optimizer, &cfg, scale));
}

static auvid_status_t run(cost_t cost)
{
    auvid_real_t best = 0, last = AUVID_LARGEST;
    for (uint32_t k = 0; k < 40u * optimizer.cfg.max_evaluations_line + 10000u; ++k) {
        auvid_status_t status = auvid_optimizer_ask(&optimizer, theta);
        if (status == AUVID_OK) {
            for (int i = 0; i < cfg.n; ++i) {
                TEST_ASSERT_TRUE(theta[i] >= cfg.lower[i] && theta[i] <= cfg.upper[i]);
            }
            TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_optimizer_tell(&optimizer, cost(theta)));
            TEST_ASSERT_NOT_NULL(auvid_optimizer_best(&optimizer, &best));
            TEST_ASSERT_TRUE(best <= last);
            last = best;
        } else if (status != AUVID_PENDING) {
            return status;
        }
    }
    TEST_FAIL_MESSAGE("the search did not end");
    return AUVID_OK;
}

static void near(const double *expected, double tolerance)
{
    for (int i = 0; i < cfg.n; ++i) {
        TEST_ASSERT_TRUE(fabs((double)auvid_optimizer_best(&optimizer, NULL)[i] - expected[i]) <=
                         tolerance);
    }
}

static void refuse(auvid_status_t expected)
{
    auvid_optimizer_t before;
    memset(&optimizer, 0x5a, sizeof optimizer);
    memcpy(&before, &optimizer, sizeof before);
    TEST_ASSERT_EQUAL_INT(expected, auvid_optimizer_init(&optimizer, &cfg, scale));
    TEST_ASSERT_EQUAL_INT(0, memcmp(&before, &optimizer, sizeof before));
    setUp();
}

static void test_init_names_what_is_wrong_and_changes_nothing(void)
{

    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_optimizer_init(NULL, &cfg, scale));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_optimizer_init(&optimizer, NULL, scale));
    cfg.n = 0;
    refuse(AUVID_ERR_PARAMETERS);
    cfg.n = AUVID_MAX_PARAMETERS + 1;
    refuse(AUVID_ERR_PARAMETERS);
    cfg.sigma = (auvid_real_t)NAN;
    refuse(AUVID_ERR_NOT_FINITE);
    scale[2] = (auvid_real_t)INFINITY;
    refuse(AUVID_ERR_NOT_FINITE);
    cfg.lower[0] = cfg.upper[0];
    refuse(AUVID_ERR_BOUNDS);
    auvid_real_t *const fields[] = {&cfg.epsilon_line, &cfg.epsilon_line, &cfg.alpha0, &cfg.alpha0,
                                    &cfg.sigma,        &cfg.sigma,        &cfg.delta,  &cfg.delta,
                                    &cfg.gamma,        &cfg.gamma,        &scale[1]};
    const auvid_real_t values[] = {-1, AUVID_C(1.1e-3), AUVID_C(3e-6), 1001, -1, 1, 1, 101, 1, -1,
                                   -1};
    for (size_t k = 0; k < sizeof values / sizeof *values; ++k) {
        *fields[k] = values[k];
        refuse(AUVID_ERR_RANGE);
    }
}

static void test_zeros_of_the_configuration_mean_what_the_header_says(void)
{
    init();
    TEST_ASSERT_TRUE(optimizer.cfg.alpha0 == AUVID_C(0.35) &&
                     optimizer.cfg.sigma == AUVID_C(0.09) &&
                     optimizer.cfg.epsilon_line == AUVID_C(3e-6) && optimizer.scale[0] == 8);
    cfg.paper = true;
    init();
    TEST_ASSERT_TRUE(optimizer.cfg.alpha0 == AUVID_C(0.05) && optimizer.cfg.sigma == AUVID_C(0.5) &&
                     optimizer.cfg.epsilon_line == AUVID_C(3e-5));
}

static void test_calls_out_of_order_are_refused(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_optimizer_ask(&optimizer, theta));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_optimizer_tell(&optimizer, 1));
    TEST_ASSERT_NULL(auvid_optimizer_best(&optimizer, NULL));
    init();
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_optimizer_tell(&optimizer, 1));
    TEST_ASSERT_NULL(auvid_optimizer_best(&optimizer, NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_optimizer_ask(&optimizer, NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_optimizer_ask(NULL, theta));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_optimizer_tell(NULL, 1));
}

/* Algorithm 2 as printed, line by line; it records the points that it evaluates. Steps are
 * powers of two and the box is far away, so both sides compute without rounding. */
static int algorithm_2(cost_t cost, auvid_real_t *visited, int max_points)
{
    enum { N = 4 };
    auvid_real_t y[N] = {0}, x[N], step[2 * N], trial[N];
    int count = 0;
    for (int i = 0; i < 2 * N; ++i) {
        step[i] = AUVID_C(0.5);
    }
    memcpy(visited, y, sizeof y);
    ++count;
    for (;;) {
        auvid_real_t longest = 0;
        for (int i = 0; i < 2 * N; ++i) {
            longest = step[i] > longest ? step[i] : longest;
        }
        if (longest <= AUVID_C(0.0009765625)) {
            return count;
        }
        memcpy(x, y, sizeof x);
        for (int i = 0; i < 2 * N; ++i) {
            auvid_real_t sign = i < N ? 1 : -1, a = step[i], taken = 0;
            for (;;) {
                memcpy(trial, y, sizeof trial);
                trial[i % N] += sign * a;
                if (count < max_points) {
                    memcpy(visited + N * count++, trial, sizeof trial);
                }
                auvid_real_t j = cost(trial);
                if (!(j <= cost(y) - AUVID_C(0.25) * a * a && j < cost(x))) {
                    break;
                }
                taken = a;
                memcpy(x, trial, sizeof x);
                a = 2 * a;
            }
            step[i] = taken > 0 ? taken : AUVID_C(0.5) * step[i];
            y[i % N] += sign * taken;
        }
    }
}

static void test_paper_asks_for_the_points_of_algorithm_2(void)
{
    static auvid_real_t visited[4 * 2000];
    const cost_t costs[] = {coupled, absolute, dead_band};
    for (size_t c = 0; c < 3; ++c) {
        box(4, AUVID_C(1024.0));
        cfg.paper = true;
        cfg.restarts = 0;
        cfg.alpha0 = AUVID_C(0.5);
        cfg.gamma = AUVID_C(0.25);
        cfg.epsilon_line = AUVID_C(0.0009765625);
        for (int i = 0; i < 4; ++i) {
            scale[i] = 1;
        }
        int count = algorithm_2(costs[c], visited, 2000), k = 0;
        init();
        while (auvid_optimizer_ask(&optimizer, theta) == AUVID_OK) {
            TEST_ASSERT_TRUE(k < count);
            TEST_ASSERT_EQUAL_INT(0, memcmp(theta, visited + 4 * k++, 4 * sizeof *theta));
            auvid_optimizer_tell(&optimizer, costs[c](theta));
        }
        TEST_ASSERT_EQUAL_INT(count, k);
        TEST_ASSERT_TRUE(count > 60);
    }
}

static void test_it_finds_the_optimum_of_coupled_quadratics(void)
{
    const double optimum[4] = {1.0, 0.5, 0.75, 0.625};
    for (int literal = 0; literal < 2; ++literal) {
        cfg.paper = literal != 0;
        init();
        TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, run(coupled));
        near(optimum, 1e-3);
    }
}

static void test_pattern_step_and_parabola_save_evaluations_if_parameters_are_coupled(void)
{
    const double optimum[4] = {1.0, -0.25, 1.3125, -0.640625};
    init();
    TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, run(strongly_coupled));
    near(optimum, 1e-4);
    uint32_t accelerated = optimizer.work.line_search;
    cfg.paper = true;
    init();
    TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, run(strongly_coupled));
    near(optimum, 1e-2);
    TEST_ASSERT_TRUE(2 * accelerated < optimizer.work.line_search);
}

/* n^2 / 2 + 5 n for the largest n, with the same coupling: the bound of auvid_line_search.c. */
static void test_a_quadratic_is_at_its_minimum_after_one_sweep(void)
{
    const uint8_t sizes[] = {1, 2, 6, AUVID_MAX_PARAMETERS};
    for (int s = 0; s < 4; ++s) {
        auvid_real_t cost = 0;
        box(sizes[s], 64);
        init();
        for (int k = 0; k < sizes[s] * sizes[s] / 2 + 5 * sizes[s];) {
            if (auvid_optimizer_ask(&optimizer, theta) == AUVID_OK) {
                auvid_optimizer_tell(&optimizer, chain(theta, AUVID_C(0.8)));
                ++k;
            }
        }
        (void)auvid_optimizer_best(&optimizer, &cost);
        TEST_ASSERT_TRUE(cost <= AUVID_C(1e-5) * (auvid_real_t)sizes[s]);
    }
}

static void test_directions_stay_valid_for_any_cost(void)
{
    const cost_t costs[] = {absolute, dead_band, fails_beyond, corner, edge};
    for (int c = 0; c < 5; ++c) {
        init();
        TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, run(costs[c]));
        for (int k = 0; k < 6; ++k) {
            TEST_ASSERT_TRUE(fabs((double)ls->shear[k]) <= 1e6);
        }
    }
}

static void test_it_finds_the_optimum_of_costs_with_kinks(void)
{
    const double optimum[4] = {0.3, 0.6, 0.9, 1.2};
    for (int literal = 0; literal < 2; ++literal) {
        cfg.paper = literal != 0;
        cfg.good[0] = -6;
        cfg.good[3] = 7;
        init();
        TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, run(absolute));
        near(optimum, 8 * 3e-5);
        init();
        TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, run(dead_band));
        for (int i = 0; i < 4; ++i) {
            TEST_ASSERT_TRUE(fabs((double)ls->theta[i]) <= 0.5 + 8 * 3e-5);
        }
    }
}

static void test_it_follows_a_curved_valley(void)
{
    const double optimum[2] = {1.0, 1.0};
    box(2, 2);
    cfg.good[0] = AUVID_C(-1.2);
    cfg.good[1] = 1;
    cfg.max_evaluations_line = 20000;
    init();
    TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, run(rosenbrock));
    near(optimum, 0.02);
}

static void test_a_step_is_cut_at_the_box_so_that_a_corner_is_reached_exactly(void)
{
    for (int literal = 0; literal < 2; ++literal) {
        cfg.paper = literal != 0;
        cfg.good[1] = AUVID_C(0.1);
        cfg.good[2] = cfg.lower[2];
        init();
        TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, run(corner));
        for (int i = 0; i < 4; ++i) {
            TEST_ASSERT_TRUE(ls->theta[i] == cfg.upper[i]);
        }
        const double optimum[4] = {8.0, 2.0, 0.0, 0.0};
        init();
        TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, run(edge));
        near(optimum, 2e-3);
    }
}

static void test_units_of_the_parameters_do_not_matter(void)
{
    const auvid_real_t unit[4] = {AUVID_C(1e-6), 1, AUVID_C(1e6), AUVID_C(1e3)};
    init();
    TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, run(coupled));
    uint32_t evaluations = optimizer.work.line_search;
    for (int i = 0; i < 4; ++i) {
        cfg.lower[i] *= unit[i];
        cfg.upper[i] *= unit[i];
    }
    init();
    auvid_real_t x[4];
    auvid_status_t status;
    uint32_t turns = 0;
    while ((status = auvid_optimizer_ask(&optimizer, theta)) == AUVID_OK ||
           status == AUVID_PENDING) {
        finish_turn(&turns, 1000000);
        for (int i = 0; i < 4; ++i) {
            x[i] = theta[i] / unit[i];
        }
        if (status == AUVID_OK) {
            auvid_optimizer_tell(&optimizer, coupled(x));
        }
    }
    TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, status);
    TEST_ASSERT_TRUE(fabs((double)ls->theta[0] / 1e-6 - 1.0) < 1e-3);
    TEST_ASSERT_TRUE(fabs((double)ls->theta[3] / 1e3 - 0.625) < 1e-3);
    TEST_ASSERT_TRUE(optimizer.work.line_search < 2 * evaluations);
}

static void test_the_last_steps_are_no_longer_than_epsilon(void)
{
    cfg.epsilon_line = AUVID_C(1e-3);
    init();
    TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, run(coupled));
    for (int i = 0; i < 8; ++i) {
        TEST_ASSERT_TRUE(ls->alpha[i] > 0 && ls->alpha[i] <= cfg.epsilon_line);
    }
    TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, auvid_optimizer_ask(&optimizer, theta));
}

static void test_plateaus_and_failing_models_end(void)
{
    init();
    TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, run(plateau));
    init();
    TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, run(fails));
    const double optimum[4] = {1.0, 0.5, 0.75, 0.625};
    init();
    TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, run(fails_beyond));
    near(optimum, 1e-3);
}

static void test_evaluations_are_capped(void)
{
    cfg.max_evaluations_line = 17;
    init();
    TEST_ASSERT_EQUAL_INT(AUVID_EVALUATION_LIMIT, run(coupled));
    TEST_ASSERT_EQUAL_UINT32(17, optimizer.work.line_search);
    TEST_ASSERT_EQUAL_INT(AUVID_EVALUATION_LIMIT, auvid_optimizer_ask(&optimizer, theta));
}

static void test_each_restart_reduces_the_steps_again(void)
{
    for (int literal = 0; literal < 2; ++literal) {
        uint32_t evaluations[4];
        cfg.paper = literal != 0;
        for (uint8_t restarts = 0; restarts < 4; ++restarts) {
            cfg.restarts = restarts;
            init();
            TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, run(plateau));
            evaluations[restarts] = optimizer.work.line_search;
        }
        TEST_ASSERT_TRUE(evaluations[2] > evaluations[1]);
        TEST_ASSERT_EQUAL_UINT32(evaluations[2] - evaluations[1], evaluations[3] - evaluations[2]);
        TEST_ASSERT_TRUE(literal == 0 || evaluations[1] > evaluations[0]);
    }
}

/* The result of a search with this goal. */
static double best_with_goal(cost_t cost, double goal)
{
    auvid_real_t best = 0;
    init();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_optimizer_set_goal(&optimizer, (auvid_real_t)goal));
    TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, run(cost));
    TEST_ASSERT_NOT_NULL(auvid_optimizer_best(&optimizer, &best));
    return (double)best;
}

static void test_a_goal_within_reach_changes_nothing(void)
{
    static const cost_t costs[] = {coupled, strongly_coupled, absolute, dead_band};
    for (size_t k = 0; k < sizeof costs / sizeof costs[0]; ++k) {
        auvid_real_t best = 0;
        init();
        TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, run(costs[k]));
        TEST_ASSERT_NOT_NULL(auvid_optimizer_best(&optimizer, &best));
        uint32_t evaluations = optimizer.work.line_search;
        TEST_ASSERT_TRUE(best_with_goal(costs[k], 0.01) <= (double)best);
        TEST_ASSERT_EQUAL_UINT32(evaluations, optimizer.work.line_search);
    }
}

/* The least cost of the chain is 0: it gains less and less, so a goal below ends it early. */
static void test_a_goal_out_of_reach_ends_the_search_early(void)
{
    init();
    TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, run(strongly_coupled));
    uint32_t evaluations = optimizer.work.line_search;
    TEST_ASSERT_TRUE(best_with_goal(strongly_coupled, -1.0) < 0.1);
    TEST_ASSERT_TRUE(optimizer.work.line_search < evaluations * 2 / 3);
    double best = best_with_goal(plateau, 2.9);
    TEST_ASSERT_TRUE(best == 3.0);
    TEST_ASSERT_TRUE(optimizer.work.line_search <= 2u * cfg.n + 1u);
}

static void test_a_goal_that_is_refused_changes_nothing(void)
{
    auvid_optimizer_t before;
    init();
    before = optimizer;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_optimizer_set_goal(NULL, 0));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE,
                          auvid_optimizer_set_goal(&optimizer, (auvid_real_t)NAN));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE,
                          auvid_optimizer_set_goal(&optimizer, (auvid_real_t)INFINITY));
    TEST_ASSERT_EQUAL_INT(0, memcmp(&before, &optimizer, sizeof before));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_optimizer_ask(&optimizer, theta));
    before = optimizer;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_optimizer_set_goal(&optimizer, 0));
    memset(&optimizer, 0, sizeof optimizer);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_optimizer_set_goal(&optimizer, 0));
    cfg.phases = AUVID_SEARCH_BOTH;
    init();
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_optimizer_set_goal(&optimizer, 0));
}

static void test_there_is_a_goal_or_a_certificate(void)
{
    auvid_real_t at[AUVID_MAX_PARAMETERS] = {0};
    init();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_optimizer_set_goal(&optimizer, 0));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_optimizer_certify(&optimizer, at, 1, 1));
    TEST_ASSERT_TRUE(optimizer.certified && !optimizer.has_goal);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_optimizer_set_goal(&optimizer, 0));
    TEST_ASSERT_TRUE(optimizer.certified && !optimizer.has_goal);
}

static void test_a_step_without_room_is_pending(void)
{
    auvid_status_t status = AUVID_OK;
    cfg.good[0] = cfg.upper[0];
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_optimizer_init(&optimizer, &cfg, scale));
    for (int k = 0; k < 1000 && (status = auvid_optimizer_ask(&optimizer, theta)) == AUVID_OK;
         ++k) {
        auvid_optimizer_tell(&optimizer, 1);
    }
    TEST_ASSERT_EQUAL_INT(AUVID_PENDING, status);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_init_names_what_is_wrong_and_changes_nothing);
    RUN_TEST(test_zeros_of_the_configuration_mean_what_the_header_says);
    RUN_TEST(test_calls_out_of_order_are_refused);
    RUN_TEST(test_paper_asks_for_the_points_of_algorithm_2);
    RUN_TEST(test_it_finds_the_optimum_of_coupled_quadratics);
    RUN_TEST(test_pattern_step_and_parabola_save_evaluations_if_parameters_are_coupled);
    RUN_TEST(test_a_quadratic_is_at_its_minimum_after_one_sweep);
    RUN_TEST(test_directions_stay_valid_for_any_cost);
    RUN_TEST(test_it_finds_the_optimum_of_costs_with_kinks);
    RUN_TEST(test_it_follows_a_curved_valley);
    RUN_TEST(test_a_step_is_cut_at_the_box_so_that_a_corner_is_reached_exactly);
    RUN_TEST(test_units_of_the_parameters_do_not_matter);
    RUN_TEST(test_the_last_steps_are_no_longer_than_epsilon);
    RUN_TEST(test_plateaus_and_failing_models_end);
    RUN_TEST(test_evaluations_are_capped);
    RUN_TEST(test_each_restart_reduces_the_steps_again);
    RUN_TEST(test_a_goal_within_reach_changes_nothing);
    RUN_TEST(test_a_goal_out_of_reach_ends_the_search_early);
    RUN_TEST(test_a_goal_that_is_refused_changes_nothing);
    RUN_TEST(test_there_is_a_goal_or_a_certificate);
    RUN_TEST(test_a_step_without_room_is_pending);
    return UNITY_END();
}
