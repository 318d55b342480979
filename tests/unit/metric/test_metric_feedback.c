/*
 * The test for feedback: its rows are those of the definition in auvid_metric_feedback.c, computed
 * here in double from the cells. What it decides is in test_feedback.c.
 */
#include <math.h>
#include <string.h>

#include "base/auvid_linalg_internal.h"
#include "metric/auvid_metric_feedback_internal.h"
#include "metric_cells.h"
#include "simulator.h"
#include "unity.h"

enum { CELLS = 900, COLUMNS = AUVID_FEEDBACK_ORDER, CELL_US = 100000 };

static double tau[CELLS][AUVID_DOF_COUNT], residual[CELLS][AUVID_DOF_COUNT];
static double normal[AUVID_DOF_COUNT][COLUMNS][COLUMNS], rows[AUVID_DOF_COUNT];
static double means[3][AUVID_DOF_COUNT]; /* of the last blocks of the wrench, newest first */
static uint32_t stored;
static int block, gap;

void setUp(void)
{
    cells_defaults();
    cfg.velocity_us = 2 * CELL_US;
    memset(normal, 0, sizeof normal);
    memset(rows, 0, sizeof rows);
    memset(means, 0, sizeof means);
    stored = 0;
    block = 5;
    gap = 2;
}

void tearDown(void)
{
}

/* Mean of DoF j over `block` cells, the last one being cell n. */
static double mean(double (*of)[AUVID_DOF_COUNT], int n, int j)
{
    double sum = 0.0;
    for (int k = 0; k < block; ++k) {
        sum += of[n - k][j];
    }
    return sum / block;
}

/* The row of DoF j whose block of the wrench ends with cell n; `count` cells since a gap. */
static void expect_row(int n, int count, int j)
{
    double scale = 1.0 / (double)cfg.tau_max[j], last = tau[n - block][j];
    double next = mean(tau, n, j), before_last = tau[n - block - 1][j], e = 0.0;
    double step = scale * (next - last), weight = 1.0 / sqrt(0.015 * 0.015 + step * step);
    double earlier[3] = {means[0][j], means[1][j], means[2][j]};
    means[2][j] = means[1][j];
    means[1][j] = means[0][j];
    means[0][j] = next;
    if (count < 4 * block + gap) {
        return;
    }
    for (int k = 1; k <= 3; ++k) { /* ends this long before the block of the wrench: */
        int between = gap + (k - 1) * block;
        bool past = (uint32_t)(between * CELL_US) << metric.result.doublings >= cfg.velocity_us;
        e += past ? mean(residual, n - gap - k * block, j) * pow(0.5, k - 1) : 0.0;
    }
    double row[COLUMNS] = {1.0,
                           scale * (last - before_last),
                           scale * (last - earlier[0]),
                           scale * (last - earlier[1]),
                           scale * (last - earlier[2]),
                           scale * e,
                           step};
    for (int a = 0; a < COLUMNS; ++a) {
        for (int b = 0; b < COLUMNS; ++b) {
            normal[j][a][b] += weight * row[a] * weight * row[b];
        }
    }
    rows[j] += 1.0;
}

/* A set has been stored: older rows count less. */
static void forget(void)
{
    double keep = metric.sets.stored != stored ? 1.0 - 0.5 / cfg.sets : 1.0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        rows[j] *= keep;
        for (int k = 0; k < COLUMNS * COLUMNS; ++k) {
            normal[j][k / COLUMNS][k % COLUMNS] *= keep;
        }
    }
    stored = metric.sets.stored;
}

/* Feeds CELLS cells with a random wrench; at some there is a gap, no estimate, or no velocity. Yaw
 * is known from cell 300 on. */
static void feed_cells(void)
{
    sim_rng_t rng;
    world_t w = world_of(&cfg);
    int count = 0;
    sim_rng_seed(&rng, 3, 1);
    for (int n = 0; n < CELLS; ++n) {
        auvid_sample_t s = cell_at(&w, n * 0.1);
        auvid_real_t e[AUVID_DOF_COUNT];
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            double noise = 0.2 * (double)cfg.tau_max[j] * sim_rng_gauss(&rng);
            s.tau[j] = (auvid_real_t)(0.8 * (n > 0 ? tau[n - 1][j] : 0.0) + noise);
        }
        s.missing = n == 400 ? 1u << AUVID_SWAY : 0;
        if (n == 200) {
            auvid_metric_gap(&metric);
        }
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
        uint8_t dofs = (uint8_t)(1u << AUVID_SURGE | (n >= 300 ? 1u << AUVID_YAW : 0u));
        double lost = 1e-4 * n; /* of the thrust */
        auvid_metric_watch(&metric, &s, n == 600 ? NULL : truth, dofs, (auvid_real_t)lost);
        auvid_vehicle_residual(&auvid_girona500, &s, truth, e);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            tau[n][j] = (double)s.tau[j];
            double left = (double)e[j] + lost * tau[n][j];
            residual[n][j] = (dofs >> j & 1) != 0 ? left : 0.0;
        }
        bool counts = n > 0 && n != 200 && n != 400 && n != 600;
        count = counts ? count + 1 : 0;
        bool complete = counts && count > block && (count - gap) % block == 0;
        if (complete) {
            forget();
        }
        for (int j = 0; complete && j < AUVID_DOF_COUNT; ++j) {
            if ((dofs >> j & 1) != 0) {
                expect_row(n, count, j);
            }
        }
    }
}

static void check_rows(void)
{
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        const auvid_real_t *r = metric.feedback.factor[j];
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, rows[j], (double)metric.feedback.rows[j]);
        for (int a = 0; a < COLUMNS; ++a) {
            for (int b = a; b < COLUMNS; ++b) {
                double sum = 0.0, size = sqrt(normal[j][a][a] * normal[j][b][b]);
                for (int i = 0; i <= a; ++i) {
                    int at = auvid_qr_row(COLUMNS, i) - i;
                    sum += (double)r[at + a] * (double)r[at + b];
                }
                TEST_ASSERT_DOUBLE_WITHIN(1e-4 * size + 1e-9, normal[j][a][b], sum);
            }
        }
    }
}

static void test_the_rows_are_those_of_the_definition(void)
{
    start();
    feed_cells();
    TEST_ASSERT_TRUE(rows[AUVID_SURGE] > 100.0 && metric.sets.stored > 1);
    check_rows();
}

static void test_residuals_that_contain_the_next_sample_of_a_slow_sensor_do_not_count(void)
{
    cfg.velocity_us = 7 * CELL_US; /* the newest of three blocks is left out */
    start();
    feed_cells();
    check_rows();
}

static void test_longer_cells_have_shorter_blocks(void)
{
    block = 3;
    gap = 1;
    start();
    metric.result.doublings = 1;
    feed_cells();
    check_rows();
}

/* sqrt(F / rows) of surge: the part of the residual in the wrench's change, over what is left. */
static double surge_after(double constant_N)
{
    setUp();
    truth[AUVID_G500_X_0] = (auvid_real_t)constant_N;
    start();
    feed_cells();
    const auvid_real_t *left =
        &metric.feedback.factor[AUVID_SURGE][AUVID_QR_FACTOR(AUVID_FEEDBACK_ORDER) - 1];
    return fabs((double)(left[-1] / left[0]));
}

static void test_a_constant_residual_makes_no_difference(void)
{
    double none = surge_after(0.0);
    TEST_ASSERT_TRUE(none > 0.01);
    TEST_ASSERT_DOUBLE_WITHIN(2e-3 * none, none, surge_after(50.0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_rows_are_those_of_the_definition);
    RUN_TEST(test_residuals_that_contain_the_next_sample_of_a_slow_sensor_do_not_count);
    RUN_TEST(test_a_constant_residual_makes_no_difference);
    RUN_TEST(test_longer_cells_have_shorter_blocks);
    return UNITY_END();
}
