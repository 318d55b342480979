/* Each mismatch of the field simulator has the effect in the table, in its size. */
#include "field.h"

#include <math.h>
#include <string.h>

#include "field_hull.h"
#include "unity.h"

enum { X, Y, Z, K, M, N };

/* The sway thruster of the Girona500 produces the reported Y, and little else. */
#define SIDE 4
#define F_MAX 153.8

static field_config_t cfg;
static field_t field;
static field_output_t out;
static double force[SIM_THRUSTERS];

void setUp(void)
{
    memset(force, 0, sizeof force);
    field_defaults(&cfg, FIELD_GIRONA500, FIELD_EXCITED, 1);
}

void tearDown(void)
{
}

static void set(const char *name, double size)
{
    TEST_ASSERT_TRUE_MESSAGE(field_set(&cfg, name, size), name);
}

static void begin(void)
{
    TEST_ASSERT_TRUE(field_init(&field, &cfg));
}

static void begin_with(const char *name, double size)
{
    field_defaults(&cfg, cfg.vehicle, cfg.driver, cfg.seed);
    set(name, size);
    begin();
}

static void run(double seconds)
{
    for (long tick = lround(seconds * 50); tick > 0; --tick) {
        field_step(&field, force, &out);
    }
}

/* True side thrust after `command` has been given for `seconds`. */
static double side(double command, double seconds)
{
    force[SIDE] = command;
    run(seconds);
    return field.truth.delivered[Y];
}

/* ---- thrust ---- */

static void test_common_increases_the_thrust_of_all_thrusters(void)
{
    begin_with("thrust_common", 0.1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 55, side(50, 1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 37.3058 * 1.1, field.truth.delivered[Z]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 50, field.truth.reported[Y]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 50, out.wrench[Y]);
}

static void test_each_gives_every_thruster_a_different_gain(void)
{
    double sum = 0, square = 0;
    for (cfg.seed = 1; cfg.seed <= 400; ++cfg.seed) {
        begin_with("thrust_each", 0.05);
        double off = side(50, 0.02) / 50 - 1;
        sum += off;
        square += off * off;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0, sum / 400);
    TEST_ASSERT_DOUBLE_WITHIN(0.005, 0.05, sqrt(square / 400));
}

static void test_backward_reduces_only_negative_force(void)
{
    begin_with("thrust_backward", 0.2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -40, side(-50, 0.1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 50, side(50, 0.1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -37.3058 * 0.8, -field.truth.delivered[Z]);
}

static void test_sag_grows_from_zero_to_its_size_at_the_end_of_the_run(void)
{
    begin_with("thrust_sag", 0.1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-2, 20, side(20, 1));
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, 19, side(20, 119));
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, 18, side(20, 120));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 18, side(20, 10));
}

static void test_exponent_changes_thrust_between_zero_and_the_limit(void)
{
    begin_with("thrust_exponent", 0.1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, F_MAX, side(F_MAX, 0.1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, F_MAX * pow(0.25, 1.1), side(F_MAX / 4, 0.1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -F_MAX * pow(0.25, 1.1), side(-F_MAX / 4, 0.1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, side(0, 0.1));
}

static void test_dead_band_reduces_thrust_by_its_size(void)
{
    begin_with("thrust_dead_band", 3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 7, side(10, 0.1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -7, side(-10, 0.1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, side(2.9, 0.1));
}

static void test_lag_acts_on_the_speed_of_the_propeller(void)
{
    begin_with("thrust_lag", 0.2);
    double gone = 1 - exp(-1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 100 * gone * gone, side(100, 0.2));
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 100, side(100, 2));
    TEST_ASSERT_DOUBLE_WITHIN(1e-2, 100 * exp(-2), side(0, 0.2)); /* (e^-1)^2 */
}

static void test_force_lag_acts_on_the_force(void)
{
    begin_with("thrust_force_lag", 0.2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 100 * (1 - exp(-1)), side(100, 0.2));
}

static void test_slew_limits_the_rate_of_the_speed(void)
{
    begin_with("slew", 1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, F_MAX * 0.25, side(F_MAX, 0.5));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, F_MAX, side(F_MAX, 0.5));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -F_MAX * 0.04, side(-F_MAX, 1.2));
}

static void test_advance_reduces_thrust_in_the_direction_of_motion(void)
{
    begin_with("thrust_advance", 0.3);
    double with = side(100, 10), v = field.truth.nu[Y] + 0.05 * field.truth.nu[K];
    TEST_ASSERT_TRUE(v > 0.3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 100 * (1 - 0.3 * v), with);
    v = (side(-100, 0.02), field.truth.nu[Y] + 0.05 * field.truth.nu[K]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -100 * (1 + 0.3 * v), field.truth.delivered[Y]);
}

static void begin_with_other_shapes(const char *name, double size)
{
    begin_with(name, size);
    set("thrust_shapes", 1);
    begin();
}

static void test_thrust_has_other_shapes_of_the_same_sizes(void)
{
    begin_with_other_shapes("thrust_exponent", 0.1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, F_MAX, side(F_MAX, 0.1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -F_MAX / 4 * (1 - 0.149 * 0.75), side(-F_MAX / 4, 0.1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, side(0, 0.1));
    begin_with_other_shapes("thrust_dead_band", 3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 100.0 / 13, side(10, 0.1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -4.0 / 5, side(-2, 0.1));
    begin_with_other_shapes("thrust_sag", 0.1);
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, 19, side(20, 60));
    begin_with_other_shapes("thrust_backward", 0.2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -40, side(-50, 0.1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 50, side(50, 0.1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 37.3058 * 0.9, field.truth.delivered[Z]); /* one of two */
    begin_with_other_shapes("thrust_advance", 0.3);
    double with = side(100, 10), v = field.truth.nu[Y] + 0.05 * field.truth.nu[K];
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 100 * (1 - 0.3 * v), with);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -100, side(-100, 0.02));
}

/* The timestamp of a wrench that is commanded at 1 s, and the time at which it acts. */
static void when(double *stamp_s, double *acts_s)
{
    *stamp_s = *acts_s = -1;
    run(1);
    force[SIDE] = 50;
    for (int tick = 0; tick < 30; ++tick) {
        field_step(&field, force, &out);
        if (*acts_s < 0 && field.truth.delivered[Y] > 1) {
            *acts_s = field.truth.t_s - 0.02;
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, 50, field.truth.reported[Y]);
        }
        if (*stamp_s < 0 && out.reported && out.wrench[Y] > 1) {
            *stamp_s = 1e-6 * (double)out.reported_us;
            TEST_ASSERT_TRUE(out.reported_us < out.t_us &&
                             out.reported_us + SIM_TICK_US >= out.t_us);
        }
    }
}

static void test_late_timestamps_are_after_thrust_acts_and_early_ones_before(void)
{
    static const double late[] = {0, 0.035, 0.1, 0.2, -0.1, -0.04, -0.2};
    for (size_t i = 0; i < sizeof late / sizeof late[0]; ++i) {
        double stamp, acts;
        setUp();
        begin_with("thrust_late", late[i]);
        when(&stamp, &acts);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, late[i], stamp - acts);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1, late[i] < 0 ? stamp : acts);
    }
}

static void test_pwm_is_reported_in_whole_microseconds_without_the_dead_zone(void)
{
    begin_with("command_pwm", 25);
    (void)side(F_MAX / 4, 0.1); /* 200 us */
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, F_MAX / 4, out.thruster_N[SIDE]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, F_MAX * pow(175 / 375.0, 2), field.truth.delivered[Y]);
    (void)side(-F_MAX / 4 * 1.004, 0.1); /* 200.4 us */
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -F_MAX / 4, out.thruster_N[SIDE]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, side(F_MAX * pow(25 / 400.0, 2), 0.1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, F_MAX, side(F_MAX, 0.1));
}

static void test_commands_at_10_hz_are_reported_in_one_tick_of_five(void)
{
    int reported = 0;
    begin_with("command_10hz", 1);
    for (int tick = 0; tick < 100; ++tick) {
        force[SIDE] = tick;
        field_step(&field, force, &out);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, tick, field.truth.delivered[Y]);
        TEST_ASSERT_EQUAL_DOUBLE(out.reported ? tick : 0, out.wrench[Y]);
        reported += out.reported;
    }
    TEST_ASSERT_EQUAL(20, reported);
}

static void test_battery_reduces_thrust_without_a_report(void)
{
    double load = (50 + 37.3058) / 5 / F_MAX;
    set("battery", 0.2);
    cfg.length_s = 2;
    begin();
    (void)side(50, 4);
    double volts = 1 - 0.2 * (1 + 0.5 * load);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 50 * pow(volts, 1.2), field.truth.delivered[Y]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 50, out.wrench[Y]);
}

static void test_a_corrected_battery_is_overcorrected(void)
{
    double load = (50 + 37.3058) / 5 / F_MAX, volts = 1 - 0.2 * (1 + 0.5 * load);
    set("battery_corrected", 0.2);
    cfg.length_s = 2;
    begin();
    (void)side(50, 4);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 50 * pow(volts, 1.2), field.truth.delivered[Y]);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 50 * volts * volts, out.wrench[Y]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, out.wrench[Y], field.truth.reported[Y]);
}

/* ---- hull ---- */

/* Hull force minus Eq. 12-15, at a velocity. */
static void residual_at(const double nu[6], double left[6])
{
    memcpy(field.truth.nu, nu, sizeof field.truth.nu);
    run(0.02);
    field_hull_residual(&field, left);
}

static void test_asymmetry_increases_drag_one_way_and_reduces_it_the_other(void)
{
    double left[6], nu[6] = {0.5};
    begin_with("drag_asymmetry", 0.1);
    residual_at(nu, left);
    double u = field.truth.nu[X], share = left[X] / (42.4181 * u + 125.3578 * u * u);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.1, fabs(share));
    nu[X] = -0.5;
    begin();
    residual_at(nu, left);
    u = field.truth.nu[X];
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, share, left[X] / (-42.4181 * u + 125.3578 * u * u));
}

static void test_drag_exponent_changes_quadratic_drag(void)
{
    double left[6], nu[6] = {0.5, 0, 0, 0, 0, 0};
    begin_with("drag_exponent", 0.15);
    residual_at(nu, left);
    double u = field.truth.nu[X];
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 125.3578 * (pow(u, 1.85) - u * u), left[X]);
}

static void test_cross_terms_couple_sway_and_yaw_symmetrically(void)
{
    double turning[6], sliding[6], both[6], r[6] = {[N] = 0.5}, v[6] = {[Y] = 0.3};
    double uv[6] = {0.4, 0.3};
    begin_with("cross", 0.15);
    residual_at(r, turning);
    begin();
    residual_at(v, sliding);
    double y_r = 75.7673 * field.hull.side_centre_m;
    TEST_ASSERT_TRUE(fabs(y_r) > 0.5);
    TEST_ASSERT_DOUBLE_WITHIN(0.03 * fabs(y_r), y_r, turning[Y] / 0.5);
    TEST_ASSERT_DOUBLE_WITHIN(0.03 * fabs(y_r), y_r, sliding[N] / 0.3);
    begin();
    residual_at(uv, both);
    TEST_ASSERT_TRUE(both[Y] > 0.5); /* lift with the sign of the side drag, and heave by speed */
    TEST_ASSERT_TRUE(fabs(both[Z]) > 0.05);
    TEST_ASSERT_TRUE(fabs(both[N] - sliding[N]) > 0.05);
}

static void test_the_seed_selects_the_centre_of_side_drag(void)
{
    double square = 0;
    for (cfg.seed = 1; cfg.seed <= 400; ++cfg.seed) {
        begin_with("cross", 0.15);
        square += field.hull.side_centre_m * field.hull.side_centre_m / 400;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.1 * 0.15 * 0.75, 0.15 * 0.75, sqrt(square));
}

static void test_centre_of_gravity_trims_the_vehicle(void)
{
    begin();
    double trim = atan(0.03 * field.hull.weight_N / (0.3 * field.hull.buoyancy_N));
    begin_with("cg_x", 0.03);
    run(60);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, -trim, field.truth.euler[1]);
    begin_with("cg_y", 0.03);
    run(60);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, trim, field.truth.euler[0]);
}

static void test_a_cable_pulls_at_the_stern(void)
{
    double left[6], still[6] = {0};
    int points = 0;
    for (cfg.seed = 1; cfg.seed <= 40; ++cfg.seed) {
        begin_with("cable", 10);
        residual_at(still, left);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 10,
                                  sqrt(left[X] * left[X] + left[Y] * left[Y] + left[Z] * left[Z]));
        TEST_ASSERT_TRUE(hypot(left[X], left[Y]) > 9);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, -0.75 * left[Y], left[N]);
        points += field.hull.cable_point;
    }
    TEST_ASSERT_INT_WITHIN(10, 20, points);
}

static void test_ballast_is_added_halfway(void)
{
    field_built_t before, after;
    begin_with("ballast", 5);
    run(119.9);
    field_built(&field, &before);
    run(0.2);
    field_built(&field, &after);
    TEST_ASSERT_EQUAL_DOUBLE(160, before.dry_kg);
    TEST_ASSERT_EQUAL_DOUBLE(165, after.dry_kg);
    for (int i = SIM_M_U; i <= SIM_M_W; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 5, after.parameter[i] - before.parameter[i]);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 5 * 9.81 * (1 - 1 / 11.34),
                              after.parameter[SIM_WB] - before.parameter[SIM_WB]);
}

static void test_ballast_at_the_origin_does_not_right_the_vehicle(void)
{
    set("cg_x", 0.01);
    set("ballast", 20);
    begin();
    double gravity = field.hull.weight_N * field.hull.r_g[0];
    double buoyancy = field.hull.buoyancy_N * field.hull.r_b[2];
    run(121);
    TEST_ASSERT_EQUAL_DOUBLE(180, field.hull.dry_kg);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, gravity, field.hull.weight_N * field.hull.r_g[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, buoyancy, field.hull.buoyancy_N * field.hull.r_b[2]);
}

static void test_fouling_increases_both_drags_up_to_its_size_at_the_end_of_the_run(void)
{
    double left[6], nu[6] = {0.5}, speed;
    for (int part = 0; part <= 2; ++part) {
        begin_with("fouling", 0.4);
        field.t_us = (uint64_t)(part * cfg.length_s / 2 * 1e6);
        residual_at(nu, left);
        speed = field.truth.nu[X];
        TEST_ASSERT_DOUBLE_WITHIN(1e-2, 0.2 * part * (42.4181 * speed + 125.3578 * speed * speed),
                                  left[X]);
    }
}

static void test_near_a_wall_added_mass_and_drag_are_larger(void)
{
    double left[6], nu[6] = {0.5}, added = 249.5384 - 160;
    begin_with("wall", 0.5);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 21, field.hull.seabed_m);
    field.truth.position[2] = 20.3;
    residual_at(nu, left);
    double u = field.truth.nu[X], k = 0.5 * pow(0.5 / (21 - field.truth.position[2]), 3);
    TEST_ASSERT_DOUBLE_WITHIN(
        0.3, k * (added * field.truth.nu_dot[X] + 42.4181 * u + 125.3578 * u * u), left[X]);
}

/* ---- water ---- */

static void test_a_current_carries_the_vehicle_and_the_dvl_measures_it(void)
{
    begin_with("current", 0.1);
    run(60);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0, hypot(field.truth.nu[X], field.truth.nu[Y]));
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 6, hypot(field.truth.position[0], field.truth.position[1]));
    const double *seen = out.sensor[SIM_DVL].value;
    TEST_ASSERT_TRUE(out.sensor[SIM_DVL].has && out.sensor[SIM_DVL].bottom);
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 0.1, hypot(seen[0], seen[1]));
}

static void test_disturbance_has_its_rms_and_correlation_time(void)
{
    double square[6] = {0}, product = 0, before = 0;
    cfg.length_s = 2000;
    set("disturbance", 2);
    begin();
    for (int i = 0; i < 1000; ++i) {
        run(2);
        for (int k = 0; k < 6; ++k) {
            square[k] += field.truth.disturbance[k] * field.truth.disturbance[k] / 1000;
        }
        product += before * field.truth.disturbance[X] / 1000;
        before = field.truth.disturbance[X];
    }
    for (int k = 0; k < 6; ++k) {
        TEST_ASSERT_DOUBLE_WITHIN(0.15 * (k < 3 ? 2 : 0.8), k < 3 ? 2 : 0.8, sqrt(square[k]));
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.15, exp(-1), product / square[X]);
}

static void test_waves_oscillate_horizontally_and_vertically_with_their_amplitude(void)
{
    for (cfg.seed = 1; cfg.seed <= 20; ++cfg.seed) {
        double max = 0, down = 0, before = 0;
        int turns = 0;
        begin_with("waves", 4);
        for (int tick = 0; tick < 60 * 50; ++tick) {
            double r[3][3], *d = field.truth.disturbance, world[3];
            run(0.02);
            sim_rotation(field.truth.euler, r);
            for (int i = 0; i < 3; ++i) {
                world[i] = r[i][0] * d[0] + r[i][1] * d[1] + r[i][2] * d[2];
            }
            double along = (field.wave[0] * world[0] + field.wave[1] * world[1]) / 4;
            max = fmax(max, fabs(along));
            down = fmax(down, fabs(world[2]));
            turns += along * before < 0;
            before = along;
        }
        TEST_ASSERT_DOUBLE_WITHIN(0.01, 4, max);
        TEST_ASSERT_DOUBLE_WITHIN(0.01, 2.8, down);
        TEST_ASSERT_TRUE(turns >= 14 &&
                         turns <= 31); /* 60 s with periods of 4..8 s, two per period */
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_common_increases_the_thrust_of_all_thrusters);
    RUN_TEST(test_each_gives_every_thruster_a_different_gain);
    RUN_TEST(test_backward_reduces_only_negative_force);
    RUN_TEST(test_sag_grows_from_zero_to_its_size_at_the_end_of_the_run);
    RUN_TEST(test_exponent_changes_thrust_between_zero_and_the_limit);
    RUN_TEST(test_dead_band_reduces_thrust_by_its_size);
    RUN_TEST(test_lag_acts_on_the_speed_of_the_propeller);
    RUN_TEST(test_force_lag_acts_on_the_force);
    RUN_TEST(test_slew_limits_the_rate_of_the_speed);
    RUN_TEST(test_advance_reduces_thrust_in_the_direction_of_motion);
    RUN_TEST(test_thrust_has_other_shapes_of_the_same_sizes);
    RUN_TEST(test_late_timestamps_are_after_thrust_acts_and_early_ones_before);
    RUN_TEST(test_pwm_is_reported_in_whole_microseconds_without_the_dead_zone);
    RUN_TEST(test_commands_at_10_hz_are_reported_in_one_tick_of_five);
    RUN_TEST(test_battery_reduces_thrust_without_a_report);
    RUN_TEST(test_a_corrected_battery_is_overcorrected);
    RUN_TEST(test_asymmetry_increases_drag_one_way_and_reduces_it_the_other);
    RUN_TEST(test_drag_exponent_changes_quadratic_drag);
    RUN_TEST(test_cross_terms_couple_sway_and_yaw_symmetrically);
    RUN_TEST(test_the_seed_selects_the_centre_of_side_drag);
    RUN_TEST(test_centre_of_gravity_trims_the_vehicle);
    RUN_TEST(test_a_cable_pulls_at_the_stern);
    RUN_TEST(test_ballast_is_added_halfway);
    RUN_TEST(test_ballast_at_the_origin_does_not_right_the_vehicle);
    RUN_TEST(test_fouling_increases_both_drags_up_to_its_size_at_the_end_of_the_run);
    RUN_TEST(test_near_a_wall_added_mass_and_drag_are_larger);
    RUN_TEST(test_a_current_carries_the_vehicle_and_the_dvl_measures_it);
    RUN_TEST(test_disturbance_has_its_rms_and_correlation_time);
    RUN_TEST(test_waves_oscillate_horizontally_and_vertically_with_their_amplitude);
    return UNITY_END();
}
