/* The log doctor on a simulated vehicle without noise: an angle that is reversed with its rate. */
#include "doctor_log.h"

void setUp(void)
{
    make_log();
}

void tearDown(void)
{
}

static void reverse_pair(int axis)
{
    scale(CSV_ATTITUDE + axis, -1.0);
    scale(CSV_NU + 3 + axis, -1.0);
}

static void without_position(void)
{
    has[CSV_POSITION] = has[CSV_POSITION + 1] = false;
}

static void test_a_heading_and_its_rate_to_port_do_not_accuse_the_moment(void)
{
    reverse_pair(2);
    assert_only(DOCTOR_FRAME, CSV_ATTITUDE + 2, "psi_rad and r_radps are both positive to port");
    TEST_ASSERT_NOT_NULL(strstr(doctor.finding[0].text, "change both signs"));
    TEST_ASSERT_NULL(finding(DOCTOR_POSITION));
    without_position(); /* roll and pitch tell it */
    assert_only(DOCTOR_FRAME, CSV_ATTITUDE + 2, "psi_rad and r_radps are both positive to port");
    TEST_ASSERT_NULL(finding(DOCTOR_ATTITUDE));
    has[CSV_ATTITUDE] = has[CSV_ATTITUDE + 1] = false; /* surge and sway tell it */
    has[CSV_POSITION + 2] = false;
    assert_only(DOCTOR_FRAME, CSV_ATTITUDE + 2, "psi_rad and r_radps are both positive to port");
}

static void test_a_yaw_input_that_is_to_port_as_well_is_named_with_them(void)
{
    reverse_pair(2);
    scale(CSV_WRENCH + 5, -1.0);
    assert_only(DOCTOR_FRAME, CSV_ATTITUDE + 2,
                "psi_rad, r_radps and the yaw input are all positive to port");
    without_position();
    assert_only(DOCTOR_FRAME, CSV_ATTITUDE + 2,
                "psi_rad, r_radps and the yaw input are all positive to port");
}

static void test_the_moment_is_named_where_roll_and_pitch_turn_with_the_heading(void)
{
    without_position();
    scale(CSV_WRENCH + 5, -1.0);
    assert_only(DOCTOR_INPUT_SIGN, CSV_WRENCH + 5, "N_Nm has the wrong sign");
}

static void test_where_nothing_decides_the_sentence_names_both(void)
{
    static const int absent[5] = {CSV_ATTITUDE, CSV_ATTITUDE + 1, CSV_WRENCH + 1, CSV_POSITION + 2,
                                  CSV_SPECIFIC_FORCE};
    without_position();
    for (int i = 0; i < 5; ++i) {
        has[absent[i]] = false;
    }
    has[CSV_SPECIFIC_FORCE + 1] = has[CSV_SPECIFIC_FORCE + 2] = false;
    reverse_pair(2);
    assert_only(DOCTOR_EITHER_SIGN, CSV_WRENCH + 5,
                "r_radps accelerates against N_Nm: its sign is wrong, or psi_rad and r_radps are "
                "both positive to port");
}

/* Then most of p is the turn of a pitched vehicle, which the heading reverses. */
static void test_a_vehicle_that_hardly_rolls_does_not_accuse_roll(void)
{
    for (int k = 0; k < ROWS; ++k) {
        double *v = rows[k].value, theta = 0.3, yaw_rate = v[CSV_NU + 5];
        double phi = 0.1 * v[CSV_ATTITUDE];
        v[CSV_ATTITUDE] = phi;
        v[CSV_ATTITUDE + 1] = theta;
        v[CSV_NU + 3] = 0.1 * v[CSV_NU + 3] - yaw_rate * sin(theta);
        v[CSV_NU + 4] = yaw_rate * cos(theta) * sin(phi);
        v[CSV_NU + 5] = yaw_rate * cos(theta) * cos(phi);
    }
    for (int i = 0; i < 3; ++i) {
        has[CSV_POSITION + i] = has[CSV_SPECIFIC_FORCE + i] = false;
    }
    reverse_pair(2);
    examine();
    assert_error(DOCTOR_FRAME, CSV_ATTITUDE + 2, "psi_rad and r_radps are both positive to port");
    TEST_ASSERT_NULL(finding(DOCTOR_ANGLE_SIGN));
    TEST_ASSERT_NULL(finding(DOCTOR_RATE_EXCHANGED));
}

static void test_depth_tells_a_pitch_and_its_rate_with_the_bow_down(void)
{
    scale(CSV_WRENCH + 4, -1.0);
    reverse_pair(1);
    has[CSV_SPECIFIC_FORCE] = has[CSV_SPECIFIC_FORCE + 2] = false;
    assert_only(DOCTOR_FRAME, CSV_ATTITUDE + 1,
                "theta_rad and q_radps are both positive with the bow down");
}

static void test_a_pair_that_nothing_else_shows_is_a_warning(void)
{
    scale(CSV_WRENCH + 3, -1.0);
    reverse_pair(0);
    without_position();
    for (int i = 0; i < 3; ++i) {
        has[CSV_SPECIFIC_FORCE + i] = false;
    }
    examine();
    const doctor_finding_t *f = finding(DOCTOR_FRAME);
    TEST_ASSERT_NOT_NULL(f);
    TEST_ASSERT_EQUAL(DOCTOR_WARNING, f->severity);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(f->text, "phi_rad and p_radps"), f->text);
    TEST_ASSERT_EQUAL_MESSAGE(0, count(DOCTOR_ERROR), doctor.finding[0].text);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_heading_and_its_rate_to_port_do_not_accuse_the_moment);
    RUN_TEST(test_a_yaw_input_that_is_to_port_as_well_is_named_with_them);
    RUN_TEST(test_the_moment_is_named_where_roll_and_pitch_turn_with_the_heading);
    RUN_TEST(test_where_nothing_decides_the_sentence_names_both);
    RUN_TEST(test_a_vehicle_that_hardly_rolls_does_not_accuse_roll);
    RUN_TEST(test_depth_tells_a_pitch_and_its_rate_with_the_bow_down);
    RUN_TEST(test_a_pair_that_nothing_else_shows_is_a_warning);
    return UNITY_END();
}
