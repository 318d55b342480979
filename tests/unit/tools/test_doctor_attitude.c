/* The log doctor on a simulated vehicle without noise: attitude against p, q, r. */
#include "doctor_log.h"

void setUp(void)
{
    make_log();
}

void tearDown(void)
{
}

/* A vehicle that hardly rolls, but turns while it is pitched by trim: most of p is that turn. */
static void pitch_by_trim(void)
{
    for (int k = 0; k < ROWS; ++k) {
        double *v = rows[k].value, theta = 0.3, yaw_rate = v[CSV_NU + 5];
        double phi = 0.02 * v[CSV_ATTITUDE];
        v[CSV_ATTITUDE] = phi;
        v[CSV_ATTITUDE + 1] = theta;
        v[CSV_NU + 3] = 0.02 * v[CSV_NU + 3] - yaw_rate * sin(theta);
        v[CSV_NU + 4] = yaw_rate * cos(theta) * sin(phi);
        v[CSV_NU + 5] = yaw_rate * cos(theta) * cos(phi);
    }
    has[CSV_POSITION] = has[CSV_POSITION + 1] = has[CSV_POSITION + 2] = false;
    has[CSV_SPECIFIC_FORCE] = has[CSV_SPECIFIC_FORCE + 1] = has[CSV_SPECIFIC_FORCE + 2] = false;
}

static void test_a_missing_heading_is_not_a_heading_that_stands_still(void)
{
    pitch_by_trim();
    has[CSV_ATTITUDE + 2] = false;
    examine();
    TEST_ASSERT_EQUAL_MESSAGE(0, count(DOCTOR_ERROR), doctor.finding[0].text);
    doctor_sums_t all;
    doctor_sum(&doctor, 0, doctor.blocks - 1, &all);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.0, doctor_discord(&all.turn[0][0][0], 1.0));
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 1.0, doctor_correlation(&all.turn[0][0][0]));
}

static void test_without_heading_a_reversed_angle_is_named(void)
{
    has[CSV_ATTITUDE + 2] = false;
    assert_clean();
    scale(CSV_ATTITUDE, -1.0);
    examine();
    assert_error(DOCTOR_ANGLE_SIGN, CSV_ATTITUDE, "phi_rad changes against p_radps");
    scale(CSV_ATTITUDE, -1.0);
    scale(CSV_ATTITUDE + 1, -1.0);
    examine();
    assert_error(DOCTOR_ANGLE_SIGN, CSV_ATTITUDE + 1, "theta_rad changes against q_radps");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_missing_heading_is_not_a_heading_that_stands_still);
    RUN_TEST(test_without_heading_a_reversed_angle_is_named);
    return UNITY_END();
}
