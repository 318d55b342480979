// Standard errors of a model without regressor: how often do they cover the truth?
//
// The user's model of tests/unit/identifier/test_user_model.c, thrusters with a dead band, only in
// surge. It contains the Coriolis forces of the simulated vehicle with their true masses, so the
// model is in class under an unmodelled force, too. Eight sets of 30 s at 1 N and 3 N.
//
// Long form (AUVID_TEST_LONG), 240 runs: pooled, one standard error covers 60-76 %, two 90-98 %;
// for a single parameter one covers 55-80 %. Short form, 30 runs: the test fails if these are
// refuted, at 3.3 standard errors of the mean over runs, or at the 99.9 % level (Clopper-Pearson).
//
// A second test compares the two paths: Girona500 through its residuals must have the standard
// errors of its regressor.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <initializer_list>

#include "binomial.h"

extern "C" {
#include "chain.h"
#include "unity.h"
}

void setUp()
{
}

void tearDown()
{
}

static auvid_row_t store[(AUVID_MAX_SETS + 1) * 150];
static auvid_identifier_t id;
static auvid_change_detector_t change;

// ---- the dead band ----

enum { GAIN_FORWARD, GAIN_BACKWARD, DEAD_BAND, X_U, X_UU, PARAMETERS };
enum { SETS = 8, SET_ROWS = 150 };

static const auvid_parameter_t parameter[PARAMETERS] = {
    {"gain_forward", "N", AUVID_SURGE, AUVID_PARAMETER_OTHER},
    {"gain_backward", "N", AUVID_SURGE, AUVID_PARAMETER_OTHER},
    {"dead_band", "1", AUVID_SURGE, AUVID_PARAMETER_OTHER},
    {"X_u", "N s/m", AUVID_SURGE, AUVID_PARAMETER_LINEAR_DRAG},
    {"X_uu", "N s2/m2", AUVID_SURGE, AUVID_PARAMETER_QUADRATIC_DRAG},
};
static const double truth[PARAMETERS] = {70.0, 55.0, 0.12, -42.4181, -125.3578};

static double thrust(double command, const double *pi)
{
    double beyond = std::fabs(command) - pi[DEAD_BAND];
    double force = (command > 0 ? pi[GAIN_FORWARD] : pi[GAIN_BACKWARD]) * std::fmax(beyond, 0);
    return command > 0 ? force : -force;
}

static void residual(const void *, const auvid_sample_t *s, const auvid_real_t *pi, auvid_real_t *e)
{
    double p[PARAMETERS], u = double(s->nu[AUVID_SURGE]);
    for (int i = 0; i < PARAMETERS; ++i) {
        p[i] = double(pi[i]);
    }
    e[AUVID_SURGE] = auvid_real_t(
        249.5384 * double(s->nu_dot[AUVID_SURGE]) -
        367.7126 * double(s->nu[AUVID_SWAY]) * double(s->nu[AUVID_YAW]) +
        659.9799 * double(s->nu[AUVID_HEAVE]) * double(s->nu[AUVID_PITCH]) -
        37.3058 * std::sin(double(s->theta)) - p[X_U] * u - p[X_UU] * std::fabs(u) * u -
        thrust(double(s->command[0]), p) - thrust(double(s->command[1]), p));
}

static auvid_vehicle_t dead_band_vehicle()
{
    auvid_vehicle_t vehicle = {};
    vehicle.built_for = AUVID_BUILD;
    vehicle.path = &auvid_path_residual;
    vehicle.name = "surge with dead band";
    vehicle.parameters = PARAMETERS;
    vehicle.parameter = parameter;
    vehicle.columns[AUVID_SURGE] = (1u << PARAMETERS) - 1;
    vehicle.residual = residual;
    return vehicle;
}

static const auvid_vehicle_t vehicle = dead_band_vehicle();

static void configure(auvid_identifier_config_t *cfg, uint64_t seed)
{
    static const auvid_real_t low[PARAMETERS] = {0, 0, 0, -200, -500};
    static const auvid_real_t high[PARAMETERS] = {300, 300, auvid_real_t(0.5), 0, 0};
    auvid_identifier_defaults(cfg, &vehicle);
    cfg->exact_inputs = true;
    cfg->uncertainty = auvid_uncertainty_t(); // the supplied values are exact here
    cfg->metric.rows = store;
    cfg->metric.row_slots = sizeof store / sizeof store[0];
    cfg->metric.sets = SETS;
    cfg->metric.set_rows = SET_ROWS;
    cfg->metric.row_cells = 2;
    std::memcpy(cfg->search.lower, low, sizeof low);
    std::memcpy(cfg->search.upper, high, sizeof high);
    cfg->search.seed = seed;
}

static void begin(const auvid_identifier_config_t &cfg, uint64_t seed)
{
    static auvid_actuation_t actuation;
    const auvid_real_t amplitude[AUVID_DOF_COUNT] = {1, 0, 0, 0, 0, 0}; // of the command
    auvid_actuation_config_t acting;
    auvid_actuation_defaults(&acting);
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_excitation_plan(&acting.excitation, amplitude, 30, SETS, seed));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_change_test(&id, &change));
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_identifier_attach_actuation(&id, &actuation, &acting, nullptr));
}

static void identify(uint64_t seed, double disturbance_N)
{
    auvid_identifier_config_t cfg;
    sim_config_t world;
    sim_t sim;
    sim_output_t sensed;
    auvid_real_t command = 0;
    bool excited = false;
    configure(&cfg, seed);
    begin(cfg, seed);
    sim_defaults(&world);
    world.seed = seed;
    world.disturbance_N = disturbance_N;
    world.disturbance_Nm = 0.4 * disturbance_N;
    TEST_ASSERT_TRUE(sim_init(&sim, &world));
    while (id.metric.sets.recorded < SETS) {
        auvid_input_t in;
        auvid_output_t out;
        const double wrench[6] = {
            2 * thrust(double(command), truth), 0, -world.parameter[SIM_WB], 0, 0, 0};
        sim_step(&sim, nullptr, wrench, &sensed);
        TEST_ASSERT_TRUE(sim.truth.t_us < (SETS + 2) * 30000000u);
        chain_sense(&sensed, 0, &in);
        if (!excited && auvid_identifier_arm(&id) == AUVID_OK) {
            excited = auvid_identifier_excite(&id) == AUVID_OK;
        }
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&id, &in, &out));
        command = out.excitation[AUVID_SURGE];
        const auvid_real_t nominal[AUVID_DOF_COUNT] = {100 * command};
        const auvid_real_t commands[AUVID_MAX_THRUSTERS] = {command, command};
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&id, in.t_us, nominal, commands));
    }
    int calls = 1; /* the first one only begins */
    while (auvid_identifier_work(&id, UINT32_MAX) == AUVID_PENDING && calls < 10) {
        ++calls;
    }
    TEST_ASSERT_TRUE(calls < 10);
    TEST_ASSERT_EQUAL_UINT32(1, id.estimate.number);
}

struct Share {
    double sum = 0, squares = 0;
    void add(double x)
    {
        sum += x;
        squares += x * x;
    }
    // Long form: is it in [low, high]? Short form: is that not refuted?
    bool within(double runs, double low, double high) const
    {
        double mean = sum / runs, error = std::sqrt((squares / runs - mean * mean) / (runs - 1));
        double slack = campaign_is_long() ? 0 : 3.3 * error;
        std::printf(" %.1f %% +- %.1f", 100 * mean, 196 * error);
        return mean >= low - slack && mean <= high + slack;
    }
};

static bool campaign(double disturbance_N)
{
    double runs = campaign_is_long() ? 240 : 30;
    double one[PARAMETERS] = {}, squares[PARAMETERS] = {}, sigmas[PARAMETERS] = {};
    double bias[PARAMETERS] = {};
    Share within[2];
    for (uint64_t seed = 7600001; seed <= 7600000 + uint64_t(runs); ++seed) {
        double fraction[2] = {};
        identify(seed, disturbance_N);
        for (int i = 0; i < PARAMETERS; ++i) {
            double error = double(id.estimate.pi[i]) / truth[i] - 1;
            double sigma = double(id.estimate.confidence.sigma[i]) / std::fabs(truth[i]);
            one[i] += std::fabs(error) < sigma;
            fraction[0] += double(std::fabs(error) < sigma) / PARAMETERS;
            fraction[1] += double(std::fabs(error) < 2 * sigma) / PARAMETERS;
            squares[i] += error * error / runs;
            bias[i] += error / runs;
            sigmas[i] += sigma / runs;
        }
        within[0].add(fraction[0]);
        within[1].add(fraction[1]);
    }
    std::printf("dead band, %g N, %.0f runs: one", disturbance_N, runs);
    bool held = within[0].within(runs, 0.60, 0.76);
    std::printf(", two");
    held = within[1].within(runs, 0.90, 0.98) && held;
    std::printf("\n");
    for (int i = 0; i < PARAMETERS; ++i) {
        bool full = campaign_is_long();
        std::printf("  %-13s one %5.1f %%, rms %.2f %%, mean %.2f %%, sigma %.2f %%\n",
                    parameter[i].name, 100 * one[i] / runs, 100 * std::sqrt(squares[i]),
                    100 * bias[i], 100 * sigmas[i]);
        held = held && (full ? one[i] / runs : binomial_upper(one[i], runs, 0.001)) >= 0.55 &&
               (full ? one[i] / runs : binomial_lower(one[i], runs, 0.001)) <= 0.80;
    }
    return held;
}

static void test_standard_errors_of_a_model_without_regressor_cover_the_truth()
{
    bool one = campaign(1), three = campaign(3);
    TEST_ASSERT_TRUE(one);
    TEST_ASSERT_TRUE(three);
}

// ---- one vehicle, both paths ----

static void girona500_residual(const void *, const auvid_sample_t *s, const auvid_real_t *pi,
                               auvid_real_t *e)
{
    auvid_vehicle_residual(&auvid_girona500, s, pi, e);
}

static chain_t chain;

static void fly(uint64_t seed, double disturbance_N, const auvid_vehicle_t *model)
{
    chain_config_t cfg;
    chain_defaults(&cfg, seed, SETS, disturbance_N);
    cfg.id.vehicle = model;
    cfg.id.metric.vehicle = model;
    cfg.id.search.has_good = true; // this test is not about the search
    std::memcpy(cfg.id.search.good, auvid_girona500_paper, sizeof auvid_girona500_paper);
    if (model->path == &auvid_path_residual) {
        cfg.id.metric.rows = store;
        cfg.id.metric.row_slots = sizeof store / sizeof store[0];
        cfg.id.metric.set_rows = SET_ROWS;
        cfg.id.metric.row_cells = 2;
    }
    cfg.budget = 0;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, SETS));
    TEST_ASSERT_TRUE(chain_finish(&chain, UINT32_MAX, 10) <= 10);
    TEST_ASSERT_EQUAL_UINT32(1, chain.id.estimate.number);
}

static void test_both_paths_give_similar_standard_errors()
{
    auvid_vehicle_t wrapped = auvid_girona500;
    wrapped.path = &auvid_path_residual;
    wrapped.regressor = nullptr;
    wrapped.residual = girona500_residual;
    double runs = campaign_is_long() ? 40 : 3, sum[SIM_PARAMETERS] = {}, all = 0;
    for (double d : {1.0, 3.0}) {
        double errors[2] = {};
        std::memset(sum, 0, sizeof sum);
        all = 0;
        for (uint64_t seed = 7700001; seed <= 7700000 + uint64_t(runs); ++seed) {
            auvid_real_t sigma[SIM_PARAMETERS];
            fly(seed, d, &auvid_girona500);
            std::memcpy(sigma, chain.id.estimate.confidence.sigma, sizeof sigma);
            errors[0] += chain_mean_square(&chain) / runs;
            fly(seed, d, &wrapped);
            errors[1] += chain_mean_square(&chain) / runs;
            for (int i = 0; i < SIM_PARAMETERS; ++i) {
                double ratio = double(chain.id.estimate.confidence.sigma[i]) / double(sigma[i]);
                sum[i] += std::log(ratio) / runs;
                all += std::log(ratio) / runs / SIM_PARAMETERS;
            }
        }
        std::printf("residual path over regressor path, %g N, %.0f runs: rms error %.2f %% over "
                    "%.2f %%; standard errors, geometric mean %.2f; each",
                    d, runs, 100 * std::sqrt(errors[1]), 100 * std::sqrt(errors[0]), std::exp(all));
        for (double s : sum) {
            std::printf(" %.2f", std::exp(s));
        }
        std::printf("\n");
        // in yaw the residuals are smoothed more than the rows, so there is less information
        TEST_ASSERT_DOUBLE_WITHIN(std::log(1.25), 0, all);
        for (double s : sum) {
            TEST_ASSERT_TRUE(s > std::log(0.6));
            TEST_ASSERT_TRUE(s < std::log(1.8));
        }
    }
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_standard_errors_of_a_model_without_regressor_cover_the_truth);
    RUN_TEST(test_both_paths_give_similar_standard_errors);
    return UNITY_END();
}
