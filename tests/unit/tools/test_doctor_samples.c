/* The log doctor on rows and samples: velocities that are absent, held or out, coarse steps, gaps,
 * slow rows, missing columns, and logs that are too short or very long. */
#include "doctor_log.h"

void setUp(void)
{
    make_log();
}

void tearDown(void)
{
}

static void test_velocities_may_be_absent_between_samples(void)
{
    for (int k = 0; k < ROWS; ++k) {
        for (int j = 0; j < 3 && k % 10 != 0; ++j) {
            rows[k].value[CSV_NU + j] = NAN;
        }
    }
    assert_clean();
}

static void test_held_velocities_are_a_warning(void)
{
    for (int k = 0; k < ROWS; ++k) {
        memcpy(&rows[k].value[CSV_NU], &rows[k - k % 10].value[CSV_NU], 3 * sizeof(double));
    }
    examine();
    TEST_ASSERT_EQUAL(0, count(DOCTOR_ERROR));
    TEST_ASSERT_NOT_NULL(finding(DOCTOR_HELD));
    TEST_ASSERT_NOT_NULL(strstr(finding(DOCTOR_HELD)->text, "for about 0.20 s"));
}

static void test_an_outage_is_told_with_its_length(void)
{
    for (int k = 2000; k < 2400; ++k) {
        memcpy(&rows[k].value[CSV_NU], &rows[2000].value[CSV_NU], 3 * sizeof(double));
    }
    examine();
    TEST_ASSERT_NOT_NULL(finding(DOCTOR_OUTAGE));
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 8.0, finding(DOCTOR_OUTAGE)->value);
    TEST_ASSERT_NOT_NULL(strstr(finding(DOCTOR_OUTAGE)->text, "t_s 140.0"));
}

/* Between samples, and where there are none, cells are empty. */
static void test_empty_cells_are_no_outage(void)
{
    for (int k = 0; k < ROWS; ++k) {
        for (int i = 0; i < 3 && (k % 10 > 0 || (k >= 2000 && k < 2400)); ++i) {
            rows[k].value[CSV_NU + i] = NAN;
        }
    }
    examine();
    TEST_ASSERT_NULL(finding(DOCTOR_OUTAGE));
    TEST_ASSERT_NULL(finding(DOCTOR_HELD));
}

static void test_samples_that_repeat_between_empty_cells_are_an_outage(void)
{
    for (int k = 0; k < ROWS; ++k) {
        for (int i = 0; i < 3; ++i) {
            double last =
                k >= 2000 && k < 2400 ? rows[2000].value[CSV_NU + i] : rows[k].value[CSV_NU + i];
            rows[k].value[CSV_NU + i] = k % 10 > 0 ? (double)NAN : last;
        }
    }
    examine();
    TEST_ASSERT_NOT_NULL(finding(DOCTOR_OUTAGE));
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 8.0, finding(DOCTOR_OUTAGE)->value);
}

static void test_a_velocity_that_is_always_zero_is_left_out(void)
{
    scale(CSV_NU + 1, 0.0);
    examine();
    TEST_ASSERT_NOT_NULL(finding(DOCTOR_STUCK));
    TEST_ASSERT_NOT_NULL(strstr(finding(DOCTOR_STUCK)->text, "v_mps is always 0, but Y_N acts"));
    TEST_ASSERT_EQUAL_HEX(1u << 1, doctor.left_out);
    TEST_ASSERT_EQUAL_STRING("usable for identification: surge, heave, roll, pitch, yaw",
                             doctor.verdict);
}

static void test_an_attitude_that_never_changes_is_an_error(void)
{
    for (int i = 0; i < 3; ++i) {
        scale(CSV_ATTITUDE + i, 0.0);
    }
    examine();
    assert_error(DOCTOR_STUCK, CSV_ATTITUDE, "the attitude never changes");
}

static void test_a_missing_column_is_a_warning(void)
{
    has[CSV_ATTITUDE + 1] = false;
    examine();
    TEST_ASSERT_TRUE(doctor_has_finding(&doctor, DOCTOR_MISSING, CSV_ATTITUDE + 1));
    TEST_ASSERT_EQUAL(0, count(DOCTOR_ERROR));
}

static void test_pulse_widths_are_named(void)
{
    for (int j = 0; j < 6; ++j) {
        for (int k = 0; k < ROWS; ++k) {
            double part = rows[k].value[CSV_WRENCH + j] / largest[j];
            rows[k].value[CSV_COMMAND + j] = 1500.0 + 200.0 * part;
        }
        has[CSV_WRENCH + j] = false;
        has[CSV_COMMAND + j] = true;
    }
    examine();
    assert_error(DOCTOR_SCALE, CSV_COMMAND, "pulse widths");
    TEST_ASSERT_NULL(finding(DOCTOR_SHORT)); /* they vary little against 1500 */
}

static void test_coarse_steps_are_told(void)
{
    for (int k = 0; k < ROWS; ++k) {
        double *u = &rows[k].value[CSV_NU];
        *u = 0.2 * floor(*u / 0.2 + 0.5);
    }
    examine();
    TEST_ASSERT_TRUE(doctor_has_finding(&doctor, DOCTOR_QUANTISED, CSV_NU));
    TEST_ASSERT_NOT_NULL(strstr(finding(DOCTOR_QUANTISED)->text, "steps of 0.2"));
    TEST_ASSERT_EQUAL_HEX(0, doctor.left_out);
}

/* From 1.1 standard deviations on. */
static void test_a_velocity_of_few_steps_is_left_out(void)
{
    double square = 0.0;
    for (int k = 0; k < ROWS; ++k) {
        square += rows[k].value[CSV_NU] * rows[k].value[CSV_NU] / ROWS;
    }
    for (int k = 0; k < ROWS; ++k) {
        double step = 1.3 * sqrt(square), *u = &rows[k].value[CSV_NU];
        *u = step * floor(*u / step + 0.5);
    }
    examine();
    TEST_ASSERT_EQUAL_HEX(1u, doctor.left_out);
    TEST_ASSERT_NOT_NULL(strstr(finding(DOCTOR_QUANTISED)->text, "and is left out"));
    TEST_ASSERT_EQUAL_STRING("usable for identification: sway, heave, roll, pitch, yaw",
                             doctor.verdict);
}

static void test_coarse_steps_to_zero_are_no_lost_lock(void)
{
    for (int k = 0; k < ROWS; ++k) {
        for (int i = 0; i < 3; ++i) {
            double *v = &rows[k].value[CSV_NU + i];
            *v = 0.2 * floor(*v / 0.2 + 0.5);
        }
    }
    examine();
    TEST_ASSERT_TRUE(doctor.drops == 0.0);
    TEST_ASSERT_NULL(finding(DOCTOR_OUTLIER));
}

static void test_a_sagging_voltage_is_told(void)
{
    has[CSV_VOLTAGE] = true;
    for (int k = 0; k < ROWS; ++k) {
        rows[k].value[CSV_VOLTAGE] = 16.8 - 3.0 * k / ROWS;
    }
    examine();
    TEST_ASSERT_NOT_NULL(finding(DOCTOR_VOLTAGE));
    TEST_ASSERT_TRUE(doctor.usable);
}

static void test_time_that_goes_back_is_an_error_and_the_row_is_skipped(void)
{
    rows[3000].value[CSV_T] = rows[100].value[CSV_T];
    rows[3000].value[CSV_NU] = 1e5;
    examine();
    assert_error(DOCTOR_TIME, CSV_T, "in 1 row, first after t_s 159.98");
    TEST_ASSERT_TRUE(doctor.column[CSV_NU].max < 10.0);
}

/* A gap of 0.8 s after every so many rows. */
static void examine_with_gaps(int every)
{
    doctor_init(&doctor, has);
    for (int k = 0; k < ROWS; ++k) {
        if (k % every >= 40) {
            doctor_feed(&doctor, &rows[k]);
        }
    }
    doctor_finish(&doctor);
}

static void test_gaps_are_counted_and_are_no_error(void)
{
    examine_with_gaps(1000);
    TEST_ASSERT_NOT_NULL(finding(DOCTOR_GAPS));
    TEST_ASSERT_NOT_NULL(strstr(finding(DOCTOR_GAPS)->text, "5 gaps"));
    TEST_ASSERT_TRUE(doctor.usable);
}

static void test_gaps_everywhere_are_an_error(void)
{
    examine_with_gaps(250);
    assert_error(DOCTOR_GAPS, CSV_T, "none is 6 s long");
}

static void examine_every(int every)
{
    doctor_init(&doctor, has);
    for (int k = 0; k < ROWS; k += every) {
        doctor_feed(&doctor, &rows[k]);
    }
    doctor_finish(&doctor);
}

static void test_slow_rows_are_an_error(void)
{
    examine_every(50);
    assert_error(DOCTOR_SLOW, CSV_T, "the rows are about 0.9");
}

static void test_rows_at_2_hz_are_a_warning_and_have_no_gap(void)
{
    examine_every(25);
    const doctor_finding_t *f = finding(DOCTOR_SLOW);
    TEST_ASSERT_NOT_NULL(f);
    TEST_ASSERT_EQUAL(DOCTOR_WARNING, f->severity);
    TEST_ASSERT_NOT_NULL(strstr(f->text, "log at 5 Hz or faster"));
    TEST_ASSERT_NULL(finding(DOCTOR_GAPS));
    examine_every(10);
    TEST_ASSERT_NULL(finding(DOCTOR_SLOW));
}

static void test_a_short_log_is_an_error(void)
{
    doctor_init(&doctor, has);
    for (int k = 0; k < 400; ++k) {
        doctor_feed(&doctor, &rows[k]);
    }
    doctor_finish(&doctor);
    assert_error(DOCTOR_SHORT, -1, "too little motion");
}

static void test_a_log_without_inputs_is_an_error(void)
{
    for (int j = 0; j < 6; ++j) {
        has[CSV_WRENCH + j] = false;
    }
    examine();
    assert_error(DOCTOR_MISSING, CSV_WRENCH, "no input column");
}

/* The rows again and again for hours: blocks double, and the range of a slip is still found. */
static void test_a_long_log_is_examined_at_constant_memory(void)
{
    doctor_init(&doctor, has);
    for (int turn = 0; turn < 90; ++turn) {
        for (int k = 0; k < ROWS; k += 5) {
            csv_row_t row = rows[k];
            row.value[CSV_T] += turn * (ROWS * STEP_S + 30.0);
            row.value[CSV_NU + 5] *= turn >= 60 ? -1.0 : 1.0;
            doctor_feed(&doctor, &row);
        }
    }
    doctor_finish(&doctor);
    TEST_ASSERT_TRUE(doctor.blocks <= DOCTOR_BLOCKS);
    assert_error(DOCTOR_RATE_SIGN, CSV_NU + 5, "r_radps has the wrong sign");
    TEST_ASSERT_DOUBLE_WITHIN(1000.0, 9100.0, finding(DOCTOR_RATE_SIGN)->from_s);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_velocities_may_be_absent_between_samples);
    RUN_TEST(test_held_velocities_are_a_warning);
    RUN_TEST(test_an_outage_is_told_with_its_length);
    RUN_TEST(test_empty_cells_are_no_outage);
    RUN_TEST(test_samples_that_repeat_between_empty_cells_are_an_outage);
    RUN_TEST(test_a_velocity_that_is_always_zero_is_left_out);
    RUN_TEST(test_an_attitude_that_never_changes_is_an_error);
    RUN_TEST(test_a_missing_column_is_a_warning);
    RUN_TEST(test_pulse_widths_are_named);
    RUN_TEST(test_coarse_steps_are_told);
    RUN_TEST(test_a_velocity_of_few_steps_is_left_out);
    RUN_TEST(test_coarse_steps_to_zero_are_no_lost_lock);
    RUN_TEST(test_a_sagging_voltage_is_told);
    RUN_TEST(test_time_that_goes_back_is_an_error_and_the_row_is_skipped);
    RUN_TEST(test_gaps_are_counted_and_are_no_error);
    RUN_TEST(test_gaps_everywhere_are_an_error);
    RUN_TEST(test_slow_rows_are_an_error);
    RUN_TEST(test_rows_at_2_hz_are_a_warning_and_have_no_gap);
    RUN_TEST(test_a_short_log_is_an_error);
    RUN_TEST(test_a_log_without_inputs_is_an_error);
    RUN_TEST(test_a_long_log_is_examined_at_constant_memory);
    return UNITY_END();
}
