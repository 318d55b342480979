/* Controlled random search: Algorithm 1 to the letter, without the local phase. */
#include <math.h>
#include <string.h>

#include "auvid/detail/optimizer.h"
#include "finish.h"
#include "unity.h"

static auvid_optimizer_t optimizer;
static auvid_crs_t *const crs = &optimizer.crs;
static auvid_search_config_t cfg;
static auvid_real_t theta[AUVID_MAX_PARAMETERS];

static void box(uint8_t n, auvid_real_t half)
{
    auvid_search_defaults(&cfg, n);
    cfg.phases = AUVID_SEARCH_GLOBAL;
    cfg.paper = true;
    for (int i = 0; i < n; ++i) {
        cfg.lower[i] = -half;
        cfg.upper[i] = half;
    }
}

void setUp(void)
{
    memset(&optimizer, 0, sizeof optimizer);
    box(4, AUVID_C(10.0));
}

void tearDown(void)
{
}

static auvid_real_t sphere(const auvid_real_t *x)
{
    auvid_real_t sum = 0;
    for (int i = 0; i < cfg.n; ++i) {
        sum += (x[i] - 1) * (x[i] - 1);
    }
    return sum;
}

static auvid_real_t corner(const auvid_real_t *x)
{
    auvid_real_t sum = 0;
    for (int i = 0; i < cfg.n; ++i) {
        sum += cfg.upper[i] - x[i];
    }
    return sum;
}

static auvid_real_t plateau(const auvid_real_t *x)
{
    (void)x;
    return 7;
}

static auvid_real_t fails(const auvid_real_t *x)
{
    (void)x;
    return (auvid_real_t)NAN;
}

static auvid_real_t fails_on_one_side(const auvid_real_t *x)
{
    return x[0] > 2 ? (auvid_real_t)NAN : x[1] > 2 ? (auvid_real_t)INFINITY : sphere(x);
}

static auvid_real_t on_a_high_floor(const auvid_real_t *x)
{
    return sphere(x) + AUVID_C(1e6);
}

/* Run to the end; fails if that takes more asks than the caps allow. */
static auvid_status_t run(auvid_real_t (*cost)(const auvid_real_t *))
{
    uint64_t m = optimizer.cfg.population;
    uint64_t max_asks =
        (uint64_t)optimizer.cfg.max_evaluations_crs * (optimizer.cfg.max_rejections + 1u) + m;
    for (uint64_t k = 0; k <= max_asks + 1u; ++k) {
        auvid_status_t status = auvid_optimizer_ask(&optimizer, theta);
        if (status == AUVID_OK) {
            for (int i = 0; i < cfg.n; ++i) {
                TEST_ASSERT_TRUE(theta[i] >= cfg.lower[i] && theta[i] <= cfg.upper[i]);
            }
            TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_optimizer_tell(&optimizer, cost(theta)));
        } else if (status != AUVID_PENDING) {
            return status;
        }
    }
    TEST_FAIL_MESSAGE("the search did not end");
    return AUVID_OK;
}

static void init(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_optimizer_init(&optimizer, &cfg, NULL));
}

static void refuse(auvid_status_t expected)
{
    auvid_optimizer_t before;
    memset(&optimizer, 0x5a, sizeof optimizer);
    memcpy(&before, &optimizer, sizeof before);
    TEST_ASSERT_EQUAL_INT(expected, auvid_search_check(&cfg));
    TEST_ASSERT_EQUAL_INT(expected, auvid_optimizer_init(&optimizer, &cfg, NULL));
    TEST_ASSERT_EQUAL_INT(0, memcmp(&before, &optimizer, sizeof before));
    setUp();
}

static void test_init_names_what_is_wrong_and_changes_nothing(void)
{
    auvid_search_defaults(NULL, 3);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_optimizer_init(NULL, &cfg, NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_optimizer_init(&optimizer, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_search_check(NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_search_check(&cfg));
    cfg.n = 0;
    refuse(AUVID_ERR_PARAMETERS);
    cfg.n = AUVID_MAX_PARAMETERS + 1;
    refuse(AUVID_ERR_PARAMETERS);
    cfg.population = 4;
    refuse(AUVID_ERR_POPULATION);
    cfg.population = AUVID_MAX_POPULATION + 1;
    refuse(AUVID_ERR_POPULATION);
    cfg.epsilon_crs = (auvid_real_t)NAN;
    refuse(AUVID_ERR_NOT_FINITE);
    cfg.upper[3] = (auvid_real_t)INFINITY;
    refuse(AUVID_ERR_NOT_FINITE);
    cfg.upper[3] = cfg.lower[3];
    refuse(AUVID_ERR_BOUNDS);
    cfg.upper[3] = AUVID_C(2e18);
    refuse(AUVID_ERR_RANGE);
    cfg.epsilon_crs = -1;
    refuse(AUVID_ERR_RANGE);
    cfg.omega = AUVID_C(2e9);
    refuse(AUVID_ERR_RANGE);
    cfg.reduction = 1;
    refuse(AUVID_ERR_RANGE);
    cfg.reduction = (auvid_real_t)NAN;
    refuse(AUVID_ERR_NOT_FINITE);
}

static void test_zeros_of_the_configuration_mean_what_the_header_says(void)
{
    init();
    TEST_ASSERT_EQUAL_INT(16, optimizer.cfg.population);
    TEST_ASSERT_TRUE(optimizer.cfg.omega == 4);
    TEST_ASSERT_EQUAL_UINT32(640, optimizer.cfg.max_evaluations_crs);
    TEST_ASSERT_EQUAL_UINT32(800, optimizer.cfg.max_rejections);
    box(1, 1);
    init();
    TEST_ASSERT_EQUAL_INT(4, optimizer.cfg.population);
}

static void test_calls_out_of_order_are_refused(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_optimizer_ask(&optimizer, theta));
    TEST_ASSERT_NULL(auvid_optimizer_best(&optimizer, NULL));
    init();
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_optimizer_tell(&optimizer, 1));
    TEST_ASSERT_NULL(auvid_optimizer_best(&optimizer, NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_optimizer_ask(&optimizer, theta));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_optimizer_tell(&optimizer, 1));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_optimizer_tell(&optimizer, 1));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_optimizer_ask(NULL, theta));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_optimizer_ask(&optimizer, NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_optimizer_tell(NULL, 1));
}

static void test_asking_twice_gives_the_same_point_and_counts_once(void)
{
    auvid_real_t again[AUVID_MAX_PARAMETERS];
    init();
    for (int k = 0; k < 100; ++k) {
        if (auvid_optimizer_ask(&optimizer, theta) != AUVID_OK) {
            continue;
        }
        uint32_t attempts = optimizer.work.attempts;
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_optimizer_ask(&optimizer, again));
        TEST_ASSERT_EQUAL_INT(0, memcmp(theta, again, cfg.n * sizeof *theta));
        TEST_ASSERT_EQUAL_UINT32(attempts, optimizer.work.attempts);
        auvid_optimizer_tell(&optimizer, sphere(theta));
    }
}

static void test_a_known_point_enters_the_population_and_bad_ones_are_refused(void)
{
    const auvid_real_t good[4] = {1, 1, 1, AUVID_C(1.5)};
    auvid_real_t bad[4] = {0, 0, 0, AUVID_C(10.001)}, cost;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_optimizer_add_point(&optimizer, good));
    init();
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_optimizer_add_point(&optimizer, NULL));
    bad[3] = (auvid_real_t)NAN;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE, auvid_optimizer_add_point(&optimizer, bad));
    for (int k = 0; k < 16; ++k) {
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_optimizer_add_point(&optimizer, good));
    }
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_POPULATION, auvid_optimizer_add_point(&optimizer, good));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_optimizer_ask(&optimizer, theta));
    TEST_ASSERT_EQUAL_INT(0, memcmp(theta, good, sizeof good));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_optimizer_add_point(&optimizer, good));
    auvid_optimizer_tell(&optimizer, AUVID_C(0.25));
    TEST_ASSERT_EQUAL_INT(0, memcmp(auvid_optimizer_best(&optimizer, &cost), good, sizeof good));
    TEST_ASSERT_TRUE(cost == AUVID_C(0.25));
}

/* Lines 9-11 in double from the state before the trial. The points drawn are read from
 * the state; they must be n + 1 distinct ones. */
static void test_the_trial_is_the_weighted_reflection_of_algorithm_1(void)
{
    int trials = 0;
    uint32_t turns = 0;
    cfg.population = 20;
    cfg.epsilon_crs = AUVID_C(1e-3);
    init();
    double spread0 = 0.0;
    while (trials < 300) {
        finish_turn(&turns, 1000000);
        auvid_status_t status = auvid_optimizer_ask(&optimizer, theta);
        if (status == AUVID_FINISHED) {
            break;
        }
        double n = 4.0, low = 1e30, high = -1e30;
        for (int k = 0; k < 20; ++k) {
            low = fmin(low, (double)crs->cost[k]);
            high = fmax(high, (double)crs->cost[k]);
        }
        if (optimizer.work.crs == 20 && trials == 0) {
            spread0 = high - low;
        }
        if (optimizer.work.crs >= 20) {
            double phi = n * (high - low) * (high - low) / spread0, eta = 0.0, mean = 0.0;
            double c[4] = {0}, worst = -1e30;
            int i0 = 0, seen[20] = {0};
            for (int j = 0; j <= 4; ++j) {
                int k = crs->order[j];
                TEST_ASSERT_EQUAL_INT(0, seen[k]++);
                double w = 1.0 / ((double)crs->cost[k] - low + phi);
                eta += w;
                mean += w * (double)crs->cost[k];
                for (int i = 0; i < 4; ++i) {
                    c[i] += w * (double)crs->theta[k][i];
                }
                if ((double)crs->cost[k] > worst) {
                    worst = (double)crs->cost[k];
                    i0 = k;
                }
            }
            double alpha = 1.0 - (worst - mean / eta) / (high - low + phi);
            for (int i = 0; i < 4; ++i) {
                double x = c[i] / eta - alpha * ((double)crs->theta[i0][i] - c[i] / eta);
                TEST_ASSERT_TRUE(fabs(x - (double)optimizer.trial[i]) <= 1e-4);
            }
            ++trials;
        }
        if (status == AUVID_OK) {
            auvid_optimizer_tell(&optimizer, sphere(theta));
        }
    }
    TEST_ASSERT_TRUE(trials > 50);
}

static void test_every_point_is_drawn_equally_often(void)
{
    enum { M = 16, TRIALS = 20000 };
    int count[M] = {0};
    cfg.max_rejections = TRIALS;
    cfg.max_evaluations_crs = 2 * TRIALS;
    init();
    for (int k = 0; k < M; ++k) {
        auvid_optimizer_ask(&optimizer, theta);
        auvid_optimizer_tell(&optimizer, sphere(theta));
    }
    for (int k = 0; k < TRIALS; ++k) {
        if (auvid_optimizer_ask(&optimizer, theta) == AUVID_OK) {
            auvid_optimizer_tell(&optimizer, AUVID_COST_FAILED); /* never accepted */
        }
        for (int j = 0; j <= 4; ++j) {
            ++count[crs->order[j]];
        }
    }
    double p = 5.0 / M, sigma = sqrt(TRIALS * p * (1.0 - p));
    for (int k = 0; k < M; ++k) { /* 4.5 sigma, 16 points: a false alarm in 1e4 seeds */
        TEST_ASSERT_TRUE(fabs(count[k] - TRIALS * p) < 4.5 * sigma);
    }
}

static void test_the_population_is_the_best_m_points_ever_evaluated(void)
{
    static auvid_real_t all[1000];
    int n = 0;
    init();
    for (int k = 0; k < 400; ++k) {
        if (auvid_optimizer_ask(&optimizer, theta) == AUVID_OK) {
            all[n++] = sphere(theta);
            auvid_optimizer_tell(&optimizer, all[n - 1]);
        }
    }
    auvid_real_t worst = 0, best;
    for (int k = 0; k < 16; ++k) {
        worst = crs->cost[k] > worst ? crs->cost[k] : worst;
    }
    int as_good = 0;
    for (int k = 0; k < n; ++k) {
        as_good += all[k] <= worst;
    }
    TEST_ASSERT_TRUE(n > 100);
    TEST_ASSERT_EQUAL_INT(16, as_good);
    auvid_optimizer_best(&optimizer, &best);
    for (int k = 0; k < n; ++k) {
        TEST_ASSERT_TRUE(best <= all[k]);
    }
}

static void test_it_finishes_when_the_spread_is_epsilon(void)
{
    cfg.omega = AUVID_C(4e6);
    cfg.max_evaluations_crs = 100000;
    init();
    TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, run(sphere));
    auvid_real_t low = crs->cost[0], high = low;
    for (int k = 1; k < 16; ++k) {
        low = crs->cost[k] < low ? crs->cost[k] : low;
        high = crs->cost[k] > high ? crs->cost[k] : high;
    }
    TEST_ASSERT_TRUE(high - low <= cfg.epsilon_crs);
    TEST_ASSERT_TRUE(low < AUVID_C(0.1));
    TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, auvid_optimizer_ask(&optimizer, theta));
}

static void test_it_finishes_when_the_spread_is_reduced_as_configured(void)
{
    cfg.reduction = AUVID_C(0.1);
    cfg.epsilon_crs = 0;
    init();
    auvid_real_t spread = 0, first = 0;
    for (uint32_t turns = 0; auvid_optimizer_ask(&optimizer, theta) != AUVID_FINISHED;) {
        finish_turn(&turns, 10000000);
        if (optimizer.asked) {
            auvid_optimizer_tell(&optimizer, sphere(theta));
        }
        if (optimizer.work.crs < 16) {
            continue;
        }
        TEST_ASSERT_TRUE(first <= 0 || spread > first / 10);
        spread = crs->cost[crs->worst] - crs->cost[crs->best];
        first = optimizer.work.crs == 16 ? spread : first;
    }
    TEST_ASSERT_TRUE(spread <= first / 10 && spread > first / 100);
}

/* With m = n + 1 or an optimum in a corner, the paper's loops do not end. */
static void test_it_ends_whatever_the_cost_and_the_population(void)
{
    auvid_real_t (*const costs[])(const auvid_real_t *) = {
        sphere, corner, plateau, fails, fails_on_one_side, on_a_high_floor};
    const uint8_t sizes[] = {1, 2, 4, 13, AUVID_MAX_PARAMETERS};
    for (size_t s = 0; s < sizeof sizes; ++s) {
        uint8_t n = sizes[s] <= AUVID_MAX_PARAMETERS ? sizes[s] : AUVID_MAX_PARAMETERS;
        for (size_t c = 0; c < 6; ++c) {
            for (uint64_t seed = 0; seed < 20; ++seed) {
                if (c == 4 && n < 2) {
                    continue;
                }
                box(n, 10);
                cfg.seed = seed;
                cfg.population = seed % 2 ? 0 : (uint16_t)(n + 1);
                cfg.epsilon_crs = seed % 4 < 2 ? AUVID_C(1e-2) : 0;
                init();
                (void)run(costs[c]);
                TEST_ASSERT_NOT_NULL(auvid_optimizer_best(&optimizer, NULL));
            }
        }
    }
}

static void test_consecutive_rejections_are_capped(void)
{
    bool met = false;
    for (uint64_t seed = 0; seed < 50 && !met; ++seed) {
        cfg.population = 5;
        cfg.max_rejections = 37;
        cfg.seed = seed;
        init();
        met = run(corner) == AUVID_EVALUATION_LIMIT && crs->rejections == 37;
        TEST_ASSERT_TRUE(crs->rejections <= 37);
    }
    TEST_ASSERT_TRUE(met);
}

static void test_a_trial_in_the_box_ends_the_run_of_rejections(void)
{
    int ended = 0;
    init();
    for (int k = 0; k < 400; ++k) {
        uint32_t before = crs->rejections;
        if (auvid_optimizer_ask(&optimizer, theta) == AUVID_OK) {
            ended += before > 0;
            TEST_ASSERT_EQUAL_UINT32(0, crs->rejections);
            auvid_optimizer_tell(&optimizer, corner(theta));
        }
    }
    TEST_ASSERT_TRUE(ended > 0);
}

static void test_a_trial_of_the_same_cost_as_the_worst_is_not_accepted(void)
{
    static auvid_real_t before[AUVID_MAX_POPULATION][AUVID_MAX_PARAMETERS];
    uint32_t turns = 0;
    init();
    while (optimizer.work.crs < 16) {
        finish_turn(&turns, 1000000);
        auvid_optimizer_ask(&optimizer, theta);
        auvid_optimizer_tell(&optimizer, sphere(theta));
    }
    memcpy(before, crs->theta, sizeof before);
    while (optimizer.work.crs < 30) {
        finish_turn(&turns, 1000000);
        if (auvid_optimizer_ask(&optimizer, theta) == AUVID_OK) {
            auvid_optimizer_tell(&optimizer, crs->cost[crs->worst]);
        }
    }
    TEST_ASSERT_EQUAL_INT(0, memcmp(before, crs->theta, sizeof before));
}

static void test_evaluations_are_capped(void)
{
    cfg.max_evaluations_crs = 30;
    cfg.epsilon_crs = 0;
    init();
    TEST_ASSERT_EQUAL_INT(AUVID_EVALUATION_LIMIT, run(sphere));
    TEST_ASSERT_EQUAL_UINT32(30, optimizer.work.crs);
}

static void test_a_plateau_converges_and_a_model_that_always_fails_does_not(void)
{
    auvid_real_t cost;
    init();
    TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, run(plateau));
    init();
    TEST_ASSERT_EQUAL_INT(AUVID_EVALUATION_LIMIT, run(fails));
    auvid_optimizer_best(&optimizer, &cost);
    TEST_ASSERT_TRUE(cost == AUVID_COST_FAILED);
}

static void test_points_where_the_model_fails_leave_the_population(void)
{
    cfg.epsilon_crs = AUVID_C(1e-4);
    cfg.population = 60; /* 4 n = 16 points may collapse early: phase 2 handles that */
    cfg.omega = AUVID_C(4e6);
    cfg.max_evaluations_crs = 100000;
    init();
    TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, run(fails_on_one_side));
    for (int i = 0; i < 4; ++i) {
        TEST_ASSERT_TRUE(fabs((double)auvid_optimizer_best(&optimizer, NULL)[i] - 1.0) < 0.1);
    }
}

static void test_same_seed_same_bits_and_another_seed_another_population(void)
{
    static auvid_optimizer_t other;
    init();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_optimizer_init(&other, &cfg, NULL));
    (void)run(sphere);
    for (int k = 0; k < 100000; ++k) {
        auvid_status_t status = auvid_optimizer_ask(&other, theta);
        if (status == AUVID_OK) {
            auvid_optimizer_tell(&other, sphere(theta));
        } else if (status != AUVID_PENDING) {
            break;
        }
    }
    TEST_ASSERT_EQUAL_INT(0, memcmp(&optimizer, &other, sizeof other));
    cfg.seed = 2;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_optimizer_init(&other, &cfg, NULL));
    init();
    TEST_ASSERT_EQUAL_INT(0, memcmp(&optimizer, &other, sizeof other));
    cfg.seed = 3;
    init();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_optimizer_ask(&other, theta));
    const auvid_real_t first = theta[0];
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_optimizer_ask(&optimizer, theta));
    TEST_ASSERT_TRUE(theta[0] < first || theta[0] > first);
}

static void test_a_trial_outside_the_box_is_pending(void)
{
    auvid_status_t status = AUVID_OK;
    init();
    for (int k = 0; k < 1000 && (status = auvid_optimizer_ask(&optimizer, theta)) == AUVID_OK;
         ++k) {
        auvid_optimizer_tell(&optimizer, theta[0]); /* the least cost is at a side of the box */
    }
    TEST_ASSERT_EQUAL_INT(AUVID_PENDING, status);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_init_names_what_is_wrong_and_changes_nothing);
    RUN_TEST(test_zeros_of_the_configuration_mean_what_the_header_says);
    RUN_TEST(test_calls_out_of_order_are_refused);
    RUN_TEST(test_asking_twice_gives_the_same_point_and_counts_once);
    RUN_TEST(test_a_known_point_enters_the_population_and_bad_ones_are_refused);
    RUN_TEST(test_the_trial_is_the_weighted_reflection_of_algorithm_1);
    RUN_TEST(test_every_point_is_drawn_equally_often);
    RUN_TEST(test_the_population_is_the_best_m_points_ever_evaluated);
    RUN_TEST(test_it_finishes_when_the_spread_is_epsilon);
    RUN_TEST(test_it_finishes_when_the_spread_is_reduced_as_configured);
    RUN_TEST(test_it_ends_whatever_the_cost_and_the_population);
    RUN_TEST(test_consecutive_rejections_are_capped);
    RUN_TEST(test_a_trial_in_the_box_ends_the_run_of_rejections);
    RUN_TEST(test_a_trial_of_the_same_cost_as_the_worst_is_not_accepted);
    RUN_TEST(test_evaluations_are_capped);
    RUN_TEST(test_a_plateau_converges_and_a_model_that_always_fails_does_not);
    RUN_TEST(test_points_where_the_model_fails_leave_the_population);
    RUN_TEST(test_same_seed_same_bits_and_another_seed_another_population);
    RUN_TEST(test_a_trial_outside_the_box_is_pending);
    return UNITY_END();
}
