/*
 * Thrusters with a dead band, a gain in each direction and a lag: the thrust of a row that follows
 * from the commands in the log, its derivatives, and configurations that are refused.
 */
#include <math.h>
#include <string.h>

#include "auvid/thrusters.h"
#include "surge_thrusters.h"
#include "unity.h"

void setUp(void)
{
    surge_thrusters_defaults();
}

void tearDown(void)
{
}

/* ---- a candidate's thrust from the log ---- */

static auvid_real_t command_at(double t_s)
{
    return (auvid_real_t)(t_s < 3.0 ? 0.0 : 0.6 * sin(1.7 * t_s) + (t_s < 6.0 ? 0.3 : -0.3));
}

static void fill(double to_s)
{
    for (uint64_t tick = 0; (double)tick * 0.02 < to_s; ++tick) {
        auvid_real_t both[AUVID_MAX_COMMANDS] = {command_at((double)tick * 0.02)};
        both[1] = -both[0];
        auvid_thrusters_command(&thrusters, tick * PERIOD_US, both);
    }
}

/* The mean force in double, in steps of 0.1 ms from time 0 on. The weights are two convolved
 * rectangles of lengths `row_s` and sqrt(2) times `velocity_s`. */
static double expected(double t_s, double row_s, double velocity_s, const double *pi)
{
    const double h = 1e-4, spread = fmax(sqrt(2.0) * velocity_s, 1e-9);
    double x = 0.0, sum = 0.0, all = 0.0;
    for (double t = 0.5 * h; t < t_s + row_s + spread; t += h) {
        double c = (double)command_at(floor(t / 0.02) * 0.02);
        double g = c > pi[2] ? pi[0] * (c - pi[2]) : c < -pi[2] ? pi[1] * (c + pi[2]) : 0.0;
        double low = fmax(t - spread / 2, t_s - row_s / 2);
        double overlap = fmax(fmin(t + spread / 2, t_s + row_s / 2) - low, 0.0);
        x = g + (x - g) * exp(-h / pi[3]);
        sum += overlap * x;
        all += overlap;
    }
    return sum / all;
}

static void check_thrust(const double *group_pi, uint32_t velocity_us, auvid_dof_t dof)
{
    auvid_real_t pi[PARAMETERS] = {0}, wrench[AUVID_DOF_COUNT];
    for (int k = 0; k < AUVID_THRUSTERS_PER_GROUP; ++k) {
        pi[HULL + k] = (auvid_real_t)group_pi[k];
    }
    double worst = 0.0;
    for (double t_s = 2.613; t_s < 11.0; t_s += 0.2) {
        TEST_ASSERT_EQUAL(
            AUVID_OK, auvid_thrusters_wrench(&thrusters, (uint64_t)(t_s * 1e6 + 0.5), pi, wrench));
        double sum = expected(t_s, 0.2, velocity_us * 1e-6, group_pi);
        worst = fmax(worst, fabs((double)wrench[dof] - 2.0 * sum));
    }
    TEST_ASSERT_TRUE(worst < 0.05); /* of 90 N */
}

static void test_the_mean_thrust_of_a_row_is_that_of_the_lag_solved_in_double(void)
{
    static const double group_pi[][AUVID_THRUSTERS_PER_GROUP] = {
        {70, 55, 0.1, 0.2}, {55, 70, 0.25, 0.05}, {60, 60, 0.0, 0.12}, {70, 50, 0.1, 0.003}};
    begin();
    fill(12.0);
    for (size_t i = 0; i < sizeof group_pi / sizeof group_pi[0]; ++i) {
        check_thrust(group_pi[i], id_config.metric.velocity_us, AUVID_SURGE);
    }
}

/* Each column of the derivatives against central differences of the residual, on an axis of force
 * and on one of moment. */
static void test_derivatives_are_those_of_the_residual(void)
{
    static const auvid_real_t group_pi[][AUVID_THRUSTERS_PER_GROUP] = {
        {70, 55, AUVID_C(0.1), AUVID_C(0.2)}, {55, 70, AUVID_C(0.25), AUVID_C(0.05)}};
    static const auvid_real_t step[AUVID_THRUSTERS_PER_GROUP] = {1, 1, AUVID_C(2e-4),
                                                                 AUVID_C(0.002)};
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {250, 300, 350, -10, -40, -120};
    const auvid_vehicle_t *v = &thrusters.vehicle;
    begin();
    fill(12.0);
    TEST_ASSERT_EQUAL_HEX32(((1u << HULL) - 1) | 3u << FORWARD, v->affine);
    for (int i = 0; i < 2 * 40; ++i) {
        auvid_sample_t s = {.t_us = 2613000u + 100000u * (uint64_t)i};
        auvid_real_t up[AUVID_DOF_COUNT], down[AUVID_DOF_COUNT];
        auvid_regressor_t y;
        memset(&y, 0, sizeof y);
        s.nu[AUVID_SURGE] = (auvid_real_t)0.5;
        s.nu_dot[AUVID_SURGE] = (auvid_real_t)0.1;
        memcpy(pi + HULL, group_pi[i % 2], sizeof group_pi[0]);
        v->regressor(v->context, &s, pi, &y);
        for (int k = 0; k < PARAMETERS; ++k) {
            auvid_real_t h = k < HULL ? 1 : step[k - HULL], kept = pi[k];
            pi[k] = kept + h;
            auvid_vehicle_residual(v, &s, pi, up);
            pi[k] = kept - h;
            auvid_vehicle_residual(v, &s, pi, down);
            pi[k] = kept;
            double slope = (double)(up[AUVID_SURGE] - down[AUVID_SURGE]) / (2.0 * (double)h);
            double off = k == LAG ? 4.0 : k == DEAD_BAND ? 2.0 : 1e-3;
            TEST_ASSERT_DOUBLE_WITHIN(off, slope, (double)y.row[AUVID_SURGE][k]);
        }
    }
}

/* The lag continues from row to row: for the same candidate the residual and its derivatives are
 * those of a row by itself, which follows the lag from steady state before it. */
static void test_rows_in_their_order_have_the_thrust_of_a_row_by_itself(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {250, 300, 350, -10, -40, -120};
    const auvid_real_t group_pi[] = {70, 55, AUVID_C(0.1), AUVID_C(0.2)};
    const auvid_vehicle_t *v = &thrusters.vehicle;
    auvid_thrusters_t alone;
    double differences = 0.0;
    begin();
    fill(12.0);
    memcpy(pi + HULL, group_pi, sizeof group_pi);
    for (int i = 0; i < 40; ++i) {
        auvid_sample_t s = {.t_us = 2613000u + 200000u * (uint64_t)i};
        auvid_real_t e[AUVID_DOF_COUNT], wrench[AUVID_DOF_COUNT];
        auvid_regressor_t y, expected_y;
        memset(&y, 0, sizeof y);
        memset(&expected_y, 0, sizeof expected_y);
        auvid_vehicle_residual(v, &s, pi, e);
        v->regressor(v->context, &s, pi, &y);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_wrench(&thrusters, s.t_us, pi, wrench));
        TEST_ASSERT_DOUBLE_WITHIN(0.05, (double)-wrench[AUVID_SURGE], (double)e[AUVID_SURGE]);
        differences += fabs((double)(e[AUVID_SURGE] + wrench[AUVID_SURGE]));
        alone = thrusters;
        alone.carry = &alone.state.carry;
        alone.state.carry.ready[0] = alone.state.carry.ready[1] = false;
        v->regressor(&alone, &s, pi, &expected_y);
        for (int k = FORWARD; k < PARAMETERS; ++k) {
            TEST_ASSERT_DOUBLE_WITHIN(k == LAG ? 0.5 : 0.1, (double)expected_y.row[AUVID_SURGE][k],
                                      (double)y.row[AUVID_SURGE][k]);
        }
    }
    TEST_ASSERT_TRUE(differences > 0.0); /* the lead-in is cut off */
}

static void test_moments_have_equal_weights_over_the_row(void)
{
    static const double group_pi[] = {70, 55, 0.1, 0.2};
    cfg.matrix[AUVID_YAW][0] = 2;
    begin();
    fill(12.0);
    check_thrust(group_pi, 0, AUVID_YAW);
}

static void test_a_mirrored_thruster_uses_the_gains_of_the_opposite_direction(void)
{
    auvid_real_t pi[PARAMETERS] = {0}, one[AUVID_DOF_COUNT], two[AUVID_DOF_COUNT];
    const auvid_real_t there[] = {70, 55, (auvid_real_t)0.1, (auvid_real_t)0.2};
    const auvid_real_t back[] = {55, 70, (auvid_real_t)0.1, (auvid_real_t)0.2};
    begin();
    fill(8.0);
    memcpy(pi + HULL, there, sizeof there);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_wrench(&thrusters, 7000000, pi, one));
    cfg.thrusters = 2;
    cfg.matrix[AUVID_SURGE][0] = 0;
    cfg.matrix[AUVID_SURGE][1] = -2;
    begin();
    fill(8.0);
    memcpy(pi + HULL, back, sizeof back);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_wrench(&thrusters, 7000000, pi, two));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, (double)one[AUVID_SURGE], (double)two[AUVID_SURGE]);
}

static void test_a_lag_of_zero_has_no_delay(void)
{
    auvid_real_t pi[PARAMETERS] = {0}, wrench[AUVID_DOF_COUNT];
    const auvid_real_t one[AUVID_MAX_COMMANDS] = {1};
    begin();
    pi[FORWARD] = 50;
    for (uint64_t tick = 0; tick < 200; ++tick) {
        auvid_thrusters_command(&thrusters, tick * PERIOD_US, tick < 100 ? NULL : one);
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_wrench(&thrusters, 1750000, pi, wrench));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, (double)wrench[AUVID_SURGE]);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_wrench(&thrusters, 2250000, pi, wrench));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 100.0, (double)wrench[AUVID_SURGE]);
}

static void test_irregular_ticks_give_the_mean_command_of_a_slot(void)
{
    auvid_real_t pi[PARAMETERS] = {0}, wrench[AUVID_DOF_COUNT];
    begin();
    pi[FORWARD] = pi[BACKWARD] = 100;
    for (uint64_t t = 0; t < 4000000; t += 7000 + t % 11000) { /* of a ramp: the mean is known */
        const auvid_real_t command[AUVID_MAX_COMMANDS] = {(auvid_real_t)t * (auvid_real_t)1e-7};
        auvid_thrusters_command(&thrusters, t, command);
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_wrench(&thrusters, 3000000, pi, wrench));
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 60.0, (double)wrench[AUVID_SURGE]);
}

static void test_commands_beyond_the_largest_are_clipped_to_it(void)
{
    auvid_real_t pi[PARAMETERS] = {0}, wrench[AUVID_DOF_COUNT];
    begin();
    pi[FORWARD] = pi[BACKWARD] = 50;
    for (uint64_t t = 0; t < 4000000; t += PERIOD_US / 4) { /* three quarters of a slot forward */
        auvid_real_t command[AUVID_MAX_COMMANDS] = {AUVID_LARGEST};
        command[0] *= t % PERIOD_US == 0 ? -1 : 1;
        auvid_thrusters_command(&thrusters, t, command);
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_wrench(&thrusters, 3000000, pi, wrench));
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 50.0, (double)wrench[AUVID_SURGE]);
    pi[DEAD_BAND] = (auvid_real_t)NAN;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_wrench(&thrusters, 3000000, pi, wrench));
}

static void test_commands_beyond_the_largest_are_counted(void)
{
    auvid_real_t command[AUVID_MAX_COMMANDS] = {1};
    begin();
    auvid_thrusters_command(&thrusters, 0, command);
    command[0] = -1;
    auvid_thrusters_command(&thrusters, PERIOD_US, command);
    TEST_ASSERT_EQUAL_UINT32(0, thrusters.state.clipped);
    command[0] = (auvid_real_t)-1.01;
    auvid_thrusters_command(&thrusters, 2 * PERIOD_US, command);
    TEST_ASSERT_EQUAL_UINT32(1, thrusters.state.clipped);
}

static void test_a_row_that_is_not_in_the_log_has_no_data(void)
{
    auvid_real_t pi[PARAMETERS] = {0}, wrench[AUVID_DOF_COUNT];
    const auvid_real_t one[AUVID_MAX_COMMANDS] = {1};
    const uint64_t length_us = (uint64_t)SLOTS * PERIOD_US;
    begin();
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_thrusters_wrench(&thrusters, 0, pi, wrench));
    for (uint64_t t = 1000000; t < 5000000 + length_us; t += PERIOD_US) {
        auvid_thrusters_command(&thrusters, t, one);
    }
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_thrusters_wrench(&thrusters, 4900000, pi, wrench));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_wrench(&thrusters, 5600000, pi, wrench));
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA,
                      auvid_thrusters_wrench(&thrusters, 6000000 + length_us, pi, wrench));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_thrusters_wrench(NULL, 0, pi, wrench));
}

static void test_after_a_long_gap_rows_do_not_read_the_commands_before_it(void)
{
    auvid_real_t pi[PARAMETERS] = {0}, wrench[AUVID_DOF_COUNT];
    auvid_real_t command[AUVID_MAX_COMMANDS] = {1};
    begin();
    pi[FORWARD] = 50;
    pi[LAG] = (auvid_real_t)0.3;
    for (uint64_t t = 0; t < 400000000; t += PERIOD_US) {
        auvid_thrusters_command(&thrusters, t, command);
    }
    command[0] = 0;
    auvid_thrusters_command(&thrusters, 400000000, command);
    auvid_thrusters_command(&thrusters, 500000000, command);
    auvid_thrusters_command(&thrusters, 501000000, command);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_wrench(&thrusters, 500000000, pi, wrench));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, (double)wrench[AUVID_SURGE]);
}

/* The wrench of rows before and after a pause equals that of a log without it. If there are too
 * many pauses, the log drops the oldest one and everything before it. */
static void test_the_log_skips_a_pause_and_keeps_the_commands_before_it(void)
{
    const uint64_t pause_us = 3600000000u;
    auvid_real_t pi[PARAMETERS] = {0}, whole[AUVID_DOF_COUNT], wrench[AUVID_DOF_COUNT];
    static auvid_thrusters_t without;
    static int16_t log_without[sizeof commands / sizeof commands[0]];
    begin();
    pi[FORWARD] = 70;
    pi[BACKWARD] = 55;
    pi[LAG] = (auvid_real_t)0.2;
    fill(60.0);
    without = thrusters;
    without.cfg.log = log_without;
    memcpy(log_without, commands, sizeof commands);
    begin();
    for (uint64_t tick = 0; tick < 3000; ++tick) {
        const auvid_real_t one[AUVID_MAX_COMMANDS] = {command_at((double)tick * 0.02)};
        uint64_t t_us = tick * PERIOD_US;
        auvid_thrusters_command(&thrusters, t_us + (tick > 1500 ? pause_us : 0), one);
    }
    TEST_ASSERT_EQUAL_UINT8(1, thrusters.state.pauses);
    for (uint64_t t_us = 5000000; t_us < 59000000; t_us += 700000) {
        bool later = t_us > 30000000;
        if (later && t_us < 33000000) { /* here the lead-in is before the pause */
            continue;
        }
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_wrench(&without, t_us, pi, whole));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_wrench(
                                        &thrusters, t_us + (later ? pause_us : 0), pi, wrench));
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, (double)whole[AUVID_SURGE], (double)wrench[AUVID_SURGE]);
    }
    for (int k = 2; k < AUVID_MAX_SETS + 5; ++k) {
        auvid_thrusters_command(&thrusters, (uint64_t)k * pause_us, NULL);
        auvid_thrusters_command(&thrusters, (uint64_t)k * pause_us + 5000000, NULL);
    }
    TEST_ASSERT_EQUAL_UINT8(AUVID_MAX_SETS + 2, thrusters.state.pauses);
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_thrusters_wrench(&thrusters, 20000000, pi, wrench));
}

/* As a program does that begins again. */
static void test_init_accepts_its_own_configuration(void)
{
    static auvid_thrusters_t again;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_init(&thrusters, &cfg, NULL));
    again = thrusters;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_init(&thrusters, &thrusters.cfg, NULL));
    TEST_ASSERT_EQUAL_MEMORY(&again, &thrusters, sizeof again);
}

/* ---- refusals ---- */

static void test_init_refuses_values_out_of_range(void)
{
    auvid_thrusters_config_t good = cfg;
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_thrusters_init(&thrusters, NULL, NULL));
    cfg.log = NULL;
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_thrusters_init(&thrusters, &cfg, NULL));
    cfg = good;
    auvid_vehicle_t other_sizes = *good.hull;
    other_sizes.built_for = NULL;
    cfg.hull = &other_sizes;
    TEST_ASSERT_EQUAL(AUVID_ERR_SIZE, auvid_thrusters_init(&thrusters, &cfg, NULL));
    cfg = good;
    cfg.thrusters = AUVID_MAX_COMMANDS + 1;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_thrusters_init(&thrusters, &cfg, NULL));
    cfg = good;
    cfg.group[0] = 1; /* and none is 0 */
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_thrusters_init(&thrusters, &cfg, NULL));
    cfg = good;
    cfg.lag_max_s = (auvid_real_t)NAN;
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_thrusters_init(&thrusters, &cfg, NULL));
    cfg = good;
    cfg.command_max = (auvid_real_t)1e-7;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_thrusters_init(&thrusters, &cfg, NULL));
    cfg = good;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_init(&thrusters, &cfg, NULL));
    cfg.hull = &thrusters.vehicle; /* it would call itself */
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_thrusters_init(&thrusters, &cfg, NULL));
    auvid_real_t *const sheet[] = {&cfg.sheet[0].gain,
                                   &cfg.sheet[0].backward,
                                   &cfg.sheet[0].dead_band,
                                   &cfg.sheet[0].lag_s,
                                   &cfg.sheet[0].gain_sigma,
                                   &cfg.sheet[0].backward_sigma,
                                   &cfg.sheet[0].dead_band_sigma,
                                   &cfg.sheet[3].lag_sigma_s};
    const auvid_real_t beyond[] = {301, 101, (auvid_real_t)0.6, 3, 2, 2, 2, (auvid_real_t)1e-5};
    for (size_t k = 0; k < sizeof sheet / sizeof sheet[0]; ++k) {
        cfg = good;
        *sheet[k] = beyond[k];
        TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_thrusters_init(&thrusters, &cfg, NULL));
        *sheet[k] = -1;
        TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_thrusters_init(&thrusters, &cfg, NULL));
        *sheet[k] = (auvid_real_t)NAN;
        TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_thrusters_init(&thrusters, &cfg, NULL));
    }
    cfg = good;
    cfg.matrix[AUVID_YAW][0] = (auvid_real_t)INFINITY;
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_thrusters_init(&thrusters, &cfg, NULL));
    cfg = good;
    cfg.thrusters = 2; /* the second acts on nothing */
    cfg.group[1] = 1;
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_thrusters_init(&thrusters, &cfg, NULL));
    cfg.thrusters = 4;
    for (int i = 1; i < 4; ++i) {
        cfg.group[i] = (uint8_t)i;
        cfg.matrix[AUVID_SURGE][i] = 1;
    }
    TEST_ASSERT_EQUAL(HULL + 4 * 4 <= AUVID_MAX_PARAMETERS ? AUVID_OK : AUVID_ERR_PARAMETERS,
                      auvid_thrusters_init(&thrusters, &cfg, NULL));
}

static void test_masses_drags_and_gains_must_not_all_be_free(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_init(&thrusters, &cfg, NULL));
    defaults(ROW_CELLS, 30);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_thrusters_configure(NULL, &id_config));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_thrusters_configure(&thrusters, NULL));
    id_config.metric.free = 0; /* all */
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_thrusters_configure(&thrusters, &id_config));
    TEST_ASSERT_NULL(id_config.listener);
    id_config.metric.free = (1u << PARAMETERS) - 1u - (1u << LAG); /* not a scale */
    id_config.metric.fixed[LAG] = (auvid_real_t)0.2;
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_thrusters_configure(&thrusters, &id_config));
    id_config.metric.free = (1u << PARAMETERS) - 1u - (1u << FORWARD);
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_thrusters_configure(&thrusters, &id_config));
    id_config.metric.fixed[FORWARD] = 70;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_configure(&thrusters, &id_config));
    TEST_ASSERT_FALSE(id_config.metric.estimate_delay);
    TEST_ASSERT_EQUAL_UINT32(200000, id_config.metric.velocity_us);
    TEST_ASSERT_EQUAL_DOUBLE(300.0, (double)id_config.search.upper[BACKWARD]);
}

static void test_a_log_too_short_for_the_ring_is_refused(void)
{
    cfg.slots = AUVID_THRUSTERS_SLOTS(SETS, 30 * 1000000u, PERIOD_US);
    begin();
    defaults(ROW_CELLS, 40);
    TEST_ASSERT_EQUAL(AUVID_ERR_SIZE, auvid_thrusters_configure(&thrusters, &id_config));
    defaults(50000, 40); /* rows of 5000 s, 705 s modulo 2^32 us */
    id_config.metric.set_rows = 1;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_thrusters_configure(&thrusters, &id_config));
    defaults(ROW_CELLS, 30);
    id_config.metric.velocity_us = UINT32_MAX - 1;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_thrusters_configure(&thrusters, &id_config));
    id_config.vehicle = &hull;
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_thrusters_configure(&thrusters, &id_config));
}

static void test_thrusters_refused_by_init_are_refused_and_do_nothing(void)
{
    const auvid_real_t command[AUVID_MAX_COMMANDS] = {1}, pi[AUVID_MAX_PARAMETERS] = {0};
    auvid_real_t wrench[AUVID_DOF_COUNT] = {1};
    memset(&thrusters, 0, sizeof thrusters);
    cfg.thrusters = 0;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_thrusters_init(&thrusters, &cfg, NULL));
    defaults(ROW_CELLS, 30);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_thrusters_configure(&thrusters, &id_config));
    TEST_ASSERT_NULL(id_config.listener);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_init(&id, &id_config));
    for (uint64_t tick = 1; tick < 100; ++tick) {
        auvid_thrusters_command(&thrusters, tick * PERIOD_US, command);
    }
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_thrusters_wrench(&thrusters, 1000000, pi, wrench));
    TEST_ASSERT_TRUE(wrench[0] == 0);
    static const auvid_thrusters_t blank;
    TEST_ASSERT_EQUAL_MEMORY(&blank, &thrusters, sizeof blank);
}

static void test_commands_before_configure_are_not_logged(void)
{
    const auvid_real_t command[AUVID_MAX_COMMANDS] = {1};
    static auvid_thrusters_t before;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_init(&thrusters, &cfg, NULL));
    before = thrusters;
    auvid_thrusters_command(&thrusters, 1000000, command);
    TEST_ASSERT_EQUAL_MEMORY(&before, &thrusters, sizeof before);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_mean_thrust_of_a_row_is_that_of_the_lag_solved_in_double);
    RUN_TEST(test_derivatives_are_those_of_the_residual);
    RUN_TEST(test_rows_in_their_order_have_the_thrust_of_a_row_by_itself);
    RUN_TEST(test_moments_have_equal_weights_over_the_row);
    RUN_TEST(test_a_mirrored_thruster_uses_the_gains_of_the_opposite_direction);
    RUN_TEST(test_a_lag_of_zero_has_no_delay);
    RUN_TEST(test_irregular_ticks_give_the_mean_command_of_a_slot);
    RUN_TEST(test_commands_beyond_the_largest_are_clipped_to_it);
    RUN_TEST(test_commands_beyond_the_largest_are_counted);
    RUN_TEST(test_a_row_that_is_not_in_the_log_has_no_data);
    RUN_TEST(test_after_a_long_gap_rows_do_not_read_the_commands_before_it);
    RUN_TEST(test_the_log_skips_a_pause_and_keeps_the_commands_before_it);
    RUN_TEST(test_init_accepts_its_own_configuration);
    RUN_TEST(test_init_refuses_values_out_of_range);
    RUN_TEST(test_masses_drags_and_gains_must_not_all_be_free);
    RUN_TEST(test_a_log_too_short_for_the_ring_is_refused);
    RUN_TEST(test_thrusters_refused_by_init_are_refused_and_do_nothing);
    RUN_TEST(test_commands_before_configure_are_not_logged);
    return UNITY_END();
}
