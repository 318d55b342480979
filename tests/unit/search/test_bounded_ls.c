/*
 * Least squares within bounds (private header): a parameter that the rows do not determine keeps
 * its value, a parameter at a bound leaves it only for a lower cost. Optima are compared with
 * Eigen's in tests/reference/test_bounded_ls.cpp.
 */
#include <math.h>

#include "search/auvid_bounded_ls_internal.h"
#include "unity.h"

enum { N = 3, MOST_STEPS = 4 * (N + 1) * (N + 2) };

static auvid_bounded_ls_t ls;

void setUp(void)
{
    auvid_bounded_ls_begin(&ls, N);
    for (int i = 0; i < N; ++i) {
        ls.lower[i] = AUVID_C(-10.0);
        ls.upper[i] = AUVID_C(10.0);
    }
}

void tearDown(void)
{
}

static void add(double a, double b, double c, double z)
{
    auvid_real_t row[N + 1] = {(auvid_real_t)a, (auvid_real_t)b, (auvid_real_t)c, (auvid_real_t)z};
    auvid_bounded_ls_add(&ls, row);
}

static void solve(auvid_real_t constant)
{
    auvid_status_t status = AUVID_PENDING;
    for (int i = 0; i < MOST_STEPS && status == AUVID_PENDING; ++i) {
        status = auvid_bounded_ls_step(&ls, constant);
    }
    TEST_ASSERT_EQUAL(AUVID_OK, status);
}

static void expect(double a, double b, double c)
{
    const double x[N] = {a, b, c};
    for (int i = 0; i < N; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, x[i], (double)ls.x[i]);
    }
}

static void test_inside_the_bounds_the_rows_are_solved(void)
{
    add(2, 1, 0, 4);
    add(0, 1, 1, 4);
    add(1, 0, 3, 7);
    solve(0);
    expect(1, 2, 2);
}

static void test_a_parameter_stops_at_its_bound_and_the_others_are_optimal(void)
{
    ls.upper[0] = AUVID_C(0.5);
    add(1, 0, 0, 1);
    add(1, 1, 0, 3); /* y = 3 - x */
    add(0, 0, 1, -4);
    solve(0);
    expect(0.5, 2.5, -4);
    TEST_ASSERT_TRUE(ls.x[0] == ls.upper[0]);
    TEST_ASSERT_EQUAL_HEX32(6, ls.free);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.25, (double)ls.cost);
}

static void test_a_parameter_leaves_the_bound_that_it_starts_at(void)
{
    ls.x[0] = ls.upper[0];
    ls.x[1] = ls.lower[1];
    add(1, 0, 0, 1);
    add(0, 1, 0, -20);
    add(0, 0, 1, 0);
    solve(0);
    expect(1, -10, 0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 100, (double)ls.cost);
}

static void test_a_parameter_without_rows_keeps_its_value(void)
{
    ls.x[1] = AUVID_C(7.0);
    add(1, 0, 0, 1);
    add(1, 0, 1, 3);
    solve(0);
    expect(1, 7, 2);
    TEST_ASSERT_EQUAL_HEX32(5, ls.free);
}

/* Columns that differ by rounding: their difference is not resolved, and no parameter diverges. */
static void test_one_of_two_equal_columns_keeps_its_value(void)
{
    ls.x[0] = ls.x[1] = AUVID_C(1.0);
    add(1, 1.000001, 0, 3.0);
    add(2, 2.000001, 0, 6.1);
    add(3, 2.999998, 0, 8.9);
    add(0, 0, 1, 5);
    solve(0);
    TEST_ASSERT_TRUE(ls.x[0] == AUVID_C(1.0) || ls.x[1] == AUVID_C(1.0));
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 3, (double)(ls.x[0] + ls.x[1]));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 5, (double)ls.x[2]);
}

static void test_a_gain_negligible_beside_the_constant_is_not_made(void)
{
    ls.x[0] = AUVID_C(1.0);
    add(1, 0, 0, 1.001);
    add(0, 1, 0, 0);
    add(0, 0, 1, 0);
    solve(AUVID_C(100.0));
    TEST_ASSERT_TRUE(ls.x[0] == AUVID_C(1.0));
    TEST_ASSERT_EQUAL(0, ls.changes);
}

static void test_contradicting_rows_add_to_the_cost(void)
{
    add(1, 0, 0, 1);
    add(1, 0, 0, 3);
    add(0, 1, 0, 0);
    add(0, 0, 1, 0);
    solve(0);
    expect(2, 0, 0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 2, (double)ls.cost);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_inside_the_bounds_the_rows_are_solved);
    RUN_TEST(test_a_parameter_stops_at_its_bound_and_the_others_are_optimal);
    RUN_TEST(test_a_parameter_leaves_the_bound_that_it_starts_at);
    RUN_TEST(test_a_parameter_without_rows_keeps_its_value);
    RUN_TEST(test_one_of_two_equal_columns_keeps_its_value);
    RUN_TEST(test_a_gain_negligible_beside_the_constant_is_not_made);
    RUN_TEST(test_contradicting_rows_add_to_the_cost);
    return UNITY_END();
}
