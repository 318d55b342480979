/*
 * Causes: each class is named where it is the only mismatch, with its sign and rough size; nothing
 * is named in a perfect world; sentences say it in words.
 */
#include <math.h>
#include <string.h>

#include "field_identify.h"
#include "identifier/auvid_identifier_internal.h"
#include "uncertain/auvid_uncertain_table_internal.h"

static auvid_causes_t causes, unchanged;
static char text[200];

void setUp(void)
{
    memset(&causes, 0, sizeof causes);
}

void tearDown(void)
{
}

/* Runs a field vehicle with up to two mismatches. */
static void identify_with(field_vehicle_t vehicle, const char *name, double size)
{
    prepare(vehicle, FIELD_EXCITED, 3);
    if (name != NULL) {
        choose(name, size);
    }
    identify();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_uncertain_causes(&run.uncertain, &causes));
}

static void test_each_class_is_named_with_sign_and_rough_size(void)
{
    static const struct {
        const char *name;
        double size;
        auvid_cause_class_t class;
        double value;
    } mismatch[] = {{"thrust_backward", 0.1, AUVID_CAUSE_CURVE, 0.1},
                    {"thrust_backward", -0.1, AUVID_CAUSE_CURVE, -0.1},
                    {"thrust_dead_band", 2.0, AUVID_CAUSE_CURVE, 2.0},
                    {"thrust_exponent", -0.1, AUVID_CAUSE_CURVE, -0.1},
                    {"thrust_advance", 0.3, AUVID_CAUSE_INFLOW, 0.3},
                    {"thrust_sag", 0.1, AUVID_CAUSE_SAG, 0.1},
                    {"thrust_lag", 0.27, AUVID_CAUSE_TIMING, 0.12},
                    {"thrust_late", 0.1, AUVID_CAUSE_TIMING, -0.1}};
    for (int vehicle = 0; vehicle < FIELD_ANY; ++vehicle) {
        for (size_t k = 0; k < sizeof mismatch / sizeof mismatch[0]; ++k) {
            identify_with((field_vehicle_t)vehicle, mismatch[k].name, mismatch[k].size);
            const auvid_cause_t *cause = &causes.cause[mismatch[k].class];
            TEST_ASSERT_TRUE_MESSAGE(causes.named > 0, mismatch[k].name);
            TEST_ASSERT_EQUAL_MESSAGE(mismatch[k].class, causes.order[0], mismatch[k].name);
            TEST_ASSERT_TRUE(cause->named && cause->sigma > 0 && cause->share > 0);
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.4 * fabs(mismatch[k].value), mismatch[k].value,
                                              (double)cause->value, mismatch[k].name);
        }
    }
}

static void test_asymmetry_and_current_have_the_right_sign(void)
{
    identify_with(FIELD_GIRONA500, "drag_asymmetry", 0.24);
    const auvid_cause_t *cause = &causes.cause[AUVID_CAUSE_ASYMMETRY];
    TEST_ASSERT_EQUAL(AUVID_CAUSE_ASYMMETRY, causes.order[0]);
    double truth = run.field.hull.asymmetry[cause->dof];
    TEST_ASSERT_DOUBLE_WITHIN(0.4 * fabs(truth), truth, (double)cause->value);
    for (int j = AUVID_SURGE; j <= AUVID_HEAVE; ++j) { /* each, not only the one that is named */
        truth = run.field.hull.asymmetry[j];
        TEST_ASSERT_DOUBLE_WITHIN(0.4 * fabs(truth), truth, (double)causes.asymmetry[j]);
        TEST_ASSERT_TRUE(causes.asymmetry_sigma[j] > 0);
    }
    identify_with(FIELD_GIRONA500, "current", 0.1);
    cause = &causes.cause[AUVID_CAUSE_CURRENT];
    TEST_ASSERT_EQUAL(AUVID_CAUSE_CURRENT, causes.order[0]);
    truth = run.field.hull.current[cause->input == AUVID_UNCERTAIN_CURRENT_Y];
    TEST_ASSERT_DOUBLE_WITHIN(0.4 * fabs(truth), truth, (double)cause->value);
}

static void test_a_dvl_elsewhere_or_later_than_told_is_named(void)
{
    static const struct {
        const char *name;
        double size;
        int input;
        auvid_cause_class_t class;
        const char *words;
    } mismatch[] = {{"dvl_arm_x", 0.1, AUVID_UNCERTAIN_ARM_X, AUVID_CAUSE_MOUNTING,
                     "further ahead than configured, by 0."},
                    {"dvl_arm_y", -0.1, AUVID_UNCERTAIN_ARM_Y, AUVID_CAUSE_MOUNTING,
                     "further to port than configured, by 0."},
                    {"dvl_latency", 0.1, AUVID_UNCERTAIN_DVL_LATE, AUVID_CAUSE_TIMING,
                     "the DVL is later than the attitude, by 0."}};
    for (size_t k = 0; k < sizeof mismatch / sizeof mismatch[0]; ++k) {
        identify_with(FIELD_ROV20, mismatch[k].name, mismatch[k].size);
        const auvid_cause_t *cause = &causes.cause[mismatch[k].class];
        TEST_ASSERT_EQUAL_MESSAGE(mismatch[k].class, causes.order[0], mismatch[k].name);
        TEST_ASSERT_EQUAL_MESSAGE(mismatch[k].input, cause->input, mismatch[k].name);
        TEST_ASSERT_DOUBLE_WITHIN(0.02, mismatch[k].size, (double)cause->value);
        TEST_ASSERT_EQUAL(AUVID_OK,
                          auvid_causes_sentence(&causes, &auvid_girona500, 0, text, sizeof text));
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(text, mismatch[k].words), text);
    }
}

/* A set of weaker thrust is evidence for another vehicle, but not if a sag explains it. */
static void test_a_certain_sag_is_no_change_of_the_vehicle(void)
{
    for (int vehicle = 0; vehicle < FIELD_ANY; ++vehicle) {
        identify_with((field_vehicle_t)vehicle, "thrust_sag", 0.1);
        TEST_ASSERT_EQUAL(0, record.changed);
        TEST_ASSERT_TRUE(record.flagged[AUVID_G500_X_UU]);
        field.uncertain = false; /* nothing explains it */
        identify();
        TEST_ASSERT_TRUE(record.changed > 0);
        field.uncertain = true;
        field.sets = 7; /* the last one is evidence */
        field.field.length_s = 210.0;
        identify();
        TEST_ASSERT_EQUAL(0, record.changed);
        double sag = (double)run.change.statistic.sag;
        TEST_ASSERT_DOUBLE_WITHIN(0.2 * 0.1 / 7.0, 0.1 / 7.0, sag);
    }
}

static void test_a_change_of_the_vehicle_is_no_sag(void)
{
    static const double kg[] = {60.0, 6.0}, sag[] = {0.0, 0.1};
    for (int k = 0; k < 2 * FIELD_ANY; ++k) {
        prepare((field_vehicle_t)(k / 2), FIELD_EXCITED, 3);
        field.sets = 7;
        field.field.length_s = 420.0; /* ballast is in the last set */
        choose("ballast", kg[k / 2]);
        choose("thrust_sag", sag[k % 2]);
        identify();
        TEST_ASSERT_NOT_EQUAL(0, run.id.change_test.changed);
        double used = (double)run.change.statistic.sag;
        TEST_ASSERT_TRUE(k % 2 > 0 ? used > 0.0 : used == 0.0);
    }
}

/* It only explains evidence, and does not make it. */
static void test_a_sag_counts_only_where_there_is_evidence(void)
{
    prepare(FIELD_GIRONA500, FIELD_EXCITED, 3);
    choose("thrust_sag", 0.07);
    choose("disturbance", 1.0);
    identify();
    const auvid_cause_t *sag = &run.uncertain.causes.cause[AUVID_CAUSE_SAG];
    TEST_ASSERT_TRUE(sag->value > AUVID_CAUSE_SIGMAS * sag->sigma); /* certain */
    TEST_ASSERT_TRUE(run.change.statistic.sag == 0);
}

static void test_nothing_is_named_in_a_perfect_world(void)
{
    for (int vehicle = 0; vehicle < FIELD_ANY; ++vehicle) {
        identify_with((field_vehicle_t)vehicle, NULL, 0.0);
        TEST_ASSERT_EQUAL(0, causes.named);
        for (int class = 0; class < AUVID_CAUSE_COUNT; ++class) {
            TEST_ASSERT_FALSE(causes.cause[class].named);
            TEST_ASSERT_TRUE(causes.cause[class].sigma > 0); /* yet each is estimated */
        }
        TEST_ASSERT_EQUAL(AUVID_FINISHED,
                          auvid_causes_sentence(&causes, &auvid_girona500, 0, text, sizeof text));
    }
}

static void test_the_scale_of_the_thrust_is_never_named(void)
{
    identify_with(FIELD_ROV20, "thrust_common", -0.2);
    TEST_ASSERT_EQUAL(0, causes.named);
}

static void test_estimates_that_differ_are_listed(void)
{
    identify_with(FIELD_ROV20, "thrust_advance", 0.36);
    const auvid_estimate_t *with = auvid_identifier_estimate(&run.id), *plain = &run.id.estimate;
    TEST_ASSERT_NOT_EQUAL(0, causes.differs);
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        double half =
            2.1 * fmax((double)with->confidence.sigma[i], (double)plain->confidence.sigma[i]);
        TEST_ASSERT_EQUAL(fabs((double)(with->pi[i] - plain->pi[i])) > half,
                          causes.differs >> i & 1u);
    }
}

static void test_causes_stay_while_the_next_solution_is_under_way(void)
{
    identify_with(FIELD_GIRONA500, "thrust_backward", 0.1);
    TEST_ASSERT_EQUAL_UINT32(run.id.estimate.number, causes.number);
    unchanged = causes;
    memset(&run.uncertain.work, 0, sizeof run.uncertain.work);
    run.uncertain.work.solving = true;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_uncertain_causes(&run.uncertain, &causes));
    TEST_ASSERT_EQUAL_MEMORY(&unchanged, &causes, sizeof causes);
}

static void test_after_a_change_of_the_vehicle_there_are_none(void)
{
    identify_with(FIELD_GIRONA500, "thrust_backward", 0.1);
    identifier_discard_uncertain(&run.id);
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_uncertain_causes(&run.uncertain, &causes));
    TEST_ASSERT_EQUAL_UINT32(0, run.uncertain.causes.named); /* what a node reports */
}

/* ---- words ---- */

static void expect(const char *words, unsigned which)
{
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_causes_sentence(&causes, &auvid_girona500, which, text, sizeof text));
    TEST_ASSERT_EQUAL_STRING(words, text);
}

static void test_sentences_give_size_and_remedy(void)
{
    identify_with(FIELD_GIRONA500, "thrust_backward", 0.1);
    causes.differs = 1u << AUVID_G500_M_U | 1u << AUVID_G500_X_UU;
    expect("backward thrust is weaker than supplied, by 10 % or so; measure the thrusters astern",
           0);
    expect("the estimate with exact inputs differs by more than both half-widths: m_u, X_uu", 1);
    TEST_ASSERT_EQUAL(AUVID_FINISHED,
                      auvid_causes_sentence(&causes, &auvid_girona500, 2, text, sizeof text));
    TEST_ASSERT_EQUAL_STRING("", text);
    causes.cause[AUVID_CAUSE_CURVE].value = AUVID_C(-0.068);
    expect("backward thrust is stronger than supplied, by 7 % or so; measure the thrusters astern",
           0);
    causes.cause[AUVID_CAUSE_CURVE].value = AUVID_C(0.0997);
    expect("backward thrust is weaker than supplied, by 10 % or so; measure the thrusters astern",
           0);
    for (size_t size = 1; size < 60; ++size) {
        memset(text, 'x', sizeof text);
        TEST_ASSERT_EQUAL(AUVID_OK,
                          auvid_causes_sentence(&causes, &auvid_girona500, 0, text, size));
        TEST_ASSERT_EQUAL(size - 1, strlen(text));
        TEST_ASSERT_EQUAL('x', text[size]);
    }
}

static void test_every_named_input_has_a_sentence(void)
{
    static const char *const mismatch[] = {
        "thrust_dead_band", "thrust_exponent", "thrust_advance", "thrust_lag", "drag_asymmetry",
        "current",          "cross",           "cg_x",           "cg_y"};
    static const double size[] = {4.0, 0.1, 0.3, 0.27, 0.24, 0.1, 0.3, 0.02, 0.02};
    static const char *const words[] = {"dead band", "exponent", "falls with speed",
                                        "later",     "drag is",  "current sets",
                                        "coupled",   "ahead",    "to starboard"};
    for (size_t k = 0; k < sizeof mismatch / sizeof mismatch[0]; ++k) {
        identify_with(FIELD_GIRONA500, mismatch[k], size[k]);
        TEST_ASSERT_EQUAL(AUVID_OK,
                          auvid_causes_sentence(&causes, &auvid_girona500, 0, text, sizeof text));
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(text, words[k]), text);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(text, "; "), text);
    }
}

static void expect_of(int input, double value, const char *words)
{
    causes.named = 1;
    causes.order[0] = 0;
    causes.cause[0] = (auvid_cause_t){.value = (auvid_real_t)value, .input = (uint8_t)input};
    expect(words, 0);
}

static void test_a_sentence_says_the_direction(void)
{
    expect_of(AUVID_UNCERTAIN_FILTER, 0.1,
              "the velocity is filtered in the world's axes, with a time constant of 0.1 s or so; "
              "supply that of the DVL");
    expect_of(AUVID_UNCERTAIN_FILTER, -0.1,
              "the velocity leads in the world's axes, by 0.1 s or so; supply that of the DVL");
    expect_of(INPUT_FORCE, 20.0,
              "surge: a constant force acts, of 20 N or so; check lever arms and mounting of DVL "
              "and IMU");
    expect_of(INPUT_FORCE, -20.0,
              "surge: a constant force acts, of -20 N or so; check lever arms and mounting of DVL "
              "and IMU");
    expect_of(INPUT_LIFT, -1.0,
              "surge: the hull has lift; check lever arms and mounting of DVL and IMU");
}

/* ---- statuses ---- */

static void test_refusals_change_nothing(void)
{
    identify_with(FIELD_GIRONA500, NULL, 0.0);
    unchanged = causes;
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_uncertain_causes(NULL, &causes));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_uncertain_causes(&run.uncertain, NULL));
    run.uncertain.causes.number = 0;
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_uncertain_causes(&run.uncertain, &causes));
    TEST_ASSERT_EQUAL_MEMORY(&unchanged, &causes, sizeof causes);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL,
                      auvid_causes_sentence(NULL, &auvid_girona500, 0, text, sizeof text));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_causes_sentence(&causes, NULL, 0, text, sizeof text));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL,
                      auvid_causes_sentence(&causes, &auvid_girona500, 0, NULL, sizeof text));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE,
                      auvid_causes_sentence(&causes, &auvid_girona500, 0, text, 0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_each_class_is_named_with_sign_and_rough_size);
    RUN_TEST(test_asymmetry_and_current_have_the_right_sign);
    RUN_TEST(test_a_dvl_elsewhere_or_later_than_told_is_named);
    RUN_TEST(test_a_certain_sag_is_no_change_of_the_vehicle);
    RUN_TEST(test_a_change_of_the_vehicle_is_no_sag);
    RUN_TEST(test_a_sag_counts_only_where_there_is_evidence);
    RUN_TEST(test_nothing_is_named_in_a_perfect_world);
    RUN_TEST(test_the_scale_of_the_thrust_is_never_named);
    RUN_TEST(test_estimates_that_differ_are_listed);
    RUN_TEST(test_causes_stay_while_the_next_solution_is_under_way);
    RUN_TEST(test_after_a_change_of_the_vehicle_there_are_none);
    RUN_TEST(test_sentences_give_size_and_remedy);
    RUN_TEST(test_every_named_input_has_a_sentence);
    RUN_TEST(test_a_sentence_says_the_direction);
    RUN_TEST(test_refusals_change_nothing);
    return UNITY_END();
}
