/*
 * A vehicle with couplings beside its diagonal: Girona500 or an ROV of 20 kg of the field simulator
 * with side drag that does not act at the origin (Y_r, N_v), lift (|u| v, u v, u^2), a centre of
 * gravity ahead of the origin (m_vr, xgW-xbB), and a disturbance. The simulator knows nothing of
 * the table. Girona500's own model, without couplings, is beside it.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "field/field_run.h"
#include "terms_girona500.h"
#include "unity.h"
#include "binomial.h"

enum { Y_R = AUVID_G500_COUNT, N_V, Y_UV, N_UV, Z_UU, M_VR, X_G, COUPLED };
enum { OWN = sizeof terms_girona500_term / sizeof terms_girona500_term[0] };

static const auvid_parameter_t added_parameter[] = {
    {"Y_r", "N s", AUVID_SWAY, AUVID_PARAMETER_OTHER},
    {"N_v", "N s", AUVID_YAW, AUVID_PARAMETER_OTHER},
    {"Y_uv", "N s2/m2", AUVID_SWAY, AUVID_PARAMETER_OTHER},
    {"N_uv", "N s2/m", AUVID_YAW, AUVID_PARAMETER_OTHER},
    {"Z_uu", "N s2/m2", AUVID_HEAVE, AUVID_PARAMETER_OTHER},
    {"m_vr", "kg m", AUVID_YAW, AUVID_PARAMETER_OTHER},
    {"xgW-xbB", "Nm", AUVID_YAW, AUVID_PARAMETER_OTHER},
};
static const auvid_term_t added_term[] = {
    {Y_R, AUVID_SWAY, -1, {AUVID_FACTOR_R}},
    {N_V, AUVID_YAW, -1, {AUVID_FACTOR_V}},
    {Y_UV, AUVID_SWAY, -1, {AUVID_FACTOR_ABS_U, AUVID_FACTOR_V}},
    {N_UV, AUVID_YAW, -1, {AUVID_FACTOR_U, AUVID_FACTOR_V}},
    {Z_UU, AUVID_HEAVE, -1, {AUVID_FACTOR_U, AUVID_FACTOR_U}},
    {M_VR, AUVID_SURGE, -1, {AUVID_FACTOR_R, AUVID_FACTOR_R}},
    {M_VR, AUVID_SWAY, 1, {AUVID_FACTOR_R_DOT}},
    {M_VR, AUVID_HEAVE, 1, {AUVID_FACTOR_P, AUVID_FACTOR_R}},
    {M_VR, AUVID_YAW, 1, {AUVID_FACTOR_V_DOT}},
    {M_VR, AUVID_YAW, 1, {AUVID_FACTOR_U, AUVID_FACTOR_R}},
    {X_G, AUVID_YAW, -1, {AUVID_FACTOR_COS_THETA, AUVID_FACTOR_SIN_PHI}},
};
enum { ADDED = sizeof added_term / sizeof added_term[0] };

static auvid_parameter_t parameter[COUPLED];
static auvid_term_t term[OWN + ADDED];
static const auvid_term_table_t table = {"with couplings", parameter, term, OWN + ADDED, COUPLED};
static auvid_terms_t model;
static field_run_t run;
static field_run_config_t config;
static field_record_t record;

void setUp(void)
{
    memcpy(parameter, auvid_girona500.parameter, AUVID_G500_COUNT * sizeof *parameter);
    memcpy(parameter + AUVID_G500_COUNT, added_parameter, sizeof added_parameter);
    memcpy(term, terms_girona500_term, sizeof terms_girona500_term);
    memcpy(term + OWN, added_term, sizeof added_term);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_terms_init(&model, &table, NULL));
    model.vehicle.free =
        AUVID_G500_FREE | (((uint32_t)1 << COUPLED) - ((uint32_t)1 << AUVID_G500_COUNT));
}

void tearDown(void)
{
}

static void identify(field_vehicle_t vehicle, const auvid_vehicle_t *with, uint64_t seed)
{
    field_run_defaults(&config);
    field_defaults(&config.field, vehicle, FIELD_EXCITED, seed);
    config.thrust_scale = config.dvl_scale = config.delay_s = 0.0;
    config.uncertain = false;
    config.model = with;
    TEST_ASSERT_TRUE(field_set(&config.field, "cross", 0.3));
    TEST_ASSERT_TRUE(field_set(&config.field, "cg_x", 0.02));
    TEST_ASSERT_TRUE(
        field_set(&config.field, "disturbance", vehicle == FIELD_GIRONA500 ? 1.0 : 0.3));
    TEST_ASSERT_TRUE(field_run(&run, &config, &record));
}

/* What the simulator was built with. */
static void find_truth(double truth[COUPLED])
{
    const field_hull_t *h = &run.field.hull;
    field_built_t built;
    field_built(&run.field, &built);
    memset(truth, 0, COUPLED * sizeof *truth);
    memcpy(truth, built.parameter, sizeof built.parameter);
    truth[Y_R] = truth[N_V] = -h->linear[AUVID_SWAY] * h->side_centre_m;
    truth[AUVID_G500_N_R] += truth[N_V] * h->side_centre_m;
    truth[Y_UV] = -h->lift_sway;
    truth[N_UV] = h->lift_yaw;
    truth[Z_UU] = h->lift_heave;
    truth[X_G] = h->weight_N * h->r_g[0];
    truth[M_VR] = h->mass[AUVID_SWAY][AUVID_YAW];
}

/* Flags of all runs. */
typedef struct {
    int all, of_couplings, beyond; /* beyond: off by more than their 95 % half-width */
} terms_flags_t;

static terms_flags_t count_flags(field_vehicle_t vehicle, const auvid_vehicle_t *with, int runs)
{
    terms_flags_t flags = {0};
    for (int k = 1; k <= runs; ++k) {
        const auvid_estimate_t *found = &run.id.estimate;
        double truth[COUPLED];
        identify(vehicle, with, (uint64_t)k);
        find_truth(truth);
        for (int i = 0; i < run.id.metric.cfg.vehicle->parameters; ++i) {
            double error = fabs((double)found->pi[i] - truth[i]);
            if ((found->confidence.identifiable >> i & 1u) == 0) {
                continue;
            }
            ++flags.all;
            flags.of_couplings += i >= AUVID_G500_COUNT;
            flags.beyond += error > 2.1 * (double)found->confidence.sigma[i];
        }
    }
    printf("  %2d parameters, %d runs: %d flags, %d of couplings, %d beyond the half-width\n",
           run.id.metric.cfg.vehicle->parameters, runs, flags.all, flags.of_couplings,
           flags.beyond);
    return flags;
}

static void check_vehicle(field_vehicle_t vehicle)
{
    const int runs = campaign_is_long() ? 100 : 6;
    terms_flags_t with = count_flags(vehicle, &model.vehicle, runs);
    terms_flags_t without = count_flags(vehicle, &auvid_girona500, runs);
    TEST_ASSERT_TRUE(with.of_couplings >= 3 * runs);
    TEST_ASSERT_TRUE(with.beyond * 20 <= with.all);
    TEST_ASSERT_TRUE(without.beyond * 10 > without.all);
}

static void test_girona500_is_identified_with_its_couplings(void)
{
    check_vehicle(FIELD_GIRONA500);
}

static void test_an_rov_is_identified_with_its_couplings(void)
{
    check_vehicle(FIELD_ROV20);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_girona500_is_identified_with_its_couplings);
    RUN_TEST(test_an_rov_is_identified_with_its_couplings);
    return UNITY_END();
}
