/*
 * BlueROV2 Heavy in six degrees of freedom, excited for twelve minutes under an unmodelled force,
 * through navigation, recorder, metric and search. The parameters reported as identifiable must be
 * correct.
 *
 * A parameter is correct if its error is at most 5 % of the truth, or if the error's force is at
 * most 1 % of the rms wrench of its degree of freedom. (That force is the error times the rms of
 * the parameter's column.) Three of the 20 parameters are truly zero: the linear drags of sway,
 * roll and yaw. They must not be identifiable, and their rms errors have the same limit. By chance
 * each of them is beyond its half-width, 2.1 standard errors, on the impossible side in 1.8 % of
 * the runs. Its degree of freedom is then not credible; otherwise all others are identifiable.
 * No flag may be wrong in any run. The long form (AUVID_TEST_LONG) has 200 runs.
 *
 * The thrusters stabilise roll and pitch with 8 Nm/rad, in addition to the hull's 1.3 Nm/rad, so
 * that small moments do not capsize the vehicle. The applied wrench contains this feedback.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "auvid/vehicle.h"
#include "auvid/fossen.h"
#include "binomial.h"
#include "chain.h"
#include "finish.h"
#include "unity.h"

enum { N = AUVID_FOSSEN_COUNT, SETS = 8, SET_S = 90, TICKS_PER_S = 1000000 / SIM_TICK_US };

static sim_t sim;
static sim_config_t world;
static auvid_identifier_t id;
static auvid_change_detector_t change;
static auvid_identifier_config_t cfg;
static auvid_actuation_config_t acting;
static auvid_actuation_t actuation;
static auvid_allocation_config_t thrusters;
static auvid_allocation_t allocation;
static auvid_averaged_t model;
static double truth[SIM_FOSSEN_PARAMETERS];
static double wrench_2[AUVID_DOF_COUNT], column_2[N]; /* sums of squares over a run */
static double tilt;                                   /* largest |phi|, |theta| of a run [rad] */

void setUp(void)
{
}

void tearDown(void)
{
}

/* Roll and pitch oscillate with 2-3 s. So their steps and sines are faster than the plan's, and
 * their rows have a shorter filter. */
static void configure(uint64_t seed, const auvid_vehicle_t *vehicle)
{
    static const auvid_real_t amplitude[AUVID_DOF_COUNT] = {40, 40, 35, 5, 6, 6};
    sim_bluerov2(&world);
    world.seed = seed;
    world.disturbance_N = 0.2;
    world.disturbance_Nm = 0.08;
    sim_fossen_parameters(&world.fossen, truth);
    auvid_identifier_defaults(&cfg, vehicle);
    cfg.exact_inputs = true;
    memset(&cfg.uncertainty, 0, sizeof cfg.uncertainty); /* thrust, DVL and delay are exact */
    thrusters = auvid_allocation_bluerov2_heavy;
    auvid_actuation_defaults(&acting);
    cfg.search.seed = seed;
    cfg.metric.set_rows = 2 * SET_S;
    cfg.metric.half_width[1] = 4;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        cfg.metric.tau_max[j] = amplitude[j];
    }
    acting.guard.roll_max_rad = acting.guard.pitch_max_rad = AUVID_C(1.2);
    acting.guard.yaw_rate_max = AUVID_C(3.0);
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_excitation_plan(&acting.excitation, amplitude, SET_S, SETS, seed));
    for (int i = 0; i < acting.excitation.segments; ++i) {
        auvid_segment_t *segment = &acting.excitation.segment[i];
        if (segment->dof >= AUVID_ROLL) {
            segment->frequency_hz = AUVID_C(0.1);
            segment->frequency_high_hz = AUVID_C(0.8);
            segment->hold_min_s = 1;
            segment->hold_max_s = 3;
        }
    }
}

/* Records the true wrench, the column of each parameter in its own equation, and the tilt. */
static void record_truth(const double *wrench)
{
    auvid_sample_t s;
    auvid_regressor_t y;
    memset(&s, 0, sizeof s);
    memset(&y, 0, sizeof y);
    s.phi = (auvid_real_t)sim.truth.euler[0];
    s.theta = (auvid_real_t)sim.truth.euler[1];
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        s.nu[j] = (auvid_real_t)sim.truth.nu[j];
        s.nu_dot[j] = (auvid_real_t)sim.truth.nu_dot[j];
        wrench_2[j] += wrench[j] * wrench[j];
    }
    auvid_fossen.regressor(auvid_fossen.context, &s, NULL, &y);
    for (int i = 0; i < N; ++i) {
        double entry = (double)y.row[auvid_fossen.parameter[i].dof][i];
        column_2[i] += entry * entry;
    }
    tilt = fmax(tilt, fmax(fabs(sim.truth.euler[0]), fabs(sim.truth.euler[1])));
}

/* Simulates one tick. The identifier receives the wrench of the previous tick, from the thrusters'
 * feedback, with the time at which it began. Writes the forces of the next tick. */
static void tick(const auvid_allocation_result_t *hover, double force[SIM_THRUSTERS])
{
    sim_output_t seen;
    auvid_input_t in;
    auvid_output_t out;
    auvid_real_t wrench[AUVID_DOF_COUNT];
    sim_step(&sim, force, NULL, &seen);
    record_truth(seen.wrench);
    chain_sense(&seen, 0, &in);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        wrench[j] = (auvid_real_t)seen.wrench[j];
    }
    (void)auvid_identifier_applied(&id, in.t_us - SIM_TICK_US, wrench, NULL);
    if (actuation.guard.state == AUVID_GUARD_DISARMED && auvid_identifier_arm(&id) == AUVID_OK) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_excite(&id));
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&id, &in, &out));
    TEST_ASSERT_EQUAL_STRING("", out.guard == AUVID_GUARD_ABORTED ? auvid_guard_cause_str(out.cause)
                                                                  : "");
    (void)auvid_identifier_work(&id, AUVID_DEFAULT_BUDGET);
    for (int i = 0; i < world.thrusters; ++i) {
        force[i] = (double)(out.thruster_N[i] + hover->force_N[i]);
    }
}

static void identify(uint64_t seed, const auvid_vehicle_t *vehicle)
{
    const auvid_real_t weight = auvid_bluerov2_heavy_benzon[AUVID_FOSSEN_W_B];
    const auvid_real_t lift[AUVID_DOF_COUNT] = {0, 0, -weight, 0, 0, 0};
    double force[SIM_THRUSTERS] = {0};
    auvid_allocation_result_t hover;
    configure(seed, vehicle);
    TEST_ASSERT_TRUE(sim_init(&sim, &world));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_change_test(&id, &change));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&allocation, &thrusters));
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_identifier_attach_actuation(&id, &actuation, &acting, &allocation));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_solve(&allocation, lift, &hover));
    memset(wrench_2, 0, sizeof wrench_2);
    memset(column_2, 0, sizeof column_2);
    tilt = 0;
    for (int k = 0; k < (SETS * SET_S + 6) * TICKS_PER_S; ++k) {
        tick(&hover, force);
    }
    finish_work(&id, 1000);
    TEST_ASSERT_EQUAL_UINT32(SETS, id.estimate.sets);
    TEST_ASSERT_EQUAL_HEX32(AUVID_FOSSEN_FREE, id.estimate.identified);
}

static double error_of(int i)
{
    return (double)id.estimate.pi[i] - truth[i];
}

static double allowed_error(int i)
{
    int j = (int)auvid_fossen.parameter[i].dof;
    return fmax(0.05 * fabs(truth[i]), 0.01 * sqrt(wrench_2[j] / column_2[i]));
}

/* ---- correctness of the flags ---- */

#define IMPOSSIBLE_BY_CHANCE 0.018 /* of a normal error: more than 2.1 standard errors */

typedef struct {
    double squares, allowed, worst; /* worst: largest error / allowed error */
    int identifiable, wrong, small;
    int discredited; /* by a parameter that is truly zero */
} score_t;

static void add_run(score_t *score, int i)
{
    bool identifiable = (id.estimate.confidence.identifiable >> i & 1u) != 0;
    double allowed = allowed_error(i), error = fabs(error_of(i));
    score->squares += error * error;
    score->allowed += allowed;
    score->small += id.estimate.confidence.note[i] == AUVID_NOTE_SMALL;
    score->identifiable += identifiable;
    score->discredited += id.estimate.confidence.note[i] == AUVID_NOTE_DISCREDITED &&
                          truth[id.estimate.confidence.partner[i]] == 0;
    score->wrong += identifiable && error > allowed;
    score->worst = fmax(score->worst, error / allowed);
}

static void print(const score_t *score, int i, int runs)
{
    printf("%-10s %9.3f  %-8s rms error %8.4f, allowed %8.4f, worst %4.2f of it, identifiable in "
           "%d of %d, small in %d\n",
           auvid_fossen.parameter[i].name, truth[i] + 0.0, auvid_fossen.parameter[i].unit,
           sqrt(score->squares / runs), score->allowed / runs, score->worst, score->identifiable,
           runs, score->small);
}

static void test_identifiable_parameters_are_correct(void)
{
    int runs = getenv("AUVID_TEST_LONG") != NULL ? 200 : 6, identifiable = 0, wrong = 0;
    score_t score[N];
    memset(score, 0, sizeof score);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_averaged_init(&model, &auvid_bluerov2_heavy, 100000, 200000));
    for (int run = 1; run <= runs; ++run) {
        identify((uint64_t)run, &model.vehicle);
        TEST_ASSERT_TRUE(tilt < 1.2);
        for (int i = 0; i < N; ++i) {
            if (AUVID_FOSSEN_FREE >> i & 1u) {
                add_run(&score[i], i);
            }
        }
    }
    for (int i = 0; i < N; ++i) {
        if (AUVID_FOSSEN_FREE >> i & 1u) {
            print(&score[i], i, runs);
            identifiable += score[i].identifiable;
            wrong += score[i].wrong;
            TEST_ASSERT_EQUAL_INT(truth[i] == 0 ? 0 : runs - score[i].discredited,
                                  score[i].identifiable);
            TEST_ASSERT_TRUE(binomial_lower(score[i].discredited, runs, 0.005) <=
                             IMPOSSIBLE_BY_CHANCE);
            TEST_ASSERT_TRUE(score[i].squares / runs <= pow(score[i].allowed / runs, 2));
        }
    }
    printf("%d runs: %d of %d identifiable, %d wrong\n", runs, identifiable, 20 * runs, wrong);
    TEST_ASSERT_EQUAL_INT(0, wrong);
}

/* ---- the averaged model ---- */

/* Seeds and motion are the same: only the model differs. Without averages X_u is too large by 0.3.
 * */
static void test_averaging_removes_the_bias_of_linear_drag(void)
{
    enum { RUNS = 2 };
    double plain = 0, averaged = 0;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_averaged_init(&model, &auvid_bluerov2_heavy, 100000, 200000));
    for (uint64_t seed = 101; seed <= 100 + RUNS; ++seed) {
        identify(seed, &auvid_bluerov2_heavy);
        plain += error_of(AUVID_FOSSEN_X_U) / RUNS;
        identify(seed, &model.vehicle);
        averaged += error_of(AUVID_FOSSEN_X_U) / RUNS;
    }
    printf("X_u: mean error %.3f plain, %.3f averaged, %d runs\n", plain, averaged, RUNS);
    TEST_ASSERT_TRUE(averaged - plain > 0.2 && averaged - plain < 0.5);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_identifiable_parameters_are_correct);
    RUN_TEST(test_averaging_removes_the_bias_of_linear_drag);
    return UNITY_END();
}
