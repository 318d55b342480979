/*
 * Parameters known from other sources as a prior, and priors that are refused.
 */
#include <math.h>
#include <string.h>

#include "auvid/prior.h"
#include "by_residual.h"
#include "identifier/auvid_prior_rows_internal.h"
#include "prior_dives.h"
#include "unity.h"

void setUp(void)
{
    prior_dives_defaults();
}

void tearDown(void)
{
}

static void check_unknown(auvid_status_t status, const auvid_real_t *pi, const auvid_real_t *sigma)
{
    static auvid_identifier_t before;
    before = chain.id;
    TEST_ASSERT_EQUAL(status, auvid_prior_set(&chain.id, pi, sigma));
    TEST_ASSERT_EQUAL_MEMORY(&before, &chain.id, sizeof before);
}

static void test_known_parameters_are_the_first_estimate(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS], sigma[AUVID_MAX_PARAMETERS];
    tank(pi, sigma);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_set(&chain.id, pi, sigma));
    TEST_ASSERT_EQUAL_UINT32(1, chain.id.estimate.number);
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE, chain.id.estimate.identified);
    TEST_ASSERT_EQUAL_HEX32(0, chain.id.estimate.confidence.identifiable);
    TEST_ASSERT_EQUAL_MEMORY(pi, chain.id.estimate.pi, N * sizeof pi[0]);
    TEST_ASSERT_EQUAL_MEMORY(sigma, chain.id.estimate.confidence.sigma, N * sizeof sigma[0]);
    for (int i = 0; i < N; ++i) {
        for (int k = 0; k < N; ++k) {
            auvid_real_t covariance =
                auvid_estimate_covariance(&chain.id.estimate, &auvid_girona500, i, k);
            TEST_ASSERT_TRUE(covariance == (i == k ? sigma[i] * sigma[i] : 0));
        }
    }
    check_unknown(AUVID_ERR_STATE, pi, sigma);
}

static void test_impossible_known_parameters_are_refused(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS], sigma[AUVID_MAX_PARAMETERS];
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_prior_set(NULL, pi, sigma));
    check_unknown(AUVID_ERR_NULL, NULL, sigma);
    check_unknown(AUVID_ERR_NULL, pi, NULL);
    tank(pi, sigma);
    pi[3] = (auvid_real_t)NAN;
    check_unknown(AUVID_ERR_NOT_FINITE, pi, sigma);
    tank(pi, sigma);
    sigma[3] = (auvid_real_t)INFINITY;
    check_unknown(AUVID_ERR_NOT_FINITE, pi, sigma);
    sigma[3] = 0;
    check_unknown(AUVID_ERR_RANGE, pi, sigma);
    sigma[3] = (auvid_real_t)1e31;
    check_unknown(AUVID_ERR_RANGE, pi, sigma);
    memset(&chain.id, 0, sizeof chain.id);
    check_unknown(AUVID_ERR_STATE, pi, sigma);
}

static void test_a_fixed_parameter_keeps_its_value_beside_known_ones(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS], sigma[AUVID_MAX_PARAMETERS];
    tank(pi, sigma);
    cfg.id.metric.free = AUVID_G500_FREE & ~(1u << AUVID_G500_M_R);
    cfg.id.metric.fixed[AUVID_G500_M_R] = 80;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_set(&chain.id, pi, sigma));
    TEST_ASSERT_EQUAL_DOUBLE(80, (double)chain.id.estimate.pi[AUVID_G500_M_R]);
}

static void check_limit(auvid_status_t status, auvid_real_t value, auvid_real_t error)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS], sigma[AUVID_MAX_PARAMETERS];
    tank(pi, sigma);
    pi[3] = value;
    sigma[3] = error;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    TEST_ASSERT_EQUAL(status, auvid_prior_set(&chain.id, pi, sigma));
}

static void test_known_parameters_are_accepted_up_to_the_limits_of_the_header(void)
{
    const auvid_real_t value = 300, error = 10;
    check_limit(AUVID_OK, AUVID_C(1e18), error);
    check_limit(AUVID_OK, AUVID_C(-1e18), error);
    check_limit(AUVID_ERR_RANGE, AUVID_C(1.01e18), error);
    check_limit(AUVID_ERR_RANGE, AUVID_C(-1.01e18), error);
    check_limit(AUVID_OK, value, AUVID_C(5.1e-31));
    check_limit(AUVID_ERR_RANGE, value, AUVID_C(4.9e-31));
    check_limit(AUVID_ERR_RANGE, value, -error);
    check_limit(AUVID_OK, value, AUVID_C(9.9e29));
    check_limit(AUVID_ERR_RANGE, value, AUVID_C(1e30));
}

static void test_an_impossible_prior_is_refused(void)
{
    auvid_prior_t prior = {.known = 1};
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    auvid_metric_t *metric = &chain.id.metric;
    prior.sigma[0] = prior.variance_inflation[AUVID_SURGE] = 1;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_check(metric, &prior));
    prior.sigma[0] = 0;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_prior_check(metric, &prior));
    prior.sigma[0] = 1;
    prior.variance_inflation[AUVID_SURGE] = 0;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_prior_check(metric, &prior));
    prior.variance_inflation[AUVID_SURGE] = (auvid_real_t)NAN;
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_prior_check(metric, &prior));
}

/* ---- the residual path ---- */

/* Without X_uu: the model contains the true one. */
static void blind_residual(const void *context, const auvid_sample_t *s, const auvid_real_t *pi,
                           auvid_real_t *residual)
{
    auvid_real_t other[AUVID_MAX_PARAMETERS];
    memcpy(other, pi, sizeof other);
    other[AUVID_G500_X_UU] = auvid_girona500_paper[AUVID_G500_X_UU];
    by_residual_predict(context, s, other, residual);
}

static void test_on_the_residual_path_a_prior_is_all_there_is_of_what_the_data_do_not_show(void)
{
    static auvid_row_t rows[3 * 60];
    static auvid_vehicle_t vehicle;
    auvid_real_t pi[AUVID_MAX_PARAMETERS], sigma[AUVID_MAX_PARAMETERS];
    const double mean = -150, error = 10;
    by_residual_surge(&cfg.id, &vehicle, rows, 2);
    vehicle.residual = blind_residual;
    memset(&cfg.id.uncertainty, 0, sizeof cfg.id.uncertainty);
    cfg.budget = 0;
    memcpy(pi, auvid_girona500_paper, sizeof auvid_girona500_paper);
    for (int i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
        sigma[i] = AUVID_C(1e6); /* a guess */
    }
    pi[AUVID_G500_X_UU] = (auvid_real_t)mean;
    sigma[AUVID_G500_X_UU] = (auvid_real_t)error;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_set(&chain.id, pi, sigma));
    chain.id.estimate.number = 0; /* the search does not begin at the means */
    while (chain.id.metric.sets.recorded < 2) {
        chain_tick(&chain);
    }
    (void)chain_finish(&chain, 100000, 100000);
    const auvid_estimate_t *e = &chain.id.estimate;
    TEST_ASSERT_TRUE(e->number > 0);
    TEST_ASSERT_DOUBLE_WITHIN(0.5, mean, (double)e->pi[AUVID_G500_X_UU]);
    double found = (double)e->confidence.sigma[AUVID_G500_X_UU];
    TEST_ASSERT_TRUE(found > 0.5 * error && found < 2.0 * error);
    TEST_ASSERT_DOUBLE_WITHIN(0.1 * 248.8, 248.8, (double)e->pi[AUVID_G500_M_U]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_known_parameters_are_the_first_estimate);
    RUN_TEST(test_impossible_known_parameters_are_refused);
    RUN_TEST(test_a_fixed_parameter_keeps_its_value_beside_known_ones);
    RUN_TEST(test_known_parameters_are_accepted_up_to_the_limits_of_the_header);
    RUN_TEST(test_an_impossible_prior_is_refused);
    RUN_TEST(test_on_the_residual_path_a_prior_is_all_there_is_of_what_the_data_do_not_show);
    return UNITY_END();
}
