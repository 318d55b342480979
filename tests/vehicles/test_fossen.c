/*
 * The contract of the 6-DoF model: names, masks, sizes, free and identifiable subsets, and singular
 * accelerations. test_fossen_reference.cpp compares it with the textbook.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "auvid/allocation.h"
#include "auvid/fossen.h"
#include "auvid/detail/metric.h"
#include "base/auvid_linalg_internal.h"
#include "unity.h"

enum { N = AUVID_FOSSEN_COUNT };

static auvid_rng_t rng;
static auvid_real_t pi[AUVID_MAX_PARAMETERS];
static auvid_metric_t metric;
static auvid_metric_config_t cfg;

void setUp(void)
{
    auvid_rng_seed(&rng, 1);
    memset(pi, 0, sizeof pi);
    memcpy(pi, auvid_bluerov2_heavy_benzon, sizeof auvid_bluerov2_heavy_benzon);
    auvid_metric_defaults(&cfg, &auvid_fossen);
}

void tearDown(void)
{
}

static auvid_real_t draw(auvid_real_t size)
{
    return size * (2 * auvid_rng_uniform(&rng) - 1);
}

static auvid_sample_t random_motion(void)
{
    auvid_sample_t s;
    memset(&s, 0, sizeof s);
    s.phi = draw(AUVID_C(0.5));
    s.theta = draw(AUVID_C(0.5));
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        s.nu[j] = draw(1);
        s.nu_dot[j] = draw(1);
        s.tau[j] = draw(10);
    }
    return s;
}

static auvid_regressor_t rows_of(const auvid_sample_t *s)
{
    auvid_regressor_t y;
    memset(&y, 0, sizeof y);
    auvid_fossen.regressor(auvid_fossen.context, s, NULL, &y);
    return y;
}

/* ---- the table ---- */

static void test_the_model_is_valid(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_vehicle_check(&auvid_fossen));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_vehicle_check(&auvid_bluerov2_heavy));
    TEST_ASSERT_EQUAL_STRING("BlueROV2 Heavy", auvid_bluerov2_heavy.name);
    TEST_ASSERT_EQUAL_UINT8(32, auvid_fossen.parameters);
}

/* A name must not suggest that a sum is one of its terms. */
static void test_names_show_the_terms_of_the_sums(void)
{
    static const char *const sums[] = {"m-X_udot",  "m-Y_vdot",  "m-Z_wdot", "Ix-K_pdot",
                                       "Iy-M_qdot", "Iz-N_rdot", "W-B",      "xgW-xbB",
                                       "ygW-ybB",   "zgW-zbB"};
    for (int i = 0; i < (int)(sizeof sums / sizeof sums[0]); ++i) {
        TEST_ASSERT_EQUAL_STRING(sums[i], auvid_fossen.parameter[i].name);
    }
    TEST_ASSERT_EQUAL_STRING("mzg-X_qdot", auvid_fossen.parameter[AUVID_FOSSEN_M_UQ].name);
    for (int i = 0; i < N; ++i) {
        for (int k = 0; k < i; ++k) {
            TEST_ASSERT_TRUE(
                strcmp(auvid_fossen.parameter[i].name, auvid_fossen.parameter[k].name) != 0);
        }
    }
}

/* The unit of a parameter follows from its column and the DoF of its equation. */
static void test_units_and_kinds_match_the_degree_of_freedom(void)
{
    static const char *const unit[2][4] = {{"kg", "N s/m", "N s2/m2", "N"},
                                           {"kg m2", "Nm s", "Nm s2", "Nm"}};
    static const int first[4] = {AUVID_FOSSEN_M_U, AUVID_FOSSEN_X_U, AUVID_FOSSEN_X_UU,
                                 AUVID_FOSSEN_X_0};
    static const auvid_parameter_kind_t kind[4] = {
        AUVID_PARAMETER_MASS, AUVID_PARAMETER_LINEAR_DRAG, AUVID_PARAMETER_QUADRATIC_DRAG,
        AUVID_PARAMETER_FORCE};
    for (int k = 0; k < 4; ++k) {
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            const auvid_parameter_t *p = &auvid_fossen.parameter[first[k] + j];
            bool inertia = k == 0 && j >= AUVID_ROLL;
            TEST_ASSERT_EQUAL(j, p->dof);
            TEST_ASSERT_EQUAL_STRING(unit[j >= AUVID_ROLL][k], p->unit);
            TEST_ASSERT_EQUAL(inertia ? AUVID_PARAMETER_INERTIA : kind[k], p->kind);
        }
    }
}

static void test_an_equation_does_not_depend_on_velocities_that_it_does_not_read(void)
{
    for (int i = 0; i < AUVID_DOF_COUNT; ++i) {
        auvid_sample_t s = random_motion();
        auvid_regressor_t y[2];
        memset(y, 0, sizeof y);
        auvid_fossen.regressor(auvid_fossen.context, &s, NULL, &y[0]);
        s.nu[i] += 3;
        s.nu_dot[i] += 5;
        auvid_fossen.regressor(auvid_fossen.context, &s, NULL, &y[1]);
        uint8_t without = auvid_vehicle_unmeasured(&auvid_fossen, (uint8_t)(1u << i));
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            bool same = memcmp(y[0].row[j], y[1].row[j], sizeof y[0].row[j]) == 0;
            TEST_ASSERT_EQUAL(!same, without >> j & 1);
        }
    }
}

static void test_masks_contain_exactly_the_columns_that_are_not_zero(void)
{
    uint32_t filled[AUVID_DOF_COUNT] = {0};
    for (int trial = 0; trial < 20; ++trial) {
        auvid_sample_t s = random_motion();
        auvid_regressor_t y = rows_of(&s);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            for (int i = 0; i < N; ++i) {
                filled[j] |= (uint32_t)(y.row[j][i] != 0) << i;
            }
        }
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        TEST_ASSERT_EQUAL_HEX32(auvid_fossen.columns[j], filled[j]);
    }
}

static int bits(uint32_t mask)
{
    int count = 0;
    for (; mask != 0; mask &= mask - 1) {
        ++count;
    }
    return count;
}

static void test_twenty_parameters_are_free_by_default(void)
{
    TEST_ASSERT_EQUAL_HEX32(AUVID_FOSSEN_FREE, auvid_fossen.free);
    TEST_ASSERT_EQUAL_INT(20, bits(AUVID_FOSSEN_FREE));
}

/* ---- subsets ---- */

static void test_any_subset_may_be_free(void)
{
    for (int i = 0; i < N; ++i) {
        cfg.free = 1u << i;
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_init(&metric, &cfg));
    }
    for (int trial = 0; trial < 200; ++trial) {
        cfg.free = auvid_rng_next(&rng) | 1u;
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_init(&metric, &cfg));
    }
    cfg.free = UINT32_MAX;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_init(&metric, &cfg));
}

/* Returns the smallest relative part of a free column outside the span of the columns before it,
 * over `motions` with roll and pitch up to `tilt`. */
static double min_independent_part(uint32_t free, auvid_real_t tilt)
{
    static auvid_real_t factor[AUVID_QR_FACTOR(N)];
    double smallest = 1.0;
    int n = bits(free);
    memset(factor, 0, sizeof factor);
    for (int trial = 0; trial < 500; ++trial) {
        auvid_sample_t s = random_motion();
        s.phi = draw(tilt);
        s.theta = draw(tilt);
        auvid_regressor_t y = rows_of(&s);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            auvid_real_t row[N];
            int k = 0;
            for (int i = 0; i < N; ++i) {
                if (free >> i & 1u) {
                    row[k++] = y.row[j][i];
                }
            }
            auvid_qr_update(factor, n, 0, row);
        }
    }
    for (int i = 0; i < n; ++i) {
        auvid_real_t pivot = factor[auvid_qr_row(n, i)];
        smallest = fmin(smallest, fabs((double)(pivot / auvid_qr_column_norm(factor, n, i))));
    }
    return smallest;
}

static void test_motion_determines_the_parameters_that_are_free_by_default(void)
{
    TEST_ASSERT_TRUE(min_independent_part(AUVID_FOSSEN_FREE, AUVID_C(0.1)) > 0.1);
}

static void test_motion_determines_the_couplings(void)
{
    uint32_t couplings = 0xFu << AUVID_FOSSEN_M_UQ, centres = 3u << AUVID_FOSSEN_X_G;
    TEST_ASSERT_TRUE(min_independent_part(AUVID_FOSSEN_FREE | couplings | centres, AUVID_C(0.1)) >
                     0.1);
}

/* As the header states: for tilts up to 0.1 rad, cos(theta) cos(phi) is 1 within 0.5 %. */
static void test_constant_forces_and_weight_are_almost_indistinguishable(void)
{
    uint32_t z_0 = 1u << AUVID_FOSSEN_Z_0, n_0 = 1u << AUVID_FOSSEN_N_0;
    uint32_t k_0 = 1u << AUVID_FOSSEN_K_0, y_g = 1u << AUVID_FOSSEN_Y_G;
    uint32_t m_0 = 1u << AUVID_FOSSEN_M_0, x_g = 1u << AUVID_FOSSEN_X_G;
    TEST_ASSERT_TRUE(min_independent_part(AUVID_FOSSEN_FREE | n_0, AUVID_C(0.1)) > 0.1);
    TEST_ASSERT_TRUE(min_independent_part(AUVID_FOSSEN_FREE | k_0 | m_0, AUVID_C(0.1)) > 0.1);
    TEST_ASSERT_TRUE(min_independent_part(AUVID_FOSSEN_FREE | z_0, AUVID_C(0.1)) < 0.1);
    TEST_ASSERT_TRUE(min_independent_part(AUVID_FOSSEN_FREE | k_0 | y_g, AUVID_C(0.1)) < 0.1);
    TEST_ASSERT_TRUE(min_independent_part(AUVID_FOSSEN_FREE | m_0 | x_g, AUVID_C(0.1)) < 0.1);
}

/* ---- forward dynamics ---- */

static uint32_t finite_dofs(bool *any)
{
    auvid_real_t nu_dot[AUVID_DOF_COUNT] = {0};
    auvid_sample_t s = random_motion();
    uint32_t finite = 0;
    *any = auvid_fossen.acceleration(auvid_fossen.context, &s, pi, nu_dot);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        finite |= (uint32_t)auvid_is_finite(nu_dot[j]) << j;
    }
    return finite;
}

static void test_without_mass_only_that_degree_of_freedom_has_no_acceleration(void)
{
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        static const auvid_real_t none[3] = {AUVID_C(0.0), AUVID_C(-1.0), AUVID_C(-1e-30)};
        for (int k = 0; k < 3; ++k) {
            bool any = false;
            setUp();
            pi[AUVID_FOSSEN_M_U + j] = none[k];
            TEST_ASSERT_EQUAL_HEX32(0x3Fu & ~(1u << j), finite_dofs(&any));
            TEST_ASSERT_TRUE(any);
        }
    }
}

static void test_without_any_mass_acceleration_returns_false(void)
{
    bool any = true;
    memset(pi, 0, sizeof pi);
    TEST_ASSERT_EQUAL_HEX32(0, finite_dofs(&any));
    TEST_ASSERT_FALSE(any);
}

/* m_u m_q = m_uq^2: M is singular with all its masses positive. */
static void test_if_M_is_not_positive_the_coupled_dofs_have_no_acceleration(void)
{
    static const int coupling[4] = {AUVID_FOSSEN_M_UQ, AUVID_FOSSEN_M_VP, AUVID_FOSSEN_M_VR,
                                    AUVID_FOSSEN_M_WQ};
    static const int pair[4][2] = {{0, 4}, {1, 3}, {1, 5}, {2, 4}};
    for (int k = 0; k < 4; ++k) {
        double limit = sqrt((double)pi[pair[k][0]] * (double)pi[pair[k][1]]);
        bool any = false;
        pi[coupling[k]] = (auvid_real_t)(0.99 * limit);
        TEST_ASSERT_EQUAL_HEX32(0x3F, finite_dofs(&any));
        pi[coupling[k]] = (auvid_real_t)(-1.01 * limit);
        TEST_ASSERT_EQUAL_HEX32(0x3Fu & ~(1u << pair[k][0] | 1u << pair[k][1]), finite_dofs(&any));
        pi[coupling[k]] = 0;
    }
}

/* ---- BlueROV2 ---- */

/* von Benzon et al. 2022, Tables 1 and 2. */
static void test_bluerov2_has_the_published_numbers(void)
{
    static const double mass = 13.5, volume = 0.0134, density = 1000, g = 9.82, z_b = -0.01;
    static const double inertia[3] = {0.26, 0.23, 0.37};
    static const double added[6] = {6.36, 7.12, 18.68, 0.189, 0.135, 0.222};
    static const double linear[6] = {13.7, 0, 33, 0, 0.8, 0};
    static const double quadratic[6] = {141, 217, 190, 1.19, 0.47, 1.5};
    double expected[N] = {0};
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        expected[AUVID_FOSSEN_M_U + j] = (j < 3 ? mass : inertia[j - 3]) + added[j];
        expected[AUVID_FOSSEN_X_U + j] = -linear[j];
        expected[AUVID_FOSSEN_X_UU + j] = -quadratic[j];
    }
    expected[AUVID_FOSSEN_W_B] = g * (mass - density * volume);
    expected[AUVID_FOSSEN_Z_G] = -z_b * g * density * volume;
    for (int i = 0; i < N; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-6 * fabs(expected[i]), expected[i],
                                  (double)auvid_bluerov2_heavy_benzon[i]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_model_is_valid);
    RUN_TEST(test_names_show_the_terms_of_the_sums);
    RUN_TEST(test_units_and_kinds_match_the_degree_of_freedom);
    RUN_TEST(test_an_equation_does_not_depend_on_velocities_that_it_does_not_read);
    RUN_TEST(test_masks_contain_exactly_the_columns_that_are_not_zero);
    RUN_TEST(test_twenty_parameters_are_free_by_default);
    RUN_TEST(test_any_subset_may_be_free);
    RUN_TEST(test_motion_determines_the_parameters_that_are_free_by_default);
    RUN_TEST(test_motion_determines_the_couplings);
    RUN_TEST(test_constant_forces_and_weight_are_almost_indistinguishable);
    RUN_TEST(test_without_mass_only_that_degree_of_freedom_has_no_acceleration);
    RUN_TEST(test_without_any_mass_acceleration_returns_false);
    RUN_TEST(test_if_M_is_not_positive_the_coupled_dofs_have_no_acceleration);
    RUN_TEST(test_bluerov2_has_the_published_numbers);
    return UNITY_END();
}
