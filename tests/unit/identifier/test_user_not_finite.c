/*
 * A user's residual that is not finite for some samples: no result may look like an estimate, and
 * the note says that the search failed.
 */
#include <math.h>
#include <string.h>

#include "surge_only.h"
#include "unity.h"

enum { M, X, PARAMETERS };

static const auvid_parameter_t parameter[PARAMETERS] = {
    {"m", "kg", AUVID_SURGE, AUVID_PARAMETER_MASS},
    {"X_uu", "N s2/m2", AUVID_SURGE, AUVID_PARAMETER_QUADRATIC_DRAG}};

/* NAN at low speed, as a logarithm of it has. */
static void residual(const void *context, const auvid_sample_t *s, const auvid_real_t *pi,
                     auvid_real_t *e)
{
    auvid_real_t u = s->nu[AUVID_SURGE];
    (void)context;
    e[AUVID_SURGE] = pi[M] * s->nu_dot[AUVID_SURGE] - pi[X] * u * (auvid_real_t)fabs((double)u) -
                     s->tau[AUVID_SURGE];
    if (fabs((double)u) < 0.05) {
        e[AUVID_SURGE] = (auvid_real_t)NAN;
    }
}

static double force(double command, double speed)
{
    (void)speed;
    return 100.0 * command;
}

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_an_estimate_from_a_residual_that_is_not_finite_says_that_it_failed(void)
{
    static const auvid_real_t lower[] = {0, -1000}, upper[] = {1000, 0};
    static const auvid_vehicle_t model = {.built_for = AUVID_BUILD,
                                          .path = &auvid_path_residual,
                                          .name = "nan",
                                          .parameters = PARAMETERS,
                                          .parameter = parameter,
                                          .columns = {3u},
                                          .residual = residual};
    auvid_identifier_config_t cfg;
    sim_config_t world;
    sim_defaults(&world);
    surge_configure(&cfg, &model, lower, upper, 1);
    cfg.metric.free = 3u;
    surge_identify(&cfg, &world, force, SETS, 2000, 0.0);
    const auvid_estimate_t *e = &id.estimate;
    TEST_ASSERT_TRUE(e->number > 0 && e->not_converged);
    TEST_ASSERT_EQUAL_HEX32(0, e->confidence.identifiable);
    for (int i = 0; i < PARAMETERS; ++i) {
        TEST_ASSERT_EQUAL(AUVID_NOTE_NOT_CONVERGED, e->confidence.note[i]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_an_estimate_from_a_residual_that_is_not_finite_says_that_it_failed);
    return UNITY_END();
}
