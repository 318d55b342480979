// Standard errors: how often is the truth within one, and within two of them?
//
// Eight sets of 30 s, all degrees of freedom excited, model in class. At 1 N and 3 N of unmodelled
// force, pooled over runs and parameters: one standard error covers the truth in 60-76 %, two in
// 90-98 %. For a single parameter one standard error covers it in 55-80 %. The parameters of a run
// are not independent, so a run's pooled fraction is one sample: the interval is 1.96 standard
// errors of the mean over runs.
//
// Long form (AUVID_TEST_LONG), 600 runs: the fractions must lie in these ranges. Short form, 200
// runs: the test fails if a range is refuted, at 3.3 standard errors (pooled) or at the 99.9 %
// level
// (one parameter, Clopper-Pearson). The long form also prints runs without force and with an
// unmodelled thruster lag. Without force the noise is smaller than the pooling assumes.
//
// A degree of freedom that is never excited must not affect the others: the same seeds with and
// without it.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "binomial.h"

extern "C" {
#include "chain.h"
#include "unity.h"
}

enum { PARAMETERS = SIM_PARAMETERS, SETS = 8 };
static const int owner[PARAMETERS] = {0, 1, 2, 5, 2, 0, 0, 1, 1, 2, 2, 5, 5};
static chain_t chain;

void setUp()
{
}

void tearDown()
{
}

static double sigma_of(int i)
{
    return double(chain.id.estimate.confidence.sigma[i]) / std::fabs(chain.sim.cfg.parameter[i]);
}

// A whole run, and the search after it. `idle`: the degree of freedom that is not excited, or -1.
static void identify(uint64_t seed, double disturbance_N, double lag_s, int idle)
{
    auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 100, 100, 0, 0, 40};
    chain_config_t cfg;
    chain_defaults(&cfg, seed, SETS, disturbance_N);
    if (idle >= 0) {
        amplitude[idle] = 0;
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_excitation_plan(&cfg.acting.excitation, amplitude,
                                                      CHAIN_SET_S, SETS, seed));
    cfg.sim.lag_s = lag_s;
    cfg.budget = 0;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, SETS));
    TEST_ASSERT_TRUE(chain_finish(&chain, UINT32_MAX, 10) <= 10);
    TEST_ASSERT_EQUAL_UINT32(1, chain.id.estimate.number);
    TEST_ASSERT_EQUAL_UINT32(SETS, chain.id.estimate.sets);
}

// Fractions of a run's errors within one and within two standard errors, over runs.
struct Fractions {
    double runs = 0, sum[2] = {}, squares[2] = {};
    void add(const double within[2])
    {
        for (int k = 0; k < 2; ++k) {
            sum[k] += within[k];
            squares[k] += within[k] * within[k];
        }
        runs += 1;
    }
    double mean(int k) const
    {
        return sum[k] / runs;
    }
    double error(int k) const
    {
        return std::sqrt((squares[k] / runs - mean(k) * mean(k)) / (runs - 1));
    }
    void print() const
    {
        std::printf("one %.1f %% +- %.1f, two %.1f %% +- %.1f", 100 * mean(0), 196 * error(0),
                    100 * mean(1), 196 * error(1));
    }
};

struct Coverage {
    double one[PARAMETERS] = {}, squares[PARAMETERS] = {}, sigmas[PARAMETERS] = {};
    Fractions fraction;
    void add()
    {
        double within[2] = {};
        for (int i = 0; i < PARAMETERS; ++i) {
            double error = std::fabs(chain_error(&chain, i)), sigma = sigma_of(i);
            one[i] += error < sigma;
            within[0] += double(error < sigma) / PARAMETERS;
            within[1] += double(error < 2 * sigma) / PARAMETERS;
            squares[i] += error * error;
            sigmas[i] += sigma;
        }
        fraction.add(within);
    }
    void print(const char *title) const
    {
        const double runs = fraction.runs;
        std::printf("%s, %.0f runs: ", title, runs);
        fraction.print();
        std::printf("\n  each one %%");
        for (double k : one) {
            std::printf(" %5.1f", 100 * k / runs);
        }
        std::printf("\n  rms %%     ");
        for (double s : squares) {
            std::printf(" %5.2f", 100 * std::sqrt(s / runs));
        }
        std::printf("\n  sigma %%   ");
        for (double s : sigmas) {
            std::printf(" %5.2f", 100 * s / runs);
        }
        std::printf("\n");
    }
};

// Drag force of the same runs at 0.3, 0.6 and 1.0 of the largest speed in each direction.
struct DragCoverage {
    enum { PARTS = 3 };
    double flagged = 0, one[PARTS] = {}, squares[PARTS] = {};
    Fractions fraction;
    void add()
    {
        static const double part[PARTS] = {0.3, 0.6, 1.0};
        static const int dof[] = {AUVID_SURGE, AUVID_SWAY, AUVID_HEAVE, AUVID_YAW};
        const auvid_estimate_t &e = chain.id.estimate;
        const double *truth = chain.sim.cfg.parameter + SIM_X_U;
        double within[2] = {};
        for (int k = 0; k < 4 * 2 * PARTS; ++k) {
            int j = k / 6, backward = k / 3 % 2;
            double v = part[k % 3] * double(e.speed[dof[j]][backward]) * (backward ? -1 : 1);
            auvid_drag_t drag;
            TEST_ASSERT_EQUAL(AUVID_OK,
                              auvid_estimate_drag(&e, &auvid_girona500, auvid_dof_t(dof[j]),
                                                  auvid_real_t(v), &drag));
            double force = truth[2 * j] * v + truth[2 * j + 1] * v * std::fabs(v);
            double error = double(drag.force) - force, sigma = double(drag.sigma);
            flagged += drag.identifiable;
            one[k % 3] += (std::fabs(error) < sigma) / 8.0;
            squares[k % 3] += error * error / force / force / 8.0;
            within[0] += (std::fabs(error) < sigma) / 24.0;
            within[1] += (std::fabs(error) < 2 * sigma) / 24.0;
        }
        fraction.add(within);
    }
    void print() const
    {
        const double runs = fraction.runs;
        std::printf("  drag force: ");
        fraction.print();
        std::printf("; flagged %.1f %%", 100 * flagged / runs / 24);
        for (int k = 0; k < PARTS; ++k) {
            std::printf("; rms %.2f %%, one %.1f %%", 100 * std::sqrt(squares[k] / runs),
                        100 * one[k] / runs);
        }
        std::printf("\n");
    }
};

static void check_fraction(const Fractions &fraction, int k, double low, double high)
{
    double slack = campaign_is_long() ? 0 : 3.3 * fraction.error(k);
    TEST_ASSERT_TRUE(fraction.mean(k) >= low - slack);
    TEST_ASSERT_TRUE(fraction.mean(k) <= high + slack);
}

static void check(const Coverage &c)
{
    check_fraction(c.fraction, 0, 0.60, 0.76);
    check_fraction(c.fraction, 1, 0.90, 0.98);
    for (double k : c.one) {
        bool full = campaign_is_long();
        double n = c.fraction.runs;
        TEST_ASSERT_TRUE((full ? k / n : binomial_upper(k, n, 0.001)) >= 0.55);
        TEST_ASSERT_TRUE((full ? k / n : binomial_lower(k, n, 0.001)) <= 0.80);
    }
}

static Coverage campaign(const char *title, uint64_t runs, double disturbance_N, double lag_s,
                         DragCoverage *drag = nullptr)
{
    Coverage c;
    DragCoverage d;
    for (uint64_t seed = 7200001; seed <= 7200000 + runs; ++seed) {
        identify(seed, disturbance_N, lag_s, -1);
        c.add();
        d.add();
    }
    c.print(title);
    d.print();
    if (drag != nullptr) {
        *drag = d;
    }
    return c;
}

static void test_one_and_two_standard_errors_cover_the_truth_as_often_as_they_should()
{
    uint64_t runs = campaign_is_long() ? 600 : 100;
    DragCoverage drag[2];
    Coverage one = campaign("1 N", runs, 1, 0, &drag[0]);
    Coverage three = campaign("3 N", runs, 3, 0, &drag[1]);
    if (campaign_is_long()) {
        (void)campaign("0 N", 200, 0, 0);
        (void)campaign("0 N, lag 0.15 s", 200, 0, 0.15);
        (void)campaign("1 N, lag 0.15 s", 200, 1, 0.15);
        (void)campaign("3 N, lag 0.15 s", 200, 3, 0.15);
    }
    check(one);
    check(three);
    for (const DragCoverage &d : drag) {
        check_fraction(d.fraction, 0, 0.60, 0.80);
        check_fraction(d.fraction, 1, 0.92, 0.98);
    }
}

// ---- a degree of freedom that is never excited ----

static const char *const dof_name[AUVID_DOF_COUNT] = {"surge", "sway",  "heave",
                                                      "roll",  "pitch", "yaw"};

static void check_words(int idle)
{
    char text[160], all[1000] = "";
    const auvid_confidence_t &c = chain.id.estimate.confidence;
    for (unsigned k = 0; auvid_confidence_missing(&c, &auvid_girona500, AUVID_G500_FREE, k, text,
                                                  sizeof text) == AUVID_OK;
         ++k) {
        std::strcat(std::strcat(all, text), "\n");
    }
    std::string expected = std::string(dof_name[idle]) + ": unactuated";
    bool coupled = (chain.id.estimate.coupled >> idle & 1) != 0;
    const char *found = std::strstr(all, expected.c_str());
    TEST_ASSERT_TRUE((found != nullptr) != coupled);
    TEST_ASSERT_NULL(std::strstr(found != nullptr ? found + expected.size() : all, "unactuated"));
    TEST_ASSERT_NULL(std::strstr(all, "not excited"));
}

static void check_idle(int idle)
{
    const auvid_confidence_t &c = chain.id.estimate.confidence;
    for (int i = 0; i < PARAMETERS; ++i) {
        if (owner[i] == idle && (chain.id.estimate.coupled >> idle & 1) != 0) {
            bool flagged = (c.identifiable >> i & 1u) != 0;
            TEST_ASSERT_TRUE(!flagged || std::fabs(chain_error(&chain, i)) < 0.2);
        } else if (owner[i] == idle) {
            TEST_ASSERT_EQUAL(AUVID_NOTE_NOT_EXCITED, c.note[i]);
            TEST_ASSERT_TRUE(c.sigma[i] == AUVID_LARGEST);
            TEST_ASSERT_EQUAL(0, c.identifiable >> i & 1u);
        } else {
            TEST_ASSERT_TRUE(c.sigma[i] < AUVID_LARGEST);
        }
    }
    TEST_ASSERT_TRUE(chain.id.estimate.coupled != 0 || c.effective_noise[idle] == 0);
    check_words(idle);
}

struct Pairs {
    std::vector<double> all, without; // mean square relative error of the other parameters
    double ratio() const
    {
        double a = 0, b = 0;
        for (size_t k = 0; k < all.size(); ++k) {
            a += all[k];
            b += without[k];
        }
        return std::sqrt(b / a);
    }
    // Standard error of that ratio, by the delta method over runs.
    double error() const
    {
        double r = ratio(), a = 0, squares = 0, n = double(all.size());
        for (size_t k = 0; k < all.size(); ++k) {
            double e = without[k] - r * r * all[k];
            a += all[k];
            squares += e * e;
        }
        return std::sqrt(squares / n / (n - 1)) / (a / n) / (2 * r);
    }
};

static double others_square(int idle)
{
    double sum = 0, n = 0;
    for (int i = 0; i < PARAMETERS; ++i) {
        if (owner[i] != idle) {
            sum += chain_error(&chain, i) * chain_error(&chain, i);
            n += 1;
        }
    }
    return sum / n;
}

// The excitation of the others has other random draws, so only the average can be compared. Less
// coupled motion gives less information: up to 1.15 times the rms error counts as unchanged.
static void test_a_dof_never_excited_is_reported_and_leaves_the_others_unchanged()
{
    uint64_t runs = campaign_is_long() ? 150 : 16;
    static const int dofs[4] = {AUVID_SURGE, AUVID_SWAY, AUVID_HEAVE, AUVID_YAW};
    double worst = 0;
    Pairs of[AUVID_DOF_COUNT];
    for (uint64_t seed = 7300001; seed <= 7300000 + runs; ++seed) {
        identify(seed, 1, 0, -1);
        for (int idle : dofs) {
            of[idle].all.push_back(others_square(idle));
        }
    }
    for (int idle : dofs) {
        Pairs &pairs = of[idle];
        double one = 0, n = 0;
        for (uint64_t seed = 7300001; seed <= 7300000 + runs; ++seed) {
            identify(seed, 1, 0, idle);
            pairs.without.push_back(others_square(idle));
            check_idle(idle);
            for (int i = 0; i < PARAMETERS; ++i) {
                one += owner[i] != idle && std::fabs(chain_error(&chain, i)) < sigma_of(i);
                n += owner[i] != idle;
            }
        }
        double refuted = pairs.ratio() - (campaign_is_long() ? 1.96 : 3) * pairs.error();
        std::printf("%s not excited, %llu pairs at 1 N: rms error of the others %.2f +- %.2f times "
                    "that with all excited; one standard error covers %.1f %%\n",
                    dof_name[idle], static_cast<unsigned long long>(runs), pairs.ratio(),
                    1.96 * pairs.error(), 100 * one / n);
        worst = std::fmax(worst, refuted);
    }
    TEST_ASSERT_TRUE(worst <= 1.15);
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_one_and_two_standard_errors_cover_the_truth_as_often_as_they_should);
    RUN_TEST(test_a_dof_never_excited_is_reported_and_leaves_the_others_unchanged);
    return UNITY_END();
}
