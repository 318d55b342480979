// Random scenarios: are the "identifiable" flags correct, and are they complete?
//
// A scenario draws the sensors' noise (0.3 to 3 times the usual), the unmodelled force (0 to 3 N,
// none in 15 %), the degrees of freedom that are excited, their amplitudes (10 to 100 %), and the
// number of sets (1 to 8). The estimate is that of the identifier's own search. It is compared
// with the Cramer-Rao bound of the same run (bound.h), over all 13 parameters.
//
// Long form (AUVID_TEST_LONG), 1000 scenarios: among the parameters flagged identifiable, the
// fraction more than 20 % off has a one-sided 95 % Clopper-Pearson bound of at most 0.5 %. Short
// form, 150: it fails if 0.5 % is refuted at the 99 % level. Parameters of one run are not
// independent, so the number of runs with such parameters is printed. Of the parameters whose
// degree of freedom was excited and whose bound's 95 % half-width is at most 10 %, at least 85 %
// are flagged. The short form fails if 85 % is refuted at the 99 % level.
#include <algorithm>
#include <cstdio>
#include <random>

#include "binomial.h"
#include "bound.h"

extern "C" {
#include "chain.h"
}

void setUp()
{
}

void tearDown()
{
}

static chain_t chain;
static const int owner[PARAMETERS] = {0, 1, 2, 5, 2, 0, 0, 1, 1, 2, 2, 5, 5};

struct Scenario {
    double noise, disturbance_N;
    uint32_t sets;
    auvid_real_t amplitude[AUVID_DOF_COUNT];
};

static Scenario draw(uint64_t seed)
{
    static const int dof[4] = {AUVID_SURGE, AUVID_SWAY, AUVID_HEAVE, AUVID_YAW};
    std::mt19937_64 random(seed);
    auto uniform = [&](double a, double b) {
        return a + (b - a) * double(random() >> 11) / 9007199254740992.0;
    };
    auto logarithmic = [&](double a, double b) {
        return std::exp(uniform(std::log(a), std::log(b)));
    };
    Scenario s = {};
    s.disturbance_N = uniform(0, 1) < 0.15 ? 0.0 : uniform(0, 3);
    s.noise = logarithmic(0.3, 3);
    s.sets = 1 + uint32_t(uniform(0, 8));
    bool alike = uniform(0, 1) < 0.5;
    unsigned excited = uniform(0, 1) < 0.4 ? 15u : 1u + unsigned(uniform(0, 15));
    double common = logarithmic(0.1, 1);
    for (int j = 0; j < 4; ++j) {
        double part = alike ? common : logarithmic(0.1, 1), full = dof[j] == AUVID_YAW ? 40 : 100;
        s.amplitude[dof[j]] = auvid_real_t((excited >> j & 1u) ? full * part : 0.0);
    }
    return s;
}

// Input of the bound for a tick: the wrench during the tick, the sensors at its end.
static void note_tick(chain_t *c, auvid_input_t *in)
{
    const sim_truth_t &t = c->sim.truth;
    Tick tick = {
        t.euler[0],
        t.euler[1],
        t.nu[3],
        t.nu[4],
        {double(c->wrench[0]), double(c->wrench[1]), double(c->wrench[2]), double(c->wrench[5])},
        {}};
    for (int i = 0; in->dvl.present && i < 3; ++i) {
        tick.measured.push_back({i, double(in->dvl.sample.velocity[i])});
    }
    if (in->imu.present) {
        tick.measured.push_back({YAW_RATE, double(in->imu.rates[2])});
    }
    if (in->depth.present) {
        tick.measured.push_back({DEPTH, double(in->depth.depth_m)});
    }
    static_cast<Run *>(c->cfg.context)->tick.push_back(tick);
}

// Relative bounds. A prior of a thousand times each value keeps the information regular if a run
// says nothing about a parameter.
static Errors bound_of(Run &run, const sim_config_t &cfg)
{
    Motion start;
    start << 0, 0, 0, 0, cfg.position[2];
    run.motion = undisturbed(run.tick, cfg, start);
    Noise noise = {cfg.dvl_m_s, cfg.imu_rate_rad_s, cfg.depth_m, cfg.disturbance_N};
    Information all = information(run, noise);
    all.diagonal().array() += 1e-6;
    return bound(all);
}

static Errors identify(const Scenario &s, uint64_t seed)
{
    chain_config_t cfg;
    Run run;
    chain_defaults(&cfg, seed, s.sets, s.disturbance_N);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_excitation_plan(&cfg.acting.excitation, s.amplitude,
                                                      CHAIN_SET_S, s.sets, seed));
    cfg.sim.imu_angle_rad *= s.noise;
    cfg.sim.imu_rate_rad_s *= s.noise;
    cfg.sim.dvl_m_s *= s.noise;
    cfg.sim.depth_m *= s.noise;
    cfg.budget = 0;
    cfg.before = note_tick;
    cfg.context = &run;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    sim_output_t nothing = {};
    run.tick.push_back(tick_of(chain.sim.truth, nothing));
    while (chain.id.metric.sets.recorded < s.sets) {
        chain_tick(&chain);
        TEST_ASSERT_TRUE(chain.tick < 1500 * (s.sets + 2));
    }
    TEST_ASSERT_TRUE(chain_finish(&chain, UINT32_MAX, 10) <= 10);
    return bound_of(run, cfg.sim);
}

struct Counts {
    double flagged, off, runs_off, idle, idle_flagged, idle_off, knowable, found, searches, aborted,
        notes[AUVID_NOTE_COUNT];
};

static void count(Counts &c, const Scenario &s, uint64_t seed, const Errors &limit)
{
    const auvid_estimate_t &e = chain.id.estimate;
    bool some_off = false;
    c.searches += e.number > 0;
    c.aborted += (chain.events & AUVID_EVENT_ABORTED) != 0;
    for (int i = 0; i < PARAMETERS; ++i) {
        bool flagged = e.number > 0 && (e.confidence.identifiable >> i & 1u);
        bool excited = s.amplitude[owner[i]] > 0;
        bool knowable = excited && 1.96 * limit(i) <= 0.1;
        double error = double(e.pi[i]) / truth(i) - 1;
        c.flagged += flagged;
        c.idle += !excited;
        c.idle_flagged += flagged && !excited;
        c.idle_off += flagged && !excited && std::fabs(error) > 0.2;
        c.knowable += knowable;
        c.found += knowable && flagged;
        c.notes[e.number > 0 ? e.confidence.note[i] : int(AUVID_NOTE_NOT_EXCITED)] += 1;
        if (flagged && std::fabs(error) > 0.2) {
            c.off += 1;
            some_off = true;
            std::printf(
                "  off: seed %llu, parameter %d, error %.3f, sigma %.3f, bound %.3f; %u sets, "
                "amplitude %.0f, %.2f N, noise %.2f\n",
                static_cast<unsigned long long>(seed), i, error,
                double(e.confidence.sigma[i]) / std::fabs(truth(i)), limit(i), s.sets,
                double(s.amplitude[owner[i]]), s.disturbance_N, s.noise);
        }
    }
    c.runs_off += some_off;
}

static void test_flags_of_identifiability_are_correct_and_complete()
{
    bool full = campaign_is_long();
    Counts c = {};
    uint64_t runs = full ? 1000 : 150;
    for (uint64_t seed = 7100001; seed <= 7100000 + runs; ++seed) {
        Scenario s = draw(seed);
        count(c, s, seed, identify(s, seed));
    }
    double upper = binomial_upper(c.off, c.flagged, 0.05);
    std::printf("%llu scenarios (%.0f with an estimate, %.0f aborted by the guard): %.0f flagged, "
                "%.0f more than 20 %% off (%.3f %%, 95 %% bound %.3f %%; in %.0f runs)\n",
                static_cast<unsigned long long>(runs), c.searches, c.aborted, c.flagged, c.off,
                100 * c.off / c.flagged, 100 * upper, c.runs_off);
    std::printf("not excited: %.0f, flagged through coupling %.0f; bound's half-width <= 10 %%: "
                "%.0f, flagged %.0f "
                "(%.1f %%, 95 %% interval [%.1f, %.1f])\n",
                c.idle, c.idle_flagged, c.knowable, c.found, 100 * c.found / c.knowable,
                100 * binomial_lower(c.found, c.knowable, 0.025),
                100 * binomial_upper(c.found, c.knowable, 0.025));
    for (int note = 0; note < AUVID_NOTE_COUNT; ++note) {
        std::printf("  %5.0f %s\n", c.notes[note],
                    note == 0 ? "identifiable" : auvid_note_str(auvid_note_t(note)));
    }
    TEST_ASSERT_TRUE(c.searches > 0.9 * double(runs));
    TEST_ASSERT_TRUE(c.flagged > 3 * double(runs));
    TEST_ASSERT_TRUE(c.idle_off == 0); // only coupling moved them
    if (full) {
        TEST_ASSERT_TRUE(upper <= 0.005);
        TEST_ASSERT_TRUE(c.found >= 0.85 * c.knowable);
    } else {
        TEST_ASSERT_TRUE(binomial_lower(c.off, c.flagged, 0.01) <= 0.005);
        TEST_ASSERT_TRUE(binomial_upper(c.found, c.knowable, 0.01) >= 0.85);
    }
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_flags_of_identifiability_are_correct_and_complete);
    return UNITY_END();
}
