/*
 * Thrusters with a dead band, a gain in each direction and a lag: identified together with the hull
 * from the commands of every tick.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "auvid/checkpoint.h"
#include "auvid/prior.h"
#include "auvid/thrusters.h"
#include "binomial.h"
#include "chain.h"
#include "finish.h"
#include "unity.h"

/* A hull with one axis, surge; the parameters of its couplings are known. */
enum { M_U, M_V, M_W, W_B, X_U, X_UU, HULL };
enum { FORWARD = HULL, BACKWARD, DEAD_BAND, LAG, PARAMETERS };
enum { FREE = 1u << X_U | 1u << X_UU };

static const auvid_parameter_t parameter[HULL] = {
    {"m_u", "kg", AUVID_SURGE, AUVID_PARAMETER_MASS},
    {"m_v", "kg", AUVID_SURGE, AUVID_PARAMETER_MASS},
    {"m_w", "kg", AUVID_SURGE, AUVID_PARAMETER_MASS},
    {"W-B", "N", AUVID_SURGE, AUVID_PARAMETER_FORCE},
    {"X_u", "N s/m", AUVID_SURGE, AUVID_PARAMETER_LINEAR_DRAG},
    {"X_uu", "N s2/m2", AUVID_SURGE, AUVID_PARAMETER_QUADRATIC_DRAG},
};

static void regressor(const void *context, const auvid_sample_t *s, const auvid_real_t *pi,
                      auvid_regressor_t *y)
{
    (void)context;
    (void)pi;
    auvid_real_t *x = y->row[AUVID_SURGE], u = s->nu[AUVID_SURGE];
    x[M_U] = s->nu_dot[AUVID_SURGE];
    x[M_V] = -s->nu[AUVID_SWAY] * s->nu[AUVID_YAW];
    x[M_W] = s->nu[AUVID_HEAVE] * s->nu[AUVID_PITCH];
    x[W_B] = (auvid_real_t)sin((double)s->theta);
    x[X_U] = -u;
    x[X_UU] = -(u > 0 ? u : -u) * u;
}

static const auvid_vehicle_t hull = {.built_for = AUVID_BUILD,
                                     .path = &auvid_path_regressor,
                                     .name = "surge",
                                     .parameters = HULL,
                                     .parameter = parameter,
                                     .columns = {[AUVID_SURGE] = (1u << HULL) - 1},
                                     .free = FREE,
                                     .regressor = regressor};

enum { SETS = 8, ROW_CELLS = 2, LONGEST_S = 60, PERIOD_US = 20000 };
enum { SLOTS = AUVID_THRUSTERS_SLOTS(SETS, LONGEST_S * 1000000u, PERIOD_US) };
static int16_t commands[2 * SLOTS];
static auvid_row_t store[(SETS + 1) * LONGEST_S * 10 / ROW_CELLS];
static auvid_thrusters_config_t cfg;
static auvid_identifier_config_t id_config;
static auvid_thrusters_t thrusters;
static auvid_identifier_t id, ideal;
static auvid_prior_t prior;
static bool with_prior;

/* Two thrusters at the stern with the same command. */
void setUp(void)
{
    auvid_thrusters_defaults(&cfg);
    cfg.hull = &hull;
    cfg.thrusters = 1;
    cfg.matrix[AUVID_SURGE][0] = 2;
    cfg.gain_max = 300;
    cfg.log = commands;
    cfg.slots = SLOTS;
    with_prior = false;
}

void tearDown(void)
{
}

static void defaults(uint16_t row_cells, uint16_t set_s)
{
    auvid_identifier_defaults(&id_config, &thrusters.vehicle);
    id_config.metric.rows = store;
    id_config.metric.sets = SETS;
    id_config.metric.row_cells = row_cells;
    id_config.metric.set_rows = (uint16_t)(set_s * 10u / row_cells);
    id_config.metric.fixed[M_U] = 250;
}

static void begin(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_init(&thrusters, &cfg));
    defaults(ROW_CELLS, 30);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_configure(&thrusters, &id_config));
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

/* ---- refusals ---- */

static void test_init_refuses_values_out_of_range(void)
{
    auvid_thrusters_config_t good = cfg;
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_thrusters_init(&thrusters, NULL));
    cfg.log = NULL;
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_thrusters_init(&thrusters, &cfg));
    cfg = good;
    auvid_vehicle_t other_sizes = *good.hull;
    other_sizes.built_for = NULL;
    cfg.hull = &other_sizes;
    TEST_ASSERT_EQUAL(AUVID_ERR_SIZE, auvid_thrusters_init(&thrusters, &cfg));
    cfg = good;
    cfg.thrusters = AUVID_MAX_COMMANDS + 1;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_thrusters_init(&thrusters, &cfg));
    cfg = good;
    cfg.group[0] = 1; /* and none is 0 */
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_thrusters_init(&thrusters, &cfg));
    cfg = good;
    cfg.lag_max_s = (auvid_real_t)NAN;
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_thrusters_init(&thrusters, &cfg));
    cfg = good;
    cfg.command_max = (auvid_real_t)1e-7;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_thrusters_init(&thrusters, &cfg));
    cfg = good;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_init(&thrusters, &cfg));
    cfg.hull = &thrusters.vehicle; /* it would call itself */
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_thrusters_init(&thrusters, &cfg));
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
        TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_thrusters_init(&thrusters, &cfg));
        *sheet[k] = -1;
        TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_thrusters_init(&thrusters, &cfg));
        *sheet[k] = (auvid_real_t)NAN;
        TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_thrusters_init(&thrusters, &cfg));
    }
    cfg = good;
    cfg.matrix[AUVID_YAW][0] = (auvid_real_t)INFINITY;
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_thrusters_init(&thrusters, &cfg));
    cfg = good;
    cfg.thrusters = 2; /* the second acts on nothing */
    cfg.group[1] = 1;
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_thrusters_init(&thrusters, &cfg));
    cfg.thrusters = 4;
    for (int i = 1; i < 4; ++i) {
        cfg.group[i] = (uint8_t)i;
        cfg.matrix[AUVID_SURGE][i] = 1;
    }
    TEST_ASSERT_EQUAL(HULL + 4 * 4 <= AUVID_MAX_PARAMETERS ? AUVID_OK : AUVID_ERR_PARAMETERS,
                      auvid_thrusters_init(&thrusters, &cfg));
}

static void test_masses_drags_and_gains_must_not_all_be_free(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_init(&thrusters, &cfg));
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
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_thrusters_init(&thrusters, &cfg));
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
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_init(&thrusters, &cfg));
    before = thrusters;
    auvid_thrusters_command(&thrusters, 1000000, command);
    TEST_ASSERT_EQUAL_MEMORY(&before, &thrusters, sizeof before);
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
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_init(&thrusters, &cfg));
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
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_init(&thrusters, &cfg));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_thrusters_configure(&thrusters, &id_config));
    TEST_ASSERT_NULL(id_config.listener);
}

/* ---- identification ---- */

static double truth[PARAMETERS];

static double thrust(double c)
{
    double d = truth[DEAD_BAND];
    return c > d ? truth[FORWARD] * (c - d) : c < -d ? truth[BACKWARD] * (c + d) : 0.0;
}

/* Each seed has another vehicle, with each parameter within 30 % of its usual value. */
static void draw_world(sim_config_t *world, uint64_t seed, double disturbance_N)
{
    sim_rng_t rng;
    double scale[6];
    sim_rng_seed(&rng, seed, 77);
    for (int i = 0; i < 6; ++i) {
        scale[i] = 0.7 + 0.6 * sim_rng_uniform(&rng);
    }
    sim_defaults(world);
    world->seed = seed;
    world->disturbance_N = disturbance_N;
    truth[M_U] = world->parameter[SIM_M_U] *= scale[0];
    truth[M_V] = world->parameter[SIM_M_V];
    truth[M_W] = world->parameter[SIM_M_W];
    truth[W_B] = world->parameter[SIM_WB];
    truth[X_U] = world->parameter[SIM_X_U] *= scale[1];
    truth[X_UU] = world->parameter[SIM_X_UU] *= scale[2];
    truth[FORWARD] = 80.0 * scale[3];
    truth[BACKWARD] = truth[FORWARD] * (0.7 + 0.1 * sim_rng_uniform(&rng));
    truth[DEAD_BAND] = 0.1 * scale[4];
    truth[LAG] = 0.22 * scale[5];
}

static void configure(uint64_t seed, uint16_t set_s, uint16_t row_cells)
{
    const auvid_real_t amplitude[AUVID_DOF_COUNT] = {1}; /* of the command */
    static auvid_actuation_t actuation;
    auvid_actuation_config_t acting;
    auvid_identifier_config_t plain;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_init(&thrusters, &cfg));
    defaults(row_cells, set_s);
    auvid_identifier_defaults(&plain, &hull);
    plain.metric.set_rows = (uint16_t)(set_s * 2);
    for (int i = 0; i < X_U; ++i) {
        id_config.metric.fixed[i] = plain.metric.fixed[i] = (auvid_real_t)truth[i];
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_configure(&thrusters, &id_config));
    id_config.search.upper[X_U] = id_config.search.upper[X_UU] = 0;
    id_config.search.seed = seed;
    auvid_actuation_defaults(&acting);
    acting.guard.off = /* there is no depth sensor, and enough space */
        AUVID_GUARD_BIT(AUVID_GUARD_DEPTH_MIN) | AUVID_GUARD_BIT(AUVID_GUARD_DEPTH_MAX);
    acting.guard.distance_max_m = 1000;
    acting.guard.speed_max = 5;
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_excitation_plan(&acting.excitation, amplitude, set_s, SETS, seed));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &id_config));
    if (with_prior) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_attach_prior(&thrusters, &id, &prior));
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_actuation(&id, &actuation, &acting, NULL));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&ideal, &plain));
}

/* Returns the mean force of a thruster over a tick; the lag is computed in steps of 2 ms. */
static double follow(double *x, double command)
{
    double mean = 0.0, g = thrust(command), h = 0.002;
    for (int i = 0; i < 10; ++i) {
        double e = exp(-h / truth[LAG]);
        mean += 0.1 * (g + (*x - g) * (1.0 - e) * truth[LAG] / h);
        *x = g + (*x - g) * e;
    }
    return mean;
}

/* The excitation's surge "force" is the command of both thrusters. `ideal` receives the mean gain
 * times the command as force. */
static void identify(uint64_t seed, double disturbance_N, uint16_t set_s, uint16_t row_cells,
                     uint32_t budget)
{
    sim_config_t world;
    sim_t sim;
    sim_output_t sensed;
    double x = 0.0;
    auvid_real_t command = 0;
    bool excited = false;
    draw_world(&world, seed, disturbance_N);
    configure(seed, set_s, row_cells);
    TEST_ASSERT_TRUE(sim_init(&sim, &world));
    for (int tick = 0; tick < SETS * set_s * 50 + 300; ++tick) {
        auvid_input_t in;
        auvid_output_t out, other;
        const double wrench[6] = {2.0 * follow(&x, (double)command), 0.0, -truth[W_B]};
        sim_step(&sim, NULL, wrench, &sensed);
        chain_sense(&sensed, 0, &in);
        in.depth.present = in.altitude.present = in.gps.present = false;
        if (!excited && auvid_identifier_arm(&id) == AUVID_OK) {
            excited = auvid_identifier_excite(&id) == AUVID_OK;
        }
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&id, &in, &out));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&ideal, &in, &other));
        command = out.excitation[AUVID_SURGE];
        const auvid_real_t gain = (auvid_real_t)(truth[FORWARD] + truth[BACKWARD]);
        const auvid_real_t nominal[AUVID_DOF_COUNT] = {gain * command};
        const auvid_real_t all[AUVID_MAX_COMMANDS] = {command};
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&id, in.t_us, nominal, all));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&ideal, in.t_us, nominal, NULL));
        (void)auvid_identifier_work(&id, budget);
        TEST_ASSERT_TRUE(id.work.last_units <= budget);
    }
    finish_work(&id, UINT32_MAX);
    finish_work(&ideal, UINT32_MAX);
    TEST_ASSERT_TRUE(id.estimate.sets == SETS || id.metric.sets.rows_dropped > 0);
    TEST_ASSERT_EQUAL_HEX32(FREE | 15u << HULL, id.estimate.identified);
    TEST_ASSERT_FALSE(id.estimate.not_converged);
}

static double error_of(int i)
{
    return (double)id.estimate.pi[i] / truth[i] - 1.0;
}

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

/* The wrench of rows before and after a pause equals that of a log without it. If there are too
 * many pauses, the log drops the oldest one and everything before it. */
/* ---- the data sheet as a prior ---- */

/* A data sheet of the thrusters of seed 1, with a lag `by` times the true one. */
static void use_sheet(double by, double lag_sigma_s)
{
    sim_config_t world;
    draw_world(&world, 1, 0.0);
    with_prior = true;
    cfg.sheet[0].gain = (auvid_real_t)truth[FORWARD];
    cfg.sheet[0].backward = (auvid_real_t)(truth[BACKWARD] / truth[FORWARD]);
    cfg.sheet[0].dead_band = (auvid_real_t)truth[DEAD_BAND];
    cfg.sheet[0].lag_s = (auvid_real_t)(by * truth[LAG]);
    cfg.sheet[0].lag_sigma_s = (auvid_real_t)lag_sigma_s;
}

static void test_the_sheet_is_a_prior_of_the_free_parameters(void)
{
    const double nominal[] = {80, 64, 0.05, 0.15}, sigma[] = {4, 64 * sqrt(0.005), 0.012, 0.06};
    cfg.sheet[0].gain = 80;
    cfg.sheet[0].backward = (auvid_real_t)0.8;
    cfg.sheet[0].dead_band = (auvid_real_t)0.05;
    begin();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &id_config));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_attach_prior(&thrusters, &id, &prior));
    TEST_ASSERT_EQUAL_HEX32(15u << HULL, prior.known);
    for (int k = 0; k < AUVID_THRUSTERS_PER_GROUP; ++k) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-5 * nominal[k], nominal[k], (double)prior.pi[HULL + k]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5 * sigma[k], sigma[k], (double)prior.sigma[HULL + k]);
    }
    TEST_ASSERT_TRUE(thrusters.vehicle.own_thrust);
    cfg.sheet[0].gain = 0;
    cfg.sheet[0].lag_sigma_s = 0;
    begin();
    id_config.metric.free &= ~(1u << FORWARD);
    id_config.metric.fixed[FORWARD] = 50; /* known: the backward gain follows */
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &id_config));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_attach_prior(&thrusters, &id, &prior));
    TEST_ASSERT_EQUAL_HEX32(1u << BACKWARD | 1u << DEAD_BAND, prior.known);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 40.0, (double)prior.pi[BACKWARD]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 2.0, (double)prior.sigma[BACKWARD]);
    TEST_ASSERT_FALSE(thrusters.vehicle.own_thrust);
}

static void test_a_prior_is_attached_to_the_identifier_of_its_thrusters_before_it_steps(void)
{
    auvid_input_t in = {.t_us = 1};
    auvid_output_t out;
    auvid_identifier_config_t plain;
    memset(&thrusters, 0, sizeof thrusters);
    memset(&id, 0, sizeof id);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_thrusters_attach_prior(NULL, &id, &prior));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_thrusters_attach_prior(&thrusters, NULL, &prior));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_thrusters_attach_prior(&thrusters, &id, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_thrusters_attach_prior(&thrusters, &id, &prior));
    begin();
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_thrusters_attach_prior(&thrusters, &id, &prior));
    auvid_identifier_defaults(&plain, &hull);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &plain));
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_thrusters_attach_prior(&thrusters, &id, &prior));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &id_config));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_attach_prior(&thrusters, &id, &prior));
    TEST_ASSERT_EQUAL(AUVID_ERR_ATTACHED, auvid_thrusters_attach_prior(&thrusters, &id, &prior));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &id_config));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&id, &in, &out));
    TEST_ASSERT_EQUAL(AUVID_ERR_STARTED, auvid_thrusters_attach_prior(&thrusters, &id, &prior));
}

static void test_a_sharp_prior_fixes_a_parameter_and_one_that_the_data_contradict_is_discarded(void)
{
    identify(1, 1.0, 30, 5, 0);
    auvid_real_t sigma = id.estimate.confidence.sigma[LAG];
    use_sheet(1.02, 1e-4);
    identify(1, 1.0, 30, 5, 0);
    TEST_ASSERT_EQUAL_UINT32(2 * 6 + 1, id.estimate.evaluations_line); /* the steps end there */
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, 1.02 * truth[LAG], (double)id.estimate.pi[LAG]);
    TEST_ASSERT_TRUE(id.estimate.confidence.sigma[LAG] < sigma / 2);
    TEST_ASSERT_EQUAL_HEX32(15u << HULL, prior.known);
    use_sheet(2.0, 1e-4);
    identify(1, 1.0, 30, 5, 0);
    TEST_ASSERT_EQUAL_HEX32(0, prior.known);
    TEST_ASSERT_TRUE(fabs(error_of(LAG)) < 0.1);
}

/* All deviations 0. */
static void test_a_sheet_without_deviations_changes_no_bit(void)
{
    static auvid_estimate_t without;
    identify(1, 1.0, 30, 5, 0);
    without = id.estimate;
    use_sheet(2.0, 0.0);
    cfg.sheet[0].gain_sigma = cfg.sheet[0].backward_sigma = cfg.sheet[0].dead_band_sigma = 0;
    identify(1, 1.0, 30, 5, 0);
    TEST_ASSERT_EQUAL_HEX32(0, prior.known);
    TEST_ASSERT_EQUAL_MEMORY(&without, &id.estimate, sizeof without);
}

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

/* While the vehicle is idle, the sets stay. When the log no longer has their commands, the next set
 * drops them, and the estimate uses only that set. */
static void test_sets_whose_commands_are_lost_are_dropped_with_the_next_set(void)
{
    cfg.slots = AUVID_THRUSTERS_SLOTS(SETS, 30 * 1000000u, PERIOD_US);
    identify(1, 0.0, 30, 5, UINT32_MAX);
    TEST_ASSERT_EQUAL_UINT32(SETS * 60, id.metric.result.dof_rows[AUVID_SURGE]);
    const auvid_real_t still[AUVID_DOF_COUNT] = {0};
    uint64_t t_us = id.t_us;
    for (int tick = 0; tick < 400 * 50; ++tick) {
        const auvid_real_t command = tick < 300 * 50 ? 0 : (auvid_real_t)sin(0.02 * tick);
        const auvid_real_t wrench[AUVID_DOF_COUNT] = {100 * command};
        const auvid_real_t all[AUVID_MAX_COMMANDS] = {command};
        t_us += PERIOD_US;
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_motion(&id, t_us, still, still));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&id, t_us, wrench, all));
        if (tick < 300 * 50) {
            TEST_ASSERT_EQUAL_UINT32(SETS * 60, id.metric.result.dof_rows[AUVID_SURGE]);
        }
        (void)auvid_identifier_work(&id, UINT32_MAX);
    }
    TEST_ASSERT_TRUE(id.metric.result.dof_rows[AUVID_SURGE] > 0);
    TEST_ASSERT_TRUE(id.metric.result.dof_rows[AUVID_SURGE] <= 4 * 60);
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
    RUN_TEST(test_init_refuses_values_out_of_range);
    RUN_TEST(test_masses_drags_and_gains_must_not_all_be_free);
    RUN_TEST(test_a_log_too_short_for_the_ring_is_refused);
    RUN_TEST(test_thrusters_refused_by_init_are_refused_and_do_nothing);
    RUN_TEST(test_commands_before_configure_are_not_logged);
    RUN_TEST(test_work_accounts_for_every_slot_that_a_row_reads);
    RUN_TEST(test_rows_too_expensive_for_work_are_refused);
    RUN_TEST(test_thrusters_and_drag_are_within_5_percent_and_drag_of_the_ideal_one_is_20_off);
    RUN_TEST(test_under_a_disturbance_of_1_N_they_are_within_5_percent_after_eight_minutes);
    RUN_TEST(test_with_a_small_budget_rows_are_dropped_and_errors_are_within_3_sigma);
    RUN_TEST(test_the_sheet_is_a_prior_of_the_free_parameters);
    RUN_TEST(test_a_prior_is_attached_to_the_identifier_of_its_thrusters_before_it_steps);
    RUN_TEST(test_a_sharp_prior_fixes_a_parameter_and_one_that_the_data_contradict_is_discarded);
    RUN_TEST(test_a_sheet_without_deviations_changes_no_bit);
    RUN_TEST(test_the_log_skips_a_pause_and_keeps_the_commands_before_it);
    RUN_TEST(test_sets_whose_commands_are_lost_are_dropped_with_the_next_set);
    RUN_TEST(test_the_thrust_is_kept_until_a_parameter_of_the_thrusters_changes);
    RUN_TEST(test_a_restart_with_checkpoint_and_log_continues_to_the_same_bits);
    RUN_TEST(test_sets_whose_log_was_lost_in_a_restart_are_dropped);
    return UNITY_END();
}
