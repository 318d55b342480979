/*
 * Confidence: the sentences that say what is missing, and the phrases of the notes.
 */
#include <stdio.h>
#include <string.h>

#include "auvid/detail/confidence.h"
#include "confidence_data.h"
#include "unity.h"

void setUp(void)
{
    confidence_data_defaults();
}

void tearDown(void)
{
}

static auvid_confidence_t notes;
static char text[160];

static void expect(const char *words, unsigned which)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_confidence_missing(&notes, &auvid_girona500, AUVID_G500_FREE,
                                                         which, text, sizeof text));
    TEST_ASSERT_EQUAL_STRING(words, text);
}

static void test_every_need_has_its_sentence(void)
{
    memset(&notes, 0, sizeof notes);
    notes.note[AUVID_G500_M_U] = AUVID_NOTE_NOISE;
    notes.note[AUVID_G500_M_R] = AUVID_NOTE_UNCERTAIN;
    notes.note[AUVID_G500_W_B] = AUVID_NOTE_UNCERTAIN;
    notes.note[AUVID_G500_X_U] = AUVID_NOTE_UNCERTAIN;
    notes.note[AUVID_G500_X_UU] = AUVID_NOTE_UNCERTAIN;
    notes.note[AUVID_G500_Z_W] = AUVID_NOTE_SMALL;
    notes.note[AUVID_G500_Z_WW] = AUVID_NOTE_IMPLAUSIBLE;
    notes.note[AUVID_G500_Y_VV] = AUVID_NOTE_FIXED;
    expect("surge: too little acceleration for m_u; sines of 0.1-0.3 Hz, stronger or for longer",
           0);
    expect("yaw: too little acceleration for m_r; sines of 0.1-0.3 Hz, stronger or for longer", 1);
    expect("heave: too short a record for W-B; continue recording", 2);
    expect("surge: too little slow motion for X_u; more steps held 4-8 s, some at a third of the "
           "strength",
           3);
    expect("surge: too little speed for X_uu; steps held 4-8 s, stronger or more of them", 4);
    TEST_ASSERT_EQUAL(
        AUVID_FINISHED,
        auvid_confidence_missing(&notes, &auvid_girona500, AUVID_G500_FREE, 5, text, sizeof text));
    TEST_ASSERT_EQUAL_STRING("", text);
}

static void test_an_unexplained_force_is_reported_before_any_advice_on_motion(void)
{
    memset(&notes, 0, sizeof notes);
    notes.note[AUVID_G500_M_U] = notes.note[AUVID_G500_X_U] = AUVID_NOTE_UNCERTAIN;
    notes.note[AUVID_G500_N_R] = notes.note[AUVID_G500_N_RR] = AUVID_NOTE_UNCERTAIN;
    notes.partner[AUVID_G500_N_R] = notes.partner[AUVID_G500_N_RR] = 1;
    notes.bound[AUVID_G500_N_R] = notes.bound[AUVID_G500_N_RR] = AUVID_C(0.359);
    expect("yaw: only 35 % of the force is explained; check signs, thrust, time stamps, current "
           "and cable",
           0);
    expect("surge: too little acceleration for m_u; sines of 0.1-0.3 Hz, stronger or for longer",
           1);
    expect("surge: too little slow motion for X_u; more steps held 4-8 s, some at a third of the "
           "strength",
           2);
    TEST_ASSERT_EQUAL(
        AUVID_FINISHED,
        auvid_confidence_missing(&notes, &auvid_girona500, AUVID_G500_FREE, 3, text, sizeof text));
    notes.bound[AUVID_G500_N_R] = -2;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_confidence_missing(&notes, &auvid_girona500, AUVID_G500_FREE,
                                                         0, text, sizeof text));
    TEST_ASSERT_NOT_NULL(strstr(text, "only 0 %"));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_confidence_note(&notes, &auvid_girona500, AUVID_G500_N_R,
                                                      text, sizeof text));
    TEST_ASSERT_EQUAL_STRING("most of the force is unexplained", text);
}

static void test_an_unexplained_force_never_asks_for_motion(void)
{
    observe(&(world_t){ALL, 1, 300.0, 0.0});
    for (unsigned which = 0; auvid_confidence_missing(result, &auvid_girona500, AUVID_G500_FREE,
                                                      which, text, sizeof text) == AUVID_OK;
         ++which) {
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(text, "of the force is explained"), text);
    }
    for (int i = 0; i < auvid_girona500.parameters; ++i) {
        TEST_ASSERT_TRUE(result->note[i] != AUVID_NOTE_UNCERTAIN || result->partner[i] == 1);
    }
}

static void test_a_large_part_of_rows_lost_to_gaps_is_reported(void)
{
    memset(&notes, 0, sizeof notes);
    notes.note[AUVID_G500_M_U] = AUVID_NOTE_UNCERTAIN;
    notes.lost[AUVID_SURGE] = 5;
    notes.lost[AUVID_HEAVE] = AUVID_CONFIDENCE_LOST_PERCENT - 1;
    TEST_ASSERT_EQUAL(
        AUVID_FINISHED,
        auvid_confidence_missing(&notes, &auvid_girona500, AUVID_G500_FREE, 1, text, sizeof text));
    notes.lost[AUVID_HEAVE] = 37;
    expect("heave: 37 % of the rows were lost to gaps in the record", 1);
    TEST_ASSERT_EQUAL(
        AUVID_FINISHED,
        auvid_confidence_missing(&notes, &auvid_girona500, AUVID_G500_FREE, 2, text, sizeof text));
}

static void test_a_pair_and_a_dof_have_one_sentence_each(void)
{
    memset(&notes, 0, sizeof notes);
    notes.note[AUVID_G500_X_U] = notes.note[AUVID_G500_X_UU] = AUVID_NOTE_COMBINATION;
    notes.partner[AUVID_G500_X_U] = AUVID_G500_X_UU;
    notes.partner[AUVID_G500_X_UU] = AUVID_G500_X_U;
    notes.note[AUVID_G500_M_V] = notes.note[AUVID_G500_Y_V] = notes.note[AUVID_G500_Y_VV] =
        AUVID_NOTE_NOT_EXCITED;
    notes.note[AUVID_G500_M_W] = notes.note[AUVID_G500_W_B] = AUVID_NOTE_COMBINATION;
    notes.partner[AUVID_G500_M_W] = AUVID_G500_W_B;
    notes.partner[AUVID_G500_W_B] = AUVID_G500_M_W;
    expect("sway: not excited; apply steps held 4-8 s and sines of 0.1-0.3 Hz", 0);
    expect("heave: m_w and W-B cannot be distinguished; fix one of them, or vary the motion", 1);
    expect("surge: X_u and X_uu cannot be distinguished; steps held 4-8 s at two strengths", 2);
    TEST_ASSERT_EQUAL(
        AUVID_FINISHED,
        auvid_confidence_missing(&notes, &auvid_girona500, AUVID_G500_FREE, 3, text, sizeof text));
}

static void test_a_bound_is_reported_with_its_value_and_its_dependents(void)
{
    memset(&notes, 0, sizeof notes);
    notes.note[AUVID_G500_M_V] = notes.note[AUVID_G500_Z_W] = AUVID_NOTE_AT_BOUND;
    notes.partner[AUVID_G500_M_V] = 1;
    notes.bound[AUVID_G500_M_V] = AUVID_C(300.0);
    notes.bound[AUVID_G500_Z_W] = AUVID_C(-0.05);
    notes.note[AUVID_G500_X_U] = notes.note[AUVID_G500_Y_VV] = AUVID_NOTE_BESIDE_BOUND;
    notes.partner[AUVID_G500_X_U] = notes.partner[AUVID_G500_Y_VV] = AUVID_G500_M_V;
    expect("sway: m_v is at its upper bound of 300 kg: widen it", 0);
    expect("surge: m_v at its bound also changes X_u, Y_vv", 1);
    expect("heave: Z_w is at its lower bound of -0.05 N s/m: widen it", 2);
    TEST_ASSERT_EQUAL(
        AUVID_FINISHED,
        auvid_confidence_missing(&notes, &auvid_girona500, AUVID_G500_FREE, 3, text, sizeof text));
}

static void test_numbers_in_sentences_are_those_of_printf(void)
{
    static const double numbers[] = {0,     1,        -1,   0.001,     0.5,
                                     12.25, -999.999, 1000, 65536.125, 999999};
    for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; ++k) {
        char words[100];
        memset(&notes, 0, sizeof notes);
        notes.note[AUVID_G500_M_U] = AUVID_NOTE_AT_BOUND;
        notes.bound[AUVID_G500_M_U] = (auvid_real_t)numbers[k];
        (void)snprintf(words, sizeof words, "surge: m_u is at its lower bound of %.9g kg: widen it",
                       numbers[k]);
        expect(words, 0);
    }
}

static void test_a_search_that_has_not_converged_is_reported_once(void)
{
    memset(&notes, 0, sizeof notes);
    notes.note[AUVID_G500_M_U] = notes.note[AUVID_G500_X_U] = notes.note[AUVID_G500_Y_V] =
        AUVID_NOTE_NOT_CONVERGED;
    expect("the search has not converged; narrow the bounds, or give a good start", 0);
    TEST_ASSERT_EQUAL(
        AUVID_FINISHED,
        auvid_confidence_missing(&notes, &auvid_girona500, AUVID_G500_FREE, 1, text, sizeof text));
}

static void test_before_the_first_estimate_every_dof_is_asked_for(void)
{
    static const char *const dof[] = {"surge: ", "sway: ", "heave: ", "yaw: "};
    unsigned which = 0;
    for (;
         auvid_confidence_missing(NULL, &auvid_girona500, 0, which, text, sizeof text) == AUVID_OK;
         ++which) {
        TEST_ASSERT_TRUE(which < 4);
        TEST_ASSERT_EQUAL_PTR(text, strstr(text, dof[which]));
        TEST_ASSERT_NOT_NULL(strstr(text, "not excited"));
    }
    TEST_ASSERT_EQUAL(4, which);
}

static void test_a_text_too_long_is_truncated_and_terminated(void)
{
    for (size_t size = 1; size < 60; ++size) {
        memset(text, 'x', sizeof text);
        TEST_ASSERT_EQUAL(AUVID_OK,
                          auvid_confidence_missing(NULL, &auvid_girona500, 0, 0, text, size));
        TEST_ASSERT_EQUAL(size - 1, strlen(text));
        TEST_ASSERT_EQUAL('x', text[size]);
        TEST_ASSERT_EQUAL(0, memcmp(text, "surge: not excited; apply steps held 4-8 s and sines o",
                                    size - 1 < 54 ? size - 1 : 54));
    }
}

static void expect_note(const auvid_confidence_t *c, int i, const char *expected)
{
    char text[64];
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_confidence_note(c, &auvid_girona500, i, text, sizeof text));
    TEST_ASSERT_EQUAL_STRING(expected, text);
}

static void test_a_note_names_the_partner(void)
{
    static auvid_confidence_t c;
    char text[10];
    memset(&c, 0, sizeof c);
    c.partner[AUVID_G500_X_U] = AUVID_G500_X_UU;
    c.note[AUVID_G500_X_U] = AUVID_NOTE_COMBINATION;
    expect_note(&c, AUVID_G500_X_U, "only a combination with X_uu");
    TEST_ASSERT_EQUAL(
        AUVID_OK, auvid_confidence_note(&c, &auvid_girona500, AUVID_G500_X_U, text, sizeof text));
    TEST_ASSERT_EQUAL_STRING("only a co", text);
    c.note[AUVID_G500_X_U] = AUVID_NOTE_BESIDE_BOUND;
    expect_note(&c, AUVID_G500_X_U, "depends on X_uu, at its bound");
    c.note[AUVID_G500_X_U] = AUVID_NOTE_DISCREDITED;
    expect_note(&c, AUVID_G500_X_U, "X_uu is impossible");
    c.note[AUVID_G500_X_U] = AUVID_NOTE_SMALL;
    expect_note(&c, AUVID_G500_X_U, "too small to matter");
    c.note[AUVID_G500_X_U] = AUVID_NOTE_NONE;
    expect_note(&c, AUVID_G500_X_U, "");
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_confidence_note(NULL, &auvid_girona500, 0, text, 10));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_confidence_note(&c, NULL, 0, text, 10));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_confidence_note(&c, &auvid_girona500, 0, NULL, 10));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_confidence_note(&c, &auvid_girona500, 0, text, 0));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_confidence_note(&c, &auvid_girona500, -1, text, 10));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE,
                      auvid_confidence_note(&c, &auvid_girona500, AUVID_G500_COUNT, text, 10));
}

/* X_uu is in two pairs: the sentence of X_u does not name m_u. */
static void test_what_is_missing_names_each_of_three_parameters_that_move_together(void)
{
    static auvid_confidence_t c;
    char text[128];
    const uint32_t free = 1u << AUVID_G500_M_U | 1u << AUVID_G500_X_U | 1u << AUVID_G500_X_UU;
    memset(&c, 0, sizeof c);
    c.note[AUVID_G500_M_U] = c.note[AUVID_G500_X_U] = c.note[AUVID_G500_X_UU] =
        AUVID_NOTE_COMBINATION;
    c.partner[AUVID_G500_M_U] = AUVID_G500_X_UU;
    c.partner[AUVID_G500_X_UU] = AUVID_G500_M_U;
    c.partner[AUVID_G500_X_U] = AUVID_G500_M_U;
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_confidence_missing(&c, &auvid_girona500, free, 0, text, sizeof text));
    TEST_ASSERT_NOT_NULL(strstr(text, "m_u and X_uu cannot be distinguished"));
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_confidence_missing(&c, &auvid_girona500, free, 1, text, sizeof text));
    TEST_ASSERT_NOT_NULL(strstr(text, "X_u and m_u cannot be distinguished"));
    TEST_ASSERT_EQUAL(AUVID_FINISHED,
                      auvid_confidence_missing(&c, &auvid_girona500, free, 2, text, sizeof text));
}

static void test_every_note_has_a_phrase(void)
{
    for (int a = AUVID_NOTE_FIXED; a < AUVID_NOTE_COUNT; ++a) {
        TEST_ASSERT_TRUE(strlen(auvid_note_str((auvid_note_t)a)) > 5);
        for (int b = AUVID_NOTE_NONE; b < a; ++b) {
            TEST_ASSERT_TRUE(
                strcmp(auvid_note_str((auvid_note_t)a), auvid_note_str((auvid_note_t)b)) != 0);
        }
    }
    TEST_ASSERT_EQUAL_STRING("", auvid_note_str(AUVID_NOTE_NONE));
    TEST_ASSERT_EQUAL_STRING("unknown note", auvid_note_str((auvid_note_t)77));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_need_has_its_sentence);
    RUN_TEST(test_an_unexplained_force_is_reported_before_any_advice_on_motion);
    RUN_TEST(test_an_unexplained_force_never_asks_for_motion);
    RUN_TEST(test_a_large_part_of_rows_lost_to_gaps_is_reported);
    RUN_TEST(test_a_pair_and_a_dof_have_one_sentence_each);
    RUN_TEST(test_a_bound_is_reported_with_its_value_and_its_dependents);
    RUN_TEST(test_numbers_in_sentences_are_those_of_printf);
    RUN_TEST(test_a_search_that_has_not_converged_is_reported_once);
    RUN_TEST(test_before_the_first_estimate_every_dof_is_asked_for);
    RUN_TEST(test_a_text_too_long_is_truncated_and_terminated);
    RUN_TEST(test_a_note_names_the_partner);
    RUN_TEST(test_what_is_missing_names_each_of_three_parameters_that_move_together);
    RUN_TEST(test_every_note_has_a_phrase);
    return UNITY_END();
}
