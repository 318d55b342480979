/*
 * A refused configuration is named: part, field, element, value and limit.
 */
#include <fenv.h>
#include <math.h>
#include <string.h>

#include "auvid/node.h"
#include "by_residual.h"
#include "refusal.h"
#include "unity.h"

static auvid_identifier_config_t cfg;
static auvid_actuation_config_t acting;
static auvid_allocation_config_t thrusters;
static auvid_allocation_t allocation;
static auvid_actuation_t actuation;
static auvid_node_config_t bus;
static auvid_node_t node;
static auvid_vehicle_t vehicle;
static auvid_row_t rows[1];
static auvid_listener_t listener;

static const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 100, 100, 0, 0, 40};

void setUp(void)
{
    vehicle = auvid_girona500;
    listener = (auvid_listener_t){NULL, NULL, NULL};
    auvid_node_defaults(&bus);
    auvid_identifier_defaults(&cfg, &vehicle);
    auvid_actuation_defaults(&acting);
    thrusters = auvid_allocation_girona500;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_plan(&acting.excitation, amplitude, 30, 2, 1));
}

void tearDown(void)
{
}

static void check_named(auvid_status_t status, const char *part, const char *field, int element,
                        double value, double limit)
{
    memset(&node, 0xFF, sizeof node);
    TEST_ASSERT_EQUAL_INT(status, auvid_identifier_init(&node.id, &cfg));
    assert_why(&node.id.refusal, part, field, element, value, limit);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_identifier_work(&node.id, 1));
    memset(&node, 0xFF, sizeof node);
    if (strcmp(part, "nav") == 0) { /* is not read for another navigation */
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_identifier_init_motion(&node.id, &cfg));
    } else {
        TEST_ASSERT_EQUAL_INT(status, auvid_identifier_init_motion(&node.id, &cfg));
        assert_why(&node.id.refusal, part, field, element, value, limit);
    }
    memset(&node, 0xFF, sizeof node);
    node.id.cfg = cfg; /* the same where init may overwrite its configuration, through the node */
    TEST_ASSERT_EQUAL_INT(status, auvid_node_init(&node, &bus, &thrusters, &node.id.cfg));
    assert_why(&node.id.refusal, part, field, element, value, limit);
    setUp();
}

/* The same of the acting half: the identifier does not change. */
static void check_acting(auvid_status_t status, const char *part, const char *field, int element,
                         double value, double limit)
{
    static auvid_identifier_t before;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_init(&allocation, &thrusters));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_identifier_init(&node.id, &cfg));
    before = node.id;
    memset(&actuation, 0xFF, sizeof actuation);
    TEST_ASSERT_EQUAL_INT(
        status, auvid_identifier_attach_actuation(&node.id, &actuation, &acting, &allocation));
    assert_why(&actuation.refusal, part, field, element, value, limit);
    TEST_ASSERT_EQUAL_MEMORY(&before, &node.id, sizeof before);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_node_init(&node, &bus, &thrusters, &cfg));
    memset(&actuation, 0xFF, sizeof actuation);
    TEST_ASSERT_EQUAL_INT(status, auvid_node_attach_actuation(&node, &actuation, &acting));
    assert_why(&actuation.refusal, part, field, element, value, limit);
    setUp();
}

/* The same of the thrusters of a node. */
static void check_thrusters(auvid_status_t status, const char *part, const char *field, int element,
                            double value, double limit)
{
    memset(&node, 0xFF, sizeof node);
    TEST_ASSERT_EQUAL_INT(status, auvid_node_init(&node, &bus, &thrusters, &cfg));
    assert_why(&node.id.refusal, part, field, element, value, limit);
    setUp();
}

#define NAMED(status, part, field, element, value, limit, assignment)                              \
    do {                                                                                           \
        assignment;                                                                                \
        check_named(AUVID_ERR_##status, part, field, element, value, limit);                       \
    } while (0)
#define NAMED_ACTING(status, part, field, element, value, limit, assignment)                       \
    do {                                                                                           \
        assignment;                                                                                \
        check_acting(AUVID_ERR_##status, part, field, element, value, limit);                      \
    } while (0)
#define NAMED_THRUSTER(status, part, field, element, value, limit, assignment)                     \
    do {                                                                                           \
        assignment;                                                                                \
        check_thrusters(AUVID_ERR_##status, part, field, element, value, limit);                   \
    } while (0)
/* A field of one number: below its lower limit, and above its upper one. */
#define BELOW(part, field, bad, limit)                                                             \
    NAMED(RANGE, #part, #field, -1, (double)(auvid_real_t)(bad), limit,                            \
          cfg.part.field = (auvid_real_t)(bad))
#define BELOW_ACTING(part, field, bad, limit)                                                      \
    NAMED_ACTING(RANGE, #part, #field, -1, (double)(auvid_real_t)(bad), limit,                     \
                 acting.part.field = (auvid_real_t)(bad))
#define ABOVE(part, field, bad, limit) BELOW(part, field, bad, limit)
/* An integer. */
#define WHOLE(part, field, bad, limit)                                                             \
    NAMED(RANGE, #part, #field, -1, bad, limit, cfg.part.field = bad)

static void test_a_field_of_the_filter_is_named(void)
{
    BELOW(nav, reference_tick, 0, 1e-4);
    BELOW(nav, sigma_dvl, 0, 1e-4);
    ABOVE(nav, sigma_dvl, 2000, 1000);
    BELOW(nav, sigma_current, -1, 0);
    BELOW(nav, sigma_depth, 0, 1e-3);
    BELOW(nav, sigma_gps, 0, 1e-3);
    BELOW(nav, sigma_position, 0, 1e-4);
    ABOVE(nav, sigma_velocity, 11, 10);
    BELOW(nav, gate, -1, 0);
    ABOVE(nav, max_acceleration, 101, 100);
    ABOVE(nav, speed_limit, 101, 100);
    BELOW(nav, density, 0, 1);
    BELOW(nav, gravity, 0, 0.1);
    BELOW(nav, surface_pressure, -1, 0);
    ABOVE(nav, surface_depth, 2e5, 1e5);
    WHOLE(nav, dvl_max_age_us, 2000001, 2000000);
    WHOLE(nav, depth_max_age_us, 2000001, 2000000);
    WHOLE(nav, gps_max_age_us, 2000001, 2000000);
    WHOLE(nav, future_us, 2000001, 2000000);
    WHOLE(nav, stale_us, 0, 1);
    WHOLE(nav, gps_start, 9, 8);
    NAMED(RANGE, "nav", "sigma_acceleration", 2, 101, 100, cfg.nav.sigma_acceleration[2] = 101);
    NAMED(RANGE, "nav", "position", 1, -2e5, -1e5, cfg.nav.position[1] = AUVID_C(-2e5));
    NAMED(RANGE, "nav", "mount.imu_euler", 0, 11, 10, cfg.nav.mount.imu_euler[0] = 11);
    NAMED(RANGE, "nav", "mount.dvl_euler", 2, -11, -10, cfg.nav.mount.dvl_euler[2] = -11);
    NAMED(RANGE, "nav", "mount.dvl_lever", 1, 1001, 1000, cfg.nav.mount.dvl_lever[1] = 1001);
    NAMED(NOT_FINITE, "nav", "mount.dvl_lever", 1, NAN, -1000,
          cfg.nav.mount.dvl_lever[1] = (auvid_real_t)NAN);
    NAMED(NOT_FINITE, "nav", "gate", -1, INFINITY, 1e6, cfg.nav.gate = (auvid_real_t)INFINITY);
}

static void test_a_field_of_the_recorder_is_named(void)
{
    WHOLE(recorder, cell_us, 999, 1000);
    WHOLE(recorder, cell_us, 1000001, 1000000);
    WHOLE(recorder, gap_us, 99999, 100000); /* less than a cell */
    WHOLE(recorder, input, 2, 1);
    NAMED(RANGE, "recorder", "gap_us", -1, 1000000001, 1e9, cfg.recorder.gap_us = 1000000001);
}

static void test_a_field_of_the_guard_is_named(void)
{
    BELOW_ACTING(guard, depth_max_m, -1, 0);
    BELOW_ACTING(guard, altitude_min_m, -1, 0);
    BELOW_ACTING(guard, roll_max_rad, -1, 0);
    BELOW_ACTING(guard, pitch_max_rad, -1, 0);
    BELOW_ACTING(guard, speed_max, -1, 0);
    BELOW_ACTING(guard, yaw_rate_max, -1, 0);
    BELOW_ACTING(guard, distance_max_m, -1, 0);
    BELOW_ACTING(guard, rest_speed, -1, 0);
    BELOW_ACTING(guard, rest_rate, -1, 0);
    BELOW_ACTING(guard, depth_min_m, -1, 0);
    NAMED_ACTING(NOT_FINITE, "guard", "speed_max", -1, NAN, 0,
                 acting.guard.speed_max = (auvid_real_t)NAN);
    NAMED_ACTING(BOUNDS, "guard", "depth_min_m", -1, 101, 100, acting.guard.depth_min_m = 101);
    NAMED_ACTING(RANGE, "guard", "off", -1, 2, (double)AUVID_GUARD_SWITCHABLE,
                 acting.guard.off = 2);
}

static void test_a_field_of_the_metric_is_named(void)
{
    BELOW(metric, excitation_threshold, -1, 0);
    WHOLE(metric, velocity_us, 1000001, 1000000);
    WHOLE(metric, max_cell_us, 1000001, 1000000);
    WHOLE(metric, row_cells, 0, 1);
    WHOLE(metric, set_rows, 0, 1);
    WHOLE(metric, set_rows, 60001, 60000 / AUVID_MAX_SETS);
    WHOLE(metric, sets, 0, 1);
    NAMED(SIZE, "metric", "sets", -1, AUVID_MAX_SETS + 1, AUVID_MAX_SETS,
          cfg.metric.sets = AUVID_MAX_SETS + 1);
    WHOLE(metric, passes, 3, 2);
    NAMED(RANGE, "metric", "tau_max", 4, -1, 1e-9, cfg.metric.tau_max[4] = -1);
    NAMED(NOT_FINITE, "metric", "fixed", 3, NAN, -(double)AUVID_LARGEST,
          cfg.metric.fixed[3] = (auvid_real_t)NAN);
    NAMED(RANGE, "metric", "half_width", 1, 0, 1, cfg.metric.half_width[1] = 0);
    NAMED(RANGE, "metric", "lag", 1, 3, AUVID_METRIC_LAGS, cfg.metric.lag[1] = 3);
    NAMED(RANGE, "metric", "delay_s", 2, 0.61, 0.6, cfg.metric.delay_s[2] = AUVID_C(0.61));
    NAMED(RANGE, "metric", "delay_s", 0, -0.3, -0.2001, cfg.metric.delay_s[0] = AUVID_C(-0.3));
}

static void test_a_metric_beyond_the_sizes_is_named(void)
{
    NAMED(SIZE, "metric", "half_width", -1, 4 * 13 + 3, AUVID_MAX_TAPS,
          cfg.metric.half_width[0] = 13);
    NAMED(SIZE, "metric", "row_cells", -1, 4, 5, cfg.metric.row_cells = 4);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        vehicle.columns[j] = (1u << AUVID_G500_COUNT) - 1u;
    }
    NAMED(SIZE, "metric", "free: AUVID_MAX_COLUMNS", -1, 6 * (13 + AUVID_METRIC_DELAYS),
          AUVID_MAX_COLUMNS, (void)0);
    vehicle.columns[AUVID_SURGE] = vehicle.columns[AUVID_SWAY] = (1u << AUVID_G500_COUNT) - 1u;
    NAMED(SIZE, "metric", "free: AUVID_MAX_FACTOR", -1, /* 16 columns twice, 9 and 8 */
          16 * 17 + 9 * 10 / 2 + 8 * 9 / 2, AUVID_MAX_FACTOR, (void)0);
}

static void residual(const void *context, const auvid_sample_t *sample, const auvid_real_t *pi,
                     auvid_real_t *e)
{
    (void)context;
    (void)sample;
    (void)pi;
    (void)e;
}

static void test_a_model_without_regressor_needs_rows(void)
{
    NAMED(MODEL, "vehicle", "regressor", -1, 0, 0,
          (vehicle.regressor = NULL, vehicle.residual = residual));
    vehicle.regressor = NULL;
    vehicle.residual = residual;
    vehicle.path = &auvid_path_residual;
    NAMED(MODEL, "metric", "rows", -1, 0, 0, (void)0);
    vehicle.regressor = NULL;
    vehicle.residual = residual;
    vehicle.path = &auvid_path_residual;
    cfg.metric.rows = rows;
    cfg.metric.row_slots = (AUVID_MAX_SETS + 1) * 60;
    NAMED(SIZE, "metric", "row_slots", -1, 59, 2 * 60,
          (cfg.metric.sets = 1, cfg.metric.row_slots = 59));
    vehicle.regressor = NULL;
    vehicle.residual = residual;
    vehicle.path = &auvid_path_residual;
    cfg.metric.rows = rows;
    cfg.metric.row_slots = (AUVID_MAX_SETS + 1) * 60;
    NAMED(SIZE, "metric", "row_cells", -1, AUVID_MAX_TAPS + 1, AUVID_MAX_TAPS,
          cfg.metric.row_cells = AUVID_MAX_TAPS + 1);
}

#define SEGMENT(status, field, bad, limit)                                                         \
    NAMED_ACTING(status, "excitation.segment", #field, 1, (double)(auvid_real_t)(bad), limit,      \
                 (sines(), acting.excitation.segment[1].field = bad))

/* Makes segment 1 sines. */
static void sines(void)
{
    const auvid_segment_t *from = acting.excitation.segment;
    while (from->kind != AUVID_SEGMENT_SINES) {
        ++from;
    }
    acting.excitation.segment[1] = *from;
}

static void test_a_segment_of_the_excitation_is_named(void)
{
    SEGMENT(RANGE, dof, (auvid_dof_t)6, 5);
    SEGMENT(RANGE, kind, AUVID_SEGMENT_KIND_COUNT, AUVID_SEGMENT_KIND_COUNT - 1);
    SEGMENT(RANGE, duration_s, -1, 0);
    SEGMENT(RANGE, pause_s, -1, 0);
    SEGMENT(RANGE, amplitude, AUVID_C(2e9), (double)AUVID_EXCITATION_LARGEST);
    SEGMENT(RANGE, from, AUVID_C(-2e9), -(double)AUVID_EXCITATION_LARGEST);
    SEGMENT(RANGE, fade_s, 16, 15);
    SEGMENT(RANGE, frequency_hz, 0, 0);
    SEGMENT(NOT_FINITE, phase, (auvid_real_t)NAN, -(double)AUVID_LARGEST);
    SEGMENT(SIZE, sines, 0, 1);
    SEGMENT(SIZE, sines, AUVID_MAX_SINES + 1, AUVID_MAX_SINES);
    SEGMENT(RANGE, frequency_high_hz, 1000, (double)AUVID_EXCITATION_HIGHEST_HZ);
    NAMED_ACTING(RANGE, "excitation.segment", "frequency_hz", 1, 1000,
                 (double)AUVID_EXCITATION_HIGHEST_HZ,
                 (sines(), acting.excitation.segment[1].kind = AUVID_SEGMENT_SINE,
                  acting.excitation.segment[1].frequency_hz = 1000));
    NAMED_ACTING(RANGE, "excitation.segment", "phase", 1, 101, 100,
                 (sines(), acting.excitation.segment[1].kind = AUVID_SEGMENT_SINE,
                  acting.excitation.segment[1].phase = 101));
    NAMED_ACTING(
        RANGE, "excitation.segment", "hold_min_s", 0, 0, 0.2,
        (acting.excitation.segment[0].duration_s = 1, acting.excitation.segment[0].hold_min_s = 0));
    NAMED_ACTING(RANGE, "excitation.segment", "hold_max_s", 0, 3, 4,
                 acting.excitation.segment[0].hold_max_s = 3);
}

static void test_a_field_of_the_excitation_is_named(void)
{
    BELOW_ACTING(excitation, duration_s, -1, 0);
    BELOW_ACTING(excitation, fade_s, -1, 0);
    BELOW_ACTING(excitation, fade_s, 31, 30); /* half the run */
    NAMED_ACTING(RANGE, "excitation", "excursion_limit", 5, -1, 0,
                 acting.excitation.excursion_limit[5] = -1);
    NAMED_ACTING(SIZE, "excitation", "segments", -1, AUVID_MAX_SEGMENTS + 1, AUVID_MAX_SEGMENTS,
                 acting.excitation.segments = AUVID_MAX_SEGMENTS + 1);
    for (int i = 0; i < acting.excitation.segments; ++i) {
        acting.excitation.segment[i] = (auvid_segment_t){.kind = AUVID_SEGMENT_PAUSE};
    }
    NAMED_ACTING(RANGE, "excitation", "segments", -1, 0, 0, (void)0);
}

/* The element is the DoF, the limit what the thrusters give beside the other DoF. */
static void test_an_excitation_beyond_the_thrusters_is_named(void)
{
    const auvid_real_t both[AUVID_DOF_COUNT] = {200, 0, 0, 0, 0, 50};
    const auvid_real_t roll[AUVID_DOF_COUNT] = {10, 0, 0, 5, 0, 0};
    NAMED_ACTING(CAPACITY, "excitation", "segment.amplitude", AUVID_SURGE, 200, 200 * 153.8 / 162.5,
                 auvid_excitation_plan(&acting.excitation, both, 30, 2, 1));
    NAMED_ACTING(CAPACITY, "excitation", "segment.amplitude", AUVID_ROLL, 5, 0,
                 auvid_excitation_plan(&acting.excitation, roll, 30, 2, 1));
}

static void test_a_thruster_is_named(void)
{
    const auvid_real_t none[AUVID_DOF_COUNT] = {0};
    auvid_thruster_t *t = thrusters.thruster;
    NAMED_THRUSTER(RANGE, "allocation.thruster", "wrench", 3, 2e6, 1e6,
                   t[3].wrench[2] = AUVID_C(2e6));
    NAMED_THRUSTER(RANGE, "allocation.thruster", "min_N", 2, 1, 0, t[2].min_N = 1);
    NAMED_THRUSTER(RANGE, "allocation.thruster", "max_N", 2, -1, 0, t[2].max_N = -1);
    NAMED_THRUSTER(RANGE, "allocation.thruster", "law", 0, 2, 1, t[0].law = (auvid_thrust_law_t)2);
    NAMED_THRUSTER(RANGE, "allocation.thruster", "gain_forward", 4, 0, 0, t[4].gain_forward = 0);
    NAMED_THRUSTER(RANGE, "allocation.thruster", "gain_backward", 4, -1, 0,
                   t[4].gain_backward = -1);
    NAMED_THRUSTER(SIZE, "allocation", "thrusters", -1, AUVID_MAX_THRUSTERS + 1,
                   AUVID_MAX_THRUSTERS, thrusters.thrusters = AUVID_MAX_THRUSTERS + 1);
    for (int i = 0; i < thrusters.thrusters; ++i) {
        memcpy(t[i].wrench, none, sizeof none);
    }
    NAMED_THRUSTER(SINGULAR, "allocation", "thruster.wrench", -1, 0, 0, (void)0);
}

static void test_a_field_of_the_search_is_named(void)
{
    auvid_search_config_t *s = &cfg.search;
    NAMED(BOUNDS, "search", "lower", 3, 10, -10, (s->lower[3] = 10, s->upper[3] = -10));
    NAMED(NOT_FINITE, "search", "lower", 3, NAN, -1e18, s->lower[3] = (auvid_real_t)NAN);
    NAMED(RANGE, "search", "upper", 3, 1e30, 1e18, s->upper[3] = AUVID_C(1e30));
    NAMED(POPULATION, "search", "population", -1, 13, 14, s->population = 13);
    NAMED(POPULATION, "search", "population", -1, AUVID_MAX_POPULATION + 1, AUVID_MAX_POPULATION,
          s->population = AUVID_MAX_POPULATION + 1);
    NAMED(RANGE, "search", "omega", -1, -1, 0, s->omega = -1);
    NAMED(RANGE, "search", "sigma", -1, 2, 1, s->sigma = 2);
    NAMED(RANGE, "search", "delta", -1, 1, 1, s->delta = 1);
    NAMED(RANGE, "search", "alpha0", -1, 2e-6, 3e-6, s->alpha0 = AUVID_C(2e-6));
    NAMED(RANGE, "search", "phases", -1, 3, 2, s->phases = AUVID_SEARCH_LOCAL + 1);
    NAMED(NOT_FINITE, "search", "good", 12, NAN, 1000,
          (s->has_good = true, s->good[12] = (auvid_real_t)NAN));
    NAMED(BOUNDS, "search", "lower", 6, 2000, 1000, /* the number of the parameter */
          (s->lower[6] = 2000, cfg.metric.free = 1u << 2 | 1u << 6));
    NAMED(PARAMETERS, "metric", "free", -1, 0, 1, cfg.metric.free = 1u << 31);
    vehicle.regressor = NULL; /* the delay is searched, too */
    vehicle.residual = residual;
    vehicle.path = &auvid_path_residual;
    vehicle.parameters = AUVID_MAX_PARAMETERS;
    cfg.metric.free = 0;
    NAMED(PARAMETERS, "metric", "free", -1, AUVID_MAX_PARAMETERS + 1, AUVID_MAX_PARAMETERS,
          (void)0);
}

static void ignore_command(void *context, uint64_t t_us, const auvid_real_t *command)
{
    (void)context;
    (void)t_us;
    (void)command;
}

static void ignore_set(void *context, auvid_metric_t *metric)
{
    (void)context;
    (void)metric;
}

static void test_a_field_of_the_identifier_is_named(void)
{
    BELOW(uncertainty, thrust_scale, -1, 0);
    ABOVE(uncertainty, dvl_scale, 2, 1);
    ABOVE(uncertainty, delay_s, 2, 1);
    NAMED(RANGE, "", "velocity", -1, 2, 1, cfg.velocity = (auvid_velocity_source_t)2);
    NAMED(RANGE, "", "dry_mass_kg", -1, -1, 0, cfg.dry_mass_kg = -1);
    NAMED(NULL, "listener", "command", -1, 0, 0,
          (cfg.listener = &listener, listener.set = ignore_set));
    NAMED(NULL, "listener", "set", -1, 0, 0,
          (cfg.listener = &listener, listener.command = ignore_command));
    NAMED(DRY_MASS, "", "dry_mass_kg", AUVID_G500_M_V, 300, 200,
          (cfg.dry_mass_kg = 300, cfg.search.upper[AUVID_G500_M_V] = 200));
    TEST_ASSERT_EQUAL_INT(0, fesetround(FE_UPWARD));
    auvid_status_t status = auvid_identifier_init(&node.id, &cfg);
    TEST_ASSERT_EQUAL_INT(0, fesetround(FE_TONEAREST));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_ARITHMETIC, status);
    assert_why(&node.id.refusal, "", "selftest", -1, 0, 0);
}

static bool no_thrust(const void *context, const auvid_sample_t *sample, const auvid_real_t *pi,
                      auvid_real_t *tau)
{
    (void)context;
    (void)sample;
    (void)pi;
    (void)tau;
    return false;
}

static void test_a_member_of_the_model_is_named(void)
{
    static auvid_parameter_t parameter[AUVID_G500_COUNT];
    memcpy(parameter, auvid_girona500.parameter, sizeof parameter);
    NAMED(NULL, "vehicle", "", -1, 0, 0, cfg.vehicle = NULL);
    NAMED(NULL, "vehicle", "parameter", -1, 0, 0, vehicle.parameter = NULL);
    NAMED(SIZE, "vehicle", "built_for", -1, 0, 0, vehicle.built_for = NULL);
    NAMED(PARAMETERS, "vehicle", "parameters", -1, 0, 1, vehicle.parameters = 0);
    NAMED(PARAMETERS, "vehicle", "parameters", -1, 99, AUVID_MAX_PARAMETERS,
          vehicle.parameters = 99);
    NAMED(MODEL, "vehicle", "path", -1, 0, 0, vehicle.path = NULL);
    NAMED(MODEL, "vehicle", "residual", -1, 0, 0,
          (vehicle.regressor = NULL, vehicle.residual = NULL));
    NAMED(MODEL, "vehicle", "residual", -1, 0, 0,
          (vehicle.thrust = no_thrust, vehicle.ignores_inputs = true));
    NAMED(MODEL, "vehicle", "thrust", -1, 0, 0,
          (vehicle = by_residual_girona500(), vehicle.thrust = no_thrust));
    NAMED(MODEL, "vehicle", "reads", 2, 0, 0, vehicle.reads[2] = 1);
    NAMED(MODEL, "vehicle", "columns", 1, 0, 0, vehicle.columns[1] |= 1u << 31);
    NAMED(MODEL, "vehicle", "affine", -1, 0, 0, vehicle.affine = 1u << 31);
    NAMED(MODEL, "vehicle", "columns", -1, 0, 0,
          memset(vehicle.columns, 0, sizeof vehicle.columns));
    parameter[7].dof = AUVID_ROLL;
    NAMED(MODEL, "vehicle", "parameter.dof", 7, 0, 0, vehicle.parameter = parameter);
}

static void test_thrusters_that_are_not_initialised_are_named(void)
{
    memset(&allocation, 0, sizeof allocation);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_identifier_init(&node.id, &cfg));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_SIZE, auvid_identifier_attach_actuation(&node.id, &actuation,
                                                                            &acting, &allocation));
    assert_why(&actuation.refusal, "allocation", "thrusters", -1, 0, 1);
}

static void test_a_field_of_the_node_is_named(void)
{
    thrusters.thrusters = 0;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_SIZE, auvid_node_init(&node, &bus, &thrusters, &cfg));
    assert_why(&node.id.refusal, "allocation", "thrusters", -1, 0, 1);
    setUp();
    bus.ids.fast = 0x7FF;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_node_init(&node, &bus, &thrusters, &cfg));
    assert_why(&node.id.refusal, "ids", "fast", -1, 0x7FF, 0x800 - AUVID_CAN_FAST_KINDS);
    setUp();
    bus.ids.slow = bus.ids.fast;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_node_init(&node, &bus, &thrusters, &cfg));
    assert_why(&node.id.refusal, "ids", "slow", -1, bus.ids.slow,
               bus.ids.fast + AUVID_CAN_FAST_KINDS);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_field_of_the_filter_is_named);
    RUN_TEST(test_a_field_of_the_recorder_is_named);
    RUN_TEST(test_a_field_of_the_guard_is_named);
    RUN_TEST(test_a_field_of_the_metric_is_named);
    RUN_TEST(test_a_metric_beyond_the_sizes_is_named);
    RUN_TEST(test_a_model_without_regressor_needs_rows);
    RUN_TEST(test_a_segment_of_the_excitation_is_named);
    RUN_TEST(test_a_field_of_the_excitation_is_named);
    RUN_TEST(test_an_excitation_beyond_the_thrusters_is_named);
    RUN_TEST(test_a_thruster_is_named);
    RUN_TEST(test_a_field_of_the_search_is_named);
    RUN_TEST(test_a_field_of_the_identifier_is_named);
    RUN_TEST(test_a_member_of_the_model_is_named);
    RUN_TEST(test_thrusters_that_are_not_initialised_are_named);
    RUN_TEST(test_a_field_of_the_node_is_named);
    return UNITY_END();
}
