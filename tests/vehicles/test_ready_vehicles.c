/* The program's vehicles: simulator, model and thrusters belong to the same vehicle, and the
 * identification finds the simulated parameters. */
#include <math.h>
#include <string.h>

#include "auvid/fossen.h"
#include "unity.h"
#include "bus/world.h"

static world_t world;
static const vehicle_t *rov;

void setUp(void)
{
    rov = vehicle_named("bluerov2");
}

void tearDown(void)
{
}

static void test_vehicles_and_models_have_names(void)
{
    TEST_ASSERT_NOT_NULL(rov);
    TEST_ASSERT_TRUE(vehicle_named("girona500") == vehicle_default());
    TEST_ASSERT_NULL(vehicle_named("bluerov"));
    TEST_ASSERT_TRUE(vehicle_model("test", "girona500") == &auvid_girona500);
    TEST_ASSERT_EQUAL_STRING(auvid_bluerov2_heavy.name, vehicle_model("test", "bluerov2")->name);
    TEST_ASSERT_TRUE(vehicle_model("test", "bluerov2") == rov->model);
    TEST_ASSERT_TRUE(vehicle_model("test", "fossen") == &auvid_fossen);
    TEST_ASSERT_NULL(vehicle_model("test", ""));
    TEST_ASSERT_EQUAL_STRING("girona500, bluerov2, bluerov2_standard, torpedo, surface",
                             vehicle_words());
}

/* A row of one cell needs no averaging. */
static void test_literal_smoothing_has_rows_without_averaging(void)
{
    const world_config_t plain = {.vehicle = rov, .seed = 1, .sets = 1};
    const world_config_t literal = {.vehicle = rov, .seed = 1, .sets = 1, .literal = true};
    auvid_identifier_config_t cfg;
    world_identifier(&cfg, &plain);
    TEST_ASSERT_TRUE(cfg.vehicle != rov->model);
    world_identifier(&cfg, &literal);
    TEST_ASSERT_TRUE(cfg.vehicle == rov->model);
}

static void test_a_world_names_what_the_library_refused(void)
{
    const world_config_t config = {.vehicle = rov, .seed = 1, .sets = 1};
    vehicle_t tumbling = *rov;
    tumbling.guard.roll_max_rad = (auvid_real_t)INFINITY;
    const world_config_t refused = {.vehicle = &tumbling, .seed = 1, .sets = 1};
    auvid_identifier_config_t cfg;
    TEST_ASSERT_TRUE(world_begin(&world, &config));
    TEST_ASSERT_NULL(world_refusal(&world));
    world_identifier(&cfg, &config);
    cfg.nav.gate = -1;
    TEST_ASSERT_FALSE(world_listen(&world, &cfg));
    TEST_ASSERT_EQUAL_STRING("gate", world_refusal(&world)->field);
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, world_refusal(&world)->status);
    TEST_ASSERT_FALSE(world_begin(&world, &refused));
    TEST_ASSERT_EQUAL_STRING("roll_max_rad", world_refusal(&world)->field);
}

static void test_the_simulated_bluerov2_has_the_librarys_parameters(void)
{
    vehicle_sim_config_t cfg;
    vehicle_sim_t *simulated = &world.vehicle_sim;
    double truth[VEHICLE_SIM_PARAMETERS];
    TEST_ASSERT_EQUAL(SIM_FOSSEN_PARAMETERS, AUVID_FOSSEN_COUNT);
    vehicle_simulation(rov, &cfg);
    TEST_ASSERT_TRUE(vehicle_sim_init(simulated, &cfg));
    vehicle_sim_truth(simulated, truth);
    for (int i = 0; i < AUVID_FOSSEN_COUNT; ++i) {
        double expected = (double)auvid_bluerov2_heavy_benzon[i];
        TEST_ASSERT_DOUBLE_WITHIN(2e-7 * fabs(expected), expected, truth[i]);
    }
}

/* The files have the constants of the library. */
static void test_the_ready_vehicles_have_the_librarys_thrusters(void)
{
    const auvid_allocation_config_t *known[] = {&auvid_allocation_girona500,
                                                &auvid_allocation_bluerov2_heavy};
    const vehicle_t *vehicles[] = {vehicle_default(), rov};
    for (int k = 0; k < 2; ++k) {
        const auvid_allocation_config_t *a = vehicles[k]->allocation;
        TEST_ASSERT_EQUAL(known[k]->thrusters, a->thrusters);
        TEST_ASSERT_EQUAL(known[k]->dofs, a->dofs);
        TEST_ASSERT_EQUAL(known[k]->priority, a->priority);
        for (int i = 0; i < a->thrusters; ++i) {
            const auvid_thruster_t *x = &known[k]->thruster[i], *y = &a->thruster[i];
            TEST_ASSERT_EQUAL(x->law, y->law);
            TEST_ASSERT_TRUE(x->min_N == y->min_N && x->max_N == y->max_N);
            TEST_ASSERT_TRUE(x->gain_forward == y->gain_forward &&
                             x->gain_backward == y->gain_backward);
            for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
                TEST_ASSERT_DOUBLE_WITHIN(sizeof(auvid_real_t) == sizeof(float) ? 0 : 1e-8,
                                          (double)x->wrench[j], (double)y->wrench[j]);
            }
        }
    }
}

static void test_the_ready_vehicles_have_the_simulators_truth(void)
{
    void (*const known[])(sim_config_t *) = {sim_defaults, sim_bluerov2};
    const vehicle_t *vehicles[] = {vehicle_default(), rov};
    for (int k = 0; k < 2; ++k) {
        sim_config_t c, d = vehicles[k]->sim;
        known[k](&c);
        TEST_ASSERT_EQUAL(c.model, d.model);
        TEST_ASSERT_EQUAL_MEMORY(c.parameter, d.parameter, sizeof c.parameter);
        TEST_ASSERT_EQUAL_MEMORY(&c.fossen, &d.fossen, sizeof c.fossen);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            for (int i = 0; i < c.thrusters; ++i) {
                TEST_ASSERT_TRUE(c.thruster_matrix[j][i] == d.thruster_matrix[j][i]);
                TEST_ASSERT_TRUE(sim_thruster_limit(&c, i, 1) == sim_thruster_limit(&d, i, 1));
                TEST_ASSERT_TRUE(sim_thruster_limit(&c, i, -1) == sim_thruster_limit(&d, i, -1));
            }
        }
        TEST_ASSERT_TRUE(c.hold_Nm_rad == d.hold_Nm_rad && c.hold_Nms_rad == d.hold_Nms_rad);
    }
}

static void test_simulator_and_allocation_have_the_same_thrusters(void)
{
    const vehicle_t *vehicles[] = {vehicle_default(), rov};
    for (int k = 0; k < 2; ++k) {
        const auvid_allocation_config_t *a = vehicles[k]->allocation;
        vehicle_sim_config_t cfg;
        vehicle_simulation(vehicles[k], &cfg);
        const sim_config_t *c = &cfg.sim;
        double back = c->thruster_back_N > 0 ? c->thruster_back_N : c->thruster_max_N;
        TEST_ASSERT_EQUAL(a->thrusters, c->thrusters);
        for (int i = 0; i < c->thrusters; ++i) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, (double)a->thruster[i].max_N, c->thruster_max_N);
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, -(double)a->thruster[i].min_N, back);
            for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
                TEST_ASSERT_DOUBLE_WITHIN(1e-6, (double)a->thruster[i].wrench[j],
                                          c->thruster_matrix[j][i]);
            }
        }
    }
}

/* Without excitation, from a tilted start, the hover and attitude feedback makes it upright. */
static void test_the_bluerov2_hovers_upright(void)
{
    const world_config_t cfg = {.vehicle = rov, .seed = 1, .sets = 1, .no_arm = true};
    TEST_ASSERT_TRUE(world_begin(&world, &cfg));
    world.vehicle_sim.sim.truth.euler[0] = 0.5;
    world.vehicle_sim.sim.truth.euler[1] = -0.5;
    while (world_time_s(&world) < 30) {
        world_tick(&world);
    }
    const sim_truth_t *t = &world.vehicle_sim.sim.truth;
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0, t->euler[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0, t->euler[1]);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 50, t->position[2]);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0, t->nu[2]);
}

/* Over the bus, in six degrees of freedom, without disturbance. All parameters except the true
 * zeros are identifiable. They are within 8 %, masses and inertias within 2 %. */
static void test_the_bluerov2_is_identified_over_the_bus(void)
{
    const world_config_t cfg = {.vehicle = rov, .seed = 1, .sets = 8};
    const auvid_estimate_t *e = &world.node[0].id.estimate;
    double truth[VEHICLE_SIM_PARAMETERS], most_rad = 0;
    int sure = 0;
    TEST_ASSERT_TRUE(world_begin(&world, &cfg));
    vehicle_sim_truth(&world.vehicle_sim, truth);
    for (uint32_t linger = 0; linger < rov->linger_ticks;) {
        world_tick(&world);
        bool busy = world_work(&world, AUVID_DEFAULT_BUDGET);
        bool over = !busy && world.node[0].id.metric.sets.recorded >= cfg.sets;
        linger = over ? linger + 1 : 0;
        TEST_ASSERT_TRUE(world_time_s(&world) < 400);
        most_rad = fmax(most_rad, fabs(world.vehicle_sim.sim.truth.euler[0]));
        most_rad = fmax(most_rad, fabs(world.vehicle_sim.sim.truth.euler[1]));
    }
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, world.actuation.guard.state);
    TEST_ASSERT_TRUE(most_rad > 0.3 && most_rad < (double)rov->guard.roll_max_rad);
    for (int i = 0; i < AUVID_FOSSEN_COUNT; ++i) {
        double value = (double)e->pi[i];
        TEST_ASSERT_EQUAL_FLOAT(value, world.vehicle_sim.estimate[i]); /* as received in frames */
        if (e->confidence.identifiable >> i & 1u) {
            double max_error = i <= AUVID_FOSSEN_M_R ? 0.02 : 0.08;
            TEST_ASSERT_DOUBLE_WITHIN(max_error * fabs(truth[i]), truth[i], value);
            ++sure;
        }
    }
    TEST_ASSERT_EQUAL(17, sure);
    double rms = vehicle_sim_rms_percent(&world.vehicle_sim);
    TEST_ASSERT_TRUE(rms > 0 && rms < 3);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_vehicles_and_models_have_names);
    RUN_TEST(test_literal_smoothing_has_rows_without_averaging);
    RUN_TEST(test_a_world_names_what_the_library_refused);
    RUN_TEST(test_the_simulated_bluerov2_has_the_librarys_parameters);
    RUN_TEST(test_the_ready_vehicles_have_the_librarys_thrusters);
    RUN_TEST(test_the_ready_vehicles_have_the_simulators_truth);
    RUN_TEST(test_simulator_and_allocation_have_the_same_thrusters);
    RUN_TEST(test_the_bluerov2_hovers_upright);
    RUN_TEST(test_the_bluerov2_is_identified_over_the_bus);
    return UNITY_END();
}
