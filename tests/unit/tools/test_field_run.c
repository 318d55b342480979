/* One field run: its record, and the configuration of its identifier. */
#include "field/field_run.h"

#include <math.h>
#include <string.h>

#include "unity.h"

static field_run_t run;
static field_run_config_t config;
static field_record_t record, other;
static auvid_averaged_t averaged;
static auvid_identifier_config_t cfg;
static auvid_actuation_config_t acting;

void setUp(void)
{
    field_run_defaults(&config);
    config.thrust_scale = config.dvl_scale = config.delay_s = 0.0;
}

void tearDown(void)
{
}

static void begin(field_vehicle_t vehicle, field_driver_t driver, uint64_t seed)
{
    field_defaults(&config.field, vehicle, driver, seed);
}

static void excite(field_vehicle_t vehicle, uint32_t sets)
{
    begin(vehicle, FIELD_EXCITED, 1);
    config.sets = sets;
    config.uncertain = false; /* the inputs are exact */
    config.field.length_s = 30.0 * sets;
    TEST_ASSERT_TRUE(field_run(&run, &config, &record));
}

/* ---- the identifier ---- */

static void test_the_rov_has_averaged_rows_and_fast_moments(void)
{
    begin(FIELD_ROV20, FIELD_EXCITED, 1);
    field_run_identifier(&config, &averaged, &cfg);
    TEST_ASSERT_EQUAL_PTR(&averaged.vehicle, cfg.vehicle);
    TEST_ASSERT_EQUAL_PTR(&auvid_girona500, averaged.other);
    TEST_ASSERT_EQUAL(4, cfg.metric.half_width[1]);
    field_run_actuation(&config, &acting);
    for (int i = 0; i < acting.excitation.segments; ++i) {
        if (acting.excitation.segment[i].dof == AUVID_YAW) {
            TEST_ASSERT_TRUE(acting.excitation.segment[i].hold_max_s <= AUVID_C(3.0));
        }
    }
}

static void test_a_fast_drawn_vehicle_has_averaged_rows_and_all_have_wide_bounds(void)
{
    auvid_identifier_config_t defaults;
    int fast = 0;
    auvid_identifier_defaults(&defaults, &auvid_girona500);
    for (uint64_t seed = 1; seed <= 20; ++seed) {
        field_sheet_t sheet;
        field_sheet(FIELD_ANY, seed, &sheet);
        fast += sheet.fast;
        begin(FIELD_ANY, FIELD_EXCITED, seed);
        field_run_identifier(&config, &averaged, &cfg);
        TEST_ASSERT_EQUAL_PTR(sheet.fast ? &averaged.vehicle : &auvid_girona500, cfg.vehicle);
        TEST_ASSERT_EQUAL(sheet.fast ? 4 : defaults.metric.half_width[1], cfg.metric.half_width[1]);
        TEST_ASSERT_EQUAL(sheet.fast ? 0 : defaults.metric.max_cell_us, cfg.metric.max_cell_us);
        TEST_ASSERT_TRUE(cfg.nav.max_acceleration == defaults.nav.max_acceleration);
        for (int i = 0; i < SIM_PARAMETERS; ++i) {
            TEST_ASSERT_TRUE((double)cfg.search.upper[i] > sheet.parameter[i]);
            TEST_ASSERT_TRUE((double)cfg.search.lower[i] < sheet.parameter[i]);
        }
    }
    TEST_ASSERT_TRUE(fast > 0 && fast < 20);
}

static void test_tau_max_is_the_amplitude(void)
{
    field_sheet_t sheet;
    begin(FIELD_ROV20, FIELD_EXCITED, 1);
    field_sheet(FIELD_ROV20, 1, &sheet);
    field_run_identifier(&config, &averaged, &cfg);
    for (int e = 0; e < FIELD_EQUATIONS; ++e) {
        int j = field_dof(e);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, sheet.amplitude[j], (double)cfg.metric.tau_max[j]);
    }
}

static void test_uncertainties_are_those_of_the_library_unless_given(void)
{
    auvid_identifier_config_t defaults;
    auvid_identifier_defaults(&defaults, &auvid_girona500);
    begin(FIELD_GIRONA500, FIELD_EXCITED, 1);
    config.thrust_scale = 0.125;
    config.dvl_scale = -1.0;
    field_run_identifier(&config, &averaged, &cfg);
    TEST_ASSERT_EQUAL_DOUBLE(0.125, (double)cfg.uncertainty.thrust_scale);
    TEST_ASSERT_EQUAL_DOUBLE((double)defaults.uncertainty.dvl_scale,
                             (double)cfg.uncertainty.dvl_scale);
}

static void test_only_an_excited_run_has_an_acting_half(void)
{
    excite(FIELD_GIRONA500, 1);
    TEST_ASSERT_EQUAL_PTR(&run.actuation, run.id.actuation);
    begin(FIELD_GIRONA500, FIELD_LAWNMOWER, 1);
    TEST_ASSERT_TRUE(field_run(&run, &config, &record));
    TEST_ASSERT_NULL(run.id.actuation);
}

/* ---- a run ---- */

static void assert_found(field_vehicle_t vehicle)
{
    excite(vehicle, 2);
    TEST_ASSERT_EQUAL(2, record.sets);
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        TEST_ASSERT_TRUE(record.estimated[i]);
    }
    for (int i = SIM_M_U; i <= SIM_M_R; ++i) {
        double truth = record.truth.si[i];
        TEST_ASSERT_DOUBLE_WITHIN(0.03 * truth, truth, record.pi[i]);
        TEST_ASSERT_TRUE(record.flagged[i]);
    }
    for (int d = 0; d < FIELD_DIRECTIONS; ++d) { /* drag forces of the estimate, and their truth */
        double speed = record.truth.speed[d / 2][d % 2];
        double truth = field_drag(record.truth.si, d / 2, d % 2 == 0 ? speed : -speed);
        TEST_ASSERT_TRUE(record.force[2][d].estimated);
        TEST_ASSERT_TRUE((d % 2 == 0) == (truth < 0.0));
        TEST_ASSERT_DOUBLE_WITHIN(0.1 * fabs(truth), truth, record.force[2][d].value);
    }
}

static void test_without_mismatch_the_girona500_is_identified(void)
{
    assert_found(FIELD_GIRONA500);
}

static void test_without_mismatch_the_rov_is_identified(void)
{
    assert_found(FIELD_ROV20);
}

static void test_without_mismatch_a_drawn_vehicle_is_identified(void)
{
    assert_found(FIELD_ANY);
}

static void
test_weaker_thrust_looks_like_a_heavier_vehicle_and_the_truth_for_reported_thrust_agrees(void)
{
    begin(FIELD_GIRONA500, FIELD_EXCITED, 1);
    TEST_ASSERT_TRUE(field_set(&config.field, "thrust_common", -0.2));
    config.sets = 2;
    TEST_ASSERT_TRUE(field_run(&run, &config, &record));
    double truth = record.truth.si[SIM_M_U];
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.8, record.truth.gain[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.04 * truth, truth / 0.8, record.pi[SIM_M_U]);
    TEST_ASSERT_DOUBLE_WITHIN(0.04 * truth, record.truth.reported[SIM_M_U], record.pi[SIM_M_U]);
}

static bool is_impossible(int equation)
{
    bool found = false;
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        found = found || (record.impossible[i] && field_equation(i) == equation);
    }
    return found;
}

static void test_what_discredits_an_equation_is_recorded(void)
{
    int discredited = 0;
    for (uint64_t seed = 1; seed <= 20 && discredited == 0; ++seed) {
        begin(FIELD_ROV20, FIELD_EXCITED, seed);
        TEST_ASSERT_TRUE(field_set(&config.field, "thrust_advance", 1.5)); /* eight deviations */
        TEST_ASSERT_TRUE(field_run(&run, &config, &record));
        for (int i = 0; i < SIM_PARAMETERS; ++i) {
            bool is = record.note[i] == AUVID_NOTE_DISCREDITED;
            TEST_ASSERT_TRUE(!is || is_impossible(field_equation(i)));
            discredited += is;
        }
    }
    TEST_ASSERT_TRUE(discredited > 0);
    excite(FIELD_ROV20, 2); /* without mismatch nothing is impossible */
    for (int e = 0; e < FIELD_EQUATIONS; ++e) {
        TEST_ASSERT_FALSE(is_impossible(e));
    }
}

static void test_the_same_seed_gives_the_same_record(void)
{
    begin(FIELD_ROV20, FIELD_EXCITED, 7);
    field_draw(&config.field, 1.0);
    config.sets = 1;
    TEST_ASSERT_TRUE(field_run(&run, &config, &record));
    TEST_ASSERT_TRUE(field_run(&run, &config, &other));
    TEST_ASSERT_EQUAL_MEMORY(&record, &other, sizeof record);
}

static void test_a_configuration_that_the_simulator_refuses_is_refused(void)
{
    config.field.size[0] = NAN;
    TEST_ASSERT_FALSE(field_run(&run, &config, &record));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_rov_has_averaged_rows_and_fast_moments);
    RUN_TEST(test_a_fast_drawn_vehicle_has_averaged_rows_and_all_have_wide_bounds);
    RUN_TEST(test_tau_max_is_the_amplitude);
    RUN_TEST(test_uncertainties_are_those_of_the_library_unless_given);
    RUN_TEST(test_only_an_excited_run_has_an_acting_half);
    RUN_TEST(test_without_mismatch_the_girona500_is_identified);
    RUN_TEST(test_without_mismatch_the_rov_is_identified);
    RUN_TEST(test_without_mismatch_a_drawn_vehicle_is_identified);
    RUN_TEST(
        test_weaker_thrust_looks_like_a_heavier_vehicle_and_the_truth_for_reported_thrust_agrees);
    RUN_TEST(test_what_discredits_an_equation_is_recorded);
    RUN_TEST(test_the_same_seed_gives_the_same_record);
    RUN_TEST(test_a_configuration_that_the_simulator_refuses_is_refused);
    return UNITY_END();
}
