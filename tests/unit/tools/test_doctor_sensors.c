/* The log doctor on a simulated vehicle without noise: accelerometers, and inputs of single
 * thrusters. */
#include "doctor_thruster_log.h"

void setUp(void)
{
    make_log();
}

void tearDown(void)
{
}

/* ---- accelerometers ---- */

static void scale_force(double x, double y, double z)
{
    scale(CSV_SPECIFIC_FORCE, x);
    scale(CSV_SPECIFIC_FORCE + 1, y);
    scale(CSV_SPECIFIC_FORCE + 2, z);
}

/* Only this warning; the log is usable, because fit needs no accelerometer. */
static void assert_warning(doctor_code_t code, int column, const char *words)
{
    examine();
    const doctor_finding_t *f = finding(code);
    TEST_ASSERT_NOT_NULL_MESSAGE(f, words);
    TEST_ASSERT_EQUAL_MESSAGE(DOCTOR_WARNING, f->severity, f->text);
    TEST_ASSERT_EQUAL_MESSAGE(column, f->column, f->text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(f->text, words), f->text);
    TEST_ASSERT_EQUAL_MESSAGE(1, count(DOCTOR_WARNING), doctor.finding[1].text);
    TEST_ASSERT_EQUAL(0, count(DOCTOR_ERROR));
    TEST_ASSERT_TRUE(doctor.usable);
}

static void test_multiples_of_g_are_named(void)
{
    scale_force(1 / 9.81, 1 / 9.81, 1 / 9.81);
    assert_warning(DOCTOR_FORCE_UNIT, CSV_SPECIFIC_FORCE + 2,
                   "look like multiples of g, not m/s2: multiply them by 9.81");
    scale_force(1000, 1000, 1000);
    assert_warning(DOCTOR_FORCE_UNIT, CSV_SPECIFIC_FORCE + 2, "look like thousandths of g");
}

static void test_a_force_without_gravity_is_named(void)
{
    for (int k = 0; k < ROWS; ++k) {
        rows[k].value[CSV_SPECIFIC_FORCE + 2] += 9.81;
    }
    assert_warning(DOCTOR_NO_GRAVITY, CSV_SPECIFIC_FORCE + 2, "fz_mps2 has no gravity");
}

static void test_an_accelerometer_in_flu_axes_is_named(void)
{
    scale_force(1, -1, -1);
    assert_warning(DOCTOR_FRAME, CSV_SPECIFIC_FORCE + 1,
                   "fy_mps2 and fz_mps2 are reversed, as in FLU axes");
}

static void test_gravity_instead_of_specific_force_is_named(void)
{
    scale_force(-1, -1, -1);
    assert_warning(DOCTOR_FORCE_SIGN, CSV_SPECIFIC_FORCE,
                   "fx_mps2, fy_mps2 and fz_mps2 are reversed, as if they were gravity");
}

static void test_each_reversed_axis_is_named(void)
{
    scale_force(-1, 1, 1);
    assert_warning(DOCTOR_FORCE_SIGN, CSV_SPECIFIC_FORCE, "fx_mps2 has the wrong sign");
    scale_force(-1, -1, 1);
    assert_warning(DOCTOR_FORCE_SIGN, CSV_SPECIFIC_FORCE + 1, "fy_mps2 has the wrong sign");
    scale_force(1, -1, -1);
    assert_warning(DOCTOR_FORCE_SIGN, CSV_SPECIFIC_FORCE + 2, "fz_mps2 is positive at rest");
}

static void test_each_pair_of_exchanged_axes_is_named(void)
{
    exchange(CSV_SPECIFIC_FORCE, CSV_SPECIFIC_FORCE + 1);
    assert_warning(DOCTOR_FORCE_EXCHANGED, CSV_SPECIFIC_FORCE, "fy_mps2 as fx_mps2");
    exchange(CSV_SPECIFIC_FORCE, CSV_SPECIFIC_FORCE + 1);
    exchange(CSV_SPECIFIC_FORCE, CSV_SPECIFIC_FORCE + 2);
    assert_warning(DOCTOR_FORCE_EXCHANGED, CSV_SPECIFIC_FORCE,
                   "fx_mps2 has the gravity that fz_mps2 should have");
}

static void test_a_slip_of_the_accelerometer_in_a_part_is_told_with_its_time(void)
{
    for (int k = ROWS / 2; k < ROWS; ++k) {
        rows[k].value[CSV_SPECIFIC_FORCE + 2] *= -1.0;
    }
    examine();
    TEST_ASSERT_NOT_NULL(finding(DOCTOR_FORCE_SIGN));
    TEST_ASSERT_DOUBLE_WITHIN(12.0, 160.0, finding(DOCTOR_FORCE_SIGN)->from_s);
}

static void test_a_wrong_attitude_is_not_blamed_on_the_accelerometer(void)
{
    scale(CSV_ATTITUDE + 1, -1.0);
    examine();
    TEST_ASSERT_NOT_NULL(finding(DOCTOR_ANGLE_SIGN));
    TEST_ASSERT_NULL(finding(DOCTOR_FORCE_SIGN));
}

static void test_without_rates_the_sentence_names_angle_and_force(void)
{
    has[CSV_NU + 3] = has[CSV_NU + 4] = has[CSV_NU + 5] = false;
    scale(CSV_ATTITUDE, -1.0);
    examine();
    const doctor_finding_t *f = finding(DOCTOR_FORCE_SIGN);
    TEST_ASSERT_NOT_NULL(f);
    TEST_ASSERT_EQUAL(CSV_ATTITUDE, f->other);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(f->text, "fy_mps2 changes against phi_rad"), f->text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(f->text, "one of them has the wrong sign"), f->text);
}

/* ---- thrusters ---- */

static void test_thrusters_are_compared_with_the_motion(void)
{
    to_thrusters();
    examine_thrusters();
    TEST_ASSERT_EQUAL_MESSAGE(0, count(DOCTOR_ERROR), doctor.finding[0].text);
    TEST_ASSERT_TRUE(doctor.answers[0] && doctor.answers[1] && doctor.answers[2]);
    TEST_ASSERT_TRUE(doctor.answers[5] && doctor.usable);
}

static void test_without_their_vehicle_they_are_not(void)
{
    to_thrusters();
    examine();
    TEST_ASSERT_TRUE(doctor.usable);
    TEST_ASSERT_NOT_NULL(strstr(finding(DOCTOR_MOTION)->text, "--vehicle"));
}

static void test_a_reversed_thruster_is_named(void)
{
    static const char *const names[4] = {"thruster_1_N has", "thruster_2_N has", "thruster_3_N",
                                         "thruster_4_N"};
    to_thrusters();
    for (int i = 0; i < 4; ++i) {
        scale(CSV_THRUSTER_N + i, -1.0);
        examine_thrusters();
        TEST_ASSERT_NOT_NULL_MESSAGE(finding(DOCTOR_THRUSTER_SIGN), names[i]);
        assert_error(DOCTOR_THRUSTER_SIGN, finding(DOCTOR_THRUSTER_SIGN)->column, names[i]);
        TEST_ASSERT_EQUAL_MESSAGE(1, count(DOCTOR_ERROR), doctor.finding[1].text);
        scale(CSV_THRUSTER_N + i, -1.0);
    }
}

static void test_exchanged_thrusters_are_named(void)
{
    static const int pair[3][2] = {{0, 2}, {1, 4}, {3, 4}};
    to_thrusters();
    for (int k = 0; k < 3; ++k) {
        char words[80];
        (void)snprintf(words, sizeof words, "thruster_%d_N and thruster_%d_N are exchanged",
                       pair[k][0] + 1, pair[k][1] + 1);
        exchange(CSV_THRUSTER_N + pair[k][0], CSV_THRUSTER_N + pair[k][1]);
        examine_thrusters();
        assert_error(DOCTOR_THRUSTER_SWAP, CSV_THRUSTER_N + pair[k][0], words);
        TEST_ASSERT_EQUAL(CSV_THRUSTER_N + pair[k][1], finding(DOCTOR_THRUSTER_SWAP)->other);
        TEST_ASSERT_EQUAL_MESSAGE(1, count(DOCTOR_ERROR), doctor.finding[1].text);
        exchange(CSV_THRUSTER_N + pair[k][0], CSV_THRUSTER_N + pair[k][1]);
    }
}

/* The default vehicle with four thrusters of heave, at the corners. */
static const vehicle_t *with_corners(void)
{
    static vehicle_t vehicle;
    static auvid_allocation_config_t all;
    static const double corner[4][2] = {{0.4, 0.3}, {0.4, -0.3}, {-0.4, 0.3}, {-0.4, -0.3}};
    vehicle = *vehicle_default();
    all = *vehicle.allocation;
    all.thruster[2] = all.thruster[4]; /* that of sway; then those of heave */
    all.thrusters = 7;
    all.dofs = 0; /* all */
    for (int i = 0; i < 4; ++i) {
        all.thruster[3 + i] = vehicle.allocation->thruster[3];
        all.thruster[3 + i].wrench[AUVID_ROLL] = (auvid_real_t)-corner[i][1];
        all.thruster[3 + i].wrench[AUVID_PITCH] = (auvid_real_t)corner[i][0];
    }
    vehicle.allocation = &all;
    return &vehicle;
}

/* The default vehicle with four horizontal thrusters at 45 degrees, and one of heave. */
static const vehicle_t *with_vectored_thrusters(void)
{
    static vehicle_t vehicle;
    static auvid_allocation_config_t all;
    static const double side[4] = {-0.7, 0.7, 0.7, -0.7}, turn[4] = {-0.4, 0.4, -0.4, 0.4};
    vehicle = *vehicle_default();
    all = *vehicle.allocation;
    all.thruster[4] = all.thruster[3];
    for (int i = 0; i < 4; ++i) {
        all.thruster[i] = vehicle.allocation->thruster[0];
        all.thruster[i].wrench[AUVID_SURGE] = (auvid_real_t)0.7;
        all.thruster[i].wrench[AUVID_SWAY] = (auvid_real_t)side[i];
        all.thruster[i].wrench[AUVID_YAW] = (auvid_real_t)turn[i];
    }
    vehicle.allocation = &all;
    return &vehicle;
}

static void test_two_reversed_thrusters_are_not_called_exchanged(void)
{
    to_thrusters_of(with_vectored_thrusters());
    for (int one = 0; one < 4; ++one) {
        for (int other = one + 1; other < 4; ++other) {
            char words[80];
            (void)snprintf(words, sizeof words, "thruster_%d_N and thruster_%d_N have the wrong",
                           one + 1, other + 1);
            scale(CSV_THRUSTER_N + one, -1.0);
            scale(CSV_THRUSTER_N + other, -1.0);
            examine_thrusters();
            assert_error(DOCTOR_THRUSTER_SIGN, CSV_THRUSTER_N + one, words);
            TEST_ASSERT_EQUAL(CSV_THRUSTER_N + other, finding(DOCTOR_THRUSTER_SIGN)->other);
            TEST_ASSERT_EQUAL_MESSAGE(1, count(DOCTOR_ERROR), doctor.finding[1].text);
            scale(CSV_THRUSTER_N + one, -1.0);
            scale(CSV_THRUSTER_N + other, -1.0);
        }
    }
}

static void test_one_slip_is_not_called_two_reversed_thrusters(void)
{
    to_thrusters_of(with_vectored_thrusters());
    for (int i = 0; i < 4; ++i) {
        scale(CSV_THRUSTER_N + i, -1.0);
        examine_thrusters();
        TEST_ASSERT_EQUAL(-1, finding(DOCTOR_THRUSTER_SIGN)->other);
        scale(CSV_THRUSTER_N + i, -1.0);
        exchange(CSV_THRUSTER_N + i, CSV_THRUSTER_N + (i + 1) % 4);
        examine_thrusters();
        TEST_ASSERT_NOT_NULL(finding(DOCTOR_THRUSTER_SWAP));
        TEST_ASSERT_EQUAL_MESSAGE(1, count(DOCTOR_ERROR), doctor.finding[1].text);
        exchange(CSV_THRUSTER_N + i, CSV_THRUSTER_N + (i + 1) % 4);
    }
}

/* Several thrusters give X and Y: there are no columns of the two to exchange. */
static void test_exchanged_forces_of_thrusters_have_no_columns(void)
{
    has[CSV_POSITION] = has[CSV_POSITION + 1] = false;
    exchange(CSV_WRENCH, CSV_WRENCH + 1);
    to_thrusters_of(with_vectored_thrusters());
    examine_thrusters();
    assert_error(DOCTOR_INPUT_EXCHANGED, CSV_WRENCH,
                 "thrusters are reversed or exchanged: compare each with the vehicle file");
}

/* Those of heave differ in pitch alone, which drag and weight turn, too. */
static void test_exchanged_thrusters_that_tilt_are_only_a_warning(void)
{
    to_thrusters_of(with_corners());
    exchange(CSV_THRUSTER_N + 3, CSV_THRUSTER_N + 4);
    examine_thrusters();
    TEST_ASSERT_NOT_NULL(finding(DOCTOR_THRUSTER_SWAP));
    TEST_ASSERT_EQUAL(DOCTOR_WARNING, finding(DOCTOR_THRUSTER_SWAP)->severity);
    TEST_ASSERT_NOT_NULL(strstr(finding(DOCTOR_THRUSTER_SWAP)->text,
                                "thruster_4_N and thruster_5_N may be exchanged"));
    TEST_ASSERT_TRUE(doctor.usable);
}

/* A reversed thruster of heave would give it a moment, too; heave's own force tells nothing. */
static void test_heave_that_pitches_the_vehicle_is_no_reversed_thruster(void)
{
    double q = 0.0, theta = 0.0;
    for (int k = 0; k < ROWS; ++k) {
        double dt = k > 0 ? rows[k].value[CSV_T] - rows[k - 1].value[CSV_T] : 0.0;
        q += dt * (1e-3 * rows[k].value[CSV_WRENCH + 2] - 2.0 * q - 1.0 * theta);
        theta += dt * q;
        rows[k].value[CSV_WRENCH + 3] = rows[k].value[CSV_WRENCH + 4] = 0.0;
        rows[k].value[CSV_NU + 4] = q;
        rows[k].value[CSV_ATTITUDE + 1] = theta;
    }
    to_thrusters_of(with_corners());
    examine_thrusters();
    TEST_ASSERT_EQUAL_MESSAGE(0, count(DOCTOR_ERROR), doctor.finding[0].text);
}

/* Errors of the thrusters' positions make such a moment, and its sign is not certain. */
static void test_a_moment_that_the_model_does_not_need_is_no_error(void)
{
    static vehicle_t vehicle;
    static auvid_vehicle_t pitches;
    vehicle = *with_corners();
    to_thrusters_of(&vehicle);
    scale(CSV_NU + 4, -1.0);
    scale(CSV_ATTITUDE + 1, -1.0);
    has[CSV_POSITION + 2] = false;
    examine_thrusters();
    TEST_ASSERT_NOT_NULL(finding(DOCTOR_EITHER_SIGN));
    TEST_ASSERT_EQUAL(DOCTOR_WARNING, finding(DOCTOR_EITHER_SIGN)->severity);
    TEST_ASSERT_NOT_NULL(strstr(finding(DOCTOR_EITHER_SIGN)->text, "positions of the thrusters"));
    pitches = *vehicle.model;
    pitches.columns[AUVID_PITCH] = 1u;
    vehicle.model = &pitches;
    examine_thrusters();
    TEST_ASSERT_EQUAL(DOCTOR_ERROR, finding(DOCTOR_EITHER_SIGN)->severity);
}

static void test_a_thruster_that_never_runs_is_named(void)
{
    to_thrusters_of(with_corners());
    scale(CSV_THRUSTER_N + 4, 0.0);
    examine_thrusters();
    TEST_ASSERT_NOT_NULL(finding(DOCTOR_STUCK));
    TEST_ASSERT_EQUAL(DOCTOR_WARNING, finding(DOCTOR_STUCK)->severity);
    TEST_ASSERT_NOT_NULL(
        strstr(finding(DOCTOR_STUCK)->text, "thruster_5_N is always 0, but thruster_4_N changes"));
}

static void test_thrusters_that_come_rarely_are_slow(void)
{
    to_thrusters_of(with_corners());
    for (int k = 0; k < ROWS; ++k) {
        for (int i = 0; i < 7 && k % 100 > 0; ++i) {
            rows[k].value[CSV_THRUSTER_N + i] = NAN;
        }
    }
    examine_thrusters();
    TEST_ASSERT_NOT_NULL(finding(DOCTOR_SLOW));
    TEST_ASSERT_NOT_NULL(
        strstr(finding(DOCTOR_SLOW)->text, "thruster_1_N comes every 2.03 s on average"));
}

/* As of a voltage that the vehicle does not measure. */
static void test_a_column_without_values_is_an_error(void)
{
    to_thrusters();
    has[CSV_VOLTAGE] = true;
    for (int k = 0; k < ROWS; ++k) {
        rows[k].value[CSV_VOLTAGE] = NAN;
    }
    examine_thrusters();
    assert_error(DOCTOR_MISSING, CSV_VOLTAGE, "voltage_V has no value in any row");
}

/* Those of surge differ in yaw alone. */
static void test_exchanged_thrusters_of_one_axis_are_told_as_its_moment(void)
{
    to_thrusters();
    exchange(CSV_THRUSTER_N, CSV_THRUSTER_N + 1);
    examine_thrusters();
    assert_error(DOCTOR_INPUT_SIGN, CSV_WRENCH + 5, "reverse its thrusters, or exchange them");
}

/* Sway has one thruster: the coupling tells that not the velocity is wrong. */
static void test_a_reversed_thruster_that_is_alone_is_told_as_the_force_of_its_axis(void)
{
    to_thrusters();
    has[CSV_POSITION] = has[CSV_POSITION + 1] = false;
    scale(CSV_THRUSTER_N + 4, -1.0);
    examine_thrusters();
    assert_error(DOCTOR_INPUT_SIGN, CSV_WRENCH + 1,
                 "the sway force of the thrusters has the wrong");
}

/* It is no slip of the thrusters that give the moment, though their exchange looks like it. */
static void test_a_heading_and_its_rate_to_port_do_not_accuse_the_thrusters(void)
{
    to_thrusters();
    scale(CSV_NU + 5, -1.0);
    scale(CSV_ATTITUDE + 2, -1.0);
    examine_thrusters();
    assert_error(DOCTOR_FRAME, CSV_ATTITUDE + 2, "psi_rad and r_radps are both positive to port");
    TEST_ASSERT_EQUAL_MESSAGE(1, count(DOCTOR_ERROR), doctor.finding[1].text);
}

/* Without dry mass the limits of the thrusters show the unit. */
static void test_thrusters_that_stop_at_a_tenth_of_their_limits_are_in_kgf(void)
{
    to_thrusters();
    for (int k = 0; k < ROWS; ++k) {
        for (int i = 0; i < 5; ++i) {
            double *force = &rows[k].value[CSV_THRUSTER_N + i];
            *force = fmax(-153.8, fmin(4.0 * *force, 153.8));
        }
    }
    examine_thrusters();
    TEST_ASSERT_NULL(finding(DOCTOR_SCALE));
    for (int i = 0; i < 5; ++i) {
        scale(CSV_THRUSTER_N + i, 1.0 / 9.81);
    }
    examine_thrusters();
    assert_error(DOCTOR_SCALE, CSV_THRUSTER_N,
                 "the forces of the thrusters look like kilograms-force (they stop at a tenth");
}

/* The wrench that follows from them is no motion to compare. */
static void test_pulse_widths_need_a_vehicle_file_that_says_so(void)
{
    to_thrusters();
    for (int i = 0; i < 5; ++i) {
        for (int k = 0; k < ROWS; ++k) {
            rows[k].value[CSV_THRUSTER + i] = 1500.0 + rows[k].value[CSV_THRUSTER_N + i];
        }
        has[CSV_THRUSTER + i] = true;
        has[CSV_THRUSTER_N + i] = false;
    }
    TEST_ASSERT_TRUE(log_use_thrusters(&use, vehicle_default(), has));
    examine_thrusters();
    assert_error(DOCTOR_SCALE, CSV_THRUSTER,
                 "give zero_command and full_command of the commands in the vehicle file (of pulse "
                 "widths 1500 and 1900)");
    TEST_ASSERT_EQUAL_MESSAGE(1, count(DOCTOR_ERROR), doctor.finding[1].text);
}

/* fit judges the largest force of all its logs. */
static void test_thrusters_that_hardly_act_are_a_warning(void)
{
    to_thrusters();
    for (int i = 0; i < 5; ++i) {
        scale(CSV_THRUSTER_N + i, 1e-3);
    }
    examine_thrusters();
    TEST_ASSERT_NOT_NULL(finding(DOCTOR_SCALE));
    TEST_ASSERT_EQUAL(DOCTOR_WARNING, finding(DOCTOR_SCALE)->severity);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_multiples_of_g_are_named);
    RUN_TEST(test_a_force_without_gravity_is_named);
    RUN_TEST(test_an_accelerometer_in_flu_axes_is_named);
    RUN_TEST(test_gravity_instead_of_specific_force_is_named);
    RUN_TEST(test_each_reversed_axis_is_named);
    RUN_TEST(test_each_pair_of_exchanged_axes_is_named);
    RUN_TEST(test_a_slip_of_the_accelerometer_in_a_part_is_told_with_its_time);
    RUN_TEST(test_a_wrong_attitude_is_not_blamed_on_the_accelerometer);
    RUN_TEST(test_without_rates_the_sentence_names_angle_and_force);
    RUN_TEST(test_thrusters_are_compared_with_the_motion);
    RUN_TEST(test_without_their_vehicle_they_are_not);
    RUN_TEST(test_a_reversed_thruster_is_named);
    RUN_TEST(test_exchanged_thrusters_are_named);
    RUN_TEST(test_two_reversed_thrusters_are_not_called_exchanged);
    RUN_TEST(test_one_slip_is_not_called_two_reversed_thrusters);
    RUN_TEST(test_exchanged_forces_of_thrusters_have_no_columns);
    RUN_TEST(test_exchanged_thrusters_that_tilt_are_only_a_warning);
    RUN_TEST(test_heave_that_pitches_the_vehicle_is_no_reversed_thruster);
    RUN_TEST(test_a_moment_that_the_model_does_not_need_is_no_error);
    RUN_TEST(test_a_thruster_that_never_runs_is_named);
    RUN_TEST(test_thrusters_that_come_rarely_are_slow);
    RUN_TEST(test_a_column_without_values_is_an_error);
    RUN_TEST(test_exchanged_thrusters_of_one_axis_are_told_as_its_moment);
    RUN_TEST(test_a_reversed_thruster_that_is_alone_is_told_as_the_force_of_its_axis);
    RUN_TEST(test_a_heading_and_its_rate_to_port_do_not_accuse_the_thrusters);
    RUN_TEST(test_pulse_widths_need_a_vehicle_file_that_says_so);
    RUN_TEST(test_thrusters_that_hardly_act_are_a_warning);
    RUN_TEST(test_thrusters_that_stop_at_a_tenth_of_their_limits_are_in_kgf);
    return UNITY_END();
}
