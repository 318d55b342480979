/*
 * Uncertain inputs: each is found where it is the only mismatch, the parameters stay right, and
 * without open-loop motion there is no estimate with them.
 */
#include <math.h>
#include <string.h>

#include "chain.h"
#include "field_identify.h"

static chain_config_t cfg;
static chain_t chain;
static auvid_uncertain_config_t inputs;
static auvid_uncertain_t storage;

void setUp(void)
{
    chain_defaults(&cfg, 1, 1, 0.0);
    memset(&chain, 0, sizeof chain);
    memset(&storage, 0, sizeof storage);
    auvid_uncertain_defaults(&inputs);
}

void tearDown(void)
{
}

/* Runs the Girona500 with one mismatch. */
static void identify_with(const char *name, double size)
{
    prepare(FIELD_GIRONA500, FIELD_EXCITED, 5);
    choose(name, size);
    choose("disturbance", 0.5);
    identify();
}

static void test_each_mismatch_is_found_and_leaves_the_parameters_right(void)
{
    static const struct {
        const char *name;
        double size;
        int input;
        double expected, within;
    } mismatch[] = {{"thrust_backward", 0.1, AUVID_UNCERTAIN_BACKWARD, 0.1, 0.03},
                    {"thrust_dead_band", 3.0, AUVID_UNCERTAIN_DEAD_BAND, 3.0, 1.0},
                    {"thrust_exponent", 0.1, AUVID_UNCERTAIN_CURVE, 0.1, 0.03},
                    {"thrust_advance", 0.2, AUVID_UNCERTAIN_INFLOW, 0.2, 0.06},
                    {"thrust_lag", 0.2, AUVID_UNCERTAIN_LAG, 0.05, 0.03},
                    {"thrust_lag", 0.0, AUVID_UNCERTAIN_LAG, -0.1, 0.06}}; /* and the delays */
    for (size_t k = 0; k < sizeof mismatch / sizeof mismatch[0]; ++k) {
        identify_with(mismatch[k].name, mismatch[k].size);
        double found = (double)run.uncertain.shared[mismatch[k].input];
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(mismatch[k].within, mismatch[k].expected, found,
                                          mismatch[k].name);
        for (int i = SIM_M_U; i <= SIM_M_R; ++i) {
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.05, 0.0, error(i), mismatch[k].name);
            TEST_ASSERT_TRUE(record.flagged[i]);
        }
    }
}

/* Runs the ROV with one mismatch, with all inputs or without one of them. */
static void identify_rov(const char *name, double size, bool (*attach_inputs)(auvid_identifier_t *))
{
    prepare(FIELD_ROV20, FIELD_EXCITED, 5);
    field.uncertain = attach_inputs == NULL;
    field.attach = attach_inputs;
    choose("thrust_lag", 0.15);
    choose("disturbance", 0.15);
    choose(name, size);
    identify();
}

static bool attach_without(auvid_identifier_t *id, auvid_real_t *deviation)
{
    *deviation = AUVID_C(0.0);
    return auvid_identifier_attach_uncertain(id, &run.uncertain, &inputs, &run.allocation) >= 0;
}

static bool attach_without_arm(auvid_identifier_t *id)
{
    return attach_without(id, &inputs.arm_m);
}

static bool attach_without_late_dvl(auvid_identifier_t *id)
{
    return attach_without(id, &inputs.dvl_late_s);
}

/* The vehicle turns: velocities are wrong by the yaw rate, and rates are not of their time. */
static void test_lever_arm_and_delay_of_the_dvl_are_found_and_would_bias_the_estimate(void)
{
    static const struct {
        const char *name;
        double size;
        int input, parameter;
        double expected, right, wrong;
        bool (*without)(auvid_identifier_t *);
    } mismatch[] = {
        {"dvl_arm_x", 0.06, AUVID_UNCERTAIN_ARM_X, SIM_Y_VV, 0.06, 0.1, 0.2, attach_without_arm},
        {"dvl_arm_y", -0.06, AUVID_UNCERTAIN_ARM_Y, SIM_X_UU, -0.06, 0.05, 0.1, attach_without_arm},
        {"dvl_latency", 0.08, AUVID_UNCERTAIN_DVL_LATE, SIM_M_R, 0.08, 0.05, 0.1,
         attach_without_late_dvl}};
    for (size_t k = 0; k < sizeof mismatch / sizeof mismatch[0]; ++k) {
        const char *name = mismatch[k].name;
        identify_rov(name, mismatch[k].size, NULL);
        double found = (double)run.uncertain.shared[mismatch[k].input];
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.015, mismatch[k].expected, found, name);
        for (int n = AUVID_UNCERTAIN_ARM_X; n <= (int)AUVID_UNCERTAIN_ARM_Y; ++n) {
            double expected = n == mismatch[k].input ? mismatch[k].expected : 0.0;
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.015, expected, (double)run.uncertain.shared[n],
                                              name);
        }
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(mismatch[k].right, 0.0, error(mismatch[k].parameter),
                                          name);
        TEST_ASSERT_TRUE_MESSAGE(record.flagged[mismatch[k].parameter], name);
        auvid_uncertain_defaults(&inputs);
        identify_rov(name, mismatch[k].size, mismatch[k].without);
        TEST_ASSERT_TRUE_MESSAGE(fabs(error(mismatch[k].parameter)) > mismatch[k].wrong, name);
    }
}

static bool attach_without_filter(auvid_identifier_t *id)
{
    return attach_without(id, &inputs.filter_s);
}

static bool attach_without_response(auvid_identifier_t *id)
{
    return attach_without(id, &inputs.response_s2);
}

/* Returns the largest error of the drag and the masses. */
static double largest_error(void)
{
    double largest = 0.0;
    for (int i = SIM_M_U; i <= SIM_N_RR; ++i) {
        bool linear = i > SIM_WB && (i - SIM_X_U) % 2 == 0;
        largest = i == SIM_WB || linear ? largest : fmax(largest, fabs(error(i)));
    }
    return largest;
}

/* What stands between the thrust and the measured motion is not that of the nominal lag. */
static void test_a_filter_of_the_velocity_and_a_long_delay_leave_the_parameters_right(void)
{
    static const struct {
        const char *name;
        double size, right, wrong;
        bool (*without)(auvid_identifier_t *);
    } mismatch[] = {{"filter_tau", 0.15, 0.12, 0.18, attach_without_filter},
                    {"thrust_late", 0.25, 0.15, 0.2, attach_without_response}};
    for (size_t k = 0; k < sizeof mismatch / sizeof mismatch[0]; ++k) {
        const char *name = mismatch[k].name;
        auvid_uncertain_defaults(&inputs);
        identify_rov(name, mismatch[k].size, NULL);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(mismatch[k].right, 0.0, largest_error(), name);
        double filter_s = k == 0 ? mismatch[k].size : 0.0;
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(
            0.03, filter_s, (double)run.uncertain.shared[AUVID_UNCERTAIN_FILTER], name);
        identify_rov(name, mismatch[k].size, mismatch[k].without);
        TEST_ASSERT_TRUE_MESSAGE(largest_error() > mismatch[k].wrong, name);
    }
}

/* In proportion to thrust, or by Fossen's bilinear law: each would bias the other's linear drag. */
static void test_thrust_is_lost_with_speed_by_either_law(void)
{
    for (int bilinear = 0; bilinear < 2; ++bilinear) {
        identify_rov("disturbance", 0.15, NULL);
        choose("thrust_lag", 0.15);
        choose("thrust_advance", 0.2);
        choose("thrust_bilinear", bilinear);
        identify();
        const auvid_real_t *loss = run.uncertain.shared + AUVID_UNCERTAIN_INFLOW;
        double sum = (double)(loss[0] + loss[1]);
        TEST_ASSERT_DOUBLE_WITHIN(0.04, 0.2, sum);
        TEST_ASSERT_TRUE(loss[bilinear] > loss[!bilinear]);
        for (int i = SIM_M_U; i <= SIM_N_RR; ++i) {
            TEST_ASSERT_TRUE(i == SIM_WB || fabs(error(i)) < (i < SIM_WB ? 0.03 : 0.1));
        }
    }
}

static bool attach_without_cross_flow(auvid_identifier_t *id)
{
    return attach_without(id, &inputs.cross_flow);
}

/* Drag of the whole speed looks like thrust that is lost with speed, where all axes move. */
static void test_cross_flow_drag_is_no_loss_of_thrust(void)
{
    const auvid_real_t *loss = run.uncertain.shared + AUVID_UNCERTAIN_INFLOW;
    for (int i = 0; i < 2; ++i) {
        identify_rov("cross_flow", 0.4, i == 0 ? NULL : attach_without_cross_flow);
        double largest = 0.0, sum = (double)(loss[0] + loss[1]);
        for (int k = SIM_M_U; k <= SIM_M_R; ++k) {
            largest = fmax(largest, fabs(error(k)));
        }
        TEST_ASSERT_TRUE(i == 0 ? fabs(sum) < 0.08 : sum > 0.12);
        TEST_ASSERT_TRUE(i == 0 ? largest < 0.06 : largest > 0.09);
    }
}

/* Runs a mixture of mismatches. */
static void identify_mixture(uint64_t seed, double strength)
{
    prepare(FIELD_GIRONA500, FIELD_EXCITED, seed);
    field_draw(&field.field, strength);
    identify();
}

/* The same seed gives the same mismatches, only larger. */
static void test_with_inputs_less_exact_than_told_little_is_identifiable(void)
{
    int usual = 0, large = 0, limits = 0;
    for (uint64_t seed = 1; seed <= 4; ++seed) {
        identify_mixture(seed, 0.5);
        TEST_ASSERT_TRUE(run.uncertain.scale < (auvid_real_t)1.0);
        TEST_ASSERT_EQUAL_FLOAT(run.id.uncertainty.thrust_scale,
                                run.uncertain.estimate.confidence.uncertainty.thrust_scale);
        for (int i = 0; i < SIM_PARAMETERS; ++i) {
            usual += record.flagged[i];
        }
        identify_mixture(seed, 3.0);
        TEST_ASSERT_TRUE(run.uncertain.scale > (auvid_real_t)1.3);
        TEST_ASSERT_EQUAL_FLOAT(run.uncertain.scale * run.uncertain.scale *
                                    run.id.uncertainty.thrust_scale,
                                run.uncertain.estimate.confidence.uncertainty.thrust_scale);
        const auvid_confidence_t *confidence = &run.uncertain.estimate.confidence;
        bool limited = run.uncertain.scale >= (auvid_real_t)2.0;
        TEST_ASSERT_EQUAL(limited, confidence->unchecked);
        TEST_ASSERT_TRUE(!limited || confidence->identifiable == 0);
        limits += limited;
        for (int i = 0; i < SIM_PARAMETERS; ++i) {
            large += record.flagged[i];
        }
    }
    TEST_ASSERT_TRUE(usual > 25 && large < 5 && limits > 0);
}

/* Mixtures that leave so much of the force that its residual, pulling towards less thrust, would
 * carry all gains, masses and drag away: no scale of the priors would suffice. */
static void test_a_large_residual_does_not_carry_the_thrust_away(void)
{
    static const uint64_t seeds[] = {1, 20, 29};
    for (size_t k = 0; k < sizeof seeds / sizeof seeds[0]; ++k) {
        prepare(FIELD_ROV20, FIELD_EXCITED, seeds[k]);
        field_draw(&field.field, 2.0);
        identify();
        TEST_ASSERT_FALSE(run.uncertain.contradicted);
        for (int i = 0; i < run.allocation.cfg.thrusters; ++i) {
            TEST_ASSERT_TRUE(run.uncertain.shared[AUVID_UNCERTAIN_GAIN + i] > (auvid_real_t)-0.25);
        }
    }
}

static void test_inputs_far_less_exact_than_told_give_no_estimate(void)
{
    auvid_causes_t causes;
    char text[160];
    identify_with("thrust_exponent", 1.0);
    TEST_ASSERT_TRUE(run.uncertain.contradicted);
    const auvid_estimate_t *plain = auvid_identifier_estimate(&run.id);
    TEST_ASSERT_EQUAL_PTR(&run.id.estimate, plain);
    TEST_ASSERT_EQUAL_HEX32(0, plain->confidence.identifiable);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_uncertain_causes(&run.uncertain, &causes));
    TEST_ASSERT_TRUE(causes.contradicted);
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_causes_sentence(&causes, &auvid_girona500, 0, text, sizeof text));
    TEST_ASSERT_NOT_NULL(strstr(text, "far less exact than configured"));
    TEST_ASSERT_EQUAL(AUVID_FINISHED,
                      auvid_causes_sentence(&causes, &auvid_girona500, 1, text, sizeof text));
}

/* Sag is counted from an hour ago, not from the beginning of the dive. */
static void test_a_long_dive_keeps_its_flags(void)
{
    prepare(FIELD_GIRONA500, FIELD_EXCITED, 1);
    choose("thrust_lag", 0.15);
    choose("disturbance", 0.5);
    field.sets = 150;
    field.field.length_s = 4500.0;
    identify();
    double elapsed = 4500.0 / (double)AUVID_UNCERTAIN_SAG_S;
    double hour = 3600.0 / (double)AUVID_UNCERTAIN_SAG_S;
    TEST_ASSERT_DOUBLE_WITHIN(0.2, elapsed, (double)run.uncertain.recorded.elapsed);
    TEST_ASSERT_DOUBLE_WITHIN(0.2, elapsed - hour, (double)run.uncertain.work.sag_from);
    for (int i = SIM_M_U; i <= SIM_M_R; ++i) {
        TEST_ASSERT_TRUE(record.flagged[i]);
        TEST_ASSERT_DOUBLE_WITHIN(0.1, 0.0, error(i));
    }
}

static void test_the_estimate_without_uncertain_inputs_stays_available(void)
{
    identify_with("thrust_advance", 0.3);
    const auvid_estimate_t *plain = &run.id.estimate;
    const auvid_estimate_t *with = auvid_identifier_estimate(&run.id);
    TEST_ASSERT_EQUAL_PTR(&run.uncertain.estimate, with);
    TEST_ASSERT_EQUAL_UINT32(plain->number, with->number);
    TEST_ASSERT_TRUE(plain->confidence.unchecked);
    TEST_ASSERT_EQUAL_HEX32(0, plain->confidence.identifiable);
    auvid_drag_t force;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_estimate_drag(plain, &auvid_girona500, AUVID_SURGE,
                                                    AUVID_C(0.6) * plain->speed[0][0], &force));
    TEST_ASSERT_FALSE(force.identifiable);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_estimate_drag(with, &auvid_girona500, AUVID_SURGE,
                                                    AUVID_C(0.6) * with->speed[0][0], &force));
    TEST_ASSERT_TRUE(force.identifiable);
    double drag = fabs((double)plain->pi[SIM_X_UU] / record.truth.si[SIM_X_UU] - 1.0);
    TEST_ASSERT_TRUE(drag > 2.0 * fabs(error(SIM_X_UU)));
}

/* Before a step: the thrusters' forces that make the wrench. */
static void supply_forces(struct chain *c, auvid_input_t *in)
{
    auvid_allocation_result_t result;
    TEST_ASSERT_TRUE(auvid_allocation_solve(&c->allocation, in->applied.wrench, &result) >= 0);
    memcpy(in->applied.command, result.force_N, sizeof result.force_N);
}

/* A driver drives a passive vehicle up to the first estimate. NULL: no commands, all are zero. */
static void drive(chain_before_t supply)
{
    chain_set_driver(&cfg);
    cfg.before = supply;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&chain.allocation, &cfg.thrusters));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_uncertain(&chain.id, &storage, &inputs,
                                                                  &chain.allocation));
    while (chain.estimates == 0 && chain.tick < 10000) {
        chain_tick(&chain);
    }
    TEST_ASSERT_EQUAL_UINT32(1, chain.estimates);
}

/* It takes the time of two sets, and ends. Sets that are complete meanwhile are in the next one. */
static void test_a_solution_slower_than_a_set_gives_an_estimate(void)
{
    chain_defaults(&cfg, 1, 12, 0.0);
    cfg.budget = 17;
    drive(supply_forces);
    while (chain.estimates < 4 && chain.tick < 20000) {
        chain_tick(&chain);
    }
    TEST_ASSERT_EQUAL_UINT32(4, chain.estimates);
    TEST_ASSERT_EQUAL_UINT32(chain.id.estimate.number, storage.estimate.number);
    TEST_ASSERT_TRUE(storage.estimate.sets > 4 && storage.estimate.sets < 12);
}

/* The estimate if parameter i is at most `upper`. */
static const auvid_estimate_t *limit(int i, auvid_real_t upper)
{
    run.id.search.upper[i] = upper;
    run.id.work.set_pending = true;
    run.uncertain.fresh = true;
    for (int k = 0; k < 100000 && auvid_identifier_work(&run.id, 100) == AUVID_PENDING; ++k) {
    }
    return auvid_identifier_estimate(&run.id);
}

/* The inputs take a part of what a bound forbids: if sway's mass may only be half of what it is,
 * surge is wrong, too. */
static void test_what_a_bound_moves_is_not_identifiable_and_names_no_cause(void)
{
    auvid_causes_t causes;
    identify_with("thrust_advance", 0.3);
    auvid_real_t surge = auvid_identifier_estimate(&run.id)->pi[SIM_M_U],
                 sway = auvid_identifier_estimate(&run.id)->pi[SIM_M_V];
    TEST_ASSERT_TRUE(auvid_identifier_estimate(&run.id)->confidence.identifiable >> SIM_M_U & 1u);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_uncertain_causes(&run.uncertain, &causes));
    TEST_ASSERT_TRUE(causes.named > 0);
    const auvid_estimate_t *with = limit(SIM_M_V, AUVID_C(0.5) * sway);
    TEST_ASSERT_EQUAL_PTR(&run.uncertain.estimate, with);
    TEST_ASSERT_TRUE(with->pi[SIM_M_U] < AUVID_C(0.9) * surge);
    TEST_ASSERT_EQUAL(AUVID_NOTE_AT_BOUND, with->confidence.note[SIM_M_V]);
    TEST_ASSERT_EQUAL(AUVID_NOTE_BESIDE_BOUND, with->confidence.note[SIM_M_U]);
    TEST_ASSERT_EQUAL(SIM_M_V, with->confidence.partner[SIM_M_U]);
    TEST_ASSERT_EQUAL_HEX32(0, with->confidence.identifiable & (1u << SIM_M_U | 1u << SIM_M_V));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_uncertain_causes(&run.uncertain, &causes));
    TEST_ASSERT_EQUAL_UINT32(with->number, causes.number);
    TEST_ASSERT_EQUAL(0, causes.named);
}

/* A bound that hardly moves anything leaves the others, and the causes. */
static void test_a_bound_close_to_the_estimate_leaves_the_others_identifiable(void)
{
    auvid_causes_t causes;
    identify_with("thrust_advance", 0.3);
    uint32_t identifiable = auvid_identifier_estimate(&run.id)->confidence.identifiable;
    const auvid_estimate_t *with =
        limit(SIM_M_V, AUVID_C(0.999) * auvid_identifier_estimate(&run.id)->pi[SIM_M_V]);
    TEST_ASSERT_EQUAL(AUVID_NOTE_AT_BOUND, with->confidence.note[SIM_M_V]);
    TEST_ASSERT_EQUAL_HEX32(identifiable & ~(1u << SIM_M_V), with->confidence.identifiable);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_uncertain_causes(&run.uncertain, &causes));
    TEST_ASSERT_TRUE(causes.named > 0);
}

/* The optimizer searches what is left when the inputs are eliminated. */
static void test_the_estimate_is_the_minimum_within_the_bounds(void)
{
    identify_with("thrust_advance", 0.3);
    const auvid_estimate_t *with = auvid_identifier_estimate(&run.id);
    auvid_real_t inside = with->pi[SIM_M_U], beside = with->pi[SIM_X_UU];
    TEST_ASSERT_FALSE(with->not_converged);
    TEST_ASSERT_EQUAL_UINT32(52, with->evaluations_crs);
    TEST_ASSERT_TRUE(with->evaluations_line >= 27 && with->evaluations_line < 40);
    with = limit(SIM_M_U, AUVID_C(0.9) * inside);
    TEST_ASSERT_FALSE(with->not_converged);
    TEST_ASSERT_TRUE(with->pi[SIM_M_U] == AUVID_C(0.9) * inside);
    TEST_ASSERT_FALSE(with->confidence.identifiable >> SIM_M_U & 1u);
    TEST_ASSERT_TRUE(fabs((double)(with->pi[SIM_X_UU] / beside) - 1.0) > 1e-3); /* the best there */
}

static void test_forces_that_do_not_make_the_wrench_give_no_estimate(void)
{
    auvid_causes_t causes;
    char text[160];
    drive(NULL);
    TEST_ASSERT_EQUAL_PTR(&chain.id.estimate, auvid_identifier_estimate(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_uncertain_causes(&storage, &causes));
    TEST_ASSERT_TRUE(causes.thrust_differs);
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_causes_sentence(&causes, &auvid_girona500, 0, text, sizeof text));
    TEST_ASSERT_NOT_NULL(strstr(text, "do not make the wrench"));
}

static void test_a_passive_vehicle_in_open_loop_has_uncertain_inputs(void)
{
    drive(supply_forces);
    TEST_ASSERT_EQUAL_PTR(&storage.estimate, auvid_identifier_estimate(&chain.id));
    TEST_ASSERT_FALSE(storage.excited);
    TEST_ASSERT_TRUE(cfg.id.exact_inputs); /* not read: the inputs are checked */
    TEST_ASSERT_TRUE(chain.id.estimate.confidence.unchecked);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_each_mismatch_is_found_and_leaves_the_parameters_right);
    RUN_TEST(test_lever_arm_and_delay_of_the_dvl_are_found_and_would_bias_the_estimate);
    RUN_TEST(test_a_filter_of_the_velocity_and_a_long_delay_leave_the_parameters_right);
    RUN_TEST(test_thrust_is_lost_with_speed_by_either_law);
    RUN_TEST(test_cross_flow_drag_is_no_loss_of_thrust);
    RUN_TEST(test_with_inputs_less_exact_than_told_little_is_identifiable);
    RUN_TEST(test_a_large_residual_does_not_carry_the_thrust_away);
    RUN_TEST(test_inputs_far_less_exact_than_told_give_no_estimate);
    RUN_TEST(test_a_long_dive_keeps_its_flags);
    RUN_TEST(test_the_estimate_without_uncertain_inputs_stays_available);
    RUN_TEST(test_what_a_bound_moves_is_not_identifiable_and_names_no_cause);
    RUN_TEST(test_a_bound_close_to_the_estimate_leaves_the_others_identifiable);
    RUN_TEST(test_the_estimate_is_the_minimum_within_the_bounds);
    RUN_TEST(test_forces_that_do_not_make_the_wrench_give_no_estimate);
    RUN_TEST(test_a_passive_vehicle_in_open_loop_has_uncertain_inputs);
    RUN_TEST(test_a_solution_slower_than_a_set_gives_an_estimate);
    return UNITY_END();
}
