/*
 * Packed R factors (private header): R'R is the sum of all row'row, and the leading columns are
 * solved for the next column as right-hand side.
 */
#include <math.h>
#include <string.h>

#include "base/auvid_linalg_internal.h"
#include "unity.h"

enum { MAX_COLUMNS = 20, ROWS = 200 };

static auvid_real_t factor[AUVID_QR_FACTOR(MAX_COLUMNS) + 1];
static double rows[ROWS][MAX_COLUMNS];
static uint32_t seed;

void setUp(void)
{
    memset(factor, 0, sizeof factor);
    factor[AUVID_QR_FACTOR(MAX_COLUMNS)] = AUVID_C(12345.0);
    seed = 1;
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(12345.0, (double)factor[AUVID_QR_FACTOR(MAX_COLUMNS)]);
}

static double draw(void)
{
    seed = seed * 1664525u + 1013904223u;
    return (double)(auvid_real_t)((double)(seed >> 8) / 8388608.0 - 1.0);
}

static void add(int n, int first, const double *row)
{
    auvid_real_t copy[MAX_COLUMNS];
    for (int i = 0; i < n; ++i) {
        copy[i] = i < first ? (auvid_real_t)NAN : (auvid_real_t)row[i]; /* must not be read */
    }
    auvid_qr_update(factor, n, first, copy);
}

static double at(int n, int i, int j)
{
    return j < i ? 0 : (double)factor[auvid_qr_row(n, i) + j - i];
}

/* |R'R - A'A|_ij <= c eps |a_i| |a_j|. The errors of ROWS rotations, 6 roundings each, add like
 * sqrt(ROWS). */
static void assert_normal_equations(int n, int count)
{
    for (int i = 0; i < n; ++i) {
        for (int j = i; j < n; ++j) {
            double sum = 0, ii = 0, jj = 0, r = 0;
            for (int k = 0; k < count; ++k) {
                sum += rows[k][i] * rows[k][j];
                ii += rows[k][i] * rows[k][i];
                jj += rows[k][j] * rows[k][j];
            }
            for (int k = 0; k <= i; ++k) {
                r += at(n, k, i) * at(n, k, j);
            }
            TEST_ASSERT_DOUBLE_WITHIN(6 * sqrt(ROWS) * (double)AUVID_EPSILON * sqrt(ii * jj), sum,
                                      r);
        }
    }
}

static void test_rows_of_a_factor_are_stored_without_gaps(void)
{
    for (int n = 1; n <= MAX_COLUMNS; ++n) {
        int next = 0;
        for (int i = 0; i < n; ++i) {
            TEST_ASSERT_EQUAL_INT(next, auvid_qr_row(n, i));
            next += n - i;
        }
        TEST_ASSERT_EQUAL_INT(next, AUVID_QR_FACTOR(n));
    }
}

static void test_factor_represents_the_sum_of_all_outer_products(void)
{
    for (int n = 1; n <= MAX_COLUMNS; n += 3) {
        setUp();
        for (int k = 0; k < ROWS; ++k) {
            for (int i = 0; i < n; ++i) {
                rows[k][i] = draw() * pow(10.0, i % 4); /* columns of different magnitude */
            }
            add(n, 0, rows[k]);
        }
        assert_normal_equations(n, ROWS);
        for (int i = 0; i < n; ++i) {
            TEST_ASSERT_TRUE(at(n, i, i) > 0);
        }
    }
}

static void test_entries_before_the_first_column_are_not_read(void)
{
    const int n = 7;
    for (int k = 0; k < ROWS; ++k) {
        int first = k % n;
        memset(rows[k], 0, sizeof rows[k]);
        for (int i = first; i < n; ++i) {
            rows[k][i] = draw();
        }
        add(n, first, rows[k]);
    }
    assert_normal_equations(n, ROWS);
}

static void test_zero_rows_change_nothing_and_rows_with_vanishing_squares_only_round(void)
{
    const int n = 5;
    for (int k = 0; k < 10; ++k) {
        for (int i = 0; i < n; ++i) {
            rows[k][i] = draw();
        }
        add(n, 0, rows[k]);
    }
    auvid_real_t before[AUVID_QR_FACTOR(5)];
    memcpy(before, factor, sizeof before);
    memset(rows[10], 0, sizeof rows[10]);
    add(n, 0, rows[10]);
    TEST_ASSERT_EQUAL_MEMORY(before, factor, sizeof before);
    for (int i = 0; i < n; ++i) {
        rows[10][i] = sizeof(auvid_real_t) == sizeof(float) ? 1e-30 : 1e-200;
    }
    add(n, 0, rows[10]);
    for (int i = 0; i < AUVID_QR_FACTOR(5); ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(2 * (double)AUVID_EPSILON * fabs((double)before[i]),
                                  (double)before[i], (double)factor[i]);
    }
    memset(factor, 0, sizeof before);
    add(n, 0, rows[10]);
    for (int i = 0; i < AUVID_QR_FACTOR(5); ++i) {
        TEST_ASSERT_TRUE(auvid_is_finite(factor[i]));
    }
}

/* Column m is the right-hand side. */
static int solve(int n, int m, auvid_real_t tiny, auvid_real_t *x)
{
    for (int i = 0; i < m; ++i) {
        x[i] = factor[auvid_qr_row(n, i) + m - i];
    }
    return auvid_qr_solve(factor, n, m, tiny, x);
}

static void test_solution_of_exact_equations_is_found(void)
{
    const int n = 9, m = 6; /* two unused right-hand sides after the first */
    double x[6] = {1, -2, 3, -4, 5, -6};
    auvid_real_t found[6];
    for (int k = 0; k < 50; ++k) {
        rows[k][m] = 0;
        for (int i = 0; i < m; ++i) {
            rows[k][i] = draw();
            rows[k][m] += rows[k][i] * x[i];
        }
        rows[k][m + 1] = draw();
        rows[k][m + 2] = draw();
        add(n, 0, rows[k]);
    }
    TEST_ASSERT_EQUAL_INT(0, solve(n, m, AUVID_C(1e-6), found));
    for (int i = 0; i < m; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(200 * (double)AUVID_EPSILON, x[i], (double)found[i]);
    }
}

static void test_least_squares_leave_a_residual_orthogonal_to_the_columns(void)
{
    const int n = 5, m = 4;
    auvid_real_t x[4];
    for (int k = 0; k < 100; ++k) {
        for (int i = 0; i < n; ++i) {
            rows[k][i] = draw();
        }
        add(n, 0, rows[k]);
    }
    TEST_ASSERT_EQUAL_INT(0, solve(n, m, AUVID_C(1e-6), x));
    double squares = 0;
    for (int i = 0; i < m; ++i) {
        double product = 0;
        for (int k = 0; k < 100; ++k) {
            double e = -rows[k][m];
            for (int c = 0; c < m; ++c) {
                e += rows[k][c] * (double)x[c];
            }
            product += e * rows[k][i];
            squares += i == 0 ? e * e : 0;
        }
        TEST_ASSERT_DOUBLE_WITHIN(100 * 10 * (double)AUVID_EPSILON, 0, product);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e3 * (double)AUVID_EPSILON, sqrt(squares), at(n, m, m));
}

static void test_column_that_depends_on_those_before_it_is_counted_and_set_to_zero(void)
{
    const int n = 4, m = 3;
    auvid_real_t x[3] = {9, 9, 9};
    for (int k = 0; k < 50; ++k) {
        rows[k][0] = draw();
        rows[k][1] = -rows[k][0];
        rows[k][2] = draw();
        rows[k][3] = 2 * rows[k][0] + 3 * rows[k][2];
        add(n, 0, rows[k]);
    }
    TEST_ASSERT_EQUAL_INT(1, solve(n, m, AUVID_C(1e-5), x));
    TEST_ASSERT_EQUAL_DOUBLE(0, (double)x[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 2, (double)x[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 3, (double)x[2]);
}

static void test_empty_factor_determines_nothing(void)
{
    auvid_real_t x[3] = {9, 9, 9};
    TEST_ASSERT_EQUAL_INT(3, solve(4, 3, 0, x));
    for (int i = 0; i < 3; ++i) {
        TEST_ASSERT_EQUAL_DOUBLE(0, (double)x[i]);
    }
    factor[0] = (auvid_real_t)NAN;
    TEST_ASSERT_EQUAL_INT(3, solve(4, 3, 0, x));
    TEST_ASSERT_EQUAL_DOUBLE(0, (double)x[0]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_rows_of_a_factor_are_stored_without_gaps);
    RUN_TEST(test_factor_represents_the_sum_of_all_outer_products);
    RUN_TEST(test_entries_before_the_first_column_are_not_read);
    RUN_TEST(test_zero_rows_change_nothing_and_rows_with_vanishing_squares_only_round);
    RUN_TEST(test_solution_of_exact_equations_is_found);
    RUN_TEST(test_least_squares_leave_a_residual_orthogonal_to_the_columns);
    RUN_TEST(test_column_that_depends_on_those_before_it_is_counted_and_set_to_zero);
    RUN_TEST(test_empty_factor_determines_nothing);
    return UNITY_END();
}
