/*
 * Thrusters identified together with the hull from the commands of every tick: the errors of the
 * estimate, the work, rows whose commands are lost, and a restart.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "auvid/checkpoint.h"
#include "auvid/thrusters.h"
#include "binomial.h"
#include "finish.h"
#include "surge_thrusters.h"
#include "unity.h"

void setUp(void)
{
    surge_thrusters_defaults();
}

void tearDown(void)
{
}

/* ---- errors of the estimate ---- */

/* Returns the larger relative error of the two drags, by least squares with the ideal thruster. */
static double ideal_error(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS];
    memcpy(pi, ideal.metric.cfg.fixed, sizeof pi);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&ideal.metric, FREE, pi));
    return fmax(fabs((double)pi[X_U] / truth[X_U] - 1.0),
                fabs((double)pi[X_UU] / truth[X_UU] - 1.0));
}

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Prints each parameter's errors [%]. The 2.5..97.5 % range (of 50 errors, without the largest and
 * the smallest) must be within 5 %. */
static void check_campaign(int seeds, double disturbance_N, uint16_t set_s)
{
    enum { MAX_SEEDS = 50 };
    static double error[PARAMETERS][MAX_SEEDS], ideal_errors[MAX_SEEDS];
    int out = seeds / 40;
    for (int k = 0; k < seeds; ++k) {
        identify((uint64_t)k + 1, disturbance_N, set_s, ROW_CELLS, 0);
        ideal_errors[k] = 100.0 * ideal_error();
        for (int i = X_U; i < PARAMETERS; ++i) {
            error[i][k] = 100.0 * error_of(i);
        }
    }
    qsort(ideal_errors, (size_t)seeds, sizeof *ideal_errors, by_value);
    TEST_ASSERT_TRUE(ideal_errors[0] >= 20.0);
    if (campaign_is_long()) {
        printf("%g N, %d x %u s  least squares with the ideal thruster: %.0f .. %.0f %% off\n",
               disturbance_N, SETS, (unsigned)set_s, ideal_errors[0], ideal_errors[seeds - 1]);
    }
    for (int i = X_U; i < PARAMETERS; ++i) {
        double *e = error[i], mean = 0.0, square = 0.0;
        qsort(e, (size_t)seeds, sizeof *e, by_value);
        for (int k = 0; k < seeds; ++k) {
            mean += e[k] / seeds;
        }
        for (int k = 0; k < seeds; ++k) {
            square += (e[k] - mean) * (e[k] - mean) / (seeds - 1);
        }
        if (campaign_is_long()) {
            printf("%g N, %d x %u s  %-10s median %5.2f  2.5..97.5 %% %5.2f .. %5.2f  mean %5.2f "
                   "+- %.2f %%\n",
                   disturbance_N, SETS, (unsigned)set_s, thrusters.parameter[i].name, e[seeds / 2],
                   e[out], e[seeds - 1 - out], mean, 1.96 * sqrt(square / seeds));
        }
        TEST_ASSERT_TRUE(e[out] > -5.0);
        TEST_ASSERT_TRUE(e[seeds - 1 - out] < 5.0);
    }
}

static void test_thrusters_and_drag_are_within_5_percent_and_drag_of_the_ideal_one_is_20_off(void)
{
    check_campaign(campaign_is_long() ? 50 : 3, 0.0, 30);
}

static void test_under_a_disturbance_of_1_N_they_are_within_5_percent_after_eight_minutes(void)
{
    check_campaign(campaign_is_long() ? 50 : 2, 1.0, 60);
}

/* The searches take longer than sets. The ring and the log contain rows and commands from before
 * and after the dropped ones. */
static void test_with_a_small_budget_rows_are_dropped_and_errors_are_within_3_sigma(void)
{
    for (uint64_t seed = 1; seed <= 3; ++seed) {
        identify(seed, 1.0, 30, 5, 40);
        TEST_ASSERT_TRUE(id.metric.sets.rows_dropped > 0);
        TEST_ASSERT_TRUE(thrusters.state.pauses > 0);
        for (int i = X_U; i < PARAMETERS; ++i) {
            double sigma = (double)id.estimate.confidence.sigma[i];
            TEST_ASSERT_DOUBLE_WITHIN(3 * sigma, truth[i], (double)id.estimate.pi[i]);
            TEST_ASSERT_TRUE(i >= LAG || fabs(error_of(i)) < 0.2);
        }
    }
}

/* ---- cost of a row ---- */

/* Eight thrusters, lags of up to 2 s, slots of 1 ms: the most expensive rows of half a second. */
enum { MANY = AUVID_MAX_COMMANDS, SHORT_US = 1000 };
enum { SHORT_SLOTS = AUVID_THRUSTERS_SLOTS(1, 5000000u, SHORT_US) + 1000u };
static int16_t short_log[MANY * SHORT_SLOTS];
static uint32_t rows_worked;

static void counting_residual(const void *context, const auvid_sample_t *s, const auvid_real_t *pi,
                              auvid_real_t *e)
{
    (void)context;
    ++rows_worked;
    e[AUVID_SURGE] = pi[M_U] * s->nu_dot[AUVID_SURGE] - s->tau[AUVID_SURGE];
}

static void begin_expensive(void)
{
    static auvid_vehicle_t counted;
    counted = hull;
    counted.path = &auvid_path_residual;
    counted.regressor = NULL;
    counted.residual = counting_residual;
    cfg.hull = &counted;
    cfg.thrusters = MANY;
    for (int i = 0; i < MANY; ++i) {
        cfg.matrix[AUVID_SURGE][i] = 1;
    }
    cfg.lag_max_s = 2;
    cfg.period_us = SHORT_US;
    cfg.log = short_log;
    cfg.slots = SHORT_SLOTS;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_init(&thrusters, &cfg, NULL));
    defaults(5, 5);
    id_config.metric.sets = 1;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_configure(&thrusters, &id_config));
}

/* Returns true if a row reads any of the first `slots` slots of the log, or of the last ones. */
static bool row_reads(uint32_t slots, bool last, uint64_t t_us)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0}, wrench[AUVID_DOF_COUNT];
    pi[FORWARD] = 100;
    pi[LAG] = 2;
    memset(short_log, 0, sizeof short_log);
    for (uint32_t i = 0; i < MANY * slots; ++i) {
        short_log[last ? MANY * SHORT_SLOTS - 1 - i : i] = 32767;
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_wrench(&thrusters, t_us, pi, wrench));
    return wrench[AUVID_SURGE] > 0;
}

/* Returns the number of slots at one end of the log that a row does not read. */
static uint32_t unread_slots(bool last, uint64_t t_us)
{
    uint32_t low = 0, high = SHORT_SLOTS; /* reads none of the first `low` */
    while (high - low > 1) {
        uint32_t middle = (low + high) / 2;
        if (row_reads(middle, last, t_us)) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return low;
}

/* A slot and thruster costs at least 20 instructions, the minimum for the lag. */
static void test_work_accounts_for_every_slot_that_a_row_reads(void)
{
    const auvid_real_t none[AUVID_MAX_COMMANDS] = {0};
    uint64_t units = 0, end_us = SHORT_SLOTS * (uint64_t)SHORT_US;
    begin_expensive();
    for (uint64_t t_us = 0; t_us <= end_us; t_us += 100000) {
        auvid_thrusters_command(&thrusters, t_us, none);
    }
    uint64_t row_us = end_us - 1000000;
    TEST_ASSERT_TRUE(row_reads(SHORT_SLOTS, false, row_us));
    uint32_t slots = SHORT_SLOTS - unread_slots(false, row_us) - unread_slots(true, row_us);
    TEST_ASSERT_TRUE(slots >= 6000); /* three times the lag */
    begin_expensive();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &id_config));
    for (int tick = 1; tick < 1300 && id.metric.sets.recorded == 0; ++tick) {
        uint64_t t_us = (uint64_t)tick * 10000;
        auvid_real_t x = (auvid_real_t)sin(0.02 * tick), still[AUVID_DOF_COUNT] = {0};
        const auvid_real_t nu[AUVID_DOF_COUNT] = {x}, wrench[AUVID_DOF_COUNT] = {100 * x};
        const auvid_real_t command[AUVID_MAX_COMMANDS] = {x, x};
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_motion(&id, t_us, still, nu));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&id, t_us, wrench, command));
    }
    rows_worked = 0;
    for (int call = 0; rows_worked < 300 && call < 100000; ++call) {
        TEST_ASSERT_EQUAL(AUVID_PENDING, auvid_identifier_work(&id, AUVID_DEFAULT_BUDGET));
        TEST_ASSERT_TRUE(id.work.last_units <= AUVID_DEFAULT_BUDGET);
        units += id.work.last_units;
    }
    TEST_ASSERT_EQUAL_UINT32(300, rows_worked);
    TEST_ASSERT_TRUE(250 * units >= (uint64_t)20 * slots * MANY * rows_worked);
}

static void test_rows_too_expensive_for_work_are_refused(void)
{
    begin_expensive();
    defaults(5000, 0); /* rows of 500 s */
    id_config.metric.sets = 1;
    id_config.metric.set_rows = 1;
    cfg.slots = 4000000; /* the log is not accessed */
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_init(&thrusters, &cfg, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_thrusters_configure(&thrusters, &id_config));
    TEST_ASSERT_NULL(id_config.listener);
}

/* Returns the units that an evaluation of the cost takes. */
static uint32_t evaluate(auvid_metric_t *m, const auvid_real_t *pi)
{
    uint32_t budget = UINT32_MAX;
    auvid_metric_cost_begin(m, pi, 0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_cost(m, &budget));
    return UINT32_MAX - budget;
}

/* A candidate that differs only in parameters of the hull takes the thrust of the last one: the
 * cost has the same bits as with thrust that is computed, for a part of the work. */
static void test_the_thrust_is_kept_until_a_parameter_of_the_thrusters_changes(void)
{
    identify(1, 0.0, 30, 5, 0);
    auvid_metric_t *m = &id.metric;
    auvid_real_t pi[AUVID_MAX_PARAMETERS], other[AUVID_MAX_PARAMETERS];
    memcpy(pi, id.estimate.pi, sizeof pi);
    memcpy(other, pi, sizeof pi);
    other[LAG] *= AUVID_C(1.01);
    uint32_t full = evaluate(m, other);
    TEST_ASSERT_EQUAL_UINT32(full, evaluate(m, pi));
    TEST_ASSERT_TRUE(evaluate(m, pi) < full / 2);
    pi[X_UU] *= AUVID_C(1.01);
    TEST_ASSERT_TRUE(evaluate(m, pi) < full / 2);
    auvid_real_t kept = m->result.cost;
    (void)evaluate(m, other);
    TEST_ASSERT_TRUE(m->result.cost > kept || m->result.cost < kept);
    TEST_ASSERT_EQUAL_UINT32(full, evaluate(m, pi));
    TEST_ASSERT_EQUAL_MEMORY(&kept, &m->result.cost, sizeof kept);
}

/* ---- lost commands, and a restart ---- */

/* A tick at rest under this command of the first thruster; *t_us: its time. */
static void tick_at_rest(uint64_t *t_us, auvid_real_t command)
{
    const auvid_real_t still[AUVID_DOF_COUNT] = {0};
    auvid_input_t in = {.applied = {.present = true, .wrench = {100 * command}}};
    auvid_output_t out;
    in.applied.command[0] = command;
    in.t_us = *t_us += PERIOD_US;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_motion(&id, *t_us, still, still));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&id, &in, &out));
}

/* While the vehicle is idle, the sets stay. When the log no longer has their commands, the next set
 * drops them, and the estimate uses only that set. */
static void test_sets_whose_commands_are_lost_are_dropped_with_the_next_set(void)
{
    cfg.slots = AUVID_THRUSTERS_SLOTS(SETS, 30 * 1000000u, PERIOD_US);
    identify(1, 0.0, 30, 5, UINT32_MAX);
    TEST_ASSERT_EQUAL_UINT32(SETS * 60, id.metric.result.dof_rows[AUVID_SURGE]);
    uint64_t t_us = id.t_us;
    for (int tick = 0; tick < 400 * 50; ++tick) {
        tick_at_rest(&t_us, tick < 300 * 50 ? 0 : (auvid_real_t)sin(0.02 * tick));
        if (tick < 300 * 50) {
            TEST_ASSERT_EQUAL_UINT32(SETS * 60, id.metric.result.dof_rows[AUVID_SURGE]);
        }
        (void)auvid_identifier_work(&id, UINT32_MAX);
    }
    TEST_ASSERT_TRUE(id.metric.result.dof_rows[AUVID_SURGE] > 0);
    TEST_ASSERT_TRUE(id.metric.result.dof_rows[AUVID_SURGE] <= 4 * 60);
}

static void test_the_last_set_waits_while_a_search_reads_the_rows(void)
{
    identify(1, 0.0, 30, 5, UINT32_MAX);
    uint64_t t_us = id.t_us;
    for (int tick = 0; tick < 60 * 50; ++tick) { /* a set, and the next one */
        tick_at_rest(&t_us, (auvid_real_t)sin(0.02 * tick));
        (void)auvid_identifier_work(&id, 1);
    }
    TEST_ASSERT_EQUAL(AUVID_PENDING, auvid_identifier_close(&id));
}

/* Works until the search is complete. Returns the number of the estimate. */
static uint32_t finish_search(auvid_identifier_t *on)
{
    finish_work(on, 1000);
    return on->estimate.number;
}

static void restart(bool with_log)
{
    static uint8_t saved[AUVID_CHECKPOINT_MAX((SETS + 1) * 60)];
    static int16_t log_saved[sizeof commands / sizeof commands[0]];
    auvid_checkpoint_t cursor;
    uint32_t bytes = sizeof saved;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_begin(&cursor, &id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_next(&cursor, saved, &bytes));
    auvid_thrusters_state_t state = thrusters.state;
    memcpy(log_saved, commands, sizeof commands);
    memset(commands, 0x55, sizeof commands);
    memset(store, 0x55, sizeof store);
    configure(1, 30, 5); /* as the next process does */
    if (with_log) {
        thrusters.state = state;
        memcpy(commands, log_saved, sizeof commands);
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, saved, bytes));
}

static void check_restart(void)
{
    static auvid_estimate_t expected_estimate;
    identify(1, 0.0, 30, 5, 0);
    uint32_t number = id.estimate.number;
    id.work.set_pending = true; /* evaluates all sets once more */
    for (int i = 0; i < 20; ++i) {
        TEST_ASSERT_EQUAL(AUVID_PENDING, auvid_identifier_work(&id, 3001));
    }
    static auvid_identifier_t before;
    before = id;
    TEST_ASSERT_EQUAL_UINT32(number + 1, finish_search(&id));
    expected_estimate = id.estimate;
    id = before;
    restart(true);
    TEST_ASSERT_EQUAL_UINT32(number + 1, finish_search(&id));
    TEST_ASSERT_EQUAL_MEMORY(expected_estimate.pi, id.estimate.pi, sizeof id.estimate.pi);
    TEST_ASSERT_EQUAL_MEMORY(&expected_estimate.cost, &id.estimate.cost, sizeof id.estimate.cost);
}

static void test_a_restart_with_checkpoint_and_log_continues_to_the_same_bits(void)
{
    check_restart();
    use_sheet(1.0, 0.5);
    check_restart();
    TEST_ASSERT_NOT_EQUAL(0, prior.known);
}

static void test_sets_whose_log_was_lost_in_a_restart_are_dropped(void)
{
    identify(1, 0.0, 30, 5, 0);
    restart(false);
    auvid_thrusters_command(&thrusters, id.t_us + PERIOD_US, NULL);
    id.work.set_pending = true;
    (void)finish_search(&id);
    TEST_ASSERT_EQUAL_UINT32(SETS, id.estimate.sets);
    for (int age = 0; age < SETS; ++age) {
        TEST_ASSERT_EQUAL_UINT32(0, id.metric.sets.set[age].rows);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_thrusters_and_drag_are_within_5_percent_and_drag_of_the_ideal_one_is_20_off);
    RUN_TEST(test_under_a_disturbance_of_1_N_they_are_within_5_percent_after_eight_minutes);
    RUN_TEST(test_with_a_small_budget_rows_are_dropped_and_errors_are_within_3_sigma);
    RUN_TEST(test_work_accounts_for_every_slot_that_a_row_reads);
    RUN_TEST(test_rows_too_expensive_for_work_are_refused);
    RUN_TEST(test_the_thrust_is_kept_until_a_parameter_of_the_thrusters_changes);
    RUN_TEST(test_sets_whose_commands_are_lost_are_dropped_with_the_next_set);
    RUN_TEST(test_the_last_set_waits_while_a_search_reads_the_rows);
    RUN_TEST(test_a_restart_with_checkpoint_and_log_continues_to_the_same_bits);
    RUN_TEST(test_sets_whose_log_was_lost_in_a_restart_are_dropped);
    return UNITY_END();
}
