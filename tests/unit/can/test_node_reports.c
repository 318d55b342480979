/*
 * What a node records of its thrusters and sends: commands and reports.
 */
#include "node_frames.h"

/* ---- thrust ---- */

static struct {
    int calls;
    uint64_t t_us;
    auvid_real_t command[AUVID_MAX_COMMANDS];
} heard;

static void hear(void *context, uint64_t t_us, const auvid_real_t *command)
{
    (void)context;
    ++heard.calls;
    heard.t_us = t_us;
    memcpy(heard.command, command, sizeof heard.command);
}

static void nothing(void *context, auvid_metric_t *metric)
{
    (void)context;
    (void)metric;
}

static void give_feedback(auvid_real_t first)
{
    auvid_can_message_t a = {.kind = AUVID_CAN_THRUSTER_FEEDBACK_A};
    auvid_can_message_t b = {.kind = AUVID_CAN_THRUSTER_FEEDBACK_B};
    for (int i = 0; i < 4; ++i) {
        a.as.thruster_feedback_a.thrust[i] = first + AUVID_C(0.125) * (auvid_real_t)i;
    }
    b.as.thruster_feedback_b.thrust[0] = AUVID_C(-0.5);
    TEST_ASSERT_EQUAL(AUVID_OK, give(&a));
    TEST_ASSERT_EQUAL(AUVID_OK, give(&b));
}

static void test_thrust_feedback_is_recorded_from_the_previous_tick_on(void)
{
    static const auvid_listener_t listener = {.command = hear, .set = nothing};
    memset(&heard, 0, sizeof heard);
    identifier.listener = &listener;
    begin();
    give_feedback(AUVID_C(0.25));
    step_at(1); /* the start of its action is unknown */
    TEST_ASSERT_EQUAL(0, heard.calls);
    TEST_ASSERT_FALSE(node.id.applied.known);
    give_feedback(AUVID_C(0.25));
    step_at(2);
    TEST_ASSERT_EQUAL(1, heard.calls);
    TEST_ASSERT_EQUAL_UINT64(20000, heard.t_us);
    TEST_ASSERT_EQUAL_UINT64(20000, node.id.applied.t_us);
    for (int i = 0; i < 4; ++i) {
        TEST_ASSERT_TRUE(heard.command[i] == AUVID_C(0.25) + AUVID_C(0.125) * (auvid_real_t)i);
    }
    TEST_ASSERT_TRUE(heard.command[4] == AUVID_C(-0.5));
    step_at(3); /* no feedback */
    TEST_ASSERT_EQUAL(1, heard.calls);
}

static void give_half(auvid_can_kind_t kind, auvid_real_t thrust, uint32_t absent)
{
    auvid_can_message_t m = {.kind = kind, .absent = absent};
    for (int i = 0; i < 4; ++i) { /* both have the same signals */
        m.as.thruster_feedback_a.thrust[i] = thrust;
    }
    TEST_ASSERT_EQUAL(AUVID_OK, give(&m));
}

static void test_feedback_without_the_thrust_of_a_thruster_in_use_is_dropped(void)
{
    static const auvid_listener_t listener = {.command = hear, .set = nothing};
    memset(&heard, 0, sizeof heard);
    identifier.listener = &listener;
    begin();
    step_at(1);
    for (uint32_t absent = 0; absent < 4; ++absent) {
        give_half(AUVID_CAN_THRUSTER_FEEDBACK_A, AUVID_C(0.5), 1u << absent);
        give_half(AUVID_CAN_THRUSTER_FEEDBACK_B, AUVID_C(0.5), 0xEu); /* those are not in use */
        step_at(2 + absent);
        TEST_ASSERT_EQUAL(0, heard.calls);
        TEST_ASSERT_EQUAL_UINT32(1 + 2 * absent, node.counters.samples_dropped); /* B, too */
    }
    give_half(AUVID_CAN_THRUSTER_FEEDBACK_A, AUVID_C(0.25), 0);
    step_at(6);
    TEST_ASSERT_EQUAL(1, heard.calls);
    TEST_ASSERT_TRUE(heard.command[0] == AUVID_C(0.25) && heard.command[4] == AUVID_C(0.5));
}

static void test_half_of_the_feedback_waits_for_the_other_half(void)
{
    static const auvid_listener_t listener = {.command = hear, .set = nothing};
    memset(&heard, 0, sizeof heard);
    identifier.listener = &listener;
    begin();
    step_at(1);
    give_half(AUVID_CAN_THRUSTER_FEEDBACK_A, AUVID_C(0.5), 0);
    step_at(2);
    TEST_ASSERT_EQUAL(0, heard.calls);
    give_half(AUVID_CAN_THRUSTER_FEEDBACK_B, AUVID_C(-0.5), 0);
    step_at(3);
    TEST_ASSERT_EQUAL(1, heard.calls);
    TEST_ASSERT_EQUAL_UINT32(0, node.counters.samples_dropped);
    for (uint32_t k = 4; k < 8; ++k) { /* B has ended: its last thrust is not that of now */
        give_half(AUVID_CAN_THRUSTER_FEEDBACK_A, AUVID_C(0.5), 0);
        step_at(k);
    }
    TEST_ASSERT_EQUAL(1, heard.calls);
    TEST_ASSERT_EQUAL_UINT32(3, node.counters.samples_dropped);
}

static void test_thrust_that_the_recorder_refuses_is_counted(void)
{
    thrusters.thruster[0].max_N = AUVID_C(2e9);
    begin();
    step_at(1);
    give_feedback(AUVID_C(0.5));
    step_at(2);
    TEST_ASSERT_EQUAL_UINT32(1, node.counters.samples_dropped);
}

/* A thruster has less force backwards: the commanded fraction refers to its direction. */
static void test_a_command_is_a_fraction_of_the_maximum_in_its_direction(void)
{
    bool forward = false, backward = false;
    for (int i = 0; i < thrusters.thrusters; ++i) {
        thrusters.thruster[i].min_N = -AUVID_C(100.0);
    }
    excite();
    for (int k = 0; k < 400; ++k) {
        tick_without(0);
        copy_node();
        auvid_input_t in = {.t_us = node.t_us + 20000};
        auvid_output_t out;
        auvid_can_message_t m = {.kind = AUVID_CAN_TICK}; /* no sensor: both see the same */
        auvid_can_frame_t frame;
        m.as.tick.sequence = node.sequence + 1;
        m.as.tick.time = (uint32_t)in.t_us;
        sender.counter[AUVID_CAN_TICK] = vehicle_sim.sender.counter[AUVID_CAN_TICK];
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_pack(&sender, &m, &frame));
        TEST_ASSERT_EQUAL(AUVID_TICK, auvid_node_take(&copy, &frame));
        static auvid_identifier_t same;
        static auvid_actuation_t same_actuation;
        same = node.id;
        same_actuation = actuation;
        same.actuation = &same_actuation;
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&same, &in, &out));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_step(&copy, NULL, sent, &count));
        TEST_ASSERT_EQUAL(2, count);
        for (int i = 0; i < thrusters.thrusters; ++i) {
            auvid_can_message_t c;
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_unpack(NULL, &sent[i / 4], &c));
            const auvid_thruster_t *t = &thrusters.thruster[i];
            auvid_real_t part = c.as.thruster_command_a.thrust[i % 4]; /* b has the same layout */
            auvid_real_t most = part > 0 ? t->max_N : -t->min_N;
            TEST_ASSERT_TRUE(fabs((double)(part * most - out.thruster_N[i])) <=
                             0.51 * (double)most / 4000.0);
            forward = forward || part > AUVID_C(0.1);
            backward = backward || part < -AUVID_C(0.1);
        }
    }
    TEST_ASSERT_TRUE(forward && backward);
}

static auvid_real_t commanded(int thruster)
{
    auvid_can_message_t m;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_unpack(NULL, &sent[thruster / 4], &m));
    TEST_ASSERT_EQUAL_HEX32(0, m.absent);
    return m.as.thruster_command_a.thrust[thruster % 4]; /* b has the same layout */
}

static void test_each_half_with_thrusters_is_commanded_in_every_tick(void)
{
    static const auvid_real_t ahead[AUVID_DOF_COUNT] = {20};
    (void)auvid_excitation_plan(&acting.excitation, ahead, 30, 2, 1);
    thrusters.dofs = AUVID_DOF_BIT(AUVID_SURGE);
    for (uint8_t count_of = 1; count_of <= AUVID_CAN_THRUSTERS; ++count_of) {
        bool driven = false;
        for (int i = 0; i < AUVID_MAX_THRUSTERS; ++i) {
            thrusters.thruster[i] = auvid_allocation_girona500.thruster[i % 2];
        }
        thrusters.thrusters = count_of;
        excite();
        for (int k = 0; k < 20; ++k) {
            tick_without(0);
            TEST_ASSERT_EQUAL(count_of <= 4 ? 1 : 2, count);
            for (int i = 0; i < 4 * count; ++i) {
                TEST_ASSERT_TRUE(i < count_of || commanded(i) == 0);
            }
            driven = driven || commanded(count_of - 1) > 0 || commanded(count_of - 1) < 0;
        }
        TEST_ASSERT_TRUE(driven);
    }
}

/* allocation.h: a thruster without force in either direction has failed. */
static void test_a_failed_thruster_is_commanded_zero_and_a_weak_one_its_fraction(void)
{
    static const auvid_real_t amplitude[AUVID_DOF_COUNT] = {AUVID_C(0.5)};
    bool driven = false;
    (void)auvid_excitation_plan(&acting.excitation, amplitude, 30, 2, 1);
    for (int i = 0; i < 2; ++i) {
        thrusters.thruster[i].max_N = AUVID_C(0.75);
        thrusters.thruster[i].min_N = -AUVID_C(0.75);
    }
    thrusters.thruster[4].max_N = thrusters.thruster[4].min_N = 0;
    excite();
    for (int k = 0; k < 400; ++k) {
        tick_without(0);
        TEST_ASSERT_EQUAL(2, count);
        TEST_ASSERT_TRUE(commanded(4) == 0);
        driven = driven || commanded(0) > AUVID_C(0.1);
    }
    TEST_ASSERT_TRUE(driven);
}

/* The application may arm the identifier and command the thrusters itself. */
static void test_a_passive_node_commands_nothing_though_its_identifier_excites(void)
{
    passive = true;
    begin();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_actuation(&node.id, &actuation, &acting,
                                                                  &node.allocation));
    go(NAVIGATED);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_arm(&node.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_excite(&node.id));
    for (int k = 0; k < 100; ++k) {
        tick_without(0);
        TEST_ASSERT_EQUAL(0, count);
    }
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, actuation.guard.state);
}

/* ---- reports ---- */

/* The next message of this kind within a cycle of reports. */
static auvid_can_message_t reported(auvid_can_kind_t kind)
{
    auvid_can_message_t m;
    for (int turn = 0; turn < 50; ++turn) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_report(&node, 0, sent, &count));
        for (int i = 0; i < count; ++i) {
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_unpack(NULL, &sent[i], &m));
            if (m.kind == kind) {
                return m;
            }
        }
    }
    TEST_FAIL_MESSAGE("not reported");
    return m;
}

static void near(auvid_real_t expected, auvid_real_t got, double step)
{
    TEST_ASSERT_TRUE(fabs((double)(expected - got)) <= 0.51 * step);
}

static void test_the_reported_navigation_is_that_of_the_filter(void)
{
    auvid_nav_state_t s;
    excite();
    go(1000);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_nav_state(&node.id.nav, &s));
    for (int i = 0; i < 3; ++i) { /* all different, so that an exchange is detected */
        TEST_ASSERT_TRUE(fabs((double)s.velocity[i]) > 0.004);
        TEST_ASSERT_TRUE(fabs((double)s.position[i]) > 0.04);
    }
    auvid_can_message_t m = reported(AUVID_CAN_NAV_POSITION);
    near(s.position[0], m.as.nav_position.x, 0.01);
    near(s.position[1], m.as.nav_position.y, 0.01);
    TEST_ASSERT_EQUAL_UINT32(s.flags, m.as.nav_position.flags);
    m = reported(AUVID_CAN_NAV_DEPTH);
    near(s.position[2], m.as.nav_depth.z, 0.002);
    m = reported(AUVID_CAN_NAV_VELOCITY);
    near(s.velocity[0], m.as.nav_velocity.u, 0.001);
    near(s.velocity[1], m.as.nav_velocity.v, 0.001);
    near(s.velocity[2], m.as.nav_velocity.w, 0.001);
}

/* The clock of the bus need not begin at zero. */
static void test_the_reported_uptime_is_that_of_the_node(void)
{
    begin();
    for (uint32_t k = 1; k <= 200; ++k) {
        step_at_us(k, 4000000000u + 20000u * k);
    }
    TEST_ASSERT_EQUAL_UINT32(3, reported(AUVID_CAN_HEARTBEAT).as.heartbeat.uptime);
}

/* lib/can/auvid.dbc: identified, excited, not converged, identifiable, implausible, accepted. */
static void test_each_flag_of_an_estimate_is_one_bit(void)
{
    auvid_estimate_t *e = &node.id.estimate;
    for (unsigned k = 0; k < 6u * auvid_girona500.parameters; ++k) {
        unsigned bit = k % 6, i = k / 6;
        uint32_t only = 1u << i;
        uint8_t dof = (uint8_t)(1u << auvid_girona500.parameter[i].dof);
        begin();
        node.next.parameter = (uint8_t)i;
        e->identified = bit == 0 ? only : ~only;
        e->excited = (uint8_t)(bit == 1 ? dof : ~dof);
        e->not_converged = bit == 2;
        e->confidence.identifiable = bit == 3 ? only : ~only;
        e->confidence.implausible = bit == 4 ? only : ~only;
        e->accepted = bit == 5;
        auvid_can_message_t m = reported(AUVID_CAN_ESTIMATE);
        TEST_ASSERT_EQUAL_UINT32(i, m.as.estimate.index);
        TEST_ASSERT_EQUAL_HEX32(1u << bit, m.as.estimate.flags);
    }
}

static void test_a_change_and_a_drift_are_reported_alike(void)
{
    begin();
    TEST_ASSERT_EQUAL_HEX32(0, reported(AUVID_CAN_PROGRESS).as.progress.changed);
    node.id.change_test.changed = AUVID_DOF_BIT(AUVID_SWAY);
    TEST_ASSERT_EQUAL_HEX32(2, reported(AUVID_CAN_PROGRESS).as.progress.changed);
    node.id.change_test.drifted = AUVID_DOF_BIT(AUVID_YAW);
    TEST_ASSERT_EQUAL_HEX32(2 | 32, reported(AUVID_CAN_PROGRESS).as.progress.changed);
}

/* An estimate with drag in surge, sway, heave and yaw; the yaw rate was positive only. */
static void know_drag(void)
{
    const auvid_parameter_t *p = auvid_girona500.parameter;
    auvid_estimate_t *e = &node.id.estimate;
    int n = auvid_girona500.parameters;
    begin();
    e->number = 130;
    e->excited = 0x27;
    for (int i = 0, diagonal = 0; i < n; diagonal += n - i, ++i) {
        e->pi[i] = (auvid_real_t)(-10 - 7 * i);
        e->covariance[diagonal] = e->confidence.sigma[i] = 1;
        if (p[i].kind == AUVID_PARAMETER_QUADRATIC_DRAG && p[i].dof == AUVID_SWAY) {
            e->confidence.sigma[i] = AUVID_LARGEST;
        }
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        e->speed[j][0] = (auvid_real_t)(0.5 + 0.1 * j);
        e->speed[j][1] = j == AUVID_YAW ? 0 : (auvid_real_t)(0.4 + 0.1 * j);
    }
}

/* The next pair of drag frames. */
static void next_drag(auvid_can_drag_t *force, auvid_can_drag_half_width_t *half,
                      uint32_t absent[2])
{
    auvid_can_message_t m = reported(AUVID_CAN_DRAG);
    *force = m.as.drag;
    absent[0] = m.absent;
    TEST_ASSERT_EQUAL(2, count); /* the half-width is in the same tick */
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_unpack(NULL, &sent[1], &m));
    TEST_ASSERT_EQUAL(AUVID_CAN_DRAG_HALF_WIDTH, m.kind);
    *half = m.as.drag_half_width;
    absent[1] = m.absent;
}

static void test_the_reported_drag_forces_cycle_and_are_those_of_the_estimate(void)
{
    static const auvid_dof_t dofs[] = {AUVID_SURGE, AUVID_SWAY, AUVID_HEAVE, AUVID_YAW};
    static const double parts[] = {0.3, 0.6, 1.0};
    know_drag();
    const auvid_estimate_t *e = &node.id.estimate;
    int identifiable = 0;
    for (uint32_t k = 0; k < 2 * 24; ++k) {
        uint32_t part = k % 3, backward = k / 3 % 2, absent[2];
        auvid_dof_t dof = dofs[k / 6 % 4];
        auvid_can_drag_t force;
        auvid_can_drag_half_width_t half;
        auvid_drag_t drag;
        next_drag(&force, &half, absent);
        TEST_ASSERT_EQUAL_UINT32(6 * dof + 3 * backward + part, force.point);
        TEST_ASSERT_EQUAL_UINT32(force.point, half.point);
        TEST_ASSERT_EQUAL_UINT32(130 - 127, force.number);
        if (dof == AUVID_YAW && backward) { /* not in the data */
            TEST_ASSERT_EQUAL_HEX32(AUVID_CAN_DRAG_NO_FORCE, absent[0]);
            TEST_ASSERT_EQUAL_HEX32(AUVID_CAN_DRAG_HALF_WIDTH_NO_SPEED |
                                        AUVID_CAN_DRAG_HALF_WIDTH_NO_HALF_WIDTH,
                                    absent[1]);
            TEST_ASSERT_EQUAL_HEX32(0, force.flags);
            continue;
        }
        auvid_real_t speed = (auvid_real_t)parts[part] * e->speed[dof][backward];
        speed = backward ? -speed : speed;
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_estimate_drag(e, &auvid_girona500, dof, speed, &drag));
        TEST_ASSERT_EQUAL_FLOAT((float)drag.force, (float)force.force);
        TEST_ASSERT_EQUAL_HEX32(drag.identifiable, force.flags);
        TEST_ASSERT_EQUAL_HEX32(dof == AUVID_SWAY ? AUVID_CAN_DRAG_HALF_WIDTH_NO_HALF_WIDTH : 0,
                                absent[1]);
        near(speed, half.speed, 0.001);
        if (dof != AUVID_SWAY) {
            TEST_ASSERT_EQUAL_FLOAT((float)drag.half_width, (float)half.half_width);
        }
        identifiable += drag.identifiable;
    }
    TEST_ASSERT_TRUE(identifiable > 10 && identifiable < 48 - 12);
}

static void test_before_the_first_estimate_no_drag_force_is_reported(void)
{
    begin();
    for (int turn = 0; turn < 100; ++turn) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_report(&node, 0, sent, &count));
        for (int i = 0; i < count; ++i) {
            TEST_ASSERT_TRUE(auvid_can_kind(NULL, sent[i].id) < AUVID_CAN_DRAG);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_thrust_feedback_is_recorded_from_the_previous_tick_on);
    RUN_TEST(test_feedback_without_the_thrust_of_a_thruster_in_use_is_dropped);
    RUN_TEST(test_half_of_the_feedback_waits_for_the_other_half);
    RUN_TEST(test_thrust_that_the_recorder_refuses_is_counted);
    RUN_TEST(test_a_command_is_a_fraction_of_the_maximum_in_its_direction);
    RUN_TEST(test_each_half_with_thrusters_is_commanded_in_every_tick);
    RUN_TEST(test_a_failed_thruster_is_commanded_zero_and_a_weak_one_its_fraction);
    RUN_TEST(test_a_passive_node_commands_nothing_though_its_identifier_excites);
    RUN_TEST(test_the_reported_navigation_is_that_of_the_filter);
    RUN_TEST(test_the_reported_uptime_is_that_of_the_node);
    RUN_TEST(test_each_flag_of_an_estimate_is_one_bit);
    RUN_TEST(test_a_change_and_a_drift_are_reported_alike);
    RUN_TEST(test_the_reported_drag_forces_cycle_and_are_those_of_the_estimate);
    RUN_TEST(test_before_the_first_estimate_no_drag_force_is_reported);
    return UNITY_END();
}
