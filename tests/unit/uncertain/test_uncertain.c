/*
 * Uncertain inputs: each is found where it is the only mismatch, the parameters stay right, and
 * without open-loop motion there is no estimate with them.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "auvid/uncertain.h"
#include "by_residual.h"
#include "chain.h"
#include "field/field_run.h"
#include "unity.h"

static chain_config_t cfg;
static chain_t chain;
static auvid_uncertain_config_t inputs;
static auvid_uncertain_t storage, unchanged;
static auvid_identifier_t before;
static field_run_t run;
static field_run_config_t field;
static field_record_t record;

void setUp(void)
{
    chain_defaults(&cfg, 1, 1, 0.0);
    memset(&chain, 0, sizeof chain);
    memset(&storage, 0, sizeof storage);
    auvid_uncertain_defaults(&inputs);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&chain.allocation, &cfg.thrusters));
}

void tearDown(void)
{
}

/* ---- attaching ---- */

static auvid_status_t attach(void)
{
    before = chain.id;
    auvid_status_t status =
        auvid_identifier_attach_uncertain(&chain.id, &storage, &inputs, &chain.allocation);
    if (status < 0) {
        TEST_ASSERT_EQUAL_MEMORY(&before, &chain.id, sizeof before);
    }
    return status;
}

static void test_null_is_refused(void)
{
    const auvid_allocation_t *a = &chain.allocation;
    before = chain.id;
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL,
                      auvid_identifier_attach_uncertain(NULL, &storage, &inputs, a));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL,
                      auvid_identifier_attach_uncertain(&chain.id, NULL, &inputs, a));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL,
                      auvid_identifier_attach_uncertain(&chain.id, &storage, NULL, a));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL,
                      auvid_identifier_attach_uncertain(&chain.id, &storage, &inputs, NULL));
    TEST_ASSERT_EQUAL_MEMORY(&before, &chain.id, sizeof before);
    auvid_uncertain_defaults(NULL);
}

static void test_it_attaches_once_and_before_the_first_step(void)
{
    auvid_input_t in = {.t_us = 1};
    auvid_output_t out;
    TEST_ASSERT_EQUAL(AUVID_OK, attach());
    unchanged = storage;
    TEST_ASSERT_EQUAL(AUVID_ERR_ATTACHED, attach());
    TEST_ASSERT_EQUAL_MEMORY(&unchanged, &storage, sizeof storage);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id)); /* detaches it */
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&chain.id, &in, &out));
    TEST_ASSERT_EQUAL(AUVID_ERR_STARTED, attach());
    memset(&chain.id, 0, sizeof chain.id);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, attach());
}

static void test_a_prior_out_of_range_is_refused(void)
{
    inputs.sag = (auvid_real_t)NAN;
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, attach());
    auvid_uncertain_defaults(&inputs);
    inputs.backward = (auvid_real_t)-0.01;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, attach());
    auvid_uncertain_defaults(&inputs);
    inputs.nominal_lag_s = 0; /* it is divided by */
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, attach());
}

static void test_thrusters_that_are_not_initialised_are_refused(void)
{
    memset(&chain.allocation, 0, sizeof chain.allocation);
    TEST_ASSERT_EQUAL(AUVID_ERR_SIZE, attach());
}

static void test_more_columns_than_there_is_room_for_are_refused(void)
{
    auvid_allocation_config_t many = cfg.thrusters;
    many.thrusters = AUVID_MAX_THRUSTERS;
    for (int i = 0; i < AUVID_MAX_THRUSTERS; ++i) {
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            many.thruster[i].wrench[j] = 1; /* each acts in all DoF */
        }
        many.thruster[i].max_N = 1;
        many.thruster[i].gain_forward = 1;
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&chain.allocation, &many));
    TEST_ASSERT_EQUAL(AUVID_ERR_SIZE, attach());
}

#if AUVID_MAX_THRUSTERS >= 8
static void test_eight_thrusters_fit(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_allocation_init(&chain.allocation, &auvid_allocation_bluerov2_heavy));
    TEST_ASSERT_EQUAL(AUVID_OK, attach());
}
#endif

static void test_a_model_of_the_residual_path_is_refused(void)
{
    static auvid_vehicle_t vehicle;
    static auvid_row_t rows[180];
    by_residual_surge(&cfg.id, &vehicle, rows, 2);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, attach());
}

/* ---- estimates ---- */

/* Runs the field simulator's Girona500 with one mismatch. */
static void identify(const char *name, double size)
{
    field_run_defaults(&field);
    field_defaults(&field.field, FIELD_GIRONA500, FIELD_EXCITED, 5);
    TEST_ASSERT_TRUE(name == NULL || field_set(&field.field, name, size));
    TEST_ASSERT_TRUE(field_set(&field.field, "disturbance", 0.5));
    TEST_ASSERT_TRUE(field_run(&run, &field, &record));
}

static double error(int i)
{
    return record.pi[i] / record.truth.si[i] - 1.0;
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
                    {NULL, 0.0, AUVID_UNCERTAIN_LAG, -0.1, 0.06}}; /* and the delays */
    for (size_t k = 0; k < sizeof mismatch / sizeof mismatch[0]; ++k) {
        identify(mismatch[k].name, mismatch[k].size);
        double found = (double)run.uncertain.shared[mismatch[k].input];
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(mismatch[k].within, mismatch[k].expected, found,
                                          mismatch[k].name == NULL ? "none" : mismatch[k].name);
        for (int i = SIM_M_U; i <= SIM_M_R; ++i) {
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.05, 0.0, error(i), mismatch[k].name);
            TEST_ASSERT_TRUE(record.flagged[i]);
        }
    }
}

/* Runs the ROV with one mismatch, with all inputs or without one of them. */
static void identify_rov(const char *name, double size, bool (*attach_inputs)(auvid_identifier_t *))
{
    field_run_defaults(&field);
    field_defaults(&field.field, FIELD_ROV20, FIELD_EXCITED, 5);
    field.uncertain = attach_inputs == NULL;
    field.attach = attach_inputs;
    TEST_ASSERT_TRUE(field_set(&field.field, "thrust_lag", 0.15));
    TEST_ASSERT_TRUE(field_set(&field.field, "disturbance", 0.15));
    TEST_ASSERT_TRUE(field_set(&field.field, name, size));
    TEST_ASSERT_TRUE(field_run(&run, &field, &record));
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
        {"dvl_arm_y", -0.06, AUVID_UNCERTAIN_ARM_Y, SIM_X_UU, -0.06, 0.1, 0.12, attach_without_arm},
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

/* Runs a mixture of mismatches. */
static void identify_mixture(uint64_t seed, double strength)
{
    field_run_defaults(&field);
    field_defaults(&field.field, FIELD_GIRONA500, FIELD_EXCITED, seed);
    field_draw(&field.field, strength);
    TEST_ASSERT_TRUE(field_run(&run, &field, &record));
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
        TEST_ASSERT_EQUAL_FLOAT(run.uncertain.scale * run.id.uncertainty.thrust_scale,
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

static void test_inputs_far_less_exact_than_told_give_no_estimate(void)
{
    auvid_causes_t causes;
    char text[160];
    identify("thrust_backward", 0.7);
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
    field_run_defaults(&field);
    field_defaults(&field.field, FIELD_GIRONA500, FIELD_EXCITED, 1);
    TEST_ASSERT_TRUE(field_set(&field.field, "thrust_lag", 0.15));
    TEST_ASSERT_TRUE(field_set(&field.field, "disturbance", 0.5));
    field.sets = 150;
    field.field.length_s = 4500.0;
    TEST_ASSERT_TRUE(field_run(&run, &field, &record));
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
    identify("thrust_advance", 0.3);
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
    while (chain.estimates == 0 && chain.tick < 5000) {
        chain_tick(&chain);
    }
    TEST_ASSERT_EQUAL_UINT32(1, chain.estimates);
}

/* The estimate if parameter i is at most `upper`. */
static const auvid_estimate_t *limit(int i, auvid_real_t upper)
{
    run.id.search.upper[i] = upper;
    run.id.work.set_pending = true;
    for (int k = 0; k < 100000 && auvid_identifier_work(&run.id, 100) == AUVID_PENDING; ++k) {
    }
    return auvid_identifier_estimate(&run.id);
}

/* The inputs take a part of what a bound forbids: if sway's mass may only be half of what it is,
 * surge is wrong, too. */
static void test_what_a_bound_moves_is_not_identifiable_and_names_no_cause(void)
{
    auvid_causes_t causes;
    identify("thrust_advance", 0.3);
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
    identify("thrust_advance", 0.3);
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
    identify("thrust_advance", 0.3);
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

/* Rows from before the first solution have no columns of the current: no vehicle is known. */
static void test_a_current_does_not_bias_the_drag_through_early_rows(void)
{
    double linear = 0.0, quadratic = 0.0; /* means */
    for (uint32_t seed = 1; seed <= 8; ++seed) {
        field_run_defaults(&field);
        field_defaults(&field.field, FIELD_GIRONA500, FIELD_EXCITED, seed);
        TEST_ASSERT_TRUE(field_set(&field.field, "thrust_lag", 0.15));
        TEST_ASSERT_TRUE(field_set(&field.field, "current", 0.1));
        TEST_ASSERT_TRUE(field_run(&run, &field, &record));
        TEST_ASSERT_TRUE(run.uncertain.informed);
        linear += error(SIM_Y_V) / 8.0;
        quadratic += error(SIM_Y_VV) / 8.0;
    }
    printf("mean errors of sway's drag in a current: %.3f, %.3f\n", linear, quadratic);
    /* 0.33 and -0.16 if early rows count in full, 0.15 and -0.08 if the columns of drag are those
       of the motion over ground */
    TEST_ASSERT_DOUBLE_WITHIN(0.06, 0.0, linear);
    TEST_ASSERT_DOUBLE_WITHIN(0.06, 0.0, quadratic);
}

static void identify_asymmetric(field_vehicle_t vehicle, uint32_t seed)
{
    field_run_defaults(&field);
    field_defaults(&field.field, vehicle, FIELD_EXCITED, seed);
    TEST_ASSERT_TRUE(field_set(&field.field, "thrust_lag", 0.15));
    TEST_ASSERT_TRUE(field_set(&field.field, "drag_asymmetry", 0.1));
    TEST_ASSERT_TRUE(field_run(&run, &field, &record));
}

/* Their products with drag are kept: what drag takes of an asymmetry is that of the whole run. */
static void test_early_rows_count_in_the_projection(void)
{
    double squares = 0.0;
    for (uint32_t seed = 1; seed <= 8; ++seed) {
        identify_asymmetric(FIELD_GIRONA500, seed);
        squares += error(SIM_X_UU) * error(SIM_X_UU);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 0.0, sqrt(squares / 8.0)); /* 0.10 without */
}

/* The asymmetry of linear drag is no constant force. */
static void test_asymmetric_drag_leaves_the_constant_force_right(void)
{
    double squares = 0.0;
    for (uint32_t seed = 1; seed <= 8; ++seed) {
        identify_asymmetric(FIELD_ROV20, seed);
        double newtons = record.pi[SIM_WB] - record.truth.si[SIM_WB];
        squares += newtons * newtons / 8.0;
    }
    printf("W-B with asymmetric drag: %.3f N\n", sqrt(squares));
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 0.0, sqrt(squares)); /* 0.14 if the column is a square */
}

/* A light vehicle with its centre of gravity 3 cm off: what its weight adds in yaw depends on the
 * rate, and belongs to the best drag. */
static void test_the_weight_of_a_tilted_vehicle_leaves_the_best_drag(void)
{
    double squares = 0.0;
    int light = 0;
    for (uint32_t seed = 1; light < 8; ++seed) {
        field_sheet_t sheet;
        field_sheet(FIELD_ANY, seed, &sheet);
        if (sheet.dry_kg > 20.0) {
            continue;
        }
        field_run_defaults(&field);
        field_defaults(&field.field, FIELD_ANY, FIELD_EXCITED, seed);
        TEST_ASSERT_TRUE(field_set(&field.field, "thrust_lag", 0.15));
        TEST_ASSERT_TRUE(field_set(&field.field, "cg_x", 0.02));
        TEST_ASSERT_TRUE(field_set(&field.field, "cg_y", 0.02));
        TEST_ASSERT_TRUE(field_run(&run, &field, &record));
        double slope = record.pi[SIM_N_R] + 2.0 * record.pi[SIM_N_RR]; /* at 1 rad/s */
        double best = record.truth.si[SIM_N_R] + 2.0 * record.truth.si[SIM_N_RR];
        squares += (slope / best - 1.0) * (slope / best - 1.0) / 8.0;
        ++light;
    }
    printf("slope of the drag of light vehicles in yaw: %.3f\n", sqrt(squares));
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 0.0, sqrt(squares)); /* 0.22 if the column of weight stays */
}

/* A lawnmower does not excite heave; its rows are taken nevertheless. */
static void test_rows_of_a_dof_that_is_not_excited_belong_to_its_parameters(void)
{
    double mass = 0.0, drag = 0.0; /* sums of square errors */
    for (uint32_t seed = 5; seed < 35; ++seed) {
        field_run_defaults(&field);
        field_defaults(&field.field, FIELD_ROV20, FIELD_LAWNMOWER, seed);
        field_draw(&field.field, 0.0);
        TEST_ASSERT_TRUE(field_run(&run, &field, &record));
        mass += error(SIM_M_U) * error(SIM_M_U);
        drag += error(SIM_X_UU) * error(SIM_X_UU);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 0.0, sqrt(mass / 30.0)); /* it was 13 */
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 0.0, sqrt(drag / 30.0));
}

/* Moves for 100 s, with a tick of this length and a DVL of 5 Hz. Returns the sets; *first_us: when
 * the first one was complete. */
static uint32_t sets_in_ticks_of(uint64_t tick_us, bool uncertain, uint64_t *first_us)
{
    *first_us = 0;
    setUp();
    if (uncertain) {
        TEST_ASSERT_EQUAL(AUVID_OK, attach());
    }
    for (uint64_t t_us = tick_us; t_us <= 100000000; t_us += tick_us) {
        double t = 1e-6 * (double)t_us;
        auvid_output_t out;
        auvid_input_t in = {.t_us = t_us,
                            .imu = {.present = true, .t_us = t_us},
                            .depth = {.present = true, .t_us = t_us, .depth_m = 5},
                            .gps = {.present = t_us == tick_us, .t_us = t_us},
                            .applied = {.present = true}};
        in.dvl.present = t_us % 200000 == 0;
        in.dvl.sample.t_us = t_us;
        in.dvl.sample.valid = AUVID_DVL_X | AUVID_DVL_Y | AUVID_DVL_Z;
        for (int i = 0; i < 3; ++i) {
            in.dvl.sample.velocity[i] = (auvid_real_t)(0.3 * sin((0.3 + 0.1 * i) * t));
            in.applied.wrench[i] = (auvid_real_t)(30.0 * sin((0.3 + 0.1 * i) * t + 1.0));
        }
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&chain.id, &in, &out));
        (void)auvid_identifier_work(&chain.id, AUVID_DEFAULT_BUDGET);
        *first_us = chain.id.metric.sets.recorded > 0 && *first_us == 0 ? t_us : *first_us;
    }
    return chain.id.metric.sets.recorded;
}

/* The last cell of the first set is complete at 35 s. A cell waits for what the one before has left
 * to do; where ticks are as slow as cells, none waits. */
static void test_no_cell_is_lost_and_a_set_is_at_most_seven_ticks_later(void)
{
    const uint64_t complete_us = 35000000;
    const uint64_t tick_us[] = {10000, 20000, 50000, 100000, 200000};
    for (size_t k = 0; k < sizeof tick_us / sizeof tick_us[0]; ++k) {
        uint64_t with_us, without_us;
        uint32_t without = sets_in_ticks_of(tick_us[k], false, &without_us);
        TEST_ASSERT_EQUAL(3, without);
        TEST_ASSERT_EQUAL(without, sets_in_ticks_of(tick_us[k], true, &with_us));
        TEST_ASSERT_TRUE(with_us >= complete_us && with_us <= complete_us + 7 * tick_us[k]);
        TEST_ASSERT_TRUE(without_us >= complete_us && without_us <= complete_us + 5 * tick_us[k]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_no_cell_is_lost_and_a_set_is_at_most_seven_ticks_later);
    RUN_TEST(test_null_is_refused);
    RUN_TEST(test_it_attaches_once_and_before_the_first_step);
    RUN_TEST(test_a_prior_out_of_range_is_refused);
    RUN_TEST(test_thrusters_that_are_not_initialised_are_refused);
    RUN_TEST(test_more_columns_than_there_is_room_for_are_refused);
#if AUVID_MAX_THRUSTERS >= 8
    RUN_TEST(test_eight_thrusters_fit);
#endif
    RUN_TEST(test_a_model_of_the_residual_path_is_refused);
    RUN_TEST(test_each_mismatch_is_found_and_leaves_the_parameters_right);
    RUN_TEST(test_lever_arm_and_delay_of_the_dvl_are_found_and_would_bias_the_estimate);
    RUN_TEST(test_with_inputs_less_exact_than_told_little_is_identifiable);
    RUN_TEST(test_inputs_far_less_exact_than_told_give_no_estimate);
    RUN_TEST(test_a_long_dive_keeps_its_flags);
    RUN_TEST(test_the_estimate_without_uncertain_inputs_stays_available);
    RUN_TEST(test_the_estimate_is_the_minimum_within_the_bounds);
    RUN_TEST(test_what_a_bound_moves_is_not_identifiable_and_names_no_cause);
    RUN_TEST(test_a_bound_close_to_the_estimate_leaves_the_others_identifiable);
    RUN_TEST(test_forces_that_do_not_make_the_wrench_give_no_estimate);
    RUN_TEST(test_a_passive_vehicle_in_open_loop_has_uncertain_inputs);
    RUN_TEST(test_a_current_does_not_bias_the_drag_through_early_rows);
    RUN_TEST(test_early_rows_count_in_the_projection);
    RUN_TEST(test_asymmetric_drag_leaves_the_constant_force_right);
    RUN_TEST(test_the_weight_of_a_tilted_vehicle_leaves_the_best_drag);
    RUN_TEST(test_rows_of_a_dof_that_is_not_excited_belong_to_its_parameters);
    return UNITY_END();
}
