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

/* A vehicle that loops and hardly rolls: upright, its angles of roll and heading change by half a
 * circle from one row to the next. */
static void loop(void)
{
    double b[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}; /* body axes in the world */
    for (int k = 0; k < ROWS; ++k) {
        double *v = rows[k].value, t = k * STEP_S;
        const double rate[3] = {0.002 * sin(0.5 * t), 0.3, 0.0};
        for (int i = 0; i < 3; ++i) { /* first order, each axis */
            int next = (i + 1) % 3, last = (i + 2) % 3;
            double c = cos(rate[i] * STEP_S), s = sin(rate[i] * STEP_S);
            for (int m = 0; m < 3; ++m) {
                double x = b[next][m], y = b[last][m];
                b[next][m] = c * x + s * y;
                b[last][m] = c * y - s * x;
            }
            v[CSV_NU + 3 + i] = rate[i];
        }
        v[CSV_ATTITUDE] = atan2(b[1][2], b[2][2]);
        v[CSV_ATTITUDE + 1] = -asin(fmax(-1.0, fmin(b[0][2], 1.0)));
        v[CSV_ATTITUDE + 2] = atan2(b[0][1], b[0][0]);
    }
    for (int i = 0; i < 3; ++i) {
        has[CSV_POSITION + i] = has[CSV_SPECIFIC_FORCE + i] = false;
    }
}

static void test_a_vehicle_that_loops_turns_with_its_rates(void)
{
    doctor_sums_t all;
    loop();
    examine();
    doctor_sum(&doctor, 0, doctor.blocks - 1, &all);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 0.0, doctor_discord(&all.turn[0][0][0], 1.0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_missing_heading_is_not_a_heading_that_stands_still);
    RUN_TEST(test_without_heading_a_reversed_angle_is_named);
    RUN_TEST(test_a_vehicle_that_loops_turns_with_its_rates);
    return UNITY_END();
}
