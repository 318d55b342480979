/* The log doctor on a simulated vehicle without noise: signs, units, axes and delays, and what must
 * not matter. What it says of rows and samples is in test_doctor_samples.c; the statistics of noisy
 * vehicles are in test_doctor_campaign.c; accelerometers and thrusters in test_doctor_sensors.c. */
#include "doctor_log.h"

void setUp(void)
{
    make_log();
}

void tearDown(void)
{
}

static void test_a_log_without_slip_is_usable(void)
{
    assert_clean();
    TEST_ASSERT_NOT_NULL(strstr(doctor.verdict, "surge, sway, heave, roll, pitch, yaw"));
    for (int j = 0; j < 6; ++j) {
        TEST_ASSERT_DOUBLE_WITHIN(15.0, 110.0, doctor.usable_s[j]);
    }
    /* about mass / (linear drag + 2 quadratic drag speed) */
    TEST_ASSERT_DOUBLE_WITHIN(1.5, 3.0, doctor.time_constant_s[0]);
}

static void test_one_angle_in_degrees_is_named(void)
{
    scale(CSV_ATTITUDE + 2, 180.0 / PI);
    assert_only(DOCTOR_ANGLE_DEGREES, CSV_ATTITUDE + 2,
                "psi_rad looks like degrees (its rate is 57 times r_radps): convert it to radians");
}

static void test_rates_in_degrees_are_named(void)
{
    for (int j = 3; j < 6; ++j) {
        scale(CSV_NU + j, 180.0 / PI);
    }
    examine();
    TEST_ASSERT_TRUE(doctor_has_finding(&doctor, DOCTOR_RATE_DEGREES, CSV_NU + 3));
    TEST_ASSERT_TRUE(doctor_has_finding(&doctor, DOCTOR_RATE_DEGREES, CSV_NU + 4));
    TEST_ASSERT_TRUE(doctor_has_finding(&doctor, DOCTOR_RATE_DEGREES, CSV_NU + 5));
}

static void test_a_reversed_heading_is_told_from_a_reversed_rate(void)
{
    scale(CSV_ATTITUDE + 2, -1.0);
    examine();
    assert_error(DOCTOR_ANGLE_SIGN, CSV_ATTITUDE + 2, "psi_rad has the wrong sign");
    TEST_ASSERT_NULL(finding(DOCTOR_RATE_SIGN));
}

static void test_a_reversed_rate_is_told_from_a_reversed_input(void)
{
    scale(CSV_NU + 5, -1.0);
    examine();
    assert_error(DOCTOR_RATE_SIGN, CSV_NU + 5, "r_radps has the wrong sign");
    TEST_ASSERT_NULL(finding(DOCTOR_INPUT_SIGN));
}

static void test_a_reversed_moment_is_named(void)
{
    scale(CSV_WRENCH + 5, -1.0);
    assert_only(DOCTOR_INPUT_SIGN, CSV_WRENCH + 5, "N_Nm has the wrong sign");
}

/* Its output opposes the motion before it. That is no sign of the input. */
static void test_a_controller_that_holds_an_axis_is_not_accused(void)
{
    make_log_of(true);
    assert_clean();
    TEST_ASSERT_EQUAL_STRING("usable for identification: surge, sway, heave, yaw", doctor.verdict);
    scale(CSV_WRENCH + 5, -1.0);
    assert_only(DOCTOR_INPUT_SIGN, CSV_WRENCH + 5, "N_Nm has the wrong sign");
}

/* Beside the steps of the rest of the log, what a column has between them is rounding. */
static void test_an_input_that_rests_for_most_of_the_log_is_not_accused_there(void)
{
    for (int k = 0; k < 2 * ROWS / 3; ++k) {
        rows[k].value[CSV_WRENCH + 5] *= -1e-6;
    }
    assert_clean();
    scale(CSV_WRENCH + 5, -1.0);
    assert_only(DOCTOR_INPUT_SIGN, CSV_WRENCH + 5, "N_Nm has the wrong sign");
}

/* Its righting moment turns the hull; the input hardly acts, and errors of that moment look alike.
 */
static void test_a_hull_that_swings_does_not_accuse_a_small_moment(void)
{
    double q = 0.0, theta = 0.3;
    static const int absent[4] = {CSV_ATTITUDE, CSV_NU + 3, CSV_WRENCH + 3, CSV_POSITION + 2};
    for (int i = 0; i < 4; ++i) {
        has[absent[i]] = false;
    }
    for (int k = 0; k < ROWS; ++k) {
        double moment = rows[k].value[CSV_WRENCH + 4];
        q += STEP_S * (-4.0 * sin(theta) - 0.05 * q - 0.002 * moment);
        theta += STEP_S * q;
        rows[k].value[CSV_ATTITUDE] = rows[k].value[CSV_NU + 3] = 0.0;
        rows[k].value[CSV_ATTITUDE + 1] = theta;
        rows[k].value[CSV_NU + 4] = q;
    }
    examine();
    TEST_ASSERT_EQUAL_MESSAGE(0, count(DOCTOR_ERROR), doctor.finding[0].text);
    TEST_ASSERT_FALSE(doctor.answers[4]);
}

static void test_the_coupling_tells_a_reversed_force_from_a_reversed_velocity(void)
{
    has[CSV_POSITION] = has[CSV_POSITION + 1] = false;
    scale(CSV_WRENCH + 1, -1.0);
    assert_only(DOCTOR_INPUT_SIGN, CSV_WRENCH + 1, "Y_N has the wrong sign");
    scale(CSV_WRENCH + 1, -1.0);
    scale(CSV_NU + 1, -1.0);
    assert_only(DOCTOR_VELOCITY_SIGN, CSV_NU + 1, "v_mps has the wrong sign");
}

static void test_depth_tells_a_reversed_heave_velocity(void)
{
    scale(CSV_NU + 2, -1.0);
    assert_only(DOCTOR_VELOCITY_SIGN, CSV_NU + 2, "w_mps has the wrong sign");
}

static void test_depth_tells_a_reversed_surge_velocity_from_a_reversed_pitch(void)
{
    has[CSV_POSITION] = has[CSV_POSITION + 1] = false;
    scale(CSV_NU, -1.0);
    assert_only(DOCTOR_VELOCITY_SIGN, CSV_NU, "runs against the depth in a dive: change its sign");
    scale(CSV_NU, -1.0);
    exchange(CSV_NU, CSV_NU + 1);
    assert_only(DOCTOR_VELOCITY_EXCHANGED, CSV_NU, "the two velocities are exchanged");
}

/* Two columns in axes that are turned to starboard. */
static void turn(int column, double degrees)
{
    double c = cos(degrees * PI / 180.0), s = sin(degrees * PI / 180.0);
    for (int k = 0; k < ROWS; ++k) {
        double *v = &rows[k].value[column], ahead = v[0];
        v[0] = c * ahead + s * v[1];
        v[1] = c * v[1] - s * ahead;
    }
}

static void test_a_velocity_sensor_that_is_mounted_backwards_is_named(void)
{
    static const char *const cure =
        "the DVL is mounted backwards: change the signs of u_mps and v_mps";
    turn(CSV_NU, 180.0);
    assert_only(DOCTOR_MOUNTING, CSV_NU, "u_mps runs against the position");
    TEST_ASSERT_NOT_NULL(strstr(doctor.finding[0].text, cure));
    has[CSV_POSITION] = has[CSV_POSITION + 1] = false;
    assert_only(DOCTOR_MOUNTING, CSV_NU, "u_mps runs against depth_m");
    TEST_ASSERT_NOT_NULL(strstr(doctor.finding[0].text, cure));
    has[CSV_POSITION + 2] = false;
    assert_only(DOCTOR_MOUNTING, CSV_NU, "or both forces have the wrong sign");
}

static void test_a_velocity_sensor_that_is_mounted_at_an_angle_is_named(void)
{
    static const double angle[5] = {-90, -45, 20, 45, 90};
    for (int position = 1; position >= 0; --position) {
        has[CSV_POSITION] = has[CSV_POSITION + 1] = position > 0;
        for (int i = 0; i < 5; ++i) {
            turn(CSV_NU, angle[i]);
            assert_only(DOCTOR_MOUNTING, CSV_NU, "mounted at an angle: rotate the two columns");
            TEST_ASSERT_DOUBLE_WITHIN(3.0 * PI / 180.0, angle[i] * PI / 180.0, doctor.mounted);
            turn(CSV_NU, -angle[i]);
        }
    }
    turn(CSV_NU, 10.0); /* may be an error of the forces */
    examine();
    TEST_ASSERT_NULL(finding(DOCTOR_MOUNTING));
}

/* The position tells that the velocities are right; a moment that is reversed, too, that all inputs
 * are. */
static void test_forces_that_are_turned_do_not_accuse_the_velocity_sensor(void)
{
    turn(CSV_WRENCH, 45.0);
    examine();
    TEST_ASSERT_NULL(finding(DOCTOR_MOUNTING));
    turn(CSV_WRENCH, 135.0);
    examine();
    assert_error(DOCTOR_INPUT_SIGN, CSV_WRENCH, "X_N has the wrong sign");
    TEST_ASSERT_NULL(finding(DOCTOR_MOUNTING));
    has[CSV_POSITION] = has[CSV_POSITION + 1] = has[CSV_POSITION + 2] = false;
    scale(CSV_WRENCH + 5, -1.0);
    examine();
    TEST_ASSERT_NULL(finding(DOCTOR_MOUNTING));
    TEST_ASSERT_EQUAL(3, count(DOCTOR_ERROR));
}

static void test_without_depth_the_sentence_names_both(void)
{
    has[CSV_POSITION + 2] = false;
    scale(CSV_NU + 2, -1.0);
    assert_only(DOCTOR_EITHER_SIGN, CSV_WRENCH + 2, "w_mps accelerates against Z_N");
}

static void test_exchanged_rates_are_named(void)
{
    exchange(CSV_NU + 3, CSV_NU + 4);
    examine();
    assert_error(DOCTOR_RATE_EXCHANGED, CSV_NU + 3, "exchange");
    TEST_ASSERT_EQUAL(CSV_NU + 4, finding(DOCTOR_RATE_EXCHANGED)->other);
}

static void test_the_coupling_tells_exchanged_forces_from_exchanged_velocities(void)
{
    exchange(CSV_WRENCH, CSV_WRENCH + 1);
    assert_only(DOCTOR_INPUT_EXCHANGED, CSV_WRENCH, "the two inputs are exchanged");
    exchange(CSV_WRENCH, CSV_WRENCH + 1);
    exchange(CSV_NU, CSV_NU + 1);
    examine();
    assert_error(DOCTOR_VELOCITY_EXCHANGED, CSV_NU, "the two velocities are exchanged");
}

static void test_an_attitude_in_other_axes_is_named(void)
{
    scale(CSV_ATTITUDE + 1, -1.0);
    scale(CSV_ATTITUDE + 2, -1.0);
    examine();
    assert_error(DOCTOR_FRAME, CSV_ATTITUDE + 2, "change the signs of theta_rad and psi_rad");
}

static void test_velocities_in_other_axes_are_named(void)
{
    static const int reversed[4] = {1, 2, 4, 5};
    for (int i = 0; i < 4; ++i) {
        scale(CSV_NU + reversed[i], -1.0);
    }
    examine();
    TEST_ASSERT_TRUE(doctor_has_finding(&doctor, DOCTOR_FRAME, CSV_NU + 1));
}

static void test_a_late_attitude_is_named_with_its_delay(void)
{
    delay(CSV_ATTITUDE, CSV_ATTITUDE + 2, 12);
    examine();
    TEST_ASSERT_NOT_NULL(finding(DOCTOR_ATTITUDE_SHIFT));
    TEST_ASSERT_EQUAL(DOCTOR_WARNING, finding(DOCTOR_ATTITUDE_SHIFT)->severity);
    TEST_ASSERT_NOT_NULL(strstr(doctor.finding[0].text, "trails p, q, r by 0.2"));
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.24, finding(DOCTOR_ATTITUDE_SHIFT)->value);
}

/* One shift of the whole log, which fit takes into account. */
static void assert_shift(doctor_severity_t severity, double lag_s)
{
    const doctor_finding_t *f = finding(DOCTOR_INPUT_SHIFT);
    TEST_ASSERT_NOT_NULL(f);
    TEST_ASSERT_EQUAL(severity, f->severity);
    TEST_ASSERT_DOUBLE_WITHIN(0.2, lag_s, f->value);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, f->value - 0.1, doctor.shift_s);
    TEST_ASSERT_EQUAL_STRING("usable for identification: surge, sway, heave, roll, pitch, yaw",
                             doctor.verdict);
}

static void test_late_motion_is_named_with_its_delay(void)
{
    delay(CSV_ATTITUDE, CSV_NU + 5, 60);
    examine();
    assert_shift(DOCTOR_WARNING, 1.2);
    TEST_ASSERT_NOT_NULL(strstr(doctor.finding[0].text, "fit shifts the inputs by that"));
}

static void test_early_motion_is_named(void)
{
    delay(CSV_WRENCH, CSV_WRENCH + 5, 30);
    examine();
    assert_shift(DOCTOR_WARNING, -0.6);
    TEST_ASSERT_NOT_NULL(strstr(doctor.finding[0].text, "which no vehicle does"));
}

static void test_motion_that_is_early_by_nearly_two_seconds_is_named(void)
{
    delay(CSV_WRENCH, CSV_WRENCH + 5, 90);
    examine();
    assert_shift(DOCTOR_WARNING, -1.8);
}

/* Longer than thrusters and instruments usually need, but possible: no accusation. */
static void test_a_long_lag_is_a_note(void)
{
    delay(CSV_ATTITUDE, CSV_NU + 5, 25);
    examine();
    assert_shift(DOCTOR_NOTE, 0.5);
}

/* No single shift puts that right. */
static void test_a_clock_that_is_set_within_the_log_is_an_error(void)
{
    for (int k = ROWS - 1; k >= ROWS / 2; --k) {
        memcpy(&rows[k].value[CSV_ATTITUDE], &rows[k - 60].value[CSV_ATTITUDE], 9 * sizeof(double));
    }
    examine();
    assert_error(DOCTOR_INPUT_SHIFT, CSV_WRENCH, "follow their inputs by 1.");
    TEST_ASSERT_FALSE(doctor.shift_s != 0.0);
    TEST_ASSERT_FALSE(doctor.usable);
}

static void test_a_slip_of_a_part_is_told_with_its_time(void)
{
    for (int k = 2 * ROWS / 3; k < ROWS; ++k) {
        rows[k].value[CSV_NU + 5] *= 180.0 / PI;
    }
    examine();
    assert_error(DOCTOR_RATE_DEGREES, CSV_NU + 5, "from t_s 1");
    TEST_ASSERT_DOUBLE_WITHIN(15.0, 180.0, finding(DOCTOR_RATE_DEGREES)->from_s);
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 220.0, finding(DOCTOR_RATE_DEGREES)->to_s);
}

static void test_of_two_slips_both_are_named(void)
{
    scale(CSV_WRENCH, -1.0);
    scale(CSV_ATTITUDE + 2, 180.0 / PI);
    examine();
    TEST_ASSERT_NOT_NULL(finding(DOCTOR_ANGLE_DEGREES));
    TEST_ASSERT_NOT_NULL(finding(DOCTOR_INPUT_SIGN));
}

/* Ten hours with a dive of two minutes; else only noise of attitude and rates. */
static void test_noise_in_hours_of_rest_is_no_slip(void)
{
    sim_rng_t rng;
    csv_row_t row = {0};
    for (uint32_t seed = 1; seed <= 2; ++seed) {
        sim_rng_seed(&rng, seed, 1);
        doctor_init(&doctor, has);
        for (int k = 0; k < ROWS; ++k) {
            doctor_feed(&doctor, &rows[k]);
        }
        for (int k = 0; k < 360000; ++k) {
            row.value[CSV_T] = 100.0 + STEP_S * ROWS + 0.1 * k;
            for (int i = 0; i < 3; ++i) {
                row.value[CSV_ATTITUDE + i] = 0.003 * sim_rng_gauss(&rng);
                row.value[CSV_NU + 3 + i] = 0.002 * sim_rng_gauss(&rng);
            }
            doctor_feed(&doctor, &row);
        }
        doctor_finish(&doctor);
        TEST_ASSERT_NULL(finding(DOCTOR_ANGLE_SIGN));
        TEST_ASSERT_NULL(finding(DOCTOR_ATTITUDE_SHIFT));
        TEST_ASSERT_NULL(finding(DOCTOR_RATE_EXCHANGED));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_log_without_slip_is_usable);
    RUN_TEST(test_one_angle_in_degrees_is_named);
    RUN_TEST(test_rates_in_degrees_are_named);
    RUN_TEST(test_a_reversed_heading_is_told_from_a_reversed_rate);
    RUN_TEST(test_a_reversed_rate_is_told_from_a_reversed_input);
    RUN_TEST(test_a_reversed_moment_is_named);
    RUN_TEST(test_a_controller_that_holds_an_axis_is_not_accused);
    RUN_TEST(test_an_input_that_rests_for_most_of_the_log_is_not_accused_there);
    RUN_TEST(test_a_hull_that_swings_does_not_accuse_a_small_moment);
    RUN_TEST(test_the_coupling_tells_a_reversed_force_from_a_reversed_velocity);
    RUN_TEST(test_depth_tells_a_reversed_heave_velocity);
    RUN_TEST(test_depth_tells_a_reversed_surge_velocity_from_a_reversed_pitch);
    RUN_TEST(test_a_velocity_sensor_that_is_mounted_backwards_is_named);
    RUN_TEST(test_a_velocity_sensor_that_is_mounted_at_an_angle_is_named);
    RUN_TEST(test_forces_that_are_turned_do_not_accuse_the_velocity_sensor);
    RUN_TEST(test_without_depth_the_sentence_names_both);
    RUN_TEST(test_exchanged_rates_are_named);
    RUN_TEST(test_the_coupling_tells_exchanged_forces_from_exchanged_velocities);
    RUN_TEST(test_an_attitude_in_other_axes_is_named);
    RUN_TEST(test_velocities_in_other_axes_are_named);
    RUN_TEST(test_a_late_attitude_is_named_with_its_delay);
    RUN_TEST(test_late_motion_is_named_with_its_delay);
    RUN_TEST(test_early_motion_is_named);
    RUN_TEST(test_motion_that_is_early_by_nearly_two_seconds_is_named);
    RUN_TEST(test_a_long_lag_is_a_note);
    RUN_TEST(test_a_clock_that_is_set_within_the_log_is_an_error);
    RUN_TEST(test_a_slip_of_a_part_is_told_with_its_time);
    RUN_TEST(test_of_two_slips_both_are_named);
    RUN_TEST(test_noise_in_hours_of_rest_is_no_slip);
    return UNITY_END();
}
