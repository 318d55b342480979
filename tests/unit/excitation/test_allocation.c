/* Allocation: wrench to thrusters and back, saturation, wrenches that are not possible. */
#include "auvid/allocation.h"

#include <math.h>
#include <string.h>

#include "unity.h"

static auvid_allocation_config_t cfg;
static auvid_allocation_t a;
static auvid_allocation_result_t out;

static double tolerance(void)
{
    return sizeof(auvid_real_t) == sizeof(double) ? 1e-12 : 2e-5;
}

void setUp(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_init(&a, &auvid_allocation_girona500));
    auvid_allocation_defaults(&cfg);
    memset(&out, 0x5a, sizeof out);
}

void tearDown(void)
{
}

static void add(double x, double y, double z, double k, double m, double n)
{
    const double column[6] = {x, y, z, k, m, n};
    auvid_thruster_t *t = &cfg.thruster[cfg.thrusters++];
    for (int i = 0; i < 6; ++i) {
        t->wrench[i] = (auvid_real_t)column[i];
    }
    t->min_N = -10;
    t->max_N = 10;
}

static auvid_status_t solve(double x, double y, double z, double k, double m, double n)
{
    const double all[6] = {x, y, z, k, m, n};
    auvid_real_t wrench[6];
    for (int i = 0; i < 6; ++i) {
        wrench[i] = (auvid_real_t)all[i];
    }
    return auvid_allocation_solve(&a, wrench, &out);
}

static void assert_wrench(double x, double y, double z, double k, double m, double n)
{
    const double all[6] = {x, y, z, k, m, n};
    for (int i = 0; i < 6; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(10 * tolerance(), all[i], (double)out.wrench[i]);
    }
}

/* By hand from X = -(f0 + f1), N = 0.4 (f1 - f0), Y = f4, Z = -(f2 + f3), M = 0.35 (f3 - f2). */
static void test_girona500_wrench_is_allocated_as_by_hand(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, solve(60, 30, -40, 0, 7, 16));
    const double expected[5] = {-30 - 20, -30 + 20, 20 - 10, 20 + 10, 30};
    for (int i = 0; i < 5; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(10 * tolerance(), expected[i], (double)out.force_N[i]);
    }
    assert_wrench(60, 30, -40, 0, 7, 16);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, (double)out.scale);
    TEST_ASSERT_EQUAL_INT(0, out.dropped);
}

static void test_girona500_is_actuated_in_all_but_roll(void)
{
    TEST_ASSERT_EQUAL_INT(5, a.rank);
    TEST_ASSERT_EQUAL_INT(0x3f & ~AUVID_DOF_BIT(AUVID_ROLL), a.actuated);
}

/* A force e at r has the moment r x e, from the position and direction of each thruster. */
static void test_bluerov2_columns_are_forces_and_their_moments(void)
{
    for (int i = 0; i < 8; ++i) {
        bool flat = i < 4, rear = i % 4 >= 2, port = i % 2 == 1;
        double across = sqrt(0.5), x = flat ? 0.156 : 0.120, y = flat ? 0.111 : 0.218;
        double r[3] = {rear ? -x : x, port ? -y : y, flat ? 0.085 : 0};
        double e[3] = {rear ? -across : across, port ? across : -across, 0};
        if (!flat) {
            e[0] = e[1] = 0;
            e[2] = rear == port ? -1 : 1;
        }
        double column[6] = {e[0],
                            e[1],
                            e[2],
                            r[1] * e[2] - r[2] * e[1],
                            r[2] * e[0] - r[0] * e[2],
                            r[0] * e[1] - r[1] * e[0]};
        for (int j = 0; j < 6; ++j) {
            TEST_ASSERT_DOUBLE_WITHIN(
                1e-7, column[j], (double)auvid_allocation_bluerov2_heavy.thruster[i].wrench[j]);
        }
    }
}

/* In each direction half of its thrusters run backward, at 40.2 N. */
static void test_bluerov2_is_actuated_in_all_with_the_thrust_of_t200s(void)
{
    const double backward = 4 * 40.2, across = sqrt(0.5);
    const double expected_max[6] = {backward * across, backward * across,
                                    backward,          backward * 0.218,
                                    backward * 0.120,  backward * across * 0.267};
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_init(&a, &auvid_allocation_bluerov2_heavy));
    TEST_ASSERT_EQUAL_INT(0x3f, a.actuated);
    for (int j = 0; j < 6; ++j) {
        auvid_real_t negative, positive;
        TEST_ASSERT_EQUAL_INT(AUVID_OK,
                              auvid_allocation_capacity(&a, (auvid_dof_t)j, &negative, &positive));
        TEST_ASSERT_DOUBLE_WITHIN(1e-5 * expected_max[j], expected_max[j], (double)positive);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5 * expected_max[j], -expected_max[j], (double)negative);
    }
    TEST_ASSERT_EQUAL_INT(AUVID_OK, solve(30, -20, 10, 1, -2, 5));
    assert_wrench(30, -20, 10, 1, -2, 5);
}

static void test_a_wrench_in_a_dof_without_thruster_is_dropped_and_reported(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_SATURATED, solve(60, 0, 0, 5, 0, 0));
    TEST_ASSERT_EQUAL_INT(AUVID_DOF_BIT(AUVID_ROLL), out.dropped);
    assert_wrench(60, 0, 0, 0, 0, 0);
}

static void test_saturation_keeps_the_direction(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_SATURATED, solve(400, 100, -50, 0, 0, 0));
    double k = 2 * 153.8 / 400;
    TEST_ASSERT_DOUBLE_WITHIN(tolerance(), k, (double)out.scale);
    assert_wrench(400 * k, 100 * k, -50 * k, 0, 0, 0);
}

static void test_yaw_is_kept_and_surge_is_reduced(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_SATURATED, solve(300, 0, 0, 0, 0, 80));
    /* Yaw takes 100 N of each of the two; 53.8 N each are left for surge. */
    TEST_ASSERT_EQUAL_DOUBLE(1.0, (double)out.scale_priority);
    assert_wrench(107.6, 0, 0, 0, 0, 80);
}

static void test_yaw_beyond_the_limit_is_scaled_and_takes_all(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_SATURATED, solve(300, 0, 0, 0, 0, -200));
    TEST_ASSERT_DOUBLE_WITHIN(tolerance(), 0.8 * 153.8 / 200, (double)out.scale_priority);
    assert_wrench(0, 0, 0, 0, 0, -0.8 * 153.8);
}

/* Four vectored thrusters in a plane; `up`: the sine of 180 degrees, as a computer has it. */
static void vectored(double up)
{
    const double place[4][2] = {{0.3, 0.2}, {0.3, -0.2}, {-0.3, 0.25}, {-0.3, -0.225}};
    const double heading[4] = {-0.785, 0.785, -2.356, 2.356};
    auvid_allocation_defaults(&cfg);
    for (int i = 0; i < 4; ++i) {
        double x = place[i][0], y = place[i][1], ahead = cos(heading[i]), aside = sin(heading[i]);
        add(ahead, aside, up, y * up, -x * up, x * aside - y * ahead);
    }
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_init(&a, &cfg));
}

static void test_a_rounding_error_in_the_configuration_is_no_thruster(void)
{
    const double errors[] = {0, 1.2246e-16, -4.3711e-8, 1e-5};
    for (int i = 0; i < 4; ++i) {
        vectored(errors[i]);
        TEST_ASSERT_EQUAL_HEX8(AUVID_DOF_BIT(AUVID_SURGE) | AUVID_DOF_BIT(AUVID_SWAY) |
                                   AUVID_DOF_BIT(AUVID_YAW),
                               a.actuated);
        TEST_ASSERT_EQUAL_INT(3, a.rank);
        TEST_ASSERT_EQUAL_INT(AUVID_SATURATED, solve(10, 5, 3, 0, 0, 1));
        TEST_ASSERT_EQUAL_INT(AUVID_DOF_BIT(AUVID_HEAVE), out.dropped);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 10, (double)out.wrench[AUVID_SURGE]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 5, (double)out.wrench[AUVID_SWAY]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 1, (double)out.wrench[AUVID_YAW]);
    }
    vectored(0.01); /* half a degree is a direction */
    TEST_ASSERT_TRUE((a.actuated & AUVID_DOF_BIT(AUVID_HEAVE)) != 0);
}

/* Its inverse would exceed the largest number, and forces would be no numbers. */
static void test_a_thruster_of_hardly_any_effect_is_none(void)
{
    const double entries[] = {1e-38, 1e-7};
    for (int i = 0; i < 2; ++i) {
        auvid_allocation_defaults(&cfg);
        add(entries[i], 0, 0, 0, 0, 0);
        TEST_ASSERT_EQUAL_INT(AUVID_ERR_SINGULAR, auvid_allocation_init(&a, &cfg));
    }
}

/* Two propellers side by side that work ahead only: X = f0 + f1, N = 0.3 (f1 - f0). */
static void twin_propellers(void)
{
    auvid_allocation_defaults(&cfg);
    add(1, 0, 0, 0, 0, -0.3);
    add(1, 0, 0, 0, 0, 0.3);
    for (int i = 0; i < 2; ++i) {
        cfg.thruster[i].min_N = 0;
        cfg.thruster[i].max_N = 50;
    }
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_init(&a, &cfg));
}

/* Surge lets them turn the vehicle, though neither can work astern. */
static void test_what_all_thrusters_can_do_together_is_not_scaled(void)
{
    twin_propellers();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, solve(40, 0, 0, 0, 0, 3));
    assert_wrench(40, 0, 0, 0, 0, 3);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, (double)out.scale_priority);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, (double)out.scale);
}

/* Yaw has as much as any surge up to the requested one allows. */
static void test_yaw_is_scaled_by_the_largest_factor_with_any_surge(void)
{
    twin_propellers();
    TEST_ASSERT_EQUAL_INT(AUVID_SATURATED, solve(40, 0, 0, 0, 0, 12)); /* (0, 40) N */
    assert_wrench(40, 0, 0, 0, 0, 12 * (double)out.scale_priority);
    TEST_ASSERT_DOUBLE_WITHIN(tolerance(), 1.0, (double)out.scale_priority);
    TEST_ASSERT_EQUAL_INT(AUVID_SATURATED, solve(80, 0, 0, 0, 0, 30)); /* (0, 50) N */
    TEST_ASSERT_DOUBLE_WITHIN(tolerance(), 0.5, (double)out.scale_priority);
    assert_wrench(50, 0, 0, 0, 0, 15);
    TEST_ASSERT_EQUAL_INT(AUVID_SATURATED, solve(0, 0, 0, 0, 0, 3));
    assert_wrench(0, 0, 0, 0, 0, 0);
    TEST_ASSERT_EQUAL_INT(AUVID_SATURATED, solve(-10, 0, 0, 0, 0, 3));
    assert_wrench(0, 0, 0, 0, 0, 0);
}

/* A filter that decays leaves numbers of any size. */
static void test_what_is_only_rounding_does_not_block(void)
{
    twin_propellers();
    TEST_ASSERT_EQUAL_INT(AUVID_SATURATED, solve(1e-36, 0, 0, 0, 0, 3));
    assert_wrench(0, 0, 0, 0, 0, 0);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, solve(40, 0, 0, 0, 0, 1e-36));
    assert_wrench(40, 0, 0, 0, 0, 0);
}

static void test_what_is_within_the_check_is_never_scaled(void)
{
    const auvid_real_t peak[6] = {5, 0, 0, 0, 0, 4}, hold[6] = {40};
    twin_propellers();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_check(&a, peak, hold, NULL));
    for (int signs = 0; signs < 4; ++signs) {
        TEST_ASSERT_EQUAL_INT(
            AUVID_OK, solve((signs & 1) != 0 ? 45 : 35, 0, 0, 0, 0, (signs & 2) != 0 ? 4 : -4));
    }
}

static void test_without_priority_the_whole_wrench_is_scaled(void)
{
    cfg = auvid_allocation_girona500;
    cfg.priority = 0;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_init(&a, &cfg));
    TEST_ASSERT_EQUAL_INT(AUVID_SATURATED, solve(300, 0, 0, 0, 0, 80));
    double k = 153.8 / 250;
    assert_wrench(300 * k, 0, 0, 0, 0, 80 * k);
}

static void test_no_force_ever_exceeds_its_limit(void)
{
    uint32_t state = 1;
    for (int i = 0; i < 20000; ++i) {
        double w[6];
        for (int j = 0; j < 6; ++j) {
            state = state * 1664525u + 1013904223u;
            w[j] = ((double)(state >> 8) / 8388608.0 - 1.0) * (j < 3 ? 500 : 200);
        }
        TEST_ASSERT_TRUE(solve(w[0], w[1], w[2], 0, w[4], w[5]) >= AUVID_OK);
        for (int j = 0; j < 5; ++j) {
            TEST_ASSERT_TRUE(fabs((double)out.force_N[j]) <=
                             (double)auvid_allocation_girona500.thruster[j].max_N);
        }
        /* Yaw keeps its wrench, the rest its direction: T force = the scaled parts. */
        const double k = (double)out.scale;
        const double expected[6] = {k * w[0], k * w[1], k * w[2],
                                    0,        k * w[4], (double)out.scale_priority * w[5]};
        for (int j = 0; j < 6; ++j) {
            TEST_ASSERT_DOUBLE_WITHIN(20 * tolerance(), expected[j], (double)out.wrench[j]);
        }
    }
}

static void test_a_thruster_out_of_order_is_not_used(void)
{
    cfg = auvid_allocation_girona500;
    cfg.thruster[4].min_N = 0;
    cfg.thruster[4].max_N = 0;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_init(&a, &cfg));
    TEST_ASSERT_EQUAL_INT(0, a.actuated & AUVID_DOF_BIT(AUVID_SWAY));
    TEST_ASSERT_EQUAL_INT(AUVID_SATURATED, solve(60, 30, 0, 0, 0, 0));
    assert_wrench(60, 0, 0, 0, 0, 0);
}

static void test_init_takes_its_own_configuration(void)
{
    a.cfg.thruster[4].min_N = 0;
    a.cfg.thruster[4].max_N = 0;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_init(&a, &a.cfg));
    TEST_ASSERT_EQUAL_INT(0, a.actuated & AUVID_DOF_BIT(AUVID_SWAY));
    TEST_ASSERT_EQUAL_INT(AUVID_SATURATED, solve(60, 30, 0, 0, 0, 0));
    assert_wrench(60, 0, 0, 0, 0, 0);
}

static void test_a_command_beyond_the_largest_number_is_refused(void)
{
    auvid_real_t force[AUVID_MAX_THRUSTERS] = {1, 1, 1, 1, AUVID_C(1e30)};
    auvid_real_t command[AUVID_MAX_THRUSTERS] = {7};
    a.cfg.thruster[4].gain_forward = AUVID_C(1e-30) * AUVID_C(1e-8);
    a.cfg.thruster[4].law = AUVID_THRUST_LINEAR;
    auvid_status_t status = auvid_allocation_command(&a, force, command);
    bool fits = sizeof(auvid_real_t) == sizeof(double);
    TEST_ASSERT_EQUAL_INT(fits ? AUVID_OK : AUVID_ERR_NOT_FINITE, status);
    TEST_ASSERT_TRUE(fits || !(fabs((double)command[0] - 7.0) > 0.0));
}

/* In exact arithmetic the first thruster does not affect sway: its share is proportional to the sum
 * of products of the columns' X and Y, -0.5 * 0.6 + 0.3 * 1.0. It works in one direction only, so
 * a rounding error would block sway in one direction. */
static void test_a_thruster_at_its_limit_does_not_block_a_dof_it_does_not_affect(void)
{
    for (int k = 0; k < 50; ++k) {
        double scale = 1 + 0.037 * k;
        auvid_allocation_defaults(&cfg);
        add(scale, 0, 0, 0, 0, 0);
        add(-0.5 * scale, 0.6 * scale, 0, 0, 0, 0);
        add(0.3 * scale, 1.0 * scale, 0, 0, 0, 0);
        cfg.thruster[0].min_N = 0;
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_init(&a, &cfg));
        TEST_ASSERT_EQUAL_INT(AUVID_OK, solve(0, 3, 0, 0, 0, 0));
        assert_wrench(0, 3, 0, 0, 0, 0);
        TEST_ASSERT_EQUAL_INT(AUVID_OK, solve(0, -3, 0, 0, 0, 0));
        assert_wrench(0, -3, 0, 0, 0, 0);
    }
}

static void test_two_coupled_dofs_are_not_actuated(void)
{
    add(1, 0, 0, 0, 0, 0);
    add(0, 1, 0, 0.2, 0, 0); /* sways and rolls */
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_init(&a, &cfg));
    TEST_ASSERT_EQUAL_INT(AUVID_DOF_BIT(AUVID_SURGE), a.actuated);
    TEST_ASSERT_EQUAL_INT(2, a.rank);
}

static void test_a_mask_without_roll_lets_sway_be_used(void)
{
    add(1, 0, 0, 0, 0, 0);
    add(0, 1, 0, 0.2, 0, 0);
    cfg.dofs = AUVID_DOF_BIT(AUVID_SURGE) | AUVID_DOF_BIT(AUVID_SWAY);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_init(&a, &cfg));
    TEST_ASSERT_EQUAL_INT(cfg.dofs, a.actuated);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, solve(3, 5, 0, 0, 0, 0));
    assert_wrench(3, 5, 0, 1, 0, 0); /* the coupled roll is reported */
}

static void test_a_one_way_thruster_gives_nothing_the_other_way(void)
{
    add(1, 0, 0, 0, 0, 0);
    cfg.thruster[0].min_N = 0;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_init(&a, &cfg));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, solve(4, 0, 0, 0, 0, 0));
    assert_wrench(4, 0, 0, 0, 0, 0);
    TEST_ASSERT_EQUAL_INT(AUVID_SATURATED, solve(-4, 0, 0, 0, 0, 0));
    assert_wrench(0, 0, 0, 0, 0, 0);
}

static void test_capacity_is_the_largest_wrench_that_is_not_scaled(void)
{
    const double expected[6] = {307.6, 153.8, 307.6, 0, 107.66, 123.04};
    for (int i = 0; i < 6; ++i) {
        auvid_real_t negative, positive, w[6] = {0};
        TEST_ASSERT_EQUAL_INT(AUVID_OK,
                              auvid_allocation_capacity(&a, (auvid_dof_t)i, &negative, &positive));
        TEST_ASSERT_DOUBLE_WITHIN(10 * tolerance(), expected[i], (double)positive);
        TEST_ASSERT_DOUBLE_WITHIN(10 * tolerance(), -expected[i], (double)negative);
        if (expected[i] > 0) {
            w[i] = positive * AUVID_C(0.9999);
            TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_solve(&a, w, &out));
            w[i] = positive * AUVID_C(1.0001);
            TEST_ASSERT_EQUAL_INT(AUVID_SATURATED, auvid_allocation_solve(&a, w, &out));
        }
    }
}

static void test_capacity_differs_between_the_two_directions(void)
{
    auvid_real_t negative, positive;
    add(1, 0, 0, 0, 0, 0);
    add(-1, 0, 0, 0, 0, 0);
    cfg.thruster[0].min_N = -4;
    cfg.thruster[1].max_N = 3;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_init(&a, &cfg));
    auvid_allocation_capacity(&a, AUVID_SURGE, &negative, &positive);
    TEST_ASSERT_DOUBLE_WITHIN(tolerance(), -6.0, (double)negative); /* 3 of the second, twice */
    TEST_ASSERT_DOUBLE_WITHIN(tolerance(), 20.0, (double)positive);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE,
                          auvid_allocation_capacity(&a, AUVID_DOF_COUNT, &negative, &positive));
}

static void test_check_passes_the_usual_excitation_with_hover_thrust(void)
{
    const auvid_real_t peak[6] = {100, 100, 100, 0, 0, 40}, hold[6] = {0, 0, AUVID_C(37.3)};
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_check(&a, peak, hold, NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_check(&a, peak, NULL, NULL));
}

static void test_check_refuses_what_some_combination_of_signs_exceeds(void)
{
    /* 110 / 2 + 40 / 0.8 = 105; 200 / 2 + 50 / 0.8 = 162.5 > 153.8; yaw or surge without the other
     * pass. */
    const auvid_real_t fits[6] = {110, 0, 0, 0, 0, 40}, both[6] = {200, 0, 0, 0, 0, 50};
    const auvid_real_t roll[6] = {0, 0, 0, 1, 0, 0}, heave[6] = {0, 0, 300, 0, 0, 0};
    const auvid_real_t hold[6] = {0, 0, 30}, negative[6] = {-1}, nan[6] = {(auvid_real_t)NAN};
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_check(&a, fits, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_CAPACITY, auvid_allocation_check(&a, both, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_CAPACITY, auvid_allocation_check(&a, roll, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_check(&a, heave, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_CAPACITY, auvid_allocation_check(&a, heave, hold, NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_allocation_check(&a, negative, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE, auvid_allocation_check(&a, nan, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE, auvid_allocation_check(&a, fits, nan, NULL));
}

static auvid_allocation_fit_t fit_of(const auvid_real_t *peak, const auvid_real_t *hold)
{
    auvid_allocation_fit_t fit = {-1, 99};
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_CAPACITY, auvid_allocation_check(&a, peak, hold, &fit));
    return fit;
}

/* The peaks times the factor fit; a thousandth more does not. */
static void assert_largest_factor(const auvid_real_t *peak, const auvid_real_t *hold, double factor)
{
    for (int more = 0; more < 2; ++more) {
        auvid_real_t scaled[AUVID_DOF_COUNT];
        for (int i = 0; i < AUVID_DOF_COUNT; ++i) {
            scaled[i] = (auvid_real_t)(factor * (more ? 1.001 : 1.0)) * peak[i];
        }
        TEST_ASSERT_EQUAL_INT(more ? AUVID_ERR_CAPACITY : AUVID_OK,
                              auvid_allocation_check(&a, scaled, hold, NULL));
    }
}

static void test_check_answers_by_which_factor_and_in_which_dof(void)
{
    const auvid_real_t both[6] = {200, 0, 0, 0, 0, 50}, turning[6] = {100, 0, 0, 0, 0, 100};
    const auvid_real_t heave[6] = {0, 0, 300, 0, 0, 0}, hold[6] = {0, 0, 30}, none[6] = {0};
    const auvid_real_t heavy[6] = {0, 0, 400}, odd[6] = {37, 151, 290, 0, 21, 83};
    auvid_allocation_fit_t fit = fit_of(both, NULL); /* 153.8 / 162.5 */
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 153.8 / 162.5, (double)fit.factor);
    TEST_ASSERT_EQUAL_INT(AUVID_SURGE, fit.dof);
    assert_largest_factor(both, NULL, (double)fit.factor);
    fit = fit_of(turning, NULL); /* 100 / 2 + 100 / 0.8 = 175 */
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 153.8 / 175, (double)fit.factor);
    TEST_ASSERT_EQUAL_INT(AUVID_YAW, fit.dof);
    fit = fit_of(heave, hold); /* (153.8 - 15) / 150 */
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 138.8 / 150, (double)fit.factor);
    TEST_ASSERT_EQUAL_INT(AUVID_HEAVE, fit.dof);
    assert_largest_factor(heave, hold, (double)fit.factor);
    fit = fit_of(odd, hold);
    assert_largest_factor(odd, hold, (double)fit.factor);
    fit = fit_of(none, heavy);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)fit.factor);
    TEST_ASSERT_EQUAL_INT(-1, fit.dof);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_check(&a, none, NULL, &fit));
    TEST_ASSERT_EQUAL_DOUBLE(1.0, (double)fit.factor);
    TEST_ASSERT_EQUAL_INT(-1, fit.dof);
}

static void test_check_names_a_dof_without_thruster(void)
{
    const auvid_real_t roll[6] = {0, 0, 300, 1, 0, 0}; /* more heave than possible, too */
    auvid_allocation_fit_t fit = fit_of(roll, NULL);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)fit.factor);
    TEST_ASSERT_EQUAL_INT(AUVID_ROLL, fit.dof);
}

static void test_square_law_gives_half_the_command_for_a_quarter_of_the_force(void)
{
    auvid_real_t force[AUVID_MAX_THRUSTERS] = {AUVID_C(153.8) / 4, AUVID_C(-153.8) / 4, 0};
    auvid_real_t n[AUVID_MAX_THRUSTERS];
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_command(&a, force, n));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, (double)n[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -0.5, (double)n[1]);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)n[2]);
}

static void test_force_and_command_are_inverse_in_both_laws_and_directions(void)
{
    for (int i = 0; i < 4; ++i) {
        add(1, 0, 0, 0, 0, 0);
        cfg.thruster[i].law = i < 2 ? AUVID_THRUST_LINEAR : AUVID_THRUST_SQUARE;
        cfg.thruster[i].gain_forward = 3;
        cfg.thruster[i].gain_backward = i % 2 == 0 ? 2 : 0;
    }
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_init(&a, &cfg));
    for (int i = -20; i <= 20; ++i) {
        auvid_real_t n[4], both[4];
        for (int j = 0; j < 4; ++j) {
            n[j] = both[j] = (auvid_real_t)i * AUVID_C(0.5);
        }
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_force(&a, both, both));
        double size = fabs(0.5 * i), sign = i < 0 ? -1 : 1, back = i < 0 ? 2 : 3;
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, sign * back * size, (double)both[0]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, sign * 3 * size, (double)both[1]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, sign * back * size * size, (double)both[2]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, sign * 3 * size * size, (double)both[3]);
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_command(&a, both, both));
        for (int j = 0; j < 4; ++j) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, (double)n[j], (double)both[j]);
        }
    }
}

static void test_wrench_is_T_times_force_beyond_the_limits_too(void)
{
    const auvid_real_t force[AUVID_MAX_THRUSTERS] = {200, -200, 10, 20, -5};
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_wrench(&a, force, out.wrench));
    assert_wrench(0, -5, -30, 0, 3.5, -160);
}

static void test_solve_refuses_wrong_input_with_no_force(void)
{
    auvid_real_t w[6] = {100};
    const double bad[3] = {NAN, INFINITY, 2e9};
    const auvid_status_t status[3] = {AUVID_ERR_NOT_FINITE, AUVID_ERR_NOT_FINITE, AUVID_ERR_RANGE};
    for (int i = 0; i < 3; ++i) {
        memset(&out, 0x5a, sizeof out);
        w[5] = (auvid_real_t)bad[i];
        TEST_ASSERT_EQUAL_INT(status[i], auvid_allocation_solve(&a, w, &out));
        assert_wrench(0, 0, 0, 0, 0, 0);
        TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)out.force_N[0]);
    }
    memset(&out, 0x5a, sizeof out);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_allocation_solve(&a, NULL, &out));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)out.force_N[0]);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_allocation_solve(NULL, w, &out));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_allocation_solve(&a, w, NULL));
}

static void expect_init(auvid_status_t status)
{
    auvid_allocation_t before = a;
    TEST_ASSERT_EQUAL_INT(status, auvid_allocation_init(&a, &cfg));
    TEST_ASSERT_EQUAL_MEMORY(&before, &a, sizeof a);
    cfg = auvid_allocation_girona500;
}

static void test_init_refuses_a_bad_configuration_and_names_why(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_allocation_init(NULL, &cfg));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_allocation_init(&a, NULL));
    expect_init(AUVID_ERR_SIZE); /* the defaults hold no thruster */
    cfg.thrusters = AUVID_MAX_THRUSTERS + 1;
    expect_init(AUVID_ERR_SIZE);
    cfg.thruster[1].wrench[3] = (auvid_real_t)NAN;
    expect_init(AUVID_ERR_NOT_FINITE);
    cfg.thruster[1].max_N = (auvid_real_t)INFINITY;
    expect_init(AUVID_ERR_NOT_FINITE);
    cfg.thruster[1].max_N = -1;
    expect_init(AUVID_ERR_RANGE);
    cfg.thruster[1].min_N = 1;
    expect_init(AUVID_ERR_RANGE);
    cfg.thruster[1].gain_forward = 0;
    expect_init(AUVID_ERR_RANGE);
    cfg.thruster[1].gain_backward = -1;
    expect_init(AUVID_ERR_RANGE);
    cfg.thruster[1].law = (auvid_thrust_law_t)2;
    expect_init(AUVID_ERR_RANGE);
    cfg.thruster[1].wrench[0] = AUVID_C(2e6);
    expect_init(AUVID_ERR_RANGE);
    cfg.dofs = AUVID_DOF_BIT(AUVID_ROLL);
    expect_init(AUVID_ERR_SINGULAR);
}

static void test_vectors_that_are_not_finite_or_null_are_refused(void)
{
    auvid_real_t bad[AUVID_MAX_THRUSTERS] = {0, (auvid_real_t)NAN}, to[AUVID_MAX_THRUSTERS] = {7};
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE, auvid_allocation_wrench(&a, bad, out.wrench));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE, auvid_allocation_command(&a, bad, to));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE, auvid_allocation_force(&a, bad, to));
    TEST_ASSERT_EQUAL_DOUBLE(7.0, (double)to[0]);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_allocation_wrench(&a, NULL, out.wrench));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_allocation_command(&a, to, NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_allocation_force(NULL, to, to));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_allocation_check(&a, NULL, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_allocation_capacity(&a, AUVID_YAW, NULL, to));
    auvid_allocation_defaults(NULL);
}

static void test_thrusters_that_were_refused_give_no_zero_wrench(void)
{
    auvid_real_t v[AUVID_MAX_THRUSTERS] = {1}, to[AUVID_MAX_THRUSTERS] = {7};
    memset(&a, 0, sizeof a);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_allocation_solve(&a, v, &out));
    assert_wrench(0, 0, 0, 0, 0, 0);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_allocation_wrench(&a, v, to));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_allocation_command(&a, v, to));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_allocation_force(&a, v, to));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_allocation_check(&a, v, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_allocation_capacity(&a, AUVID_YAW, to, to));
    TEST_ASSERT_EQUAL_DOUBLE(7.0, (double)to[0]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_girona500_wrench_is_allocated_as_by_hand);
    RUN_TEST(test_girona500_is_actuated_in_all_but_roll);
    RUN_TEST(test_bluerov2_columns_are_forces_and_their_moments);
    RUN_TEST(test_bluerov2_is_actuated_in_all_with_the_thrust_of_t200s);
    RUN_TEST(test_a_wrench_in_a_dof_without_thruster_is_dropped_and_reported);
    RUN_TEST(test_saturation_keeps_the_direction);
    RUN_TEST(test_yaw_is_kept_and_surge_is_reduced);
    RUN_TEST(test_yaw_beyond_the_limit_is_scaled_and_takes_all);
    RUN_TEST(test_a_rounding_error_in_the_configuration_is_no_thruster);
    RUN_TEST(test_a_thruster_of_hardly_any_effect_is_none);
    RUN_TEST(test_what_all_thrusters_can_do_together_is_not_scaled);
    RUN_TEST(test_yaw_is_scaled_by_the_largest_factor_with_any_surge);
    RUN_TEST(test_what_is_only_rounding_does_not_block);
    RUN_TEST(test_what_is_within_the_check_is_never_scaled);
    RUN_TEST(test_without_priority_the_whole_wrench_is_scaled);
    RUN_TEST(test_no_force_ever_exceeds_its_limit);
    RUN_TEST(test_a_thruster_out_of_order_is_not_used);
    RUN_TEST(test_init_takes_its_own_configuration);
    RUN_TEST(test_a_command_beyond_the_largest_number_is_refused);
    RUN_TEST(test_a_thruster_at_its_limit_does_not_block_a_dof_it_does_not_affect);
    RUN_TEST(test_two_coupled_dofs_are_not_actuated);
    RUN_TEST(test_a_mask_without_roll_lets_sway_be_used);
    RUN_TEST(test_a_one_way_thruster_gives_nothing_the_other_way);
    RUN_TEST(test_capacity_is_the_largest_wrench_that_is_not_scaled);
    RUN_TEST(test_capacity_differs_between_the_two_directions);
    RUN_TEST(test_check_passes_the_usual_excitation_with_hover_thrust);
    RUN_TEST(test_check_refuses_what_some_combination_of_signs_exceeds);
    RUN_TEST(test_check_answers_by_which_factor_and_in_which_dof);
    RUN_TEST(test_check_names_a_dof_without_thruster);
    RUN_TEST(test_square_law_gives_half_the_command_for_a_quarter_of_the_force);
    RUN_TEST(test_force_and_command_are_inverse_in_both_laws_and_directions);
    RUN_TEST(test_wrench_is_T_times_force_beyond_the_limits_too);
    RUN_TEST(test_solve_refuses_wrong_input_with_no_force);
    RUN_TEST(test_init_refuses_a_bad_configuration_and_names_why);
    RUN_TEST(test_vectors_that_are_not_finite_or_null_are_refused);
    RUN_TEST(test_thrusters_that_were_refused_give_no_zero_wrench);
    return UNITY_END();
}
