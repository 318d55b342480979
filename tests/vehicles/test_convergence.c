/*
 * Six degrees of freedom from 40 s of a log with very small roll and pitch. With its certificate
 * the search ends at the optimum. To the letter of the paper it often ends far from it, sometimes
 * by its own criterion. Each such result, and no other, must be reported as not converged.
 *
 * A result is far from the optimum if coordinate descent in double finds a lower cost within the
 * bounds. A result is at the optimum if no seed finds a cost that is lower by more than a
 * thousandth.
 *
 * Long form (AUVID_TEST_LONG): 200 seeds; or COUNT and FIRST as arguments.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "auvid/fossen.h"
#include "auvid/identifier.h"
#include "base/auvid_linalg_internal.h"
#include "metric/auvid_metric_evaluator_internal.h"
#include "simulator.h"
#include "unity.h"

enum { N = AUVID_FOSSEN_COUNT, MAX_SEEDS = 1000 };
enum { SECONDS = 40, TICKS_PER_S = 1000000 / SIM_TICK_US };

/* The wrench of a DoF: a sine or a square wave. */
typedef struct {
    double amplitude, omega, phase, mean;
    bool square;
} wave_t;

/* A vehicle, its excitation, and the noise of its log. Inputs of the log are in `unit` newtons. The
 * search bounds of all parameters are +-bound. */
typedef struct {
    double centre_m, disturbance_N, disturbance_Nm, noise, bound;
    double unit[AUVID_DOF_COUNT];
    wave_t wave[AUVID_DOF_COUNT];
} world_t;

/* A hundredth of a newton-metre in roll; the inputs are commands. */
static const world_t faint = {-0.0260,
                              0.128,
                              0.0106,
                              0.00116,
                              1000,
                              {100, 100, 70, 20, 20, 20},
                              {{39.7, 0.510, 2.17, 5.90, true},
                               {9.67, 1.930, 4.12, 0, false},
                               {19.9, 1.280, 2.56, 1, true},
                               {0.00989, 1.610, 2.62, 0, true},
                               {0.352, 1.148, 2.17, 0.328, true},
                               {3.17, 1.529, 4.07, 2.77, true}}};
static const world_t weak = {-0.05,
                             0.5,
                             0.05,
                             0.01,
                             1000,
                             {1, 1, 1, 1, 1, 1},
                             {{30, 0.7, 0, 0, true},
                              {30, 0.45, 1, 0, true},
                              {20, 0.9, 0, 1, false},
                              {0.2, 2.0, 0, 0, false},
                              {0.2, 1.7, 0.4, 0, false},
                              {3, 0.6, 2, 0, true}}};

/* The same log with 10 kN for a command of 1, and bounds so wide that they do not help. */
static world_t unbounded(void)
{
    world_t world = weak;
    world.bound = 1e5;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        world.unit[j] = 1e4;
    }
    return world;
}

static sim_t sim;
static auvid_identifier_t id;
static auvid_change_detector_t change;
static auvid_identifier_config_t cfg;

void setUp(void)
{
}

void tearDown(void)
{
}

static double wrench_at(const world_t *world, int j, double t)
{
    const wave_t *w = &world->wave[j];
    double s = sin(w->omega * t + w->phase);
    return w->mean + w->amplitude * (w->square ? (s > 0 ? 1 : -1) : s);
}

static void configure(const world_t *world, uint64_t seed)
{
    bool paper = cfg.search.paper;
    auvid_identifier_defaults(&cfg, &auvid_fossen);
    cfg.exact_inputs = true;
    memset(&cfg.uncertainty, 0, sizeof cfg.uncertainty); /* thrust, DVL and delay are exact */
    cfg.search.seed = seed;
    cfg.search.paper = paper;
    cfg.metric.set_rows = 20;
    cfg.metric.velocity_us = 100000;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        const wave_t *w = &world->wave[j];
        cfg.metric.tau_max[j] = (auvid_real_t)((w->amplitude + w->mean) / world->unit[j]);
    }
    for (int i = 0; i < N; ++i) {
        cfg.search.upper[i] = (auvid_real_t)world->bound;
        cfg.search.lower[i] = -cfg.search.upper[i];
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_change_test(&id, &change));
}

/* Records a row of the log every 0.1 s. */
static void record(const world_t *world, uint64_t log_seed)
{
    sim_config_t vehicle;
    sim_output_t seen;
    sim_rng_t rng;
    sim_bluerov2(&vehicle);
    vehicle.thrusters = 0;
    vehicle.hold_Nm_rad = vehicle.hold_Nms_rad = 0;
    vehicle.fossen.r_b[2] = world->centre_m;
    vehicle.disturbance_N = world->disturbance_N;
    vehicle.disturbance_Nm = world->disturbance_Nm;
    TEST_ASSERT_TRUE(sim_init(&sim, &vehicle));
    vehicle.seed += log_seed;
    sim_rng_seed(&rng, 1 + log_seed, 77);
    for (int k = 0; k < SECONDS * TICKS_PER_S; ++k) {
        double wrench[AUVID_DOF_COUNT], t = (double)k / TICKS_PER_S;
        auvid_real_t attitude[3], nu[AUVID_DOF_COUNT], input[AUVID_DOF_COUNT];
        uint64_t t_us = 1000000u + (uint64_t)k * SIM_TICK_US;
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            double noise = (j < AUVID_ROLL ? 1.0 : 0.2) * world->noise;
            wrench[j] = wrench_at(world, j, t);
            input[j] = (auvid_real_t)(wrench[j] / world->unit[j]);
            nu[j] = (auvid_real_t)(sim.truth.nu[j] + noise * sim_rng_gauss(&rng));
        }
        for (int i = 0; i < 3; ++i) {
            double noise = 0.3 * world->noise * sim_rng_gauss(&rng);
            attitude[i] = (auvid_real_t)(sim.truth.euler[i] + noise);
        }
        if (k % 5 == 0) {
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_motion(&id, t_us, attitude, nu));
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&id, t_us, input, NULL));
        }
        sim_step(&sim, NULL, wrench, &seen);
    }
    TEST_ASSERT_EQUAL(AUVID_SET_COMPLETE, auvid_identifier_close(&id));
}

static void identify(const world_t *world, uint64_t seed, uint64_t log_seed)
{
    configure(world, seed);
    record(world, log_seed);
    while (auvid_identifier_work(&id, 1000) == AUVID_PENDING) {
    }
    TEST_ASSERT_TRUE(id.estimate.number > 0);
}

/* ---- the cost in double ---- */

/* Gets row i of DoF j of the metric's cost, the sum of squares of z - row x. Returns false if there
 * is none. */
static bool row_of(int j, int i, double row[N], double *z)
{
    const auvid_metric_t *m = &id.metric;
    int order = auvid_metric_order(m, j), at = m->layout.channel_at[j];
    if (!(m->result.excited >> j & 1) || i >= m->layout.count[j]) {
        return false;
    }
    const auvid_real_t *r = m->evaluator.merged + m->layout.factor_at[j] + auvid_qr_row(order, i);
    double scale = sqrt((double)m->evaluator.weight[j]);
    memset(row, 0, N * sizeof *row);
    for (int k = i; k < m->layout.count[j]; ++k) {
        row[m->layout.index[at + k]] = scale * (double)r[k - i];
    }
    *z = scale * (double)m->evaluator.z[at + i];
    return true;
}

static double cost_of(const double x[N])
{
    double row[N], z, sum = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        for (int i = 0; row_of(j, i, row, &z); ++i) {
            for (int k = 0; k < N; ++k) {
                z -= row[k] * x[k];
            }
            sum += z * z;
        }
    }
    return sum;
}

/* Minimises the cost along each parameter in turn, within the bounds. */
static void descend(double x[N], int sweeps)
{
    static double a[N][N], b[N];
    double row[N], z;
    memset(a, 0, sizeof a);
    memset(b, 0, sizeof b);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        for (int i = 0; row_of(j, i, row, &z); ++i) {
            for (int k = 0; k < N; ++k) {
                b[k] += row[k] * z;
                for (int q = 0; q < N; ++q) {
                    a[k][q] += row[k] * row[q];
                }
            }
        }
    }
    for (int s = 0; s < sweeps * N; ++s) {
        int k = s % N;
        double slope = b[k];
        for (int q = 0; q < N; ++q) {
            slope -= a[k][q] * x[q];
        }
        if ((id.estimate.identified >> k & 1u) && a[k][k] > 0) {
            x[k] = fmin(fmax(x[k] + slope / a[k][k], (double)cfg.search.lower[k]),
                        (double)cfg.search.upper[k]);
        }
    }
}

/* ---- the tests ---- */

/* In double the search finds all these optima. */
static const bool in_double = sizeof(auvid_real_t) == sizeof(double);

typedef struct {
    double cost, min_cost; /* with the constant part; after a descent */
    bool by_criterion;     /* the line search ended by its own criterion */
    bool not_converged;
    int flags;
} result_t;

static result_t result[MAX_SEEDS];
static int seeds = 8;
static uint64_t first_seed = 1;

/* One search for each seed: of the same log, or of a log of its own. */
static void run(const world_t *world, bool paper, bool own_logs)
{
    cfg.search.paper = paper;
    for (int k = 0; k < seeds; ++k) {
        double x[N];
        result_t *to = &result[k];
        uint64_t seed = first_seed + (uint64_t)k;
        identify(world, seed, own_logs ? seed : 0);
        for (int i = 0; i < N; ++i) {
            x[i] = (double)id.estimate.pi[i];
        }
        to->cost = cost_of(x) + (double)id.metric.result.constant;
        descend(x, 5000);
        to->min_cost = cost_of(x) + (double)id.metric.result.constant;
        to->by_criterion = id.estimate.evaluations_line <
                           1000u * (unsigned)__builtin_popcount(id.estimate.identified);
        to->not_converged = id.estimate.not_converged;
        to->flags = __builtin_popcount(id.estimate.confidence.identifiable);
    }
}

/* Returns the number of results far from the optimum whose search ended by its own criterion. */
static int assert_far_results_are_reported(const world_t *world, const char *name)
{
    int far = 0, by_criterion = 0;
    run(world, true, false);
    for (int k = 0; k < seeds; ++k) {
        const result_t *r = &result[k];
        if (r->cost > 1.001 * r->min_cost) {
            ++far;
            by_criterion += r->by_criterion;
            TEST_ASSERT_TRUE(r->not_converged);
            TEST_ASSERT_EQUAL_INT(0, r->flags);
        }
    }
    printf("%s: %d seeds, %d far from the optimum, %d of them by the search's own criterion\n",
           name, seeds, far, by_criterion);
    TEST_ASSERT_TRUE(far > 0 || in_double);
    return by_criterion;
}

static void test_a_result_far_from_the_optimum_has_not_converged_and_has_no_flags(void)
{
    const world_t world = unbounded();
    (void)assert_far_results_are_reported(&faint, "faint roll");
    (void)assert_far_results_are_reported(&weak, "weak roll and pitch");
    int by_criterion = assert_far_results_are_reported(&world, "wide bounds");
    TEST_ASSERT_TRUE(by_criterion > 0 || in_double); /* else this test would prove nothing */
}

static void test_a_result_at_the_optimum_has_converged(void)
{
    int at = 0;
    run(&weak, false, false);
    double min_cost = HUGE_VAL;
    for (int k = 0; k < seeds; ++k) {
        min_cost = fmin(min_cost, result[k].min_cost);
    }
    for (int k = 0; k < seeds; ++k) {
        if (result[k].cost <= 1.0005 * min_cost && result[k].by_criterion) {
            ++at;
            TEST_ASSERT_FALSE(result[k].not_converged);
            TEST_ASSERT_TRUE(result[k].flags > 0);
        }
    }
    printf("weak roll and pitch: %d of %d seeds at the optimum\n", at, seeds);
    TEST_ASSERT_TRUE(at > 0);
}

static void test_with_its_certificate_the_search_ends_at_the_optimum(void)
{
    const world_t wide = unbounded(), *const worlds[] = {&faint, &weak, &wide};
    const char *const name[] = {"faint roll", "weak roll and pitch", "wide bounds"};
    for (size_t w = 0; w < 3; ++w) {
        double largest = 0.0;
        int unconverged = 0;
        run(worlds[w], false, true);
        for (int k = 0; k < seeds; ++k) {
            largest = fmax(largest, result[k].cost / result[k].min_cost - 1.0);
            unconverged += result[k].not_converged;
        }
        printf("%s: %d logs with a certificate, largest excess %.1e, %d not converged\n", name[w],
               seeds, largest, unconverged);
        TEST_ASSERT_TRUE(largest <= 1e-3);
        TEST_ASSERT_EQUAL_INT(0, unconverged);
    }
}

int main(int argc, char **argv)
{
    seeds = getenv("AUVID_TEST_LONG") != NULL ? 200 : seeds;
    if (argc > 1) {
        seeds = (int)fmin(fmax(atof(argv[1]), 1.0), MAX_SEEDS);
    }
    if (argc > 2) {
        first_seed = strtoull(argv[2], NULL, 10);
    }
    UNITY_BEGIN();
    RUN_TEST(test_with_its_certificate_the_search_ends_at_the_optimum);
    RUN_TEST(test_a_result_far_from_the_optimum_has_not_converged_and_has_no_flags);
    RUN_TEST(test_a_result_at_the_optimum_has_converged);
    return UNITY_END();
}
