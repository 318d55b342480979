/*
 * Is the wrench feedback of the motion? A body in surge, driven by a pilot or by a controller of
 * its speed; the identifier is passive.
 */
#include <math.h>
#include <string.h>

#include "auvid/identifier.h"
#include "auvid/prior.h"
#include "base/auvid_linalg_internal.h"
#include "chain.h"
#include "identifier/auvid_identifier_internal.h"
#include "metric/auvid_metric_feedback_internal.h"
#include "simulator.h"
#include "unity.h"

enum { TICK_US = 20000, CONTROL = 10 /* ticks, as samples of the velocity */, DOF = AUVID_SURGE };
#define M_KG 250.0
#define LINEAR 40.0
#define QUADRATIC 120.0
#define DISTURBANCE_N 3.0
#define TAU_MAX_N 100.0

typedef enum { PILOT, CONTROLLER, SINES } driver_t;

typedef struct {
    sim_rng_t rng;
    double u, disturbance, stick, sum, tau, delivered, sampled;
    long next;
    uint64_t t_us;
} body_t;

static auvid_identifier_t id;
static body_t body, aside; /* in surge, in sway */
static bool has_aside;
static double lag_s;     /* of the thrusters */
static double sag;       /* part of the thrust that is lost in 240 s */
static uint32_t of_sway; /* its parameters that are free */

void setUp(void)
{
    auvid_identifier_config_t cfg;
    memset(&body, 0, sizeof body);
    memset(&aside, 0, sizeof aside);
    has_aside = false;
    lag_s = sag = 0.0;
    sim_rng_seed(&body.rng, 7, 1);
    sim_rng_seed(&aside.rng, 8, 1);
    auvid_identifier_defaults(&cfg, &auvid_girona500);
    cfg.exact_inputs = true;
    cfg.metric.free = of_sway | 1u << AUVID_G500_M_U | 1u << AUVID_G500_X_U | 1u << AUVID_G500_X_UU;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
}

void tearDown(void)
{
    of_sway = 0;
}

/* An excitation that auvid does not know of. */
static double sines(long tick)
{
    static const double period_s[5] = {3.7, 5.3, 8.9, 13.1, 21.7};
    double sum = 0.0;
    for (int i = 0; i < 5; ++i) {
        sum += 16.0 * sin(6.2831853 * ((double)tick * TICK_US * 1e-6 / period_s[i] + 0.37 * i));
    }
    return sum;
}

/* The pilot moves the stick at random times. The controller follows a speed that lasts longer. */
static double drive(body_t *b, long tick, driver_t driver)
{
    bool controlled = driver == CONTROLLER;
    if (driver == SINES) {
        return sines(tick);
    }
    if (tick >= b->next) {
        b->stick = 2.0 * sim_rng_uniform(&b->rng) - 1.0;
        long lasts = (long)(300.0 * sim_rng_uniform(&b->rng));
        b->next = tick + lasts + (controlled ? 800 : 100);
    }
    double error = 0.5 * b->stick - b->sampled;
    b->sum += controlled ? 2.0 * error * TICK_US * 1e-6 : 0.0;
    double force = controlled ? 4.0 * M_KG * 0.25 * error + 20.0 * b->sum : 80.0 * b->stick;
    return fmax(-TAU_MAX_N, fmin(TAU_MAX_N, force));
}

static void sample(body_t *b, long tick, driver_t driver)
{
    b->sampled = b->u + 0.005 * sim_rng_gauss(&b->rng);
    b->tau = drive(b, tick, driver);
}

static void move(body_t *b)
{
    const double dt = TICK_US * 1e-6;
    b->disturbance +=
        -b->disturbance * dt / 2.0 + DISTURBANCE_N * sqrt(dt) * sim_rng_gauss(&b->rng);
    double drag = (LINEAR + QUADRATIC * fabs(b->u)) * b->u;
    b->delivered += lag_s > 0.0 ? (b->tau - b->delivered) * dt / lag_s : b->tau - b->delivered;
    double lost = sag * (double)b->t_us * 1e-6 / 240.0;
    b->u += ((1.0 - lost) * b->delivered + b->disturbance - drag) / M_KG * dt;
    b->t_us += TICK_US;
}

/* A body in surge, and in sway another one under a controller, if there is one. */
static void run(double seconds, driver_t driver)
{
    for (long k = 0, ticks = lround(seconds / (TICK_US * 1e-6)); k < ticks; ++k) {
        auvid_real_t attitude[3] = {0}, nu[AUVID_DOF_COUNT] = {0}, wrench[AUVID_DOF_COUNT] = {0};
        if (k % CONTROL == 0) {
            sample(&body, k, driver);
            nu[DOF] = (auvid_real_t)body.sampled;
            if (has_aside) {
                sample(&aside, k, CONTROLLER);
                nu[AUVID_SWAY] = (auvid_real_t)aside.sampled;
            }
            (void)auvid_identifier_motion(&id, body.t_us, attitude, nu);
        }
        wrench[DOF] = (auvid_real_t)body.tau;
        wrench[AUVID_SWAY] = (auvid_real_t)aside.tau;
        (void)auvid_identifier_applied(&id, body.t_us, wrench, NULL);
        (void)auvid_identifier_work(&id, AUVID_DEFAULT_BUDGET);
        move(&body);
        if (has_aside) {
            move(&aside);
        }
    }
    while (auvid_identifier_work(&id, 1000000) == AUVID_PENDING) {
    }
}

static auvid_note_t note(int i)
{
    return (auvid_note_t)id.estimate.confidence.note[i];
}

static void test_a_pilots_wrench_is_no_feedback(void)
{
    run(400.0, PILOT);
    TEST_ASSERT_NOT_EQUAL(0, id.estimate.confidence.identifiable);
    TEST_ASSERT_EQUAL(AUVID_NOTE_NONE, note(AUVID_G500_M_U));
}

/* The past of a sum of sines tells its future; what a wrong model leaves tells a little of it. */
static void test_a_sum_of_sines_is_no_feedback(void)
{
    lag_s = 0.25;
    run(400.0, SINES);
    TEST_ASSERT_TRUE(id.estimate.number > 5);
    TEST_ASSERT_NOT_EQUAL(AUVID_NOTE_FEEDBACK, note(AUVID_G500_M_U));
    TEST_ASSERT_NOT_EQUAL(0, id.estimate.confidence.identifiable);
}

/* In the place of the uncertain inputs: they know the sag, of a set of 30 s, and nothing else. */
static bool no_step(auvid_identifier_t *identifier)
{
    (void)identifier;
    return false;
}

static void nothing(auvid_identifier_t *identifier)
{
    (void)identifier;
}

static const auvid_estimate_t *no_estimate(const auvid_identifier_t *identifier)
{
    (void)identifier;
    return NULL;
}

static auvid_real_t known_sag(const auvid_identifier_t *identifier)
{
    (void)identifier;
    return (auvid_real_t)(sag * 30.0 / 240.0);
}

static const auvid_uncertain_functions_t knows_the_sag = {.add_cell = no_step,
                                                          .rotate = nothing,
                                                          .begin = no_step,
                                                          .publish = nothing,
                                                          .estimate = no_estimate,
                                                          .accept = nothing,
                                                          .change_vehicle = nothing,
                                                          .sag = known_sag};

/* What the model leaves then is in proportion to the wrench. */
static void test_a_wrench_whose_thrust_sags_is_no_feedback_if_the_sag_is_known(void)
{
    sag = 0.2;
    run(400.0, SINES);
    TEST_ASSERT_EQUAL(AUVID_NOTE_FEEDBACK, note(AUVID_G500_M_U));
    setUp();
    sag = 0.2;
    id.attached.uncertain_functions = &knows_the_sag;
    run(400.0, SINES);
    TEST_ASSERT_TRUE(id.estimate.number > 5);
    TEST_ASSERT_NOT_EQUAL(AUVID_NOTE_FEEDBACK, note(AUVID_G500_M_U));
    TEST_ASSERT_EQUAL(0, auvid_metric_feedback_dofs(&id.metric));
}

static void test_a_controllers_wrench_is_feedback_and_nothing_is_identifiable(void)
{
    auvid_drag_t drag;
    run(400.0, CONTROLLER);
    TEST_ASSERT_TRUE(id.estimate.number > 5);
    TEST_ASSERT_EQUAL(0, id.estimate.confidence.identifiable);
    TEST_ASSERT_EQUAL(AUVID_NOTE_FEEDBACK, note(AUVID_G500_M_U));
    TEST_ASSERT_EQUAL(AUVID_NOTE_FEEDBACK, note(AUVID_G500_X_UU));
    TEST_ASSERT_EQUAL(AUVID_NOTE_FIXED, note(AUVID_G500_M_V));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_estimate_drag(&id.estimate, &auvid_girona500, AUVID_SURGE,
                                                    AUVID_C(0.3), &drag));
    TEST_ASSERT_FALSE(drag.identifiable);
}

/* A pilot in surge, a controller in sway. */
static void run_both(bool known)
{
    char text[160];
    of_sway = 1u << AUVID_G500_M_V | 1u << AUVID_G500_Y_V | 1u << AUVID_G500_Y_VV;
    setUp();
    has_aside = true;
    id.metric.cfg.closed_loop = known ? 1u << AUVID_SWAY : 0;
    run(400.0, PILOT);
    TEST_ASSERT_EQUAL(AUVID_NOTE_FEEDBACK, note(AUVID_G500_M_V));
    TEST_ASSERT_EQUAL(known ? AUVID_NOTE_NONE : AUVID_NOTE_FEEDBACK, note(AUVID_G500_M_U));
    TEST_ASSERT_EQUAL(known, (id.estimate.confidence.identifiable >> AUVID_G500_M_U & 1u) != 0);
    TEST_ASSERT_EQUAL(known, id.estimate.confidence.identifiable != 0);
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_confidence_missing(&id.estimate.confidence, &auvid_girona500,
                                               1u << AUVID_G500_M_V, 0, text, sizeof text));
    TEST_ASSERT_EQUAL(known, strcmp(text, "sway: closed loop; drive it in open loop") == 0);
}

static void test_where_the_closed_loop_is_known_the_rest_is_identifiable(void)
{
    run_both(true);
}

static void test_where_it_is_not_known_nothing_is(void)
{
    run_both(false);
}

static void test_the_sentence_names_the_closed_loop_once(void)
{
    char text[160];
    run(400.0, CONTROLLER);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_confidence_missing(&id.estimate.confidence, &auvid_girona500,
                                                         0, 0, text, sizeof text));
    TEST_ASSERT_EQUAL_STRING(
        "closed loop: the wrench is feedback of a controller; excite the "
        "vehicle, or drive it in open loop; if a pilot drives some axes, list the others in "
        "closed_loop",
        text);
    TEST_ASSERT_EQUAL(AUVID_FINISHED,
                      auvid_confidence_missing(&id.estimate.confidence, &auvid_girona500, 0, 1,
                                               text, sizeof text));
}

static void test_a_record_of_feedback_gives_no_prior(void)
{
    uint8_t record[AUVID_PRIOR_BYTES];
    static auvid_prior_t prior;
    run(400.0, CONTROLLER);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_save(&id, record));
    setUp();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_prior(&id, &prior));
    TEST_ASSERT_TRUE(auvid_prior_load(&id, record, sizeof record) < 0 || prior.known == 0);
}

/* The controller's rows are forgotten. */
static void test_flags_return_after_the_controller(void)
{
    run(400.0, CONTROLLER);
    TEST_ASSERT_EQUAL(AUVID_NOTE_FEEDBACK, note(AUVID_G500_M_U));
    run(3000.0, PILOT);
    TEST_ASSERT_EQUAL(AUVID_NOTE_NONE, note(AUVID_G500_M_U));
}

/* Column of the wrench, after that of the residual. */
enum { LAST = AUVID_FEEDBACK_ORDER - 1 };

/* DoF j has this F statistic; its noise is far above the least one. */
static void give(int j, double statistic, double rows)
{
    auvid_metric_feedback_t *f = &id.metric.feedback;
    auvid_real_t *left = &f->factor[j][AUVID_QR_FACTOR(AUVID_FEEDBACK_ORDER) - 1];
    left[-1] = (auvid_real_t)(100.0 * sqrt(statistic / (rows - LAST)));
    left[0] = 100;
    f->rows[j] = (auvid_real_t)rows;
}

static void test_the_sum_over_the_degrees_of_freedom_decides(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, auvid_metric_feedback_dofs(&id.metric));
    give(AUVID_SURGE, 6.4, 100);
    TEST_ASSERT_EQUAL_HEX32(0, auvid_metric_feedback_dofs(&id.metric));
    give(AUVID_SURGE, 6.6, 100);
    TEST_ASSERT_EQUAL_HEX32(AUVID_FEEDBACK_ALL, auvid_metric_feedback_dofs(&id.metric));
    give(AUVID_YAW, 2.5, 50); /* the limit is 6.5 sqrt(2) = 9.19 */
    TEST_ASSERT_EQUAL_HEX32(0, auvid_metric_feedback_dofs(&id.metric));
    give(AUVID_YAW, 2.7, 50);
    TEST_ASSERT_EQUAL_HEX32(AUVID_FEEDBACK_ALL, auvid_metric_feedback_dofs(&id.metric));
    give(AUVID_YAW, 1000, 39); /* too few rows: does not count */
    TEST_ASSERT_EQUAL_HEX32(AUVID_FEEDBACK_ALL, auvid_metric_feedback_dofs(&id.metric));
    give(AUVID_SURGE, 6.4, 100);
    TEST_ASSERT_EQUAL_HEX32(0, auvid_metric_feedback_dofs(&id.metric));
    give(AUVID_YAW, 1000, 40);
    TEST_ASSERT_EQUAL_HEX32(AUVID_FEEDBACK_ALL, auvid_metric_feedback_dofs(&id.metric));
    id.metric.sets.stored += id.metric.cfg.sets - 1u;
    TEST_ASSERT_EQUAL_HEX32(AUVID_FEEDBACK_ALL, auvid_metric_feedback_dofs(&id.metric));
    ++id.metric.sets.stored; /* no set of the ring is watched */
    TEST_ASSERT_EQUAL_HEX32(0, auvid_metric_feedback_dofs(&id.metric));
    id.metric.sets.stored = 0;
    /* a wrench without change */
    auvid_clear(id.metric.feedback.factor[AUVID_YAW], AUVID_QR_FACTOR(AUVID_FEEDBACK_ORDER));
    TEST_ASSERT_EQUAL_HEX32(0, auvid_metric_feedback_dofs(&id.metric));
}

/* Noise of less than 0.3 % of tau_max counts as that: so an F of 100 is none. */
static void test_a_wrench_that_its_own_past_tells_is_no_feedback(void)
{
    auvid_real_t *left =
        &id.metric.feedback.factor[AUVID_SURGE][AUVID_QR_FACTOR(AUVID_FEEDBACK_ORDER) - 1];
    give(AUVID_SURGE, 100, 100);
    left[0] = (auvid_real_t)(0.0006 / 0.015 * sqrt(100.0));
    left[-1] *= left[0] / 100;
    TEST_ASSERT_EQUAL_HEX32(0, auvid_metric_feedback_dofs(&id.metric));
    left[-1] *= (auvid_real_t)(sqrt(0.065) * sqrt(26.0) * 1.01); /* noise^2: 1 + 5^2 as much */
    TEST_ASSERT_EQUAL_HEX32(AUVID_FEEDBACK_ALL, auvid_metric_feedback_dofs(&id.metric));
    left[-1] *= (auvid_real_t)(0.99 / 1.01);
    TEST_ASSERT_EQUAL_HEX32(0, auvid_metric_feedback_dofs(&id.metric));
}

/* Not if the wrench changes 5 times as much in three blocks: its answers change the estimate
 * little. Constant parts, in the first row of the factor, do not count. */
static void test_answers_to_a_small_residual_do_not_count(void)
{
    enum { RESIDUAL = LAST - 1, EARLIEST = LAST - 2 };
    auvid_real_t *f = id.metric.feedback.factor[AUVID_SURGE];
    give(AUVID_SURGE, 100, 100);
    f[RESIDUAL] = f[EARLIEST] = 1000;
    f[auvid_qr_row(AUVID_FEEDBACK_ORDER, 1) + EARLIEST - 1] = 30;
    f[auvid_qr_row(AUVID_FEEDBACK_ORDER, EARLIEST)] = 40;
    f[auvid_qr_row(AUVID_FEEDBACK_ORDER, EARLIEST) + 1] = 6;
    f[auvid_qr_row(AUVID_FEEDBACK_ORDER, RESIDUAL)] = (auvid_real_t)7.9; /* together 9.92 of 50 */
    TEST_ASSERT_EQUAL_HEX32(0, auvid_metric_feedback_dofs(&id.metric));
    f[auvid_qr_row(AUVID_FEEDBACK_ORDER, RESIDUAL)] = (auvid_real_t)8.1;
    TEST_ASSERT_EQUAL_HEX32(AUVID_FEEDBACK_ALL, auvid_metric_feedback_dofs(&id.metric));
}

/* What an error of the model leaves does not average out. */
static void test_a_long_record_counts_as_one_of_960_rows(void)
{
    give(AUVID_SURGE, 6.6, 960);
    TEST_ASSERT_EQUAL_HEX32(AUVID_FEEDBACK_ALL, auvid_metric_feedback_dofs(&id.metric));
    give(AUVID_SURGE, 6.6, 1000);
    TEST_ASSERT_EQUAL_HEX32(0, auvid_metric_feedback_dofs(&id.metric));
    give(AUVID_SURGE, 6.6 * (1920 - LAST) / (960 - LAST), 1920);
    TEST_ASSERT_EQUAL_HEX32(AUVID_FEEDBACK_ALL, auvid_metric_feedback_dofs(&id.metric));
}

static void test_roll_and_pitch_are_judged_by_themselves(void)
{
    give(AUVID_ROLL, 6.6, 100);
    TEST_ASSERT_EQUAL_HEX32(AUVID_FEEDBACK_TILT, auvid_metric_feedback_dofs(&id.metric));
    give(AUVID_PITCH, 2.5, 50);
    give(AUVID_SURGE, 6.4, 100); /* together 15.5 of 11.3 */
    TEST_ASSERT_EQUAL_HEX32(0, auvid_metric_feedback_dofs(&id.metric));
    give(AUVID_SURGE, 6.6, 100);
    TEST_ASSERT_EQUAL_HEX32(AUVID_FEEDBACK_ALL, auvid_metric_feedback_dofs(&id.metric));
    give(AUVID_PITCH, 2.7, 50);
    TEST_ASSERT_EQUAL_HEX32(AUVID_FEEDBACK_ALL, auvid_metric_feedback_dofs(&id.metric));
    give(AUVID_SURGE, 6.4, 100);
    TEST_ASSERT_EQUAL_HEX32(AUVID_FEEDBACK_TILT, auvid_metric_feedback_dofs(&id.metric));
}

static void test_the_others_are_tested_without_those_in_closed_loop(void)
{
    const uint32_t known = 1u << AUVID_HEAVE | 1u << AUVID_ROLL;
    id.metric.cfg.closed_loop = (uint8_t)known;
    TEST_ASSERT_EQUAL_HEX32(known, auvid_metric_feedback_dofs(&id.metric));
    give(AUVID_HEAVE, 1000, 100);
    give(AUVID_ROLL, 1000, 100);
    give(AUVID_SURGE, 6.4, 100);
    TEST_ASSERT_EQUAL_HEX32(known, auvid_metric_feedback_dofs(&id.metric));
    give(AUVID_SURGE, 6.6, 100);
    TEST_ASSERT_EQUAL_HEX32(AUVID_FEEDBACK_ALL, auvid_metric_feedback_dofs(&id.metric));
    give(AUVID_SURGE, 6.4, 100);
    give(AUVID_PITCH, 6.6, 100);
    TEST_ASSERT_EQUAL_HEX32(known | AUVID_FEEDBACK_TILT, auvid_metric_feedback_dofs(&id.metric));
}

static void test_what_is_known_to_be_in_open_loop_is_not_tested(void)
{
    id.metric.cfg.open_loop = 1u << AUVID_HEAVE | 1u << AUVID_ROLL;
    give(AUVID_HEAVE, 1000, 100);
    give(AUVID_ROLL, 1000, 100);
    give(AUVID_SURGE, 6.4, 100);
    TEST_ASSERT_EQUAL_HEX32(0, auvid_metric_feedback_dofs(&id.metric));
    give(AUVID_SURGE, 6.6, 100);
    TEST_ASSERT_EQUAL_HEX32(AUVID_FEEDBACK_ALL, auvid_metric_feedback_dofs(&id.metric));
}

static void test_only_degrees_of_freedom_can_be_in_closed_or_open_loop_and_in_one(void)
{
    auvid_identifier_config_t cfg;
    auvid_identifier_defaults(&cfg, &auvid_girona500);
    cfg.metric.closed_loop = 1u << AUVID_DOF_COUNT;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_identifier_init(&id, &cfg));
    cfg.metric.closed_loop = 1u << AUVID_HEAVE;
    cfg.metric.open_loop = 1u << AUVID_DOF_COUNT;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_identifier_init(&id, &cfg));
    cfg.metric.open_loop = 1u << AUVID_SURGE | 1u << AUVID_HEAVE;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_identifier_init(&id, &cfg));
    cfg.metric.open_loop = 1u << AUVID_SURGE;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
}

/* Rows of the test after this many seconds. */
static auvid_real_t watched_rows(bool passive, double seconds)
{
    static chain_t chain;
    static chain_config_t cfg;
    chain_defaults(&cfg, 7, 3, 1.0);
    cfg.budget = 2000;
    if (passive) {
        chain_set_driver(&cfg);
    }
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, seconds);
    return chain.id.metric.feedback.rows[AUVID_SURGE];
}

static void test_neither_auvids_excitation_nor_motion_before_an_estimate_is_watched(void)
{
    TEST_ASSERT_TRUE(watched_rows(false, 28.0) == AUVID_C(0.0));
    TEST_ASSERT_TRUE(watched_rows(false, 80.0) == AUVID_C(0.0));
    TEST_ASSERT_TRUE(watched_rows(true, 28.0) == AUVID_C(0.0));
    TEST_ASSERT_TRUE(watched_rows(true, 80.0) > AUVID_C(50.0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_pilots_wrench_is_no_feedback);
    RUN_TEST(test_a_sum_of_sines_is_no_feedback);
    RUN_TEST(test_a_wrench_whose_thrust_sags_is_no_feedback_if_the_sag_is_known);
    RUN_TEST(test_a_controllers_wrench_is_feedback_and_nothing_is_identifiable);
    RUN_TEST(test_where_the_closed_loop_is_known_the_rest_is_identifiable);
    RUN_TEST(test_where_it_is_not_known_nothing_is);
    RUN_TEST(test_the_sentence_names_the_closed_loop_once);
    RUN_TEST(test_a_record_of_feedback_gives_no_prior);
    RUN_TEST(test_flags_return_after_the_controller);
    RUN_TEST(test_the_sum_over_the_degrees_of_freedom_decides);
    RUN_TEST(test_a_wrench_that_its_own_past_tells_is_no_feedback);
    RUN_TEST(test_answers_to_a_small_residual_do_not_count);
    RUN_TEST(test_a_long_record_counts_as_one_of_960_rows);
    RUN_TEST(test_roll_and_pitch_are_judged_by_themselves);
    RUN_TEST(test_the_others_are_tested_without_those_in_closed_loop);
    RUN_TEST(test_what_is_known_to_be_in_open_loop_is_not_tested);
    RUN_TEST(test_only_degrees_of_freedom_can_be_in_closed_or_open_loop_and_in_one);
    RUN_TEST(test_neither_auvids_excitation_nor_motion_before_an_estimate_is_watched);
    return UNITY_END();
}
