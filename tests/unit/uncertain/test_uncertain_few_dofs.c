/*
 * Uncertain inputs of a vehicle that uses few of the model's degrees of freedom. In the equation of
 * one that rests, noise of the rates of roll and pitch is all that coupling does.
 */
#include <math.h>
#include <string.h>

#include "auvid/uncertain.h"
#include "chain.h"
#include "unity.h"

#define HEAVE                                                                                      \
    (1u << AUVID_G500_M_W | 1u << AUVID_G500_W_B | 1u << AUVID_G500_Z_W | 1u << AUVID_G500_Z_WW)

static chain_config_t cfg;
static chain_t chain;
static auvid_uncertain_t storage;

void setUp(void)
{
    chain_defaults(&cfg, 1, 1, 0.0);
    memset(&chain, 0, sizeof chain);
    cfg.id.metric.free = ((1u << AUVID_G500_COUNT) - 1u) & ~HEAVE;
}

void tearDown(void)
{
}

/* Returns a random number within +- range. */
static auvid_real_t noise(auvid_real_t range)
{
    static uint32_t state = 1;
    state = state * 1664525u + 1013904223u;
    return range * (AUVID_C(2.0) * (auvid_real_t)(state >> 8) / AUVID_C(16777216.0) - 1);
}

/* Motion of surge, sway and yaw, as sums of two sines, and the wrench that it takes beside a
 * disturbance. */
static void move(uint32_t k)
{
    static const auvid_real_t level[3] = {0};
    static auvid_real_t disturbance[AUVID_DOF_COUNT];
    auvid_sample_t sample = {.t_us = 100000u * k};
    auvid_real_t wrench[AUVID_DOF_COUNT];
    auvid_allocation_result_t thrust;
    for (int wave = 0; wave < 6; ++wave) {
        const int dof = wave / 2 == 2 ? AUVID_YAW : wave / 2;
        double w = 0.3 * (1 + wave % 2) + 0.11 * (wave / 2), phase = 0.1 * k * w + dof;
        sample.nu[dof] += (auvid_real_t)(0.2 * sin(phase));
        sample.nu_dot[dof] += (auvid_real_t)(0.2 * w * cos(phase));
    }
    auvid_vehicle_residual(&auvid_girona500, &sample, auvid_girona500_paper, wrench);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        disturbance[j] = k % 10 == 0 ? noise(AUVID_C(0.5)) : disturbance[j];
        wrench[j] += disturbance[j];
    }
    wrench[AUVID_HEAVE] = 0; /* the vehicle is trimmed */
    sample.nu[AUVID_ROLL] = noise(AUVID_C(0.004));
    sample.nu[AUVID_PITCH] = noise(AUVID_C(0.004));
    (void)auvid_allocation_solve(&chain.allocation, wrench, &thrust);
    (void)auvid_identifier_applied(&chain.id, sample.t_us, thrust.wrench, thrust.force_N);
    (void)auvid_identifier_motion(&chain.id, sample.t_us, level, sample.nu);
    (void)auvid_identifier_work(&chain.id, 400);
}

static void identify(void)
{
    auvid_uncertain_config_t inputs;
    auvid_uncertain_defaults(&inputs);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&chain.allocation, &cfg.thrusters));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_uncertain(&chain.id, &storage, &inputs,
                                                                  &chain.allocation));
    for (uint32_t k = 1; k < 1500; ++k) {
        move(k);
    }
}

static void expect_others(void)
{
    static const int mass[] = {AUVID_G500_M_U, AUVID_G500_M_V, AUVID_G500_M_R};
    TEST_ASSERT_TRUE(storage.estimate.number > 1 && !storage.contradicted);
    for (int i = 0; i < 3; ++i) {
        double truth = (double)auvid_girona500_paper[mass[i]];
        TEST_ASSERT_DOUBLE_WITHIN(0.05 * truth, truth, (double)storage.estimate.pi[mass[i]]);
    }
    TEST_ASSERT_TRUE(storage.scale < AUVID_C(1.0));
}

static void test_an_equation_without_free_parameters_of_its_own_shrinks_no_mass(void)
{
    identify();
    expect_others();
}

static void test_an_equation_that_only_noise_couples_shrinks_no_mass(void)
{
    cfg.id.metric.free |= 1u << AUVID_G500_Z_W;
    identify();
    expect_others();
}

static void test_a_fixed_mass_of_a_dof_that_rests_is_no_known_force(void)
{
    cfg.id.metric.free |= 1u << AUVID_G500_Z_W;
    cfg.id.metric.fixed[AUVID_G500_M_W] = AUVID_C(500.0);
    identify();
    expect_others();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_an_equation_without_free_parameters_of_its_own_shrinks_no_mass);
    RUN_TEST(test_an_equation_that_only_noise_couples_shrinks_no_mass);
    RUN_TEST(test_a_fixed_mass_of_a_dof_that_rests_is_no_known_force);
    return UNITY_END();
}
