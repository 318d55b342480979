/* The log doctor on a simulated vehicle without noise: velocities in other units, in the axes of
 * the world, or with an offset; forces in other units; the order of a quaternion. */
#include "doctor_log.h"

void setUp(void)
{
    make_log();
}

void tearDown(void)
{
}

#define DRY_MASS_KG 220.0 /* of 250 in surge, 370 in sway, 660 in heave */
#define KNOTS 1.9438      /* in a metre per second */

static void examine_with(double dry_mass_kg, bool known_force)
{
    doctor_init(&doctor, has);
    doctor_dry_mass(&doctor, dry_mass_kg, known_force);
    for (int k = 0; k < ROWS; ++k) {
        doctor_feed(&doctor, &rows[k]);
    }
    doctor_finish(&doctor);
}

static void examine_dry(double dry_mass_kg)
{
    examine_with(dry_mass_kg, false);
}

static void lose(int column, int count)
{
    for (int i = 0; i < count; ++i) {
        has[column + i] = false;
        for (int k = 0; k < ROWS; ++k) {
            rows[k].value[column + i] = NAN;
        }
    }
}

static void assert_warning(doctor_code_t code, int column, const char *words)
{
    const doctor_finding_t *f = finding(code);
    TEST_ASSERT_NOT_NULL_MESSAGE(f, words);
    TEST_ASSERT_EQUAL_MESSAGE(DOCTOR_WARNING, f->severity, f->text);
    TEST_ASSERT_EQUAL_MESSAGE(column, f->column, f->text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(f->text, words), f->text);
    TEST_ASSERT_EQUAL_MESSAGE(1, count(DOCTOR_WARNING) + count(DOCTOR_ERROR),
                              doctor.finding[0].text);
}

/* ---- units ---- */

static void scale_velocities(int n, double factor)
{
    for (int i = 0; i < n; ++i) {
        scale(CSV_NU + i, factor);
    }
}

static void test_the_position_shows_velocities_in_knots(void)
{
    lose(CSV_SPECIFIC_FORCE, 3);
    scale_velocities(2, KNOTS);
    assert_only(
        DOCTOR_SCALE, CSV_NU,
        "u_mps, v_mps: 1.94 times the rates of north_m and east_m, as if in knots: multiply "
        "by 0.5144");
}

static void test_the_depth_shows_a_heave_velocity_in_feet(void)
{
    lose(CSV_SPECIFIC_FORCE, 3);
    scale(CSV_NU + 2, 3.2808);
    assert_only(DOCTOR_SCALE, CSV_NU + 2,
                "w_mps: 3.28 times the rate of depth_m, as if in ft/s: multiply by 0.3048");
}

static void test_the_accelerometer_shows_velocities_in_knots(void)
{
    lose(CSV_POSITION, 3);
    scale_velocities(3, KNOTS);
    assert_only(DOCTOR_SCALE, CSV_NU,
                "u_mps, v_mps, w_mps: 1.94 times what the accelerometer says, as if in knots");
}

static void test_the_dry_mass_shows_velocities_in_knots(void)
{
    lose(CSV_POSITION, 3);
    lose(CSV_SPECIFIC_FORCE, 3);
    scale_velocities(2, KNOTS);
    examine_dry(DRY_MASS_KG);
    assert_warning(DOCTOR_SCALE, CSV_NU,
                   "if u_mps and v_mps are in knots, multiply them by 0.5144; else the horizontal "
                   "forces are too small, or the dry mass too large");
    examine_dry(0.0);
    TEST_ASSERT_NULL(finding(DOCTOR_SCALE)); /* nothing shows it */
}

static void test_slow_velocities_in_centimetres_are_named(void)
{
    scale_velocities(2, 30.0); /* cm/s of a vehicle that is slower by 0.3 */
    scale(CSV_POSITION, 0.3);
    scale(CSV_POSITION + 1, 0.3);
    lose(CSV_POSITION + 2, 1);
    lose(CSV_SPECIFIC_FORCE, 3);
    assert_only(DOCTOR_SCALE, CSV_NU, "as if in cm/s: multiply by 0.01");
}

static void scale_forces(double factor)
{
    for (int j = 0; j < 6; ++j) {
        scale(CSV_WRENCH + j, factor);
    }
}

static void test_the_dry_mass_shows_forces_in_kgf(void)
{
    scale_forces(1.0 / 9.81);
    examine_dry(DRY_MASS_KG);
    assert_error(
        DOCTOR_SCALE, CSV_WRENCH,
        "X_N, Y_N, Z_N and the moments look like kilograms-force (the mass that follows is "
        "0.1");
    assert_error(DOCTOR_SCALE, CSV_WRENCH,
                 "multiply them by 9.81, or correct the dry mass if it is too large");
    TEST_ASSERT_EQUAL(1, count(DOCTOR_ERROR));
}

static void test_masses_above_the_dry_mass_are_not_accused(void)
{
    examine_dry(DRY_MASS_KG);
    TEST_ASSERT_EQUAL(0, count(DOCTOR_ERROR) + count(DOCTOR_WARNING));
}

static void test_a_mass_far_below_the_dry_mass_is_an_error_though_no_unit_explains_it(void)
{
    scale_forces(0.33);
    examine_dry(DRY_MASS_KG);
    assert_error(DOCTOR_SCALE, CSV_NU,
                 "of the dry mass, but no vehicle has less than its dry mass: X_N, Y_N, Z_N and "
                 "the moments are too small, u_mps is too large, or the dry mass is");
    TEST_ASSERT_FALSE(doctor.usable);
    scale_forces(0.1);
    examine_dry(DRY_MASS_KG);
    TEST_ASSERT_EQUAL(1, count(DOCTOR_ERROR)); /* nor kilograms-force */
}

static void test_a_known_force_may_correct_thrust_that_is_too_small(void)
{
    scale_forces(0.33);
    examine_with(DRY_MASS_KG, true);
    assert_warning(DOCTOR_SCALE, CSV_NU, "no vehicle has less than its dry mass");
    TEST_ASSERT_TRUE(doctor.usable);
}

static void test_a_mass_of_sway_below_the_dry_mass_is_named(void)
{
    scale(CSV_WRENCH + 1, 0.4);
    examine_dry(DRY_MASS_KG);
    assert_warning(DOCTOR_SCALE, CSV_NU + 1, "the mass that follows from v_mps and its force is");
}

static void test_masses_far_above_the_dry_mass_are_a_warning_if_surge_is_among_them(void)
{
    scale_forces(5.0);
    examine_dry(DRY_MASS_KG);
    assert_warning(DOCTOR_SCALE, CSV_WRENCH, "times the dry mass, more than water adds: X_N, Y_N");
    lose(CSV_WRENCH, 1);
    examine_dry(DRY_MASS_KG);
    TEST_ASSERT_NULL(finding(DOCTOR_SCALE));
}

static void test_a_flat_hull_may_carry_much_water_across(void)
{
    scale(CSV_WRENCH + 1, 3.0);
    scale(CSV_WRENCH + 2, 3.0);
    examine_dry(DRY_MASS_KG);
    TEST_ASSERT_NULL(finding(DOCTOR_SCALE));
}

static void test_attitude_and_rates_in_degrees_have_no_wrong_sign(void)
{
    for (int i = 0; i < 3; ++i) {
        scale(CSV_ATTITUDE + i, 180.0 / PI);
        scale(CSV_NU + 3 + i, 180.0 / PI);
    }
    examine();
    for (int i = 0; i < doctor.findings; ++i) {
        doctor_code_t code = doctor.finding[i].code;
        TEST_ASSERT_TRUE_MESSAGE(code == DOCTOR_ANGLE_DEGREES || code == DOCTOR_RATE_DEGREES ||
                                     doctor.finding[i].severity == DOCTOR_NOTE,
                                 doctor.finding[i].text);
    }
    TEST_ASSERT_TRUE(doctor_has_finding(&doctor, DOCTOR_ANGLE_DEGREES, CSV_ATTITUDE + 2));
}

/* What fit refuses is no usable log. */
static void test_degrees_in_a_pair_or_in_a_single_column_are_named_as_by_fit(void)
{
    lose(CSV_ATTITUDE, 2);
    lose(CSV_NU + 3, 2);
    lose(CSV_POSITION, 3);
    lose(CSV_SPECIFIC_FORCE, 3);
    scale(CSV_ATTITUDE + 2, 180.0 / PI);
    scale(CSV_NU + 5, 180.0 / PI);
    assert_only(DOCTOR_ANGLE_DEGREES, CSV_ATTITUDE + 2,
                "an angle in radians jumps by at most 6.28, one revolution: if the attitude is in "
                "degrees, convert it to radians (times pi/180)");
    lose(CSV_ATTITUDE + 2, 1);
    assert_only(DOCTOR_RATE_DEGREES, CSV_NU + 5,
                "r_radps is beyond +-6.28, one revolution per second, in ");
}

/* ---- axes ---- */

static void to_world(void)
{
    for (int k = 0; k < ROWS; ++k) {
        double *v = rows[k].value, r[3][3], nu[3];
        memcpy(nu, &v[CSV_NU], sizeof nu);
        sim_rotation(&v[CSV_ATTITUDE], r);
        for (int i = 0; i < 3; ++i) {
            v[CSV_NU + i] = r[i][0] * nu[0] + r[i][1] * nu[1] + r[i][2] * nu[2];
        }
    }
}

static void test_velocities_of_the_world_are_named_by_the_position(void)
{
    to_world();
    for (int j = 0; j < 6; ++j) {
        has[CSV_WRENCH + j] = j == 5;
    }
    assert_only(DOCTOR_WORLD_FRAME, CSV_NU, "they are the rates of north_m and east_m");
}

static void test_velocities_of_the_world_are_named_by_the_inputs(void)
{
    to_world();
    lose(CSV_POSITION, 3);
    lose(CSV_SPECIFIC_FORCE, 3);
    assert_only(DOCTOR_WORLD_FRAME, CSV_NU, "turn them into body axes, u ahead and v to starboard");
}

static void test_velocities_to_the_east_north_and_up_are_named(void)
{
    to_world();
    exchange(CSV_NU, CSV_NU + 1);
    scale(CSV_NU + 2, -1.0);
    lose(CSV_SPECIFIC_FORCE, 3);
    assert_only(DOCTOR_WORLD_FRAME, CSV_NU, "they are the rates of east_m and north_m");
    lose(CSV_POSITION, 3);
    assert_only(DOCTOR_WORLD_FRAME, CSV_NU,
                "u_mps, v_mps and w_mps look like velocities to the east, north and up");
    TEST_ASSERT_NOT_NULL(strstr(doctor.finding[0].text, "u ahead and v to starboard, w down"));
}

/* Axes with y to port and z up, and a world with them. */
static void to_flu(void)
{
    static const int reversed[10] = {
        CSV_ATTITUDE + 1, CSV_ATTITUDE + 2, CSV_NU + 1,     CSV_NU + 2,     CSV_NU + 4,
        CSV_NU + 5,       CSV_WRENCH + 1,   CSV_WRENCH + 2, CSV_WRENCH + 4, CSV_WRENCH + 5};
    for (int i = 0; i < 10; ++i) {
        scale(reversed[i], -1.0);
    }
    lose(CSV_SPECIFIC_FORCE, 3);
}

/* Which of the two is wrong does not matter for a fit, or reverses W-B. */
static void test_a_height_and_a_log_with_z_up_have_one_sentence(void)
{
    static const char words[] = "if depth_m is a height, change its sign; if w_mps and its input "
                                "are positive upwards, give them, and all other columns that are "
                                "in FLU and ENU axes, in FRD and NED";
    scale(CSV_POSITION + 2, -1.0);
    assert_only(DOCTOR_DEPTH_SIGN, CSV_POSITION + 2, words);
    make_log();
    to_flu();
    lose(CSV_POSITION, 2);
    assert_only(DOCTOR_DEPTH_SIGN, CSV_POSITION + 2, words);
}

static void test_heave_with_its_input_and_depth_upwards_may_look_like_a_wrong_pitch(void)
{
    scale(CSV_NU + 2, -1.0);
    scale(CSV_WRENCH + 2, -1.0);
    scale(CSV_POSITION + 2, -1.0);
    lose(CSV_SPECIFIC_FORCE, 3);
    assert_only(DOCTOR_ANGLE_SIGN, CSV_ATTITUDE + 1,
                "or depth_m, w_mps and the heave input are all positive upwards");
}

static void test_a_position_in_other_axes_is_named(void)
{
    static const char words[] = "as if one were in NED and FRD axes (z down), the other in ENU and "
                                "FLU (z up): give all columns in NED and FRD";
    exchange(CSV_POSITION, CSV_POSITION + 1);
    examine();
    assert_warning(DOCTOR_POSITION, CSV_POSITION, words);
    make_log();
    to_flu();
    lose(CSV_POSITION + 2, 1);
    examine();
    assert_warning(DOCTOR_POSITION, CSV_POSITION, words);
}

static void test_a_depth_above_the_surface_may_be_a_height(void)
{
    to_flu();
    scale(CSV_POSITION + 1, -1.0);
    scale(CSV_POSITION + 2, -1.0);
    examine();
    assert_warning(DOCTOR_DEPTH_SIGN, CSV_POSITION + 2, "see whether the log is in axes with z up");
}

/* ---- quaternions ---- */

/* order: where w, x, y, z stand in qw, qx, qy, qz. The reader computes the attitude. */
static void to_quaternion(const int order[4])
{
    for (int k = 0; k < ROWS; ++k) {
        double *v = rows[k].value, c[3], s[3];
        for (int i = 0; i < 3; ++i) {
            c[i] = cos(0.5 * v[CSV_ATTITUDE + i]);
            s[i] = sin(0.5 * v[CSV_ATTITUDE + i]);
        }
        const double q[4] = {
            c[0] * c[1] * c[2] + s[0] * s[1] * s[2], s[0] * c[1] * c[2] - c[0] * s[1] * s[2],
            c[0] * s[1] * c[2] + s[0] * c[1] * s[2], c[0] * c[1] * s[2] - s[0] * s[1] * c[2]};
        for (int i = 0; i < 4; ++i) {
            v[CSV_QUATERNION + order[i]] = q[i];
            has[CSV_QUATERNION + i] = true;
        }
        const double *read = &v[CSV_QUATERNION];
        csv_attitude(read[0], read[1], read[2], read[3], &v[CSV_ATTITUDE]);
    }
}

static void test_a_quaternion_that_begins_with_x_is_named(void)
{
    static const int last[4] = {3, 0, 1, 2};
    to_quaternion(last);
    assert_only(DOCTOR_QUATERNION, CSV_QUATERNION,
                "qw, qx, qy, qz look like x, y, z, w: the attitude turns with p, q, r only in that "
                "order: name the columns qx, qy, qz, qw");
}

static void test_a_quaternion_that_turns_from_world_to_body_is_named(void)
{
    static const int right[4] = {0, 1, 2, 3};
    to_quaternion(right);
    for (int k = 0; k < ROWS; ++k) {
        double *q = &rows[k].value[CSV_QUATERNION];
        for (int i = 1; i < 4; ++i) {
            q[i] *= -1.0;
        }
        csv_attitude(q[0], q[1], q[2], q[3], &rows[k].value[CSV_ATTITUDE]);
    }
    assert_only(DOCTOR_QUATERNION, CSV_QUATERNION,
                "qw, qx, qy, qz turn from world to body: the attitude turns against p, q, r: "
                "change the signs of qx, qy, qz");
    for (int j = 3; j < 6; ++j) { /* such rates agree with it; they run against their inputs */
        scale(CSV_NU + j, -1.0);
    }
    examine();
    TEST_ASSERT_NULL(finding(DOCTOR_QUATERNION));
}

static void test_rates_that_are_all_reversed_do_not_accuse_the_quaternion(void)
{
    static const int right[4] = {0, 1, 2, 3};
    to_quaternion(right);
    for (int j = 3; j < 6; ++j) {
        scale(CSV_NU + j, -1.0);
    }
    examine();
    TEST_ASSERT_NULL(finding(DOCTOR_QUATERNION));
    assert_error(DOCTOR_RATE_SIGN, CSV_NU + 5, "r_radps has the wrong sign");
}

static void test_a_quaternion_in_order_is_not_accused(void)
{
    static const int right[4] = {0, 1, 2, 3};
    to_quaternion(right);
    assert_clean();
}

/* ---- offsets ---- */

static void offset(int column, double by)
{
    for (int k = 0; k < ROWS; ++k) {
        rows[k].value[column] += by;
    }
}

static void test_the_position_shows_an_offset_of_a_velocity(void)
{
    offset(CSV_NU, 0.1);
    examine();
    assert_warning(DOCTOR_OFFSET, CSV_NU,
                   "u_mps has an offset of +0.100 m/s against the rates of north_m and east_m");
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.1, finding(DOCTOR_OFFSET)->value);
}

/* Velocity through the water, position over ground. */
static void test_a_current_is_no_offset(void)
{
    for (int k = 0; k < ROWS; ++k) {
        rows[k].value[CSV_POSITION] += 0.2 * STEP_S * k;
    }
    examine();
    TEST_ASSERT_NULL(finding(DOCTOR_OFFSET));
}

static void test_rest_shows_an_offset_of_a_velocity(void)
{
    for (int k = 0; k < ROWS / 3; ++k) {
        memset(&rows[k].value[CSV_NU], 0, 12 * sizeof(double));
        for (int i = 0; i < 3; ++i) {
            rows[k].value[CSV_NU + i] = 0.004 * sin(1.3 * k + i); /* noise */
        }
        memcpy(&rows[k].value[CSV_ATTITUDE], &rows[ROWS / 3].value[CSV_ATTITUDE],
               3 * sizeof(double));
    }
    lose(CSV_POSITION, 3);
    lose(CSV_SPECIFIC_FORCE, 3);
    examine();
    TEST_ASSERT_NULL(finding(DOCTOR_OFFSET));
    offset(CSV_NU, -0.08);
    examine();
    assert_warning(DOCTOR_OFFSET, CSV_NU, "u_mps is -0.080 m/s on average in 3");
    TEST_ASSERT_DOUBLE_WITHIN(0.01, -0.08, finding(DOCTOR_OFFSET)->value);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_position_shows_velocities_in_knots);
    RUN_TEST(test_the_depth_shows_a_heave_velocity_in_feet);
    RUN_TEST(test_the_accelerometer_shows_velocities_in_knots);
    RUN_TEST(test_the_dry_mass_shows_velocities_in_knots);
    RUN_TEST(test_slow_velocities_in_centimetres_are_named);
    RUN_TEST(test_the_dry_mass_shows_forces_in_kgf);
    RUN_TEST(test_masses_above_the_dry_mass_are_not_accused);
    RUN_TEST(test_a_mass_far_below_the_dry_mass_is_an_error_though_no_unit_explains_it);
    RUN_TEST(test_a_known_force_may_correct_thrust_that_is_too_small);
    RUN_TEST(test_a_mass_of_sway_below_the_dry_mass_is_named);
    RUN_TEST(test_masses_far_above_the_dry_mass_are_a_warning_if_surge_is_among_them);
    RUN_TEST(test_a_flat_hull_may_carry_much_water_across);
    RUN_TEST(test_attitude_and_rates_in_degrees_have_no_wrong_sign);
    RUN_TEST(test_degrees_in_a_pair_or_in_a_single_column_are_named_as_by_fit);
    RUN_TEST(test_velocities_of_the_world_are_named_by_the_position);
    RUN_TEST(test_velocities_of_the_world_are_named_by_the_inputs);
    RUN_TEST(test_velocities_to_the_east_north_and_up_are_named);
    RUN_TEST(test_a_height_and_a_log_with_z_up_have_one_sentence);
    RUN_TEST(test_heave_with_its_input_and_depth_upwards_may_look_like_a_wrong_pitch);
    RUN_TEST(test_a_position_in_other_axes_is_named);
    RUN_TEST(test_a_depth_above_the_surface_may_be_a_height);
    RUN_TEST(test_a_quaternion_that_begins_with_x_is_named);
    RUN_TEST(test_a_quaternion_that_turns_from_world_to_body_is_named);
    RUN_TEST(test_rates_that_are_all_reversed_do_not_accuse_the_quaternion);
    RUN_TEST(test_a_quaternion_in_order_is_not_accused);
    RUN_TEST(test_the_position_shows_an_offset_of_a_velocity);
    RUN_TEST(test_a_current_is_no_offset);
    RUN_TEST(test_rest_shows_an_offset_of_a_velocity);
    return UNITY_END();
}
