/*
 * Instruments: a body in surge that a fast controller drives against a strong disturbance. Least
 * squares takes the disturbance for drag; the reference does not.
 */
#include <math.h>
#include <string.h>

#include "auvid/uncertain.h"
#include "simulator.h"
#include "unity.h"

enum { TICK_US = 20000, CONTROL = 10 /* ticks, as samples of the velocity */, DOF = AUVID_SURGE };
enum { SEEDS = 50, M = AUVID_G500_M_U, X = AUVID_G500_X_U };
#define M_KG 250.0
#define LINEAR 120.0
#define DISTURBANCE_N 40.0
#define TAU_MAX_N 300.0
#define RUN_S 1000.0
#define SPEED 1.0

typedef struct {
    sim_rng_t rng;
    double u, disturbance, wanted, smooth, sum, tau, sampled;
    long tick, next;
    uint64_t t_us;
} body_t;

static auvid_identifier_t id, before;
static auvid_allocation_t thrusters;
static auvid_uncertain_config_t inputs;
static auvid_uncertain_t uncertain, bare;
static auvid_instruments_t instruments, unchanged;
static auvid_real_t reference[AUVID_DOF_COUNT];
static body_t body;

static void begin(uint64_t seed)
{
    auvid_identifier_config_t cfg;
    auvid_allocation_config_t allocation;
    memset(&body, 0, sizeof body);
    sim_rng_seed(&body.rng, seed, 1);
    auvid_identifier_defaults(&cfg, &auvid_girona500);
    cfg.metric.free = 1u << M | 1u << X;
    cfg.metric.set_rows = 240;
    cfg.uncertainty = (auvid_uncertainty_t){0};
    cfg.exact_inputs = true;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    auvid_allocation_defaults(&allocation);
    allocation.thrusters = 1;
    allocation.thruster[0].wrench[DOF] = 1;
    allocation.thruster[0].max_N = (auvid_real_t)TAU_MAX_N;
    allocation.thruster[0].min_N = (auvid_real_t)-TAU_MAX_N;
    allocation.dofs = AUVID_DOF_BIT(DOF);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&thrusters, &allocation));
    inputs = (auvid_uncertain_config_t){.nominal_lag_s = AUVID_C(0.01)}; /* exact */
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_identifier_attach_uncertain(&id, &uncertain, &inputs, &thrusters));
}

static auvid_status_t attach(void)
{
    memset(&instruments, 0, sizeof instruments);
    return auvid_identifier_attach_instruments(&id, &instruments);
}

void setUp(void)
{
    begin(1);
    memset(reference, 0, sizeof reference);
}

void tearDown(void)
{
}

/* A speed that changes at random times, and the controller that follows it. */
static void drive(double speed)
{
    if (body.tick >= body.next) {
        body.wanted = speed * (2.0 * sim_rng_uniform(&body.rng) - 1.0);
        body.next = body.tick + 150 + (long)(600.0 * sim_rng_uniform(&body.rng));
    }
    body.smooth += (body.wanted - body.smooth) * 0.2;
    double error = body.smooth - body.sampled;
    body.sum += 10.0 * error;
    body.tau = fmax(-TAU_MAX_N, fmin(TAU_MAX_N, 250.0 * error + body.sum));
}

static void run(double seconds, double speed, bool given)
{
    const double dt = TICK_US * 1e-6;
    for (long ticks = lround(seconds / dt); ticks > 0; --ticks, ++body.tick) {
        auvid_real_t attitude[3] = {0}, nu[AUVID_DOF_COUNT] = {0}, wrench[AUVID_DOF_COUNT] = {0};
        auvid_real_t command[AUVID_MAX_COMMANDS] = {0};
        body.t_us += TICK_US;
        if (body.tick % CONTROL == 0) {
            body.sampled = body.u + 0.003 * sim_rng_gauss(&body.rng);
            nu[DOF] = (auvid_real_t)body.sampled;
            (void)auvid_identifier_motion(&id, body.t_us, attitude, nu);
            drive(speed);
        }
        if (given) {
            reference[DOF] = (auvid_real_t)body.smooth;
            TEST_ASSERT_EQUAL(AUVID_OK,
                              auvid_instruments_reference(&instruments, body.t_us, reference));
        }
        wrench[DOF] = command[0] = (auvid_real_t)body.tau;
        (void)auvid_identifier_applied(&id, body.t_us, wrench, command);
        (void)auvid_identifier_work(&id, AUVID_DEFAULT_BUDGET);
        body.disturbance +=
            -body.disturbance * dt / 2.0 + DISTURBANCE_N * sqrt(dt) * sim_rng_gauss(&body.rng);
        body.u += (body.tau + body.disturbance - LINEAR * body.u) / M_KG * dt;
    }
    while (auvid_identifier_work(&id, 1000000) == AUVID_PENDING) {
    }
}

static auvid_note_t note(int i)
{
    return (auvid_note_t)auvid_identifier_estimate(&id)->confidence.note[i];
}

/* ---- what they find ---- */

/* Of an error that is not flagged, the mean of few runs says little. Sorts the errors. */
static double median(double error[SEEDS])
{
    for (int i = 1; i < SEEDS; ++i) {
        for (int k = i; k > 0 && error[k] < error[k - 1]; --k) {
            double larger = error[k - 1];
            error[k - 1] = error[k];
            error[k] = larger;
        }
    }
    return error[SEEDS / 2];
}

static void test_the_reference_finds_what_least_squares_gets_wrong(void)
{
    static const int of[2] = {M, X};
    static const double truth[2] = {M_KG, -LINEAR};
    int flagged = 0, told = 0, within[2] = {0};
    double plain[2] = {0.0}, found[2][SEEDS]; /* relative errors, without (mean) and with them */
    for (uint64_t seed = 1; seed <= SEEDS; ++seed) {
        begin(seed);
        TEST_ASSERT_EQUAL(AUVID_OK, attach());
        run(RUN_S, SPEED, true);
        const auvid_estimate_t *e = auvid_identifier_estimate(&id);
        told += id.estimate.confidence.identifiable == 0;
        for (int k = 0; k < 2; ++k) {
            double off = (double)e->pi[of[k]] - truth[k];
            bool is = (e->confidence.identifiable >> of[k] & 1u) != 0;
            plain[k] += ((double)id.estimate.pi[of[k]] / truth[k] - 1.0) / SEEDS;
            found[k][seed - 1] = off / truth[k];
            within[k] += fabs(off) <= 1.96 * (double)e->confidence.sigma[of[k]];
            flagged += is;
            TEST_ASSERT_FALSE(is && fabs(off) > 0.2 * fabs(truth[k]));
        }
    }
    TEST_ASSERT_TRUE(told >= SEEDS - 2); /* closed loop: nothing is identifiable without them */
    TEST_ASSERT_TRUE(plain[0] < -0.2 && plain[1] < -0.1);
    TEST_ASSERT_TRUE(fabs(median(found[0])) < 0.05 && fabs(median(found[1])) < 0.03);
    TEST_ASSERT_TRUE(within[0] >= 45 && within[1] >= 45);
    TEST_ASSERT_TRUE(flagged >= 70);
}

/* A reference that the vehicle does not follow. */
static void test_a_weak_reference_gives_no_flag(void)
{
    sim_rng_t rng;
    sim_rng_seed(&rng, 1, 2);
    TEST_ASSERT_EQUAL(AUVID_OK, attach());
    for (int k = 0; k < (int)RUN_S / 5; ++k) {
        reference[DOF] = (auvid_real_t)(2.0 * sim_rng_uniform(&rng) - 1.0);
        TEST_ASSERT_EQUAL(AUVID_OK,
                          auvid_instruments_reference(&instruments, body.t_us + 1u, reference));
        run(5.0, SPEED, false);
    }
    TEST_ASSERT_EQUAL(0, instruments.strong);
    TEST_ASSERT_EQUAL(0, auvid_identifier_estimate(&id)->confidence.identifiable);
    TEST_ASSERT_EQUAL(AUVID_NOTE_FEEDBACK, note(M));
    TEST_ASSERT_EQUAL(AUVID_NOTE_FEEDBACK, note(X));
}

static void test_a_reference_of_another_degree_of_freedom_gives_no_flag(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, attach());
    for (int k = 0; k < 3; ++k) {
        reference[AUVID_YAW] = (auvid_real_t)(k % 2);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_instruments_reference(
                                        &instruments, (uint64_t)(k + 1) * TICK_US, reference));
    }
    run(RUN_S, SPEED, false);
    TEST_ASSERT_EQUAL(0, instruments.strong);
    TEST_ASSERT_EQUAL(AUVID_NOTE_FEEDBACK, note(X));
}

/* They are of a vehicle whose controller acts in all degrees of freedom. */
static void test_where_the_closed_loop_is_configured_they_do_not_count(void)
{
    id.metric.cfg.closed_loop = 1u << DOF;
    TEST_ASSERT_EQUAL(AUVID_OK, attach());
    run(RUN_S, SPEED, true);
    TEST_ASSERT_EQUAL(0, instruments.strong);
    TEST_ASSERT_EQUAL(0, auvid_identifier_estimate(&id)->confidence.identifiable);
    TEST_ASSERT_EQUAL(AUVID_NOTE_FEEDBACK, note(M));
}

static void test_without_reference_all_is_as_without_instruments(void)
{
    run(RUN_S, SPEED, false);
    auvid_estimate_t plain = uncertain.estimate;
    bare = uncertain;
    begin(1);
    TEST_ASSERT_EQUAL(AUVID_OK, attach());
    run(RUN_S, SPEED, false);
    TEST_ASSERT_TRUE(plain.number > 0);
    TEST_ASSERT_EQUAL_MEMORY(&plain, &uncertain.estimate, sizeof plain);
    TEST_ASSERT_EQUAL_MEMORY(bare.factor, uncertain.factor, sizeof bare.factor);
}

/* Each is held until the next one. */
static void test_a_reference_once_a_second_is_enough(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, attach());
    for (int k = 0; k < (int)RUN_S; ++k) {
        reference[DOF] = (auvid_real_t)body.smooth;
        TEST_ASSERT_EQUAL(AUVID_OK,
                          auvid_instruments_reference(&instruments, body.t_us + 1u, reference));
        run(1.0, SPEED, false);
    }
    TEST_ASSERT_EQUAL(1u << M | 1u << X, instruments.strong);
    TEST_ASSERT_FLOAT_WITHIN(0.1 * LINEAR, -LINEAR, (float)auvid_identifier_estimate(&id)->pi[X]);
}

/* ---- statuses ---- */

static void test_null_is_refused(void)
{
    before = id;
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_attach_instruments(NULL, &instruments));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_attach_instruments(&id, NULL));
    TEST_ASSERT_EQUAL_MEMORY(&before, &id, sizeof before);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_instruments_reference(NULL, 1, reference));
    TEST_ASSERT_EQUAL(AUVID_OK, attach());
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_instruments_reference(&instruments, 1, NULL));
}

static void test_they_attach_once_to_uncertain_inputs_and_before_the_first_step(void)
{
    auvid_identifier_config_t cfg;
    auvid_input_t in = {.t_us = 1};
    auvid_output_t out;
    TEST_ASSERT_EQUAL(AUVID_OK, attach());
    unchanged = instruments;
    TEST_ASSERT_EQUAL(AUVID_ERR_ATTACHED, auvid_identifier_attach_instruments(&id, &instruments));
    TEST_ASSERT_EQUAL_MEMORY(&unchanged, &instruments, sizeof unchanged);
    begin(1);
    (void)auvid_identifier_step(&id, &in, &out);
    before = id;
    TEST_ASSERT_EQUAL(AUVID_ERR_STARTED, attach());
    TEST_ASSERT_EQUAL_MEMORY(&before, &id, sizeof before);
    auvid_identifier_defaults(&cfg, &auvid_girona500);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_ERR_DETACHED, attach());
    memset(&id, 0, sizeof id);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, attach());
}

/* An equation of 16 parameters would need 33 columns with two lags. */
static void test_more_columns_than_there_is_room_for_are_refused(void)
{
    enum { MANY = 16 };
    static auvid_parameter_t parameter[MANY];
    static auvid_term_t term[MANY];
    static auvid_terms_t model;
    static const auvid_term_table_t table = {
        .name = "many", .parameter = parameter, .term = term, .terms = MANY, .parameters = MANY};
    auvid_identifier_config_t cfg;
    for (int i = 0; i < MANY; ++i) {
        parameter[i] = (auvid_parameter_t){.name = "p", .unit = "N", .dof = AUVID_SURGE};
        term[i] = (auvid_term_t){(uint8_t)i, AUVID_SURGE, 1, {(uint8_t)(AUVID_FACTOR_U + i)}};
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_terms_init(&model, &table, NULL));
    auvid_identifier_defaults(&cfg, &model.vehicle);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_identifier_attach_uncertain(&id, &uncertain, &inputs, &thrusters));
    before = id;
    TEST_ASSERT_EQUAL(AUVID_ERR_SIZE, attach());
    TEST_ASSERT_EQUAL_MEMORY(&before, &id, sizeof before);
}

/* Five lags of the 13 parameters need 119 columns; there are 110. */
static void test_the_longest_lag_is_left_out_if_there_is_no_room_for_it(void)
{
    auvid_identifier_config_t cfg;
    auvid_allocation_t five;
    auvid_identifier_defaults(&cfg, &auvid_girona500);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&five, &auvid_allocation_girona500));
    auvid_uncertain_defaults(&inputs);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_uncertain(&id, &uncertain, &inputs, &five));
    TEST_ASSERT_EQUAL(AUVID_OK, attach());
    TEST_ASSERT_EQUAL(4, instruments.lags);
    TEST_ASSERT_EQUAL(4 * 6 + 1, instruments.of[AUVID_SURGE].count);
    TEST_ASSERT_EQUAL(4 * 5 + 1, instruments.of[AUVID_YAW].count);
}

static void test_a_bad_reference_is_refused_and_changes_nothing(void)
{
    memset(&instruments, 0, sizeof instruments);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_instruments_reference(&instruments, 9, reference));
    TEST_ASSERT_EQUAL(AUVID_OK, attach());
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_instruments_reference(&instruments, 9, reference));
    unchanged = instruments;
    TEST_ASSERT_EQUAL(AUVID_ERR_TIME_SAME, auvid_instruments_reference(&instruments, 9, reference));
    TEST_ASSERT_EQUAL(AUVID_ERR_TIME_BACK, auvid_instruments_reference(&instruments, 8, reference));
    reference[AUVID_PITCH] = (auvid_real_t)NAN;
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE,
                      auvid_instruments_reference(&instruments, 10, reference));
    reference[AUVID_PITCH] = (auvid_real_t)1e30;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_instruments_reference(&instruments, 10, reference));
    TEST_ASSERT_EQUAL_MEMORY(&unchanged, &instruments, sizeof unchanged);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_reference_finds_what_least_squares_gets_wrong);
    RUN_TEST(test_a_weak_reference_gives_no_flag);
    RUN_TEST(test_a_reference_of_another_degree_of_freedom_gives_no_flag);
    RUN_TEST(test_where_the_closed_loop_is_configured_they_do_not_count);
    RUN_TEST(test_without_reference_all_is_as_without_instruments);
    RUN_TEST(test_a_reference_once_a_second_is_enough);
    RUN_TEST(test_null_is_refused);
    RUN_TEST(test_they_attach_once_to_uncertain_inputs_and_before_the_first_step);
    RUN_TEST(test_more_columns_than_there_is_room_for_are_refused);
    RUN_TEST(test_the_longest_lag_is_left_out_if_there_is_no_room_for_it);
    RUN_TEST(test_a_bad_reference_is_refused_and_changes_nothing);
    return UNITY_END();
}
