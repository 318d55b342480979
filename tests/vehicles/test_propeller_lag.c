/*
 * Propellers whose speed lags behind the command, and thrust with wrong timestamps. The
 * identifiable flags must be correct, and most flags must remain.
 *
 * The thrust of a propeller is k n |n|. Its speed n follows the command with a first-order lag
 * (0.05-0.3 s). Then neither a delay nor a first-order lag describes the thrust. A timestamp is
 * late if it is later than the time at which the thrust acted. Then the delay from thrust to motion
 * is negative. Timestamps are 0.1 s early to 0.2 s late.
 *
 * There are five vehicles: Girona500; vehicles of about 20, 60 and 1500 kg; and BlueROV2 Heavy in
 * six degrees of freedom, with the centre of buoyancy 5 cm up. The parameters of the second to
 * fourth are drawn within +-25 % of Girona500's, scaled. The smallest has twice the drag and a
 * quarter of the yaw inertia, which is then hardly separable from a delay. All degrees of freedom
 * are excited, 8 sets of 30 s (BlueROV2: 90 s). The disturbance is 1 % of the amplitude (BlueROV2:
 * 0.2 N, 0.08 Nm).
 *
 * A flag is wrong if its parameter is more than 20 % off, and the error's force at the largest
 * motion of the run is above 2 % of the amplitude. For W-B only the force decides. "Kept" is the
 * fraction of the flags that the same run has without lag and with correct timestamps.
 *
 * Short form: one run of each vehicle and kind. Long form (AUVID_TEST_LONG): 400 runs of each kind.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "auvid/fossen.h"
#include "chain.h"
#include "finish.h"
#include "unity.h"

enum { N = AUVID_MAX_PARAMETERS, SETS = 8, TICKS_PER_S = 1000000 / SIM_TICK_US, PAST = 32 };
enum { GIRONA500, SMALL, MIDDLE, LARGE, BLUEROV2, VEHICLES };

static const char *const name_of[VEHICLES] = {"Girona500", "20 kg", "60 kg", "1500 kg", "BlueROV2"};

/* The fault of a run. */
typedef struct {
    double lag_s; /* lag of the propellers' speed */
    int late;     /* delay of timestamps [ticks]; negative: early */
} fault_t;

static sim_t sim;
static sim_config_t world;
static auvid_identifier_t id;
static auvid_change_detector_t change;
static auvid_identifier_config_t cfg;
static auvid_actuation_config_t acting;
static auvid_actuation_t actuation;
static auvid_allocation_config_t thrusters;
static auvid_allocation_t allocation;
static double truth[N];
static double speed[SIM_THRUSTERS];        /* square root of the thrust, signed */
static double largest[2][AUVID_DOF_COUNT]; /* velocity and acceleration of a run */

void setUp(void)
{
}

void tearDown(void)
{
}

/* ---- vehicles ---- */

/* Makes a vehicle with k times Girona500's mass and the same density. */
static void scale_girona500(int v, double k)
{
    static const double power[SIM_PARAMETERS] = {1,       1,       1,       5. / 3., 2. / 3.,
                                                 2. / 3., 2. / 3., 2. / 3., 2. / 3., 2. / 3.,
                                                 2. / 3., 4. / 3., 5. / 3.};
    double force = pow(k, 2. / 3.);
    sim_rng_t rng;
    sim_defaults(&world);
    sim_rng_seed(&rng, 77, (uint64_t)v);
    thrusters = auvid_allocation_girona500;
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        double factor = v == GIRONA500 ? 1 : 0.75 + 0.5 * sim_rng_uniform(&rng);
        world.parameter[i] *= factor * pow(k, power[i]);
        truth[i] = world.parameter[i];
    }
    if (v == SMALL) { /* an open frame */
        for (int i = SIM_X_U; i < SIM_PARAMETERS; ++i) {
            truth[i] = world.parameter[i] *= 2;
        }
        truth[SIM_M_R] = world.parameter[SIM_M_R] /= 4;
    }
    world.tilt_inertia *= pow(k, 5. / 3.);
    world.tilt_linear *= pow(k, 4. / 3.);
    world.tilt_quadratic *= pow(k, 5. / 3.);
    world.tilt_righting *= pow(k, 4. / 3.);
    world.roll_arm_m *= cbrt(k);
    world.pitch_arm_m *= cbrt(k);
    world.thruster_max_N *= force;
    for (int t = 0; t < world.thrusters; ++t) {
        thrusters.thruster[t].max_N *= (auvid_real_t)force;
        thrusters.thruster[t].min_N *= (auvid_real_t)force;
        for (int j = AUVID_ROLL; j < AUVID_DOF_COUNT; ++j) {
            world.thruster_matrix[j][t] *= cbrt(k);
            thrusters.thruster[t].wrench[j] *= (auvid_real_t)cbrt(k);
        }
    }
}

/* The centre of buoyancy is 5 cm up, so the lagging thrusters need not keep it upright. See
 * test_bluerov2.c for the shorter filter and the sequences. */
static void make_bluerov2(void)
{
    sim_bluerov2(&world);
    world.hold_Nm_rad = world.hold_Nms_rad = 0;
    world.fossen.r_b[2] = -0.05;
    sim_fossen_parameters(&world.fossen, truth);
    thrusters = auvid_allocation_bluerov2_heavy;
    cfg.metric.half_width[1] = 4;
    acting.guard.roll_max_rad = acting.guard.pitch_max_rad = AUVID_C(1.2);
    acting.guard.yaw_rate_max = AUVID_C(3.0);
}

static void shorten_tilt_periods(void)
{
    for (int i = 0; i < acting.excitation.segments; ++i) {
        auvid_segment_t *segment = &acting.excitation.segment[i];
        if (segment->dof == AUVID_ROLL || segment->dof == AUVID_PITCH) {
            segment->frequency_hz = AUVID_C(0.1);
            segment->frequency_high_hz = AUVID_C(0.8);
            segment->hold_min_s = 1;
            segment->hold_max_s = 3;
        }
    }
}

static void make_vehicle(int v, uint64_t seed, const auvid_uncertainty_t *uncertainty)
{
    static const double size[VEHICLES] = {1, 0.06, 0.18, 4.5, 0};
    static const auvid_real_t rov[AUVID_DOF_COUNT] = {40, 40, 35, 1.5, 1.5, 6};
    auvid_real_t amplitude[AUVID_DOF_COUNT] = {0};
    auvid_actuation_defaults(&acting);
    auvid_identifier_defaults(&cfg, v == BLUEROV2 ? &auvid_bluerov2_heavy : &auvid_girona500);
    cfg.exact_inputs = true;
    if (v == BLUEROV2) {
        make_bluerov2();
        memcpy(amplitude, rov, sizeof rov);
    } else {
        scale_girona500(v, size[v]);
        amplitude[AUVID_SURGE] = amplitude[AUVID_SWAY] = amplitude[AUVID_HEAVE] =
            (auvid_real_t)(100 * pow(size[v], 2. / 3.));
        amplitude[AUVID_YAW] = (auvid_real_t)(40 * pow(size[v], 4. / 3.));
    }
    uint32_t set_s = v == BLUEROV2 ? 90 : 30;
    world.seed = cfg.search.seed = seed;
    world.disturbance_N = v == BLUEROV2 ? 0.2 : 0.01 * (double)amplitude[AUVID_SURGE];
    world.disturbance_Nm = v == BLUEROV2 ? 0.08 : 0.01 * (double)amplitude[AUVID_YAW];
    cfg.uncertainty = *uncertainty;
    cfg.metric.set_rows = (uint16_t)(2 * set_s);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        cfg.metric.tau_max[j] = amplitude[j] > 0 ? amplitude[j] : cfg.metric.tau_max[j];
    }
    for (int i = 0; i < cfg.vehicle->parameters && v != BLUEROV2; ++i) {
        cfg.search.upper[i] = (auvid_real_t)(8 * fabs(truth[i]));
        cfg.search.lower[i] = -cfg.search.upper[i];
    }
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_excitation_plan(&acting.excitation, amplitude, set_s, SETS, seed));
    if (v == BLUEROV2) {
        shorten_tilt_periods();
    }
}

/* ---- thrust ---- */

/* Computes the thrusters' mean force over the next tick for the command `force`. */
static void apply_lag(const fault_t *fault, const double *force, double *acting)
{
    double left = fault->lag_s > 0 ? exp(-1e-6 * SIM_TICK_US / fault->lag_s) : 0;
    for (int i = 0; i < world.thrusters; ++i) {
        double n = copysign(sqrt(fabs(force[i])), force[i]), before = speed[i];
        double middle = n + sqrt(left) * (before - n);
        speed[i] = n + left * (before - n);
        acting[i] =
            fault->lag_s > 0
                ? (before * fabs(before) + 4 * middle * fabs(middle) + speed[i] * fabs(speed[i])) /
                      6
                : force[i];
    }
}

/* ---- a run ---- */

static double past[PAST][SIM_THRUSTERS]; /* commanded thrust of each tick */

static void record_motion(void)
{
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        largest[0][j] = fmax(largest[0][j], fabs(sim.truth.nu[j]));
        largest[1][j] = fmax(largest[1][j], fabs(sim.truth.nu_dot[j]));
    }
}

static void begin(int v, auvid_allocation_result_t *hover)
{
    auvid_real_t lift[AUVID_DOF_COUNT] = {0};
    TEST_ASSERT_TRUE(sim_init(&sim, &world));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_change_test(&id, &change));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&allocation, &thrusters));
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_identifier_attach_actuation(&id, &actuation, &acting, &allocation));
    lift[AUVID_HEAVE] = (auvid_real_t)(-truth[v == BLUEROV2 ? (int)AUVID_FOSSEN_W_B : (int)SIM_WB]);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_solve(&allocation, lift, hover));
    memset(largest, 0, sizeof largest);
    for (int i = 0; i < world.thrusters; ++i) {
        double force = (double)hover->force_N[i];
        speed[i] = copysign(sqrt(fabs(force)), force);
        for (int k = 0; k < PAST; ++k) {
            past[k][i] = force;
        }
    }
}

/* Passes the thrust of `late` ticks ago to the identifier. */
static void pass_thrust(uint64_t t_us, const double *force)
{
    auvid_real_t wrench[AUVID_DOF_COUNT];
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        double sum = 0;
        for (int i = 0; i < world.thrusters; ++i) {
            sum += world.thruster_matrix[j][i] * force[i];
        }
        wrench[j] = (auvid_real_t)sum;
    }
    (void)auvid_identifier_applied(&id, t_us, wrench, NULL);
}

static void identify(int v, uint64_t seed, const fault_t *fault,
                     const auvid_uncertainty_t *uncertainty)
{
    int held = fault->late > 0 ? fault->late : 0, early = fault->late < 0 ? -fault->late : 0;
    auvid_allocation_result_t hover;
    make_vehicle(v, seed, uncertainty);
    begin(v, &hover);
    int ticks = (SETS * cfg.metric.set_rows / 2 + 6) * TICKS_PER_S;
    for (int k = 0; k < ticks; ++k) {
        double acting[SIM_THRUSTERS] = {0}, *next = past[(k + 1) % PAST];
        sim_output_t seen;
        auvid_input_t in;
        auvid_output_t out;
        apply_lag(fault, past[(k + PAST - early) % PAST], acting);
        sim_step(&sim, acting, NULL, &seen);
        record_motion();
        chain_sense(&seen, 0, &in);
        if (actuation.guard.state == AUVID_GUARD_DISARMED &&
            auvid_identifier_arm(&id) == AUVID_OK) {
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_excite(&id));
        }
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&id, &in, &out));
        TEST_ASSERT_EQUAL_STRING(
            "", out.guard == AUVID_GUARD_ABORTED ? auvid_guard_cause_str(out.cause) : "");
        for (int i = 0; i < world.thrusters; ++i) {
            next[i] = (double)(out.thruster_N[i] + hover.force_N[i]);
        }
        pass_thrust(in.t_us, past[(k + 1 + PAST - held) % PAST]);
    }
    finish_work(&id, 100000);
    TEST_ASSERT_EQUAL_UINT32(SETS, id.estimate.sets);
}

static double error_of(int i)
{
    return (double)id.estimate.pi[i] - truth[i];
}

static bool is_wrong(int i)
{
    const auvid_parameter_t *p = &cfg.vehicle->parameter[i];
    int j = (int)p->dof;
    bool mass = p->kind == AUVID_PARAMETER_MASS || p->kind == AUVID_PARAMETER_INERTIA;
    bool quadratic = p->kind == AUVID_PARAMETER_QUADRATIC_DRAG;
    bool drag = quadratic || p->kind == AUVID_PARAMETER_LINEAR_DRAG;
    double motion = (mass   ? largest[1][j]
                     : drag ? largest[0][j]
                            : 1) *
                    (quadratic ? largest[0][j] : 1);
    double error = fabs(error_of(i));
    return (strcmp(p->name, "W-B") == 0 || error > 0.2 * fabs(truth[i])) &&
           error * motion > 0.02 * (double)cfg.metric.tau_max[j];
}

/* ---- campaign ---- */

enum { FLAGS, KEPT, WRONG, BEFORE, COUNTS }; /* BEFORE: in the run without fault */

typedef struct {
    int runs;
    int sum[COUNTS];
    int of[400][COUNTS]; /* of each run */
} tally_t;

static tally_t tally[VEHICLES + 1]; /* last: all */

static uint32_t flagged(void)
{
    return id.estimate.confidence.identifiable & ~id.estimate.confidence.implausible;
}

static void count(tally_t *to, const int *counts)
{
    for (int k = 0; k < COUNTS; ++k) {
        to->sum[k] += counts[k];
        to->of[to->runs][k] = counts[k];
    }
    ++to->runs;
}

/* Runs the same seed without and with the fault. */
static void compare(int v, uint64_t seed, const fault_t *fault,
                    const auvid_uncertainty_t *uncertainty)
{
    const fault_t none = {0, 0};
    identify(v, seed, &none, uncertainty);
    uint32_t before = flagged();
    identify(v, seed, fault, uncertainty);
    uint32_t now = flagged();
    int counts[COUNTS] = {__builtin_popcount(now), __builtin_popcount(now & before), 0,
                          __builtin_popcount(before)};
    for (int i = 0; i < cfg.vehicle->parameters; ++i) {
        bool wrong = (now >> i & 1u) != 0 && is_wrong(i);
        counts[WRONG] += wrong;
        if (wrong) {
            printf("  %s, seed %llu, lag %.2f s, stamps %.2f s late: %s %.4g, is %.4g\n",
                   name_of[v], (unsigned long long)seed, fault->lag_s,
                   1e-6 * SIM_TICK_US * fault->late, cfg.vehicle->parameter[i].name,
                   (double)id.estimate.pi[i], truth[i]);
        }
    }
    count(&tally[v], counts);
    count(&tally[VEHICLES], counts);
}

static double ratio(const tally_t *t, const int *run, int over, int under)
{
    double sum[2] = {0, 0};
    for (int k = 0; k < t->runs; ++k) {
        sum[0] += t->of[run == NULL ? k : run[k]][over];
        sum[1] += t->of[run == NULL ? k : run[k]][under];
    }
    return sum[1] > 0 ? 100 * sum[0] / sum[1] : 0;
}

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Prints a ratio like "3.1 % (2.7 .. 3.6)", with its 95 % interval by bootstrap over runs. */
static void print_ratio(const char *title, const tally_t *t, int over, int under)
{
    enum { DRAWS = 1000 };
    static double drawn[DRAWS];
    int run[400];
    sim_rng_t rng;
    sim_rng_seed(&rng, 1, 99);
    for (int d = 0; d < DRAWS; ++d) {
        for (int k = 0; k < t->runs; ++k) {
            run[k] = (int)(sim_rng_uniform(&rng) * t->runs);
        }
        drawn[d] = ratio(t, run, over, under);
    }
    qsort(drawn, DRAWS, sizeof drawn[0], ascending);
    printf("%s %.2f %% (%.2f .. %.2f)", title, ratio(t, NULL, over, under), drawn[DRAWS / 40],
           drawn[DRAWS - DRAWS / 40]);
}

static void print_tally(const char *name, const tally_t *t)
{
    printf("%-10s %3d runs: ", name, t->runs);
    print_ratio("wrong", t, WRONG, FLAGS);
    print_ratio(" of the flags;", t, KEPT, BEFORE);
    printf(" of %d kept\n", t->sum[BEFORE]);
}

/* Kind of fault: lag, timestamps or both. */
typedef enum { LAG, STAMPS, BOTH } kind_t;

static fault_t draw(uint64_t seed, kind_t kind)
{
    sim_rng_t rng;
    sim_rng_seed(&rng, seed, 4711);
    double lag_s = 0.05 + 0.25 * sim_rng_uniform(&rng);
    int late = (int)lrint((-0.1 + 0.3 * sim_rng_uniform(&rng)) * TICKS_PER_S);
    fault_t fault = {kind == STAMPS ? 0 : lag_s, kind == LAG ? 0 : late};
    return fault;
}

static int runs_of(int in_short)
{
    return getenv("AUVID_TEST_LONG") != NULL ? 400 : in_short;
}

static void campaign(const char *title, kind_t kind, uint64_t first)
{
    auvid_identifier_config_t usual;
    int runs = runs_of(VEHICLES);
    memset(tally, 0, sizeof tally);
    auvid_identifier_defaults(&usual, &auvid_girona500);
    usual.uncertainty.thrust_scale = usual.uncertainty.dvl_scale = 0;
    for (int run = 0; run < runs; ++run) {
        fault_t fault = draw(first + (uint64_t)run, kind);
        compare(run % VEHICLES, first + (uint64_t)run, &fault, &usual.uncertainty);
    }
    printf("%s\n", title);
    for (int v = 0; v < VEHICLES; ++v) {
        print_tally(name_of[v], &tally[v]);
    }
    print_tally("all", &tally[VEHICLES]);
    TEST_ASSERT_TRUE(ratio(&tally[VEHICLES], NULL, WRONG, FLAGS) <= 1);
    TEST_ASSERT_TRUE(ratio(&tally[VEHICLES], NULL, KEPT, BEFORE) >= 60);
}

static void test_with_a_lag_of_the_propellers_speed_flags_are_correct(void)
{
    campaign("propellers lag", LAG, 810001);
}

static void test_with_wrong_timestamps_flags_are_correct(void)
{
    campaign("wrong stamps", STAMPS, 820001);
}

static void test_with_a_lag_and_wrong_timestamps_flags_are_correct(void)
{
    campaign("propellers lag and stamps are wrong", BOTH, 830001);
}

static void test_without_the_delays_uncertainty_flags_are_wrong(void)
{
    const auvid_uncertainty_t none = {0, 0, 0};
    const fault_t late = {0, 5}, worst = {0.3, 10};
    memset(tally, 0, sizeof tally);
    compare(SMALL, 1, &worst, &none);
    compare(GIRONA500, 1, &late, &none);
    TEST_ASSERT_TRUE(tally[SMALL].sum[WRONG] > 0);
    TEST_ASSERT_TRUE(tally[GIRONA500].sum[WRONG] > 0);
}

static void test_with_the_longest_lag_and_the_latest_timestamps_flags_are_correct(void)
{
    const auvid_uncertainty_t usual = {0, 0, AUVID_C(0.1)};
    const fault_t worst = {0.3, 10};
    memset(tally, 0, sizeof tally);
    for (int v = 0; v < VEHICLES; ++v) {
        compare(v, 1, &worst, &usual);
    }
    print_tally("0.3 s, 0.2 s late", &tally[VEHICLES]);
    TEST_ASSERT_EQUAL_INT(0, tally[VEHICLES].sum[WRONG]);
    TEST_ASSERT_TRUE(ratio(&tally[VEHICLES], NULL, KEPT, BEFORE) >= 60);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_without_the_delays_uncertainty_flags_are_wrong);
    RUN_TEST(test_with_a_lag_of_the_propellers_speed_flags_are_correct);
    RUN_TEST(test_with_wrong_timestamps_flags_are_correct);
    RUN_TEST(test_with_a_lag_and_wrong_timestamps_flags_are_correct);
    RUN_TEST(test_with_the_longest_lag_and_the_latest_timestamps_flags_are_correct);
    return UNITY_END();
}
