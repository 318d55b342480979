/*
 * Wrong inputs on the bus: a node reports the causes, and a receiver says the same words.
 */
#include <string.h>

#include "auvid/node.h"
#include "uncertain/auvid_uncertain_parts_internal.h"
#include "unity.h"

enum { CYCLE = 50, LONGEST = 200 };

static auvid_node_t node;
static auvid_uncertain_t uncertain;
static auvid_causes_t received;
static auvid_can_message_t message[CYCLE * AUVID_NODE_FRAMES]; /* on wrong inputs, of one cycle */
static int messages;

static void begin(bool attached)
{
    static auvid_identifier_config_t identifier;
    auvid_node_config_t cfg;
    auvid_uncertain_config_t inputs;
    auvid_identifier_defaults(&identifier, &auvid_girona500);
    auvid_node_defaults(&cfg);
    auvid_uncertain_defaults(&inputs);
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_node_init(&node, &cfg, &auvid_allocation_girona500, &identifier));
    if (attached) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_attach_uncertain(&node, &uncertain, &inputs));
    }
}

void setUp(void)
{
    memset(&received, 0, sizeof received);
    begin(true);
    uncertain.causes.number = 130;
}

void tearDown(void)
{
}

/* A class of causes that is named, after those named before. */
static void name_cause(auvid_cause_class_t class, int input, auvid_dof_t dof, auvid_real_t value)
{
    auvid_causes_t *c = &uncertain.causes;
    auvid_real_t share = AUVID_C(0.3) - AUVID_C(0.04) * (auvid_real_t)c->named;
    c->cause[class] = (auvid_cause_t){.value = value,
                                      .sigma = AUVID_C(0.01),
                                      .share = share,
                                      .input = (uint8_t)input,
                                      .dof = (uint8_t)dof,
                                      .named = true};
    c->order[c->named++] = (uint8_t) class;
}

/* All seven. */
static void name_all(void)
{
    name_cause(AUVID_CAUSE_CURRENT, AUVID_UNCERTAIN_CURRENT_Y, AUVID_SWAY, AUVID_C(-0.1));
    name_cause(AUVID_CAUSE_TIMING, INPUT_DELAY, AUVID_YAW, AUVID_C(0.12));
    name_cause(AUVID_CAUSE_CURVE, AUVID_UNCERTAIN_DEAD_BAND, AUVID_SURGE, AUVID_C(2.5));
    name_cause(AUVID_CAUSE_SAG, AUVID_UNCERTAIN_SAG, AUVID_HEAVE, AUVID_C(0.08));
    name_cause(AUVID_CAUSE_MOUNTING, INPUT_FORCE, AUVID_YAW, AUVID_C(-1.5));
    name_cause(AUVID_CAUSE_ASYMMETRY, INPUT_ASYMMETRY, AUVID_SURGE, AUVID_C(0.2));
    name_cause(AUVID_CAUSE_INFLOW, AUVID_UNCERTAIN_INFLOW, AUVID_SURGE, AUVID_C(0.3));
}

/* Collects what the node reports in a second. */
static void report(void)
{
    auvid_can_frame_t frame[AUVID_NODE_FRAMES];
    int count;
    messages = 0;
    for (int tick = 0; tick < CYCLE; ++tick) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_report(&node, 0, frame, &count));
        for (int i = 0; i < count; ++i) {
            auvid_can_message_t *m = &message[messages];
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_unpack(NULL, &frame[i], m));
            messages += m->kind == AUVID_CAN_WRONG_INPUTS || m->kind == AUVID_CAN_WRONG_INPUT;
        }
    }
}

/* A receiver hears the node for some seconds. */
static void listen(int seconds)
{
    for (int s = 0; s < seconds; ++s) {
        report();
        for (int i = 0; i < messages; ++i) {
            TEST_ASSERT_TRUE(auvid_causes_take(&received, &message[i]) >= 0);
        }
    }
}

static void expect_the_same_words(void)
{
    char ours[LONGEST], theirs[LONGEST];
    auvid_status_t status = AUVID_OK;
    for (unsigned k = 0; status == AUVID_OK; ++k) {
        status = auvid_causes_sentence(&uncertain.causes, &auvid_girona500, k, ours, LONGEST);
        TEST_ASSERT_EQUAL(status,
                          auvid_causes_sentence(&received, &auvid_girona500, k, theirs, LONGEST));
        TEST_ASSERT_EQUAL_STRING(ours, theirs);
    }
}

/* ---- the node ---- */

static void test_the_reports_cycle_through_the_named_classes(void)
{
    name_all();
    uncertain.causes.differs = 0x80000005u;
    report();
    TEST_ASSERT_EQUAL(10, messages);
    for (int i = 0; i < messages; i += 2) {
        const auvid_can_wrong_inputs_t *all = &message[i].as.wrong_inputs;
        const auvid_can_wrong_input_t *one = &message[i + 1].as.wrong_input;
        const auvid_cause_t *cause = &uncertain.causes.cause[uncertain.causes.order[i / 2]];
        TEST_ASSERT_EQUAL(AUVID_CAN_WRONG_INPUTS, message[i].kind);
        TEST_ASSERT_EQUAL_HEX32(0, all->flags);
        TEST_ASSERT_EQUAL_UINT32(130 - 127, all->number);
        TEST_ASSERT_EQUAL_UINT32(7, all->named);
        TEST_ASSERT_EQUAL_HEX32(0x80000005u, all->differs);
        TEST_ASSERT_EQUAL(AUVID_CAN_WRONG_INPUT, message[i + 1].kind);
        TEST_ASSERT_EQUAL_UINT32((130 - 127) % 4, one->number);
        TEST_ASSERT_EQUAL_UINT32(i / 2, one->rank);
        TEST_ASSERT_EQUAL_UINT32(cause->dof, one->dof);
        TEST_ASSERT_EQUAL_UINT32(30 - 4 * (i / 2), one->share);
        TEST_ASSERT_EQUAL_FLOAT((float)cause->value, (float)one->value);
    }
    TEST_ASSERT_EQUAL_UINT32(AUVID_CAN_INPUT_CURRENT_EAST, message[1].as.wrong_input.input);
    TEST_ASSERT_EQUAL_UINT32(AUVID_CAN_INPUT_TIMING_DELAY, message[3].as.wrong_input.input);
    TEST_ASSERT_EQUAL_UINT32(AUVID_CAN_INPUT_CURVE_DEAD_BAND, message[5].as.wrong_input.input);
    TEST_ASSERT_EQUAL_UINT32(AUVID_CAN_INPUT_MOUNTING_FORCE, message[9].as.wrong_input.input);
    report();
    for (int i = 1; i < messages; i += 2) {
        TEST_ASSERT_EQUAL_UINT32((5 + i / 2) % 7, message[i].as.wrong_input.rank);
    }
}

/* Surge at 0.3, 0.6 and 1 of its speeds, forward, then backward, as auvid_causes_drag says. */
static void test_the_reported_drag_is_that_of_each_direction(void)
{
    auvid_can_frame_t frame[AUVID_NODE_FRAMES];
    auvid_estimate_t *e = &uncertain.estimate;
    int count, points = 0;
    e->number = uncertain.causes.number;
    e->excited = 1u << AUVID_SURGE;
    e->speed[AUVID_SURGE][0] = AUVID_C(1.0);
    e->speed[AUVID_SURGE][1] = AUVID_C(0.5);
    e->pi[AUVID_G500_X_UU] = AUVID_C(-100.0);
    uncertain.causes.asymmetry[AUVID_SURGE] = AUVID_C(0.1);
    uncertain.causes.asymmetry_sigma[AUVID_SURGE] = AUVID_C(0.01);
    uncertain.causes.one_way[AUVID_SURGE][0][1] = AUVID_C(1.0);
    uncertain.causes.one_way[AUVID_SURGE][1][1] = AUVID_C(1.0);
    for (int tick = 0; tick < 24 * CYCLE && points < 6; ++tick) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_report(&node, 0, frame, &count));
        for (int i = 0; i < count; ++i) {
            auvid_can_message_t m;
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_unpack(NULL, &frame[i], &m));
            if (m.kind == AUVID_CAN_DRAG && m.as.drag.point < 6) {
                static const double expected[6] = {-9.9, -39.6, -110.0, 2.025, 8.1, 22.5};
                TEST_ASSERT_EQUAL_UINT32(points++, m.as.drag.point);
                TEST_ASSERT_FLOAT_WITHIN(1e-4, expected[m.as.drag.point], m.as.drag.force);
            }
        }
    }
    TEST_ASSERT_EQUAL(6, points);
    e->number = 0;
}

static void test_a_share_of_more_than_127_per_cent_is_sent_as_127(void)
{
    name_cause(AUVID_CAUSE_CURRENT, AUVID_UNCERTAIN_CURRENT_X, AUVID_SURGE, AUVID_C(9.0));
    uncertain.causes.cause[AUVID_CAUSE_CURRENT].share = AUVID_C(1e9);
    report();
    TEST_ASSERT_EQUAL_UINT32(127, message[1].as.wrong_input.share);
    TEST_ASSERT_EQUAL_UINT32(0, node.sender.saturated);
}

static void test_before_the_first_solution_nothing_is_reported_as_wrong(void)
{
    uncertain.causes.number = 0;
    report();
    TEST_ASSERT_EQUAL(5, messages);
    TEST_ASSERT_EQUAL(AUVID_CAN_WRONG_INPUTS, message[0].kind);
    TEST_ASSERT_EQUAL_UINT32(0, message[0].as.wrong_inputs.number);
    TEST_ASSERT_EQUAL_UINT32(0, message[0].as.wrong_inputs.named);
}

static void test_a_node_without_uncertain_inputs_does_not_report_them(void)
{
    begin(false);
    report();
    TEST_ASSERT_EQUAL(0, messages);
}

/* ---- the receiver ---- */

static void test_a_receiver_says_the_same_words_on_every_input(void)
{
    for (int input = 0; input < INPUTS; ++input) {
        auvid_cause_class_t class = auvid_uncertain_row(input)->class;
        for (int dof = 0; dof < AUVID_DOF_COUNT && class < AUVID_CAUSE_COUNT; ++dof) {
            setUp();
            memset(&uncertain.causes, 0, sizeof uncertain.causes);
            uncertain.causes.number = 1;
            name_cause(class, input, (auvid_dof_t)dof, AUVID_C(0.25));
            listen(1);
            TEST_ASSERT_EQUAL(1, received.named);
            TEST_ASSERT_EQUAL(class, received.order[0]);
            TEST_ASSERT_EQUAL(dof, received.cause[class].dof);
            expect_the_same_words();
        }
    }
}

static void test_a_receiver_says_all_the_same_words_within_three_seconds(void)
{
    name_all();
    uncertain.causes.differs = 1u << AUVID_G500_M_U | 1u << AUVID_G500_X_UU;
    for (uint8_t first = 0; first < 7; ++first) { /* it may begin to listen at any time */
        memset(&received, 0, sizeof received);
        node.next.cause = first;
        listen(3);
        TEST_ASSERT_EQUAL(7, received.named);
        TEST_ASSERT_EQUAL_UINT32(130 - 127, received.number);
        expect_the_same_words();
    }
}

static void test_contradicted_inputs_and_wrong_forces_are_told_apart(void)
{
    for (int k = 0; k < 3; ++k) {
        uncertain.causes.contradicted = k == 1;
        uncertain.causes.thrust_differs = k == 2;
        listen(1);
        TEST_ASSERT_EQUAL(k == 1, received.contradicted);
        TEST_ASSERT_EQUAL(k == 2, received.thrust_differs);
        expect_the_same_words();
    }
}

static void test_a_new_estimate_replaces_the_causes_of_the_last_one(void)
{
    name_all();
    listen(3);
    memset(&uncertain.causes, 0, sizeof uncertain.causes);
    uncertain.causes.number = 131;
    name_cause(AUVID_CAUSE_INFLOW, AUVID_UNCERTAIN_INFLOW, AUVID_SWAY, AUVID_C(0.2));
    listen(1);
    TEST_ASSERT_EQUAL(1, received.named);
    TEST_ASSERT_FALSE(received.cause[AUVID_CAUSE_CURRENT].named);
    expect_the_same_words();
    uncertain.causes.named = 0; /* a restarted node counts from the same number */
    listen(1);
    expect_the_same_words();
}

static void test_a_class_whose_predecessor_is_missing_waits(void)
{
    name_all();
    report();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_causes_take(&received, &message[0]));
    TEST_ASSERT_EQUAL(AUVID_UNUSED, auvid_causes_take(&received, &message[3])); /* the second */
    TEST_ASSERT_EQUAL(0, received.named);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_causes_take(&received, &message[1]));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_causes_take(&received, &message[3]));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_causes_take(&received, &message[3]));
    TEST_ASSERT_EQUAL(2, received.named);
}

static void test_messages_that_are_not_used_change_nothing(void)
{
    auvid_causes_t before;
    name_all();
    listen(3);
    before = received;
    auvid_can_message_t other = {.kind = AUVID_CAN_ESTIMATE}, of_rank = message[1];
    auvid_can_message_t of_number = message[1], absent = message[1];
    of_rank.as.wrong_input.rank = 7;
    of_number.as.wrong_input.number ^= 1u;
    absent.absent = AUVID_CAN_WRONG_INPUT_NO_VALUE;
    auvid_can_message_t of_input = message[1], of_dof = message[1]; /* not as unpacked */
    of_input.as.wrong_input.input = AUVID_CAN_INPUT_TIMING_FILTER + 1;
    of_dof.as.wrong_input.dof = AUVID_DOF_COUNT;
    TEST_ASSERT_EQUAL(AUVID_UNUSED, auvid_causes_take(&received, &of_input));
    TEST_ASSERT_EQUAL(AUVID_UNUSED, auvid_causes_take(&received, &of_dof));
    TEST_ASSERT_EQUAL(AUVID_UNUSED, auvid_causes_take(&received, &other));
    TEST_ASSERT_EQUAL(AUVID_UNUSED, auvid_causes_take(&received, &of_rank));
    TEST_ASSERT_EQUAL(AUVID_UNUSED, auvid_causes_take(&received, &of_number));
    TEST_ASSERT_EQUAL(AUVID_UNUSED, auvid_causes_take(&received, &absent));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_causes_take(NULL, &other));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_causes_take(&received, NULL));
    TEST_ASSERT_EQUAL_MEMORY(&before, &received, sizeof before);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_reports_cycle_through_the_named_classes);
    RUN_TEST(test_the_reported_drag_is_that_of_each_direction);
    RUN_TEST(test_a_share_of_more_than_127_per_cent_is_sent_as_127);
    RUN_TEST(test_before_the_first_solution_nothing_is_reported_as_wrong);
    RUN_TEST(test_a_node_without_uncertain_inputs_does_not_report_them);
    RUN_TEST(test_a_receiver_says_the_same_words_on_every_input);
    RUN_TEST(test_a_receiver_says_all_the_same_words_within_three_seconds);
    RUN_TEST(test_contradicted_inputs_and_wrong_forces_are_told_apart);
    RUN_TEST(test_a_new_estimate_replaces_the_causes_of_the_last_one);
    RUN_TEST(test_a_class_whose_predecessor_is_missing_waits);
    RUN_TEST(test_messages_that_are_not_used_change_nothing);
    return UNITY_END();
}
