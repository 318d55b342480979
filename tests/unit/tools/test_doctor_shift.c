/* The log doctor on a simulated vehicle without noise: a part of the motion that is late. Inputs
 * that are late against all of it are in test_doctor.c. */
#include "doctor_log.h"

void setUp(void)
{
    make_log();
}

void tearDown(void)
{
}

static void assert_late(int column, double by_s, const char *words)
{
    examine();
    const doctor_finding_t *f = finding(DOCTOR_VELOCITY_SHIFT);
    TEST_ASSERT_NOT_NULL_MESSAGE(f, words);
    TEST_ASSERT_EQUAL(DOCTOR_WARNING, f->severity);
    TEST_ASSERT_EQUAL(column, f->column);
    TEST_ASSERT_DOUBLE_WITHIN(0.11, by_s, f->value);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(f->text, words), f->text);
    TEST_ASSERT_NULL(finding(DOCTOR_INPUT_SHIFT));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, doctor.shift_s);
    TEST_ASSERT_EQUAL_MESSAGE(0, count(DOCTOR_ERROR), doctor.finding[0].text);
}

/* If fit shifted the inputs, yaw would be wrong instead. */
static void test_a_late_velocity_sensor_does_not_shift_the_inputs(void)
{
    static const int rows_late[3] = {20, 25, 50};
    for (int i = 0; i < 3; ++i) {
        make_log();
        delay(CSV_NU, CSV_NU + 2, rows_late[i]);
        assert_late(CSV_NU, STEP_S * rows_late[i], "u_mps, v_mps, w_mps are later than r_radps");
        TEST_ASSERT_NOT_NULL(strstr(finding(DOCTOR_VELOCITY_SHIFT)->text, "the DVL are late"));
    }
}

static void test_late_rates_do_not_shift_the_inputs_either(void)
{
    delay(CSV_NU + 3, CSV_NU + 5, 25);
    delay(CSV_ATTITUDE, CSV_ATTITUDE + 2, 25);
    assert_late(CSV_NU + 5, -0.5, "r_radps is later than u_mps, v_mps, w_mps");
}

static void test_a_small_delay_of_the_velocity_sensor_is_not_named(void)
{
    delay(CSV_NU, CSV_NU + 2, 5);
    examine();
    TEST_ASSERT_NULL(finding(DOCTOR_VELOCITY_SHIFT));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_late_velocity_sensor_does_not_shift_the_inputs);
    RUN_TEST(test_late_rates_do_not_shift_the_inputs_either);
    RUN_TEST(test_a_small_delay_of_the_velocity_sensor_is_not_named);
    return UNITY_END();
}
