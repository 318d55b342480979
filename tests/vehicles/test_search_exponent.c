/*
 * The search of a user's model whose drag has an exponent to identify, X |u|^n: how near the
 * optimum it ends, and what it takes (search_campaign.h). The model is smooth, but not affine in n.
 * The exponents differ from seed to seed. Half of the seeds have a disturbance of 1 N and a delay.
 */
#include "search_campaign.h"
#include "surge_only.h"

enum { M_U, X, EXPONENT, PARAMETERS };
static const auvid_parameter_t parameter[PARAMETERS] = {
    {"m_u", "kg", AUVID_SURGE, AUVID_PARAMETER_MASS},
    {"X", "N s^n/m^n", AUVID_SURGE, AUVID_PARAMETER_QUADRATIC_DRAG},
    {"n", "1", AUVID_SURGE, AUVID_PARAMETER_OTHER},
};
static const auvid_real_t low[PARAMETERS] = {50, -1000, AUVID_C(0.5)};
static const auvid_real_t high[PARAMETERS] = {1000, 0, 4};
static double truth[PARAMETERS];

static double drag(double coefficient, double exponent, double u)
{
    return coefficient * pow(fabs(u), exponent) * (u > 0.0 ? 1.0 : -1.0);
}

static void residual(const void *context, const auvid_sample_t *s, const auvid_real_t *pi,
                     auvid_real_t *e)
{
    (void)context;
    double force = drag((double)pi[X], (double)pi[EXPONENT], (double)s->nu[AUVID_SURGE]) -
                   -37.3058 * sin((double)s->theta);
    e[AUVID_SURGE] = pi[M_U] * s->nu_dot[AUVID_SURGE] - (auvid_real_t)force - s->tau[AUVID_SURGE];
}

static const auvid_vehicle_t vehicle = {.built_for = AUVID_BUILD,
                                        .path = &auvid_path_residual,
                                        .name = "surge with an exponent",
                                        .parameters = PARAMETERS,
                                        .parameter = parameter,
                                        .columns = {[AUVID_SURGE] = (1u << PARAMETERS) - 1},
                                        .affine = 1u << M_U | 1u << X,
                                        .smooth = true,
                                        .residual = residual};

void setUp(void)
{
}

void tearDown(void)
{
}

/* In place of the simulated vehicle's drag, which is left out. */
static double force(double command, double speed)
{
    return 100.0 * command + drag(truth[X], truth[EXPONENT], speed);
}

static void step(const auvid_identifier_t *unused, const auvid_output_t *out)
{
    (void)unused;
    (void)out;
    campaign_step(&id);
}

static void identify_seed(uint64_t seed)
{
    auvid_identifier_config_t cfg;
    sim_config_t world;
    double delay_s = seed % 2 == 0 ? 0.14 : 0.0;
    sim_defaults(&world);
    truth[M_U] = world.parameter[SIM_M_U];
    truth[X] = -150.0;
    truth[EXPONENT] = 1.4 + 0.1 * (double)(seed % 10);
    world.parameter[SIM_X_U] = world.parameter[SIM_X_UU] = 0.0;
    world.seed = seed;
    world.disturbance_N = seed % 2 == 0 ? 1.0 : 0.0;
    surge_configure(&cfg, &vehicle, low, high, seed);
    surge_identify(&cfg, &world, force, SETS, 0, delay_s);
    campaign_take(&id, truth, (1u << PARAMETERS) - 1u, delay_s);
}

static void test_first_and_later_searches_end_at_the_optimum(void)
{
    each_step = step;
    campaign_run(identify_seed, SETS, "exponent");
}

int main(int argc, char **argv)
{
    campaign_options(argc, argv, 2);
    UNITY_BEGIN();
    RUN_TEST(test_first_and_later_searches_end_at_the_optimum);
    return UNITY_END();
}
