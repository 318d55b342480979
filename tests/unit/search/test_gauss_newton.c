/* Damped Gauss-Newton steps on y = a + b e^(c t), which is affine in a and b. */
#include <math.h>
#include <string.h>

#include "search/auvid_gauss_newton_internal.h"
#include "unity.h"

enum { A, B, C, PARAMETERS, POINTS = 40 };

static const double truth[PARAMETERS] = {1.5, -2.0, -0.7};
static double noise; /* amplitude of what the model does not contain */
static auvid_real_t x[PARAMETERS], lower[PARAMETERS], upper[PARAMETERS];
static auvid_gauss_newton_t gn;
static int costs, linearisations;
static auvid_real_t outside; /* c above which the model fails */

void setUp(void)
{
    noise = 0.02;
    costs = linearisations = 0;
    outside = INFINITY;
    for (int i = 0; i < PARAMETERS; ++i) {
        lower[i] = -5;
        upper[i] = 5;
        x[i] = 0;
    }
    x[C] = -2; /* at c = 0, a and b have the same column */
}

void tearDown(void)
{
}

static double residual(const auvid_real_t *p, int k)
{
    double t = 0.1 * k, y = truth[A] + truth[B] * exp(truth[C] * t) + noise * sin(7.0 * k);
    return (double)p[A] + (double)p[B] * exp((double)p[C] * t) - y;
}

static auvid_real_t cost(const auvid_real_t *p)
{
    double sum = 0.0;
    ++costs;
    for (int k = 0; k < POINTS; ++k) {
        sum += residual(p, k) * residual(p, k);
    }
    return p[C] > outside ? (auvid_real_t)NAN : (auvid_real_t)sum;
}

static void add_rows(void)
{
    for (int k = 0; k < POINTS; ++k) {
        double t = 0.1 * k, e = exp((double)gn.x[C] * t);
        const double d[PARAMETERS] = {1.0, e, (double)gn.x[B] * t * e};
        auvid_real_t row[AUVID_MAX_PARAMETERS + 1] = {0};
        double z = -residual(gn.x, k);
        for (int i = 0; i < PARAMETERS; ++i) {
            row[i] = (auvid_real_t)d[i];
            z += d[i] * (double)gn.x[i];
        }
        row[PARAMETERS] = (auvid_real_t)z;
        auvid_gauss_newton_add(&gn, row);
    }
}

static void assert_inside(const auvid_real_t *p)
{
    for (int i = 0; i < PARAMETERS; ++i) {
        TEST_ASSERT_TRUE(p[i] >= lower[i] && p[i] <= upper[i]);
    }
}

static void search(uint32_t affine)
{
    auvid_real_t last = AUVID_COST_FAILED;
    auvid_gauss_newton_begin(&gn, PARAMETERS, x, affine);
    memcpy(gn.lower, lower, sizeof lower);
    memcpy(gn.upper, upper, sizeof upper);
    for (int turn = 0; gn.state != NEWTON_DONE; ++turn) {
        TEST_ASSERT_TRUE(turn < 1000);
        TEST_ASSERT_TRUE(gn.cost <= last);
        last = gn.cost;
        if (gn.state == NEWTON_COST) {
            assert_inside(gn.ls.x);
            auvid_gauss_newton_tell(&gn, cost(gn.ls.x));
        } else if (gn.state == NEWTON_ROWS) {
            ++linearisations;
            auvid_gauss_newton_begin_step(&gn);
        } else {
            add_rows();
            while (gn.state == NEWTON_STEP) {
                auvid_gauss_newton_step(&gn);
            }
        }
    }
    assert_inside(gn.x);
}

/* Each partial derivative of the cost at the result, relative to its curvature. */
static void assert_minimum(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-5 * (double)gn.cost, (double)cost(gn.x), (double)gn.cost);
    for (int i = 0; i < PARAMETERS; ++i) {
        for (int sign = -1; sign <= 1; sign += 2) {
            auvid_real_t p[PARAMETERS];
            memcpy(p, gn.x, sizeof p);
            p[i] += (auvid_real_t)sign * auvid_gauss_newton_scale(&gn, i) / 20;
            bool room = p[i] >= lower[i] && p[i] <= upper[i];
            TEST_ASSERT_TRUE(!room || cost(p) > (1 - AUVID_C(1e-4)) * gn.cost);
        }
    }
}

static void test_the_closed_form_and_a_few_steps_reach_the_minimum(void)
{
    search(1u << A | 1u << B);
    TEST_ASSERT_TRUE(linearisations <= 8 && costs <= 12 + NEWTON_MAX_REJECTED);
    assert_minimum();
    for (int i = 0; i < PARAMETERS; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(0.05, truth[i], (double)gn.x[i]);
    }
}

static void test_without_affine_parameters_the_steps_reach_it_as_well(void)
{
    x[B] = -1;
    x[C] = -1;
    search(0);
    TEST_ASSERT_TRUE(linearisations <= NEWTON_MAX_ROWS);
    assert_minimum();
}

static void test_the_closed_form_moves_only_the_affine_parameters(void)
{
    x[C] = AUVID_C(-0.3);
    auvid_gauss_newton_begin(&gn, PARAMETERS, x, 1u << A | 1u << B);
    memcpy(gn.lower, lower, sizeof lower);
    memcpy(gn.upper, upper, sizeof upper);
    auvid_gauss_newton_tell(&gn, cost(x));
    TEST_ASSERT_EQUAL(NEWTON_ROWS, gn.state);
    auvid_gauss_newton_begin_step(&gn);
    add_rows();
    while (gn.state == NEWTON_STEP) {
        auvid_gauss_newton_step(&gn);
    }
    TEST_ASSERT_EQUAL_DOUBLE((double)x[C], (double)gn.ls.x[C]);
    auvid_real_t best = cost(gn.ls.x);
    for (int i = A; i <= B; ++i) { /* least for this c */
        for (int sign = -1; sign <= 1; sign += 2) {
            auvid_real_t p[PARAMETERS];
            memcpy(p, gn.ls.x, sizeof p);
            p[i] += (auvid_real_t)sign * AUVID_C(0.01);
            TEST_ASSERT_TRUE(cost(p) > best);
        }
    }
}

static void test_a_bound_holds_and_the_others_are_at_their_minimum_beside_it(void)
{
    upper[A] = 1;
    search(1u << A | 1u << B);
    TEST_ASSERT_EQUAL_DOUBLE(1, (double)gn.x[A]);
    assert_minimum();
}

static void test_a_point_at_which_the_model_fails_is_not_taken(void)
{
    x[B] = -1;
    x[C] = AUVID_C(-1.5);
    outside = AUVID_C(-0.9);
    search(0);
    TEST_ASSERT_TRUE(gn.cost < AUVID_COST_FAILED && gn.x[C] <= outside);
    TEST_ASSERT_TRUE(gn.cost < cost(x));
}

static void test_a_start_without_a_cost_ends_the_steps(void)
{
    outside = -3;
    search(0);
    TEST_ASSERT_EQUAL(0, linearisations);
    TEST_ASSERT_EQUAL(1, costs);
    TEST_ASSERT_TRUE(gn.cost >= AUVID_COST_FAILED);
}

static void test_at_the_minimum_one_linearisation_is_enough(void)
{
    search(1u << A | 1u << B);
    memcpy(x, gn.x, sizeof x);
    costs = linearisations = 0;
    search(0);
    TEST_ASSERT_EQUAL(1, linearisations);
    TEST_ASSERT_TRUE(costs <= 2 + NEWTON_MAX_REJECTED);
}

/* Tells that `worse` steps from x make it worse, and the next one better. */
static void search_worse(int worse)
{
    auvid_gauss_newton_begin(&gn, PARAMETERS, x, 0);
    memcpy(gn.lower, lower, sizeof lower);
    memcpy(gn.upper, upper, sizeof upper);
    auvid_gauss_newton_tell(&gn, 1);
    auvid_gauss_newton_begin_step(&gn);
    for (int trials = 1; trials <= worse + 1 && gn.state == NEWTON_STEP; ++trials) {
        add_rows();
        while (gn.state == NEWTON_STEP) {
            auvid_gauss_newton_step(&gn);
        }
        auvid_gauss_newton_tell(&gn, trials <= worse ? 2 : AUVID_C(0.5));
        TEST_ASSERT_TRUE(gn.damping <= NEWTON_MAX_DAMPING);
    }
}

/* A step that always makes it worse: the damping rises, then the search ends where it was. */
static void test_steps_that_never_help_end_at_the_start(void)
{
    search_worse(NEWTON_MAX_REJECTED + 1);
    TEST_ASSERT_EQUAL(NEWTON_DONE, gn.state);
    TEST_ASSERT_EQUAL_MEMORY(x, gn.x, sizeof x);
    TEST_ASSERT_EQUAL_DOUBLE(1, (double)gn.cost);
}

/* Where a cost has many small kinks, only a step that is short enough helps. */
static void test_a_step_that_helps_only_when_it_is_short_is_taken(void)
{
    search_worse(6);
    TEST_ASSERT_EQUAL(NEWTON_ROWS, gn.state);
    TEST_ASSERT_EQUAL_DOUBLE(0.5, (double)gn.cost);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_closed_form_and_a_few_steps_reach_the_minimum);
    RUN_TEST(test_without_affine_parameters_the_steps_reach_it_as_well);
    RUN_TEST(test_the_closed_form_moves_only_the_affine_parameters);
    RUN_TEST(test_a_bound_holds_and_the_others_are_at_their_minimum_beside_it);
    RUN_TEST(test_a_point_at_which_the_model_fails_is_not_taken);
    RUN_TEST(test_a_start_without_a_cost_ends_the_steps);
    RUN_TEST(test_at_the_minimum_one_linearisation_is_enough);
    RUN_TEST(test_steps_that_never_help_end_at_the_start);
    RUN_TEST(test_a_step_that_helps_only_when_it_is_short_is_taken);
    return UNITY_END();
}
