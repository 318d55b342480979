/* The log doctor on a simulated vehicle without noise: depth against the velocities. */
#include "doctor_log.h"

void setUp(void)
{
    make_log();
}

void tearDown(void)
{
}

/* A vehicle that sinks while it pitches up: reversed, its pitch would give a larger depth rate. */
static void sink_with_pitch(double share)
{
    double depth = 20.0;
    scale(CSV_ATTITUDE + 1, 3.0);
    scale(CSV_NU + 4, 3.0);
    has[CSV_POSITION] = has[CSV_POSITION + 1] = false;
    for (int k = 0; k < ROWS; ++k) {
        double *v = rows[k].value, phi = v[CSV_ATTITUDE], theta = v[CSV_ATTITUDE + 1];
        v[CSV_NU + 2] += share * v[CSV_NU] * sin(theta);
        v[CSV_POSITION + 2] = depth;
        depth += STEP_S * (cos(theta) * (sin(phi) * v[CSV_NU + 1] + cos(phi) * v[CSV_NU + 2]) -
                           sin(theta) * v[CSV_NU]);
    }
}

/* Its unit is a warning, and nothing else is said: fit does not use the depth. */
static void assert_unit(const char *words)
{
    examine();
    const doctor_finding_t *f = finding(DOCTOR_SCALE);
    TEST_ASSERT_NOT_NULL_MESSAGE(f, words);
    TEST_ASSERT_EQUAL(DOCTOR_WARNING, f->severity);
    TEST_ASSERT_EQUAL(CSV_POSITION + 2, f->column);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(f->text, words), f->text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(f->text, "convert it to metres"), f->text);
    TEST_ASSERT_EQUAL_MESSAGE(1, count(DOCTOR_WARNING), doctor.finding[1].text);
    TEST_ASSERT_EQUAL_MESSAGE(0, count(DOCTOR_ERROR), doctor.finding[0].text);
    TEST_ASSERT_TRUE(doctor.usable);
}

static void test_the_unit_of_a_depth_is_named(void)
{
    static const struct {
        double factor, offset;
        const char *words;
    } unit[] = {{3.2808, 0, "in feet"},
                {100, 0, "in centimetres or millibars"},
                {1000, 0, "in millimetres"},
                {0.1005, 1.013, "in bars"},
                {9.81, 101.3, "or kilopascals"}};
    for (size_t i = 0; i < sizeof unit / sizeof unit[0]; ++i) {
        make_log();
        for (int k = 0; k < ROWS; ++k) {
            double *depth = &rows[k].value[CSV_POSITION + 2];
            *depth = unit[i].factor * *depth + unit[i].offset;
        }
        assert_unit(unit[i].words);
        has[CSV_POSITION] = has[CSV_POSITION + 1] = false;
        assert_unit(unit[i].words);
    }
}

static void test_a_depth_with_an_error_of_scale_has_no_other_unit_and_no_wrong_sign(void)
{
    static const double factor[4] = {0.7, 1.3, 2.0, 2.8};
    for (int i = 0; i < 4; ++i) {
        make_log();
        sink_with_pitch(2.0);
        scale(CSV_POSITION + 2, factor[i]);
        examine();
        TEST_ASSERT_EQUAL_MESSAGE(0, count(DOCTOR_WARNING), doctor.finding[0].text);
        TEST_ASSERT_NULL(finding(DOCTOR_ANGLE_SIGN));
        TEST_ASSERT_NULL(finding(DOCTOR_DEPTH_SIGN));
    }
}

static void test_a_height_in_feet_is_named_as_both(void)
{
    scale(CSV_POSITION + 2, -3.2808);
    examine();
    assert_error(DOCTOR_DEPTH_SIGN, CSV_POSITION + 2, "if depth_m is a height");
    TEST_ASSERT_NOT_NULL(finding(DOCTOR_SCALE));
    TEST_ASSERT_EQUAL_MESSAGE(1, count(DOCTOR_ERROR), doctor.finding[1].text);
}

/* The pitch of the vehicle tells it. */
static void test_a_velocity_and_a_depth_upwards_do_not_contradict_each_other(void)
{
    scale(CSV_NU + 2, -1.0);
    scale(CSV_POSITION + 2, -1.0);
    has[CSV_POSITION] = has[CSV_POSITION + 1] = false;
    for (int i = 0; i < 3; ++i) {
        has[CSV_SPECIFIC_FORCE + i] = false;
    }
    examine();
    assert_error(DOCTOR_VELOCITY_SIGN, CSV_NU + 2, "w_mps and depth_m are both positive upwards");
    TEST_ASSERT_EQUAL_MESSAGE(1, count(DOCTOR_ERROR), doctor.finding[1].text);
    TEST_ASSERT_NULL(strstr(doctor.finding[0].text, "runs against depth"));
}

/* Zeros between the samples of a slower sensor: its averages are too small. */
static void test_velocities_that_are_zero_between_samples_do_not_accuse_pitch(void)
{
    sink_with_pitch(2.0);
    for (int k = 0; k < ROWS; ++k) {
        for (int i = 0; i < 3 && k % 3 > 0; ++i) {
            rows[k].value[CSV_NU + i] = 0.0;
        }
    }
    examine();
    assert_error(DOCTOR_OUTLIER, CSV_NU, "drop from motion to exactly 0");
    TEST_ASSERT_NULL(finding(DOCTOR_ANGLE_SIGN));
    TEST_ASSERT_NULL(finding(DOCTOR_DEPTH_SIGN));
    TEST_ASSERT_NULL(finding(DOCTOR_SCALE));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_unit_of_a_depth_is_named);
    RUN_TEST(test_a_depth_with_an_error_of_scale_has_no_other_unit_and_no_wrong_sign);
    RUN_TEST(test_a_height_in_feet_is_named_as_both);
    RUN_TEST(test_a_velocity_and_a_depth_upwards_do_not_contradict_each_other);
    RUN_TEST(test_velocities_that_are_zero_between_samples_do_not_accuse_pitch);
    return UNITY_END();
}
