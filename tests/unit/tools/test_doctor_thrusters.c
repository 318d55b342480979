/* The log doctor on a simulated vehicle without noise: slips of thrusters that motion does not
 * show. Those that it shows are in test_doctor_sensors.c. */
#include "doctor_thruster_log.h"

void setUp(void)
{
    make_log();
}

void tearDown(void)
{
}

/* The two thrusters of surge have equal forces: yaw hardly varies. */
static void act_alike(double difference)
{
    for (int k = 0; k < ROWS; ++k) {
        double *force = &rows[k].value[CSV_THRUSTER_N];
        double sum = force[0] + force[1];
        force[0] = 0.5 * (1.0 + difference) * sum;
        force[1] = 0.5 * (1.0 - difference) * sum;
        rows[k].value[CSV_NU + 5] = 0.0;
    }
    scale(CSV_ATTITUDE + 2, 0.0);
    has[CSV_POSITION] = has[CSV_POSITION + 1] = false;
}

static void test_a_thruster_that_always_adds_to_another_may_be_reversed_unseen(void)
{
    to_thrusters();
    act_alike(0.5);
    examine_thrusters();
    TEST_ASSERT_NOT_NULL(finding(DOCTOR_THRUSTER_HIDDEN));
    TEST_ASSERT_NOT_NULL(strstr(finding(DOCTOR_THRUSTER_HIDDEN)->text, "thruster_2_N reversed"));
}

/* Reversed, two thrusters whose forces differ by 6 % would leave a thirtieth of the force: the
 * motion shows that. */
static void test_a_reversal_that_leaves_no_force_is_not_unseen(void)
{
    to_thrusters();
    act_alike(0.03);
    examine_thrusters();
    TEST_ASSERT_NULL(finding(DOCTOR_THRUSTER_HIDDEN));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_thruster_that_always_adds_to_another_may_be_reversed_unseen);
    RUN_TEST(test_a_reversal_that_leaves_no_force_is_not_unseen);
    return UNITY_END();
}
